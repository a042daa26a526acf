// The commands of the rbvi tool.
#pragma once

#include "rbvi/mesh/surface.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "rbvi/tool/options.hpp"

namespace rbvi {

/// Snapshots, bases, interpolation and the model file. Collective on the world.
void command_offline(const OfflineOptions &options);

/// One high-fidelity solve. Collective on the world.
void command_solve(const OfflineOptions &options, const SolveOptions &solve);

/// A line for each thing that is not accurate in an answer or not the only one, by one rank;
/// whether there is any.
bool warn_of_answer(const Problem &problem, const Mu &mu, const HfSolution &solution,
                    std::ostream &out);

/// The files of -vtu, and a high-fidelity answer in them; nothing without that option. Collective.
std::vector<NamedFile> files_of_solution(const std::string &vtu, const Scene &scene);
void write_solution(Problem &problem, const std::string &vtu, const Mu &mu,
                    const HfSolution &solution);

/// Reduced against high-fidelity over the validation set; writes tables and the measured errors
/// into the model file. Collective on the world.
void command_verify(const MeasureOptions &options);

/// Run time against error, or command_growth (MeasureOptions::growth), or command_convergence.
/// Collective on the world.
void command_bench(const MeasureOptions &options);

/// What offline takes on several meshes, by several ranks per solve. Collective on the world.
void command_growth(const MeasureOptions &options);

/// Outputs of full solves on several meshes (MeasureOptions::convergence), into
/// bench/convergence.csv where a run directory is named. Collective on the world.
void command_convergence(const MeasureOptions &options);

/// What check writes beside the file of -vtu: the mesh with its groups, its surface, and of each
/// contact the partners at some parameters. The names, none without that option; and the files, by
/// one rank.
std::vector<NamedFile> files_of_check(const std::string &vtu, const Scene &scene);
std::vector<std::filesystem::path> write_check(const std::string &vtu, const Problem &problem,
                                               const SerialMesh &mesh);

/// A case: its text and variants, its mesh, its functions, contact over the box, one solve. What
/// was read is printed, every defect told; and its tests, where they are asked for. Collective on
/// the world.
void command_check(const MeasureOptions &options, const SolveOptions &solve);

/// check, offline, verify and figures of a case, a line for each, whose own lines go into run.log
/// in the run directory; the first that fails is the last. Collective on the world.
void command_run(ToolOptions options);

/// Writes NAME/case.yaml, a case to begin with; of a Gmsh mesh, if one is named, with its parts.
void command_new(const std::string &name, const std::string &mesh);

/// The scenes of the program and the cases FOLDER/*/case.yaml.
void command_list(const std::string &folder, const Registry &registry);
void command_inspect(const std::string &file, const Registry &registry);

/// Prints sizes, errors and times of the models of run folders, or of model files, a column each:
/// relative errors, those of outputs over their range, the largest that verify found. With `csv` a
/// file of a row each. Throws bad_input for a run that has no model or was not verified. Serial.
void command_compare(const std::vector<std::string> &given, const std::string &csv,
                     const Registry &registry);

} // namespace rbvi
