// What samples and models keep of a scene is its tree: of a case the values of the file after
// choices, variants, -set and the command line, of a program's scene its name and version.
#pragma once

#include "rbvi/scene/tree.hpp"

#include "rbvi/core/scene.hpp"

#include <map>
#include <string>

namespace rbvi {

/// The scene of a tree with these options: its case read again, or made by the program's entry.
/// Throws bad_input where the registry has no such entry, or another version of it, and where this
/// build reads no scene in the case.
Scene scene_in(const std::string &tree, const SceneOptions &options, const Registry &registry);

/// Adds what a body that contact alone holds asks of a scene: a term of zeros in a with the
/// coefficient of term `of` of a (-1: 1), with the first body a load of nothing. The tree keeps it,
/// for the mesh alone tells such bodies.
void add_held_body(Scene &scene, int of);

/// What a case says of its parameters, by their names.
std::map<std::string, std::string> texts_of_parameters(const Scene &scene);

/// Whether outputs of the case's own count as well.
enum class Compared { answers, answers_and_outputs };

/// The first value of `mine` that is not the same in `theirs`, both trees:
/// "poisson is .3, it was .35", "nu of rubber is ...". Empty: there is none. Texts are compared, not
/// what they mean: 2*x is not x*2. What changes no answer does not count: names, texts for people,
/// boxes, limits, values of parameters that have a range, training sets, requirements, tests, facts
/// of meshes; and parameters and lets that nothing else names.
std::string scene_difference(const std::string &theirs, const std::string &mine,
                             Compared compared = Compared::answers);

} // namespace rbvi
