#include "rbvi/mor/affine.hpp"

#include "rbvi/contact/entity_sum.hpp"
#include "rbvi/element/facets.hpp"
#include "rbvi/mor/operator_entries.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/columns.hpp"

#include <algorithm>
#include <numeric>
#include <set>

namespace rbvi {

namespace {

/// One cell that touches sampled entries: its number, its vertices, (entry, local) pairs, and of a
/// and f the term that it is a cell of, or has a facet of.
struct TouchedCell {
  PetscInt number;
  std::array<Point, 4> vertices;
  std::vector<std::pair<int, int>> entries;
  int term = -1;
  std::vector<int> imposed_by = {}; ///< Cell::imposed_by; empty: nothing is imposed
};

/// SampleMesh::imposed_by.
std::vector<int> imposed_by_of(const std::vector<TouchedCell> &cells) {
  std::size_t most = 0;
  for (const TouchedCell &cell : cells)
    most = std::max(most, cell.imposed_by.size());
  std::vector<int> result;
  for (const TouchedCell &cell : cells) {
    result.insert(result.end(), cell.imposed_by.begin(), cell.imposed_by.end());
    result.insert(result.end(), most - cell.imposed_by.size(), -1);
  }
  return result;
}

/// `corners`: vertices of each cell.
SampleMesh to_sample_mesh(int dim, int corners, std::vector<TouchedCell> cells) {
  std::stable_sort(cells.begin(), cells.end(), [](const TouchedCell &x, const TouchedCell &y) {
    return std::pair(x.number, x.term) < std::pair(y.number, y.term);
  });
  SampleMesh sample;
  sample.corners = corners;
  sample.vertices.resize(std::ssize(cells) * corners, dim);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    for (int i = 0; i < corners; ++i)
      for (int c = 0; c < dim; ++c)
        sample.vertices(static_cast<Index>(k) * corners + i, c) = cells[k].vertices[i][c];
    for (const auto &[entry, local] : cells[k].entries)
      sample.contributions.push_back({entry, static_cast<int>(k), local});
    if (cells[k].term >= 0) sample.terms.push_back(cells[k].term);
  }
  sample.imposed_by = imposed_by_of(cells);
  std::stable_sort(sample.contributions.begin(), sample.contributions.end(),
                   [](const auto &x, const auto &y) { return x.entry < y.entry; });
  return sample;
}

/// (entry, local) pairs of one cell, given the keys' rows and columns of its local dofs.
std::vector<std::pair<int, int>> touched(const std::vector<EntryKey> &entries,
                                         const std::vector<PetscInt> &rows,
                                         const std::vector<PetscInt> &columns) {
  std::vector<std::pair<int, int>> result;
  for (std::size_t e = 0; e < entries.size(); ++e)
    for (std::size_t i = 0; i < rows.size(); ++i)
      for (std::size_t j = 0; j < columns.size(); ++j)
        if (rows[i] == entries[e].row && columns[j] == entries[e].column)
          result.emplace_back(static_cast<int>(e), static_cast<int>(i * columns.size() + j));
  return result;
}

/// Entities of one interface; rows are dual dofs, columns contact dofs for b, the single 0 for g.
SampleMesh sample_interface(const EntitySum &interface, Index first_row,
                            const std::vector<EntryKey> &entries, bool matrix) {
  std::vector<TouchedCell> touching;
  for (Index e = 0; e < interface.mesh().count(); ++e) {
    std::vector<PetscInt> rows, columns{0};
    for (const Index row : interface.rows_of(e))
      rows.push_back(row < 0 ? -1 : static_cast<PetscInt>(first_row + row));
    if (matrix) {
      columns.clear();
      for (const Index column : interface.columns_of(e))
        columns.push_back(static_cast<PetscInt>(column));
    }
    const Cell cell = interface.reference_entity(e);
    TouchedCell entity{static_cast<PetscInt>(e), cell.reference, touched(entries, rows, columns)};
    if (!matrix && cell.imposed_by != nullptr)
      entity.imposed_by.assign(cell.imposed_by, cell.imposed_by + interface.columns_of(e).size());
    if (!entity.entries.empty()) touching.push_back(std::move(entity));
  }
  return to_sample_mesh(interface.mesh().dim, interface.entity_dim() + 1, std::move(touching));
}

std::vector<SampleMesh> sample_contact(const Contact &contact, const std::vector<EntryKey> &entries,
                                       bool matrix) {
  std::vector<SampleMesh> samples;
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i)
    samples.push_back(sample_interface(*contact.interfaces[i]->entity_sum(), contact.first_row[i],
                                       entries, matrix));
  return samples;
}

