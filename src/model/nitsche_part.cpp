#include "nitsche_part.hpp"

#include "rbvi/model/packed.hpp"

namespace rbvi {

namespace {

/// The terms of the first `size` of n columns.
LayerTerms leading_terms(const LayerTerms &terms, Index n, Index size) {
  LayerTerms result = terms;
  if (terms.size() == 0) return result;
  result.reduced = terms.columns.empty() ? Matrix(terms.reduced.topRows(size))
                                         : leading_triangles(terms.reduced, n, size);
  return result;
}

} // namespace

Index curve_cells(const ReducedModel &model) {
  Index count = 0;
  for (const InterfaceModel &interface : model.contact.interfaces)
    count += interface.mesh.count();
  return count;
}

void keep_leading_nitsche(Index n, Index size, ReducedModel &model) {
  if (!model.contact.nitsche) return;
  NitscheModel &kept = *model.contact.nitsche;
  if (kept.rule == CurveRule::interpolated) kept.starts = Matrix(kept.starts.topRows(size));
  if (kept.states.size() > 0) kept.states = Matrix(kept.states.topRows(size));
  for (LayerTerms *terms : {&kept.consistency, &kept.contact_matrix, &kept.contact_vector,
                            &kept.friction_matrix, &kept.friction_vector})
    *terms = leading_terms(*terms, n, size);
}

const std::vector<std::string> &curve_rule_names() {
  static const std::vector<std::string> names{"empirical", "full", "interpolated"};
  return names;
}

std::string describe_curve(const ReducedModel &model) {
  const NitscheModel &nitsche = *model.contact.nitsche;
  const auto number = [](auto size) { return std::to_string(size); };
  if (nitsche.rule == CurveRule::interpolated) {
    const std::string friction = "B^tau " + number(nitsche.friction_matrix.size());
    const bool joint = nitsche.contact_matrix.size() == 0 && nitsche.friction_matrix.size() > 0;
    return "terms: B^n " + (joint ? "+ " + friction : number(nitsche.contact_matrix.size())) +
           ", Theta^n " + number(nitsche.contact_vector.size()) + (joint ? "" : ", " + friction) +
           ", Theta^tau " + number(nitsche.friction_vector.size());
  }
  const std::size_t all = 4 * static_cast<std::size_t>(curve_cells(model));
  const bool few = nitsche.rule == CurveRule::empirical;
  return number(few ? nitsche.points.size() : all) + " of " + number(all) + " Gauss points";
}

Index consistency_terms(const ReducedModel &model) {
  return model.contact.nitsche->consistency.size();
}

std::string nitsche_name(const ReducedModel &model) {
  return "nitsche " + curve_rule_names()[static_cast<std::size_t>(model.contact.nitsche->rule)];
}

} // namespace rbvi
