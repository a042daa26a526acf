#include "rbvi/model/nodal_trace.hpp"

#include "edge_of_nodes.hpp"
#include "rbvi/core/error.hpp"

#include <algorithm>
#include <limits>

namespace rbvi {

namespace {

/// The contact dofs that constraints at single nodes act on, where they are not all: those of the
/// vertices.
std::vector<Index> nodal_dofs(const Contact &contact) {
  std::vector<Index> dofs;
  for (const auto &interface : contact.interfaces) {
    if (interface->dual().vertices.empty()) return {};
    const InterfaceMesh &mesh = interface->mesh();
    for (const Index node : interface->dual().vertices)
      for (int c = 0; c < mesh.components; ++c)
        if (const int dof = mesh.dofs[node * mesh.components + c]; dof >= 0) dofs.push_back(dof);
  }
  return dofs;
}

/// NodalTrace::held_.
std::vector<bool> held_by(const ReducedModel &model, const Contact &contact) {
  const Vector rows = model.contact.dual_basis.rowwise().lpNorm<Eigen::Infinity>();
  if (!model.contact.law || rows.minCoeff() > 0) return {};
  std::vector<bool> held;
  if (model.evaluates_contact()) {
    held.assign(model.contact_dofs(), false);
    for (const int dof : model.contact.law->condensed.dofs)
      held[dof] = true;
    return held;
  }
  for (std::size_t i = 0; i < contact.interfaces.size(); ++i)
    for (Index node = 0; node < contact.interfaces[i]->dual().nodes(); ++node)
      held.push_back(rows[contact.first_row[i] + node] > 0);
  return held;
}

} // namespace

NodalTrace::NodalTrace(const ReducedModel &model, const Contact &contact)
    : model_(model), held_(held_by(model, contact)) {
  if (model.contact.trace_dofs.empty()) {
    dofs_ = nodal_dofs(contact);
    trace_ = model.contact.trace(dofs_, Eigen::all);
    return;
  }
  dofs_.assign(model.contact.trace_dofs.begin(), model.contact.trace_dofs.end());
  trace_ = model.contact.trace;
  unknown_.assign(model.contact_dofs(), true);
  for (const Index dof : dofs_)
    unknown_[dof] = false;
}

Vector NodalTrace::gap_left(const ContactOperators &operators, const Vector &u) const {
  if (dofs_.empty()) return operators.nodal_gap - operators.nodal_b * (model_.contact.trace * u);
  Vector at_contact = Vector::Zero(model_.contact_dofs());
  at_contact(dofs_) = trace_ * u;
  Vector gap = operators.nodal_gap - operators.nodal_b * at_contact;
  for (Index node = 0; node < gap.size() && !unknown_.empty(); ++node)
    for (SparseMatrix::InnerIterator entry(operators.nodal_b, node); entry; ++entry)
      if (unknown_[entry.col()]) gap[node] = std::numeric_limits<double>::infinity();
  return gap;
}

void NodalTrace::check_outside(const ContactOperators &operators, const Vector &gap) const {
  constexpr double touching = 1e-3; // of the largest gap without displacement
  if (held_.empty()) return;
  const double least = -touching * operators.nodal_gap.cwiseAbs().maxCoeff();
  const auto is_outside = [&](Index node) {
    if (!model_.evaluates_contact()) return !held_[node];
    for (SparseMatrix::InnerIterator entry(operators.nodal_b, node); entry; ++entry)
      if (entry.value() != 0 && !held_[entry.col()]) return true;
    return false;
  };
  for (Index node = 0; node < gap.size(); ++node)
    if (gap[node] < least && is_outside(node))
      throw failure("the bodies meet far from the nodes that the model has multipliers at: " +
                    std::string(keeps_more));
}

} // namespace rbvi
