#include "rbvi/rom/model/model.hpp"

#include "checks.hpp"
#include "nitsche_part.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/element/lagrange.hpp"
#include "rbvi/rom/model/packed.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rbvi {

namespace {

Matrix leading_block(const Matrix &packed, Index rows, Index r, Index n) {
  Matrix result(r * n, packed.cols());
  for (Index j = 0; j < n; ++j)
    result.middleRows(j * r, r) = packed.middleRows(j * rows, r);
  return result;
}

/// `samples`: of how many meshes the entries are; `columns`: of `reduced`.
void check_terms(const AffineTerms &terms, Index rows, Index columns, int dim, std::size_t samples,
                 const std::string &name) {
  const Index size = terms.interpolation.rows();
  require_shape(terms.interpolation, size, size, name + "/interpolation");
  require(terms.exact >= 0, name + "/exact is negative");
  require_shape(terms.reduced, terms.size() == 0 ? terms.reduced.rows() : rows, columns,
                name + "/reduced");
  require(size == 0 || terms.samples.size() == samples, name + " has sampled entries elsewhere");
  for (const SampleMesh &sample : terms.samples) {
    const Matrix &vertices = sample.vertices;
    require(sample.corners > 1 && sample.corners <= dim + 1 &&
                vertices.rows() % sample.corners == 0,
            name + "/vertices is not a list of cells");
    require_shape(vertices, vertices.rows(), vertices.rows() == 0 ? vertices.cols() : dim,
                  name + "/vertices");
    require(sample.terms.empty() || std::ssize(sample.terms) * sample.corners == vertices.rows(),
            name + "/cell_terms does not fit");
    const std::size_t cells = static_cast<std::size_t>(vertices.rows() / sample.corners);
    require(cells == 0 ? sample.imposed_by.empty() : sample.imposed_by.size() % cells == 0,
            name + "/cell_imposed_by does not fit");
    int previous = 0;
    for (const SampleMesh::Contribution &c : sample.contributions) {
      require(c.entry >= previous && c.entry < size && c.cell >= 0 && c.local >= 0 &&
                  c.cell < vertices.rows() / sample.corners,
              name + "/contributions point nowhere or are not ordered by entry");
      previous = c.entry;
    }
  }
}

void check_change(const ReducedModel &model) {
  const StiffnessChange &change = model.a_change;
  const Index rank = change.rank(), terms = rank > 0 ? model.a.size() : 0;
  require(rank == 0 || !(model.law || !model.has_multipliers() || model.online_enriched),
          "a/range is for a pair of spaces");
  require_shape(change.scales, terms, 1, "a/scales");
  require_shape(change.range, rank > 0 ? model.primal_size() : change.range.rows(), rank,
                "a/range");
  require_shape(change.cores, rank > 0 ? rank * (rank + 1) / 2 : change.cores.rows(), terms,
                "a/cores");
}

void check_interface(const InterfaceModel &interface, int dim, Index columns) {
  const InterfaceMesh &mesh = interface.mesh;
  const Index nodes = mesh.nodes();
  require(mesh.dim == dim && (mesh.degree == 1 || mesh.degree == 2) && mesh.components > 0 &&
              mesh.components <= 3 && mesh.per_entity > 1 && mesh.columns == columns,
          "interfaces/sizes do not fit");
  require(std::ranges::all_of(mesh.points,
                              [](const Point &x) { return std::isfinite(x[0] + x[1] + x[2]); }),
          "interfaces/points has an entry that is not finite");
  require(mesh.count() > 0 && static_cast<Index>(mesh.entities.size()) % mesh.per_entity == 0,
          "interfaces/entities is not a list of them");
  require_indices(mesh.entities, nodes, "interfaces/entities");
  require(mesh.edges.empty() || static_cast<Index>(mesh.edges.size()) == mesh.count(),
          "interfaces/edges does not fit");
  require_indices(mesh.edges, 3, "interfaces/edges");
  require(std::accumulate(mesh.parts.begin(), mesh.parts.end(), Index{0}) == nodes &&
              std::ranges::all_of(mesh.parts, [](int part) { return part > 0; }),
          "interfaces/parts does not fit");
  require(static_cast<Index>(mesh.dofs.size()) == nodes * mesh.components &&
              std::ranges::all_of(mesh.dofs, [&](int d) { return d >= -1 && d < columns; }),
          "interfaces/dofs does not fit");
  require(static_cast<Index>(interface.nodes.size()) == nodes, "interfaces/nodes does not fit");
  require(mesh.imposed_by.empty() || mesh.imposed_by.size() == mesh.dofs.size(),
          "interfaces/imposed_by does not fit");
}

void check_fields(const ReducedModel &model, int dim) {
  const Index nodes = model.mesh_points.rows();
  if (nodes == 0 && model.primal_basis.rows() == 0) return;
  require_shape(model.mesh_points, nodes, dim, "fields/points");
  require(nodes > 0 && model.primal_basis.rows() % nodes == 0,
          "fields/primal_basis has no whole number of rows per node");
  require_shape(model.primal_basis, model.primal_basis.rows(), model.primal_size(),
                "fields/primal_basis");
  for (const InterfaceModel &interface : model.interfaces)
    require_indices(interface.nodes, nodes, "interfaces/nodes");
  require_indices(model.mesh_cells, nodes, "fields/cells");
  require(model.imposed_by.empty() ||
              static_cast<Index>(model.imposed_by.size()) == model.primal_basis.rows(),
          "fields/imposed_by does not fit");
  const int degree = model.interfaces.front().mesh.degree;
  require(model.mesh_cells.size() % static_cast<std::size_t>(nodes_per_cell(dim, degree)) == 0,
          "fields/cells is not a list of cells");
}

void check_law(const ReducedModel &model, const NodalLaw &law) {
  const CondensedOperator &condensed = law.condensed;
  const Index m = model.generators, b = model.b.size();
  const Index blocks = model.evaluates_contact() ? 1 : b * (b + 1) / 2;
  const Index size = model.evaluates_contact() ? std::ssize(condensed.dofs) : m;
  require(law.normal > 0 && law.normal <= m, "law/normal does not fit");
  require(law.reduction >= MultiplierReduction::condensed &&
              law.reduction <= MultiplierReduction::collocated,
          "law/reduction is none that this build has");
  for (const ChebyshevAxis &axis : condensed.axes)
    require(axis.points > 0 && axis.lower < axis.upper && axis.parameter >= 0 &&
                axis.parameter < static_cast<int>(model.scene.parameters.all.size()),
            "law/axes do not fit");
  if (condensed.terms.size() > 0) {
    require_shape(condensed.shape, condensed.shape.rows(), grid_size(condensed.axes), "law/shape");
    require_shape(condensed.terms, size * size, blocks * condensed.shape.rows(), "law/terms");
    require_indices(condensed.dofs, model.contact_trace.rows(), "law/dofs");
  } else {
    require(law.reduction == MultiplierReduction::collocated, "it has no condensed operator");
  }
  if (law.reduction == MultiplierReduction::collocated) {
    const MultiplierBasis &basis = law.basis;
    require_shape(basis.normal, law.normal, basis.normal.cols(), "law/basis/normal");
    require_shape(basis.tangential, m - law.normal, basis.tangential.cols(),
                  "law/basis/tangential");
    require_indices(basis.nodes, law.normal, "law/basis/nodes");
  }
  const int apart = law.apart.normal, all = model.b.size();
  require(apart >= 0 && (apart == 0 || (apart < all && m > law.normal)), "law/apart does not fit");
  require(model.b.interpolation.bottomLeftCorner(all - apart, apart).isZero(0),
          "b/interpolation mixes terms of B^n and of B^tau");
  require_shape(law.starts, m, law.starts.cols(), "law/starts");
  require_shape(law.starts_mu, model.scene.parameters.size(), law.starts.cols(), "law/starts_mu");
  if (law.states.size() > 0)
    require_shape(law.states, model.contact_trace.rows(), law.starts.cols(), "law/states");
}

} // namespace

