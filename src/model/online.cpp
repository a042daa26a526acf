#include "rbvi/model/online.hpp"

#include "rbvi/contact/force_balance.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/largest.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/model/affine_coefficients.hpp"
#include "rbvi/model/certificate.hpp"
#include "rbvi/model/column_laws.hpp"
#include "rbvi/model/free_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

/// The contact dofs that constraints at single nodes act on, where they are not all: those of the
/// vertices.
std::vector<Index> nodal_dofs(const Contact &contact) {
  std::vector<Index> dofs;
  for (const auto &interface : contact.interfaces) {
    if (interface->dual().vertices.empty()) return {};
    const InterfaceMesh &mesh = interface->mesh();
    for (const Index node : interface->dual().vertices)
      for (int c = 0; c < mesh.components; ++c)
        if (const int dof = mesh.dofs[node * mesh.components + c]; dof >= 0) dofs.push_back(dof);
  }
  return dofs;
}

/// NodalTrace::held_.
std::vector<bool> held_by(const ReducedModel &model, const Contact &contact) {
  const Vector rows = model.contact.dual_basis.rowwise().lpNorm<Eigen::Infinity>();
  if (!model.contact.law || rows.minCoeff() > 0) return {};
  std::vector<bool> held;
  if (model.evaluates_contact()) {
    held.assign(model.contact_dofs(), false);
    for (const int dof : model.contact.law->condensed.dofs)
      held[dof] = true;
    return held;
  }
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i)
    for (Index node = 0; node < contact.interfaces[i]->dual().nodes(); ++node)
      held.push_back(rows[contact.first_row[i] + node] > 0);
  return held;
}

/// Throws bad_input where displacements are imposed by boundaries that the scene does not have.
void check_imposed_by(const ReducedModel &model, const Scene &scene) {
  std::vector<const std::vector<int> *> lists{&model.fields.imposed_by};
  for (const InterfaceModel &interface : model.contact.interfaces)
    lists.push_back(&interface.mesh.imposed_by);
  for (const AffineTerms *terms : {&model.body.f, &model.contact.g, &model.body.imposed_energy})
    for (const SampleMesh &sample : terms->samples)
      lists.push_back(&sample.imposed_by);
  for (const std::vector<int> *list : lists)
    if (std::ranges::any_of(*list, [&](int b) { return b < -1 || b >= std::ssize(scene.fixed); }))
      throw bad_input("the imposed displacements of the model are not those of its scene in this "
                      "build");
}

/// Throws bad_input where cells are of materials that the scene does not have.
void check_materials(const ReducedModel &model, const Scene &scene) {
  std::vector<const std::vector<int> *> lists{&model.fields.materials};
  for (const InterfaceModel &interface : model.contact.interfaces)
    lists.push_back(&interface.mesh.materials);
  for (const std::vector<int> *list : lists)
    if (std::ranges::any_of(*list, [&](int m) { return m >= std::ssize(scene.materials); }))
      throw bad_input("the materials of the model are not those of its scene in this build");
}

/// The options with the method of the model where they name none. Throws bad_input for one that
/// its queries do not have.
QueryOptions with_method(QueryOptions options, const ReducedModel &model, const Scene &scene) {
  const auto kept = model.made.settings.find("online_method");
  if (!options.method)
    options.method = online_method(kept == model.made.settings.end() ? "exact" : kept->second);
  const bool on_functions = model.contact.law && model.contact.law->on_functions();
  if (options.method == OnlineMethod::uzawa && !on_functions)
    throw bad_input("Uzawa's method is for models by -multiplier_reduction collocated: ask this "
                    "one by the method exact");
  if (options.method == OnlineMethod::kacanov && !(model.has_multipliers() && follows_state(scene)))
    throw bad_input("Kacanov's iteration is for multipliers of contact that follows the "
                    "displacement: ask this model by the method exact");
  if (options.method == OnlineMethod::newton && model.has_multipliers())
    throw bad_input(
        "Newton's method from rest is for models by Nitsche's method: ask this one by the "
        "method exact");
  return options;
}

/// ReducedAnswer::beyond_basis, added to a displacement at the contact dofs.
Vector with_beyond(const ReducedModel &model, const ReducedAnswer &solution, Vector at_contact) {
  if (solution.beyond_basis.size() > 0)
    at_contact(model.contact.law->condensed.dofs) += solution.beyond_basis;
  return at_contact;
}