/// Flattens the cells of all ranks onto every rank.
std::vector<TouchedCell> gather_cells(MPI_Comm comm, const std::vector<TouchedCell> &mine) {
  std::vector<double> packed; // number, term, 12 coordinates, count, pairs, count, imposed_by
  for (const TouchedCell &cell : mine) {
    packed.push_back(static_cast<double>(cell.number));
    packed.push_back(cell.term);
    for (const Point &x : cell.vertices)
      packed.insert(packed.end(), x.begin(), x.end());
    packed.push_back(static_cast<double>(cell.entries.size()));
    for (const auto &[entry, local] : cell.entries) {
      packed.push_back(entry);
      packed.push_back(local);
    }
    packed.push_back(static_cast<double>(cell.imposed_by.size()));
    packed.insert(packed.end(), cell.imposed_by.begin(), cell.imposed_by.end());
  }
  const std::vector<double> all = gather_all(comm, packed, MPI_DOUBLE);
  std::vector<TouchedCell> cells;
  for (auto at = all.begin(); at != all.end();) {
    TouchedCell cell{static_cast<PetscInt>(*at++), {}, {}};
    cell.term = static_cast<int>(*at++);
    for (Point &x : cell.vertices)
      for (double &coordinate : x)
        coordinate = *at++;
    for (auto count = static_cast<int>(*at++); count > 0; --count) {
      const int entry = static_cast<int>(*at++);
      cell.entries.emplace_back(entry, static_cast<int>(*at++));
    }
    for (auto count = static_cast<int>(*at++); count > 0; --count)
      cell.imposed_by.push_back(static_cast<int>(*at++));
    cells.push_back(std::move(cell));
  }
  return cells;
}

/// Calls visitor(nodes of the kernel, the cell with its term) for the cells and facets of some
/// terms of a sum on this rank.
template <class Visitor>
void visit_domain(const Problem &problem, const Sum &sum, const std::vector<int> &terms,
                  Visitor &&visitor) {
  const Mesh &mesh = problem.mesh();
  const auto per_cell = static_cast<std::size_t>(nodes_per_cell(mesh.dim, mesh.degree));
  for (const int term : terms) {
    const Form &form = sum[term].form;
    for (const auto &[k, facet] : places_of(mesh, form)) {
      if (facet < 0) {
        const auto nodes = nodes_of(mesh, k);
        visitor(std::vector<int>{nodes.begin(), nodes.begin() + per_cell},
                TouchedCell{mesh.natural_cell[k], cell_of(mesh, k).reference, {}, term});
        continue;
      }
      std::vector<int> nodes = facet_nodes(mesh.dim, mesh.degree, facet);
      for (int &node : nodes)
        node = nodes_of(mesh, k)[node];
      visitor(nodes,
              TouchedCell{
                  mesh.natural_cell[k], facet_cell(cell_of(mesh, k), facet).reference, {}, term});
    }
  }
}

/// Cell::imposed_by of these nodes; empty where nothing is imposed on them.
std::vector<int> imposed_by_at(const Dofs &dofs, const std::vector<int> &nodes) {
  std::vector<int> result;
  for (std::size_t i = 0; i < nodes.size() && !dofs.imposed_by.empty(); ++i) {
    const auto first = dofs.imposed_by.begin() + std::ptrdiff_t{nodes[i]} * dofs.components;
    result.insert(result.end(), first, first + dofs.components);
  }
  if (std::ranges::all_of(result, [](int boundary) { return boundary < 0; })) result.clear();
  return result;
}

