#include "rbvi/tool/commands.hpp"

namespace rbvi {

void command_bench(const ToolOptions &) {}

} // namespace rbvi