std::vector<std::vector<int>> nodes_of(const ContactModel &contact) {
  std::vector<std::vector<int>> nodes;
  for (const InterfaceModel &interface : contact.interfaces)
    nodes.push_back(interface.nodes);
  return nodes;
}

} // namespace

NodalTrace::NodalTrace(const ReducedModel &model, const Contact &contact)
    : model_(model), held_(held_by(model, contact)) {
  if (model.contact.trace_dofs.empty()) {
    dofs_ = nodal_dofs(contact);
    trace_ = model.contact.trace(dofs_, Eigen::all);
    return;
  }
  dofs_.assign(model.contact.trace_dofs.begin(), model.contact.trace_dofs.end());
  trace_ = model.contact.trace;
  unknown_.assign(model.contact_dofs(), true);
  for (const Index dof : dofs_)
    unknown_[dof] = false;
}

Vector NodalTrace::displacement(const ReducedAnswer &solution) const {
  if (dofs_.empty()) return with_beyond(model_, solution, model_.contact.trace * solution.u);
  Vector at_contact = Vector::Zero(model_.contact_dofs());
  at_contact(dofs_) = trace_ * solution.u;
  return with_beyond(model_, solution, std::move(at_contact));
}

Vector NodalTrace::gap_left(const ContactOperators &operators, const Vector &displacement) const {
  Vector gap = operators.nodal_gap - operators.nodal_b * displacement;
  for (Index node = 0; node < gap.size() && !unknown_.empty(); ++node)
    for (SparseMatrix::InnerIterator entry(operators.nodal_b, node); entry; ++entry)
      if (unknown_[entry.col()]) gap[node] = std::numeric_limits<double>::infinity();
  return gap;
}

void NodalTrace::check_outside(const ContactOperators &operators, const Vector &gap) const {
  constexpr double touching = 1e-3; // of the largest gap without displacement
  if (held_.empty()) return;
  const double least = -touching * operators.nodal_gap.cwiseAbs().maxCoeff();
  const auto is_outside = [&](Index node) {
    if (!model_.evaluates_contact()) return !held_[node];
    for (SparseMatrix::InnerIterator entry(operators.nodal_b, node); entry; ++entry)
      if (entry.value() != 0 && !held_[entry.col()]) return true;
    return false;
  };
  for (Index node = 0; node < gap.size(); ++node)
    if (gap[node] < least && is_outside(node))
      throw failure("the bodies meet far from the nodes that the model has multipliers at: " +
                    std::string(keeps_more));
}

const std::vector<std::string> &online_method_names() {
  static const std::vector<std::string> names{"exact", "uzawa", "kacanov", "newton"};
  return names;
}

OnlineMethod online_method(const std::string &name) {
  const std::vector<std::string> &names = online_method_names();
  const auto found = std::ranges::find(names, name);
  if (found == names.end())
    throw bad_input("the method of queries is '" + name + "': use one of " + joined(names));
  return static_cast<OnlineMethod>(found - names.begin());
}

OnlineSolver::OnlineSolver(const ReducedModel &model, const QueryOptions &options)
    : OnlineSolver(model, model.scene, options) {}

OnlineSolver::OnlineSolver(const ReducedModel &model, Scene scene, const QueryOptions &given)
    : model_(model), scene_(with_imposed_loads(std::move(scene))),
      imposed_energy_(rbvi::imposed_energy(scene_)), contact_(contact_of(model, scene_)),
      dual_basis_(model.contact.dual_basis.sparseView()), only_(given.only),
      cell_outputs_(model.outputs, scene_, only_),
      contact_shares_(contact_shares(scene_, model.outputs.cells, nodes_of(model.contact))) {
  check_terms_of(model.body.a, scene_.a, scene_.parameters, "a");
  check_terms_of(model.body.f, scene_.f, scene_.parameters, "f");
  check_imposed_by(model, scene_);
  check_materials(model, scene_);
  check_terms_of(model.body.imposed_energy, imposed_energy_, scene_.parameters,
                 "the imposed energy");
  if (contact_.dual_size() != model.contact.dual_basis.rows() ||
      has_multipliers(scene_) != model.has_multipliers() ||
      (model.evaluates_contact() == separable_contact(scene_) && model.has_multipliers()))
    throw bad_input("the contact of the model does not fit its scene in this build");
  const QueryOptions options = with_method(given, model, scene_);
  if (!model.has_multipliers()) {
    auto nitsche = std::make_unique<ReducedNitsche>(model, layer_of(contact_), options);
    nitsche_ = nitsche.get();
    method_ = std::move(nitsche);
    return;
  }
  trace_.emplace(model, contact_);
  if (model.certificate.by_law) column_laws_ = laws_of_columns(contact_, model.contact.dual_basis);
  if (model.contact.law)
    method_ = law_solver(model, scene_, contact_, options);
  else
    method_ = std::make_unique<ConeSolver>(model, scene_, contact_, options);
}

