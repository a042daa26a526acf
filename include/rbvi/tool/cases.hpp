// The cases of runs, of -help and of pages.
#pragma once

#include "rbvi/scene/case.hpp"

#include <mpi.h>

#include <filesystem>
#include <memory>

namespace rbvi {

/// The case that a run is of, among the scenes that the program knows.
struct GivenCase {
  std::shared_ptr<const Registry> registry;    ///< of the program, with the scene of the case
  std::string scene;                           ///< its name
  std::string text = "";                       ///< of the case file; "": a scene of the program
  std::map<std::string, std::string> origin{}; ///< where options stand: " (line 2 of case.yaml)"
};

/// Puts the options of a case below those of the command line and above what comes from outside.
/// The case is that of -case, that of the run directory -out, or the program's scene -scene. Throws
/// bad_input. Collective.
GivenCase insert_case(MPI_Comm comm, const std::vector<std::string> &command_line,
                      const Registry &registry);

/// The scene of a case file, or of the folder of a case.yaml. Throws bad_input. Collective.
SceneEntry scene_of_file(MPI_Comm comm, const std::filesystem::path &file,
                         const CaseChanges &changes = {});

/// The cases FOLDER/*/case.yaml, by name. Throws bad_input for one that cannot be read.
std::vector<SceneEntry> cases_in(const std::filesystem::path &folder);

/// Of -set: "mesh.edges=200,mesh.degree=1". Throws bad_input.
std::vector<std::pair<std::string, std::string>> settings_of(const std::string &text);

} // namespace rbvi
