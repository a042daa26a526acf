#include "catalogue.hpp"

#include "membrane_obstacle/scene.hpp"
#include "patch/scene.hpp"
#include "rigid_disk/scene.hpp"
#include "roller/scene.hpp"
#include "two_disks/scene.hpp"

namespace rbvi {

const Registry &catalogue() {
  static const Registry scenes =
      registry_of({membrane_obstacle(), two_disks(), rigid_disk(), roller(), patch()});
  return scenes;
}

Scene make_scene(const std::string &name, const SceneOptions &options) {
  return make_scene(entry_of(catalogue(), name), options);
}

} // namespace rbvi
