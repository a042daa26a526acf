#include "rbvi/element/cell_fields.hpp"
#include "rbvi/mesh/serial.hpp"

namespace rbvi {

std::vector<int> bodies_of(const SerialMesh &mesh) {
  if (mesh.cells.empty()) return {};
  std::vector<int> vertices;
  for (const auto &cell : mesh.cells)
    vertices.insert(vertices.end(), cell.begin(), cell.begin() + mesh.dim + 1);
  const Vector numbers =
      body_numbers(vertices, mesh.dim + 1, std::ssize(mesh.points), vertices.front());
  std::vector<int> result;
  for (const double number : numbers) // from 1
    result.push_back(static_cast<int>(number) - 1);
  return result;
}

} // namespace rbvi
