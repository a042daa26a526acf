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
    // A few points in a cube, on a curve; more on a surface.
    const double longest =
        std::max({upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]});
    const int cubes = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(points.size()))));
    width_ = longest > 0 ? longest / cubes : 1;
    lower_ = lower;
    last_ = key(upper);
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
    const auto first = [&](std::size_t k) { return std::max(-reach, -centre[k]); };
    const auto last = [&](std::size_t k) { return std::min(reach, last_[k] - centre[k]); };
    for (int i = first(0); i <= last(0); ++i)
      for (int j = first(1); j <= last(1); ++j)
        for (int k = first(2); k <= last(2); ++k) {
          if (std::max({std::abs(i), std::abs(j), std::abs(k)}) != reach) continue;
          const auto cube = cube_.find({centre[0] + i, centre[1] + j, centre[2] + k});
          if (cube == cube_.end()) continue;
          for (const Index p : cube->second)
            found.push_back({squared_distance(x, points_[p]), p});
        }
  }

  const std::vector<Point> &points_;
  Point lower_{};
  Key last_{}; ///< the cube of the upper corner
  double width_ = 1;
  std::map<Key, std::vector<Index>> cube_;
};

using Weights = std::vector<std::pair<Index, double>>; ///< node and weight

/// Whether x is the nearest one of some points.
bool coincides(const std::vector<Neighbour> &neighbours) {
  return neighbours.front().squared_distance <= 1e-20 * neighbours.back().squared_distance;
}

Weights by_distance(const std::vector<Neighbour> &neighbours) {
  const double nearest = neighbours.front().squared_distance;
  double sum = 0;
  Weights weights;
  for (const Neighbour &neighbour : neighbours)
    sum += weights.emplace_back(neighbour.point, nearest / neighbour.squared_distance).second;
  for (auto &[node, weight] : weights)
    weight /= sum;
  return weights;
}

/// The edges or triangles of an interface around its dual nodes; none where not all of their nodes
/// are such.
class DualEntities {
public:
  explicit DualEntities(const ContactInterface &interface) : dual_(interface.dual()) {
    const InterfaceMesh &mesh = interface.mesh();
    around_.resize(dual_.points.size());
    if (mesh.degree != 1 || mesh.per_entity > 3) return;
    std::vector<Index> dual_node(mesh.points.size(), -1);
    for (std::size_t i = 0; i < dual_.vertices.size(); ++i)
      dual_node[dual_.vertices[i]] = static_cast<Index>(i);
    for (Index e = 0; e < mesh.count(); ++e) {
      std::vector<Index> nodes;
      for (int k = 0; k < mesh.per_entity; ++k)
        nodes.push_back(dual_node[mesh.nodes_of(e)[k]]);
      if (std::ranges::any_of(nodes, [](Index node) { return node < 0; })) continue;
      for (const Index node : nodes)
        around_[node].push_back(nodes);
    }
  }

  /// Linear interpolation at x in the entity around one of these nodes that holds it, or that it is
  /// least outside of, there at a point of its boundary. Empty where there is no entity.
  Weights linear(const Point &x, const std::vector<Neighbour> &near) const {
    constexpr double vanishing = 1e-8;
    Eigen::Vector3d best = Eigen::Vector3d::Zero();
    const std::vector<Index> *chosen = nullptr;
    for (const Neighbour &neighbour : near)
      for (const std::vector<Index> &entity : around_[neighbour.point]) {
        if (chosen != nullptr && best.minCoeff() >= 0) break;
        const Eigen::Vector3d weights = barycentric(x, entity);
        if (chosen != nullptr && !(weights.minCoeff() > best.minCoeff())) continue;
        best = weights;
        chosen = &entity;
      }
    Weights result;
    if (chosen == nullptr) return result;
    double sum = 0;
    for (std::size_t k = 0; k < chosen->size(); ++k)
      if (const double weight = best[static_cast<Index>(k)]; weight > vanishing)
        sum += result.emplace_back((*chosen)[k], weight).second;
    for (auto &[node, weight] : result)
      weight /= sum;
    return result;
  }

private:
  Eigen::Vector3d point(Index node) const {
    return Eigen::Vector3d::Map(dual_.points[node].data());
  }
  /// Of the projection of x onto the line or plane of the entity; the third is 1 on an edge.
  Eigen::Vector3d barycentric(const Point &x, const std::vector<Index> &entity) const {
    const Eigen::Vector3d first = point(entity[0]), side = point(entity[1]) - first;
    const Eigen::Vector3d from = Eigen::Vector3d::Map(x.data()) - first;
    const double square = side.squaredNorm(), along = side.dot(from) / square;
    if (entity.size() == 2) return {1 - along, along, 1};
    // The part of the other side, and of x, across the first one.
    const Eigen::Vector3d other = point(entity[2]) - first;
    const double skew = side.dot(other) / square;
    const Eigen::Vector3d across = other - skew * side;
    const double height = across.dot(from) / across.squaredNorm();
    const double second = along - skew * height;
    return {1 - second - height, second, height};
  }

  const DualSpace &dual_;
  std::vector<std::vector<std::vector<Index>>> around_; ///< entities of each dual node
};

/// Row of component c of a node: the normal multipliers of all nodes come first.
Index row_of(const DualSpace &dual, Index node, int c) {
  return c == 0 ? node : dual.nodes() + node * (dual.components - 1) + c - 1;
}

} // namespace

SparseMatrix interpolation(const Contact &from, const Contact &to,
                           const std::vector<WantedNodes> &wanted) {
  if (from.interfaces.size() != to.interfaces.size())
    throw failure("multipliers can be transferred between meshes of one scene alone");
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t i = 0; i < from.interfaces.size(); ++i) {
    const DualSpace &coarse = from.interfaces[i]->dual(), &fine = to.interfaces[i]->dual();
    const std::size_t count = from.interfaces[i]->mesh().per_entity == 2 ? 2 : 3;
    const NearestPoints nearest(coarse.points);
    const DualEntities entities(*from.interfaces[i]);
    for (Index node = 0; node < fine.nodes(); ++node) {
      if (!wanted.empty() && !is_wanted(wanted[i], node)) continue;
      const Point &x = fine.points[node];
      const std::vector<Neighbour> near = nearest.of(x, count);
      Weights weights;
      if (coincides(near))
        weights = {{near.front().point, 1}};
      else
        weights = entities.linear(x, near);
      if (weights.empty()) weights = by_distance(near);
      for (int c = 0; c < fine.components; ++c)
        for (const auto &[point, weight] : weights)
          entries.emplace_back(static_cast<int>(to.first_row[i] + row_of(fine, node, c)),
                               static_cast<int>(from.first_row[i] + row_of(coarse, point, c)),
                               weight);
    }
  }
  SparseMatrix result(to.dual_size(), from.dual_size());
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

} // namespace rbvi
