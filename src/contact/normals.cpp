// The field of normals of a master curve.
#include "rbvi/contact/partners.hpp"
#include "rbvi/core/error.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// A quarter turn to the left of a tangent, of length 1.
Point leftwards(const Point &tangent) {
  const double length = norm(tangent);
  if (!(length > 0)) throw failure("an edge of a contact curve has lost its length");
  return {-tangent[1] / length, tangent[0] / length, 0};
}

Point mean(const Point &a, const Point &b) {
  const Point sum = a + b;
  const double length = norm(sum);
  if (!(length > 1e-3)) throw failure("a contact curve has folded back on itself");
  return sum / length;
}

bool is_sharp(const Point &before, const Point &after) {
  return std::atan2(norm(cross(before, after)), dot(before, after)) > sharp_turn;
}

} // namespace

std::vector<CurveSection> sections_of(const NodalCurve &curve, bool whole) {
  std::vector<CurveSection> sections;
  for (const CurveChain &piece : curve.shape().pieces) {
    const auto edge = [&](Index k) { return piece.first_edge + k % piece.edges; };
    const auto corner_before = [&](Index k) { // or an end
      if (k % piece.edges == 0 && !piece.loop) return true;
      return !whole &&
             is_sharp(curve.tangent(edge(k + piece.edges - 1), 1), curve.tangent(edge(k), 0));
    };
    Index first = 0;
    while (first < piece.edges && !corner_before(first))
      ++first;
    if (first == piece.edges) {
      CurveSection &all = sections.emplace_back(CurveSection{{}, true});
      for (Index k = 0; k < piece.edges; ++k)
        all.edges.push_back(edge(k));
      continue;
    }
    for (Index k = first; k < first + piece.edges; ++k) {
      if (corner_before(k)) sections.emplace_back();
      sections.back().edges.push_back(edge(k));
    }
  }
  return sections;
}

EdgeNormals averaged_normals(const NodalCurve &curve, const std::vector<CurveSection> &sections,
                             const std::vector<int> &fixed) {
  EdgeNormals normals(curve.edges());
  for (Index e = 0; e < curve.edges(); ++e)
    normals[e] = {leftwards(curve.tangent(e, 0)), leftwards(curve.tangent(e, 1)),
                  leftwards(curve.tangent(e, 0.5))};
  const auto mirrored = [&](Index vertex, Point &n) {
    if (fixed[vertex] != 1 && fixed[vertex] != 2) return;
    const Point image = fixed[vertex] == 1 ? Point{-n[0], n[1], 0} : Point{n[0], -n[1], 0};
    if (!is_sharp(n, image)) n = mean(n, image);
  };
  for (const auto &[edges, loop] : sections) {
    for (std::size_t k = loop ? 0 : 1; k < edges.size(); ++k) {
      Point &before = normals[edges[(k + edges.size() - 1) % edges.size()]][1],
            &after = normals[edges[k]][0];
      before = after = mean(before, after);
    }
    if (loop) continue;
    mirrored(curve.node(edges.front(), 0), normals[edges.front()][0]);
    mirrored(curve.node(edges.back(), 1), normals[edges.back()][1]);
  }
  return normals;
}

EdgeNormals vertical_normals(const NodalCurve &curve) {
  const Point up{0, 1, 0};
  return EdgeNormals(curve.edges(), {up, up, up});
}

} // namespace rbvi
