// The reduced model: immutable data that answers a new parameter on one core.
//
//   sum_q theta^a_q(mu) A_q u + sum_q theta^b_q(mu) B_q^T x = sum_q theta^f_q(mu) F_q
//   sum_q theta^b_q(mu) B_q u <= sum_q theta^g_q(mu) G_q,    x >= 0,  complementary
//
// u: n coefficients of the primal basis (N POD modes, then S supremizers or responses), x: R
// coefficients of the generators of the dual cone. theta is a known function of the scene, or comes
// from empirical interpolation (B.36): a few entries of the full operator are re-assembled on their
// few cells. Where B and G do not separate, they are evaluated for each mu on the contact
// interfaces alone, exactly, from the trace of the basis. Other full-order data are there for
// outputs and for reconstruction alone. All fields are numbered by the undistributed mesh. Where
// the scene has a motion, u is what is left beside it; where boundaries impose values l(mu), which
// are in F and G, u is zero there, and reconstruction adds l.
#pragma once

#include "rbvi/contact/contact.hpp"
#include "rbvi/core/outputs.hpp"
#include "rbvi/core/scene.hpp"
#include "rbvi/element/output_cells.hpp"
#include "rbvi/method/residual.hpp"
#include "rbvi/model/nitsche_model.hpp"
#include "rbvi/model/sparse_grid.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace rbvi {

/// Entries of a full operator sampled on the cells that touch them. Entry k is the sum over its
/// contributions of kernel value `local` of cell `cell`.
struct SampleMesh {
  struct Contribution {
    int entry, cell, local;
  };
  Matrix vertices;                         ///< (cells * corners) x dim reference coordinates
  int corners = 3;                         ///< vertices of each cell or edge
  std::vector<Contribution> contributions; ///< ordered by entry
  /// Of a and f: the term of the scene that each cell is a cell of, or (facet_cell) has a facet of.
  std::vector<int> terms{};
  /// Of f, g and the imposed energy: Cell::imposed_by of each cell, as many numbers for each (-1
  /// behind those of a facet); empty where nothing is imposed on any.
  std::vector<int> imposed_by{};
};

/// One operator as sum_q theta_q(mu) (reduced term q): first the exact terms, whose theta are known
/// functions of the scene, then those of empirical interpolation, J of them.
struct AffineTerms {
  Matrix reduced;                  ///< (entries of the reduced operator) x size(), see ReducedModel
  Matrix interpolation;            ///< J x J, lower triangular with unit diagonal (B.34)
  std::vector<SampleMesh> samples; ///< J entries: on the domain (a, f), on each interface (b, g)
  double error = 0;                ///< e_EIM reached (B.32)
  int exact = 0;                   ///< exact terms
  int size() const { return exact + static_cast<int>(interpolation.rows()); }
};

/// Terms of A that differ on few functions, where what changes with mu lies apart from contact:
/// term q is scales_q A_1 + Q C_q Q^T.
struct StiffnessChange {
  Vector scales; ///< terms
  Matrix range;  ///< Q: n x r; empty: BodyModel::a has a column for every term
  Matrix cores;  ///< lower triangles of the r x r matrices C_q, column by column: r(r+1)/2 x terms
  Index rank() const { return range.cols(); }
};

/// Error of one output over the validation set.
struct OutputError {
  std::string name;                           ///< OutputColumn::name
  double mean = 0, max = 0;                   ///< absolute
  double mean_of_range = 0, max_of_range = 0; ///< over the range of the high-fidelity values
  double mean_of_value = 0, max_of_value = 0; ///< over each value
};

/// Errors measured by `rbvi verify`, relative, over the validation set and the corners and faces of
/// the box (corners_and_faces); negative: not measured.
struct ValidationErrors {
  int count = 0; ///< parameters, those without an answer of the model apart
  double u_mean = -1, u_max = -1, lambda_mean = -1, lambda_max = -1;
  double tangential_mean = -1, tangential_max = -1; ///< with friction; lambda is the normal part
  std::vector<OutputError> outputs{};               ///< in the order of output_columns()
  int unanswered = 0;
};

/// The largest value of a quantity over some queries, and where.
struct Worst {
  double value = 0;
  Mu at{}; ///< free parameters; empty where there was no query
};

