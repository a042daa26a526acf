// Scenes from files: a case file (YAML) says the bodies, what holds, loads and touches them, and
// the parameters of all that. cases/CASE_FILE.md describes the format; src/scene/keys.cpp is its
// table.
#pragma once

#include "rbvi/core/scene.hpp"
#include "rbvi/scene/tree.hpp"

namespace rbvi {

/// What a run changes of a case file before it is read.
struct CaseChanges {
  std::string variant = ""; ///< one of `variants:`
  /// "mesh.edges" -> "200": values at paths of the file.
  std::vector<std::pair<std::string, std::string>> values{};
  /// Names that parameters and choices do not have: those of options of the program.
  std::vector<std::string> taken{};
};

/// Whether the text is that of a case, with sections of a scene. Throws bad_input for
/// text that is no YAML table.
bool is_scene_file(const std::string &text, const std::string &file);

/// The scene of a case file, and the options that the file chooses. `file` is for messages, and
/// names the scene that has no name: after its folder if it is a case.yaml, else after itself.
/// Throws bad_input with every defect of the text that can be found without a mesh.
SceneEntry read_case(const std::string &text, const std::string &file,
                     const CaseChanges &changes = {});
SceneEntry read_case(CaseNode root, const std::string &file, const CaseChanges &changes);

/// The scene of a case whose choices and changes are made. Throws bad_input with its defects.
Scene read_scene(const CaseNode &resolved);

/// A case to begin with: a block with friction on a floor.
std::string new_case();
/// A case of a mesh file: its parts, in a comment; the lines of the sections imposed and contact,
/// in which `depth` is a parameter with this upper bound. `physics`: plane_strain or solid.
std::string new_case(const std::string &physics, const std::string &mesh, const std::string &parts,
                     const std::string &imposed, const std::string &contact, double depth);

/// A key of case files.
struct CaseKey {
  std::string table; ///< "", "mesh", "contact.*", ...: * is a name of the author's
  std::string name;  ///< of the key; "*": any
  std::string value; ///< "expression", "text", "a | b", "[a, b]", "table", ...
  std::string says;
  bool needed = false;
  std::string dimension = ""; ///< of its numbers, as a unit: "N/m^2"; "": any
};

/// All keys, by table: what is checked, explained and completed comes from here.
const std::vector<CaseKey> &case_keys();

} // namespace rbvi
