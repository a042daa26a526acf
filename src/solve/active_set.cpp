#include "rbvi/core/error.hpp"
#include "rbvi/core/lcp.hpp"
#include "rbvi/solve/methods.hpp"

namespace rbvi {

namespace {

constexpr std::size_t block = 128; ///< right-hand sides at a time: bounds the memory

} // namespace

Matrix condensed_columns(KSP ksp, const Trace &trace, const Operators &op,
                         const std::vector<Index> &which) {
  Matrix columns(op.b.rows(), static_cast<Index>(which.size()));
  for (std::size_t first = 0; first < which.size(); first += block) {
    const std::size_t count = std::min(block, which.size() - first);
    Matrix loads = Matrix::Zero(op.b.cols(), static_cast<Index>(count));
    for (std::size_t k = 0; k < count; ++k)
      loads.col(static_cast<Index>(k)) = op.b.row(which[first + k]).transpose();
    const Handle<Mat> rhs = extension(trace, loads, op.a);
    Handle<Mat> response;
    RBVI_CALL(MatDuplicate(rhs.get(), MAT_DO_NOT_COPY_VALUES, response.put()));
    RBVI_CALL(KSPMatSolve(ksp, rhs.get(), response.get()));
    columns.middleCols(static_cast<Index>(first), static_cast<Index>(count)) =
        op.b * restrict_to(trace, response.get());
  }
  return columns;
}

MethodResult solve_active_set(KSP ksp, const Trace &trace, const Operators &op,
                              const std::vector<Index> &start) {
  MethodResult result;
  RBVI_CALL(VecDuplicate(op.f, result.u.put()));
  solve_linear(ksp, op.f, result.u.get());
  const Vector q = op.g - op.b * restrict_to(trace, result.u.get());
  const auto columns = [&](const std::vector<Index> &which) {
    return condensed_columns(ksp, trace, op, which);
  };
  LcpResult lcp = solve_lcp(columns, q, start);
  solve_linear(ksp, reaction_rhs(trace, op, lcp.x).get(), result.u.get());
  result.lambda = std::move(lcp.x);
  result.active = std::move(lcp.active);
  result.iterations = lcp.iterations;
  result.columns = lcp.columns;
  result.converged = lcp.converged;
  result.reason = lcp.reason;
  return result;
}

} // namespace rbvi
