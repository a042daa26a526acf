#include "rbvi/study/stability_report.hpp"

#include "rbvi/mor/high_fidelity_pair.hpp"
#include "rbvi/mor/reduce.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/columns.hpp"
#include "rbvi/par/small_svd.hpp"

#include <algorithm>
#include <limits>

namespace rbvi {

namespace {

/// What the arithmetic leaves of a singular value, relative to the largest.
constexpr double round_off = 1e-10;

LinearBasis basis_of(Problem &problem, const Matrix &natural_columns) {
  LinearBasis basis;
  const Handle<Vec> like = make_vector(problem.dofs());
  basis.columns = make_columns(like.get(), natural_columns.cols(), problem.v_product());
  for (Index j = 0; j < natural_columns.cols(); ++j)
    RBVI_CALL(BVInsertVec(basis.columns.get(), static_cast<PetscInt>(j),
                          from_natural(problem.dofs(), natural_columns.col(j)).get()));
  return basis;
}

} // namespace

StabilityCheck make_stability_check(Problem &problem, const ReducedModel &model) {
  StabilityCheck check;
  check.modes = model.body.modes;
  check.dual = orthonormal_dual_basis(
      model.contact.law ? multiplier_functions(model.contact.dual_basis, model.contact.law->basis)
                        : model.contact.dual_basis,
      problem.w_product());
  Operators op;
  const bool few_loads = model.contact.b.size() == 1 && iterates_constants(problem);
  if (few_loads) problem.assemble_contact(box_centre(model.scene.parameters), op);
  check.space = make_riesz_space(problem.v_product(), problem.trace(), {},
                                 few_loads ? Matrix(op.b.transpose() * check.dual) : Matrix());
  check.coordinates = mode_coordinates(check.space, basis_of(problem, model.fields.basis));
  return check;
}

std::vector<InfSup> infsup_over(MPI_Comm comm, Problem &problem, const StabilityCheck &check,
                                const std::vector<ContactPoint> &set, bool b_is_scaled) {
  const Matrix modes = check.coordinates.leftCols(check.modes);
  const std::vector<PairConstants> pairs =
      high_fidelity_pairs(problem, problem.v_product(), check.space,
                          {set.begin(), b_is_scaled ? set.begin() + 1 : set.end()});
  Matrix values = Matrix::Zero(4, std::ssize(set)); // the last is |b|
  take_turns(comm, set.size(), [&](std::size_t p) {
    Operators op;
    problem.assemble_contact(set[p].mu, op, set[p].state);
    const InfSup c = infsup_constants(check.space, op.b, modes, check.coordinates, check.dual);
    values.col(p) << c.dec, c.on, c.off, op.b.norm();
  });
  over_ranks(comm, MPI_SUM, values);
  std::vector<InfSup> result;
  for (std::size_t p = 0; p < set.size(); ++p) {
    const PairConstants &pair = pairs[b_is_scaled ? 0 : p];
    const auto at = values.col(p);
    const double scale = b_is_scaled ? at[3] / values(3, 0) : 1;
    result.push_back({scale * pair.beta, at[0], at[1], at[2], scale * pair.c});
  }
  return result;
}

ContactPoint weakest_form(Problem &problem, const std::vector<ContactPoint> &set) {
  constexpr double tie = 1e-10;
  double least = std::numeric_limits<double>::infinity();
  ContactPoint weakest;
  Operators op;
  for (const ContactPoint &at : set) {
    problem.assemble_contact(at.mu, op, at.state);
    if (op.b.norm() >= (1 - tie) * least) continue;
    least = op.b.norm();
    weakest = at;
  }
  return weakest;
}

BoundCheck check_bound(MPI_Comm comm, Problem &problem, const StabilityCheck &check,
                       const std::vector<ContactPoint> &set) {
  BoundCheck result{.smallest = std::numeric_limits<double>::infinity()};
  take_turns(comm, set.size(), [&](std::size_t p) {
    const Matrix t = supremizers_at(problem, check.space, check.dual, {set[p]}).front();
    const int all = static_cast<int>(check.coordinates.cols()) - check.modes;
    const auto [bound, off] = stability_path(check.coordinates, check.modes, {all}, t).front();
    result.smallest = std::min(result.smallest, off / bound.sharp);
    if (!(off >= bound.sharp - round_off * bound.c)) ++result.exceptions;
  });
  MPI_Allreduce(MPI_IN_PLACE, &result.smallest, 1, MPI_DOUBLE, MPI_MIN, comm);
  MPI_Allreduce(MPI_IN_PLACE, &result.exceptions, 1, MPI_INT, MPI_SUM, comm);
  return result;
}

std::vector<StabilityRow> stability_along(MPI_Comm comm, Problem &problem,
                                          const StabilityCheck &check,
                                          const std::vector<ContactPoint> &set,
                                          const std::vector<int> &counts) {
  // Columns: what the worst is the largest of. Smallest values enter with their sign changed.
  enum { sigma, condition, minus_classic, minus_bound, minus_ratio, minus_beta, columns };
  const auto size = std::ssize(counts);
  Matrix worst = Matrix::Constant(size, columns, -std::numeric_limits<double>::infinity());
  std::vector<int> exceptions(counts.size(), 0);
  take_turns(comm, set.size(), [&](std::size_t p) {
    const Matrix t = supremizers_at(problem, check.space, check.dual, {set[p]}).front();
    const auto steps = stability_path(check.coordinates, check.modes, counts, t);
    for (Index k = 0; k < size; ++k) {
      const auto &[bound, off] = steps[k];
      Vector here(static_cast<Index>(columns));
      here << bound.sigma, bound.sigma * bound.c / bound.on, -bound.classic / bound.on,
          -bound.sharp / bound.on, -off / bound.on, -off;
      worst.row(k) = worst.row(k).cwiseMax(here.transpose());
      if (!(off >= bound.sharp - round_off * bound.c)) ++exceptions[k];
    }
  });
  over_ranks(comm, MPI_MAX, worst);
  MPI_Allreduce(MPI_IN_PLACE, exceptions.data(), static_cast<int>(size), MPI_INT, MPI_SUM, comm);
  std::vector<StabilityRow> rows;
  for (Index k = 0; k < size; ++k) {
    const auto at = static_cast<std::size_t>(k);
    rows.push_back({counts[at], worst(k, sigma), worst(k, condition), -worst(k, minus_classic),
                    -worst(k, minus_bound), -worst(k, minus_ratio), -worst(k, minus_beta),
                    exceptions[at]});
  }
  return rows;
}

int fewest_supremizers(MPI_Comm comm, Problem &problem, const StabilityCheck &check,
                       const std::vector<ContactPoint> &set, double fraction) {
  const int all = static_cast<int>(check.coordinates.cols()) - check.modes;
  int fewest = 0; // enough for every mu so far; all + 1: nothing is
  take_turns(comm, set.size(), [&](std::size_t p) {
    const Matrix t = supremizers_at(problem, check.space, check.dual, {set[p]}).front();
    const double needed = fraction * singular_values(t, "infsup_").minCoeff();
    const auto enough = [&](int supremizers) {
      return infsup_constant(check.coordinates.leftCols(check.modes + supremizers), t) >= needed;
    };
    if (fewest > all || enough(fewest)) return;
    int few = fewest;
    fewest = enough(all) ? all : all + 1;
    while (fewest - few > 1 && fewest <= all) {
      const int middle = few + (fewest - few) / 2;
      (enough(middle) ? fewest : few) = middle;
    }
  });
  MPI_Allreduce(MPI_IN_PLACE, &fewest, 1, MPI_INT, MPI_MAX, comm);
  return fewest <= all ? fewest : -1;
}

} // namespace rbvi