void check_model(const ReducedModel &model) {
  require(!model.interfaces.empty(), "it has no contact interface");
  const int dim = model.interfaces.front().mesh.dim;
  const Index n = model.primal_size(), r = model.generators, dual = model.dual_basis.rows(),
              contact = model.contact_dofs();
  require(dim == 2 || dim == 3, "interfaces have neither 2 nor 3 dimensions");
  require(model.modes > 0 && model.supremizers >= 0 && (r > 0 || !model.has_multipliers()),
          "it has no modes or no generators");
  require(model.a.size() > 0, "a has no terms");
  require(model.b.size() > 0 ? model.has_multipliers() : model.g.size() == 0,
          "g has terms and b has not, or Nitsche's method has some");
  const std::size_t interfaces = model.interfaces.size();
  for (const InterfaceModel &interface : model.interfaces)
    check_interface(interface, dim, contact);
  const Index of_a = model.a_change.rank() > 0 ? 1 : model.a.size();
  check_terms(model.a, n * (n + 1) / 2, of_a, dim, 1, "a");
  check_change(model);
  check_terms(model.b, r * n, model.b.size(), dim, interfaces, "b");
  check_terms(model.f, n, model.f.size(), dim, 1, "f");
  check_terms(model.g, r, model.g.size(), dim, interfaces, "g");
  check_terms(model.imposed_energy, 1, model.imposed_energy.size(), dim, 1, "imposed_energy");
  if (model.law) check_law(model, *model.law);
  check_nitsche(model);
  require_shape(model.dual_basis, dual, r, "contact/dual_basis");
  require(model.free_modes >= 0 && model.free_modes <= r, "size/free_modes does not fit");
  const bool partial = !model.trace_dofs.empty();
  require(!partial || !(model.law || !model.has_multipliers() || model.evaluates_contact()),
          "contact/trace_dofs is for a pair of spaces");
  require(std::ranges::is_sorted(model.trace_dofs), "contact/trace_dofs does not rise");
  require_indices(model.trace_dofs, contact, "contact/trace_dofs");
  require_shape(model.contact_trace, partial ? std::ssize(model.trace_dofs) : contact, n,
                "contact/trace");
  const Index free = model.scene.parameters.size();
  for (const auto &[mu, name] :
       {std::pair{&model.trained_mu, "training/mu"}, {&model.failed_mu, "training/failed"}})
    require_shape(*mu, mu->cols() == 0 ? mu->rows() : free, mu->cols(), name);
  check_fields(model, dim);
}

