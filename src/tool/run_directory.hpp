// The directory of a run: its case file, the sets that this names, and what killed runs left.
//
// Names of files in a case file are looked for beside it first, then in the working directory. A
// run's own case file has the sets as copies in its directory, and its mesh by an absolute path,
// whose file is looked for in the folders around where it is gone: the directory may be moved, the
// folder of the project renamed, and the commands called from anywhere.
#pragma once

#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/tool/options.hpp"

namespace rbvi {

/// The value of option `name` in `case_file`, where it is one file beside that, or around it: with
/// its folder.
std::string beside_case(const std::string &name, const std::string &value,
                        const std::filesystem::path &case_file);

/// The value of option `name` as the case file of a run has it.
std::string value_in_run(const std::string &name, const std::string &value);

/// Writes the case file of a run that begins, and the sets that it names; removes temporary files
/// of killed runs. Collective. Throws failure, or bad_input for a set that cannot be read.
void begin_run(MPI_Comm world, const RunFiles &files);

/// Removes the temporary files of killed runs. By one rank.
void sweep_up(const std::filesystem::path &out);

} // namespace rbvi
