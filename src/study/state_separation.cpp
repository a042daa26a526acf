#include "rbvi/core/error.hpp"
#include "rbvi/mor/eim.hpp"
#include "rbvi/par/small_svd.hpp"
#include "rbvi/study/separation_errors.hpp"

#include <algorithm>
#include <set>
#include <utility>

namespace rbvi {

namespace {

/// B at these points: entries x points, in the order of `keys`, which the first call sets. A pair's
/// pattern may differ from state to state: `keys` are those of all points.
Matrix entries_at(const Contact &contact, const ParameterSpace &space,
                  const std::vector<ContactPoint> &points, const std::vector<EntryKey> &keys,
                  ContactOperators &op) {
  Matrix values = Matrix::Zero(std::ssize(keys), std::ssize(points));
  for (std::size_t k = 0; k < points.size(); ++k) {
    assemble(contact, expand(space, points[k].mu), {points[k].state}, op);
    for (Index row = 0; row < op.b.rows(); ++row)
      for (SparseMatrix::InnerIterator entry(op.b, row); entry; ++entry) {
        const EntryKey key{static_cast<PetscInt>(row), static_cast<PetscInt>(entry.col())};
        const auto found = std::ranges::lower_bound(keys, key);
        if (found != keys.end() && *found == key)
          values(found - keys.begin(), static_cast<Index>(k)) = entry.value();
      }
  }
  return values;
}

std::vector<EntryKey> keys_of(const Contact &contact, const ParameterSpace &space,
                              const std::vector<ContactPoint> &points, ContactOperators &op) {
  std::vector<EntryKey> keys;
  for (const ContactPoint &point : points) {
    assemble(contact, expand(space, point.mu), {point.state}, op);
    for (Index row = 0; row < op.b.rows(); ++row)
      for (SparseMatrix::InnerIterator entry(op.b, row); entry; ++entry)
        keys.push_back({static_cast<PetscInt>(row), static_cast<PetscInt>(entry.col())});
    std::ranges::sort(keys);
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  }
  return keys;
}

} // namespace

StateSeparation separation_over_states(const Contact &contact, const ParameterSpace &space,
                                       const std::vector<ContactPoint> &training,
                                       const std::vector<ContactPoint> &validation,
                                       double tolerance) {
  ContactOperators op;
  const std::vector<EntryKey> keys = keys_of(contact, space, training, op);
  const Matrix values = entries_at(contact, space, training, keys, op);
  const Eim found = eim(PETSC_COMM_SELF, values, keys, {tolerance, 0});
  const Matrix functions = values(Eigen::all, found.snapshots) * found.combination;
  std::vector<Index> rows;
  std::set<PetscInt> multipliers;
  for (const EntryKey &entry : found.entries) {
    rows.push_back(std::ranges::lower_bound(keys, entry) - keys.begin());
    multipliers.insert(entry.row);
  }
  Matrix left = entries_at(contact, space, validation, keys, op);
  const double scale = values.cwiseAbs().maxCoeff();
  SeparationErrors errors{"b_of_states", found.error, {left.cwiseAbs().maxCoeff() / scale}};
  const Matrix theta =
      found.interpolation.triangularView<Eigen::UnitLower>().solve(left(rows, Eigen::all));
  for (Index j = 0; j < theta.rows(); ++j) {
    left -= functions.col(j) * theta.row(j);
    errors.validation.push_back(left.cwiseAbs().maxCoeff() / scale);
  }
  const Vector singular = singular_values(values);
  return {std::move(errors), static_cast<int>((singular.array() > tolerance * singular[0]).count()),
          static_cast<int>(multipliers.size())};
}

} // namespace rbvi