/// Queries that `rbvi offline` asked of the model that it had just made, random in its box and at
/// the corners and faces of that.
struct SelfCheck {
  int queries = 0; ///< all; 0: none were asked
  int unanswered = 0;
  Mu unanswered_at{};      ///< the first one without an answer; empty where there is none
  std::string reason = ""; ///< why there was none
  /// kkt_residual, max_penetration, and friction_violation over the peak pressure of all queries.
  Worst residual{}, penetration{}, friction{};
  int at_boundary = 0; ///< of the queries, at corners and faces
  double scale = 0;    ///< the largest component of the displacement of the contact region
  /// All were answered, with residuals of round-off.
  bool answered() const { return unanswered == 0 && residual.value <= residual_limit; }
  /// Bodies do not penetrate, and friction is bounded, but for what a law on weighted gaps and
  /// tractions leaves between nodes: a few parts in a thousand of these scales.
  bool admissible() const { return penetration.value <= 2e-2 * scale && friction.value <= 2e-2; }
  bool clean() const { return answered() && admissible(); }
};

/// H = B A^-1 B^T on the columns of the dual basis (m of them), term by term:
/// H(mu) = sum over t of coefficient_t(mu) terms_t, over the common coefficient of a. The terms
/// come in blocks, one for each pair of terms p <= q of b, of J terms each: coefficient = theta_p
/// theta_q (shape w)_j, w the functions of the grid at mu. Where b does not separate, the terms are
/// those of E^T A^-1 E on the contact dofs that the dual basis meets (m of them), in one block, and
/// H = B (sum of terms) B^T.
struct CondensedOperator {
  SparseGrid grid;       ///< over the free parameters of a over its common coefficient
  Matrix shape;          ///< J x grid points
  Matrix terms;          ///< m^2 x (blocks * J): symmetric matrices, column by column
  std::vector<int> dofs; ///< where b does not separate: these contact dofs, rising
  double error = 0;      ///< of the interpolation: what further points would add, relative
};

/// What the multipliers are combined from.
enum class MultiplierReduction {
  automatic,  ///< condensed where every interface keeps its nodes (ContactRecipe), else cone
  cone,       ///< a cone, stable with supremizers; without friction
  condensed,  ///< every node: the law of contact and friction is exact, the body is reduced
  collocated, ///< a cone for lambda_n, modes for lambda_tau, the bound at collocation nodes (3.54)
  none        ///< Nitsche's method has no multipliers
};

/// The functions of MultiplierReduction::collocated by their coefficients in the nodal dual basis:
/// k nodes, t of them of interfaces with friction.
struct MultiplierBasis {
  Matrix normal;          ///< k x R, a cone
  Matrix tangential;      ///< t x S, modes
  std::vector<int> nodes; ///< the collocation nodes
};

/// Where B^n and B^tau, the rows of lambda_n and those of lambda_tau, are interpolated apart.
struct TermsApart {
  int normal =
      0; ///< the first so many terms of b are B^n's, the others B^tau's; 0: all are of both
  double normal_error = 0, tangential_error = 0; ///< e_EIM reached of each (3.61)
};

/// The law of contact and friction at every node, or on functions of the nodes. The dual basis of
/// the model is nodal: a column for every node of the interfaces, or pair of mirror images; with
/// MultiplierReduction::condensed of those near contact alone.
struct NodalLaw {
  int normal = 0; ///< columns of the dual basis for lambda_n; the rest are for lambda_tau
  MultiplierReduction reduction = MultiplierReduction::condensed; ///< neither of the first two
  MultiplierBasis basis;       ///< empty where reduction is condensed
  CondensedOperator condensed; ///< without terms: collocated, and no check at all nodes
  bool mended = true; ///< answers of a reduced law that fail at some node are mended by exact steps
  TermsApart apart;
  Matrix starts;    ///< m x P: FrictionResult::start of the training samples (without the condensed
                    ///< operator their multipliers), where a query starts from
  Matrix starts_mu; ///< free parameters x P: where they are
  Matrix states;    ///< contact dofs x P: their displacements, where contact follows them; or empty
  /// On functions of the nodes, not at every node.
  bool on_functions() const { return basis.normal.size() > 0; }
};

