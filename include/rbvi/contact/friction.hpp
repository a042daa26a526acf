// The law of friction, and of adhesion, that a scene poses on an interface.
//
// Adhesion is a constant pull: the pressure p is at least -a, and where there is a gap it is -a, at
// any distance. The multiplier is x_n = p + a >= 0, and the pull a load, of the scene, so that
// whatever solves contact without adhesion solves it with one. Outputs say p. Coulomb's bound
// follows max(p, 0).
#pragma once

#include "rbvi/core/contact_recipe.hpp"
#include "rbvi/core/functions.hpp"
#include "rbvi/method/node_laws.hpp"

namespace rbvi {

/// |sigma_tau| <= bound: Tresca's threshold (a pressure), or Coulomb's coefficient times the normal
/// pressure, up to a limit where there is one.
struct Friction {
  FrictionLaw law = FrictionLaw::none;
  std::function<Coefficient> value;      ///< threshold or coefficient, >= 0
  bool only_in_contact = false;          ///< Tresca: zero where a node carries no pressure
  std::function<Coefficient> limit{};    ///< of Coulomb's bound, a pressure >= 0; empty: none
  std::function<Coefficient> adhesion{}; ///< a, a pressure >= 0; empty: none
};

/// The bound at one mu. Throws failure, naming the value, for a negative one.
FrictionBound friction_bound(const Friction &friction, const FullMu &all_parameters);

/// Gives a recipe the law, and the bound among its coefficients.
void add_friction(const Friction &friction, ContactRecipe &recipe);

} // namespace rbvi
