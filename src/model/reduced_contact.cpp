#include "rbvi/model/reduced_contact.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/model/affine_coefficients.hpp"
#include "rbvi/model/column_laws.hpp"
#include "rbvi/model/packed.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// The coefficient of each term of one block of the condensed operator.
Vector block_coefficients(const CondensedOperator &condensed, const Scene &scene,
                          const FullMu &mu) {
  return condensed.shape * grid_functions(scene, condensed.grid, mu) /
         common_coefficient(scene.a, scene.parameters, mu);
}

/// Columns of a sum of m x m matrices, each of which is a column of `terms`.
Matrix columns_of_sum(const Matrix &terms, const Vector &coefficients,
                      const std::vector<Index> &which) {
  const Index m = std::lround(std::sqrt(static_cast<double>(terms.rows())));
  Matrix result(m, std::ssize(which));
  for (Index k = 0; k < result.cols(); ++k)
    result.col(k).noalias() = terms.middleRows(which[k] * m, m) * coefficients;
  return result;
}

/// The dual basis transposed.
SparseMatrix rows_of(const ReducedModel &model) {
  return Matrix(model.contact.dual_basis.transpose()).sparseView();
}

class SeparatedContact : public ReducedContact {
public:
  SeparatedContact(const ReducedModel &model, const Scene &scene, const Contact &contact,
                   const ReducedBody &body)
      : model_(model), scene_(scene), contact_(contact), rows_(rows_of(model)) {
    if (body.unit_responses().size() == 0) return;
    for (Index p = 0; p < model.contact.b.size(); ++p)
      of_unit_responses_.push_back(term(p) * body.unit_responses());
  }

  void set(const FullMu &mu, const Vector &, ReducedAnswer &answer) override {
    theta_ = contact_coefficients(model_.contact.b, Part::b, contact_, scene_, mu);
    set_gap(mu, answer);
    answer.theta_b = theta_;
    const CondensedOperator &condensed = model_.contact.law->condensed;
    coefficients_.resize(condensed.terms.cols());
    if (coefficients_.size() == 0) return;
    const Vector of_block = block_coefficients(condensed, scene_, mu);
    Index at = 0;
    for (Index p = 0; p < theta_.size(); ++p)
      for (Index q = p; q < theta_.size(); ++q, at += of_block.size())
        coefficients_.segment(at, of_block.size()) = theta_[p] * theta_[q] * of_block;
  }

  Matrix b() const override {
    return (model_.contact.b.reduced * theta_)
        .reshaped(model_.contact.generators, model_.primal_size());
  }

  Matrix times(const Matrix &u) const override {
    Matrix result = Matrix::Zero(model_.contact.generators, u.cols());
    for (Index p = 0; p < theta_.size(); ++p)
      result.noalias() += theta_[p] * (term(p) * u);
    return result;
  }

  Vector times_response_to_load(const BodyAtMu &body, const Vector &u) const override {
    const Vector shares = body.load_shares();
    if (shares.size() == 0) return times(u);
    Vector result = Vector::Zero(model_.contact.generators);
    for (Index p = 0; p < theta_.size(); ++p)
      result.noalias() += theta_[p] * (of_unit_responses_[p] * shares);
    return result;
  }

  std::optional<ScaledMatrix> condensed() const override {
    const Matrix &terms = model_.contact.law->condensed.terms;
    const Index m = model_.contact.generators;
    if (terms.cols() != 1) return {};
    return ScaledMatrix{{terms.data(), m, m}, coefficients_[0]};
  }

  Matrix condensed_columns(const std::vector<Index> &which) override {
    return columns_of_sum(model_.contact.law->condensed.terms, coefficients_, which);
  }

  void move(const BodyAtMu &body, ReducedAnswer &answer) const override {
    answer.u = -body.response(theta_, answer.lambda);
  }

private:
  /// Term p of B, m x n.
  Eigen::Map<const Matrix> term(Index p) const {
    return {model_.contact.b.reduced.col(p).data(), model_.contact.generators,
            model_.primal_size()};
  }
  void set_gap(const FullMu &mu, ReducedAnswer &answer) {
    if (model_.evaluates_gap()) {
      assemble_gaps(contact_, mu, answer.contact);
      g_ = rows_ * answer.contact.g;
    } else {
      g_ = model_.contact.g.reduced *
           contact_coefficients(model_.contact.g, Part::g, contact_, scene_, mu);
    }
  }

  const ReducedModel &model_;
  const Scene &scene_;
  const Contact &contact_;
  const SparseMatrix rows_;
  std::vector<Matrix> of_unit_responses_; ///< B_p ReducedBody::unit_responses(), where there are
  Vector theta_, coefficients_;
};

} // namespace

