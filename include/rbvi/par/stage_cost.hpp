// What a piece of work takes beside wall time: CPU seconds, memory, messages, factorisations.
#pragma once

#include <mpi.h>

#include <array>

namespace rbvi {

/// On one rank, from one moment to another. Messages and their bytes are those of -log_view: of
/// PETSc, SLEPc and this code, half of those sent and half of those received, without what MUMPS
/// and HDF5 send by themselves. A rank that waits in MPI spins: that is CPU time, too.
struct StageCost {
  double seconds = 0; ///< wall
  double cpu = 0;     ///< seconds, user and system
  double memory = 0;  ///< bytes: largest resident set
  double messages = 0, bytes = 0;
  double reductions = 0;     ///< and broadcasts, gathers, scatters among more than one rank
  double symbolic = 0;       ///< symbolic factorisations (Cholesky, LU)
  double factorisations = 0; ///< numeric
  double solves = 0;         ///< with factors; a block of right-hand sides is one
  double factor_seconds = 0, solve_seconds = 0; ///< of numeric factorisations, of those solves
  double assemblies = 0;                        ///< of sparse matrices from the cells
  double interpolations = 0; ///< runs of empirical interpolation, one for each operator
  double cg_steps = 0;       ///< of conjugate gradients, also where multigrid estimates eigenvalues

  static constexpr auto members() {
    return std::array{&StageCost::seconds,        &StageCost::cpu,
                      &StageCost::memory,         &StageCost::messages,
                      &StageCost::bytes,          &StageCost::reductions,
                      &StageCost::symbolic,       &StageCost::factorisations,
                      &StageCost::solves,         &StageCost::factor_seconds,
                      &StageCost::solve_seconds,  &StageCost::assemblies,
                      &StageCost::interpolations, &StageCost::cg_steps};
  }
};

/// Counts as an event of -log_view, by its name, from construction to destruction.
class CountedEvent {
public:
  explicit CountedEvent(const char *name);
  ~CountedEvent();
  CountedEvent(const CountedEvent &) = delete;
  CountedEvent &operator=(const CountedEvent &) = delete;

private:
  int event_ = -1;
};

/// One after the other: the sum, of memory the maximum.
StageCost operator+(StageCost first, const StageCost &second);

/// Turns PETSc's log on, without which there is nothing to count; it slows PETSc's calls down by
/// less than a microsecond each. Once on it stays on.
void measure_costs();

/// Whether that was called, or -log_view given.
bool costs_are_measured();

/// Measures from its construction on. Meters may be nested, one inside another; the innermost one
/// answers.
class CostMeter {
public:
  /// Gives memory that was freed back to the system first, so that it does not count as used.
  CostMeter();
  ~CostMeter();
  CostMeter(const CostMeter &) = delete;
  CostMeter &operator=(const CostMeter &) = delete;
  StageCost so_far() const;

private:
  StageCost start_; ///< counters; memory: the peak before
};

/// Resident bytes of this process now, once memory that was freed is given back to the system.
double resident_bytes();
/// The largest number of them since the last CostMeter began or ended, or since the process did.
double peak_bytes();

/// Each member over the ranks.
struct RankCosts {
  StageCost largest, sum;
};

/// Collective.
RankCosts costs_over_ranks(MPI_Comm comm, const StageCost &cost);

} // namespace rbvi