/// A contact interface of the model.
struct InterfaceModel {
  InterfaceMesh mesh;
  std::vector<int> nodes; ///< numbers of its nodes in the whole mesh
};

/// The body on its reduced space of n = modes + supremizers functions.
struct BodyModel {
  int modes = 0;       ///< N
  int supremizers = 0; ///< S, or (condensed) the responses that join the modes
  /// V_N + S_R(mu) is made for each mu (2.17); the supremizers span S_R(mu) for every mu.
  bool online_enriched = false;
  /// reduced: lower triangle of the n x n matrix, column by column, n(n+1)/2 x terms; of A_1 alone
  /// where the terms are in a_change.
  AffineTerms a;
  StiffnessChange a_change;
  AffineTerms f; ///< n x terms; none: no load
  /// Of bodies that contact alone holds (model/free_bodies.hpp), k motions; none: empty. V^T
  /// springs, n x k; the term of Scene::a that has each; springs^T u of the training samples, k x
  /// samples.
  Matrix springs;
  std::vector<int> spring_terms;
  Matrix motions;
  AffineTerms imposed_energy; ///< 1 x terms, of imposed displacements; none: there are none
};

/// Contact on R generators, by Nitsche's method on none.
struct ContactModel {
  int generators = 0; ///< R
  int free_modes = 0; ///< the last of the R: their coefficients take either sign
  AffineTerms b;      ///< reduced: R x n, column-major, R n x J; of a support see TermsApart
  AffineTerms g;      ///< R x J; none: ReducedModel::evaluates_gap
  std::vector<InterfaceModel> interfaces;
  Matrix dual_basis; ///< dual dofs x R; entries >= 0 but for hybrid cones
  /// The primal basis at the contact dofs, k x n. In a large pair of spaces at `trace_dofs` alone,
  /// those of the nodes over which contact moves and of two layers around them: elsewhere gaps are
  /// not known.
  Matrix trace;
  std::vector<int> trace_dofs; ///< contact dof of each row, rising; empty: all of them
  /// Of a pair of spaces, R x samples: its own answers at the training parameters, zero where it
  /// has none; queries start from their active sets. Empty: found when they are first asked for.
  Matrix starts;
  std::optional<NodalLaw> law;
  std::optional<NitscheModel> nitsche;
  /// Without: R = 0, and b and g have no terms.
  bool has_multipliers() const { return !nitsche; }
};

/// Of full order, for reconstruction; may stay in a file of their own, which may be large.
struct ModelFields {
  std::string key;             ///< of that file, where they are not here
  Matrix basis;                ///< dofs x n, fixed dofs included
  Matrix points;               ///< of the mesh: nodes x dim, reference coordinates
  std::vector<int> cells;      ///< node numbers of each cell, nodes_per_cell of them
  std::vector<int> materials;  ///< of each cell (Scene::materials); empty: the first
  std::vector<int> imposed_by; ///< Cell::imposed_by of each dof; empty where nothing is imposed
};

/// What named outputs apart from contact are taken from; empty without any.
struct OutputModel {
  OutputCells cells;
  Matrix basis; ///< the primal basis at cells.nodes: (nodes * components) x n
};

/// Norms of residuals in A(mu_j)^-1 at one reference parameter mu_j, exact: each block has a column
/// for a part of the residual, in coordinates that are orthonormal there. Those of a block come
/// before what the blocks after it add, so that it has zeros behind its rows.
struct CertificateReference {
  Vector theta;      ///< of the terms of A at mu_j
  Matrix of_basis;   ///< (terms * n) columns: A_q times the primal basis, term by term
  Matrix of_lifting; ///< (terms * m) columns: A_q times the lifting functions
  Matrix of_contact; ///< a unit force at each of CertificateModel::dofs
  Matrix of_loads;   ///< rank x terms of F
};

/// What bounds of errors are made of (model/certificate.hpp); without references there are none,
/// unless the law tells them.
struct CertificateModel {
  /// Multipliers are those of the whole body: mu only scales A, G is evaluated, and the condensed
  /// operator is exact and known at every node. Nothing more is needed than A_1^-1 F and what the
  /// basis leaves of it, in coordinates that are orthonormal in A_1 (A = common coefficient times
  /// A_1): terms of F x terms of F.
  bool by_law = false;
  Matrix of_loads, left_of_loads;
  std::vector<CertificateReference> references;
  std::vector<int> dofs; ///< contact dofs that multipliers push, rising
  std::vector<int> own; ///< of each dual dof the function that lifts its gap or slip, -1: none does
  Matrix lifting_trace; ///< contact dofs x m: the lifting functions
  bool exists() const { return by_law || !references.empty(); }
};

