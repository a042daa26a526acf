// The whole scene as text, a line for each of its parts. Samples and models keep it, so that those
// of another scene are never taken for this one's, though its name and options be the same.
#pragma once

#include "rbvi/contact/contact.hpp"

namespace rbvi {

/// Their setting that is this text.
inline constexpr const char *whole_scene = "whole scene";

/// Lines "name: what". The ranges of the parameters; the record of the scene (scene_record.hpp),
/// and the kernels of exact terms, boundaries and parts of the mesh, which that leaves out; and of
/// every function, whether it has a name in files or not, a sum of its values at 16 fixed random
/// points and parameters, to 9 digits. `contact`: the interfaces of the scene, on any ranks.
std::string scene_text(const Scene &scene, const Contact &contact);

/// Lines of another scene that one's own has not: a difference, or none.
enum class Further { refused, allowed };

/// The first line of `mine` that is not the same in `theirs`: "map values is 1, it was 2". Empty:
/// there is none. Sums are the same to 1e-8: the last digits are the processor's.
std::string scene_difference(const std::string &theirs, const std::string &mine, Further further);

} // namespace rbvi