/// Cells and facets of the terms of a sum that depend on the map; matrix: rows and columns are
/// natural dofs, vector: column 0.
SampleMesh sample_domain(const Problem &problem, const Sum &sum, const std::vector<int> &terms,
                         const std::vector<EntryKey> &entries, bool matrix) {
  const Mesh &mesh = problem.mesh();
  const int components = problem.dofs().components;
  std::vector<TouchedCell> mine;
  visit_domain(problem, sum, terms, [&](const std::vector<int> &nodes, TouchedCell cell) {
    if (!matrix) cell.imposed_by = imposed_by_at(problem.dofs(), nodes);
    if (sum[cell.term].of_imposed && cell.imposed_by.empty()) return;
    std::vector<PetscInt> rows;
    for (const int node : nodes)
      for (int c = 0; c < components; ++c)
        rows.push_back(problem.dofs().natural(mesh, static_cast<std::size_t>(node), c));
    cell.entries = touched(entries, rows, matrix ? rows : std::vector<PetscInt>{0});
    if (!cell.entries.empty()) mine.push_back(std::move(cell));
  });
  return to_sample_mesh(mesh.dim, mesh.dim + 1, gather_cells(problem.comm(), mine));
}

/// The keys' values at every mu of a training set, column by column.
struct Snapshots {
  std::vector<EntryKey> keys;
  std::vector<int> numbers; ///< of the training mu
  Matrix values;

  Snapshots(std::vector<EntryKey> k, std::vector<int> n)
      : keys(std::move(k)), numbers(std::move(n)), values(keys.size(), numbers.size()) {}
  bool has(std::size_t number) const {
    return std::find(numbers.begin(), numbers.end(), static_cast<int>(number)) != numbers.end();
  }
  template <class Values> void add(std::size_t number, Values &&values_at) {
    const auto found = std::find(numbers.begin(), numbers.end(), static_cast<int>(number));
    if (found != numbers.end()) values.col(found - numbers.begin()) = values_at();
  }
  Eim separate(MPI_Comm comm, const EimOptions &options) const {
    if (numbers.empty()) return {};
    Eim result = eim(comm, values, keys, options);
    for (int &number : result.snapshots)
      number = numbers[number];
    return result;
  }
  /// The snapshots of the rows from `first` on, `count` of them.
  Snapshots rows(PetscInt first, PetscInt count) const {
    std::vector<Index> taken;
    Snapshots result({}, numbers);
    for (std::size_t e = 0; e < keys.size(); ++e) {
      if (keys[e].row < first || keys[e].row >= first + count) continue;
      taken.push_back(static_cast<Index>(e));
      result.keys.push_back(keys[e]);
    }
    result.values = values(taken, Eigen::all);
    return result;
  }
};

/// B as one, or B^n and B^tau apart.
void separate_rows(const Snapshots &b, Index normal, Index dual, const EimOptions &options,
                   const std::optional<RowOptions> &apart, AffineOperators &result) {
  const bool friction = dual > normal;
  if (apart && friction) {
    const Eim whole = b.separate(MPI_COMM_SELF, {.tolerance = 0, .max_size = 1});
    if (whole.exact()) {
      result.b = whole;
      return;
    }
    const auto n = static_cast<PetscInt>(normal), all = static_cast<PetscInt>(dual);
    result.b = b.rows(0, n).separate(MPI_COMM_SELF, apart->normal);
    result.b_tangential = b.rows(n, all - n).separate(MPI_COMM_SELF, apart->tangential);
    return;
  }
  result.b = b.separate(MPI_COMM_SELF, apart ? apart->normal : options);
}

/// The sampled entries of B, in the order of its terms.
std::vector<EntryKey> entries_of_b(const AffineOperators &affine) {
  std::vector<EntryKey> entries = affine.b.entries;
  entries.insert(entries.end(), affine.b_tangential.entries.begin(),
                 affine.b_tangential.entries.end());
  return entries;
}

} // namespace

std::vector<int> interpolated_samples(const Sum &sum, const ParameterSpace &space,
                                      const std::vector<Mu> &set) {
  std::set<std::vector<double>> seen;
  std::vector<int> result;
  const bool none = split_sum(sum, space).mapped.empty();
  for (std::size_t p = 0; p < set.size() && !none; ++p)
    if (seen.insert(values_of_dependence(sum, expand(space, set[p]))).second)
      result.push_back(static_cast<int>(p));
  return result;
}

