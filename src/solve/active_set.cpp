#include "rbvi/core/error.hpp"
#include "rbvi/core/lcp.hpp"
#include "rbvi/solve/methods.hpp"

namespace rbvi {

namespace {

/// E^T A^-1 E B^T(:, which): the contact trace of the response to unit multipliers.
Matrix condensed_columns(KSP ksp, const Trace &trace, const Operators &op,
                         const std::vector<Index> &which) {
  Matrix loads = Matrix::Zero(op.b.cols(), static_cast<Index>(which.size()));
  for (std::size_t k = 0; k < which.size(); ++k)
    loads.col(static_cast<Index>(k)) = op.b.row(which[k]).transpose();
  const Handle<Mat> rhs = extension(trace, loads, op.a);
  Handle<Mat> response;
  RBVI_CALL(MatDuplicate(rhs.get(), MAT_DO_NOT_COPY_VALUES, response.put()));
  RBVI_CALL(KSPMatSolve(ksp, rhs.get(), response.get()));
  return op.b * restrict_to(trace, response.get());
}

} // namespace

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
