#include "rbvi/mor/nodal_dual_basis.hpp"

#include "rbvi/contact/transfer.hpp"
#include "rbvi/core/error.hpp"

#include <Eigen/SparseCholesky>

#include <algorithm>
#include <cmath>
#include <numeric>

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
  for (const bool normal : {true, false}) // normal multipliers first
    for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
      const DualSpace &dual = contact.interfaces[i]->dual();
      const Index nodes = dual.nodes(), first = contact.first_row[i] + (normal ? 0 : nodes);
      const Index rows = normal ? nodes : (dual.components - 1) * nodes;
      const Index count = halves ? (rows + 1) / 2 : rows; // mirrored nodes have one tangent
      for (Index k = 0; k < count; ++k, ++column) {
        if (halves && rows - 1 - k != k)
          entries.emplace_back(first + rows - 1 - k, column, normal ? 1 : -1);
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

using At = Eigen::Map<const Eigen::Vector3d>;

/// The diagonal of the bounding box.
double extent(const std::vector<Point> &points) {
  Eigen::Vector3d low = At(points.front().data()), high = low;
  for (const Point &point : points) {
    low = low.cwiseMin(At(point.data()));
    high = high.cwiseMax(At(point.data()));
  }
  return (high - low).norm();
}

/// Per node of an interface: whether it is near one that carries.
std::vector<bool> near_contact(const Contact &contact, std::size_t interface,
                               const Matrix &snapshots, double ring) {
  constexpr double noise = 1e-12; // some solvers leave it where nothing touches
  const double least = noise * snapshots.cwiseAbs().maxCoeff();
  const DualSpace &dual = contact.interfaces[interface]->dual();
  std::vector<bool> carries(dual.nodes(), false);
  for (Index row = contact.first_row[interface]; row < contact.first_row[interface + 1]; ++row)
    if (snapshots.row(row).cwiseAbs().maxCoeff() > least)
      carries[dual_row(contact, row).node] = true;
  std::vector<Point> carrying;
  for (std::size_t node = 0; node < carries.size(); ++node)
    if (carries[node]) carrying.push_back(dual.points[node]);
  std::vector<bool> near(carries.size(), true);
  if (carrying.size() < 2) return near;
  const double reach = ring * extent(carrying);
  for (std::size_t node = 0; node < near.size(); ++node)
    near[node] = std::ranges::any_of(
        carrying, [&](const Point &point) { return norm(point - dual.points[node]) <= reach; });
  return near;
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

std::vector<Index> columns_near_contact(const Contact &contact, const Matrix &basis,
                                        const Matrix &snapshots, double ring) {
  std::vector<Index> columns(basis.cols());
  std::iota(columns.begin(), columns.end(), 0);
  if (std::isinf(ring)) return columns;
  std::vector<std::vector<bool>> near;
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i)
    near.push_back(near_contact(contact, i, snapshots, ring));
  std::erase_if(columns, [&](Index column) {
    Index row = 0;
    basis.col(column).cwiseAbs().maxCoeff(&row);
    const DualRow of = dual_row(contact, row);
    return !near[of.interface][of.node];
  });
  return columns;
}

} // namespace rbvi
