// The compliance of a model on its contact dofs: the sum of its terms. A column of one body is zero
// on the others.
#pragma once

#include "rbvi/law/compliance.hpp"
#include "rbvi/rom/model/model.hpp"

namespace rbvi {

/// The law of a query has to be met to this.
constexpr double largest_residual = 1e-8;

class ModelCompliance : public Compliance {
public:
  /// `operator_of` must outlive it; its terms are those of the contact dofs.
  explicit ModelCompliance(const CondensedOperator &operator_of);
  /// The coefficients of the terms; columns of other ones are forgotten. Whether they are others
  /// than before.
  bool set(const Vector &coefficients);
  Range body_of(Index dof) const override { return bodies_[dof]; }

private:
  void make(const std::vector<Index> &dofs, Eigen::Ref<Matrix> columns) override;

  const CondensedOperator &of_;
  Vector coefficients_;
  std::vector<Range> bodies_; ///< per dof
};

} // namespace rbvi
