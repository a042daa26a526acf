#include "rbvi/fem/distributed_contact.hpp"

#include "rbvi/par/collective.hpp"
#include "rbvi/par/columns.hpp"

#include <unordered_set>

namespace rbvi {

namespace {

/// The nodes of an interface that belong to this rank. `natural`: the numbers of its mesh nodes;
/// `of_rank`: those that the rank owns.
WantedNodes own_nodes(const DualSpace &dual, const std::vector<PetscInt> &natural,
                      const std::unordered_set<PetscInt> &of_rank, MPI_Comm comm) {
  WantedNodes own;
  const int rank = rank_of(comm), ranks = ranks_of(comm);
  for (Index i = 0; i < dual.nodes(); ++i)
    if (dual.vertices.empty()) {
      own.push_back(i * ranks / dual.nodes() == rank);
    } else {
      const auto vertex = static_cast<std::size_t>(dual.vertices[i]);
      own.push_back(of_rank.contains(natural[vertex]));
    }
  return own;
}

/// The rows of some node in ContactOperators::b: normal, then tangential.
std::vector<Index> rows_of(const Contact &contact, std::size_t interface, Index node) {
  const DualSpace &dual = contact.interfaces[interface]->dual();
  const Index first = contact.first_row[interface], tangents = dual.components - 1;
  std::vector<Index> rows{first + node};
  for (Index k = 0; k < tangents; ++k)
    rows.push_back(first + dual.nodes() + node * tangents + k);
  return rows;
}

SparseMatrix rows_at(const SparseMatrix &matrix, const std::vector<Index> &rows) {
  SparseMatrix result(std::ssize(rows), matrix.cols());
  for (Index k = 0; k < result.rows(); ++k) {
    result.startVec(k);
    for (SparseMatrix::InnerIterator entry(matrix, rows[k]); entry; ++entry)
      result.insertBack(k, entry.col()) = entry.value();
  }
  result.finalize();
  return result;
}

/// This rank's rows, with other numbers for their columns.
Handle<Mat> matrix_of(MPI_Comm comm, const SparseMatrix &own, const std::vector<PetscInt> &columns,
                      PetscInt local_columns) {
  std::vector<PetscInt> first{0}, column;
  std::vector<PetscScalar> value;
  for (Index row = 0; row < own.rows(); ++row) {
    for (SparseMatrix::InnerIterator entry(own, row); entry; ++entry) {
      column.push_back(columns[entry.col()]);
      value.push_back(entry.value());
    }
    first.push_back(static_cast<PetscInt>(column.size()));
  }
  Handle<Mat> result;
  RBVI_CALL(MatCreateMPIAIJWithArrays(comm, static_cast<PetscInt>(own.rows()), local_columns,
                                      PETSC_DETERMINE, PETSC_DETERMINE, first.data(), column.data(),
                                      value.data(), result.put()));
  return result;
}

} // namespace

DualLayout share_dual(const Contact &contact, const InterfacePlaces &places, const Mesh &mesh,
                      const Dofs &dofs) {
  std::unordered_set<PetscInt> of_rank;
  for (std::size_t node = 0; node < mesh.natural_node.size(); ++node)
    if (mesh.owned_node[node]) of_rank.insert(mesh.natural_node[node]);
  DualLayout layout;
  layout.comm = mesh.comm;
  layout.local_columns = static_cast<PetscInt>(dofs.natural_owned.size());
  Index first_node = 0;
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    const DualSpace &dual = contact.interfaces[i]->dual();
    layout.own.push_back(own_nodes(dual, places.natural_nodes[i], of_rank, mesh.comm));
    for (Index node = 0; node < dual.nodes(); ++node) {
      if (!layout.own[i][node]) continue;
      layout.nodes.push_back(first_node + node);
      const std::vector<Index> rows = rows_of(contact, i, node);
      layout.rows.insert(layout.rows.end(), rows.begin(), rows.end());
    }
    first_node += dual.nodes();
  }
  PetscInt first = 0;
  const auto count = static_cast<PetscInt>(layout.rows.size());
  MPI_Exscan(&count, &first, 1, MPIU_INT, MPI_SUM, mesh.comm);
  layout.numbers.assign(contact.dual_size(), 0);
  for (std::size_t k = 0; k < layout.rows.size(); ++k)
    layout.numbers[layout.rows[k]] = first + static_cast<PetscInt>(k);
  over_ranks(mesh.comm, MPI_SUM, layout.numbers);
  layout.columns = global_rows(places.trace, dofs.first_free);
  return layout;
}

