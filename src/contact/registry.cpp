#include "rbvi/contact/registry.hpp"

#include "rbvi/contact/nitsche_support.hpp"
#include "rbvi/contact/obstacle.hpp"
#include "rbvi/contact/pair.hpp"
#include "rbvi/contact/surfaces.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/formula.hpp"
#include "rbvi/element/axisymmetric_forms.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/facet_forms.hpp"
#include "rbvi/element/scalar_forms.hpp"

namespace rbvi {

Registry registry_of(std::vector<SceneEntry> scenes) {
  Registry registry{std::move(scenes), {obstacle_kind(), two_bodies_kind()}, common_functions()};
  for (const ContactKind &kind : rigid_kinds())
    registry.kinds.push_back(kind);
  const auto add = [&](const FunctionLibrary &more) {
    registry.functions.insert(registry.functions.end(), more.begin(), more.end());
  };
  for (const FunctionLibrary &more :
       {scalar_functions(), elastic_functions(), axisymmetric_functions(), facet_functions(),
        formula_functions(), surface_functions()})
    add(more);
  for (const SceneEntry &scene : registry.scenes)
    add(scene.functions);
  return registry;
}

ContactRecipe contact_in(const Stored &stored) {
  const Record &record = stored.record;
  const std::vector<ContactKind> none;
  for (const ContactKind &kind : stored.registry == nullptr ? none : stored.registry->kinds)
    if (kind.name == record.name && kind.version == record.version) return kind.make(stored);
  throw bad_input("contact '" + record.name + "' version " + std::to_string(record.version) +
                  " is not in this build: make the model again, or use the build that made it");
}

} // namespace rbvi
