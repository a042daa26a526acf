// Writes meshes as Gmsh does, in versions 2.2, 4.0 and 4.1, as text and in binary.
#pragma once

#include "rbvi/mesh/mesh.hpp"

#include <algorithm>
#include <cstddef>
#include <iomanip>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace rbvi {

/// A curve, surface or volume with its linear elements; a negative group turns it round.
struct GmshEntity {
  int dim, number;
  std::vector<int> groups;
  std::vector<std::vector<int>> elements; ///< of nodes, counted from 0
};

struct GmshDrawing {
  std::vector<Point> points;
  std::vector<GmshEntity> entities;
  std::map<std::pair<int, int>, std::string> names; ///< of a group: dimension, number
};

struct GmshEncoding {
  std::string version; ///< 2.2, 4 or 4.1
  bool binary;
};

inline const std::vector<GmshEncoding> gmsh_encodings{
    {"2.2", false}, {"2.2", true}, {"4", false}, {"4", true}, {"4.1", false}, {"4.1", true}};

/// Node numbers have gaps, and one more node belongs to no element; versions 4.x list the blocks of
/// nodes and elements backwards.
class GmshWriter {
public:
  explicit GmshWriter(GmshEncoding encoding) : encoding_(std::move(encoding)) {
    out_ << std::setprecision(17);
  }
  std::string write(const GmshDrawing &drawing);

private:
  static int node(int v) { return 2 * v + 5; }
  static int type(int dim) { return std::vector{15, 1, 2, 4}.at(dim); }
  bool two() const { return encoding_.version == "2.2"; }
  bool four_one() const { return encoding_.version == "4.1"; }

  template <class T> void put(T value) {
    if (encoding_.binary)
      out_.write(reinterpret_cast<const char *>(&value), sizeof value);
    else
      out_ << value << " ";
  }
  void integer(std::size_t value) { put(static_cast<int>(value)); }
  void count(std::size_t value) { put(value); }
  void tag(std::size_t value) { four_one() ? put(value) : integer(value); }
  void point(const Point &x) {
    for (const double coordinate : x)
      put(coordinate);
  }
  void nodes_two(const GmshDrawing &drawing);
  void elements_two(const GmshDrawing &drawing);
  void entities(const GmshDrawing &drawing);
  void nodes_four(const GmshDrawing &drawing);
  void elements_four(const GmshDrawing &drawing);

  GmshEncoding encoding_;
  std::ostringstream out_;
};

inline void GmshWriter::nodes_two(const GmshDrawing &drawing) {
  out_ << "\n$Nodes\n" << drawing.points.size() + 1 << "\n";
  for (std::size_t v = 0; v < drawing.points.size(); ++v) {
    put(node(static_cast<int>(v)));
    point(drawing.points[v]);
    if (!encoding_.binary) out_ << "\n";
  }
  put(1);
  point({9, 9, 0});
  out_ << "\n$EndNodes";
}

/// Each element once per group, turned round where that is negative.
inline void GmshWriter::elements_two(const GmshDrawing &drawing) {
  std::size_t all = 0;
  for (const GmshEntity &entity : drawing.entities)
    all += entity.elements.size() * std::max<std::size_t>(entity.groups.size(), 1);
  out_ << "\n$Elements\n" << all << "\n";
  std::size_t number = 0;
  for (const GmshEntity &entity : drawing.entities) {
    const std::vector<int> none{0}, &groups = entity.groups.empty() ? none : entity.groups;
    for (const int group : groups) {
      if (encoding_.binary)
        for (const std::size_t value :
             {static_cast<std::size_t>(type(entity.dim)), entity.elements.size(), std::size_t{2}})
          integer(value);
      for (std::vector<int> element : entity.elements) {
        if (group < 0) std::swap(element[element.size() - 2], element.back());
        integer(++number);
        if (!encoding_.binary)
          for (const int value : {type(entity.dim), 2})
            put(value);
        for (const int value : {std::abs(group), entity.number})
          put(value);
        for (const int v : element)
          put(node(v));
      }
    }
  }
  out_ << "\n$EndElements\n";
}

inline void GmshWriter::entities(const GmshDrawing &drawing) {
  out_ << "\n$Entities\n";
  for (const int dim : {0, 1, 2, 3})
    count(dim == 0 ? 1
                   : static_cast<std::size_t>(std::count_if(
                         drawing.entities.begin(), drawing.entities.end(),
                         [&](const GmshEntity &entity) { return entity.dim == dim; })));
  put(7); // a point, of group 5
  for (int corner = 0; corner < (four_one() ? 1 : 2); ++corner)
    point({9, 9, 0});
  count(1);
  put(5);
  for (const int dim : {1, 2, 3})
    for (const GmshEntity &entity : drawing.entities) {
      if (entity.dim != dim) continue;
      put(entity.number);
      point({-1, -1, 0});
      point({1, 1, 0});
      count(entity.groups.size());
      for (const int group : entity.groups)
        put(group);
      count(2);
      for (const int bounding : {1, -2})
        put(bounding);
    }
  out_ << "\n$EndEntities";
}

