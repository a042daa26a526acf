#include "rbvi/mor/separation/affine.hpp"

#include "rbvi/contact/entity_sum.hpp"
#include "rbvi/mor/separation/operator_entries.hpp"
#include "rbvi/par/gather.hpp"

#include <algorithm>
#include <numeric>
#include <set>

namespace rbvi {

namespace {

/// One cell that touches sampled entries: its number, its vertices, and (entry, local) pairs.
struct TouchedCell {
  PetscInt number;
  std::array<Point, 4> vertices;
  std::vector<std::pair<int, int>> entries;
};

/// `corners`: vertices of each cell.
SampleMesh to_sample_mesh(int dim, int corners, std::vector<TouchedCell> cells) {
  std::sort(cells.begin(), cells.end(),
            [](const TouchedCell &x, const TouchedCell &y) { return x.number < y.number; });
  SampleMesh sample;
  sample.corners = corners;
  sample.vertices.resize(static_cast<Index>(cells.size()) * corners, dim);
  for (std::size_t k = 0; k < cells.size(); ++k) {
    for (int i = 0; i < corners; ++i)
      for (int c = 0; c < dim; ++c)
        sample.vertices(static_cast<Index>(k) * corners + i, c) =
            cells[k].vertices[static_cast<std::size_t>(i)][static_cast<std::size_t>(c)];
    for (const auto &[entry, local] : cells[k].entries)
      sample.contributions.push_back({entry, static_cast<int>(k), local});
  }
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
      rows.push_back(static_cast<PetscInt>(first_row + row));
    if (matrix) {
      columns.clear();
      for (const Index column : interface.columns_of(e))
        columns.push_back(static_cast<PetscInt>(column));
    }
    TouchedCell entity{static_cast<PetscInt>(e), interface.reference_entity(e).reference,
                       touched(entries, rows, columns)};
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
  std::vector<double> packed; // number, 12 coordinates, count, pairs
  for (const TouchedCell &cell : mine) {
    packed.push_back(static_cast<double>(cell.number));
    for (const Point &x : cell.vertices)
      packed.insert(packed.end(), x.begin(), x.end());
    packed.push_back(static_cast<double>(cell.entries.size()));
    for (const auto &[entry, local] : cell.entries) {
      packed.push_back(entry);
      packed.push_back(local);
    }
  }
  const std::vector<double> all = gather_all(comm, packed, MPI_DOUBLE);
  std::vector<TouchedCell> cells;
  for (auto at = all.begin(); at != all.end();) {
    TouchedCell cell{static_cast<PetscInt>(*at++), {}, {}};
    for (Point &x : cell.vertices)
      for (double &coordinate : x)
        coordinate = *at++;
    for (auto count = static_cast<int>(*at++); count > 0; --count) {
      const int entry = static_cast<int>(*at++);
      cell.entries.emplace_back(entry, static_cast<int>(*at++));
    }
    cells.push_back(std::move(cell));
  }
  return cells;
}

/// Cells of the whole mesh; matrix: rows and columns are natural dofs, vector: column 0.
SampleMesh sample_domain(const Problem &problem, const std::vector<EntryKey> &entries,
                         bool matrix) {
  const Mesh &mesh = problem.mesh();
  const auto components = problem.dofs().components;
  std::vector<TouchedCell> mine;
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    std::vector<PetscInt> rows;
    TouchedCell cell{mesh.natural_cell[k], {}, {}};
    const auto nodes = nodes_of(mesh, k);
    for (std::size_t i = 0; i < nodes.size() && nodes[i] >= 0; ++i) {
      const auto node = static_cast<std::size_t>(nodes[i]);
      if (i <= static_cast<std::size_t>(mesh.dim)) cell.vertices[i] = mesh.points[node];
      for (int c = 0; c < components; ++c)
        rows.push_back(mesh.natural_node[node] * components + c);
    }
    cell.entries = touched(entries, rows, matrix ? rows : std::vector<PetscInt>{0});
    if (!cell.entries.empty()) mine.push_back(std::move(cell));
  }
  return to_sample_mesh(mesh.dim, mesh.dim + 1, gather_cells(problem.comm(), mine));
}

/// The first mu of the set with each value of the parameters that a depends on, by number.
std::vector<int> different_stiffness(const Problem &problem, const std::vector<Mu> &set) {
  std::set<std::vector<double>> seen;
  std::vector<int> result;
  for (std::size_t p = 0; p < set.size(); ++p)
    if (seen.insert(problem.stiffness_values(expand(problem.scene().parameters, set[p]))).second)
      result.push_back(static_cast<int>(p));
  return result;
}

/// The keys' values at every mu of a training set, column by column.
struct Snapshots {
  std::vector<EntryKey> keys;
  std::vector<int> numbers; ///< of the training mu
  Matrix values;

