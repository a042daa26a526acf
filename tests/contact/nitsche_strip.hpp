// A curve of Nitsche's method with a strip of triangles beside it, and a half disk it belongs to.
#pragma once

#include "../element/cells.hpp"
#include "rbvi/contact/nitsche_support.hpp"
#include "support_scenes.hpp"

namespace rbvi {

/// Triangles above a curve or, listing their edges against increasing x, below it; neighbours share
/// a vertex. The edges on the curve are the local edges 0, 1 and 2 in turn.
struct Strip {
  std::vector<CurveCell> cells;
  std::vector<Point> nodes; ///< of the reference domain; dof = 2 * node + component
};

enum class Side { above, below };

inline Strip strip(int degree, const Curve &curve, Side side = Side::above) {
  Strip result{{}, curve};
  for (std::size_t k = 0; k + 1 < curve.size(); ++k) {
    const std::size_t first = side == Side::above ? k : k + 1, second = 2 * k + 1 - first;
    const std::size_t edge = k % 3, end = (edge + 1) % 3;
    Point apex = between(curve[k], curve[k + 1], 0.5);
    apex[1] += side == Side::above ? 0.2 : -0.2;
    CurveCell beside{{2, {}, {}}, static_cast<int>(edge), {}};
    beside.cell.reference[edge] = curve[first];
    beside.cell.reference[end] = curve[second];
    beside.cell.reference[3 - edge - end] = apex;
    beside.cell.mapped = beside.cell.reference;
    beside.dofs.fill(-1);
    const auto nodes = nodes_of(2, degree, beside.cell.reference);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      std::size_t node = result.nodes.size();
      if (i == edge || i == end)
        node = i == edge ? first : second;
      else
        result.nodes.push_back({nodes[i][0], nodes[i][1], 0});
      beside.dofs[2 * i] = static_cast<int>(2 * node);
      beside.dofs[2 * i + 1] = static_cast<int>(2 * node + 1);
    }
    beside.ends = {static_cast<int>(first), static_cast<int>(second)};
    result.cells.push_back(beside);
  }
  return result;
}

/// Displacements of the nodes by a field of the mapped domain.
inline Vector nodal(const Scene &scene, const FullMu &mu, const Strip &s, const PointField &field) {
  Vector u(2 * static_cast<Index>(s.nodes.size()));
  for (std::size_t i = 0; i < s.nodes.size(); ++i) {
    const Point value = field(scene.map(mu, s.nodes[i]));
    u.segment<2>(2 * static_cast<Index>(i)) << value[0], value[1];
  }
  return u;
}

/// A half disk, stiffer on the right, that is pushed down.
inline SupportScene half_disk(int degree) {
  SupportScene scene = hertz(degree);
  scene.motion = [](const FullMu &, const Point &) { return Point{0.02, -0.1, 0}; };
  scene.materials = {{{}, [](const FullMu &, const Point &x) { return Lame{9 + 3 * x[0], 4}; }}};
  return scene;
}

/// gamma0 = 0.3.
inline NitscheLayer layer_of(const SupportScene &scene, const Strip &s) {
  NitscheCurve curve{scene.support.friction, rigid_contact(scene.support).facing, 0.3};
  curve.images = Vector::Ones(std::ssize(s.cells) + 1);
  return {scene, {curve}, s.cells};
}

} // namespace rbvi
