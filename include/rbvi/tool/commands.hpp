// The commands of the rbvi tool.
#pragma once

#include "rbvi/tool/options.hpp"

namespace rbvi {

/// Snapshots, bases, interpolation and the model file. Collective on the world.
void command_offline(const ToolOptions &options);

/// One high-fidelity solve. Collective on the world.
void command_solve(const ToolOptions &options);

/// Reduced against high-fidelity over the validation set; writes tables and the measured errors
/// into the model file. Collective on the world.
void command_verify(const ToolOptions &options);

/// Run time against error, or (ToolOptions::growth) command_growth. Collective on the world.
void command_bench(const ToolOptions &options);

/// What offline takes on several meshes, by several ranks per solve. Collective on the world.
void command_growth(const ToolOptions &options);

void command_list(const Registry &registry);
void command_inspect(const std::string &file, const Registry &registry);

} // namespace rbvi