  Snapshots(std::vector<EntryKey> k, std::vector<int> n)
      : keys(std::move(k)), numbers(std::move(n)), values(keys.size(), numbers.size()) {}
  template <class Values> void add(std::size_t number, Values &&values_at) {
    const auto found = std::find(numbers.begin(), numbers.end(), static_cast<int>(number));
    if (found != numbers.end()) values.col(found - numbers.begin()) = values_at();
  }
  Eim separate(MPI_Comm comm, const EimOptions &options) const {
    if (numbers.empty()) return {};
    Eim result = eim(comm, values, keys, options);
    for (int &number : result.snapshots)
      number = numbers[static_cast<std::size_t>(number)];
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

std::vector<RowsOfB> rows_of_b(const AffineOperators &affine, const Problem &problem) {
  const Index dual = problem.dual_size();
  if (affine.b_tangential.size() == 0) return {{affine.b, 0, dual}};
  const Index normal = problem.contact().nodes();
  return {{affine.b, 0, normal}, {affine.b_tangential, normal, dual - normal}};
}

AffineOperators separate(Problem &problem, const std::vector<Mu> &training,
                         const EimOptions &options, const std::optional<RowOptions> &apart) {
  std::vector<int> all(training.size()), none;
  std::iota(all.begin(), all.end(), 0);
  const bool without_b = !separable_contact(problem.scene()),
             load = static_cast<bool>(problem.scene().f);
  const Operators &op = problem.assemble(training.front());
  const LowerTriangle triangle(op.a, problem.dofs());
  std::vector<EntryKey> f_keys, g_keys;
  for (const PetscInt natural : problem.dofs().natural_owned)
    f_keys.push_back({natural, 0});
  for (PetscInt i = 0; i < op.g.size(); ++i)
    g_keys.push_back({i, 0});
  Snapshots a(triangle.keys(), different_stiffness(problem, training));
  Snapshots f(f_keys, load ? all : none), b(nonzero_keys(op.b), without_b ? none : all),
      g(g_keys, without_b ? none : all);
  for (const int number : load || !without_b ? all : a.numbers) {
    const auto p = static_cast<std::size_t>(number);
    problem.assemble(training[p]);
    a.add(p, [&] { return triangle.values(op.a); });
    f.add(p, [&] { return local_values(op.f); });
    b.add(p, [&] { return nonzero_values(op.b); });
    g.add(p, [&] { return op.g; });
  }

  AffineOperators result;
  result.a = a.separate(problem.comm(), options);
  separate_rows(b, problem.contact().nodes(), problem.dual_size(), options, apart, result);
  result.f = f.separate(problem.comm(), options);
  result.g = g.separate(MPI_COMM_SELF, options);
  result.sample_a = {sample_domain(problem, result.a.entries, true)};
  result.sample_f = {sample_domain(problem, result.f.entries, false)};
  if (without_b) return result;
  result.sample_b = sample_contact(problem.contact(), entries_of_b(result), true);
  result.sample_g = sample_contact(problem.contact(), result.g.entries, false);
  return result;
}

} // namespace rbvi
