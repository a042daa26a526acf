#include "rbvi/mor/high_fidelity_pair.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/mor/small_svd.hpp"
#include "rbvi/par/collective.hpp"

#include <algorithm>

namespace rbvi {

namespace {

constexpr double round_off = 1e-10;         ///< of a singular value, relative to the largest
constexpr double largest_tolerance = 0.999; ///< sigma never exceeds 1

/// Multipliers whose support has a partner everywhere; of one body all.
std::vector<Index> covered_multipliers(const Problem &problem, const Operators &op) {
  const Vector whole = problem.w_product() * Vector::Ones(problem.dual_size());
  std::vector<Index> rows;
  for (Index i = 0; i < whole.size(); ++i)
    if (!problem.two_bodies() || op.weights[i] > (1 - 1e-9) * whole[i]) rows.push_back(i);
  return rows;
}

} // namespace

PairConstants high_fidelity_pair(const Problem &problem, const RieszSpace &space,
                                 const Operators &op) {
  const std::vector<Index> rows = covered_multipliers(problem, op);
  if (rows.empty()) throw failure("no multiplier has a partner: there is no inf-sup constant");
  const Eigen::LLT<Matrix> w(Matrix(problem.w_product())(rows, rows));
  if (w.info() != Eigen::Success) throw failure("the W product is not positive definite");
  Matrix x = Matrix::Zero(problem.dual_size(), static_cast<Index>(rows.size()));
  x(rows, Eigen::all) = Matrix(w.matrixU().solve(Matrix::Identity(x.cols(), x.cols())));
  const Vector stretch = singular_values(supremizer_coordinates(space, op.b, x));
  const bool enough = stretch.size() == x.cols(); // else V holds fewer directions than W
  return {enough ? stretch(stretch.size() - 1) : 0, stretch(0)};
}

double infsup_tolerance(MPI_Comm comm, Problem &problem, const RieszSpace &space,
                        const std::vector<Mu> &set) {
  double smallest = largest_tolerance;
  collectively(comm, [&] {
    int rank = 0, ranks = 1;
    MPI_Comm_rank(comm, &rank);
    MPI_Comm_size(comm, &ranks);
    Operators op;
    for (auto p = static_cast<std::size_t>(rank); p < set.size();
         p += static_cast<std::size_t>(ranks)) {
      problem.assemble_contact(set[p], op);
      const PairConstants pair = high_fidelity_pair(problem, space, op);
      if (!(pair.beta > round_off * pair.c))
        throw failure("beta_HF is " + short_number(pair.beta) +
                      ", zero to round-off: give -pga_tolerance a number");
      smallest = std::min(smallest, pair.beta / pair.c);
    }
  });
  MPI_Allreduce(MPI_IN_PLACE, &smallest, 1, MPI_DOUBLE, MPI_MIN, comm);
  return smallest;
}

} // namespace rbvi