const std::vector<std::string> &multiplier_reduction_names() {
  static const std::vector<std::string> names{"auto", "cone", "condensed", "collocated"};
  return names;
}

ReducedModel leading(const ReducedModel &model, int n, int r) {
  if (n < 1 || n > model.primal_size() || r < std::min(1, model.generators) || r > model.generators)
    throw bad_input("no leading part of " + std::to_string(n) + " primal and " + std::to_string(r) +
                    " dual functions in a model of " + std::to_string(model.primal_size()) +
                    " and " + std::to_string(model.generators));
  if (model.law && r != model.generators)
    throw bad_input("a model of contact with a support has no part with fewer multipliers");
  ReducedModel result = model;
  result.modes = std::min(n, model.modes);
  result.supremizers = n - result.modes;
  result.online_enriched = model.online_enriched && result.supremizers > 0;
  result.generators = r;
  result.free_modes = std::max(0, r - (model.generators - model.free_modes));
  if (model.a_change.rank() > 0) result.a_change.range = model.a_change.range.topRows(n);
  result.a.reduced = leading_triangles(model.a.reduced, model.primal_size(), n);
  if (model.b.size() > 0) result.b.reduced = leading_block(model.b.reduced, model.generators, r, n);
  if (model.f.size() > 0) result.f.reduced = model.f.reduced.topRows(n);
  if (model.g.size() > 0) result.g.reduced = model.g.reduced.topRows(r);
  result.dual_basis = model.dual_basis.leftCols(r);
  result.contact_trace = model.contact_trace.leftCols(n);
  keep_leading_nitsche(model.primal_size(), n, result);
  if (model.primal_basis.size() > 0) result.primal_basis = model.primal_basis.leftCols(n);
  if (n != model.primal_size()) result.fields_key.clear();
  if (r != model.generators || n != model.primal_size()) result.validation_enriched = {};
  if (r != model.generators || n != model.primal_size()) result.self_check = {};
  if (r != model.generators || result.modes != model.modes) result.validation_decorrelated = {};
  return result;
}

const ValidationErrors &expected_errors(const ReducedModel &model) {
  const ValidationErrors &plain = model.validation_decorrelated;
  return model.supremizers == 0 && plain.count + plain.unanswered > 0 ? plain
                                                                      : model.validation_enriched;
}

ErrorOfOutput errors_of_outputs(const ReducedModel &model) {
  ErrorOfOutput errors;
  for (const OutputError &error : expected_errors(model).outputs)
    if (output_column(error.name).kind != OutputKind::check) errors[error.name] = error.max;
  return errors;
}

Point point_of(const Matrix &points, Index i) {
  Point point{};
  for (Index k = 0; k < points.cols(); ++k)
    point[k] = points(i, k);
  return point;
}

Contact contact_of(const ReducedModel &model, const Scene &scene) {
  std::vector<InterfaceMesh> meshes;
  for (const InterfaceModel &interface : model.interfaces)
    meshes.push_back(interface.mesh);
  return make_contact(scene, std::move(meshes));
}

Scene scene_by_code(const Scene &stored, const Registry &registry) {
  Scene scene = make_scene(entry_of(registry, stored.name), stored.options);
  const auto same = [](const Parameter &p, const Parameter &q) { return p.name == q.name; };
  if (!std::ranges::equal(scene.parameters.all, stored.parameters.all, same))
    throw bad_input("the parameters of the model are not those of scene " + stored.name +
                    " in this build");
  const ParameterSpace of_scene = std::exchange(scene.parameters, stored.parameters);
  for (std::size_t i = 0; i < of_scene.all.size(); ++i)
    scene.parameters.all[i].valid = of_scene.all[i].valid;
  check_box(scene);
  return scene;
}

} // namespace rbvi
