// Two bodies that meet along two curves: the operators of contact_pair.hpp at mu, the curves mapped
// by h(mu), the motion of the scene taken into both gaps.
#pragma once

#include "rbvi/contact/contact_pair.hpp"
#include "rbvi/contact/interface.hpp"

namespace rbvi {

/// The partner of a point of the slave (upper) curve is the point of the master (lower) one below
/// it; the gap is measured along e_y (2.49). Of degree 2 Scene::snap brings the middles of their
/// edges onto the curves.
struct Pair {
  std::string slave, master; ///< boundaries
  PairDiscretisation discretisation;
};

ContactRecipe two_bodies(Pair pair);

/// "two_bodies" in files.
ContactKind two_bodies_kind();

} // namespace rbvi
