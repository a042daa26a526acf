// E^T A^-1 E of a model on its contact dofs: the sum of its terms, a column when it is required. A
// column of one body is zero on the others.
#pragma once

#include "rbvi/law/nonlinear/nonlinear.hpp"
#include "rbvi/rom/model/model.hpp"

namespace rbvi {

/// The law of a query has to be met to this.
constexpr double largest_residual = 1e-8;

class ModelCompliance : public ComplianceColumns {
public:
  /// `operator_of` must outlive it; its terms are those of the contact dofs.
  explicit ModelCompliance(const CondensedOperator &operator_of);
  /// The coefficients of the terms; columns of other ones are forgotten.
  /// True if they are others than before.
  bool set(const Vector &coefficients);

  Index size() const override { return size_; }
  void require(const std::vector<Index> &dofs) override;
  Eigen::Map<const Vector> column(Index dof) const override {
    return {columns_.col(dof).data(), size_};
  }
  Range body_of(Index dof) const override { return bodies_[dof]; }
  /// Adds a multiple of a column, made where it is not known.
  void add(Index dof, double factor, Eigen::Ref<Vector> sum) {
    make(dof);
    const auto [first, count] = body_of(dof);
    sum.segment(first, count) += factor * columns_.col(dof).segment(first, count);
  }

private:
  void make(Index dof);

  const CondensedOperator &of_;
  Index size_;
  Vector coefficients_;
  Matrix columns_;
  std::vector<bool> known_;
  std::vector<Range> bodies_; ///< per dof
};

} // namespace rbvi
