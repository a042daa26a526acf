// The file of a model's fields, beside that of the model.
#pragma once

#include "rbvi/element/lagrange.hpp"
#include "rbvi/io/fields.hpp"
#include "rbvi/model/model.hpp"

namespace rbvi {

/// Bound of numbers of materials; OnlineSolver asks for those of the scene.
inline constexpr Index most_materials = 1000;

/// The fields of a mesh; `group`: "", or with a slash.
template <class Store, class Model>
void list_mesh(const Store &store, const std::string &group, Model &model) {
  const bool known = !model.contact.interfaces.empty();
  const Index nodes = model.fields.points.rows();
  store(group + "points", model.fields.points,
        Shape{any_size, known ? model.contact.interfaces.front().mesh.dim : any_size});
  store(group + "cells", model.fields.cells, Indices{nodes});
  store.ask(group + "cells is not a list of cells", [&] {
    const InterfaceMesh &mesh = model.contact.interfaces.front().mesh;
    return std::ssize(model.fields.cells) % nodes_per_cell(mesh.dim, mesh.degree) == 0;
  });
  store(group + "imposed_by", model.fields.imposed_by);
  store(group + "materials", model.fields.materials, Indices{most_materials});
  store.ask(group + "materials does not fit", [&] {
    const InterfaceMesh &mesh = model.contact.interfaces.front().mesh;
    return model.fields.materials.empty() ||
           std::ssize(model.fields.materials) * nodes_per_cell(mesh.dim, mesh.degree) ==
               std::ssize(model.fields.cells);
  });
}

/// The fields that a model holds in memory.
template <class Store, class Model>
void list_fields(const Store &store, const std::string &group, Model &model) {
  const Index nodes = model.fields.points.rows(), dofs = model.fields.basis.rows();
  list_mesh(store, group, model);
  store(group + "primal_basis", model.fields.basis, Shape{any_size, model.primal_size()});
  store.ask(group + "primal_basis has no whole number of rows per node",
            [&] { return nodes > 0 && dofs % nodes == 0; });
  store.ask(group + "imposed_by does not fit", [&] {
    return model.fields.imposed_by.empty() || std::ssize(model.fields.imposed_by) == dofs;
  });
}

/// Tells the fields of one model from those of another; "" for a model without.
std::string key_of_fields(const ReducedModel &model);

/// Makes the scene of a model that was read, of its tree. Throws as read_model.
void take_scene(ReducedModel &model, const Registry &registry);

/// Writes the fields that a model holds in memory; leaves the file as it is where it has them.
void write_fields(const ReducedModel &model, const std::filesystem::path &model_path);

/// `key`: of the model; "" is a model without fields. Throws bad_input for a file that is not there
/// or has other fields.
void read_fields(const std::filesystem::path &model_path, const std::string &key,
                 ReducedModel &model);

} // namespace rbvi