ReducedAnswer OnlineSolver::solve(const Mu &mu, bool extrapolate) {
  check_query(scene_, mu, extrapolate);
  return while_doing("solving the reduced problem at " + describe(scene_.parameters, mu), [&] {
    return with_imposed_energy(
        solve_balanced(*method_, model_, scene_, expand(scene_.parameters, mu)));
  });
}

ReducedAnswer OnlineSolver::near(const ReducedAnswer &from, const Mu &mu) {
  return while_doing("following the answer to " + describe(scene_.parameters, mu), [&] {
    const FullMu all = expand(scene_.parameters, mu);
    if (std::optional<ReducedAnswer> found = method_->near(from, all))
      return with_imposed_energy(std::move(*found));
    ReducedAnswer found = solve_balanced(*method_, model_, scene_, all);
    found.passes_kink = differs_in_contact(from.lambda, found.lambda);
    return with_imposed_energy(std::move(found));
  });
}

ReducedAnswer OnlineSolver::with_imposed_energy(ReducedAnswer answer) const {
  answer.energy += imposed_energy_at(answer.mu);
  return answer;
}

double OnlineSolver::imposed_energy_at(const FullMu &mu) const {
  const AffineTerms &imposed = model_.body.imposed_energy;
  if (imposed.size() == 0) return 0;
  return imposed.reduced.row(0).dot(affine_coefficients(imposed, imposed_energy_, scene_, mu));
}

Vector OnlineSolver::multiplier(const ReducedAnswer &solution) const {
  if (nitsche_) return nitsche_->multiplier(solution.mu, solution.u);
  return dual_basis_ * solution.lambda;
}

ContactOperators OnlineSolver::nodal_operators(const ReducedAnswer &solution,
                                               const Vector &lambda) const {
  if (model_.evaluates_gap()) return solution.contact;
  ContactOperators operators;
  assemble_nodal(contact_, solution.mu, {}, lambda, operators);
  return operators;
}

Vector OnlineSolver::contact_gap(const ReducedAnswer &solution) const {
  const ContactOperators operators = nodal_operators(solution, multiplier(solution));
  return trace_->gap_left(operators, trace_->displacement(solution));
}

Vector OnlineSolver::field(const ReducedAnswer &solution) const {
  if (model_.fields.basis.rows() == 0)
    throw failure("the model was read without its fields: no full field can be reconstructed");
  return field_of(scene_, model_.fields, solution);
}

Vector OnlineSolver::at_interface(const FullMu &mu, const Vector &columns,
                                  std::size_t interface) const {
  const InterfaceMesh &mesh = contact_.interfaces[interface]->mesh();
  Vector u = Vector::Zero(std::ssize(mesh.dofs));
  for (Index i = 0; i < u.size(); ++i)
    if (const int column = mesh.dofs[i]; column >= 0) u[i] = columns[column];
  if (!mesh.imposed_by.empty()) u += imposed_values(scene_, mu, mesh.points, mesh.imposed_by);
  return u;
}

Vector OnlineSolver::at_contact_dofs(const ReducedAnswer &solution) const {
  const std::vector<int> &dofs = model_.contact.trace_dofs;
  Vector known = model_.contact.trace * solution.u;
  if (dofs.empty()) return with_beyond(model_, solution, std::move(known));
  Vector all = Vector::Constant(model_.contact_dofs(), std::numeric_limits<double>::quiet_NaN());
  all(dofs) = known;
  return all;
}

Grid OnlineSolver::contact_grid(const ReducedAnswer &solution, std::size_t interface) const {
  const Index rows = contact_.interfaces[interface]->dual().size();
  return contact_fields(*contact_.interfaces[interface], solution.mu,
                        at_interface(solution.mu, at_contact_dofs(solution), interface),
                        multiplier(solution).segment(contact_.first_row[interface], rows));
}

