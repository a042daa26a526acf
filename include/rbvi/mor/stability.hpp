// Inf-sup constants and supremizers, in coordinates in which the V product is Euclidean.
//
// The contact forms touch n_c displacement dofs only, so every Riesz representer
// T(mu) eta = V^-1 E B_c(mu)^T eta lies in the range of V^-1 E, E the n_c unit columns of those
// dofs. With Z = E^T V^-1 E = L L^T one block of n_c solves serves all mu:
//   T(mu) eta           has coordinates  [ L^T B_c(mu)^T eta ; 0 ]            in R^(n_c + N)
//   a mode v_n          has coordinates  [ L^-1 E^T v_n ; K^T ],  K K^T = I - P^T P, P = L^-1 E^T V_N
//   b(mu; v, eta)       = eta^T B_c(mu) L y            for v with coordinates [ y ; z ].
// Constants are over the span of the dual basis, a lower bound for the cone's (Niakh 2022, 2.3).
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/fem/trace.hpp"
#include "rbvi/mor/pod.hpp"

#include <functional>
#include <string>
#include <vector>

namespace rbvi {

/// The map between displacement fields and Euclidean coordinates above. Dense parts replicated.
struct RieszSpace {
  Handle<Mat> lift;  ///< V^-1 E: free dofs x n_c, dense, distributed like V
  Matrix factor;     ///< L, lower triangular: n_c x n_c
};

/// Collective. One factorisation of `product` (KSP prefix -v_), one block of n_c solves.
RieszSpace make_riesz_space(Mat product, const Trace &trace);

/// Collective. Coordinates of the basis columns: (n_c + N) x N, orthonormal.
Matrix mode_coordinates(const RieszSpace &space, const LinearBasis &modes, const Trace &trace);

/// Columns orthonormal in W that span the columns of `generators` (dependent ones left out below
/// `tolerance`, relative): dual dofs x rank.
Matrix orthonormal_dual_basis(const Matrix &generators, const SparseMatrix &w_product,
                              double tolerance = 1e-9);

/// L^T B_c(mu)^T X: n_c x columns of X, the coordinates of T(mu) X.
Matrix supremizer_coordinates(const RieszSpace &space, const SparseMatrix &b_contact, const Matrix &x);

/// Smallest singular value of b between the orthonormal columns of `primal` ((n_c + N) x k
/// coordinates) and an orthonormal dual basis X, given T = supremizer_coordinates(X). 0 if k is
/// smaller than the number of columns of X.
double infsup_constant(const Matrix &primal, const Matrix &supremizers);

struct InfSup {
  double hf, dec, on, off;
};

/// The four constants at one mu (2.3), (2.14), (2.18), (2.30). `modes`: coordinates of V_N;
/// `enriched`: of V_N + S; `x`: orthonormal dual basis; `w_product`: for beta_HF.
/// beta_HF is over the whole dual space and costs a dense SVD of its size: NaN unless `with_hf`.
InfSup infsup_constants(const RieszSpace &space, const SparseMatrix &b_contact,
                        const SparseMatrix &w_product, const Matrix &modes, const Matrix &enriched,
                        const Matrix &x, bool with_hf);

struct PgaOptions {
  double tolerance = 0;        ///< on max sigma_S (2.27); 0: use `stability` instead
  double stability = 0.9;      ///< stop when sqrt(1 - sigma_S(mu)^2) >= stability for all mu
  int max_size = 0;            ///< 0: no bound
};

struct Pga {
  Matrix representers;           ///< n_c x S: supremizer s is V^-1 E times column s (before projection)
  Matrix coordinates;            ///< (n_c + N) x (N + S): orthonormal, the modes first
  std::vector<double> sigma;     ///< max over mu of sigma_{S^n}(mu), n = 0, 1, ..., S (2.21)
  std::vector<int> selected;     ///< training index of each supremizer; -1 where one SVD gave all
  int evaluations = 0;           ///< eigenproblems solved
  bool parameter_independent = false; ///< S_R(mu) is one space: a single SVD replaced the sweep
  std::string reason;
};

/// Projected greedy algorithm (Algorithm 1), lazily evaluated, rank-one updates of the R x R
/// matrices whose largest eigenvalue is sigma_S(mu)^2. `supremizers`: T(mu_p) X in coordinates
/// (n_c x R each) for every training mu; it stops on the sharper bound
/// beta_off >= sqrt(1 - sigma_S^2) beta_on. Ties within 1e-10 go to the lowest training index.
Pga projected_greedy(const RieszSpace &space, const Matrix &modes,
                     const std::vector<Matrix> &supremizers, const PgaOptions &options);

} // namespace rbvi
