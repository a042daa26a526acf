#include "rbvi/model/law_problem.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/model/free_bodies.hpp"

#include <numeric>

namespace rbvi {

namespace {

const ReducedModel &with_law(const ReducedModel &model) {
  if (!model.contact.law) throw bad_input("the model has no law of contact at nodes");
  return model;
}

} // namespace

Matrix multiplier_coefficients(const MultiplierBasis &basis) {
  const Matrix &a = basis.normal, &b = basis.tangential;
  Matrix result = Matrix::Zero(a.rows() + b.rows(), a.cols() + b.cols());
  result.topLeftCorner(a.rows(), a.cols()) = a;
  result.bottomRightCorner(b.rows(), b.cols()) = b;
  return result;
}

LawProblem::LawProblem(const ReducedModel &model, const Scene &scene, const Contact &contact)
    : model_(with_law(model)), scene_(scene), interfaces_(contact),
      columns_(laws_of_columns(contact, model.contact.dual_basis)),
      edge_(edge_of_nodes(contact, model.contact.dual_basis)), body_(model, scene), at_mu_(body_),
      contact_(reduced_contact(model, scene, contact, body_)) {}

const LawAtMu &LawProblem::at(const FullMu &mu, ReducedAnswer &answer, const Vector &state,
                              const Vector &beta) {
  if (!(answer.motions && mu_ == mu)) {
    mu_.reset(); // until all of it is there
    set(mu, state, answer);
    if (beta.size() > 0) set_springs(answer);
    mu_ = mu;
  }
  if (beta.size() > 0) {
    law_.q = q_ + law_.by_beta * beta;
    law_.load = load_ + springs_ * theta_.cwiseProduct(beta);
    law_.unloaded = unloaded_ + motions_ * theta_.cwiseProduct(beta);
  }
  return law_;
}

void LawProblem::set(const FullMu &mu, const Vector &state, ReducedAnswer &answer) {
  answer.mu = mu;
  contact_->set(mu, state, answer);
  at_mu_.set(mu);
  law_ = {contact_->g(), {}, {}, {}, laws_at(columns_, interfaces_, mu)};
  const MultiplierBasis &functions = model_.contact.law->basis;
  if (functions.normal.size() > 0) law_.b = contact_->b();
  if (model_.body.online_enriched)
    at_mu_.restrict_to(enriched_subspace(multiplier_coefficients(functions).transpose() * law_.b,
                                         model_.body.modes));
  if (at_mu_.has_load()) {
    law_.load = at_mu_.half_response_to_load();
    law_.unloaded = at_mu_.response_to_load();
    law_.q -= contact_->times_response_to_load(at_mu_, law_.unloaded);
  }
  friction_.reset();
}

FrictionSolver &LawProblem::friction() {
  if (friction_) return *friction_;
  if (const std::optional<ScaledMatrix> h = contact_->condensed())
    friction_ = std::make_unique<FrictionSolver>(*h, law_.laws);
  else
    friction_ = std::make_unique<FrictionSolver>(
        [this](const std::vector<Index> &which) { return contact_->condensed_columns(which); },
        law_.laws);
  return *friction_;
}

Vector LawProblem::left(const LawAtMu &law, const Vector &x) {
  std::vector<Index> support;
  for (Index j = 0; j < x.size(); ++j)
    if (x[j] != 0) support.push_back(j);
  return contact_->condensed_columns(support) * x(support) + law.q;
}

void LawProblem::set_springs(ReducedAnswer &answer) {
  motions_ = at_mu_.free_motions();
  answer.motions = free_motions_at(at_mu_, motions_, contact_->times(motions_), law_.laws);
  theta_ = spring_coefficients(model_, scene_, answer.mu);
  law_.by_beta = -answer.motions->held * theta_.asDiagonal();
  springs_ = at_mu_.half_response_to_springs();
  q_ = law_.q;
  load_ = law_.load;
  unloaded_ = law_.unloaded;
}

AtAllNodes LawProblem::at_all_nodes(const LawAtMu &law, const Vector &x) {
  std::vector<Index> all(model_.contact.generators);
  std::iota(all.begin(), all.end(), 0);
  const Matrix h = contact_->condensed_columns(all);
  // A multiplier that faces no partner has no row.
  AtAllNodes result{h * x + law.q, (h.diagonal().array() > 0).select(h.diagonal(), 1), {}};
  result.start = x - result.w.cwiseQuotient(result.diagonal);
  return result;
}

double LawProblem::residual(const LawAtMu &law, const Vector &x, const Vector &w) const {
  const Vector &g = contact_->g();
  return residual_of_laws(law.laws, g, x, w,
                          ((law.q - g).cwiseAbs() + (w - law.q).cwiseAbs()).maxCoeff());
}

void LawProblem::displace(ReducedAnswer &answer) const {
  if (answer.left.size() > 0) {
    answer.residual = residual(law_, answer.lambda, answer.left);
    check_residual(answer.residual, query_residual_limit,
                   ": reduce again with more training parameters");
  }
  for (const Index column : edge_)
    if (answer.lambda[column] != 0) {
      Index row = 0;
      model_.contact.dual_basis.col(column).cwiseAbs().maxCoeff(&row);
      throw failure(said_of(interfaces_, row) +
                    "contact reaches the edge of the nodes that the model has multipliers at: " +
                    std::string(keeps_more));
    }
  contact_->move(at_mu_, answer);
  if (law_.unloaded.size() > 0) answer.u += law_.unloaded;
}

} // namespace rbvi