inline void GmshWriter::nodes_four(const GmshDrawing &drawing) {
  const auto points = drawing.points.size();
  out_ << "\n$Nodes\n";
  for (const std::size_t value : {std::size_t{2}, points + 1})
    count(value);
  if (four_one())
    for (const std::size_t value : {std::size_t{1}, 2 * points + 3})
      count(value);
  const auto block = [&](int dim, int entity, std::size_t size) {
    put(four_one() ? dim : entity);
    put(four_one() ? entity : dim);
    put(dim == 2 ? 1 : 0); // with coordinates on the surface
    count(size);
  };
  const auto coordinates = [&](std::size_t v) {
    point(drawing.points[v]);
    for (int k = 0; k < 2; ++k)
      put(0.25);
  };
  block(2, 1, points);
  for (std::size_t v = points; v-- > 0;) {
    tag(node(static_cast<int>(v)));
    if (!four_one()) coordinates(v);
  }
  for (std::size_t v = points; four_one() && v-- > 0;)
    coordinates(v);
  block(0, 7, 1);
  tag(1);
  point({9, 9, 0});
  out_ << "\n$EndNodes";
}

inline void GmshWriter::elements_four(const GmshDrawing &drawing) {
  std::size_t all = 1;
  for (const GmshEntity &entity : drawing.entities)
    all += entity.elements.size();
  out_ << "\n$Elements\n";
  for (const std::size_t value : {drawing.entities.size() + 1, all})
    count(value);
  if (four_one())
    for (const std::size_t value : {std::size_t{1}, all})
      count(value);
  std::size_t number = all;
  const auto block = [&](int dim, int entity, std::size_t size) {
    put(four_one() ? dim : entity);
    put(four_one() ? entity : dim);
    put(type(dim));
    count(size);
  };
  for (auto entity = drawing.entities.rbegin(); entity != drawing.entities.rend(); ++entity) {
    block(entity->dim, entity->number, entity->elements.size());
    for (auto element = entity->elements.rbegin(); element != entity->elements.rend(); ++element) {
      tag(number--);
      for (const int v : *element)
        tag(node(v));
    }
  }
  block(0, 7, 1);
  tag(number);
  tag(1);
  out_ << "\n$EndElements\n";
}

inline std::string GmshWriter::write(const GmshDrawing &drawing) {
  out_ << "$MeshFormat\n" << encoding_.version << (encoding_.binary ? " 1 8\n" : " 0 8\n");
  if (encoding_.binary) put(1);
  out_ << "\n$EndMeshFormat\n$Comments\nthe $Nodes come later\n$EndComments\n$PhysicalNames\n"
       << drawing.names.size() << "\n";
  for (const auto &[key, name] : drawing.names)
    out_ << key.first << " " << key.second << " \"" << name << "\"\n";
  out_ << "$EndPhysicalNames";
  if (two()) {
    nodes_two(drawing);
    elements_two(drawing);
  } else {
    entities(drawing);
    nodes_four(drawing);
    elements_four(drawing);
  }
  return out_.str();
}

/// A mesh of triangles: one group per name, one entity per list of groups that elements share.
inline GmshDrawing drawing_of(const SerialMesh &mesh) {
  GmshDrawing drawing;
  drawing.points = mesh.points;
  std::map<std::pair<int, int>, std::vector<int>> facets; // vertices -> groups
  std::vector<std::vector<int>> cells(mesh.cells.size());
  int group = 0;
  for (const auto &[name, own] : mesh.boundary) {
    drawing.names[{1, ++group}] = name;
    for (const auto &facet : own)
      facets[{facet[0], facet[1]}].push_back(group);
  }
  group = 0;
  for (const auto &[name, own] : mesh.region) {
    drawing.names[{2, ++group}] = name;
    for (const int cell : own)
      cells[cell].push_back(group);
  }
  const auto add = [&](int dim, const std::vector<int> &groups, std::vector<int> element) {
    int number = 1;
    for (GmshEntity &entity : drawing.entities) {
      if (entity.dim != dim) continue;
      ++number;
      if (entity.groups == groups) return entity.elements.push_back(std::move(element));
    }
    drawing.entities.push_back({dim, number, groups, {std::move(element)}});
  };
  for (const auto &[facet, groups] : facets)
    add(1, groups, {facet.first, facet.second});
  for (std::size_t c = 0; c < cells.size(); ++c)
    add(2, cells[c], {mesh.cells[c][0], mesh.cells[c][1], mesh.cells[c][2]});
  return drawing;
}

inline std::string written(const GmshDrawing &drawing, const GmshEncoding &encoding) {
  return GmshWriter(encoding).write(drawing);
}

} // namespace rbvi
