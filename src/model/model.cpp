#include "rbvi/model/model.hpp"

#include "basis_change.hpp"
#include "model_fields.hpp"
#include "model_list.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/io/fields.hpp"
#include "rbvi/model/certificate.hpp"

#include <algorithm>

namespace rbvi {

namespace {

void require(bool holds, const std::string &what) {
  if (!holds) throw failure("the reduced model is inconsistent: " + what);
}

/// The store that checks what a list says of its fields.
struct FieldChecker {
  static constexpr bool reads = false, checks = true;
  template <class T> void operator()(const std::string &, const T &) const {}
  void operator()(const std::string &name, const Matrix &matrix, Shape shape) const;
  void operator()(const std::string &name, const std::vector<int> &indices, Indices said) const;
  void operator()(const std::string &name, int value, Between said) const;
  template <class Holds> void ask(const std::string &what, Holds &&holds) const {
    require(holds(), what);
  }
};

void FieldChecker::operator()(const std::string &name, const Matrix &matrix, Shape shape) const {
  const Index rows = shape.rows == any_size ? matrix.rows() : shape.rows,
              columns = shape.columns == any_size ? matrix.cols() : shape.columns;
  require(matrix.rows() == rows && matrix.cols() == columns,
          name + " is " + std::to_string(matrix.rows()) + " x " + std::to_string(matrix.cols()) +
              " instead of " + std::to_string(rows) + " x " + std::to_string(columns));
  require(matrix.allFinite(), name + " has an entry that is not finite");
}

void FieldChecker::operator()(const std::string &name, const std::vector<int> &indices,
                              Indices said) const {
  require(said.count == any_size || std::ssize(indices) == said.count,
          name + " has " + std::to_string(indices.size()) + " entries instead of " +
              std::to_string(said.count));
  require(std::ranges::all_of(indices, [&](int i) { return i >= said.lowest && i < said.bound; }),
          name + " points outside " + std::to_string(said.lowest) + ".." +
              std::to_string(said.bound - 1));
}

void FieldChecker::operator()(const std::string &name, int value, Between said) const {
  require(value >= said.lowest && value <= said.highest,
          name + " is " + std::to_string(value) + " and not in " + std::to_string(said.lowest) +
              ".." + std::to_string(said.highest));
}

/// Matrices of so many rows, each a column of its entries column by column: their first r rows.
Matrix leading_rows(const Matrix &packed, Index rows, Index r) {
  Matrix result(packed.rows() / rows * r, packed.cols());
  for (Index j = 0; j < packed.rows() / rows; ++j)
    result.middleRows(j * r, r) = packed.middleRows(j * rows, r);
  return result;
}

/// Every part of a model that is one of its primal basis.
void change_basis(const BasisChange &to, ReducedModel &model) {
  BodyModel &body = model.body;
  body.a.reduced = to.triangles(body.a.reduced);
  change_rows(to, body.a_change.range);
  change_rows(to, body.f.reduced);
  change_rows(to, body.springs);
  Matrix &b = model.contact.b.reduced;
  if (const Index r = model.contact.generators, terms = b.cols(); b.size() > 0)
    b = to.side_by_side(b.reshaped(r, to.before() * terms)).reshaped(r * to.after(), terms);
  change_columns(to, model.contact.trace);
  change_columns(to, model.outputs.basis);
  change_columns(to, model.fields.basis);
  change_certificate(to, model.certificate);
  change_nitsche(to, model);
}

} // namespace

void check_model(const ReducedModel &model) {
  require(!model.contact.interfaces.empty(), "it has no contact interface");
  const int dim = model.contact.interfaces.front().mesh.dim;
  require(dim == 2 || dim == 3, "interfaces have neither 2 nor 3 dimensions");
  const FieldChecker checker;
  list_model(checker, model, model.fields.key);
  if (model.fields.points.rows() > 0 || model.fields.basis.rows() > 0)
    list_fields(checker, "fields/", model);
}

ReducedModel leading(const ReducedModel &model, int n, int r) {
  if (n < 1 || n > model.primal_size() || r < std::min(1, model.contact.generators) ||
      r > model.contact.generators)
    throw bad_input("no leading part of " + std::to_string(n) + " primal and " + std::to_string(r) +
                    " dual functions in a model of " + std::to_string(model.primal_size()) +
                    " and " + std::to_string(model.contact.generators));
  if (model.contact.law && r != model.contact.generators)
    throw bad_input("a model of contact with a support has no part with fewer multipliers");
  ReducedModel result = model;
  result.body.modes = std::min(n, model.body.modes);
  result.body.supremizers = n - result.body.modes;
  result.body.online_enriched = model.body.online_enriched && result.body.supremizers > 0;
  const bool fewer = n != model.primal_size(), fewer_dual = r != model.contact.generators;
  if (fewer) change_basis({model.primal_size(), n}, result);
  result.contact.generators = r;
  result.contact.free_modes =
      std::max(0, r - (model.contact.generators - model.contact.free_modes));
  if (fewer_dual) {
    if (model.contact.b.size() > 0)
      result.contact.b.reduced =
          leading_rows(result.contact.b.reduced, model.contact.generators, r);
    if (model.contact.g.size() > 0) result.contact.g.reduced = model.contact.g.reduced.topRows(r);
    result.contact.dual_basis = model.contact.dual_basis.leftCols(r);
  }
  if (fewer) result.fields.key.clear();
  if (fewer || fewer_dual) {
    result.contact.starts.resize(0, 0);
    result.made.validation_enriched = {};
    result.made.self_check = {};
  }
  if (fewer_dual || result.body.modes != model.body.modes) result.made.validation_decorrelated = {};
  return result;
}

const ValidationErrors &expected_errors(const ReducedModel &model) {
  const ValidationErrors &plain = model.made.validation_decorrelated;
  return model.body.supremizers == 0 && plain.count + plain.unanswered > 0
             ? plain
             : model.made.validation_enriched;
}

Vector spring_coefficients(const ReducedModel &model, const Scene &scene, const FullMu &mu) {
  Vector result(std::ssize(model.body.spring_terms));
  for (Index k = 0; k < result.size(); ++k)
    result[k] = coefficient_of(scene.a[model.body.spring_terms[k]], mu);
  return result;
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
  for (const InterfaceModel &interface : model.contact.interfaces)
    meshes.push_back(interface.mesh);
  return make_contact(scene, std::move(meshes));
}

Scene in_box_of(const Scene &stored, Scene scene) {
  const auto same = [](const Parameter &p, const Parameter &q) { return p.name == q.name; };
  if (!std::ranges::equal(scene.parameters.all, stored.parameters.all, same))
    throw bad_input("the parameters of the model are not those of scene " + stored.name +
                    " in this build");
  const ParameterSpace of_scene = std::exchange(scene.parameters, stored.parameters);
  for (std::size_t i = 0; i < of_scene.all.size(); ++i) {
    scene.parameters.all[i].valid = of_scene.all[i].valid;
    scene.parameters.all[i].choices = of_scene.all[i].choices;
  }
  scene.name = stored.name;
  check_box(scene);
  return scene;
}

ReducedModel rebased(const ReducedModel &model, const Matrix &c, int modes) {
  ReducedModel result = model;
  result.body.modes = modes;
  result.body.supremizers = static_cast<int>(c.cols()) - modes;
  result.fields.basis.resize(0, 0);
  change_basis(BasisChange(c), result);
  return result;
}

} // namespace rbvi
