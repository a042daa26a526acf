// The part of check_functions that looks at kernels.
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// Throws bad_input for an exact term whose kernel depends on parameters, or fills another number
/// of values than the scene has: assembled without parameters it might end the program.
void check_exact_kernels(const Scene &scene);

} // namespace rbvi
