// Niakh (2022): (B.32), (B.35).
#include "rbvi/mor/eim.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/stage_cost.hpp"

#include <array>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

constexpr double eim_tie = 1e-10;
constexpr double exact_decomposition = 1e-13; // relative residual of a decomposition that is exact

struct Pivot {
  int owner = 0;    // rank
  Index local = -1; // its position there; -1 on the other ranks
  EntryKey key{};
};

/// max |column| of every training index over all ranks.
Vector column_maxima(MPI_Comm comm, const Matrix &residual) {
  Vector maxima(residual.cols());
  for (Index p = 0; p < residual.cols(); ++p) {
    const auto column = residual.col(p);
    // MPI_MAX does not carry NaN from rank to rank, infinity it does.
    maxima(p) = column.size() == 0   ? 0
                : column.allFinite() ? column.cwiseAbs().maxCoeff()
                                     : std::numeric_limits<double>::infinity();
  }
  over_ranks(comm, MPI_MAX, maxima);
  return maxima;
}

/// The lowest key among the entries of `column` that reach `largest` (B.31).
Pivot find_pivot(MPI_Comm comm, const Eigen::Ref<const Vector> &column,
                 const std::vector<EntryKey> &keys, double largest) {
  constexpr PetscInt none = std::numeric_limits<PetscInt>::max();
  Pivot pivot;
  EntryKey lowest{none, none};
  for (Index e = 0; e < column.size(); ++e) {
    const EntryKey key = keys[e];
    if (std::abs(column(e)) < (1 - eim_tie) * largest || key >= lowest) continue;
    lowest = key;
    pivot.local = e;
  }
  const int ranks = ranks_of(comm), rank = rank_of(comm);
  const std::array<PetscInt, 2> mine{lowest.row, lowest.column};
  std::vector<PetscInt> all(2 * static_cast<std::size_t>(ranks));
  RBVI_CALL(MPI_Allgather(mine.data(), 2, MPIU_INT, all.data(), 2, MPIU_INT, comm));
  pivot.key = {none, none};
  for (int r = 0; r < ranks; ++r) {
    const EntryKey key{all[2 * static_cast<std::size_t>(r)],
                       all[2 * static_cast<std::size_t>(r) + 1]};
    if (key >= pivot.key) continue;
    pivot.key = key;
    pivot.owner = r;
  }
  if (pivot.owner != rank) pivot.local = -1;
  return pivot;
}

/// Residuals of all training snapshots; the column of a selected snapshot, whose residual is zero
/// from then on, holds its term A_j instead.
struct Residuals {
  MPI_Comm comm;
  Matrix columns;
  std::vector<bool> selected;
  Vector maxima; // over all ranks; 0 for selected columns

  /// Lowest training index among the largest residuals (B.30).
  int worst() const {
    const double largest = maxima.maxCoeff();
    int p = 0;
    while (maxima(p) < (1 - eim_tie) * largest)
      ++p;
    return p;
  }

  /// The residuals (and earlier terms) at the pivot, shared by its owner.
  Vector row(const Pivot &pivot) const {
    Vector values(columns.cols());
    if (pivot.local >= 0) values = columns.row(pivot.local);
    RBVI_CALL(MPI_Bcast(values.data(), static_cast<PetscMPIInt>(values.size()), MPI_DOUBLE,
                        pivot.owner, comm));
    return values;
  }

  /// Makes column p the term A_j (B.33) and subtracts its multiples from the others.
  void eliminate(int p, const Vector &at_pivot) {
    columns.col(p) /= at_pivot(p);
    selected[p] = true;
    maxima.setZero();
    for (Index q = 0; q < columns.cols(); ++q) {
      if (selected[q]) continue;
      if (at_pivot(q) != 0) columns.col(q) -= at_pivot(q) * columns.col(p);
      if (columns.rows() > 0) maxima(q) = columns.col(q).cwiseAbs().maxCoeff();
    }
    over_ranks(comm, MPI_MAX, maxima);
  }
};

