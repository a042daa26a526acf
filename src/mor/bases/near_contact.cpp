#include "rbvi/mor/bases/near_contact.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rbvi {

namespace {

double squared_distance(const Point &a, const Point &b) {
  double sum = 0;
  for (std::size_t c = 0; c < a.size(); ++c)
    sum += (a[c] - b[c]) * (a[c] - b[c]);
  return sum;
}

/// Squared; of the bounding box.
double squared_extent(const std::vector<Point> &points) {
  Point low = points.front(), high = low;
  for (const Point &point : points)
    for (std::size_t c = 0; c < point.size(); ++c) {
      low[c] = std::min(low[c], point[c]);
      high[c] = std::max(high[c], point[c]);
    }
  return squared_distance(low, high);
}

/// Per node of the interface at rows `first`: whether it is near one that carries.
std::vector<bool> near_contact(const DualSpace &dual, Index first, const Matrix &snapshots,
                               double ring) {
  constexpr double round_off = 1e-12; // some solvers leave it where nothing touches
  const double least = round_off * snapshots.cwiseAbs().maxCoeff();
  std::vector<Point> carrying;
  for (Index node = 0; node < dual.nodes(); ++node)
    for (Index row = node; row < dual.size(); row += dual.nodes())
      if (snapshots.row(first + row).cwiseAbs().maxCoeff() > least) {
        carrying.push_back(dual.points[static_cast<std::size_t>(node)]);
        break;
      }
  std::vector<bool> near(static_cast<std::size_t>(dual.nodes()), true);
  if (carrying.size() < 2) return near;
  const double reach = ring * ring * squared_extent(carrying);
  for (std::size_t node = 0; node < near.size(); ++node)
    near[node] = std::ranges::any_of(carrying, [&](const Point &point) {
      return squared_distance(point, dual.points[node]) <= reach;
    });
  return near;
}

} // namespace

std::vector<Index> columns_near_contact(const Contact &contact, const Matrix &basis,
                                        const Matrix &snapshots, double ring) {
  std::vector<Index> columns(static_cast<std::size_t>(basis.cols()));
  std::iota(columns.begin(), columns.end(), 0);
  if (std::isinf(ring)) return columns;
  std::vector<std::vector<bool>> near;
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i)
    near.push_back(
        near_contact(contact.interfaces[i]->dual(), contact.first_row[i], snapshots, ring));
  std::erase_if(columns, [&](Index column) {
    Index row = 0;
    basis.col(column).cwiseAbs().maxCoeff(&row);
    const DualRow of = dual_row(contact, row);
    return !near[of.interface][static_cast<std::size_t>(of.node)];
  });
  return columns;
}

} // namespace rbvi
