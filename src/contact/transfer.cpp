#include "rbvi/contact/transfer.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace rbvi {

namespace {

double squared_distance(const Point &a, const Point &b) {
  return std::pow(a[0] - b[0], 2) + std::pow(a[1] - b[1], 2) + std::pow(a[2] - b[2], 2);
}

struct Neighbour {
  double squared_distance;
  Index point;
  bool operator<(const Neighbour &other) const {
    return std::tie(squared_distance, point) < std::tie(other.squared_distance, other.point);
  }
};

/// Finds the nearest of some points by a grid of cubes.
class NearestPoints {
public:
  explicit NearestPoints(const std::vector<Point> &points) : points_(points) {
    Point lower = points.front(), upper = points.front();
    for (const Point &p : points)
      for (std::size_t k = 0; k < 3; ++k) {
        lower[k] = std::min(lower[k], p[k]);
        upper[k] = std::max(upper[k], p[k]);
      }
    lower_ = lower;
    // A few points in a cube, on a curve; more on a surface.
    const double longest =
        std::max({upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]});
    cubes_ = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(points.size()))));
    width_ = longest > 0 ? longest / cubes_ : 1;
    for (std::size_t i = 0; i < points.size(); ++i)
      cube_[key(points[i])].push_back(static_cast<Index>(i));
  }

  /// Sorted by distance.
  std::vector<Neighbour> of(const Point &x, std::size_t count) const {
    std::vector<Neighbour> found;
    const Key centre = key(x);
    for (int reach = 0;; ++reach) {
      add_shell(x, centre, reach, found);
      std::sort(found.begin(), found.end());
      // All points within `reach` widths have been seen.
      const bool enough =
          found.size() >= count && found[count - 1].squared_distance <= std::pow(reach * width_, 2);
      if (enough || found.size() == points_.size()) break;
    }
    found.resize(std::min(count, found.size()));
    return found;
  }

private:
  using Key = std::array<int, 3>;

  Key key(const Point &x) const {
    Key result{};
    for (std::size_t k = 0; k < 3; ++k)
      result[k] = static_cast<int>(std::floor((x[k] - lower_[k]) / width_));
    return result;
  }
  /// The points of the cubes exactly `reach` from the centre, in one direction at least.
  void add_shell(const Point &x, const Key &centre, int reach,
                 std::vector<Neighbour> &found) const {
    for (int i = -reach; i <= reach; ++i)
      for (int j = -reach; j <= reach; ++j)
        for (int k = -reach; k <= reach; ++k) {
          if (std::max({std::abs(i), std::abs(j), std::abs(k)}) != reach) continue;
          const auto cube = cube_.find({centre[0] + i, centre[1] + j, centre[2] + k});
          if (cube == cube_.end()) continue;
          for (const Index p : cube->second)
            found.push_back({squared_distance(x, points_[static_cast<std::size_t>(p)]), p});
        }
  }

  const std::vector<Point> &points_;
  Point lower_{};
  int cubes_ = 1;
  double width_ = 1;
  std::map<Key, std::vector<Index>> cube_;
};

/// Weights of the neighbours; all on the nearest one where x is that point.
std::vector<double> weights_of(const std::vector<Neighbour> &neighbours) {
  std::vector<double> weights(neighbours.size(), 0);
  const double nearest = neighbours.front().squared_distance;
  if (nearest <= 1e-20 * neighbours.back().squared_distance) {
    weights.front() = 1;
    return weights;
  }
  double sum = 0;
  for (std::size_t k = 0; k < weights.size(); ++k)
    sum += weights[k] = nearest / neighbours[k].squared_distance;
  for (double &weight : weights)
    weight /= sum;
  return weights;
}

} // namespace

Vector transferred(const Contact &from, const Contact &to, const Vector &values) {
  if (from.interfaces.size() != to.interfaces.size() || values.size() != from.dual_size())
    throw failure("multipliers can be transferred between meshes of one scene alone");
  Vector result = Vector::Zero(to.dual_size());
  for (std::size_t i = 0; i < from.interfaces.size(); ++i) {
    const DualSpace &coarse = from.interfaces[i]->dual(), &fine = to.interfaces[i]->dual();
    const std::size_t count = from.interfaces[i]->mesh().per_entity == 2 ? 2 : 3;
    const NearestPoints nearest(coarse.points);
    for (Index node = 0; node < fine.nodes(); ++node) {
      const std::vector<Neighbour> neighbours =
          nearest.of(fine.points[static_cast<std::size_t>(node)], count);
      const std::vector<double> weights = weights_of(neighbours);
      // Rows of an interface: the normal multipliers of all nodes, then the tangential ones.
      for (int c = 0; c < fine.components; ++c)
        for (std::size_t k = 0; k < neighbours.size(); ++k) {
          const auto row = [&](const DualSpace &dual, Index n) {
            return c == 0 ? n : dual.nodes() + n * (dual.components - 1) + c - 1;
          };
          result[to.first_row[i] + row(fine, node)] +=
              weights[k] * values[from.first_row[i] + row(coarse, neighbours[k].point)];
        }
    }
  }
  return result;
}

} // namespace rbvi