/// Appends one term: its row of Q (B.34) and its column of the combination.
void record_term(Eim &result, int p, const EntryKey &key, const Vector &at_pivot,
                 std::vector<Vector> &rows) {
  const Index j = result.size();
  Vector combination = Vector::Zero(j + 1);
  combination(j) = 1;
  result.interpolation.conservativeResizeLike(Matrix::Zero(j + 1, j + 1));
  for (Index i = 0; i < j; ++i) {
    result.interpolation(j, i) = at_pivot(result.snapshots[i]);
    combination.head(i + 1) -= rows[i](p) * result.combination.col(i).head(i + 1);
  }
  result.interpolation(j, j) = 1;
  result.combination.conservativeResizeLike(Matrix::Zero(j + 1, j + 1));
  result.combination.col(j) = combination / at_pivot(p);
  result.snapshots.push_back(p);
  result.entries.push_back(key);
  rows.push_back(at_pivot);
}

/// Whether the snapshots that the terms are made of are all that differ. `rows`: of each term the
/// residuals before it at its pivot.
bool takes_all_that_differ(const Eim &result, const std::vector<Vector> &rows) {
  const auto repeats = [&](Index p, int j) {
    const Index taken = result.snapshots[j];
    for (int i = 0; i < result.size(); ++i) {
      const double wanted = i <= j ? rows[i](taken) : 0;
      if (!(std::abs(rows[i](p) - wanted) <= eim_tie * std::abs(rows[i](result.snapshots[i]))))
        return false;
    }
    return true;
  };
  for (Index p = 0; p < rows[0].size(); ++p) {
    bool known = std::ranges::find(result.snapshots, p) != result.snapshots.end();
    for (int j = 0; j < result.size() && !known; ++j)
      known = repeats(p, j);
    if (!known) return false;
  }
  return true;
}

/// "" while the greedy has to go on.
std::string stop_reason(const Eim &result, const EimOptions &options,
                        const std::vector<Vector> &rows) {
  const double error = result.error.back();
  const int size = result.size();
  if (error <= exact_decomposition && size == 0) return "zero for every parameter: no term";
  if (error <= exact_decomposition && size > 1 && takes_all_that_differ(result, rows))
    return "a term for each snapshot that differs";
  if (error <= exact_decomposition)
    return "separable: rank " + std::to_string(size) + ", error at round-off";
  if (error <= options.tolerance) return "tolerance reached";
  if (options.max_size > 0 && size >= options.max_size)
    return "stopped at the maximal size " + std::to_string(size);
  return "";
}

} // namespace

Eim eim(MPI_Comm comm, const Matrix &values, const std::vector<EntryKey> &keys,
        const EimOptions &options) {
  const CountedEvent counted("EIM");
  if (!(options.tolerance >= 0)) throw bad_input("the tolerance of an EIM must not be negative");
  if (options.max_size < 0) throw bad_input("the maximal size of an EIM must not be negative");
  if (values.cols() == 0) throw failure("an empirical interpolation needs at least one snapshot");
  Residuals residuals{comm, values, std::vector<bool>(values.cols()), column_maxima(comm, values)};
  const double scale = residuals.maxima.maxCoeff();
  if (!std::isfinite(scale))
    throw failure("snapshots of an empirical interpolation are not finite");

  Eim result;
  result.error = {scale > 0 ? 1.0 : 0.0};
  std::vector<Vector> rows;
  while ((result.reason = stop_reason(result, options, rows)).empty()) {
    const int p = residuals.worst();
    const Pivot pivot = find_pivot(comm, residuals.columns.col(p), keys, residuals.maxima(p));
    const Vector at_pivot = residuals.row(pivot);
    record_term(result, p, pivot.key, at_pivot, rows);
    residuals.eliminate(p, at_pivot);
    result.error.push_back(residuals.maxima.maxCoeff() / scale);
  }
  return result;
}

} // namespace rbvi
