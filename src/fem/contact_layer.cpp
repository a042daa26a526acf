#include "rbvi/fem/contact_layer.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/par/gather.hpp"

#include <algorithm>
#include <map>

namespace rbvi {

namespace {

/// A cell as it travels: its edge, natural dofs (-1: fixed, or not there) and vertices.
struct Record {
  PetscInt numbers[1 + 12];
  double vertices[3 * 2];
};

/// Local edge of a cell whose nodes are all on the boundary; -1: none.
int edge_on(const std::vector<bool> &boundary, const std::array<int, most_nodes> &nodes,
            int degree) {
  const auto on = [&](std::size_t i) { return boundary[static_cast<std::size_t>(nodes[i])]; };
  for (std::size_t e = 0; e < 3; ++e)
    if (on(static_cast<std::size_t>(simplex_edges[e][0])) &&
        on(static_cast<std::size_t>(simplex_edges[e][1])) && (degree == 1 || on(3 + e)))
      return static_cast<int>(e);
  return -1;
}

std::vector<Record> own_records(const Mesh &mesh, const Dofs &dofs, const std::string &boundary) {
  std::vector<Record> records;
  const auto count = static_cast<std::size_t>(nodes_per_cell(2, mesh.degree));
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    const auto nodes = nodes_of(mesh, k);
    const int edge = edge_on(mesh.boundary.at(boundary), nodes, mesh.degree);
    if (edge < 0) continue;
    Record record{};
    record.numbers[0] = edge;
    for (std::size_t i = 0; i < 12; ++i) {
      record.numbers[1 + i] = -1;
      if (i >= 2 * count) continue;
      const auto node = static_cast<std::size_t>(nodes[i / 2]);
      if (dofs.free[2 * node + i % 2] >= 0)
        record.numbers[1 + i] = 2 * mesh.natural_node[node] + static_cast<PetscInt>(i % 2);
    }
    for (std::size_t v = 0; v < 3; ++v)
      for (std::size_t c = 0; c < 2; ++c)
        record.vertices[2 * v + c] = mesh.points[static_cast<std::size_t>(nodes[v])][c];
    records.push_back(record);
  }
  return records;
}

std::vector<Record> on_every_rank(MPI_Comm comm, const std::vector<Record> &mine) {
  std::vector<char> bytes(mine.size() * sizeof(Record));
  std::copy_n(reinterpret_cast<const char *>(mine.data()), bytes.size(), bytes.data());
  bytes = gather_all(comm, bytes, MPI_CHAR);
  std::vector<Record> all(bytes.size() / sizeof(Record));
  std::copy_n(bytes.data(), bytes.size(), reinterpret_cast<char *>(all.data()));
  const auto middle = [](const Record &r) {
    const auto [a, b] = simplex_edges[static_cast<std::size_t>(r.numbers[0])];
    return r.vertices[2 * a] + r.vertices[2 * b];
  };
  std::sort(all.begin(), all.end(),
            [&](const Record &a, const Record &b) { return middle(a) < middle(b); });
  return all;
}

} // namespace

ContactLayer make_contact_layer(const Mesh &mesh, const Dofs &dofs, const std::string &boundary) {
  if (mesh.dim != 2)
    throw bad_input("Nitsche's method is for two dimensions: the mesh has " +
                    std::to_string(mesh.dim));
  const std::vector<Record> records = on_every_rank(mesh.comm, own_records(mesh, dofs, boundary));
  if (records.empty()) throw bad_input("no cell has an edge on the boundary '" + boundary + "'");
  std::map<PetscInt, int> number; // natural dof -> dof of the layer
  for (const Record &record : records)
    for (std::size_t i = 0; i < 12; ++i)
      if (record.numbers[1 + i] >= 0) number.emplace(record.numbers[1 + i], 0);
  ContactLayer layer;
  for (auto &[dof, position] : number) {
    position = static_cast<int>(layer.natural.size());
    layer.natural.push_back(dof);
  }
  for (const Record &record : records) {
    CurveCell cell{{2, {}, {}}, static_cast<int>(record.numbers[0]), {}};
    for (std::size_t v = 0; v < 3; ++v)
      cell.cell.reference[v] = {record.vertices[2 * v], record.vertices[2 * v + 1], 0};
    cell.cell.mapped = cell.cell.reference;
    for (std::size_t i = 0; i < 12; ++i)
      cell.dofs[i] = record.numbers[1 + i] < 0 ? -1 : number.at(record.numbers[1 + i]);
    layer.cells.push_back(cell);
  }
  layer.trace = make_trace(dofs, layer.natural);
  return layer;
}

} // namespace rbvi
