// Contact in front of a reduced body, at one mu: g, B and the condensed operator H = B A^-1 B^T on
// the columns of a nodal dual basis. Where B separates, H is a sum of terms; else B is evaluated on
// the interfaces, and H = B C B^T with the compliance C of the model on the contact dofs.
#pragma once

#include "rbvi/method/compliance.hpp"
#include "rbvi/method/lcp.hpp"
#include "rbvi/model/answer.hpp"
#include "rbvi/model/reduced_body.hpp"

#include <memory>
#include <optional>

namespace rbvi {

class ReducedContact {
public:
  virtual ~ReducedContact() = default;
  /// At mu, and at a state where contact follows one. Sets theta_b or contact of the answer.
  virtual void set(const FullMu &mu, const Vector &state, ReducedAnswer &answer) = 0;
  virtual Matrix b() const = 0; ///< m x n, on the primal basis
  /// B u of any number of displacements.
  virtual Matrix times(const Matrix &u) const = 0;
  /// B u of the displacement under the load of `body` alone.
  virtual Vector times_response_to_load(const BodyAtMu & /*body*/, const Vector &u) const {
    return times(u);
  }
  /// H(:, which), m x which.size().
  virtual Matrix condensed_columns(const std::vector<Index> &which) = 0;
  /// All of H, where it is a multiple of what the model has.
  virtual std::optional<ScaledMatrix> condensed() const { return {}; }
  /// Whether this multiplier faces a partner.
  virtual bool faces(Index) const { return true; }
  /// Sets the displacement of answer.lambda without loads.
  virtual void move(const BodyAtMu &body, ReducedAnswer &answer) const = 0;
  const Vector &g() const { return g_; } ///< m

protected:
  Vector g_;
};

/// Where B is evaluated.
class EvaluatedContact : public ReducedContact {
public:
  /// All must outlive it.
  EvaluatedContact(const ReducedModel &model, const Scene &scene, const Contact &contact,
                   const ReducedBody &body);
  ~EvaluatedContact() override;
  void set(const FullMu &mu, const Vector &state, ReducedAnswer &answer) override;
  Matrix b() const override { return b_ * trace_; }
  Matrix times(const Matrix &u) const override { return b_ * Matrix(trace_ * u); }
  Matrix condensed_columns(const std::vector<Index> &which) override;
  bool faces(Index row) const override { return b_.row(row).norm() > 0; }
  void move(const BodyAtMu &body, ReducedAnswer &answer) const override;

  const SparseMatrix &rows() const { return rows_; } ///< the dual basis transposed
  Compliance &compliance();                          ///< set to mu
  /// C at mu. Whether it is another one than before.
  bool set_compliance(const FullMu &mu);
  /// -A_N^-1 of the forces on CondensedOperator::dofs.
  Vector moved_by(const BodyAtMu &body, const Vector &forces) const;

private:
  class OfModel;
  /// The columns of B that the condensed operator knows. Throws failure where it meets others.
  SparseMatrix known_columns(const SparseMatrix &b) const;

  const ReducedModel &model_;
  const Scene &scene_;
  const Contact &contact_;
  SparseMatrix rows_;
  std::vector<int> place_; ///< of each contact dof in CondensedOperator::dofs; -1: it is not there
  Matrix trace_;           ///< the primal basis at these dofs, without an operator at all
  Matrix unit_loads_;      ///< of a unit force at each of these dofs: ReducedBody::prepared
  std::unique_ptr<OfModel> compliance_; ///< null: the model has none
  SparseMatrix b_;                      ///< m x these dofs
  SparseMatrix usual_b_;  ///< that at the values of all parameters, which may serve all mu
  bool is_usual_ = false; ///< b_ is that: H is then a sum of terms
  Matrix terms_;          ///< these, as those of C; empty: not made yet
};

/// What the model has. All must outlive it.
std::unique_ptr<ReducedContact> reduced_contact(const ReducedModel &model, const Scene &scene,
                                                const Contact &contact, const ReducedBody &body);

} // namespace rbvi
