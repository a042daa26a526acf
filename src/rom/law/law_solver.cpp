#include "rbvi/rom/law/law_solver.hpp"

#include "edge_of_nodes.hpp"
#include "model_compliance.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/local_fit.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/rom/model/affine_coefficients.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace rbvi {

namespace {

constexpr double mended_above = 1e-6; ///< natural residual of a reduced law at all nodes

/// Of another answer that only the sign of the tangent tells of.
constexpr double least_distance = 1e-6;

} // namespace

bool has_several_answers(const ReducedModel &model) {
  return model.histories.contains("self_check/other");
}

LawSolver::LawSolver(const ReducedModel &model, const Scene &scene, const Contact &contact,
                     const QueryOptions &options)
    : model_(model), scene_(scene), contact_(contact), options_(options),
      reduced_(model.law && model.law->reduction == MultiplierReduction::collocated),
      by_rule_(model.law && !reduced_ && !options.warm && has_several_answers(model)),
      reduced_starts_(scene.parameters, model.law ? model.law->starts_mu : Matrix()),
      columns_(laws_of_columns(contact, model.dual_basis)), body_(model, scene), at_mu_(body_) {
  if (!model.law) throw bad_input("the model has no law of contact at nodes");
  options_.looks_for_others = options.looks_for_others || by_rule_;
  samples_ = parts_of_box(scene.parameters, model.law->starts_mu);
  edge_ = edge_of_nodes(contact, model.dual_basis);
  if (model.evaluates_contact()) {
    const std::vector<int> &dofs = model.law->condensed.dofs;
    nodal_ = Matrix(model.dual_basis.transpose()).sparseView();
    trace_ = dofs.empty() ? model.contact_trace : Matrix(model.contact_trace(dofs, Eigen::all));
    unit_loads_ = body_.prepared(trace_.transpose());
    place_.assign(model.contact_trace.rows(), -1);
    for (std::size_t k = 0; k < dofs.size(); ++k)
      place_[dofs[k]] = static_cast<int>(k);
    if (!dofs.empty()) compliance_ = std::make_unique<ModelCompliance>(model.law->condensed);
  }
  if (!follows_state(contact)) return;
  if (reduced_)
    throw bad_input("contact that follows the displacement is reduced to a law at all nodes");
  nodal_is_identity_ = model.dual_basis.isIdentity(0);
  const ContactInterface *nodal = nodal_interface(contact);
  if (nodal != nullptr && nodal_is_identity_) nodal_compliance_.emplace(nodal->averages());
  w_product_ = nodal_ * contact.w_product() * nodal_.transpose();
}

LawSolver::~LawSolver() = default;

SparseMatrix LawSolver::known_columns(const SparseMatrix &b) const {
  if (trace_.rows() == b.cols()) return b;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(b.nonZeros());
  for (Index row = 0; row < b.rows(); ++row)
    for (SparseMatrix::InnerIterator entry(b, row); entry; ++entry) {
      if (entry.value() == 0) continue;
      const int column = place_[entry.col()];
      if (column < 0)
        throw failure("a multiplier of the model meets the other body where no training parameter "
                      "takes it: " +
                      std::string(keeps_more));
      entries.emplace_back(row, column, entry.value());
    }
  SparseMatrix known(b.rows(), trace_.rows());
  known.setFromTriplets(entries.begin(), entries.end());
  return known;
}

void LawSolver::check_edge(const Vector &x) const {
  for (const Index column : edge_)
    if (x[column] != 0)
      throw failure("contact reaches the edge of the nodes that the model has multipliers at: " +
                    std::string(keeps_more));
}

Vector LawSolver::start_at(const Vector &here) const {
  if (options_.warm && last_start_.size() > 0) return last_start_;
  if (samples_.cols() == 0) return {};
  return local_fit(model_.law->starts, samples_, here);
}