EimOptions eim_of_body(const Scene &scene, EimOptions options) {
  constexpr double of_rest = 1e-6;
  if (scene.components > 1) options.tolerance *= of_rest;
  return options;
}

std::vector<RowsOfB> rows_of_b(const AffineOperators &affine, const Problem &problem) {
  const Index dual = problem.dual_size();
  if (affine.b_tangential.size() == 0) return {{affine.b, 0, dual}};
  const Index normal = problem.contact().nodes();
  return {{affine.b, 0, normal}, {affine.b_tangential, normal, dual - normal}};
}

AffineTerms separate_imposed_energy(const Problem &problem) {
  const auto &[sum, split, exact] = problem.imposed_energy();
  AffineTerms terms;
  if (sum.empty()) return terms;
  const Index sampled = split.mapped.empty() ? 0 : 1;
  terms.exact = static_cast<int>(exact.size());
  terms.reduced = Matrix::Ones(1, terms.exact + sampled);
  for (std::size_t q = 0; q < exact.size(); ++q)
    terms.reduced(0, static_cast<Index>(q)) = exact[q];
  terms.interpolation = Matrix::Identity(sampled, sampled);
  std::vector<TouchedCell> mine;
  visit_domain(problem, sum, split.mapped, [&](const std::vector<int> &nodes, TouchedCell cell) {
    cell.imposed_by = imposed_by_at(problem.dofs(), nodes);
    cell.entries = {{0, 0}};
    if (!cell.imposed_by.empty() || !sum[cell.term].of_imposed) mine.push_back(std::move(cell));
  });
  const Mesh &mesh = problem.mesh();
  terms.samples = {to_sample_mesh(mesh.dim, mesh.dim + 1, gather_cells(problem.comm(), mine))};
  return terms;
}

AffineOperators separate(Problem &problem, const std::vector<Mu> &training,
                         const EimOptions &options, const std::optional<RowOptions> &apart) {
  std::vector<int> all(training.size()), none;
  std::iota(all.begin(), all.end(), 0);
  const Scene &scene = problem.scene();
  const bool without_b = !separable_contact(scene), without_g = !separable_gap(scene);
  const Summed<Mat> &a_terms = problem.a_terms();
  const Summed<Vec> &f_terms = problem.f_terms();
  const Operators &op = problem.assemble(training.front());
  const LowerTriangle triangle(op.a, problem.dofs());
  std::vector<EntryKey> f_keys, g_keys;
  for (const PetscInt natural : problem.dofs().natural_owned)
    f_keys.push_back({natural, 0});
  for (PetscInt i = 0; i < op.g.size(); ++i)
    g_keys.push_back({i, 0});
  Snapshots a(triangle.keys(), interpolated_samples(scene.a, scene.parameters, training));
  Snapshots f(f_keys, interpolated_samples(scene.f, scene.parameters, training)),
      b(nonzero_keys(op.b), without_b ? none : all), g(g_keys, without_g ? none : all);
  for (const int number : all) {
    const auto p = static_cast<std::size_t>(number);
    if (without_b && !a.has(p) && !f.has(p)) continue;
    problem.assemble(training[p]);
    a.add(p, [&] { return triangle.values(a_terms.mapped.get()); });
    f.add(p, [&] { return local_values(f_terms.mapped.get()); });
    b.add(p, [&] { return nonzero_values(op.b); });
    g.add(p, [&] { return op.g; });
  }

  AffineOperators result;
  const EimOptions of_body = eim_of_body(scene, options);
  result.a = a.separate(problem.comm(), of_body);
  separate_rows(b, problem.contact().nodes(), problem.dual_size(), options, apart, result);
  result.f = f.separate(problem.comm(), of_body);
  result.g = g.separate(MPI_COMM_SELF, options);
  result.sample_a = {sample_domain(problem, scene.a, a_terms.split.mapped, result.a.entries, true)};
  result.sample_f = {
      sample_domain(problem, scene.f, f_terms.split.mapped, result.f.entries, false)};
  if (without_b) return result;
  result.sample_b = sample_contact(problem.contact(), entries_of_b(result), true);
  if (without_g) return result;
  result.sample_g = sample_contact(problem.contact(), result.g.entries, false);
  return result;
}

} // namespace rbvi
