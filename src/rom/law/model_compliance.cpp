#include "model_compliance.hpp"

#include <cmath>

namespace rbvi {

ModelCompliance::ModelCompliance(const CondensedOperator &operator_of)
    : of_(operator_of),
      size_(std::lround(std::sqrt(static_cast<double>(operator_of.terms.rows())))),
      columns_(size_, size_), known_(static_cast<std::size_t>(size_)) {}

bool ModelCompliance::set(const Vector &coefficients) {
  if (coefficients_.size() == coefficients.size() && coefficients_ == coefficients) return false;
  coefficients_ = coefficients;
  known_.assign(known_.size(), false);
  return true;
}

void ModelCompliance::require(const std::vector<Index> &dofs) {
  for (const Index dof : dofs) {
    if (known_[static_cast<std::size_t>(dof)]) continue;
    columns_.col(dof).noalias() = of_.terms.middleRows(dof * size_, size_) * coefficients_;
    known_[static_cast<std::size_t>(dof)] = true;
  }
}

} // namespace rbvi
