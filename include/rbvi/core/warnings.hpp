// What an answer tells of its own accuracy: too few nodes in contact, contact at an end of its
// boundary, strains that small kinematics are not for.
#pragma once

#include "rbvi/core/outputs.hpp"

namespace rbvi {

/// What is not accurate in this answer because contact reaches the end of its boundary, because so
/// few nodes are in contact, or stick, at the interface where that is worst, or because none is
/// though the bodies overlap, and how far it may be off; empty: nothing.
std::string resolution_warning(const Outputs &outputs);

/// A strain or a rotation, in radians, that linear elasticity is not for.
constexpr double large_strain = 0.3;

/// Why small kinematics do not hold at this answer; empty: they do.
std::string validity_warning(const Outputs &outputs);

/// The warnings of several answers.
struct ResolutionTally {
  long all = 0;     ///< answers
  long at_ends = 0; ///< where contact reaches the end of its boundary
  long coarse = 0;  ///< others with a warning
  long invalid = 0; ///< where small kinematics do not hold
  long held = 0;    ///< where imposed values hold nodes below a surface
  std::string first_end, first, first_invalid, first_held; ///< the first warning of each
  void add(const Outputs &outputs);
  /// One line for each of these, where there are any. `answers`: what they are called.
  void print(std::ostream &out, const char *answers = "answers") const;
};

} // namespace rbvi
