#include "nitsche_part.hpp"

#include "checks.hpp"
#include "rbvi/rom/model/packed.hpp"

#include <algorithm>

namespace rbvi {

namespace {

struct NamedTerms {
  const char *name;
  LayerTerms NitscheModel::*terms;
};
constexpr NamedTerms layer_terms[] = {{"nitsche/consistency", &NitscheModel::consistency},
                                      {"nitsche/contact_matrix", &NitscheModel::contact_matrix},
                                      {"nitsche/contact_vector", &NitscheModel::contact_vector},
                                      {"nitsche/friction_matrix", &NitscheModel::friction_matrix},
                                      {"nitsche/friction_vector", &NitscheModel::friction_vector}};

/// Cells beside the curves.
Index curve_cells(const ReducedModel &model) {
  Index count = 0;
  for (const InterfaceModel &interface : model.interfaces)
    count += interface.mesh.count();
  return count;
}

/// The terms of the first `size` of n columns.
LayerTerms leading_terms(const LayerTerms &terms, Index n, Index size) {
  LayerTerms result = terms;
  if (terms.size() == 0) return result;
  result.reduced = terms.columns.empty() ? Matrix(terms.reduced.topRows(size))
                                         : leading_triangles(terms.reduced, n, size);
  return result;
}

/// `entries`: of the reduced operator.
void check_layer_terms(const LayerTerms &terms, Index entries, Index dofs,
                       const std::string &name) {
  require_shape(terms.interpolation, terms.size(), terms.size(), name + "/interpolation");
  require_shape(terms.reduced, terms.size() == 0 ? terms.reduced.rows() : entries, terms.size(),
                name + "/reduced");
  require(static_cast<Index>(terms.rows.size()) == terms.size() &&
              (terms.columns.empty() || terms.columns.size() == terms.rows.size()),
          name + "/rows does not fit");
  require_indices(terms.rows, dofs, name + "/rows");
  require_indices(terms.columns, dofs, name + "/columns");
}

} // namespace

void check_nitsche(const ReducedModel &model) {
  if (!model.nitsche) return;
  const NitscheModel &nitsche = *model.nitsche;
  const Index cells = curve_cells(model), n = model.primal_size(), packed = n * (n + 1) / 2,
              dofs = model.contact_trace.rows();
  check_layer_terms(nitsche.consistency, packed, dofs, "nitsche/consistency");
  check_layer_terms(nitsche.contact_matrix, packed, dofs, "nitsche/contact_matrix");
  check_layer_terms(nitsche.contact_vector, n, dofs, "nitsche/contact_vector");
  check_layer_terms(nitsche.friction_matrix, packed, dofs, "nitsche/friction_matrix");
  check_layer_terms(nitsche.friction_vector, n, dofs, "nitsche/friction_vector");
  require(nitsche.rule >= CurveRule::empirical && nitsche.rule <= CurveRule::interpolated,
          "nitsche/rule is none that this build has");
  require_indices(nitsche.points, 4 * cells, "nitsche/points");
  require(std::is_sorted(nitsche.points.begin(), nitsche.points.end()),
          "nitsche/points are not in order");
  require_shape(nitsche.factors, static_cast<Index>(nitsche.points.size()), 1, "nitsche/factors");
  require(nitsche.rule != CurveRule::interpolated || nitsche.starts.rows() == n,
          "nitsche/starts does not fit");
  require_shape(nitsche.starts_mu, model.scene.parameters.size(), nitsche.starts.cols(),
                "nitsche/starts_mu");
  if (nitsche.states.size() > 0)
    require_shape(nitsche.states, n, nitsche.starts.cols(), "nitsche/states");
}

void keep_leading_nitsche(Index n, Index size, ReducedModel &model) {
  if (!model.nitsche) return;
  NitscheModel &kept = *model.nitsche;
  if (kept.rule == CurveRule::interpolated) kept.starts = Matrix(kept.starts.topRows(size));
  if (kept.states.size() > 0) kept.states = Matrix(kept.states.topRows(size));
  for (const auto &[name, member] : layer_terms)
    kept.*member = leading_terms(kept.*member, n, size);
}

void write_nitsche(H5Writer &file, const ReducedModel &model) {
  const std::optional<NitscheModel> &nitsche = model.nitsche;
  file.write("nitsche/rule", nitsche ? static_cast<int>(nitsche->rule) : -1);
  if (!nitsche) return;
  file.write("nitsche/points", nitsche->points);
  file.write("nitsche/factors", nitsche->factors);
  file.write("nitsche/starts", nitsche->starts);
  file.write("nitsche/starts_mu", nitsche->starts_mu);
  file.write("nitsche/states", nitsche->states);
  for (const auto &[name, member] : layer_terms) {
    const LayerTerms &terms = (*nitsche).*member;
    const std::string group = name;
    file.write(group + "/reduced", terms.reduced);
    file.write(group + "/interpolation", terms.interpolation);
    file.write(group + "/rows", terms.rows);
    file.write(group + "/columns", terms.columns);
    file.write(group + "/error", terms.error);
  }
}

void read_nitsche(const H5Reader &file, ReducedModel &model) {
  const int rule = file.integer("nitsche/rule");
  if (rule < 0) return;
  NitscheModel &nitsche = model.nitsche.emplace();
  nitsche.rule = static_cast<CurveRule>(rule);
  nitsche.points = file.ints("nitsche/points");
  nitsche.factors = file.vector("nitsche/factors");
  nitsche.starts = file.matrix("nitsche/starts");
  nitsche.starts_mu = file.matrix("nitsche/starts_mu");
  nitsche.states = file.matrix("nitsche/states");
  for (const auto &[name, member] : layer_terms) {
    LayerTerms &terms = nitsche.*member;
    const std::string group = name;
    terms.reduced = file.matrix(group + "/reduced");
    terms.interpolation = file.matrix(group + "/interpolation");
    terms.rows = file.ints(group + "/rows");
    terms.columns = file.ints(group + "/columns");
    terms.error = file.number(group + "/error");
  }
}

const std::vector<std::string> &curve_rule_names() {
  static const std::vector<std::string> names{"empirical", "full", "interpolated"};
  return names;
}

std::string describe_curve(const ReducedModel &model) {
  const NitscheModel &nitsche = *model.nitsche;
  const auto number = [](auto size) { return std::to_string(size); };
  if (nitsche.rule == CurveRule::interpolated)
    return "terms: B^n " + number(nitsche.contact_matrix.size()) + ", Theta^n " +
           number(nitsche.contact_vector.size()) + ", B^tau " +
           number(nitsche.friction_matrix.size()) + ", Theta^tau " +
           number(nitsche.friction_vector.size());
  const std::size_t all = 4 * static_cast<std::size_t>(curve_cells(model));
  const bool few = nitsche.rule == CurveRule::empirical;
  return number(few ? nitsche.points.size() : all) + " of " + number(all) + " Gauss points";
}

Index consistency_terms(const ReducedModel &model) {
  return model.nitsche->consistency.size();
}

std::string nitsche_name(const ReducedModel &model) {
  return "nitsche " + curve_rule_names()[static_cast<std::size_t>(model.nitsche->rule)];
}

} // namespace rbvi
