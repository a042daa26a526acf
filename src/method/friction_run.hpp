// The way to an answer with friction, as problems that differ in q alone share it.
#pragma once

#include "friction_laws.hpp"
#include "rbvi/method/several_answers.hpp"

#include <optional>
#include <set>
#include <string>

namespace rbvi::friction {

/// What problems that differ in q alone hand on.
struct Kept {
  std::set<std::string> known;    ///< keys of active sets on the way to answers to the last q
  std::optional<System> system;   ///< in the plane, the last one of the laws themselves
  std::string key;                ///< of its sets
  std::optional<ActiveSets> sets; ///< of the last answer
};

/// The answer from `start` on, where some node has friction; `searches`: for another one.
FrictionAnswer run_friction(LazyColumns &h, const Vector &q, const NodeLaws &laws,
                            const FrictionOptions &options, Kept &kept, const Vector &start,
                            bool by_rule, bool searches);

} // namespace rbvi::friction
