#include "rbvi/contact/history.hpp"

#include "rbvi/core/error.hpp"

namespace rbvi {

namespace {

/// visit(entry of the history, dual row, normal multiplier) for every tangential row.
template <class Visit> void visit_tangents(const Contact &contact, Visit &&visit) {
  Index entry = 0, first_node = 0;
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i) {
    const DualSpace &dual = contact.interfaces[i]->dual();
    const Index tangents = dual.components - 1, first = contact.first_row[i] + dual.nodes();
    for (Index k = 0; k < dual.nodes() * tangents; ++k, ++entry)
      visit(entry, first + k, first_node + k / tangents);
    first_node += dual.nodes();
  }
}

} // namespace

Index tangential_size(const Contact &contact) {
  return contact.dual_size() - contact.nodes();
}

void check_history(const Contact &contact, const Vector &slip) {
  if (slip.size() != 0 && slip.size() != tangential_size(contact))
    throw bad_input("the history of friction has " + std::to_string(slip.size()) +
                    " values instead of " + std::to_string(tangential_size(contact)) +
                    ": it must be that of a solution on the same mesh");
  if (!slip.allFinite()) throw bad_input("the history of friction is not finite");
}

Vector added_by_history(const Contact &contact, const Vector &slip, const Vector &weights) {
  Vector added = Vector::Zero(contact.dual_size());
  if (slip.size() > 0)
    visit_tangents(contact, [&](Index entry, Index row, Index node) {
      added[row] = weights[node] * slip[entry];
    });
  return added;
}

NodalEvaluation nodal_with_history(const Contact &contact, const FullMu &mu, const Vector &slip,
                                   const Vector &weights) {
  const ContactInterface &nodal = *nodal_interface(contact);
  NodalEvaluation evaluate = nodal.nodal_at(mu);
  if (slip.size() == 0) return evaluate;
  return [evaluate, nodes = nodal.dual().nodes(), added = added_by_history(contact, slip, weights)](
             const Vector &state, const Vector &x, const std::vector<bool> &near,
             NodalCondition &condition) {
    evaluate(state, x, near, condition);
    for (Index node = 0; node < nodes; ++node)
      if (is_wanted(near, node)) condition.w[nodes + node] += added[nodes + node];
  };
}

Vector slip_of(const Contact &contact, const Vector &excess, const Vector &weights,
               const Vector &before) {
  Vector slip = before.size() > 0 ? before : Vector(Vector::Zero(tangential_size(contact)));
  visit_tangents(contact, [&](Index entry, Index row, Index node) {
    if (weights[node] > 0) slip[entry] += excess[row] / weights[node];
  });
  return slip;
}

} // namespace rbvi
