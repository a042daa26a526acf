// The loads on the contact dofs that a condensed operator is made of.
#include "condensed_loads.hpp"

#include "cone_tools.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/mor/condensed.hpp"

#include <algorithm>
#include <numeric>
#include <set>

namespace rbvi {

namespace {

/// The terms of b on the basis, side by side: contact dofs x (multipliers * terms).
Matrix separated_loads(Problem &problem, const AffineOperators &affine,
                       const std::vector<Mu> &training, const Matrix &basis) {
  const Index m = basis.cols();
  Matrix loads = Matrix::Zero(problem.trace().size, m * affine.b_size());
  Operators op;
  int first = 0;
  for (const RowsOfB &rows : rows_of_b(affine, problem)) {
    for (int i = 0; i < rows.eim.size(); ++i) {
      const int snapshot = rows.eim.snapshots[i];
      problem.assemble_contact(training[snapshot], op);
      const Matrix at_snapshot = op.b.middleRows(rows.first, rows.count).transpose() *
                                 basis.middleRows(rows.first, rows.count);
      for (int p = i; p < rows.eim.size(); ++p)
        loads.middleCols((first + p) * m, m) += rows.eim.combination(i, p) * at_snapshot;
    }
    first += rows.eim.size();
  }
  return loads;
}

constexpr Index layers = 2; ///< of neighbours

/// Some rows of b with their neighbours: along a curve by their numbers, on a surface by their
/// nodes.
std::vector<bool> with_neighbours(Problem &problem, const std::vector<bool> &rows) {
  const Index count = std::ssize(rows);
  std::vector<bool> result = rows;
  if (problem.scene().dim == 2) {
    for (Index i = 0; i < count; ++i)
      for (Index k = std::max<Index>(0, i - layers); k < std::min(count, i + layers + 1); ++k)
        if (rows[k]) result[i] = true;
    return result;
  }
  for (Index layer = 0; layer < layers; ++layer)
    add_neighbours(result, problem.w_product());
  const Contact &contact = problem.contact();
  for (Index i = 0; i < count; ++i)
    if (const DualRow of = dual_row(contact, i);
        !of.normal && result[contact.first_row[of.interface] + of.node])
      result[i] = true;
  return result;
}

/// Contact dofs that b couples, at some mu of the set, with rows of it that are wanted there or
/// have one that is among their neighbours. Increasing.
template <class Wanted>
std::vector<Index> coupled_dofs(Problem &problem, const std::vector<Mu> &set, Wanted &&wanted) {
  std::set<Index> dofs;
  Operators op;
  for (std::size_t p = 0; p < set.size(); ++p) {
    try {
      problem.assemble_contact(set[p], op);
    } catch (const Error &) {
      continue; // where the interfaces cannot be, no query has an answer
    }
    std::vector<bool> near(op.b.rows());
    for (Index i = 0; i < op.b.rows(); ++i)
      near[i] = wanted(p, i);
    near = with_neighbours(problem, near);
    for (Index i = 0; i < op.b.rows(); ++i)
      for (SparseMatrix::InnerIterator entry(op.b, i); entry && near[i]; ++entry)
        if (entry.value() != 0) dofs.insert(entry.col());
  }
  return {dofs.begin(), dofs.end()};
}

/// Beside multipliers that are positive in a sample: where contact is at other mu.
std::vector<Index> loaded_dofs(Problem &problem, const std::vector<Mu> &training,
                               const Matrix &multipliers) {
  return coupled_dofs(problem, training, [&](std::size_t p, Index row) {
    return multipliers(row, static_cast<Index>(p)) > 0;
  });
}

/// Those that the rows of the basis meet wherever the parameters are.
std::vector<int> met_dofs(Problem &problem, std::vector<Mu> set, const Matrix &basis) {
  std::vector<int> dofs(problem.trace().size);
  std::iota(dofs.begin(), dofs.end(), 0);
  const Vector rows = basis.rowwise().lpNorm<Eigen::Infinity>();
  if (follows_state(problem.scene()) || rows.minCoeff() > 0) return dofs;
  const ParameterSpace &space = problem.scene().parameters;
  std::string corners = "grid:2";
  for (int i = 1; i < space.size(); ++i)
    corners += ",2";
  for (const std::string &more : {corners, std::string("random:100:31")})
    for (Mu &mu : parse_set(space, more))
      set.push_back(std::move(mu));
  const auto met =
      coupled_dofs(problem, set, [&](std::size_t, Index row) { return rows[row] > 0; });
  return {met.begin(), met.end()};
}

} // namespace

CondensedLoads condensed_loads(Problem &problem, const AffineOperators &affine,
                               const std::vector<Mu> &training, const Matrix &multipliers,
                               const Matrix &basis) {
  if (!separable_contact(problem.scene())) {
    const Index dofs = problem.trace().size;
    std::vector<int> met = met_dofs(problem, training, basis);
    const auto size = std::ssize(met);
    return {unit_loads(dofs, met), size, std::move(met), false,
            loaded_dofs(problem, training, multipliers)};
  }
  CondensedLoads loads{
      separated_loads(problem, affine, training, basis), basis.cols(), {}, affine.b_size() == 1};
  if (!loads.join) loads.dofs = loaded_dofs(problem, training, multipliers);
  return loads;
}

} // namespace rbvi
