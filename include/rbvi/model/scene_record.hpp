// What the online program needs of a scene, as a record: sizes, the map, the motion, the material,
// the contacts, the coefficients of exact terms and the kernels of the others. A model file holds
// it, and stands alone where every function has a name.
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

Record record_of(const Scene &scene);

/// The scene of a record, without its parameters, and without what the online program does not
/// need: mesh, boundaries without imposed values, and then kernels of exact terms. Throws bad_input
/// for a function or a kind of contact that the registry does not have.
Scene scene_in(const Stored &of);

/// A record as lines, path -> value, and back: a part under "map", "contact_0.height", ... its name
/// and version; numbers under "map:initial_gap", texts under "contact_0=slave". Throws bad_input
/// for lines that are not those of a record.
std::map<std::string, std::string> lines_of(const Record &record);
Record record_in(const std::map<std::string, std::string> &lines);

} // namespace rbvi
