// Reduced models of two bodies with small curves and random bases, for tests that compute the
// answer another way.
#pragma once

#include "../couple.hpp"
#include "brute_force.hpp"

#include "rbvi/contact/contact_pair.hpp"
#include "rbvi/contact/pair.hpp"
#include "tests/catalogue.hpp"

#include <algorithm>

namespace rbvi::synthetic {

inline Scene scene_with(const std::string &multiplier,
                        const std::string &integration = "intersection") {
  return make_scene("two_disks",
                    {{"degree", "1"}, {"multiplier", multiplier}, {"integration", integration}});
}

inline Scene p0() {
  return scene_with("p0");
}

inline Scene p1() {
  return scene_with("p1");
}

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
    const double t = std::numbers::pi / 4 * (angle / angles.back()); // the ends exactly
    points.push_back({std::sin(t), sign * (1.5 - std::cos(t)), 0});
  }
  return points;
}

/// Two fans of triangles between the curves and the centres of the disks.
inline void add_fans(const PairSizes &sizes, ReducedModel &model) {
  const auto slave = static_cast<int>(sizes.slave), master = static_cast<int>(sizes.master);
  model.fields.points.resize(sizes.slave + sizes.master + 2, 2);
  model.fields.points.topRows(2) << 0, 1.5, 0, -1.5;
  InterfaceModel &contact = model.contact.interfaces.front();
  for (int i = 0; i < slave + master; ++i) {
    contact.nodes.push_back(2 + i);
    const Point &x = contact.mesh.points[i];
    model.fields.points.row(2 + i) << x[0], x[1];
  }
  model.fields.cells.clear();
  for (int i = 0; i + 1 < slave; ++i)
    model.fields.cells.insert(model.fields.cells.end(), {0, 2 + i, 3 + i});
  for (int i = slave; i + 1 < slave + master; ++i)
    model.fields.cells.insert(model.fields.cells.end(), {1, 3 + i, 2 + i});
}

/// Two curves of degree 1; the pair sees the vertical displacement of node i as column i.
inline InterfaceMesh pair_mesh(const std::vector<Point> &slave, const std::vector<Point> &master) {
  InterfaceMesh mesh;
  mesh.components = 2;
  for (const std::vector<Point> *curve : {&slave, &master}) {
    const auto first = static_cast<int>(mesh.points.size());
    mesh.points.insert(mesh.points.end(), curve->begin(), curve->end());
    mesh.parts.push_back(static_cast<int>(curve->size()));
    for (int i = first; i + 1 < first + mesh.parts.back(); ++i)
      mesh.entities.insert(mesh.entities.end(), {i, i + 1});
  }
  mesh.columns = mesh.nodes();
  for (int i = 0; i < mesh.columns; ++i)
    mesh.dofs.insert(mesh.dofs.end(), {-1, i});
  return mesh;
}

/// Of the options of a scene of two bodies.
inline PairDiscretisation discretisation_of(const Scene &scene) {
  return {scene.options.at("multiplier") == "p1" ? MultiplierSpace::nodes
                                                 : MultiplierSpace::macro_edges,
          scene.options.at("integration") == "direct" ? PairQuadrature::direct
                                                      : PairQuadrature::intersection,
          PairProjection::vertical};
}

/// On the forms of two_disks; A has one term. The trace is that of the basis.
inline ReducedModel random_pair_model(const PairSizes &sizes, unsigned seed, const Scene &scene) {
  std::mt19937 random(seed);
  ReducedModel model = named_model(scene, sizes);
  const Index n = model.primal_size();
  model.body.a = random_terms(random, n * (n + 1) / 2, 1, 1);
  model.body.a.interpolation.resize(0, 0); // one exact term
  model.body.a.samples.clear();
  model.body.a.exact = 1;
  model.body.a.reduced = pack(random_spd(random, n));

  const std::vector<Point> slave = arc_points(random, sizes.slave, 1),
                           master = arc_points(random, sizes.master, -1);
  model.contact.interfaces = {{pair_mesh(slave, master), {}}};
  add_fans(sizes, model);
  model.fields.basis = random_matrix(random, 2 * model.fields.points.rows(), n);
  model.contact.trace.resize(sizes.slave + sizes.master, n);
  for (Index i = 0; i < model.contact.trace.rows(); ++i)
    model.contact.trace.row(i) = model.fields.basis.row(2 * (2 + i) + 1);
  const Index dual = multiplier_count(sizes.slave, discretisation_of(scene).multiplier);
  model.contact.dual_basis = random_matrix(random, dual, sizes.generators).cwiseAbs();
  return model;
}

/// The operators of the curves mapped here, without the motion.
inline PairOperators mapped_pair(const ReducedModel &model, const Scene &scene, const FullMu &mu) {
  const InterfaceMesh &curves = model.contact.interfaces.front().mesh;
  std::vector<Point> slave, master;
  for (std::size_t i = 0; i < curves.points.size(); ++i)
    (static_cast<int>(i) < curves.parts[0] ? slave : master)
        .push_back(scene.map(mu, curves.points[i]));
  return couple(slave, master, discretisation_of(scene));
}

/// The reduced operators computed another way: the curves mapped here, coupled, the motion taken
/// into the gap by hand, projected densely.
inline brute::Operators pair_operators(const ReducedModel &model, const Scene &scene,
                                       const Mu &free) {
  const FullMu mu = expand(scene.parameters, free);
  const InterfaceMesh &curves = model.contact.interfaces.front().mesh;
  Vector motion(curves.nodes());
  for (Index i = 0; i < motion.size(); ++i)
    motion[i] = scene.motion ? scene.motion(mu, curves.points[i])[1] : 0;
  const PairOperators pair = mapped_pair(model, scene, mu);
  const Matrix b = pair.b;
  const Index n = model.primal_size();
  const Vector packed = model.body.a.reduced.col(0);
  brute::Operators result;
  result.a.resize(n, n);
  for (Index j = 0, at = 0; j < n; ++j)
    for (Index i = j; i < n; ++i, ++at)
      result.a(i, j) = result.a(j, i) = packed[at];
  result.b = model.contact.dual_basis.transpose() * b * model.contact.trace;
  result.f = Vector::Zero(n);
  result.g = model.contact.dual_basis.transpose() * (pair.g - b * motion);
  return result;
}

} // namespace rbvi::synthetic
