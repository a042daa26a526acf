#include "nitsche_part.hpp"

#include "basis_change.hpp"

namespace rbvi {

Index curve_cells(const ReducedModel &model) {
  Index count = 0;
  for (const InterfaceModel &interface : model.contact.interfaces)
    count += interface.mesh.count();
  return count;
}

void change_nitsche(const BasisChange &to, ReducedModel &model) {
  if (!model.contact.nitsche) return;
  NitscheModel &nitsche = *model.contact.nitsche;
  if (nitsche.rule == CurveRule::interpolated) change_rows(to, nitsche.starts);
  change_rows(to, nitsche.states);
  for (LayerTerms *terms : {&nitsche.consistency, &nitsche.contact_matrix, &nitsche.contact_vector,
                            &nitsche.friction_matrix, &nitsche.friction_vector})
    if (terms->size() > 0)
      terms->reduced =
          terms->columns.empty() ? to.rows(terms->reduced) : to.triangles(terms->reduced);
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
