#include "rbvi/core/warnings.hpp"

#include "rbvi/core/text.hpp"

#include <algorithm>

namespace rbvi {

namespace {

std::string end_warning(const std::string &who) {
  return who + ", beside which the body would touch too: a smaller indentation, offset or "
               "load, or a scene with a wider contact boundary";
}

/// Of one answer with such nodes: on which contact they are deepest.
std::string held_warning(const Outputs &outputs) {
  const auto deepest = std::ranges::max_element(outputs.interfaces, {}, &Outputs::held_depth);
  const Outputs &one = deepest == outputs.interfaces.end() ? outputs : *deepest;
  const double nodes = one.held_nodes.value_or(0);
  return (one.name.empty() ? "" : one.name + ": ") + "imposed values hold " + short_number(nodes) +
         (nodes == 1 ? " node" : " nodes") + " of the contact boundary up to " +
         short_number(one.held_depth.value_or(0)) +
         " below the surface: contact cannot move them and carries nothing there; max_penetration "
         "counts them";
}

/// Of one answer that has such ends: "contact reaches ...", of several interfaces with the name.
std::string end_of(const Outputs &outputs) {
  const auto at_end = std::ranges::find_if(
      outputs.interfaces, [](const Outputs &one) { return one.ends_in_contact.value_or(0) > 0; });
  return (at_end == outputs.interfaces.end() ? "" : at_end->name + ": ") +
         "contact reaches the end of its boundary";
}

/// Nitsche reduced, with contact that is at no training parameter: the model's points and modes see
/// another one, which the whole curve tells. Where they see it, what is left of it is round-off, or
/// of the size of the errors that were measured.
std::string unseen_warning(const Outputs &outputs) {
  constexpr double least = 1e-3, times = 10;
  const double left = outputs.quadrature_residual.value_or(0);
  const double measured =
      std::max(outputs.expected_error_u.value_or(1), outputs.expected_error_lambda.value_or(1));
  if (!(left > std::max(least, times * measured))) return "";
  return "quadrature_residual is " + short_number(left) + ", where errors of " +
         formatted("%.1e", measured) +
         " were measured: contact is not as at the training parameters, and errors are larger than "
         "printed; train with parameters nearby";
}

/// Of one interface.
std::string zone_warning(const Outputs &outputs) {
  // Measured on rigid_disk (its README): with 7 nodes in contact forces are 3e-3 off and the peak
  // 6e-2, with 9 they are 3e-4 and 1e-2. With 5 sticking nodes the tangential force is 2e-3 off,
  // with fewer by up to 1.5 times the share of one node, whose stress is undecided where the slip
  // turns.
  constexpr double fewest_in_contact = 9, fewest_that_stick = 5;
  const double contact = outputs.contact_nodes.value_or(0);
  // Where all nodes are in contact it has no edge that the mesh could miss, and where all slip in
  // one direction the slip does not turn.
  const bool narrow =
      contact > 0 && contact < fewest_in_contact && outputs.free_nodes.value_or(1) > 0;
  const bool slips =
      contact > 0 && outputs.stick_nodes && *outputs.stick_nodes < fewest_that_stick &&
      outputs.tangential_force.value_or(0) > 0 && outputs.slip_directions.value_or(2) > 1;
  constexpr double far_from_law = 0.2;
  if (!narrow && !slips) {
    if (!(contact > 0) || outputs.law_error_normal.value_or(0) < far_from_law) return "";
    return "law_error_normal is " + short_number(*outputs.law_error_normal) +
           ": the pressure is that far from the law of contact; a finer mesh tells (-mesh_refine)";
  }
  std::string text = "only " + short_number(contact) + " nodes are in contact";
  if (slips)
    text = "only " + short_number(*outputs.stick_nodes) + " of " + short_number(contact) +
           " nodes in contact stick";
  text += ": ";
  if (narrow) text += "forces may be off by 3e-3 or more, pressures and widths by 0.1";
  const bool rubs = slips || (outputs.stick_nodes.value_or(contact) < fewest_that_stick &&
                              outputs.tangential_force.value_or(0) > 0);
  if (narrow && rubs) text += ", and ";
  if (rubs)
    text += std::string(slips ? "where the slip turns, " : "") + "tangential_force may be off by " +
            formatted("%.1e", 1.5 / contact);
  return text + "; a finer mesh tells (-mesh_refine)";
}

} // namespace

std::string resolution_warning(const Outputs &outputs) {
  if (outputs.ends_in_contact.value_or(0) > 0) return end_warning(end_of(outputs));
  if (const std::string warning = unseen_warning(outputs); !warning.empty()) return warning;
  if (outputs.overlap && outputs.contact_nodes == 0)
    return "the bodies overlap by " + short_number(*outputs.overlap) +
           " between nodes, and no multiplier carries a pressure: contact is narrower than the "
           "mesh "
           "sees, and the forces of this answer are zero; a finer mesh tells (-mesh_refine)";
  for (const Outputs &one : outputs.interfaces)
    if (const std::string warning = zone_warning(one); !warning.empty())
      return one.name + ": " + warning;
  return outputs.interfaces.empty() ? zone_warning(outputs) : "";
}

std::string validity_warning(const Outputs &outputs) {
  constexpr double most_error = 0.05, most_strained = 0.01;
  std::string text;
  if (outputs.gap_error.value_or(0) > most_error)
    text = "gaps between the deformed bodies differ from those of small kinematics by " +
           formatted("%.0f", 100 * *outputs.gap_error) +
           " % of the largest approach: use kinematics: large";
  else if (outputs.strained.value_or(0) > most_strained)
    text = "strains or rotations are above " + short_number(large_strain) + " in " +
           formatted("%.0f", 100 * *outputs.strained) +
           " % of the body, where small kinematics do not hold: move less, or kinematics: large "
           "if they are of contact alone";
  return text.empty() ? text : text + " (small: yes in the case silences this)";
}

void ResolutionTally::add(const Outputs &outputs) {
  const std::string warning = resolution_warning(outputs), invalidity = validity_warning(outputs);
  ++all;
  if (!invalidity.empty() && invalid++ == 0) first_invalid = invalidity;
  if (outputs.held_nodes && held++ == 0) first_held = held_warning(outputs);
  const bool at_end = outputs.ends_in_contact.value_or(0) > 0;
  if (warning.empty() || (at_end ? at_ends : coarse)++ > 0) return;
  (at_end ? first_end : first) = warning;
}

void ResolutionTally::print(std::ostream &out, const char *answers) const {
  if (at_ends > 0)
    out << "warning: "
        << (all == 1 ? first_end
                     : end_warning(std::to_string(at_ends) + " of " + std::to_string(all) + ' ' +
                                   answers + " touch an end of the contact boundary"))
        << '\n';
  for (const auto &[count, text] :
       {std::pair{coarse, first}, {invalid, first_invalid}, {held, first_held}}) {
    if (count == 0) continue;
    out << "warning: " << text;
    if (count > 1) out << " (the first of " << count << " such " << answers << ')';
    out << '\n';
  }
}

} // namespace rbvi