NodeLaws own_laws(const DualLayout &layout, const NodeLaws &laws) {
  NodeLaws own;
  own.tangents = laws.tangents;
  for (const Index node : layout.nodes) {
    const bool with_tangent = laws.has_tangent(node);
    own.normal.push_back(own.rows);
    own.tangent.push_back(with_tangent ? own.rows + 1 : -1);
    own.bound.push_back(laws.bound[node]);
    own.free.push_back(laws.free_at(node));
    own.rows += 1 + (with_tangent ? laws.tangents : 0);
  }
  return own;
}

SparseMatrix own_rows(const DualLayout &layout, const SparseMatrix &of_multipliers) {
  return rows_at(of_multipliers, layout.rows);
}

Handle<Mat> distribute_rows(const DualLayout &layout, const SparseMatrix &own) {
  return matrix_of(layout.comm, own, layout.columns, layout.local_columns);
}

Handle<Vec> distribute_values(MPI_Comm comm, const Vector &own) {
  Handle<Vec> result;
  RBVI_CALL(VecCreateMPI(comm, static_cast<PetscInt>(own.size()), PETSC_DETERMINE, result.put()));
  PetscScalar *values = nullptr;
  RBVI_CALL(VecGetArrayWrite(result.get(), &values));
  std::copy(own.begin(), own.end(), values);
  RBVI_CALL(VecRestoreArrayWrite(result.get(), &values));
  return result;
}

SparseMatrix gather_rows(MPI_Comm comm, const SparseMatrix &own, const std::vector<Index> &numbers,
                         Index all) {
  std::vector<PetscInt> places;
  std::vector<double> values;
  for (Index k = 0; k < own.rows(); ++k)
    for (SparseMatrix::InnerIterator entry(own, k); entry; ++entry) {
      places.insert(places.end(),
                    {static_cast<PetscInt>(numbers[k]), static_cast<PetscInt>(entry.col())});
      values.push_back(entry.value());
    }
  places = gather_all(comm, places, MPIU_INT);
  values = gather_all(comm, values, MPI_DOUBLE);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < values.size(); ++k)
    entries.emplace_back(places[2 * k], places[2 * k + 1], values[k]);
  SparseMatrix whole(all, own.cols());
  whole.setFromTriplets(entries.begin(), entries.end());
  return whole;
}

DistributedContact distribute(const DualLayout &layout, const ContactOperators &operators,
                              const NodeLaws &laws) {
  DistributedContact result;
  result.laws = own_laws(layout, laws);
  result.b = distribute_rows(layout, own_rows(layout, operators.b));
  result.g = distribute(layout, operators.g);
  Vector weights(result.laws.rows);
  for (Index i = 0; i < result.laws.nodes(); ++i) {
    const auto node = static_cast<std::size_t>(i);
    const double weight = operators.weights[layout.nodes[node]];
    weights[result.laws.normal[node]] = weight;
    if (result.laws.has_tangent(i))
      weights.segment(result.laws.tangent[node], result.laws.tangents).setConstant(weight);
  }
  result.weights = distribute_values(layout.comm, weights);
  return result;
}

Handle<Mat> distribute(const DualLayout &layout, const SparseMatrix &w_product) {
  return matrix_of(layout.comm, own_rows(layout, w_product), layout.numbers,
                   static_cast<PetscInt>(layout.rows.size()));
}

Handle<Vec> distribute(const DualLayout &layout, const Vector &multipliers) {
  return distribute_values(layout.comm, multipliers(layout.rows));
}

Vector on_every_rank(const DualLayout &layout, const Vector &own) {
  Vector result = Vector::Zero(std::ssize(layout.numbers));
  result(layout.rows) = own;
  over_ranks(layout.comm, MPI_SUM, result); // exact: zero but on the owner
  return result;
}

Vector on_every_rank(const DualLayout &layout, Vec multipliers) {
  return on_every_rank(layout, local_values(multipliers));
}

void gather_rows(const DualLayout &layout, const Contact &contact, std::size_t interface,
                 ContactOperators &operators) {
  std::vector<Index> nodes, rows;
  const WantedNodes &own = layout.own[interface];
  for (Index node = 0; node < std::ssize(own); ++node) {
    if (!own[node]) continue;
    nodes.push_back(node);
    for (const Index row : rows_of(contact, interface, node))
      rows.push_back(row - contact.first_row[interface]);
  }
  for (const auto &[matrix, of] : {std::pair{&operators.b, &rows}, {&operators.nodal_b, &nodes}})
    *matrix = gather_rows(layout.comm, rows_at(*matrix, *of), *of, matrix->rows());
  for (Vector *values : {&operators.g, &operators.weights, &operators.nodal_gap})
    over_ranks(layout.comm, MPI_SUM, *values); // exact: zero but on the owner
}

} // namespace rbvi
