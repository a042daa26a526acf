// The fields of model.h5, listed once for writing, reading and checking; LAYOUT.md says what they
// are.
#pragma once

#include "certificate_part.hpp"
#include "model_fields.hpp"
#include "nitsche_part.hpp"
#include "rbvi/contact/curve.hpp"
#include "rbvi/model/cell_outputs.hpp"
#include "rbvi/model/packed.hpp"

#include <cmath>
#include <limits>
#include <numeric>

namespace rbvi {

template <class Store, class Space> void list_parameters(const Store &store, Space &space) {
  const auto column = [&](const std::string &name, auto &&member) {
    list_column(store, "parameters/" + name, space.all, member);
  };
  column(
      "names", [](auto &p) -> auto & { return p.name; });
  column(
      "units", [](auto &p) -> auto & { return p.unit; });
  column(
      "lower", [](auto &p) -> auto & { return p.lower; });
  column(
      "upper", [](auto &p) -> auto & { return p.upper; });
  column(
      "value", [](auto &p) -> auto & { return p.value; });
  store("parameters/free", space.free, Indices{std::ssize(space.all)});
}

/// Sampled entries on one mesh, `entries` of them.
template <class Store, class Sample>
void list_sample(const Store &store, const std::string &at, Sample &sample, Index dim,
                 Index entries) {
  const Matrix &vertices = sample.vertices;
  store(at + "/vertices", sample.vertices, Shape{any_size, vertices.rows() == 0 ? any_size : dim});
  store(at + "/corners", sample.corners, Between{2, dim + 1});
  list_records(store, at + "/contributions", sample.contributions,
               [](auto &c) { return std::tie(c.entry, c.cell, c.local); });
  store(at + "/cell_terms", sample.terms);
  store(at + "/cell_imposed_by", sample.imposed_by);
  store.ask(at + "/vertices is not a list of cells",
            [&] { return vertices.rows() % sample.corners == 0; });
  store.ask(at + "/cell_terms does not fit", [&] {
    return sample.terms.empty() || std::ssize(sample.terms) * sample.corners == vertices.rows();
  });
  store.ask(at + "/cell_imposed_by does not fit", [&] {
    const Index cells = vertices.rows() / sample.corners;
    return cells == 0 ? sample.imposed_by.empty() : std::ssize(sample.imposed_by) % cells == 0;
  });
  store.ask(at + "/contributions point nowhere or are not ordered by entry", [&] {
    int previous = 0;
    return std::ranges::all_of(sample.contributions, [&](const SampleMesh::Contribution &c) {
      return c.entry >= std::exchange(previous, c.entry) && c.entry < entries && c.cell >= 0 &&
             c.local >= 0 && c.cell < vertices.rows() / sample.corners;
    });
  });
}

/// `reduced`: its shape; `meshes`: of how many the entries are.
template <class Store, class Terms>
void list_terms(const Store &store, const std::string &name, Terms &terms, Shape reduced, int dim,
                Index meshes) {
  const Index size = terms.interpolation.rows();
  store(name + "/interpolation", terms.interpolation, Shape{size, size});
  store(name + "/exact", terms.exact, Between{0, std::numeric_limits<int>::max()});
  if (terms.size() == 0) reduced.rows = any_size;
  store(name + "/reduced", terms.reduced, reduced);
  store(name + "/error", terms.error);
  list_elements(
      store, name + "/samples", name, terms.samples,
      [&](const std::string &at, auto &sample) { list_sample(store, at, sample, dim, size); });
  store.ask(name + " has sampled entries elsewhere",
            [&] { return size == 0 || std::ssize(terms.samples) == meshes; });
}

template <class Store, class Model> void list_change(const Store &store, Model &model) {
  auto &change = model.body.a_change;
  const Index rank = change.rank(), terms = rank > 0 ? model.body.a.size() : 0;
  store.ask("a/range is for a pair of spaces", [&] {
    return rank == 0 ||
           !(model.contact.law || !model.has_multipliers() || model.body.online_enriched);
  });
  store("a/scales", change.scales, Shape{terms, 1});
  store("a/range", change.range, Shape{rank > 0 ? model.primal_size() : any_size, rank});
  store("a/cores", change.cores, Shape{rank > 0 ? rank * (rank + 1) / 2 : any_size, terms});
}

/// The separated operators.
template <class Store, class Model> void list_operators(const Store &store, Model &model, int dim) {
  const Index n = model.primal_size(), r = model.contact.generators,
              interfaces = std::ssize(model.contact.interfaces);
  const Index of_a = model.body.a_change.rank() > 0 ? 1 : model.body.a.size();
  store.ask("a has no terms", [&] { return model.body.a.size() > 0; });
  store.ask("g has terms and b has not, or Nitsche's method has some", [&] {
    return model.contact.b.size() > 0 ? model.has_multipliers() : model.contact.g.size() == 0;
  });
  list_terms(store, "a", model.body.a, Shape{n * (n + 1) / 2, of_a}, dim, 1);
  list_change(store, model);
  list_terms(store, "b", model.contact.b, Shape{r * n, model.contact.b.size()}, dim, interfaces);
  list_terms(store, "f", model.body.f, Shape{n, model.body.f.size()}, dim, 1);
  list_terms(store, "g", model.contact.g, Shape{r, model.contact.g.size()}, dim, interfaces);
  auto &body = model.body;
  const Index motions = std::ssize(body.spring_terms);
  store("springs/terms", body.spring_terms, Indices{std::ssize(model.scene.a)});
  store("springs/reduced", body.springs, Shape{motions > 0 ? n : any_size, motions});
  store("springs/motions", body.motions, Shape{motions, any_size});
  auto &energy = model.body.imposed_energy;
  list_terms(store, "imposed_energy", energy, Shape{1, energy.size()}, dim, 1);
}

/// `mesh_nodes`: of the whole mesh, where they are known.
template <class Store, class Interface>
void list_interface(const Store &store, const std::string &at, Interface &interface, int dim,
                    Index mesh_nodes) {
  auto &mesh = interface.mesh;
  list_record(store, at + "/sizes",
              std::tie(mesh.dim, mesh.degree, mesh.components, mesh.per_entity));
  if constexpr (Store::reads) mesh.per_entity = std::max(1, mesh.per_entity);
  store.ask(at + "/sizes do not fit", [&] {
    return mesh.dim == dim && (mesh.degree == 1 || mesh.degree == 2) && mesh.components > 0 &&
           mesh.components <= 3 && mesh.per_entity > 1;
  });
  list_as(
      store, at + "/points", mesh.points,
      [&](const std::vector<Point> &points) {
        Matrix rows(std::ssize(points), mesh.dim);
        for (Index i = 0; i < rows.rows(); ++i)
          rows.row(i) = Eigen::Map<const Eigen::RowVector3d>(points[i].data()).head(mesh.dim);
        return rows;
      },
      [&](const Matrix &rows) {
        if (mesh.dim < 2 || mesh.dim > 3 || rows.cols() != mesh.dim)
          throw bad_input(at + "/points does not fit " + at + "/sizes");
        std::vector<Point> points;
        for (Index i = 0; i < rows.rows(); ++i)
          points.push_back(point_of(rows, i));
        return points;
      },
      Shape{any_size, mesh.dim});
  const Index nodes = mesh.nodes(), cells = mesh.count();
  store.ask(at + "/entities is not a list of them",
            [&] { return cells > 0 && std::ssize(mesh.entities) % mesh.per_entity == 0; });
  store(at + "/entities", mesh.entities, Indices{nodes});
  store(at + "/edges", mesh.edges, Indices{3, mesh.edges.empty() ? 0 : cells});
  store(at + "/parts", mesh.parts, Indices{nodes + 1, any_size, 1});
  store.ask(at + "/parts does not fit", [&] {
    return std::accumulate(mesh.parts.begin(), mesh.parts.end(), Index{0}) == nodes;
  });
  store(at + "/closed_ends", mesh.closed_ends, Indices{2});
  store.ask(at + "/closed_ends does not fit", [&] {
    return mesh.closed_ends.empty() || mesh.closed_ends.size() == count_ends(mesh);
  });
  store(at + "/dofs", mesh.dofs, Indices{mesh.columns, nodes * mesh.components, -1});
  store(at + "/imposed_by", mesh.imposed_by);
  store.ask(at + "/imposed_by does not fit",
            [&] { return mesh.imposed_by.empty() || mesh.imposed_by.size() == mesh.dofs.size(); });
  store(at + "/materials", mesh.materials,
        Indices{most_materials, mesh.materials.empty() ? 0 : cells});
  store(at + "/nodes", interface.nodes, Indices{mesh_nodes, nodes});
}

template <class Store, class Model> void list_contact(const Store &store, Model &model, int dim) {
  int contact = model.contact.interfaces.empty() ? 0 : static_cast<int>(model.contact_dofs());
  const Index rows = model.fields.points.rows();
  store("contact/dofs", contact);
  list_elements(store, "interfaces/count", "interfaces", model.contact.interfaces,
                [&](const std::string &at, auto &interface) {
                  if constexpr (Store::reads) interface.mesh.columns = contact;
                  store.ask(at + "/dofs are of other columns",
                            [&] { return interface.mesh.columns == contact; });
                  list_interface(store, at, interface, dim,
                                 rows > 0 ? rows : std::numeric_limits<int>::max());
                });
  const Index generators = model.contact.generators;
  store("contact/dual_basis", model.contact.dual_basis, Shape{any_size, generators});
  const bool known = model.contact.starts.size() > 0;
  store("contact/starts", model.contact.starts, Shape{known ? generators : any_size, any_size});
  const bool partial = !model.contact.trace_dofs.empty();
  store("contact/trace_dofs", model.contact.trace_dofs, Indices{contact});
  store.ask("contact/trace_dofs is for a pair of spaces", [&] {
    return !partial ||
           !(model.contact.law || !model.has_multipliers() || model.evaluates_contact());
  });
  store.ask("contact/trace_dofs does not rise",
            [&] { return std::ranges::is_sorted(model.contact.trace_dofs); });
  store("contact/trace", model.contact.trace,
        Shape{partial ? std::ssize(model.contact.trace_dofs) : contact, model.primal_size()});
}

template <class Store, class Model> void list_outputs(const Store &store, Model &model, int dim) {
  auto &[cells, basis] = model.outputs;
  const Index nodes = cells.points.rows(), per_cell = nodes_per_cell(dim, model.scene.degree);
  store("outputs/points", cells.points, Shape{any_size, nodes > 0 ? dim : any_size});
  store("outputs/nodes", cells.nodes,
        Indices{std::numeric_limits<int>::max(), Store::reads ? any_size : nodes});
  store("outputs/cells", cells.cells, Indices{cells.points.rows()});
  const Index count = std::ssize(cells.cells) / per_cell;
  store.ask("outputs/cells is not a list of them",
            [&] { return count * per_cell == std::ssize(cells.cells); });
  store("outputs/materials", cells.materials,
        Indices{std::max<Index>(1, std::ssize(model.scene.materials)),
                cells.materials.empty() ? 0 : count});
  store("outputs/imposed_by", cells.imposed_by);
  list_records(store, "outputs/parts", cells.parts, [](auto &part) {
    return std::tie(part.output, part.cell, part.facet, part.term, part.held);
  });
  store("outputs/basis", basis,
        Shape{cells.points.rows() * model.scene.components,
              cells.points.rows() > 0 ? model.primal_size() : any_size});
  store.ask("outputs do not fit", [&] { return fits(model.outputs, model.scene, count); });
}

/// `size`: the order of the terms; `blocks`: of how many blocks they come; `contact`: dofs.
template <class Store, class Operator>
void list_condensed(const Store &store, Operator &condensed, Index size, Index blocks,
                    Index contact) {
  const bool some = condensed.terms.size() > 0;
  auto &grid = condensed.grid;
  const Index axes = std::ssize(grid.axes);
  list_records(store, "law/axes", grid.axes,
               [](auto &axis) { return std::tie(axis.parameter, axis.lower, axis.upper); });
  store("law/abscissae", grid.abscissae);
  store("law/points", grid.points, Indices{std::max<Index>(1, grid.abscissae.size())});
  store.ask("law/points do not fit",
            [&] { return axes == 0 ? grid.points.empty() : std::ssize(grid.points) % axes == 0; });
  store("law/error", condensed.error);
  store("law/shape", condensed.shape, Shape{any_size, some ? grid.size() : any_size});
  store("law/dofs", condensed.dofs, Indices{some ? contact : std::numeric_limits<int>::max()});
  if constexpr (Store::checks) {
    const Index terms = blocks * condensed.shape.rows();
    if (some) store("law/terms", condensed.terms, Shape{size * size, terms});
  } else {
    std::vector<int> orders;
    if constexpr (!Store::reads) orders = diagonal_blocks(condensed.terms);
    store("law/blocks", orders);
    list_as(
        store, "law/terms", condensed.terms,
        [&](const Matrix &terms) { return pack_blocks(terms, orders); },
        [&](const Matrix &packed) { return unpacked_blocks(packed, orders); });
  }
}

template <class Store, class Model> void list_law(const Store &store, Model &model) {
  const Index m = model.contact.generators, b = model.contact.b.size(),
              contact = model.contact.trace.rows();
  int normal = model.contact.law ? model.contact.law->normal : 0;
  store("law/normal", normal, Between{model.contact.law ? 1 : 0, m});
  if (normal == 0) return;
  if constexpr (Store::reads) model.contact.law.emplace().normal = normal;
  auto &law = *model.contact.law;
  const bool evaluates = model.evaluates_contact();
  list_condensed(store, law.condensed, evaluates ? std::ssize(law.condensed.dofs) : m,
                 evaluates ? 1 : b * (b + 1) / 2, contact);
  store.ask("law/axes do not fit", [&] {
    return std::ranges::all_of(law.condensed.grid.axes, [&](const GridAxis &axis) {
      return axis.lower < axis.upper && axis.parameter >= 0 &&
             axis.parameter < std::ssize(model.scene.parameters.all);
    });
  });
  list_integer(store, "law/reduction", law.reduction,
               Between{static_cast<int>(MultiplierReduction::condensed),
                       static_cast<int>(MultiplierReduction::collocated)});
  const bool collocated = law.reduction == MultiplierReduction::collocated;
  store.ask("it has no condensed operator",
            [&] { return collocated || law.condensed.terms.size() > 0; });
  list_integer(store, "law/mended", law.mended);
  store("law/basis/normal", law.basis.normal, Shape{collocated ? normal : any_size, any_size});
  store("law/basis/tangential", law.basis.tangential,
        Shape{collocated ? m - normal : any_size, any_size});
  store("law/basis/nodes", law.basis.nodes, Indices{normal});
  auto &apart = law.apart;
  list_record(store, "law/apart",
              std::tie(apart.normal, apart.normal_error, apart.tangential_error));
  store.ask("law/apart does not fit", [&] {
    return apart.normal == 0 || (apart.normal > 0 && apart.normal < b && m > normal);
  });
  store.ask("b/interpolation mixes terms of B^n and of B^tau", [&] {
    return model.contact.b.interpolation.bottomLeftCorner(b - apart.normal, apart.normal).isZero(0);
  });
  const Index starts = law.starts.cols();
  store("law/starts", law.starts, Shape{m, any_size});
  store("law/starts_mu", law.starts_mu, Shape{model.scene.parameters.size(), starts});
  const bool follows = law.states.size() > 0;
  store("law/states", law.states, Shape{follows ? contact : any_size, follows ? starts : any_size});
}

template <class Store, class Errors>
void list_validation(const Store &store, const std::string &name, Errors &errors) {
  list_record(store, name,
              std::tie(errors.count, errors.u_mean, errors.u_max, errors.lambda_mean,
                       errors.lambda_max, errors.tangential_mean, errors.tangential_max,
                       errors.unanswered));
  list_column(
      store, name + "_outputs/names", errors.outputs, [](auto &of) -> auto & { return of.name; });
  constexpr std::array numbers{&OutputError::mean,          &OutputError::max,
                               &OutputError::mean_of_range, &OutputError::max_of_range,
                               &OutputError::mean_of_value, &OutputError::max_of_value};
  list_as(
      store, name + "_outputs/values", errors.outputs,
      [&](const std::vector<OutputError> &outputs) {
        return Matrix(
            Matrix::NullaryExpr(std::ssize(outputs), std::ssize(numbers),
                                [&](Index i, Index k) { return outputs[i].*numbers[k]; }));
      },
      [&](const Matrix &rows) {
        std::vector<OutputError> outputs = errors.outputs;
        if (rows.rows() != std::ssize(outputs) || (rows.size() > 0 && rows.cols() != 6))
          throw bad_input(name + "_outputs: names without six values each");
        for (Index i = 0; i < rows.rows(); ++i)
          for (Index k = 0; k < rows.cols(); ++k)
            outputs[i].*numbers[k] = rows(i, k);
        return outputs;
      });
}

template <class Store, class Check> void list_self_check(const Store &store, Check &check) {
  list_record(store, "self_check/counts",
              std::tie(check.queries, check.unanswered, check.at_boundary));
  store("self_check/scale", check.scale);
  store("self_check/unanswered_at", check.unanswered_at);
  store("self_check/reason", check.reason);
  const auto worst = [&](const std::string &name, auto &of) {
    store("self_check/" + name, of.value);
    store("self_check/" + name + "_at", of.at);
  };
  worst("residual", check.residual);
  worst("penetration", check.penetration);
  worst("friction", check.friction);
}

/// How the model was made, and what was measured of it.
template <class Store, class Model> void list_history(const Store &store, Model &model) {
  std::vector<std::string> names;
  for (const auto &[name, values] : model.made.histories)
    names.push_back(name);
  store("histories/names", names);
  for (const std::string &name : names) {
    if constexpr (Store::reads) model.made.histories.try_emplace(name);
    store("histories/values/" + name, model.made.histories.at(name));
  }
  list_map(store, "stages/names", "stages/seconds", model.made.stage_seconds);
  const auto parameters = [&](const std::string &name, auto &mu) {
    store(name, mu, Shape{mu.cols() == 0 ? any_size : model.scene.parameters.size(), any_size});
  };
  parameters("training/mu", model.made.trained_mu);
  store.ask("contact/starts are of other samples", [&] {
    const Index starts = model.contact.starts.cols();
    return starts == 0 || model.made.trained_mu.cols() == 0 ||
           starts == model.made.trained_mu.cols();
  });
  parameters("training/failed", model.made.failed_mu);
  list_validation(store, "validation/enriched", model.made.validation_enriched);
  list_validation(store, "validation/decorrelated", model.made.validation_decorrelated);
  parameters("validation/mu", model.made.validated_mu);
  list_self_check(store, model.made.self_check);
}

/// `fields_key`: of the file of the fields.
template <class Store, class Model, class Key>
void list_model(const Store &store, Model &model, Key &&fields_key) {
  const int dim = model.contact.interfaces.empty() ? 2 : model.contact.interfaces.front().mesh.dim;
  const auto texts = [&](const std::string &group, auto &map) {
    list_map(store, group + "/names", group + "/values", map);
  };
  store("scene/name", model.scene.name);
  texts("scene/options", model.scene.options);
  store("scene/tree", model.scene.tree);
  list_parameters(store, model.scene.parameters);
  texts("settings", model.made.settings);
  store("mesh/fingerprint", model.made.mesh_fingerprint);
  store("size/modes", model.body.modes);
  store("size/supremizers", model.body.supremizers);
  store("size/generators", model.contact.generators);
  store("size/free_modes", model.contact.free_modes, Between{0, model.contact.generators});
  list_integer(store, "size/online_enriched", model.body.online_enriched);
  store.ask("it has no modes or no generators", [&] {
    return model.body.modes > 0 && model.body.supremizers >= 0 &&
           (model.contact.generators > 0 || !model.has_multipliers());
  });
  store("fields/key", fields_key);
  list_nitsche(store, model);
  list_operators(store, model, dim);
  list_contact(store, model, dim);
  list_law(store, model);
  list_outputs(store, model, dim);
  list_certificate(store, model);
  list_history(store, model);
}

} // namespace rbvi