/// The sum of the model's terms. A column of one body is zero on the others.
class EvaluatedContact::OfModel : public Compliance {
public:
  explicit OfModel(const CondensedOperator &of)
      : Compliance(std::lround(std::sqrt(static_cast<double>(of.terms.rows())))), of_(of) {
    for (const Index size : diagonal_blocks(of.terms))
      bodies_.insert(bodies_.end(), static_cast<std::size_t>(size), {std::ssize(bodies_), size});
  }
  bool set(Vector coefficients) {
    if (coefficients_.size() == coefficients.size() && coefficients_ == coefficients) return false;
    coefficients_ = std::move(coefficients);
    forget();
    return true;
  }
  Range body_of(Index dof) const override { return bodies_[dof]; }
  const Vector &coefficients() const { return coefficients_; }
  /// B of each term B^T, as columns.
  Matrix condensed(const SparseMatrix &b) const {
    Matrix result(b.rows() * b.rows(), of_.terms.cols());
    for (Index k = 0; k < result.cols(); ++k) {
      const Matrix moved = b * Eigen::Map<const Matrix>(of_.terms.col(k).data(), size(), size());
      result.col(k) = (b * Matrix(moved.transpose())).reshaped();
    }
    return result;
  }

private:
  void make(const std::vector<Index> &dofs, Eigen::Ref<Matrix> columns) override {
    columns.setZero();
    for (std::size_t k = 0; k < dofs.size(); ++k) {
      const auto [first, count] = body_of(dofs[k]);
      columns.col(static_cast<Index>(k)).segment(first, count).noalias() =
          of_.terms.middleRows(dofs[k] * size() + first, count) * coefficients_;
    }
  }

  const CondensedOperator &of_;
  Vector coefficients_;
  std::vector<Range> bodies_; ///< per dof
};

EvaluatedContact::EvaluatedContact(const ReducedModel &model, const Scene &scene,
                                   const Contact &contact, const ReducedBody &body)
    : model_(model), scene_(scene), contact_(contact), rows_(rows_of(model)),
      place_(model.contact.trace.rows(), -1) {
  const std::vector<int> &dofs = model.contact.law->condensed.dofs;
  trace_ = dofs.empty() ? model.contact.trace : Matrix(model.contact.trace(dofs, Eigen::all));
  unit_loads_ = body.prepared(trace_.transpose());
  for (std::size_t k = 0; k < dofs.size(); ++k)
    place_[dofs[k]] = static_cast<int>(k);
  if (dofs.empty()) return;
  compliance_ = std::make_unique<OfModel>(model.contact.law->condensed);
  FullMu usual;
  for (const Parameter &parameter : scene.parameters.all)
    usual.push_back(parameter.value);
  try {
    ContactOperators at_rest;
    assemble(contact, usual, {}, at_rest);
    usual_b_ = known_columns(rows_ * at_rest.b);
  } catch (const Error &) { // bodies that do not face each other there
  }
}

EvaluatedContact::~EvaluatedContact() = default;

Compliance &EvaluatedContact::compliance() {
  return *compliance_;
}

bool EvaluatedContact::set_compliance(const FullMu &mu) {
  return compliance_ &&
         compliance_->set(block_coefficients(model_.contact.law->condensed, scene_, mu));
}

void EvaluatedContact::set(const FullMu &mu, const Vector &state, ReducedAnswer &answer) {
  assemble(contact_, mu, {state}, answer.contact);
  b_ = known_columns(rows_ * answer.contact.b);
  is_usual_ = usual_b_.rows() > 0 && (b_ - usual_b_).norm() == 0;
  if (is_usual_ && terms_.size() == 0) terms_ = compliance_->condensed(usual_b_);
  g_ = rows_ * answer.contact.g;
  set_compliance(mu);
}

SparseMatrix EvaluatedContact::known_columns(const SparseMatrix &b) const {
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

Matrix EvaluatedContact::condensed_columns(const std::vector<Index> &which) {
  if (is_usual_) return columns_of_sum(terms_, compliance_->coefficients(), which);
  return rbvi::condensed_columns(*compliance_, b_, which);
}

Vector EvaluatedContact::moved_by(const BodyAtMu &body, const Vector &forces) const {
  Vector load = Vector::Zero(unit_loads_.rows());
  for (Index dof = 0; dof < forces.size(); ++dof)
    if (forces[dof] != 0) load -= forces[dof] * unit_loads_.col(dof);
  return body.response_of_prepared(load);
}

void EvaluatedContact::move(const BodyAtMu &body, ReducedAnswer &answer) const {
  answer.reaction = b_.transpose() * answer.lambda;
  answer.u = moved_by(body, answer.reaction);
  if (compliance_)
    answer.beyond_basis = compliance_->displaced_by(answer.reaction) - trace_ * answer.u;
}

std::unique_ptr<ReducedContact> reduced_contact(const ReducedModel &model, const Scene &scene,
                                                const Contact &contact, const ReducedBody &body) {
  if (model.evaluates_contact())
    return std::make_unique<EvaluatedContact>(model, scene, contact, body);
  return std::make_unique<SeparatedContact>(model, scene, contact, body);
}

} // namespace rbvi
