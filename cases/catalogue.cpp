// The scenes of this build: a line each; and the functions that model files can name.
#include "membrane_obstacle/scene.hpp"
#include "patch/scene.hpp"
#include "rigid_disk/scene.hpp"
#include "roller/scene.hpp"
#include "two_disks/scene.hpp"

#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/facet_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"

namespace rbvi {

const std::vector<SceneEntry> &scene_catalogue() {
  static const std::vector<SceneEntry> catalogue{membrane_obstacle(), two_disks(), rigid_disk(),
                                                 roller(), patch()};
  return catalogue;
}

const FunctionLibrary &function_library() {
  static const FunctionLibrary library = [] {
    FunctionLibrary all = common_functions();
    const auto add = [&](const FunctionLibrary &more) {
      all.insert(all.end(), more.begin(), more.end());
    };
    add(scalar_functions());
    add(elastic_functions());
    add(facet_functions());
    for (const SceneEntry &scene : scene_catalogue())
      add(scene.functions);
    return all;
  }();
  return library;
}

} // namespace rbvi
