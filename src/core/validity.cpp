#include "rbvi/core/validity.hpp"

#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace rbvi {

namespace {

bool inside(const Range &range, double value) {
  return value >= range.lower && value <= range.upper;
}

/// Without the round-off of a bound that was computed.
std::string bound(double value) {
  return shortest_number(std::strtod(formatted("%.12g", value).c_str(), nullptr));
}

/// Throws bad_input where a coefficient of a, f, an imposed displacement or a contact interface is
/// not finite.
void check_all_coefficients(const Scene &scene, const FullMu &all) {
  for (const Sum *sum : {&scene.a, &scene.f})
    check_coefficients(*sum, scene.parameters, all);
  for (const FixedBoundary &boundary : scene.fixed)
    for (const ImposedTerm &value : boundary.values)
      if (value.theta) check_coefficients({exact_term({}, *value.theta)}, scene.parameters, all);
  check_contacts(scene, all);
}

} // namespace

std::string describe(const Range &range) {
  const bool below = std::isfinite(range.lower), above = std::isfinite(range.upper);
  const std::string lower = bound(range.lower), upper = bound(range.upper);
  if (below && above) return std::string("[").append(lower).append(", ").append(upper).append("]");
  if (below) return std::string("at least ").append(lower);
  if (above) return std::string("at most ").append(upper);
  return "any number";
}

void check_range(const Range &range, double value, const std::string &what) {
  if (!inside(range, value))
    throw bad_input(what + " is " + shortest_number(value) + ": its range of validity is " +
                    describe(range));
}

void check_contacts(const Scene &scene, const FullMu &all) {
  for (const ContactRecipe &contact : scene.contacts)
    for (const ContactCoefficient &coefficient : contact.coefficients)
      if (!std::isfinite(coefficient.value(all)))
        throw bad_input("the " + coefficient.name + " of " + described(contact) +
                        " is not finite at " + describe(scene.parameters, all));
}

void check_together(const Scene &scene, const FullMu &all) {
  if (scene.check_parameters) scene.check_parameters(all);
  check_all_coefficients(scene, all);
}

void check_set(const Scene &scene, const std::vector<Mu> &set) {
  for (const Mu &mu : set)
    check_all_coefficients(scene, expand(scene.parameters, mu));
}

void check_query(const Scene &scene, const Mu &mu, bool allow_outside) {
  check_mu(scene.parameters, mu, allow_outside);
  const FullMu all = expand(scene.parameters, mu);
  if (allow_outside)
    check_together(scene, all);
  else
    check_contacts(scene, all);
}

void check_box(const Scene &scene) {
  const ParameterSpace &space = scene.parameters;
  for (int i = 0; i < static_cast<int>(space.all.size()); ++i) {
    const Parameter &p = space.all[i];
    const bool is_free = std::find(space.free.begin(), space.free.end(), i) != space.free.end();
    if (!is_free) check_range(p.valid, p.value, "parameter " + p.name);
    if (is_free && !(inside(p.valid, p.lower) && inside(p.valid, p.upper) && p.lower < p.upper))
      throw bad_input("parameter " + p.name + " is freed in [" + shortest_number(p.lower) + ", " +
                      shortest_number(p.upper) + "]: its range of validity is " +
                      describe(p.valid));
  }
  for (unsigned long bits = 0; bits < 1UL << space.free.size(); ++bits) {
    const Mu mu = corner(space, bits);
    while_doing("checking the corner " + describe(space, mu) + " of the box",
                [&] { check_together(scene, expand(space, mu)); });
  }
}

} // namespace rbvi
