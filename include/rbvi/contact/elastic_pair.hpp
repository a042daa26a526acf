// What scenes of two elastic bodies in contact share: the same material, displacements of
// degree 1 or 2 in the plane, contact between the boundaries "slave" and "master".
#pragma once

#include "rbvi/contact/contact_pair.hpp"

#include <array>

namespace rbvi {

/// The options multiplier, integration, kinematics, degree (by default the one given), young and
/// poisson_ratio, then the scene's own.
std::vector<SceneOption> elastic_pair_options(int degree, const std::vector<SceneOption> &own);

/// What the options multiplier and integration say.
PairDiscretisation pair_discretisation(const SceneOptions &options);

/// Sets dimension, components, degree, material, a, v_product and the pair as these options say. a
/// does not depend on the parameters: right where h(mu) moves each body by a similarity.
/// `closed_ends`: Pair::closed_ends.
void set_elastic_pair(const SceneOptions &options, std::array<bool, 2> closed_ends, Scene &scene);

} // namespace rbvi
