// What the commands do about parameters without a high-fidelity answer.
#pragma once

#include "rbvi/sweep/sweep.hpp"
#include "rbvi/tool/options.hpp"

namespace rbvi {

/// Prints the failed samples of a set of `total` (rank 0 of the world). Throws failure if all
/// failed, or more than the share `most`. `set`: "training", "validation".
void check_failures(const ParameterSpace &space, double most, const SweepReport &report,
                    std::size_t total, const std::string &set);

/// The end of a command, when all is written: throws failure if a sample failed, so that the
/// exit status says so. `consequence`: what that means for what was made.
void report_failures(const ParameterSpace &space, const SweepReport &report, std::size_t total,
                     const std::string &set, const std::string &consequence);

} // namespace rbvi
