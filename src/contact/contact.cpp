#include "rbvi/contact/contact.hpp"

#include "rbvi/contact/history.hpp"
#include "rbvi/contact/support_outputs.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>

namespace rbvi {

namespace {

/// Matrices below each other; `diagonal`: their columns side by side, too.
SparseMatrix stacked(const std::vector<SparseMatrix> &parts, bool diagonal) {
  Index rows = 0, columns = diagonal ? 0 : parts.front().cols();
  std::vector<Eigen::Triplet<double>> entries;
  for (const SparseMatrix &part : parts) {
    const Index first_column = diagonal ? columns : 0;
    for (Index row = 0; row < part.rows(); ++row)
      for (SparseMatrix::InnerIterator entry(part, row); entry; ++entry)
        entries.emplace_back(rows + row, first_column + entry.col(), entry.value());
    rows += part.rows();
    if (diagonal) columns += part.cols();
  }
  SparseMatrix result(rows, columns);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

Vector stacked(const std::vector<Vector> &parts) {
  const Index size = std::accumulate(parts.begin(), parts.end(), Index{0},
                                     [](Index n, const Vector &part) { return n + part.size(); });
  Vector result(size);
  Index first = 0;
  for (const Vector &part : parts) {
    result.segment(first, part.size()) = part;
    first += part.size();
  }
  return result;
}

/// One member of all.
template <class Member>
std::vector<Member> each(const std::vector<ContactOperators> &all,
                         Member ContactOperators::*member) {
  std::vector<Member> result;
  for (const ContactOperators &operators : all)
    result.push_back(operators.*member);
  return result;
}

/// weights, nodal_b and nodal_gap.
void stack_nodal(const std::vector<ContactOperators> &all, ContactOperators &operators) {
  operators.weights = stacked(each(all, &ContactOperators::weights));
  operators.nodal_b = stacked(each(all, &ContactOperators::nodal_b), false);
  operators.nodal_gap = stacked(each(all, &ContactOperators::nodal_gap));
  for (const ContactOperators &of_one : all)
    if (of_one.state.displacement.size() > 0) operators.state = of_one.state;
}

/// Counts nodes that imposed values hold below a surface in max_penetration.
void add_held(const ContactInterface &interface, const FullMu &mu, Outputs &outputs) {
  constexpr double round_off = 1e-10;
  double deepest = 0, nodes = 0;
  for (const auto &[left, size] : interface.held_gaps(mu))
    if (-left > round_off * size) {
      deepest = std::max(deepest, -left);
      ++nodes;
    }
  if (nodes == 0) return;
  outputs.held_nodes = nodes;
  outputs.held_depth = deepest;
  outputs.max_penetration = std::max(outputs.max_penetration.value_or(0), deepest);
}

/// Adds the pull of adhesion, which multipliers have not, to forces and pressures of the domain.
void add_pull(ContactInterface &interface, const FullMu &mu, const ContactState &state,
              Outputs &outputs) {
  const Pull pull = pull_of(interface, mu, state);
  if (pull.pressure == 0) return;
  const auto add = [](double more, std::optional<double> &output) {
    if (output) *output += more;
  };
  add(pull.normal_force, outputs.normal_force);
  add(-pull.pressure, outputs.peak_pressure);
  add(-pull.pressure, outputs.centre_pressure);
  add(pull.force[0], outputs.horizontal_reaction);
  add(pull.force[1], outputs.reaction);
  add(pull.force[0], outputs.force_x);
  add(pull.force[1], outputs.force_y);
  add(pull.force[2], outputs.force_z);
}

/// Throws bad_input where Nitsche's method would need the stress of imposed values.
void check_imposed(const ContactRecipe &recipe, const InterfaceMesh &mesh) {
  if (recipe.formulation == Formulation::nitsche &&
      std::ranges::any_of(mesh.imposed_by, [](int boundary) { return boundary >= 0; }))
    throw bad_input("displacements are imposed on a cell beside " + described(recipe) +
                    ", which Nitsche's method does not take: use multipliers (-formulation mixed)");
}

/// Throws bad_input for Nitsche's method beside multipliers.
void check_formulations(const Scene &scene) {
  const auto of = [&](Formulation formulation) {
    return std::ranges::find(scene.contacts, formulation, &ContactRecipe::formulation);
  };
  const auto nitsche = of(Formulation::nitsche), mixed = of(Formulation::mixed);
  if (nitsche == scene.contacts.end() || mixed == scene.contacts.end()) return;
  throw bad_input("scene " + scene.name + " has " + described(*nitsche) +
                  " by Nitsche's method and " + described(*mixed) +
                  " by multipliers: use one of them on both");
}

} // namespace

Index Contact::nodes() const {
  Index count = 0;
  for (const auto &interface : interfaces)
    count += interface->dual().nodes();
  return count;
}

Contact make_contact(const Scene &scene, std::vector<InterfaceMesh> meshes) {
  if (meshes.empty() || meshes.size() != scene.contacts.size())
    throw bad_input("scene " + scene.name + " has " + std::to_string(scene.contacts.size()) +
                    " contact interfaces, on " + std::to_string(meshes.size()) + " meshes");
  check_formulations(scene);
  Contact contact;
  contact.first_row.push_back(0);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    check_imposed(scene.contacts[i], meshes[i]);
    contact.interfaces.push_back(scene.contacts[i].make(scene, std::move(meshes[i])));
    contact.names.push_back(contact_name(scene, i));
    const DualSpace &dual = contact.interfaces.back()->dual();
    contact.first_row.push_back(contact.first_row.back() + dual.size());
  }
  if (contact.interfaces.size() == 1) return contact;
  std::vector<SparseMatrix> grams;
  for (const auto &interface : contact.interfaces)
    grams.push_back(interface->dual().gram);
  contact.stacked_gram = stacked(grams, true);
  return contact;
}

void assemble(const Contact &contact, const FullMu &mu, const ContactState &state,
              ContactOperators &operators) {
  if (contact.interfaces.size() == 1) {
    contact.interfaces.front()->assemble_all(mu, state, operators);
  } else {
    std::vector<ContactOperators> all(contact.interfaces.size());
    for (std::size_t i = 0; i < all.size(); ++i)
      contact.interfaces[i]->assemble_all(mu, state, all[i]);
    stack(contact, all, operators);
  }
  if (state.slip.size() > 0)
    operators.g += added_by_history(contact, state.slip, operators.weights);
}

void assemble_gaps(const Contact &contact, const FullMu &mu, ContactOperators &operators) {
  if (contact.interfaces.size() > 1) return assemble(contact, mu, {}, operators);
  contact.interfaces.front()->assemble_gaps(mu, operators);
}

void stack(const Contact &contact, const std::vector<ContactOperators> &all,
           ContactOperators &operators) {
  operators.b = stacked(each(all, &ContactOperators::b), false);
  operators.g = stacked(each(all, &ContactOperators::g));
  stack_nodal(all, operators);
  operators.uncovered.clear();
  operators.segments.clear();
  for (std::size_t i = 0; i < all.size(); ++i) {
    const std::vector<Index> &segments = all[i].segments;
    operators.segments.insert(operators.segments.end(), segments.begin(), segments.end());
    for (const Index row : all[i].uncovered)
      operators.uncovered.push_back(contact.first_row[i] + row);
  }
}

void assemble_nodal(const Contact &contact, const FullMu &mu, const ContactState &state,
                    const Vector &lambda, ContactOperators &operators) {
  if (contact.interfaces.size() == 1)
    return contact.interfaces.front()->assemble_nodal(mu, state, lambda, operators);
  std::vector<ContactOperators> all(contact.interfaces.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    ContactInterface &interface = *contact.interfaces[i];
    const Vector own = lambda.size() == 0
                           ? lambda
                           : Vector(lambda.segment(contact.first_row[i], interface.dual().size()));
    interface.assemble_nodal(mu, state, own, all[i]);
  }
  stack_nodal(all, operators);
}

bool follows_state(const Contact &contact) {
  return std::ranges::any_of(contact.interfaces,
                             [](const auto &interface) { return interface->follows_state(); });
}

bool has_curvature(const Contact &contact) {
  return std::ranges::all_of(contact.interfaces, [](const auto &interface) {
    return !interface->follows_state() || interface->has_curvature();
  });
}

Curvature curvature(const Contact &contact, const FullMu &mu, const ContactState &state,
                    const Vector &lambda) {
  std::vector<SparseMatrix> s, e;
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    const ContactInterface &interface = *contact.interfaces[i];
    if (!interface.follows_state()) continue;
    Curvature one = interface.curvature(
        mu, state, lambda.segment(contact.first_row[i], interface.dual().size()));
    if (contact.interfaces.size() == 1) return one;
    s.push_back(std::move(one.s));
    e.push_back(std::move(one.e));
  }
  return {stacked(s, false), stacked(e, false)};
}

