#include "rbvi/mor/nodal_dual_basis.hpp"

#include "rbvi/contact/transfer.hpp"
#include "rbvi/core/error.hpp"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// Whether node i is the mirror image of node count - 1 - i.
bool is_mirrored(const std::vector<Point> &points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point &x = points[i], &y = points[points.size() - 1 - i];
    if (std::hypot(x[0] + y[0], x[1] - y[1]) > 1e-12) return false;
  }
  return true;
}

/// lambda_n even, lambda_tau odd about the middle, to 1e-8 of the largest of all.
bool symmetric(const Matrix &snapshots, Index nodes, double largest) {
  for (Index first = 0; first < snapshots.rows(); first += nodes) {
    const Matrix part = snapshots.middleRows(first, nodes);
    const double sign = first == 0 ? 1 : -1;
    const double defect = (part - sign * part.colwise().reverse()).cwiseAbs().maxCoeff();
    if (defect > 1e-8 * largest) return false;
  }
  return true;
}

/// Whether every interface has mirrored nodes, in one tangential direction at most.
bool is_mirrored(const Contact &contact) {
  return std::ranges::all_of(contact.interfaces, [](const auto &interface) {
    const DualSpace &dual = interface->dual();
    return dual.components <= 2 && is_mirrored(dual.points);
  });
}

bool symmetric(const Contact &contact, const Matrix &snapshots) {
  const double largest = snapshots.cwiseAbs().maxCoeff();
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    const DualSpace &dual = contact.interfaces[i]->dual();
    if (!symmetric(snapshots.middleRows(contact.first_row[i], dual.size()), dual.nodes(), largest))
      return false;
  }
  return true;
}

/// One column for each dual dof, or, where `halves`, for each pair of mirror images.
SparseMatrix columns_of_nodes(const Contact &contact, bool halves) {
  std::vector<Eigen::Triplet<double>> entries;
  Index column = 0;
  for (int component = 0; component < 3; ++component) // normal multipliers first
    for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
      const DualSpace &dual = contact.interfaces[i]->dual();
      if (component >= dual.components) continue;
      const Index nodes = dual.nodes(), first = contact.first_row[i] + component * nodes;
      const Index count = halves ? (nodes + 1) / 2 : nodes;
      for (Index k = 0; k < count; ++k, ++column) {
        if (halves && nodes - 1 - k != k)
          entries.emplace_back(first + nodes - 1 - k, column, component == 0 ? 1 : -1);
        entries.emplace_back(first + k, column, 1);
      }
    }
  SparseMatrix basis(contact.dual_size(), column);
  basis.setFromTriplets(entries.begin(), entries.end());
  return basis;
}

std::unique_ptr<Problem> of_level(const Problem &problem, int level) {
  std::unique_ptr<Problem> coarse = problem.coarser(level);
  if (!coarse)
    throw bad_input("the mesh has no level that is " + std::to_string(level) + " times coarser");
  return coarse;
}

} // namespace

SparseMatrix hats_of_level(const Problem &problem, int level) {
  return interpolation(of_level(problem, level)->contact(), problem.contact());
}

Matrix nodal_dual_basis(const Problem &problem, const Matrix &snapshots, int level) {
  const Contact &contact = problem.contact();
  const bool halves =
      is_symmetric(problem.scene()) && is_mirrored(contact) && symmetric(contact, snapshots);
  if (level == 0) return columns_of_nodes(contact, halves);
  const std::unique_ptr<Problem> coarse = of_level(problem, level);
  return interpolation(coarse->contact(), contact) *
         columns_of_nodes(coarse->contact(), halves && is_mirrored(coarse->contact()));
}

Matrix nodal_coefficients(const Matrix &basis, const Matrix &multipliers) {
  const SparseMatrix sparse = basis.sparseView();
  const Eigen::SparseMatrix<double> transposed = sparse.transpose();
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> gram(transposed *
                                                                transposed.transpose());
  return gram.solve(transposed * multipliers);
}

} // namespace rbvi