void OnlineSolver::add_outputs_of_scene(const ReducedAnswer &solution, const Vector &lambda,
                                        const Vector &at_vertices, Outputs &outputs) const {
  const bool faces_surfaces = !scene_.small && !model_.evaluates_contact() &&
                              model_.contact.trace_dofs.empty() && scene_.components == scene_.dim;
  if (scene_.outputs.empty() && !faces_surfaces) return;
  Vector columns; // once for all interfaces
  const auto of_interface = [&](std::size_t interface) {
    if (columns.size() == 0) columns = at_contact_dofs(solution);
    return at_interface(solution.mu, columns, interface);
  };
  add_named_outputs(scene_, contact_, solution.mu,
                    {contact_shares_, of_interface, cell_outputs_.at(solution.mu, solution.u),
                     solution.least_pressure * std::max(0.0, lambda.maxCoeff()), only_},
                    lambda, outputs);
  if (faces_surfaces)
    add_gap_error(
        scene_, contact_, solution.mu,
        [&](std::size_t i) { return at_interface(solution.mu, at_vertices, i); }, lambda, outputs);
}

void OnlineSolver::add_bound(const ReducedAnswer &solution, const Vector &lambda,
                             Outputs &outputs) const {
  const auto any = [&](const std::vector<std::string> &names) {
    return std::ranges::any_of(names,
                               [&](const std::string &name) { return is_asked(only_, name); });
  };
  if (!model_.certificate.exists() || !any(names_of_bounds())) return;
  const bool forces =
      any({"normal_force_lower", "normal_force_upper", "reaction_lower", "reaction_upper"});
  const double imposed = imposed_energy_at(solution.mu);
  const std::optional<AnswerBound> bound =
      column_laws_ ? bound_by_law(model_, scene_, laws_at(*column_laws_, contact_, solution.mu),
                                  solution, imposed)
                   : bound_of(model_, scene_, contact_, solution, lambda, imposed, forces);
  if (!bound) return;
  const double size = std::max(bound->size, std::numeric_limits<double>::min());
  (bound->certified ? outputs.error_bound : outputs.error_indicator) = bound->error / size;
  const double images = image_count(scene_.mirrors);
  outputs.energy_norm = std::sqrt(images) * bound->size;
  const auto tell = [&](const char *output, const std::optional<AnswerBound::Interval> &interval) {
    const std::string name(output);
    if (!interval || !output_column(name).of(outputs)) return;
    for (const auto &[end, value] :
         {std::pair{"_lower", interval->lower}, {"_upper", interval->upper}})
      if (is_asked(only_, name + end)) outputs.named.push_back({name + end, images * value});
  };
  tell("energy", bound->energy);
  tell("normal_force", bound->normal_force);
  tell("reaction", bound->reaction);
}

void OnlineSolver::check_forces(const ReducedAnswer &solution) const {
  if (nitsche_)
    return rbvi::check_forces(layer_of(contact_), solution.mu, model_.contact.trace * solution.u);
  const Vector lambda = multiplier(solution);
  const ContactState state = nodal_operators(solution, lambda).state;
  rbvi::check_forces(scene_, contact_, solution.mu, state, lambda, nullptr);
}

Outputs OnlineSolver::outputs(const Mu &mu, const ReducedAnswer &solution) const {
  Outputs result;
  result.energy = image_count(scene_.mirrors) * solution.energy;
  tell(solution, result);
  const ValidationErrors &expected = expected_errors(model_);
  if (expected.count > 0 && in_box(scene_.parameters, mu)) {
    result.expected_error_u = expected.u_max;
    result.expected_error_lambda = std::max(expected.lambda_max, expected.tangential_max);
  }
  if (nitsche_) {
    nitsche_->outputs(solution.mu, solution.u, result);
    add_outputs_of_scene(solution, multiplier(solution), model_.contact.trace * solution.u, result);
    check_finite(result);
    return result;
  }
  const Vector lambda = multiplier(solution), at_vertices = trace_->displacement(solution);
  add_outputs_of_scene(solution, lambda, at_vertices, result);
  const ContactOperators operators = nodal_operators(solution, lambda);
  const Vector gap = trace_->gap_left(operators, at_vertices);
  trace_->check_outside(operators, gap);
  set_penetration(penetration_at(gap, operators.nodal_gap), result);
  const double least = solution.least_pressure * std::max(0.0, lambda.maxCoeff());
  contact_outputs(contact_, solution.mu, operators, lambda, least, result);
  add_bound(solution, lambda, result);
  check_finite(result);
  return result;
}

Vector field_of(const Scene &scene, const ModelFields &fields, const ReducedAnswer &solution) {
  Vector u = fields.basis * solution.u;
  const Vector given = imposed_at(scene, solution.mu, fields.points, fields.imposed_by);
  if (given.size() > 0) u += given;
  return u;
}

} // namespace rbvi
