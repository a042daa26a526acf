// Reduced models of two bodies with small curves and random bases, for tests that compute the
// answer another way.
#pragma once

#include "brute_force.hpp"

#include "rbvi/contact/pair/contact_pair.hpp"

#include <algorithm>

namespace rbvi::synthetic {

struct PairSizes {
  int modes = 4, supremizers = 3, generators = 4;
  Index slave = 12, master = 9; ///< nodes: 5 macro-edges, the last of three edges
};

/// Nodes on the upper (sign 1) or lower (-1) contact arc of the reference disks, not equidistant,
/// from the axis on.
inline std::vector<Point> arc_points(std::mt19937 &random, Index nodes, double sign) {
  std::uniform_real_distribution<double> share(0.5, 1.5);
  std::vector<double> angles{0};
  for (Index i = 1; i < nodes; ++i)
    angles.push_back(angles.back() + share(random));
  std::vector<Point> points;
  for (const double angle : angles) {
    const double t = std::numbers::pi / 4 * angle / angles.back();
    points.push_back({std::sin(t), sign * (1.5 - std::cos(t)), 0});
  }
  return points;
}

/// Two fans of triangles between the curves and the centres of the disks.
inline void add_fans(const PairSizes &sizes, ReducedModel &model) {
  const auto slave = static_cast<int>(sizes.slave), master = static_cast<int>(sizes.master);
  model.mesh_points.resize(sizes.slave + sizes.master + 2, 2);
  model.mesh_points << 0, 1.5, 0, -1.5, model.contact_points;
  model.mesh_cells.clear();
  for (int i = 0; i + 1 < slave; ++i)
    model.mesh_cells.insert(model.mesh_cells.end(), {0, 2 + i, 3 + i});
  for (int i = slave; i + 1 < slave + master; ++i)
    model.mesh_cells.insert(model.mesh_cells.end(), {1, 3 + i, 2 + i});
  for (int i = 0; i < slave + master; ++i)
    model.contact_nodes.push_back(2 + i);
}

/// On the forms of two_disks; A has one term. The trace is that of the basis.
inline ReducedModel random_pair_model(const PairSizes &sizes, unsigned seed, const Scene &scene) {
  std::mt19937 random(seed);
  ReducedModel model = named_model(scene, sizes);
  const Index n = model.primal_size();
  model.a = random_terms(random, n * (n + 1) / 2, 1, 1);
  model.a = {pack(random_spd(random, n)), {}, {}, 0, 1};

  model.slave_nodes = static_cast<int>(sizes.slave);
  std::vector<Point> points = arc_points(random, sizes.slave, 1);
  std::ranges::copy(arc_points(random, sizes.master, -1), std::back_inserter(points));
  model.contact_points.resize(sizes.slave + sizes.master, 2);
  for (Index i = 0; i < model.contact_points.rows(); ++i)
    model.contact_points.row(i) << points[static_cast<std::size_t>(i)][0],
        points[static_cast<std::size_t>(i)][1];
  add_fans(sizes, model);
  model.primal_basis = random_matrix(random, 2 * model.mesh_points.rows(), n);
  model.contact_trace.resize(model.contact_points.rows(), n);
  for (Index i = 0; i < model.contact_trace.rows(); ++i)
    model.contact_trace.row(i) = model.primal_basis.row(2 * (2 + i) + 1);
  const Index dual = multiplier_count(sizes.slave, scene.pair->discretisation.multiplier);
  model.dual_basis = random_matrix(random, dual, sizes.generators).cwiseAbs();
  model.lumped_weights.resize(dual, 0);
  return model;
}

/// The reduced operators computed another way: the curves mapped here, coupled, the motion taken
/// into the gap by hand, projected densely.
inline brute::Operators pair_operators(const ReducedModel &model, const Scene &scene,
                                       const Mu &free) {
  const FullMu mu = expand(scene.parameters, free);
  std::vector<Point> slave, master;
  Vector motion(model.contact_points.rows());
  for (Index i = 0; i < motion.size(); ++i) {
    const Point x = point_of(model.contact_points, i);
    (i < model.slave_nodes ? slave : master).push_back(scene.map(mu, x));
    motion[i] = scene.motion ? scene.motion(mu, x)[1] : 0;
  }
  const PairOperators pair = couple(slave, master, scene.pair->discretisation);
  const Matrix b = pair.b;
  const Index n = model.primal_size();
  const Vector packed = model.a.reduced.col(0);
  brute::Operators result;
  result.a.resize(n, n);
  for (Index j = 0, at = 0; j < n; ++j)
    for (Index i = j; i < n; ++i, ++at)
      result.a(i, j) = result.a(j, i) = packed[at];
  result.b = model.dual_basis.transpose() * b * model.contact_trace;
  result.f = Vector::Zero(n);
  result.g = model.dual_basis.transpose() * (pair.g - b * motion);
  return result;
}

} // namespace rbvi::synthetic
