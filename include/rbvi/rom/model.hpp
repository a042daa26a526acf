// The reduced model: immutable data that answers a new parameter on one core.
//
//   sum_q theta^a_q(mu) A_q u + sum_q theta^b_q(mu) B_q^T x = sum_q theta^f_q(mu) F_q
//   sum_q theta^b_q(mu) B_q u <= sum_q theta^g_q(mu) G_q,    x >= 0,  complementary
//
// u: n coefficients of the primal basis (N POD modes, then S supremizers), x: R coefficients of the
// generators of the dual cone. theta comes from empirical interpolation (B.36): a few entries of
// the full operator are re-assembled on their few cells. Of two bodies B and G do not separate:
// they are assembled for each mu on the two contact curves alone, exactly, from the trace of the
// basis. Other full-order data are there for outputs and for reconstruction alone. All fields are
// numbered by the undistributed mesh. Where the scene has a motion, u is what is left beside it.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/core/scene.hpp"

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
  Matrix vertices;                         ///< (cells * (dim + 1)) x dim reference coordinates
  std::vector<Contribution> contributions; ///< ordered by entry
};

/// One operator as sum_q theta_q(mu) (reduced term q), with theta from empirical interpolation.
struct AffineTerms {
  Matrix reduced;       ///< (entries of the reduced operator) x J, see ReducedModel
  Matrix interpolation; ///< J x J, lower triangular with unit diagonal (B.34)
  SampleMesh sample;    ///< J entries
  double error = 0;     ///< e_EIM reached (B.32)
  int size() const { return static_cast<int>(interpolation.rows()); }
};

/// Errors measured by `rbvi verify`, relative, over the validation set; negative: not measured.
struct ValidationErrors {
  int count = 0;
  double u_mean = -1, u_max = -1, lambda_mean = -1, lambda_max = -1;
};

struct ReducedModel {
  std::string scene_name;
  SceneOptions scene_options;
  ParameterSpace parameters;
  std::map<std::string, std::string> settings; ///< tolerances and options that made it
  std::string mesh_fingerprint;

  int modes = 0;       ///< N
  int supremizers = 0; ///< S
  int generators = 0;  ///< R
  int free_modes = 0;  ///< the last of the R: their coefficients take either sign
  /// V_N + S_R(mu) is made for each mu (2.17); the supremizers span S_R(mu) for every mu.
  bool online_enriched = false;
  int primal_size() const { return modes + supremizers; }

  AffineTerms a; ///< reduced: lower triangle of the n x n matrix, column by column, n(n+1)/2 x J
  AffineTerms b; ///< reduced: R x n, column-major, R n x J
  AffineTerms f; ///< n x J; J = 0: no load
  AffineTerms g; ///< R x J

  // The contact nodes: the dual dofs of one body; of two bodies those of the slave curve, then
  // those of the master curve, each by increasing x.
  int slave_nodes = 0;   ///< two bodies: number of nodes of the slave curve; 0: one body
  Matrix dual_basis;     ///< dual dofs x R; entries >= 0 but for hybrid cones
  Matrix contact_trace;  ///< contact nodes x n: primal basis there, of two bodies its vertical part
  Matrix contact_points; ///< contact nodes x dim, reference coordinates
  Matrix lumped_weights; ///< dual dofs x b.size(): integral of each hat function, per term of b
  bool two_bodies() const { return slave_nodes > 0; }

  // Full order, for reconstruction.
  Matrix primal_basis;            ///< dofs x n, fixed dofs included
  Matrix mesh_points;             ///< nodes x dim, reference coordinates
  std::vector<int> mesh_cells;    ///< (dim + 1) node numbers per cell
  std::vector<int> contact_nodes; ///< mesh node of each contact node
  std::vector<int> contact_cells; ///< one body: (dim + 1) contact nodes per cell of the region

  ValidationErrors validation_enriched, validation_decorrelated;
  std::map<std::string, std::vector<double>> histories; ///< "pod/error", "cone/e_orth", ...
  std::map<std::string, double> stage_seconds;
};

inline constexpr int model_schema = 3;

/// Throws failure, naming the member, if sizes do not agree, an index points nowhere or a number is
/// not finite (members that reconstruction alone needs may all be empty).
void check_model(const ReducedModel &model);

/// Throws failure (check_model, H5Writer::commit).
void write_model(const ReducedModel &model, const std::filesystem::path &path);

/// Throws bad_input (see H5Reader), also for a scene or an option that this build does not have, or
/// parameters that are not those of the scene. `with_fields` false leaves out what reconstruction
/// alone needs: primal_basis, mesh_points, mesh_cells, contact_cells.
ReducedModel read_model(const std::filesystem::path &path, bool with_fields = true);

/// The same model with the first n primal columns alone (n = modes: the decorrelated basis) and
/// the first r generators. Errors measured for other sizes are dropped. Throws bad_input for sizes
/// that the model does not have.
ReducedModel leading(const ReducedModel &model, int n, int r);

/// The errors measured for this model: with supremizers if it has any.
const ValidationErrors &expected_errors(const ReducedModel &model);

/// Row `i` of contact_points or mesh_points as a point.
Point point_of(const Matrix &points, Index i);

/// The scene of the model, with its options and the model's free and fixed parameters.
Scene scene_of(const ReducedModel &model);

} // namespace rbvi
