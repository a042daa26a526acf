#include "local_frames.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/element/lagrange.hpp"

#include <array>
#include <map>

namespace rbvi {

namespace {

/// Adds those of one interface, by contact dof.
void add_bounds(const ContactInterface &interface, const FullMu &mu,
                std::map<int, NodalBound> &bounds) {
  const InterfaceMesh &mesh = interface.mesh();
  for (Index e = 0; e < mesh.count(); ++e) {
    const int edge = mesh.edges[e];
    const auto [a, b] = simplex_edges[edge];
    std::vector<int> on_curve{a, b};
    if (mesh.degree == 2) on_curve.push_back(3 + edge);
    for (const int local : on_curve) {
      const auto node = static_cast<std::size_t>(mesh.nodes_of(e)[local]);
      const int dof = mesh.dofs[2 * node];
      if (dof < 0 || mesh.dofs[2 * node + 1] < 0) continue;
      const PointConstraint at = interface.constraint_at(mu, mesh.points[node]);
      bounds[dof] = {{dof, dof + 1}, Vector{{at.direction[0], at.direction[1]}}, at.gap};
    }
  }
}

/// Orthonormal columns, the normal first; in the plane then the tangent, a quarter of a turn on.
Matrix frame_of(const Vector &normal) {
  if (normal.size() == 2) return Matrix{{normal[0], -normal[1]}, {normal[1], normal[0]}};
  // The reflection that takes the first axis to the normal, or to its opposite.
  Vector v = normal;
  v[0] += normal[0] < 0 ? -1 : 1;
  Matrix frame =
      2 / v.squaredNorm() * v * v.transpose() - Matrix::Identity(normal.size(), normal.size());
  if (normal[0] < 0) frame = -frame;
  return frame;
}

} // namespace

std::vector<NodalBound> bounds_along(const Contact &contact, const FullMu &mu) {
  std::map<int, NodalBound> all;
  for (const auto &interface : contact.interfaces) {
    std::map<int, NodalBound> bounds;
    add_bounds(*interface, mu, bounds);
    for (const auto &[dof, bound] : bounds)
      if (!all.emplace(dof, bound).second)
        throw bad_input("two contact curves share a node, whose displacement has one bound: leave "
                        "out -nitsche_bounds");
  }
  std::vector<NodalBound> result;
  for (const auto &[dof, bound] : all)
    result.push_back(bound);
  return result;
}

LocalFrames::LocalFrames(const Problem &problem) : row_of_(problem.trace().size, -1) {
  const Trace &trace = problem.trace();
  const Dofs &dofs = problem.dofs();
  for (std::size_t k = 0; k < trace.index.size(); ++k)
    row_of_[trace.index[k]] = dofs.first_free + trace.local_row[k];
  const auto local = static_cast<PetscInt>(dofs.natural_owned.size());
  RBVI_CALL(MatCreateAIJ(problem.comm(), local, local, PETSC_DETERMINE, PETSC_DETERMINE, 3, nullptr,
                         2, nullptr, q_.put()));
}

void LocalFrames::set(std::vector<NodalBound> bounds) {
  bounds_ = std::move(bounds);
  PetscInt first = 0, last = 0;
  RBVI_CALL(MatGetOwnershipRange(q_.get(), &first, &last));
  for (PetscInt row = first; row < last; ++row)
    RBVI_CALL(MatSetValue(q_.get(), row, row, 1, INSERT_VALUES));
  for (const NodalBound &bound : bounds_) {
    std::vector<PetscInt> rows;
    for (const Index dof : bound.contact_dofs)
      rows.push_back(row_of_[dof]);
    if (rows.front() < 0) continue;
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> frame =
        frame_of(bound.normal);
    const auto size = static_cast<PetscInt>(rows.size());
    RBVI_CALL(
        MatSetValues(q_.get(), size, rows.data(), size, rows.data(), frame.data(), INSERT_VALUES));
  }
  RBVI_CALL(MatAssemblyBegin(q_.get(), MAT_FINAL_ASSEMBLY));
  RBVI_CALL(MatAssemblyEnd(q_.get(), MAT_FINAL_ASSEMBLY));
}

Handle<Mat> LocalFrames::turned(Mat a) const {
  Handle<Mat> result;
  RBVI_CALL(MatPtAP(a, q_.get(), MAT_INITIAL_MATRIX, PETSC_DEFAULT, result.put()));
  return result;
}

Handle<Vec> LocalFrames::turned(Vec f) const {
  Handle<Vec> result;
  RBVI_CALL(VecDuplicate(f, result.put()));
  RBVI_CALL(MatMultTranspose(q_.get(), f, result.get()));
  return result;
}

Handle<Vec> LocalFrames::turned_back(Vec v) const {
  Handle<Vec> result;
  RBVI_CALL(VecDuplicate(v, result.put()));
  RBVI_CALL(MatMult(q_.get(), v, result.get()));
  return result;
}

Handle<Vec> LocalFrames::upper() const {
  Handle<Vec> result;
  RBVI_CALL(MatCreateVecs(q_.get(), result.put(), nullptr));
  RBVI_CALL(VecSet(result.get(), PETSC_INFINITY));
  for (const NodalBound &bound : bounds_)
    if (const PetscInt row = row_of_[bound.contact_dofs.front()]; row >= 0)
      RBVI_CALL(VecSetValue(result.get(), row, bound.gap, INSERT_VALUES));
  RBVI_CALL(VecAssemblyBegin(result.get()));
  RBVI_CALL(VecAssemblyEnd(result.get()));
  return result;
}

} // namespace rbvi
