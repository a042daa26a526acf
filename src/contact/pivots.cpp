#include "rbvi/contact/pivots.hpp"

#include "rbvi/core/error.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

/// The node of the first boundary, or region, with a free dof that is nearest to the point.
Index nearest_node(const InterfaceMesh &mesh, const Point &x) {
  Index nearest = -1;
  double least = 0;
  for (Index node = 0; node < mesh.nodes(); ++node) {
    if (mesh.parts.size() > 1 && node >= mesh.parts.front()) break;
    const auto first = mesh.dofs.begin() + node * mesh.components;
    if (std::all_of(first, first + mesh.components, [](int dof) { return dof < 0; })) continue;
    const Point &p = mesh.points[node];
    const double distance = std::hypot(p[0] - x[0], p[1] - x[1], p[2] - x[2]);
    if (nearest >= 0 && distance >= least) continue;
    nearest = node;
    least = distance;
  }
  return nearest;
}

/// Half of the function in the middle of each edge at a vertex of a triangle, in one component.
void add_middles(const InterfaceMesh &mesh, std::vector<Eigen::Triplet<double>> &moves) {
  if (mesh.degree == 1 || mesh.vertices() != 3) return;
  const auto dof = [&](int node, int c) { return mesh.dofs[node * mesh.components + c]; };
  for (Index entity = 0; entity < mesh.count(); ++entity)
    for (int edge = 0; edge < 3; ++edge)
      for (const int end : {edge, (edge + 1) % 3})
        for (int c = 0; c < mesh.components; ++c) {
          const int vertex = dof(mesh.nodes_of(entity)[end], c),
                    middle = dof(mesh.nodes_of(entity)[3 + edge], c);
          if (vertex >= 0 && middle >= 0) moves.emplace_back(vertex, middle, 0.5);
        }
}

} // namespace

ContactDofs contact_dofs(const Contact &contact) {
  ContactDofs dofs;
  const Index columns = contact.interfaces.front()->mesh().columns;
  dofs.node.assign(columns, -1);
  dofs.row_node.assign(contact.dual_size(), -1);
  std::vector<Eigen::Triplet<double>> moves;
  for (int dof = 0; dof < columns; ++dof)
    moves.emplace_back(dof, dof, 1);
  Index first_node = 0;
  for (std::size_t k = 0; k < contact.interfaces.size(); ++k) {
    const InterfaceMesh &mesh = contact.interfaces[k]->mesh();
    const DualSpace &dual = contact.interfaces[k]->dual();
    for (std::size_t i = 0; i < mesh.dofs.size(); ++i) {
      if (mesh.dofs[i] < 0) continue;
      const auto node = static_cast<Index>(i) / mesh.components;
      dofs.node[mesh.dofs[i]] = first_node + node;
    }
    add_middles(mesh, moves);
    std::vector<Index> nodes = dual.vertices;
    for (Index i = std::ssize(nodes); i < dual.nodes(); ++i)
      nodes.push_back(nearest_node(mesh, dual.points[i]));
    for (Index row = contact.first_row[k]; row < contact.first_row[k + 1]; ++row)
      dofs.row_node[row] = first_node + nodes[dual_row(contact, row).node];
    first_node += mesh.nodes();
  }
  dofs.moves.resize(columns, columns); // an edge is of two triangles
  dofs.moves.setFromTriplets(moves.begin(), moves.end(), [](double a, double) { return a; });
  return dofs;
}

std::vector<Index> choose_pivots(const ContactDofs &dofs, const std::vector<Index> &rows,
                                 const SparseMatrix &c) {
  std::vector<Index> pivots(c.rows(), -1);
  std::vector<char> taken(dofs.node.size(), 0);
  for (Index k = 0; k < c.rows(); ++k) {
    const Index node = dofs.row_node[rows[k]];
    double largest = 0;
    for (SparseMatrix::InnerIterator entry(c, k); entry; ++entry) {
      const Index dof = entry.col();
      if (dofs.node[dof] != node || taken[dof] || !(std::abs(entry.value()) > largest)) continue;
      largest = std::abs(entry.value());
      pivots[k] = entry.col();
    }
    if (pivots[k] < 0)
      throw failure("an active constraint has no displacement of its own to eliminate");
    taken[pivots[k]] = 1;
  }
  return pivots;
}