const ContactInterface *nodal_interface(const Contact &contact) {
  const ContactInterface &only = *contact.interfaces.front();
  return contact.interfaces.size() == 1 && only.is_nodal() ? &only : nullptr;
}

Vector undeformed(const Contact &contact, const Scene &scene, const FullMu &mu) {
  Vector state = Vector::Zero(contact.interfaces.front()->mesh().columns);
  for (const auto &interface : contact.interfaces) {
    const InterfaceMesh &mesh = interface->mesh();
    for (std::size_t i = 0; i < mesh.points.size() && scene.motion; ++i) {
      const Point motion = scene.motion(mu, mesh.points[i]);
      for (std::size_t c = 0; c < static_cast<std::size_t>(mesh.components); ++c)
        if (const int dof = mesh.dofs[i * static_cast<std::size_t>(mesh.components) + c]; dof >= 0)
          state[dof] = -motion[c];
    }
  }
  return state;
}

NodeLaws laws_at(const Contact &contact, const FullMu &mu) {
  NodeLaws laws;
  for (const auto &interface : contact.interfaces) {
    const DualSpace &dual = interface->dual();
    NodeLaws own = uniform_laws(dual.nodes(), dual.components, interface->bound(mu));
    own.free = interface->free_tangents();
    for (Index node = 0; node < own.nodes(); ++node)
      if (own.free[node] == 0) own.bound[node] = {};
    append(own, laws);
  }
  return laws;
}

