// The scenes of this build: a line each.
#include "membrane_obstacle/scene.hpp"
#include "patch/scene.hpp"
#include "rigid_disk/scene.hpp"
#include "roller/scene.hpp"
#include "two_disks/scene.hpp"

namespace rbvi {

const std::vector<SceneEntry> &scene_catalogue() {
  static const std::vector<SceneEntry> catalogue{membrane_obstacle(), two_disks(), rigid_disk(),
                                                 roller(), patch()};
  return catalogue;
}

} // namespace rbvi
