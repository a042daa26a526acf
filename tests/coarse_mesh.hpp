// A small Gmsh mesh of the membrane scene, for tests that need many solves: 181 nodes, 61 of them
// in the closed disc.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

namespace rbvi {

struct CoarseMesh {
  std::vector<std::array<double, 2>> points;
  std::vector<std::array<int, 3>> disc, rest;
  std::vector<std::array<int, 2>> boundary;
};

/// Disc of 4 rings of 6 k nodes, then 5 rings of 24 nodes that turn from the circle into the
/// square.
inline CoarseMesh make_coarse_mesh() {
  constexpr int rings = 4, around = 6 * rings, outer = 5;
  CoarseMesh mesh;
  const auto node = [=](int ring, int i) {
    if (ring == 0) return 0;
    const int first = ring <= rings ? 1 + 3 * ring * (ring - 1)
                                    : 1 + 3 * rings * (rings + 1) + around * (ring - rings - 1);
    return first + i % (6 * std::min(ring, rings));
  };
  mesh.points.push_back({0, 0});
  for (int ring = 1; ring <= rings + outer; ++ring) {
    const int count = 6 * std::min(ring, rings);
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * i / count, c = std::cos(angle),
                   s = std::sin(angle);
      const double t = std::max(0.0, double(ring - rings) / outer);
      const double circle = 0.05 * std::min(ring, rings);
      const double square = 0.5 / std::max(std::abs(c), std::abs(s));
      const double r = (1 - t) * circle + t * square;
      mesh.points.push_back({r * c, r * s});
    }
  }
  for (int k = 1; k <= rings; ++k)
    for (int sector = 0; sector < 6; ++sector)
      for (int j = 0; j < k; ++j) {
        const int inner = sector * (k - 1) + j, out = sector * k + j;
        mesh.disc.push_back({node(k - 1, inner), node(k, out), node(k, out + 1)});
        if (j + 1 < k)
          mesh.disc.push_back({node(k - 1, inner), node(k, out + 1), node(k - 1, inner + 1)});
      }
  for (int ring = rings; ring < rings + outer; ++ring)
    for (int i = 0; i < around; ++i) {
      mesh.rest.push_back({node(ring, i), node(ring + 1, i), node(ring + 1, i + 1)});
      mesh.rest.push_back({node(ring, i), node(ring + 1, i + 1), node(ring, i + 1)});
    }
  for (int i = 0; i < around; ++i)
    mesh.boundary.push_back({node(rings + outer, i), node(rings + outer, i + 1)});
  return mesh;
}

/// As Gmsh 2.2 text with physical regions "obstacle", "rest" and boundary `boundary`, in units of
/// 1 / scale metres.
inline std::string coarse_gmsh(const std::string &boundary = "boundary", double scale = 1) {
  const CoarseMesh mesh = make_coarse_mesh();
  std::ostringstream out;
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"" << boundary
      << "\"\n2 2 \"obstacle\"\n2 3 \"rest\"\n$EndPhysicalNames\n$Nodes\n"
      << mesh.points.size() << "\n"
      << std::setprecision(17);
  for (std::size_t i = 0; i < mesh.points.size(); ++i)
    out << i + 1 << " " << scale * mesh.points[i][0] << " " << scale * mesh.points[i][1] << " 0\n";
  out << "$EndNodes\n$Elements\n"
      << mesh.boundary.size() + mesh.disc.size() + mesh.rest.size() << "\n";
  int element = 0;
  for (const auto &edge : mesh.boundary)
    out << ++element << " 1 2 1 1 " << edge[0] + 1 << " " << edge[1] + 1 << "\n";
  for (const auto *cells : {&mesh.disc, &mesh.rest})
    for (const auto &cell : *cells)
      out << ++element << " 2 2 " << (cells == &mesh.disc ? 2 : 3) << " 1 " << cell[0] + 1 << " "
          << cell[1] + 1 << " " << cell[2] + 1 << "\n";
  out << "$EndElements\n";
  return out.str();
}

/// The coarse membrane, all of it the region of the obstacle.
inline std::string one_region() {
  std::string text = coarse_gmsh();
  const std::string rest = " 2 2 3 1 ", obstacle = " 2 2 2 1 ";
  for (std::size_t at = 0; (at = text.find(rest)) != std::string::npos;)
    text.replace(at, rest.size(), obstacle);
  return text;
}

} // namespace rbvi
