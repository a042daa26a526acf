#include "rbvi/contact/friction.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

namespace rbvi {

FrictionBound friction_bound(const Friction &friction, const FullMu &all_parameters) {
  FrictionBound bound;
  if (friction.law == FrictionLaw::none) return bound;
  const double value = friction.value(all_parameters);
  if (!(value >= 0))
    throw failure("the friction coefficient or threshold is " + short_number(value) +
                  ": it must not be negative");
  (friction.law == FrictionLaw::coulomb ? bound.coefficient : bound.threshold) = value;
  bound.only_in_contact = friction.only_in_contact;
  return bound;
}

} // namespace rbvi