void SquareFactor::compute(const Eigen::SparseMatrix<double> &matrix) {
  constexpr double round_off = 1e-14;
  single_ = take_single_entries(matrix);
  if (single_) return;
  const Eigen::SparseMatrix<double> transposed = matrix.transpose();
  // A mass matrix of the active nodes, where a constraint is that of its own node.
  if ((matrix - transposed).norm() <= round_off * matrix.norm()) {
    symmetric_ = std::make_unique<Llt>(matrix);
    if (symmetric_->info() == Eigen::Success) return;
    symmetric_.reset();
  }
  lu_ = std::make_unique<Lu>(matrix);
  if (lu_->info() != Eigen::Success) throw failure("the active constraints depend on each other");
}

/// Whether there is one entry in each row and column; columns_ and values_ then hold them.
bool SquareFactor::take_single_entries(const Eigen::SparseMatrix<double> &matrix) {
  if (matrix.nonZeros() != matrix.rows()) return false;
  columns_.assign(matrix.rows(), -1);
  values_.resize(matrix.rows());
  for (Index column = 0; column < matrix.cols(); ++column) {
    Eigen::SparseMatrix<double>::InnerIterator entry(matrix, column);
    if (!entry || entry.value() == 0 || columns_[entry.row()] >= 0) return false;
    columns_[entry.row()] = column;
    values_[entry.row()] = entry.value();
  }
  return true;
}

Matrix SquareFactor::solve(const Matrix &right) const {
  if (single_) {
    Matrix result(right.rows(), right.cols());
    result(columns_, Eigen::all) = values_.cwiseInverse().asDiagonal() * right;
    return result;
  }
  return symmetric_ ? Matrix(symmetric_->solve(right)) : Matrix(lu_->solve(right));
}

Matrix SquareFactor::solve_transposed(const Matrix &right) const {
  if (single_) return values_.cwiseInverse().asDiagonal() * right(columns_, Eigen::all);
  return symmetric_ ? Matrix(symmetric_->solve(right)) : Matrix(lu_->transpose().solve(right));
}

PivotBlock::PivotBlock(const SparseMatrix &c, const std::vector<Index> &pivots,
                       const SparseMatrix &moves) {
  std::vector<Index> position(c.cols(), -1), other(c.cols(), -1);
  for (std::size_t k = 0; k < pivots.size(); ++k)
    position[pivots[k]] = static_cast<Index>(k);
  std::vector<Eigen::Triplet<double>> block, rest;
  const SparseMatrix moved = c * SparseMatrix(moves.transpose());
  for (Index row = 0; row < c.rows(); ++row) {
    // Vertex quadrature keeps the pattern of a mass matrix.
    for (SparseMatrix::InnerIterator entry(moved, row); entry; ++entry)
      if (const Index column = position[entry.col()]; column >= 0 && entry.value() != 0)
        block.emplace_back(static_cast<int>(row), static_cast<int>(column), entry.value());
    for (SparseMatrix::InnerIterator entry(c, row); entry; ++entry) {
      if (position[entry.col()] >= 0 || entry.value() == 0) continue;
      Index &column = other[entry.col()];
      if (column < 0) {
        column = std::ssize(coupled_);
        coupled_.push_back(entry.col());
      }
      rest.emplace_back(static_cast<int>(row), static_cast<int>(column), entry.value());
    }
  }
  Eigen::SparseMatrix<double> square(c.rows(), c.rows());
  square.setFromTriplets(block.begin(), block.end());
  others_.resize(c.rows(), std::ssize(coupled_));
  others_.setFromTriplets(rest.begin(), rest.end());
  if (c.rows() > 0) factor_.compute(square);
}

SparseMatrix PivotBlock::ties(Index contact_dofs) const {
  constexpr double small = 1e-3;
  constexpr Index at_a_time = 64;
  const Eigen::SparseMatrix<double> columns = others_;
  std::vector<Eigen::Triplet<double>> entries;
  for (Index first = 0; first < columns.cols(); first += at_a_time) {
    const Index count = std::min(at_a_time, columns.cols() - first);
    const Matrix tied = factor_.solve(columns.middleCols(first, count));
    for (Index k = 0; k < count; ++k)
      for (Index i = 0; i < tied.rows(); ++i)
        if (std::abs(tied(i, k)) > small)
          entries.emplace_back(static_cast<int>(i), static_cast<int>(coupled_[first + k]),
                               -tied(i, k));
  }
  SparseMatrix result(others_.rows(), contact_dofs);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

} // namespace rbvi