Vector LawSolver::term_coefficients(const FullMu &all_parameters, const Vector &theta_b) const {
  const CondensedOperator &condensed = model_.law->condensed;
  const Vector shape = condensed.shape * grid_weights(scene_, condensed.axes, all_parameters);
  if (model_.evaluates_contact()) return shape;
  Vector result(condensed.terms.cols());
  Index at = 0;
  for (Index p = 0; p < theta_b.size(); ++p)
    for (Index q = p; q < theta_b.size(); ++q, at += shape.size())
      result.segment(at, shape.size()) = theta_b[p] * theta_b[q] * shape;
  return result;
}

Vector LawSolver::moved_by(const Vector &reaction) const {
  Vector load = Vector::Zero(unit_loads_.rows());
  for (Index dof = 0; dof < reaction.size(); ++dof)
    if (reaction[dof] != 0) load -= reaction[dof] * unit_loads_.col(dof);
  return at_mu_.response_of_prepared(load);
}

LawAtMu LawSolver::law_at(const FullMu &all_parameters, ReducedAnswer &answer,
                          const Vector &state) {
  const NodalLaw &of_model = *model_.law;
  LawAtMu law;
  if (model_.evaluates_contact()) {
    assemble(contact_, all_parameters, {state}, answer.contact);
    law.b_contact = known_columns(nodal_ * answer.contact.b);
    law.q = nodal_ * answer.contact.g;
  } else {
    answer.theta_b = contact_coefficients(model_.b, Part::b, contact_, scene_, all_parameters);
    law.q = model_.g.reduced *
            contact_coefficients(model_.g, Part::g, contact_, scene_, all_parameters);
  }
  const Vector &theta_b = answer.theta_b;
  if (of_model.condensed.terms.size() > 0) law.terms = term_coefficients(all_parameters, theta_b);
  const bool with_b = reduced_ || model_.f.size() > 0;
  if (with_b && model_.evaluates_contact())
    law.b = law.b_contact * trace_;
  else if (with_b)
    law.b = (model_.b.reduced * theta_b).reshaped(model_.generators, model_.primal_size());
  at_mu_.set(all_parameters);
  if (model_.online_enriched)
    at_mu_.restrict_to(enriched_subspace(
        multiplier_coefficients(of_model.basis).transpose() * law.b, model_.modes));
  law.body = &at_mu_;
  if (model_.f.size() > 0) {
    law.load = at_mu_.half_response(at_mu_.load());
    law.q -= law.b * at_mu_.transposed_half_response(law.load);
  }
  law.laws = rbvi::laws_at(columns_, contact_, all_parameters);
  return law;
}

Matrix LawSolver::condensed_columns(const LawAtMu &law, const std::vector<Index> &which) {
  const Matrix &terms = model_.law->condensed.terms;
  if (compliance_) {
    compliance_->set(law.terms);
    return rbvi::condensed_columns(*compliance_, law.b_contact, which);
  }
  const Index m = model_.generators;
  Matrix result(m, std::ssize(which));
  for (Index k = 0; k < result.cols(); ++k)
    result.col(k).noalias() = terms.middleRows(which[k] * m, m) * law.terms;
  return result;
}

LawSolver::AtAllNodes LawSolver::at_all_nodes(const LawAtMu &law, const Vector &x) {
  std::vector<Index> all(model_.generators);
  std::iota(all.begin(), all.end(), 0);
  const Matrix h = condensed_columns(law, all);
  // A multiplier that faces no partner has no row.
  AtAllNodes result{h * x + law.q, (h.diagonal().array() > 0).select(h.diagonal(), 1), {}};
  result.start = x - result.w.cwiseQuotient(result.diagonal);
  return result;
}

Vector LawSolver::start_of(const FullMu &all_parameters, const Vector &x, const Vector &state) {
  ReducedAnswer answer;
  const LawAtMu law = law_at(all_parameters, answer, state);
  return at_all_nodes(law, x).start;
}

Vector LawSolver::reduced_start(const Vector &here) {
  if (!reduced_) return {};
  if (options_.warm) return last_reduced_;
  return reduced_starts_.nearest(here, [&](Index sample) {
    const Vector mu = model_.law->starts_mu.col(sample);
    ReducedAnswer unused;
    const LawAtMu law = law_at(expand(scene_.parameters, {mu.begin(), mu.end()}), unused);
    return solve_reduced_law(model_.law->basis, law).x;
  });
}

