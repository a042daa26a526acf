#include "rbvi/contact/friction.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

namespace rbvi {

FrictionBound friction_bound(const Friction &friction, const FullMu &all_parameters) {
  FrictionBound bound;
  const auto at_mu = [&](const std::function<Coefficient> &number, const char *what) {
    const double value = number(all_parameters);
    if (!(value >= 0))
      throw failure("the " + std::string(what) + " is " + short_number(value) +
                    ": it must not be negative");
    return value;
  };
  if (friction.adhesion) bound.pull = at_mu(friction.adhesion, "adhesion");
  if (friction.law == FrictionLaw::none) return bound;
  (friction.law == FrictionLaw::coulomb ? bound.coefficient : bound.threshold) =
      at_mu(friction.value, "friction coefficient or threshold");
  bound.only_in_contact = friction.only_in_contact;
  if (friction.limit) bound.limit = at_mu(friction.limit, "limit of friction");
  return bound;
}

void add_friction(const Friction &friction, ContactRecipe &recipe) {
  recipe.friction = friction.law;
  if (friction.adhesion) recipe.coefficients.push_back({"adhesion", friction.adhesion});
  if (friction.law == FrictionLaw::none) return;
  recipe.coefficients.push_back(
      {friction.law == FrictionLaw::coulomb ? "coefficient of friction" : "threshold of friction",
       friction.value});
  if (friction.limit) recipe.coefficients.push_back({"limit of friction", friction.limit});
}

} // namespace rbvi
