// From snapshots to a reduced model: POD, cone, supremizers, separation, projection.
// Niakh (2022): (2.20).
#pragma once

#include "rbvi/model/answer.hpp"
#include "rbvi/model/model.hpp"
#include "rbvi/mor/affine.hpp"
#include "rbvi/mor/collocation.hpp"
#include "rbvi/mor/condensed.hpp"
#include "rbvi/mor/cones.hpp"
#include "rbvi/mor/nitsche_quadrature.hpp"
#include "rbvi/mor/pod.hpp"
#include "rbvi/mor/stability.hpp"
#include "rbvi/par/stage.hpp"
#include "rbvi/sweep/sweep.hpp"

namespace rbvi {

/// Functions that the multipliers of contact with friction are combined from (Niakh 2022, 3.3.2),
/// in coefficients of the nodal dual basis: m of them, k for lambda_n and the rest for lambda_tau,
/// of the interfaces with friction alone. Niakh (2022): (3.36)-(3.38).
struct MultiplierOptions {
  MultiplierReduction reduction = MultiplierReduction::automatic;
  double tangential = 1e-4; ///< collocated: tolerance of POD of lambda_tau
  bool exact = true;        ///< collocated: NodalLaw::mended
};

struct MultiplierBases {
  MultiplierBasis basis;
  ConeHistory normal;
  std::vector<double> tangential; ///< error of POD with 0, 1, ... modes, as (3.60c)
};

/// The functions of `basis` at all dual dofs, those of lambda_n first: dual dofs x (R + S).
/// `nodal`: the nodal dual basis, whose coefficients they are.
Matrix multiplier_functions(const Matrix &nodal, const MultiplierBasis &basis);

/// What is added to the modes.
enum class Enrichment {
  decorrelated, ///< nothing: V_N
  online,       ///< S_R(mu), made for each query (2.17); the model holds the span of all S_R(mu)
  offline,      ///< the supremizers of the projected greedy (2.30)
};

/// The product in which supremizers represent b(mu; ., eta).
enum class SupremizerProduct {
  v,     ///< the V product: beta and sigma are those of the theory
  energy ///< a(reference; ., .): the response of u to eta, exact where A does not vary
};

/// Their names, in order.
const std::vector<std::string> &enrichment_names();
const std::vector<std::string> &product_names();

struct ReduceOptions {
  PodOptions pod;
  ConeOptions cone;
  PgaOptions pga;
  bool infsup_tolerance = false; ///< the tolerance of pga is infsup_tolerance() of the training set
  EimOptions eim;
  /// MultiplierReduction::collocated: tolerances of B^n and of B^tau, where not that of eim.
  std::optional<double> eim_normal, eim_tangential;
  CondensedOptions condensed; ///< the law at nodes
  MultiplierOptions multipliers;
  GcnsOptions gcns;
  CurveOptions curve; ///< Nitsche's method
  Enrichment enrichment = Enrichment::offline;
  SupremizerProduct product = SupremizerProduct::v;
  OnlineMethod online_method = OnlineMethod::exact; ///< of the queries of the model
  bool certify = false; ///< the model keeps what bounds of its errors are made of
  Mu reference; ///< free parameters of the a of energy and of the hybrid cone; empty: box_centre
};

/// A basis pair and how it was found.
struct ReducedBases {
  Pod pod; ///< basis: N modes, then the S supremizers or responses, V-orthonormal
  Cone cone;
  Pga pga;
  Matrix nodal_dual; ///< the law at nodes: the nodal dual basis; cone is empty
  Index dropped = 0; ///< columns of it that are too far from contact to be kept
  CondensedOperator condensed;
  MultiplierReduction reduction = MultiplierReduction::condensed;
  bool mended = true; ///< NodalLaw::mended
  MultiplierBases multipliers;
  int modes = 0;       ///< N
  int supremizers = 0; ///< S
  int responses = 0;   ///< the law at nodes: S functions of `condense` in their place
  /// The law at nodes: the loads of which responses follow, once there are answers of the law.
  std::optional<CondensedLoads> awaiting;
  /// What of displacements those may leave, relative, where fields are large; else 0.
  double left_by_answers = 0;
  int factorisations = 0; ///< of A, for the condensed operator
  bool online_enriched = false;
  double infsup_tolerance = 0; ///< of the greedy, where ReduceOptions asks for it
};

/// Throws bad_input for reductions of the multipliers that a load of the scene, its law of
/// friction, its B or the type of the cones does not allow.
void check_reduction(const Scene &scene, const ReduceOptions &options);

/// All of the offline stage behind the snapshots. The model is complete on every rank, but for its
/// settings, validation errors and stage times, and for the self-check, which rank 0 has.
struct Reduction {
  AffineOperators affine;
  ReducedBases bases;
  ReducedModel model;
  int ring = 0;            ///< layers of nodes of a hybrid cone, ReduceOptions::cone.ring or more
  Gcns collocation;        ///< of MultiplierReduction::collocated
  CurveReport curve;       ///< of Nitsche's method
  std::string no_bounds{}; ///< why answers have no bounds where they are wanted

  StageTable stages; ///< reduction_stages(), timed
};

/// Collective. `problem`: on all ranks. Throws failure where there is no sample, or no contact in
/// any; bad_input for options that do not fit the scene.
Reduction reduce(Problem &problem, const std::vector<Sample> &samples,
                 const ReduceOptions &options);

/// The middle of the box. Free parameters.
Mu box_centre(const ParameterSpace &space);

/// Whether every corner of the box of the free parameters is a training point.
bool holds_corners(const ParameterSpace &space, const std::vector<Mu> &training);

/// POD of the displacements. Collective.
void add_modes(Problem &problem, const std::vector<Sample> &samples, const PodOptions &options,
               ReducedBases &bases);

/// Multipliers as columns. Throws failure where there is no sample, or no contact in any.
Matrix multipliers_of(const std::vector<Sample> &samples);

/// Collective. Projects the separated operators onto the bases. The model is complete on every
/// rank, but for its settings, validation errors and stage times.
ReducedModel project(Problem &problem, const std::vector<Sample> &samples,
                     const AffineOperators &affine, const ReducedBases &bases);

/// Collective. Fills the parts of a model that describe the mesh and the contact interfaces.
void describe_mesh(const Problem &problem, ReducedModel &model);

/// T(mu) X in coordinates for every mu of the set (n_c x columns of X each). Not collective.
std::vector<Matrix> supremizers_at(Problem &problem, const RieszSpace &riesz, const Matrix &x,
                                   const std::vector<ContactPoint> &set);

namespace stage {
inline constexpr StageName interpolation("interpolation"), pod("POD"), condensation("condensation"),
    cone("cone"), multipliers("multipliers"), riesz("Riesz representers"),
    infsup_tolerance("inf-sup tolerance"), pga("PGA"), contact_curve("contact curve"),
    collocation("collocation nodes"), projection("projection"), bounds("bounds of errors"),
    self_check("self-check");
} // namespace stage

/// One row per stage. `made` null: the plan, in which what hangs on the separation of the operators
/// is said as a condition; else what was done, without the seconds.
StageTable reduction_stages(const Scene &scene, const ReduceOptions &options,
                            const Reduction *made = nullptr);

} // namespace rbvi
