// Inf-sup constants and supremizers, in coordinates in which the V product is Euclidean.
//
// The contact forms touch n_c displacement dofs only, so every Riesz representer
// T(mu) eta = V^-1 E B_c(mu)^T eta lies in the range of V^-1 E, E the n_c unit columns of those
// dofs. With Z = E^T V^-1 E = L L^T one block of n_c solves serves all mu:
//   T(mu) eta      has coordinates  [ L^T B_c(mu)^T eta ; 0 ]  in R^(n_c + N)
//   a mode v_n     has coordinates  [ L^-1 E^T v_n ; K^T ],
//                  K K^T = I - P^T P,  P = L^-1 E^T V_N
//   b(mu; v, eta)  = eta^T B_c(mu) L y  for v with coordinates [ y ; z ].
// Constants are over the span of the dual basis, a lower bound for the cone's (Niakh 2022, 2.3),
// which cases/reduced_pairs.py has.
// Niakh (2022): (2.15), (2.16), (2.19), (2.25), (2.26), (A.16)-(A.20), Proposition 2.3.1.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/fem/trace.hpp"
#include "rbvi/mor/orthonormal.hpp"
#include "rbvi/mor/pod.hpp"
#include "rbvi/solve/response_solver.hpp"

#include <memory>
#include <string>
#include <vector>

