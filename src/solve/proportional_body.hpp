// A body whose stiffness is in proportion to a coefficient of mu, A(mu) = c(mu) A_1, as that of a
// solid is to its size: one factorisation serves a whole sweep. Where rows of B only scale with mu,
// too, so do the responses to multipliers, which are kept row by row.
#pragma once

#include "rbvi/solve/full_body.hpp"

namespace rbvi {

class ProportionalBody : public FullBody {
public:
  /// Of a scene whose stiffness_scales. `problem` must outlive it. Factorises at the first set().
  explicit ProportionalBody(const Problem &problem);
  /// A of the next calls, that of these operators. Not collective.
  void set(const Operators &op);

  /// Rows of B that are in proportion to those of an earlier call cost no solve.
  Matrix moved(const SparseMatrix &b, const std::vector<Index> &which) override;
  Vector free(const Operators &op) override { return first_->free(op) / ratio_; }
  double displacement(const Operators &op, const Vector &lambda, Vec u) override;

private:
  void make(const std::vector<Index> &dofs, Eigen::Ref<Matrix> columns) override;

  struct Kept {
    Eigen::SparseVector<double, Eigen::RowMajor> row; ///< of size 0: not asked for yet
    Vector response;
  };
  const Problem &problem_;
  Handle<KSP> ksp_;
  Handle<Mat> a_;                       ///< at the first mu
  std::unique_ptr<FactoredBody> first_; ///< with it
  double coefficient_ = 0, ratio_ = 1;  ///< c there, and what it is now over that
  std::vector<Kept> kept_;              ///< of each row of B
};

} // namespace rbvi
