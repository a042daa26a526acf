// A rectangle of triangles as a Gmsh file: the section of a ring.
#pragma once

#include <sstream>
#include <string>

namespace rbvi {

struct Rectangle {
  double x0 = 1, x1 = 2, y0 = 0, y1 = 1;
  int across = 4, up = 4; ///< squares, each of two triangles
};

/// Boundaries bottom, top, inner, outer; regions low and high, its halves.
inline std::string ring_mesh(const Rectangle &ring) {
  std::ostringstream nodes, elements;
  nodes.precision(17);
  const int m = ring.across, n = ring.up;
  const auto node = [m](int i, int j) { return 1 + i + (m + 1) * j; };
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= m; ++i)
      nodes << node(i, j) << ' ' << ring.x0 + (ring.x1 - ring.x0) * i / m << ' '
            << ring.y0 + (ring.y1 - ring.y0) * j / n << " 0\n";
  int count = 0;
  const auto edge = [&](int group, int a, int b) {
    elements << ++count << " 1 2 " << group << " 1 " << a << ' ' << b << '\n';
  };
  for (int i = 0; i < m; ++i) {
    edge(1, node(i, 0), node(i + 1, 0));
    edge(2, node(i, n), node(i + 1, n));
  }
  for (int j = 0; j < n; ++j) {
    edge(3, node(0, j), node(0, j + 1));
    edge(4, node(m, j), node(m, j + 1));
  }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < m; ++i) {
      const std::string group = 2 * j < n ? " 2 2 5 1 " : " 2 2 6 1 ";
      elements << ++count << group << node(i, j) << ' ' << node(i + 1, j) << ' '
               << node(i + 1, j + 1) << '\n';
      elements << ++count << group << node(i, j) << ' ' << node(i + 1, j + 1) << ' '
               << node(i, j + 1) << '\n';
    }
  std::ostringstream out;
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n6\n1 1 \"bottom\"\n1 2 \"top\"\n"
         "1 3 \"inner\"\n1 4 \"outer\"\n2 5 \"low\"\n2 6 \"high\"\n$EndPhysicalNames\n$Nodes\n"
      << (m + 1) * (n + 1) << '\n'
      << nodes.str() << "$EndNodes\n$Elements\n"
      << count << '\n'
      << elements.str() << "$EndElements\n";
  return out.str();
}

} // namespace rbvi
