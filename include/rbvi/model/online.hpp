// The online stage: one parameter in, one checked answer out. Serial and dense. By a method for
// each kind of model: the pair of spaces (model/cone_solver.hpp), the law at the nodes
// (model/law_solver.hpp), Nitsche's method (model/nitsche_solver.hpp).
// Niakh (2022): (3.44), (3.45), Remark 3.3.1.
#pragma once

#include "rbvi/contact/contact.hpp"
#include "rbvi/contact/named_outputs.hpp"
#include "rbvi/core/outputs.hpp"
#include "rbvi/model/cell_outputs.hpp"
#include "rbvi/model/column_laws.hpp"
#include "rbvi/model/cone_solver.hpp"
#include "rbvi/model/law_solver.hpp"
#include "rbvi/model/model.hpp"
#include "rbvi/model/nitsche_solver.hpp"

#include <memory>

namespace rbvi {

static_assert(EIGEN_DEFAULT_ALIGN_BYTES == 64 && alignof(Eigen::Matrix<double, 8, 1>) == 64,
              "include headers of rbvi before those of Eigen, or define EIGEN_MAX_ALIGN_BYTES and "
              "EIGEN_MAX_STATIC_ALIGN_BYTES as 64 in the whole program: both share memory");

/// The primal basis of a model where single nodes are constrained, and the gap that it leaves
/// there.
class NodalTrace {
public:
  /// `model` must outlive it.
  NodalTrace(const ReducedModel &model, const Contact &contact);
  /// The displacement of an answer at the contact dofs that single nodes are constrained at, at
  /// least; zero at the others.
  Vector displacement(const ReducedAnswer &solution) const;
  /// nodal_gap - nodal_b times that; infinite at nodes where the model has no displacement.
  Vector gap_left(const ContactOperators &operators, const Vector &displacement) const;
  /// Throws failure where `gap`, of gap_left, says that bodies meet at a node without multipliers,
  /// in a model whose multipliers are those near contact.
  void check_outside(const ContactOperators &operators, const Vector &gap) const;

private:
  const ReducedModel &model_;
  std::vector<Index> dofs_;   ///< contact dofs that nodal_b acts on; empty: all
  Matrix trace_;              ///< the primal basis there
  std::vector<bool> unknown_; ///< of each contact dof; empty: none is
  /// Where b separates per normal multiplier whether it has a column, else per contact dof whether
  /// some column meets it; empty: all.
  std::vector<bool> held_;
};

/// Answers queries on a model that it does not own. An answer depends on its mu and the model, to
/// round-off, not on the queries before (but QueryOptions::warm).
class OnlineSolver {
public:
  /// Throws bad_input for a method that is not one of the model.
  explicit OnlineSolver(const ReducedModel &model, const QueryOptions &options = {});
  OnlineSolver(const OnlineSolver &) = delete;
  /// With the forms, map and obstacle of `scene` instead of those of the model.
  OnlineSolver(const ReducedModel &model, Scene scene, const QueryOptions &options = {});
  /// `mu`: the free parameters; throws bad_input outside the box unless `extrapolate`, and failure,
  /// saying what to try, where the method has no answer.
  ReducedAnswer solve(const Mu &mu, bool extrapolate = false);
  /// The answer at a mu near that of `from`, the last one of solve(), to first order: its active
  /// sets stay, or Newton's method goes on from it (QueryMethod::near). Throws failure where it
  /// cannot be told.
  ReducedAnswer near(const ReducedAnswer &from, const Mu &mu);
  /// Energy, forces and contact measures of an answer, at a cost that depends on the contact region
  /// alone (min_u is left unset: it needs the full field). Expected errors are set inside the box.
  /// Throws failure (check_finite).
  Outputs outputs(const Mu &mu, const ReducedAnswer &solution) const;
  /// Throws failure where forces of contact do not balance (contact/force_balance.hpp). Costs
  /// integrals over contact.
  void check_forces(const ReducedAnswer &solution) const;
  /// At the dual dofs; of Nitsche's method what stands for it (nitsche_multiplier).
  Vector multiplier(const ReducedAnswer &solution) const;
  /// Gap that is left at the nodes with a constraint (ContactOperators::nodal_gap); infinite where
  /// the model has no displacement (ContactModel::trace_dofs).
  Vector contact_gap(const ReducedAnswer &solution) const;
  /// At all dofs, without the motion of the scene, with the values that boundaries impose. Throws
  /// failure if the model was read without its fields.
  Vector field(const ReducedAnswer &solution) const;
  /// An interface with its pressure, gap, normal and displacement (ContactInterface::fields), NaN
  /// where the model has no displacement.
  Grid contact_grid(const ReducedAnswer &solution, std::size_t interface) const;
  const ReducedModel &model() const { return model_; }
  const Scene &scene() const { return scene_; }
  const Contact &contact() const { return contact_; }

private:
  /// The displacement of an answer at all contact dofs.
  Vector at_contact_dofs(const ReducedAnswer &solution) const;
  /// At the nodes of an interface, the values that boundaries impose among them. `columns`: at the
  /// contact dofs.
  Vector at_interface(const FullMu &mu, const Vector &columns, std::size_t interface) const;
  /// weights, nodal_b and nodal_gap.
  ContactOperators nodal_operators(const ReducedAnswer &solution, const Vector &lambda) const;

  /// `at_vertices`: the displacement at the contact dofs, those of vertices at least.
  void add_outputs_of_scene(const ReducedAnswer &solution, const Vector &lambda,
                            const Vector &at_vertices, Outputs &outputs) const;
  void add_bound(const ReducedAnswer &solution, const Vector &lambda, Outputs &outputs) const;
  ReducedAnswer with_imposed_energy(ReducedAnswer answer) const;
  double imposed_energy_at(const FullMu &mu) const;

  const ReducedModel &model_;
  const Scene scene_; ///< with_imposed_loads
  const Sum imposed_energy_;
  Contact contact_;
  std::unique_ptr<QueryMethod> method_;
  const ReducedNitsche *nitsche_ = nullptr; ///< it, by Nitsche's method
  std::optional<NodalTrace> trace_;         ///< else
  std::optional<ColumnLaws> column_laws_;   ///< where they tell bounds of errors
  SparseMatrix dual_basis_;
  const std::vector<std::string> only_; ///< outputs of the scene
  const CellOutputs cell_outputs_;
  const ContactShares contact_shares_; ///< of reactions
};

/// At all dofs, without the motion of the scene, with the values that boundaries impose.
Vector field_of(const Scene &scene, const ModelFields &fields, const ReducedAnswer &solution);

} // namespace rbvi