std::string overdetermined(const Contact &contact) {
  std::map<int, std::size_t> owner; // of a column of B, an interface with a multiplier there
  std::map<std::array<std::size_t, 2>, int> shared;
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    const InterfaceMesh &mesh = contact.interfaces[i]->mesh();
    const DualSpace &dual = contact.interfaces[i]->dual();
    for (const Index vertex : dual.vertices) {
      const int column = mesh.dofs[vertex * mesh.components];
      if (column < 0 || mesh.degree > 1) continue;
      const std::size_t other = owner.try_emplace(column, i).first->second;
      const bool friction =
          dual.size() > dual.nodes() ||
          contact.interfaces[other]->dual().size() > contact.interfaces[other]->dual().nodes();
      if (other != i && friction) ++shared[{other, i}];
    }
  }
  if (shared.empty()) return "";
  const auto &[which, count] = *shared.begin();
  return "the contacts " + contact.names[which[0]] + " and " + contact.names[which[1]] + " share " +
         counted(count, "node") +
         ", where friction on one and contact with the other may ask more than displacements of "
         "degree 1 can meet: use degree: 2 (mesh), or end one of the boundaries a cell before the "
         "other";
}

std::string failure_at(const Contact &contact, const FullMu &mu, const ContactOperators &operators,
                       const Vector &lambda, const std::string &reason) {
  Outputs outputs;
  if (lambda.size() > 0) contact_outputs(contact, mu, operators, lambda, 0, outputs);
  if (outputs.ends_in_contact.value_or(0) == 0) return reason;
  return "contact has come to the end of its boundary: try a smaller indentation or offset, or "
         "more -nonlinear_load_steps (" +
         reason + ")";
}

