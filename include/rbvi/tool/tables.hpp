// Tables and small text of the commands.
#pragma once

#include "rbvi/sweep/sweep.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace rbvi {

/// Columns of equal length under a header, as CSV, atomically. Throws failure.
void write_columns(const std::filesystem::path &path, const std::vector<std::string> &names,
                   const std::vector<std::vector<double>> &columns);

/// One row per sample: parameters, outputs.
void write_sample_table(const std::filesystem::path &path, const ParameterSpace &space,
                        const std::vector<Sample> &samples);

} // namespace rbvi
