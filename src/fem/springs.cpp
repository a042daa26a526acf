// The springs of bodies that contact alone holds, in A and in F.
#include "rbvi/fem/free_motions.hpp"

#include "rbvi/par/collective.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// Of springs against the body: balance takes fewer solves the softer they are, and more digits are
/// lost (0.001: residuals reach 1e-10).
constexpr double softer = 0.01;

/// Entries of a vector, on every rank. Collective.
Vector entries(Vec vector, const std::vector<PetscInt> &rows) {
  PetscInt begin = 0, end = 0;
  const PetscScalar *values = nullptr;
  RBVI_CALL(VecGetOwnershipRange(vector, &begin, &end));
  RBVI_CALL(VecGetArrayRead(vector, &values));
  Vector result = Vector::Zero(std::ssize(rows));
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (rows[i] >= begin && rows[i] < end) result[static_cast<Index>(i)] = values[rows[i] - begin];
  RBVI_CALL(VecRestoreArrayRead(vector, &values));
  over_ranks(PetscObjectComm(reinterpret_cast<PetscObject>(vector)), MPI_SUM, result);
  return result;
}

/// Adds weight springs springs^T. Collective.
void add(const FreeBody &body, double weight, Mat a) {
  const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> block =
      weight * (body.springs * body.springs.transpose());
  const auto size = static_cast<PetscInt>(body.rows.size());
  PetscInt begin = 0, end = 0;
  RBVI_CALL(MatGetOwnershipRange(a, &begin, &end));
  for (PetscInt i = 0; i < size; ++i)
    if (body.rows[i] >= begin && body.rows[i] < end)
      RBVI_CALL(MatSetValues(a, 1, &body.rows[i], size, body.rows.data(),
                             block.data() + std::ptrdiff_t{i} * size, ADD_VALUES));
  RBVI_CALL(MatAssemblyBegin(a, MAT_FINAL_ASSEMBLY));
  RBVI_CALL(MatAssemblyEnd(a, MAT_FINAL_ASSEMBLY));
}

} // namespace

void stiffen(std::vector<FreeBody> &bodies, const Scene &scene, const FullMu &mu, Summed<Mat> &a) {
  Handle<Vec> diagonal;
  RBVI_CALL(MatCreateVecs(a.total.get(), nullptr, diagonal.put()));
  RBVI_CALL(MatGetDiagonal(a.total.get(), diagonal.get()));
  a.made_at.reset();
  for (FreeBody &body : bodies) {
    const Term &term = scene.a[body.term];
    const double mean = entries(diagonal.get(), body.rows).mean();
    body.springs *= std::sqrt(softer * mean / std::abs(coefficient_of(term, mu)));
    for (std::size_t g = 0; g < a.split.exact.size(); ++g)
      for (const ExactGroup::Member &member : a.split.exact[g].members)
        if (member.term == body.term) add(body, member.weight, a.exact[g].get());
  }
}

Index motions_of(const std::vector<FreeBody> &bodies) {
  Index count = 0;
  for (const FreeBody &body : bodies)
    count += body.motions.cols();
  return count;
}

Vector spring_coefficients(const std::vector<FreeBody> &bodies, const Scene &scene,
                           const FullMu &mu) {
  Vector result(motions_of(bodies));
  Index first = 0;
  for (const FreeBody &body : bodies) {
    const Index count = body.motions.cols();
    result.segment(first, count).setConstant(coefficient_of(scene.a[body.term], mu));
    first += count;
  }
  return result;
}

Vector spring_lengths(const std::vector<FreeBody> &bodies, Vec u) {
  Vector result(motions_of(bodies));
  Index first = 0;
  for (const FreeBody &body : bodies) {
    const Index count = body.motions.cols();
    result.segment(first, count) = body.springs.transpose() * entries(u, body.rows);
    first += count;
  }
  return result;
}

void add_spring_forces(const std::vector<FreeBody> &bodies, const Vector &values, Vec f) {
  PetscInt begin = 0, end = 0;
  RBVI_CALL(VecGetOwnershipRange(f, &begin, &end));
  Index first = 0;
  for (const FreeBody &body : bodies) {
    const Index count = body.motions.cols();
    const Vector forces = body.springs * values.segment(first, count);
    first += count;
    for (std::size_t i = 0; i < body.rows.size(); ++i)
      if (body.rows[i] >= begin && body.rows[i] < end)
        RBVI_CALL(VecSetValue(f, body.rows[i], forces[static_cast<Index>(i)], ADD_VALUES));
  }
  RBVI_CALL(VecAssemblyBegin(f));
  RBVI_CALL(VecAssemblyEnd(f));
}

} // namespace rbvi
