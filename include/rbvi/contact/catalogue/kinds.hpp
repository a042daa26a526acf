// The kinds of contact of this build: a line each.
#pragma once

#include "rbvi/core/contact_recipe.hpp"

namespace rbvi {

const std::vector<ContactKind> &contact_kinds();

/// The contact of a record. Throws bad_input for a kind that this build does not have, or has in
/// another version.
ContactRecipe contact_in(const Record &record);

} // namespace rbvi
