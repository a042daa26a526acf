// A bound of the error of any answer u_N, l_N to the problem of contact
//
//   A u + B^T l = f,   B_n u <= g_n,   l_n >= 0,   complementary,   and by Tresca's law |l_t| <= k
//
// from what the answer itself leaves: no constant of stability, no part of the true answer. |.| of
// a displacement is its norm in A, of a residual its norm in A^-1. With r = f - A u_N - B^T l_N and
// s = B_n u_N - g_n, a lifting z of s, B_n z >= s, makes v = u_N - z admissible, and
//
//   slack = l_n . (B_n z - s) + sum of (k |v_t| - l_t . v_t),   v_t = B_t v - g_t,
//   |u - u_N| <= |r - A z| / 2 + Rad,   |u - v|, |B^T (l - l_N)| <= |r + A z| / 2 + Rad,
//   Rad^2 = |r + A z|^2 / 4 + slack,    J(v) - gap <= J(u) <= J(v),   gap = |r + A z|^2 / 2 + slack
//
// where l_N is one that the law allows and J is the energy with k |v_t|. cases/BOUNDS.md
// proves it.
#pragma once

#include "rbvi/core/dense.hpp"
#include "rbvi/method/lcp.hpp"
#include "rbvi/method/node_laws.hpp"

#include <optional>
#include <vector>

namespace rbvi {

struct ErrorBound {
  double u;          ///< of |u - u_N|
  double multiplier; ///< of |u - v| and of |B^T (l - l_N)|
  double gap;        ///< of J(v) - J(u)
};

/// `minus`: |r - A z|, `plus`: |r + A z|, `slack` >= 0.
ErrorBound error_bound(double minus, double plus, double slack);

/// Bound of the norm of a residual in A^-1 from its norms in A_j^-1, J of them, where
/// A = sum of theta_q A^q and A_j = sum of references(q, j) A^q: with any c >= 0 for which
/// A = sum of c_j A_j it is (sum of c_j / norms_j^2)^-1/2, and of these the least is taken.
/// Infinite where A is no such sum.
double norm_over_references(const Matrix &references, const Vector &theta, const Vector &norms);

/// z as a combination of the lifting functions, and B z - s: at normal rows >= 0, at others minus
/// the slip of u_N - z.
struct Lifting {
  Vector weights, left;
};

/// `columns`: B of some of the `count` lifting functions; `own`: of each row the function that
/// lifts it, -1: none does; `s`, `multiplier`: rows. Rows whose multiplier stays positive under s
/// get B_n z = s, other normal ones as much as they need; nodes whose traction stays below its
/// bound under their slip get B_t z = s, so that they do not slip. What is left within `roundoff`
/// of zero is zero. Nothing where some normal row cannot be lifted.
std::optional<Lifting> lift(const ColumnSource &columns, Index count, const std::vector<int> &own,
                            const Vector &s, const Vector &multiplier, const NodeLaws &laws,
                            double roundoff);

/// Of an output p . l_n: with v the lifting functions times `weights`, |p . (l_n - l_N)| is at most
/// |v| times ErrorBound::multiplier plus `far` times ErrorBound::gap.
struct LinearOutput {
  Vector weights;
  double far;
};

/// Without friction, one for each column of `outputs`, p at the rows of B. `columns`, `count`,
/// `own`, `multiplier`: as in lift; `left`: the gaps of u_N - z, >= 0. Nothing where a row presses
/// without a function of its own, or might.
std::optional<std::vector<LinearOutput>> linear_outputs(const ColumnSource &columns, Index count,
                                                        const std::vector<int> &own,
                                                        const Vector &multiplier,
                                                        const Vector &left, const Matrix &outputs);

} // namespace rbvi
