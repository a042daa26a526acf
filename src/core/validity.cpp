#include "rbvi/core/validity.hpp"

#include "../../cases/membrane_obstacle/scene.hpp"
#include "../../cases/rigid_disk/scene.hpp"
#include "rbvi/core/error.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace rbvi {

namespace {

/// Ranges of several parameters at a time, of the scenes that have some.
struct JointRange {
  const char *scene;
  void (*check)(const Mu &all);
};
constexpr JointRange joint_ranges[] = {{"membrane_obstacle", check_disc_in_square},
                                       {"rigid_disk", check_indentation}};

std::string text(double value) {
  std::ostringstream out;
  out.precision(15);
  out << value;
  return out.str();
}

bool inside(const Range &range, double value) {
  return value >= range.lower && value <= range.upper;
}

} // namespace

std::string describe(const Range &range) {
  const bool below = std::isfinite(range.lower), above = std::isfinite(range.upper);
  std::ostringstream out;
  out.precision(15);
  if (below && above)
    out << '[' << range.lower << ", " << range.upper << ']';
  else if (below)
    out << "at least " << range.lower;
  else if (above)
    out << "at most " << range.upper;
  else
    out << "any number";
  return out.str();
}

void check_range(const Range &range, double value, const std::string &what) {
  if (!inside(range, value))
    throw bad_input(what + " is " + text(value) + ": its range of validity is " + describe(range));
}

void check_together(const Scene &scene, const Mu &all) {
  for (const JointRange &joint : joint_ranges)
    if (scene.name == joint.scene) joint.check(all);
}

void check_query(const Scene &scene, const Mu &mu, bool allow_outside) {
  check_mu(scene.parameters, mu, allow_outside);
  if (allow_outside) check_together(scene, expand(scene.parameters, mu));
}

void check_box(const Scene &scene) {
  const ParameterSpace &space = scene.parameters;
  for (int i = 0; i < static_cast<int>(space.all.size()); ++i) {
    const Parameter &p = space.all[static_cast<std::size_t>(i)];
    const bool is_free = std::find(space.free.begin(), space.free.end(), i) != space.free.end();
    if (!is_free) check_range(p.valid, p.value, "parameter " + p.name);
    if (is_free && !(inside(p.valid, p.lower) && inside(p.valid, p.upper) && p.lower < p.upper))
      throw bad_input("parameter " + p.name + " is freed in [" + text(p.lower) + ", " +
                      text(p.upper) + "]: its range of validity is " + describe(p.valid));
  }
  for (unsigned corner = 0; corner < 1U << space.free.size(); ++corner) {
    Mu mu;
    for (int i = 0; i < space.size(); ++i)
      mu.push_back((corner >> i & 1U) != 0 ? space.at(i).upper : space.at(i).lower);
    while_doing("checking the corner " + describe(space, mu) + " of the box",
                [&] { check_together(scene, expand(space, mu)); });
  }
}

} // namespace rbvi
