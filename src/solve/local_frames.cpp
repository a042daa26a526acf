#include "local_frames.hpp"

#include <algorithm>

namespace rbvi {

std::vector<int> nodes_of_dofs(const ContactSupport &support, const ContactLayer &layer) {
  std::vector<int> node_of_dof(layer.natural.size(), -1);
  for (std::size_t k = 0; k < support.natural_node.size(); ++k) {
    const auto found =
        std::lower_bound(layer.natural.begin(), layer.natural.end(), 2 * support.natural_node[k]);
    node_of_dof[static_cast<std::size_t>(found - layer.natural.begin())] = static_cast<int>(k);
  }
  return node_of_dof;
}

LocalFrames::LocalFrames(const Problem &problem, std::size_t nodes) : problem_(problem) {
  const ContactSupport &support = problem.support();
  const Dofs &dofs = problem.dofs();
  for (std::size_t k = 0; k < nodes; ++k)
    nodes_.push_back({-1, support.curve.points[k], {}, 0});
  for (std::size_t k = 0; k < support.trace.index.size(); ++k) {
    const auto contact_dof = static_cast<std::size_t>(support.trace.index[k]);
    if (contact_dof % 2 == 0 && contact_dof / 2 < nodes)
      nodes_[contact_dof / 2].row = dofs.first_free + support.trace.local_row[k];
  }
  const auto local = static_cast<PetscInt>(dofs.natural_owned.size());
  RBVI_CALL(MatCreateAIJ(problem.comm(), local, local, PETSC_DETERMINE, PETSC_DETERMINE, 2, nullptr,
                         1, nullptr, q_.put()));
}

void LocalFrames::set(const FullMu &all_parameters) {
  const Scene &scene = problem_.scene();
  PetscInt first = 0, last = 0;
  RBVI_CALL(MatGetOwnershipRange(q_.get(), &first, &last));
  for (PetscInt row = first; row < last; ++row)
    RBVI_CALL(MatSetValue(q_.get(), row, row, 1, INSERT_VALUES));
  for (Node &node : nodes_) {
    const Point &x = node.reference;
    node.n = scene.support->normal(all_parameters, x);
    node.gap = scene.support->gap(all_parameters, x);
    if (scene.motion) {
      const Point motion = scene.motion(all_parameters, x);
      node.gap -= motion[0] * node.n[0] + motion[1] * node.n[1];
    }
    if (node.row < first || node.row >= last) continue;
    const std::array<PetscInt, 2> rows{node.row, node.row + 1};
    const std::array<double, 4> frame{node.n[0], -node.n[1], node.n[1], node.n[0]}; // (n, tau)
    RBVI_CALL(MatSetValues(q_.get(), 2, rows.data(), 2, rows.data(), frame.data(), INSERT_VALUES));
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

void LocalFrames::turn(std::vector<NitscheFace> &faces, const std::vector<int> &node_of_dof) const {
  for (NitscheFace &face : faces)
    for (std::size_t i = 0; i < 12; i += 2) {
      if (face.dofs[i] < 0) continue;
      const int k = node_of_dof[static_cast<std::size_t>(face.dofs[i])];
      if (k < 0) continue;
      const Point &n = nodes_[static_cast<std::size_t>(k)].n;
      for (NitschePoint &point : face.points)
        for (NitschePoint::Row *row : {&point.sigma_n, &point.sigma_tau, &point.n, &point.tau}) {
          auto pair = row->segment<2>(static_cast<Index>(i));
          pair = Eigen::Vector2d(n[0] * pair[0] + n[1] * pair[1], n[0] * pair[1] - n[1] * pair[0]);
        }
    }
}

Handle<Vec> LocalFrames::upper() const {
  Handle<Vec> result;
  PetscInt first = 0, last = 0;
  RBVI_CALL(MatCreateVecs(q_.get(), result.put(), nullptr));
  RBVI_CALL(VecSet(result.get(), PETSC_INFINITY));
  RBVI_CALL(VecGetOwnershipRange(result.get(), &first, &last));
  for (const Node &node : nodes_)
    if (node.row >= first && node.row < last)
      RBVI_CALL(VecSetValue(result.get(), node.row, node.gap, INSERT_VALUES));
  RBVI_CALL(VecAssemblyBegin(result.get()));
  RBVI_CALL(VecAssemblyEnd(result.get()));
  return result;
}

} // namespace rbvi
