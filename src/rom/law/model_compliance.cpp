#include "model_compliance.hpp"

#include "rbvi/rom/model/packed.hpp"

#include <cmath>

namespace rbvi {

ModelCompliance::ModelCompliance(const CondensedOperator &operator_of)
    : of_(operator_of),
      size_(std::lround(std::sqrt(static_cast<double>(operator_of.terms.rows())))),
      columns_(Matrix::Zero(size_, size_)), known_(size_) {
  for (const Index size : diagonal_blocks(operator_of.terms))
    bodies_.insert(bodies_.end(), static_cast<std::size_t>(size), {std::ssize(bodies_), size});
}

bool ModelCompliance::set(const Vector &coefficients) {
  if (coefficients_.size() == coefficients.size() && coefficients_ == coefficients) return false;
  coefficients_ = coefficients;
  known_.assign(known_.size(), false);
  return true;
}

void ModelCompliance::make(Index dof) {
  if (known_[dof]) return;
  const auto [first, count] = body_of(dof);
  columns_.col(dof).segment(first, count).noalias() =
      of_.terms.middleRows(dof * size_ + first, count) * coefficients_;
  known_[dof] = true;
}

void ModelCompliance::require(const std::vector<Index> &dofs) {
  for (const Index dof : dofs)
    make(dof);
}

} // namespace rbvi
