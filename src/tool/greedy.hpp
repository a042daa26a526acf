// Samples chosen by bounds of errors: a model of the samples so far says where the next are solved.
#pragma once

#include "rbvi/model/model.hpp"
#include "rbvi/par/petsc.hpp"
#include "rbvi/tool/options.hpp"

namespace rbvi {

/// What -greedy asks for.
struct GreedyPool {
  std::vector<Mu> candidates; ///< empty: the training set stays as it is
  double tolerance = 0;       ///< of the largest bound among them
  std::size_t most = 0;       ///< samples in all
};

/// Throws bad_input for a set that cannot be read, and where answers to the scene have no bounds.
GreedyPool greedy_pool(const OfflineOptions &options);

struct NextSamples {
  std::vector<Mu> mu; ///< at most as many as are asked for, that with the largest bound first
  double largest = 0; ///< bound of the error over |u|; infinite where there is no answer
};

/// `model`: complete on every rank; `taken`: that have samples, which are not taken again. Those
/// behind the first are farther from it than half of its distance to the samples, in parts of the
/// box. Collective.
NextSamples next_samples(MPI_Comm world, const ReducedModel &model, const Scene &scene,
                         const std::vector<Mu> &pool, const std::vector<Mu> &taken,
                         std::size_t count);

} // namespace rbvi