void contact_outputs(const Contact &contact, const FullMu &mu, const ContactOperators &operators,
                     const Vector &lambda, double least, Outputs &outputs) {
  const MirrorPlanes &mirrors = contact.interfaces.front()->mirrors();
  if (contact.interfaces.size() == 1) {
    contact.interfaces.front()->outputs(mu, operators, lambda, least, outputs);
    add_pull(*contact.interfaces.front(), mu, operators.state, outputs);
    make_whole(mirrors, outputs);
    return add_held(*contact.interfaces.front(), mu, outputs);
  }
  Index node = 0;
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    ContactInterface &interface = *contact.interfaces[i];
    ContactOperators part;
    part.weights = operators.weights.segment(node, interface.dual().nodes());
    part.state = operators.state;
    node += interface.dual().nodes();
    Outputs one;
    one.name = contact.names[i];
    interface.outputs(mu, part, lambda.segment(contact.first_row[i], interface.dual().size()),
                      least, one);
    add_pull(interface, mu, operators.state, one);
    make_whole(mirrors, one);
    add_held(interface, mu, one);
    add_contact(one, outputs);
  }
}

Pull pull_of(ContactInterface &interface, const FullMu &mu, const ContactState &state) {
  Pull pull{.pressure = interface.bound(mu).pull};
  if (pull.pressure == 0) return pull;
  const DualSpace &dual = interface.dual();
  Vector lambda = Vector::Zero(dual.size());
  lambda.head(dual.nodes()).setConstant(-pull.pressure);
  ContactOperators operators;
  interface.assemble_nodal(mu, state, lambda, operators);
  pull.normal_force = operators.weights.dot(lambda.head(dual.nodes()));
  for (const PointForce &at : interface.point_forces(mu, state, lambda))
    pull.force = pull.force + at.force;
  return pull;
}

Grid contact_fields(ContactInterface &interface, const FullMu &mu, const Vector &u,
                    const Vector &lambda) {
  Grid grid = interface.fields(mu, u, lambda, false);
  for (std::vector<Field> *fields : {&grid.of_nodes, &grid.of_cells})
    for (Field &field : *fields)
      if (field.name == "pressure") field.values.array() -= interface.bound(mu).pull;
  return grid;
}

DualRow dual_row(const Contact &contact, Index row) {
  std::size_t i = 0;
  while (row >= contact.first_row[i + 1])
    ++i;
  const DualSpace &dual = contact.interfaces[i]->dual();
  const Index local = row - contact.first_row[i], tangents = dual.components - 1;
  if (local < dual.nodes()) return {i, local, true};
  return {i, (local - dual.nodes()) / tangents, false};
}

std::string said_of(const Contact &contact, Index row) {
  return contact.names[dual_row(contact, row).interface] + ": ";
}

Matrix by_node(const Contact &contact, const Vector &lambda) {
  Matrix result = Matrix::Zero(contact.nodes(), contact.interfaces.front()->mesh().dim);
  Index first = 0;
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    const DualSpace &dual = contact.interfaces[i]->dual();
    const Index nodes = dual.nodes();
    const auto own = lambda.segment(contact.first_row[i], dual.size());
    result.col(0).segment(first, nodes) = own.head(nodes);
    for (Index k = 0; k + 1 < dual.components; ++k)
      result.col(1 + k).segment(first, nodes) =
          own.tail((dual.components - 1) * nodes)(Eigen::seqN(k, nodes, dual.components - 1));
    first += nodes;
  }
  return result;
}

std::vector<Point> dual_points(const Contact &contact) {
  std::vector<Point> points;
  for (const auto &interface : contact.interfaces)
    points.insert(points.end(), interface->dual().points.begin(), interface->dual().points.end());
  return points;
}

std::vector<MaterialPoint> material_points(const Contact &contact) {
  std::vector<MaterialPoint> points;
  for (const auto &interface : contact.interfaces) {
    const InterfaceMesh &mesh = interface->mesh();
    const int vertices = mesh.vertices();
    for (Index e = 0; e < mesh.count(); ++e) {
      Point middle{};
      for (int i = 0; i < vertices; ++i)
        middle = middle + 1.0 / vertices * mesh.points[mesh.nodes_of(e)[i]];
      points.push_back({middle, mesh.material_of(e)});
    }
  }
  return points;
}

} // namespace rbvi
