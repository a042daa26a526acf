#include "rbvi/contact/catalogue/kinds.hpp"

#include "rbvi/contact/half_plane/half_plane.hpp"
#include "rbvi/contact/large_pair/large_pair.hpp"
#include "rbvi/contact/nitsche/nitsche_support.hpp"
#include "rbvi/contact/obstacle/obstacle.hpp"
#include "rbvi/contact/pair/pair.hpp"
#include "rbvi/contact/support/support.hpp"
#include "rbvi/contact/surface/surface.hpp"
#include "rbvi/core/error.hpp"

#include <algorithm>

namespace rbvi {

const std::vector<ContactKind> &contact_kinds() {
  static const std::vector<ContactKind> kinds{
      obstacle_kind(),        two_bodies_kind(),      rigid_support_kind(),
      nitsche_support_kind(), half_plane_kind(),      nitsche_half_plane_kind(),
      rigid_surface_kind(),   nitsche_surface_kind(), deformed_bodies_kind()};
  return kinds;
}

ContactRecipe contact_in(const Record &record) {
  const auto found = std::ranges::find_if(contact_kinds(), [&](const ContactKind &kind) {
    return kind.name == record.name && kind.version == record.version;
  });
  if (found == contact_kinds().end())
    throw bad_input("contact '" + record.name + "' version " + std::to_string(record.version) +
                    " is not in this build: make the model again, or use the build that made it");
  return found->make(record);
}

} // namespace rbvi