bool LawSolver::answer_reduced_law(const LawAtMu &law, const Vector &start, ReducedAnswer &answer) {
  const MultiplierBasis &basis = model_.law->basis;
  const bool checks = model_.law->condensed.terms.size() > 0;
  const bool mends = model_.law->mended && checks;
  try {
    CollocatedResult reduced = solve_reduced_law(basis, law, start);
    const Matrix functions = multiplier_coefficients(basis);
    answer.lambda = functions * reduced.x;
    if (options_.looks_for_others)
      answer.to_other =
          distance_of_answers(answer.lambda, functions * solve_reduced_law(basis, law).x);
    answer.residual = reduced.residual;
    answer.iterations = reduced.iterations;
    last_reduced_ = std::move(reduced.x);
  } catch (const Error &) {
    if (!mends) throw;
    return false;
  }
  if (!checks) return true;
  AtAllNodes nodes = at_all_nodes(law, answer.lambda);
  answer.energy = 0.5 * (answer.lambda.dot(nodes.w - law.q) - law.load.squaredNorm());
  answer.residual = natural_residual(answer.lambda, nodes.w, nodes.diagonal, law.laws);
  answer.start = std::move(nodes.start);
  return !mends || answer.residual <= mended_above;
}

void LawSolver::solve_at_nodes(const LawAtMu &law, const Vector &here, ReducedAnswer &answer) {
  const auto columns = [&](const std::vector<Index> &which) {
    return condensed_columns(law, which);
  };
  Vector start = answer.start.size() > 0 ? answer.start : start_at(here);
  for (Index i = 0; i < law.b_contact.rows() && start.size() > 0; ++i)
    if (law.b_contact.row(i).norm() == 0) start[i] = std::min(start[i], 0.0); // faces no partner
  FrictionAnswer found = friction_answer(columns, law.q, law.laws, start, by_rule_);
  if (!found.converged || !(found.residual <= largest_residual))
    throw failure("the law of contact and friction is met to " + short_number(found.residual) +
                  " only: " + found.reason);
  if (options_.looks_for_others)
    answer.to_other = distance_to_other_answer(columns, law.q, law.laws, found);
  if (found.has_others) answer.to_other = std::max(answer.to_other, least_distance);
  answer.energy = 0.5 * (found.x.dot(found.w - law.q) - law.load.squaredNorm());
  answer.residual = found.residual;
  answer.iterations += found.iterations;
  answer.lambda = std::move(found.x);
  answer.start = std::move(found.start);
}

ReducedAnswer LawSolver::solve(const FullMu &all_parameters) {
  if (follows_state(contact_)) {
    ReducedAnswer answer = solve_following(all_parameters);
    answer.mu = all_parameters;
    last_start_ = answer.start;
    return answer;
  }
  const Vector here = parts_of_box(scene_.parameters, all_parameters);
  const Vector start = reduced_start(here);
  ReducedAnswer answer;
  answer.mu = all_parameters;
  const LawAtMu law = law_at(all_parameters, answer);
  if (!reduced_ || !answer_reduced_law(law, start, answer)) solve_at_nodes(law, here, answer);
  check_edge(answer.lambda);
  if (model_.evaluates_contact()) {
    answer.reaction = law.b_contact.transpose() * answer.lambda;
    answer.u = moved_by(answer.reaction);
  } else {
    answer.u = -at_mu_.response(answer.theta_b, answer.lambda);
  }
  if (law.load.size() > 0) answer.u += at_mu_.transposed_half_response(law.load);
  if (model_.law->condensed.terms.size() == 0)
    answer.energy = 0.5 * (at_mu_.half_response(law.b.transpose() * answer.lambda).squaredNorm() -
                           law.load.squaredNorm());
  last_start_ = answer.start;
  return answer;
}

} // namespace rbvi