/// How a model was made, and what was found out about it.
struct ModelHistory {
  std::map<std::string, std::string> settings; ///< tolerances and options that made it
  std::string mesh_fingerprint;
  ValidationErrors validation_enriched, validation_decorrelated;
  Matrix validated_mu; ///< free parameters x P, where these were measured
  SelfCheck self_check;
  Matrix trained_mu; ///< free parameters x samples
  Matrix failed_mu;  ///< free parameters x samples that have no high-fidelity answer
  std::map<std::string, std::vector<double>> histories; ///< "pod/error", "cone/e_orth", ...
  std::map<std::string, double> stage_seconds;
};

struct ReducedModel {
  /// Read from a file, what its tree says (scene/stored_scene.hpp). Its parameters are those of the
  /// model, free and fixed.
  Scene scene;
  BodyModel body;
  ContactModel contact;
  OutputModel outputs;
  CertificateModel certificate;
  ModelFields fields;
  ModelHistory made;

  int primal_size() const { return body.modes + body.supremizers; }
  Index contact_dofs() const { return contact.interfaces.front().mesh.columns; } ///< k
  bool has_multipliers() const { return contact.has_multipliers(); }
  /// B and G do not separate: they are evaluated for each mu on the interfaces.
  bool evaluates_contact() const { return contact.b.size() == 0 && has_multipliers(); }
  /// G is evaluated likewise, beside B or alone.
  bool evaluates_gap() const { return contact.g.size() == 0 && has_multipliers(); }
};

inline constexpr int model_schema = 26;

/// Throws failure, naming the member, if sizes do not agree, an index points nowhere or a number is
/// not finite (fields may all be empty).
void check_model(const ReducedModel &model);

/// The fields are in a file of their own beside the model: model.h5 -> model.fields.h5. It is as
/// large as the mesh; the model is not.
std::filesystem::path fields_file(const std::filesystem::path &model);

/// Writes both files; that of the fields first, and only where it holds others or is not there, and
/// not for a model without fields. Throws failure (check_model, H5Writer::commit).
void write_model(const ReducedModel &model, const std::filesystem::path &path);

/// Of model.h5, or of an image (model/model_image.hpp). Throws bad_input (see H5Reader), also for a
/// program's scene that the registry does not have, or has in another version, for parameters that
/// are not those of the scene, and where the fields are asked for and are not there or another
/// model's. `with_fields` false leaves them out.
ReducedModel read_model(const std::filesystem::path &path, const Registry &registry,
                        bool with_fields = true);

/// The model with the first n primal columns alone (n = modes: the decorrelated basis) and
/// the first r generators. Errors measured for other sizes are dropped. Throws bad_input for sizes
/// that the model does not have.
ReducedModel leading(const ReducedModel &model, int n, int r);
/// The model on the functions V C, C n x k, `modes` of them modes; without its fields.
ReducedModel rebased(const ReducedModel &model, const Matrix &c, int modes);

/// theta of the springs of each free motion.
Vector spring_coefficients(const ReducedModel &model, const Scene &scene, const FullMu &mu);

/// The errors measured for this model: with supremizers if it has any. `count` 0: nobody measured
/// them.
const ValidationErrors &expected_errors(const ReducedModel &model);

/// The largest absolute error that was measured of each of its outputs; residuals and the like have
/// none.
ErrorOfOutput errors_of_outputs(const ReducedModel &model);

/// Row `i` of points as a point.
Point point_of(const Matrix &points, Index i);

/// The interfaces of the model. `scene` must outlive them. Throws bad_input where they do not fit.
Contact contact_of(const ReducedModel &model, const Scene &scene);

/// A scene with the name, the box and the fixed values of another; ranges of validity are its own.
/// Throws bad_input where the parameters are others or the box leaves these ranges.
Scene in_box_of(const Scene &stored, Scene scene);

} // namespace rbvi
