// Where the tests of a case are.
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// The scene with all parameters free, so that one problem serves all tests.
Scene with_all_free(Scene scene);

/// All parameters: those of the test, the others as they are.
Mu place_of(const SceneTest &test, const ParameterSpace &space);

} // namespace rbvi
