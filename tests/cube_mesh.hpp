// The unit cube as a Gmsh mesh, for tests in three dimensions.
#pragma once

#include <array>
#include <cmath>
#include <cstdlib>
#include <iomanip>
#include <sstream>
#include <string>
#include <vector>

namespace rbvi {

/// Gmsh text of the unit cube in n^3 boxes of six tetrahedra; region "core": the middle third,
/// boundary "boundary": all sides, "x0", "x1", ..., "z1": each of them. Vertices inside are moved
/// by up to `shake` lengths of a box. `images`: whether its images beyond x = 0, y = 0, z = 0 come
/// with it; what was "x0" is then inside, and "x1" is both sides.
inline std::string cube_mesh(int n, double shake = 0, std::array<bool, 3> images = {}) {
  std::ostringstream nodes, elements;
  int element = 0;
  const std::array<int, 3> low{images[0] ? -n : 0, images[1] ? -n : 0, images[2] ? -n : 0};
  const auto node = [n, low](int i, int j, int k) {
    return 1 + i - low[0] + (n + 1 - low[0]) * (j - low[1] + (n + 1 - low[1]) * (k - low[2]));
  };
  const auto moved = [n, shake](int i, int j, int k) {
    const bool inner = i % n != 0 && j % n != 0 && k % n != 0;
    const double by = 1.0 + 3 * std::abs(i) + 5 * std::abs(j) + 7 * std::abs(k);
    return inner ? (i > 0 ? 1 : -1) * shake * std::sin(by) : 0;
  };
  // Of a box: its corner next to the origin, and the way to the others.
  const auto near = [](int i) { return i >= 0 ? i : i + 1; };
  const auto step = [](int i) { return i >= 0 ? 1 : -1; };
  nodes << std::setprecision(17);
  for (int k = low[2]; k <= n; ++k)
    for (int j = low[1]; j <= n; ++j)
      for (int i = low[0]; i <= n; ++i)
        nodes << node(i, j, k) << " " << (i + moved(i, j, k)) / n << " " << (j + moved(j, k, i)) / n
              << " " << (k + moved(k, i, j)) / n << "\n";
  const auto add = [&](int type, int tag, const std::vector<int> &vertices) {
    elements << ++element << " " << type << " 2 " << tag << " 1";
    for (const int v : vertices)
      elements << " " << v;
    elements << "\n";
  };
  const auto inside = [n, near](int i) {
    const int from = std::abs(near(i));
    return 3 * from >= n && 3 * (from + 1) <= 2 * n;
  };
  const int steps[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (int k = low[2]; k < n; ++k)
    for (int j = low[1]; j < n; ++j)
      for (int i = low[0]; i < n; ++i)
        for (const auto &order :
             steps) { // Kuhn: from corner to corner along the axes in every order
          const int box[3] = {i, j, k};
          int at[3] = {near(i), near(j), near(k)};
          std::vector<int> vertices{node(at[0], at[1], at[2])};
          for (const int axis : order) {
            at[axis] += step(box[axis]);
            vertices.push_back(node(at[0], at[1], at[2]));
          }
          add(4, inside(i) && inside(j) && inside(k) ? 2 : 3, vertices);
        }
  for (int axis = 0; axis < 3; ++axis)
    for (const int side : {low[axis], n})
      for (int p = low[(axis + 1) % 3]; p < n; ++p)
        for (int q = low[(axis + 2) % 3]; q < n; ++q) {
          const auto corner = [&](int a, int b) {
            int at[3];
            at[axis] = side;
            at[(axis + 1) % 3] = near(p) + a * step(p);
            at[(axis + 2) % 3] = near(q) + b * step(q);
            return node(at[0], at[1], at[2]);
          };
          for (const int group : {1, 4 + 2 * axis + (side != 0 ? 1 : 0)}) {
            add(2, group, {corner(0, 0), corner(1, 0), corner(1, 1)});
            add(2, group, {corner(0, 0), corner(0, 1), corner(1, 1)});
          }
        }
  std::ostringstream out;
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n9\n2 1 \"boundary\"\n3 2 \"core\"\n"
      << "3 3 \"rest\"\n2 4 \"x0\"\n2 5 \"x1\"\n2 6 \"y0\"\n2 7 \"y1\"\n2 8 \"z0\"\n2 9 "
         "\"z1\"\n$EndPhysicalNames\n$Nodes\n"
      << (n + 1 - low[0]) * (n + 1 - low[1]) * (n + 1 - low[2]) << "\n"
      << nodes.str() << "$EndNodes\n$Elements\n"
      << element << "\n"
      << elements.str() << "$EndElements\n";
  return out.str();
}

} // namespace rbvi
