#include "model_compliance.hpp"

#include "rbvi/rom/model/packed.hpp"

#include <cmath>

namespace rbvi {

ModelCompliance::ModelCompliance(const CondensedOperator &operator_of)
    : Compliance(std::lround(std::sqrt(static_cast<double>(operator_of.terms.rows())))),
      of_(operator_of) {
  for (const Index size : diagonal_blocks(operator_of.terms))
    bodies_.insert(bodies_.end(), static_cast<std::size_t>(size), {std::ssize(bodies_), size});
}

bool ModelCompliance::set(const Vector &coefficients) {
  if (coefficients_.size() == coefficients.size() && coefficients_ == coefficients) return false;
  coefficients_ = coefficients;
  forget();
  return true;
}

void ModelCompliance::make(const std::vector<Index> &dofs, Eigen::Ref<Matrix> columns) {
  columns.setZero();
  for (std::size_t k = 0; k < dofs.size(); ++k) {
    const auto [first, count] = body_of(dofs[k]);
    columns.col(static_cast<Index>(k)).segment(first, count).noalias() =
        of_.terms.middleRows(dofs[k] * size() + first, count) * coefficients_;
  }
}

} // namespace rbvi
