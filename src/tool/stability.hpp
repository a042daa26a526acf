// The part of verify that is about stability.
#pragma once

#include "rbvi/fem/problem.hpp"
#include "rbvi/model/model.hpp"

#include <filesystem>
#include <string>

namespace rbvi {

/// Why there are no inf-sup constants to verify; empty: there are.
std::string no_constants(const ReducedModel &model);

/// What the model promises about stability, checked at every training and validation mu, where
/// contact follows the displacement at every step of their iterations: infsup.csv
/// and stability.csv into `out`, a summary to standard output. Collective.
void check_stability(MPI_Comm world, Problem &problem, const ReducedModel &model,
                     const std::vector<ContactPoint> &training,
                     const std::vector<ContactPoint> &validation, const std::filesystem::path &out);

} // namespace rbvi