namespace rbvi {

/// The map between displacement fields and Euclidean coordinates above, for all contact dofs or for
/// those that b couples with the multipliers at hand; or, where b depends on mu by a factor alone,
/// for the loads B^T X of these multipliers, which are fewer: F in place of E. Dense parts
/// on every rank.
struct RieszSpace {
  Matrix factor;           ///< L, lower triangular: n_c x n_c, or as many as loads
  std::vector<Index> dofs; ///< the n_c contact dofs of the scene that it covers; empty: all
  Matrix loads;            ///< F: n_c x columns of X; empty: the identity
  Trace trace;             ///< onto these dofs
  std::shared_ptr<ResponseSolver> solver;
};

/// Collective. One factorisation of `product` (KSP prefix -v_), n_c solves shared among the ranks.
/// `dofs`: contact dofs to cover, empty: all. `loads`: on them; they are left out, and cost
/// nothing, where they are not fewer or depend on each other. Throws failure if the factorisation
/// fails.
RieszSpace make_riesz_space(Mat product, const Trace &trace, const std::vector<Index> &dofs = {},
                            const Matrix &loads = {});

/// Appends V^-1 E representers to a basis as append_orthonormalised(): one solve per column.
/// Collective.
std::vector<int> append_representers(const RieszSpace &space, const Matrix &representers,
                                     LinearBasis &basis, double tolerance);

/// Collective. Coordinates of the basis columns: (n_c + N) x N, orthonormal. Throws failure if the
/// basis is not orthonormal in the product of `space`.
Matrix mode_coordinates(const RieszSpace &space, const LinearBasis &modes);

/// Columns orthonormal in W that span the columns of `generators`, without those of which
/// `tolerance` of their norm is left beside those before them: dual dofs x rank.
Matrix orthonormal_dual_basis(const Matrix &generators, const SparseMatrix &w_product,
                              double tolerance = 1e-9);

/// L^T B_c(mu)^T X: n_c x columns of X, the coordinates of T(mu) X. `b_contact`: dual x all contact
/// dofs; X must not couple with those that `space` leaves out. Of loads: throws failure unless
/// B_c(mu)^T X is a multiple of them.
Matrix supremizer_coordinates(const RieszSpace &space, const SparseMatrix &b_contact,
                              const Matrix &x);

/// Smallest singular value of b between the orthonormal columns of `primal` ((n_c + N) x k
/// coordinates) and an orthonormal dual basis X, given T = supremizer_coordinates(X). 0 if k is
/// smaller than the number of columns of X.
double infsup_constant(const Matrix &primal, const Matrix &supremizers);

struct InfSup {
  double hf, dec, on, off; ///< hf: NaN where it was not asked for
  double c_hf = hf;        ///< continuity constant (2.3), likewise
};

/// What V_N + S guarantees at one mu: beta_off >= sqrt(1 - sigma^2) beta_on. For with T = T(mu) and
/// the V-orthogonal projection Pi onto V_N + S
///
///   b(v, eta) = (v, T eta)_V,   hence   sup over v in V_N + S of b(v, eta) / |v|_V = |Pi T eta|_V,
///   |Pi T eta|^2 = |T eta|^2 - |(I - Pi) T eta|^2 >= (1 - sigma^2) |T eta|^2,
///
/// since T eta is in S_R(mu) (2.21). V_N + S_R(mu) holds T eta, so that the sup over it is |T eta|,
/// and beta_on |eta|_W <= |T eta|_V. Take the inf over eta, of the cone or of its span alike. For
/// every sigma < 1 the bound is positive; (2.24) asks for sigma < beta_on / c_S.
struct StabilityBound {
  double sigma;   ///< sigma_S(mu) (2.21), over the span
  double c;       ///< c_S(mu) (2.22), over the span
  double on;      ///< beta_on(mu)
  double sharp;   ///< sqrt(1 - sigma^2) beta_on <= beta_off
  double classic; ///< beta_S^* (2.24) <= beta_off; not positive where (2.23) fails
};

/// What the first supremizers guarantee, and what they reach.
struct StabilityStep {
  StabilityBound bound; ///< sigma from its cosine: nothing below 1e-8 is meant
  double off;           ///< beta_off(mu), or beta_{S^n}(mu) of (2.42)
};

/// One step for each number of supremizers in `counts` (increasing). `coordinates`: of V_N and then
/// all of them. Triangular factors grow by the new rows, so that a step costs two small SVDs.
std::vector<StabilityStep> stability_path(const Matrix &coordinates, Index modes,
                                          const std::vector<int> &counts,
                                          const Matrix &supremizers);

/// The constants at one mu (2.14), (2.18), (2.30), beta_HF left out. `modes`: coordinates of V_N;
/// `enriched`: of V_N + S; `x`: orthonormal dual basis.
InfSup infsup_constants(const RieszSpace &space, const SparseMatrix &b_contact, const Matrix &modes,
                        const Matrix &enriched, const Matrix &x);

struct PgaOptions {
  double tolerance = 0;   ///< on max sigma_S (2.27), below 1; 0: use `stability` instead
  double stability = 0.9; ///< stop when sqrt(1 - sigma_S(mu)^2) >= stability for all mu; in (0, 1)
  int max_size = 0;       ///< 0: no bound
};

struct Pga {
  Matrix representers;       ///< n_c x S: V^-1 E times column s is supremizer s, of norm 1
  Matrix coordinates;        ///< (n_c + N) x (N + S): orthonormal, the modes first
  std::vector<double> sigma; ///< max over mu of sigma_{S^n}(mu), n = 0, 1, ..., S (2.21)
  std::vector<int> selected; ///< training index of each supremizer; -1: one SVD gave all
  int evaluations = 0;       ///< candidates evaluated by an eigenproblem, or 1 SVD
  std::string reason;        ///< why it stopped
};

/// Projected greedy algorithm (Algorithm 1), lazily evaluated: sigma does not increase, so that
/// only candidates whose last value can still win are looked at again, with rank-k updates of the
/// R x R matrices whose largest eigenvalue is sigma_S(mu)^2. Of these most are ruled out by a
/// Cholesky factorisation, and SLEPc's EPS (prefix pga_) gives the value of the others. A multiple
/// eigenvalue gives all its vectors at once, as the greedy would take them one after the other.
///
/// Collective on `comm`; what it returns is on every rank, choices and counts are the same for any
/// number of them. `modes`: coordinates of V_N, (n_c + N) x N; `supremizers`: T(mu_p) X, n_c x R,
/// for this rank's turns among the training mu, p = rank, rank + ranks, ... (move them in). One
/// matrix, or all of the same span: a single SVD (prefix pga_) gives everything. Stops on the
/// tolerance or on the sharper bound beta_off >= sqrt(1 - sigma_S^2) beta_on; supremizers within
/// 1e-12 of the space count as inside. Ties within 1e-10 go to the lowest training index. Throws
/// bad_input for an option out of its range, failure for entries that are not finite.
Pga projected_greedy(MPI_Comm comm, const RieszSpace &space, const Matrix &modes,
                     std::vector<Matrix> supremizers, const PgaOptions &options);

} // namespace rbvi
