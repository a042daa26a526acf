// The primal basis of a model where single nodes are constrained, and the gap that it leaves there.
#pragma once

#include "rbvi/contact/contact.hpp"
#include "rbvi/rom/model/model.hpp"

namespace rbvi {

class NodalTrace {
public:
  /// `model` must outlive it.
  NodalTrace(const ReducedModel &model, const Contact &contact);
  /// nodal_gap - nodal_b u; infinite at nodes where the model has no displacement.
  Vector gap_left(const ContactOperators &operators, const Vector &u) const;

private:
  const ReducedModel &model_;
  std::vector<Index> dofs_;   ///< contact dofs that nodal_b acts on; empty: all
  Matrix trace_;              ///< the primal basis there
  std::vector<bool> unknown_; ///< of each contact dof; empty: none is
};

} // namespace rbvi
