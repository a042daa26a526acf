#include "rbvi/mor/near_contact.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rbvi {

namespace {

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
