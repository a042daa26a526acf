#include "rbvi/method/certificate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace rbvi {

ErrorBound error_bound(double minus, double plus, double slack) {
  const double radius = std::sqrt(plus * plus / 4 + slack);
  return {minus / 2 + radius, plus / 2 + radius, plus * plus / 2 + slack};
}

double norm_over_references(const Matrix &references, const Vector &theta, const Vector &norms) {
  constexpr double none = -1e-12; // round-off of a weight that is zero
  const Index terms = references.rows(), count = references.cols();
  double largest = 0; // sum of c_j / norms_j^2: of a linear program, at one of its corners
  std::vector<bool> chosen(count, false);
  std::fill_n(chosen.begin(), std::min(terms, count), true);
  do {
    std::vector<Index> which;
    for (Index j = 0; j < count; ++j)
      if (chosen[j]) which.push_back(j);
    if (std::ssize(which) < terms) break;
    const Vector c = lu_solve(references(Eigen::all, which), theta);
    if (!c.allFinite() || !(c.minCoeff() >= none * c.cwiseAbs().maxCoeff())) continue;
    double sum = 0;
    for (std::size_t k = 0; k < which.size(); ++k)
      if (c[static_cast<Index>(k)] > 0)
        sum += c[static_cast<Index>(k)] / (norms[which[k]] * norms[which[k]]);
    largest = std::max(largest, sum);
  } while (std::prev_permutation(chosen.begin(), chosen.end()));
  return 1 / std::sqrt(largest);
}

namespace {

/// What B_n z is wanted to be at the rows of some lifting functions, one for each.
struct Wanted {
  std::vector<Index> rows;
  std::vector<Index> functions;

  void add(Index row, int function) {
    rows.push_back(row);
    functions.push_back(function);
  }
  bool lifts(int function) const {
    return std::ranges::find(functions, Index{function}) != functions.end();
  }
};

/// Weights with B_n z = s at these rows.
Vector weights_of(const Matrix &b, const Wanted &wanted, const Vector &s) {
  Vector weights = Vector::Zero(b.cols());
  if (wanted.rows.empty()) return weights;
  const Matrix square = b(wanted.rows, wanted.functions);
  const Vector target = s(wanted.rows);
  Vector some = lu_solve(square, target);
  some += lu_solve(square, target - square * some);
  weights(wanted.functions) = some;
  return weights;
}

/// Adds a multiple of the sum of all functions that leaves no row below zero.
bool raise(const Matrix &b, double roundoff, Lifting &lifting) {
  const Vector sum = b.rowwise().sum();
  double amount = 0;
  for (Index row = 0; row < sum.size(); ++row) {
    if (lifting.left[row] >= -roundoff) continue;
    if (!(sum[row] > 0)) return false;
    amount = std::max(amount, -lifting.left[row] / sum[row]);
  }
  if (amount == 0) return true;
  lifting.weights.array() += amount;
  lifting.left += amount * sum;
  return lifting.left.minCoeff() >= -roundoff;
}

} // namespace

std::optional<Lifting> lift(const Matrix &b, const std::vector<int> &own, const Vector &s,
                            const Vector &multiplier, double roundoff) {
  constexpr int most_rounds = 10;
  Wanted wanted;
  for (Index row = 0; row < s.size(); ++row) {
    const int function = own[row];
    if (function < 0 || wanted.lifts(function)) continue;
    const double k = 1 / b(row, function);
    if (s[row] > 0 || (multiplier[row] > 0 && multiplier[row] + k * s[row] > 0))
      wanted.add(row, function);
  }
  Lifting lifting;
  for (int round = 0;; ++round) {
    lifting.weights = weights_of(b, wanted, s);
    lifting.left = b * lifting.weights - s;
    const std::size_t before = wanted.rows.size();
    for (Index row = 0; row < s.size() && round < most_rounds; ++row)
      if (lifting.left[row] < -roundoff && own[row] >= 0 && !wanted.lifts(own[row]))
        wanted.add(row, own[row]);
    if (wanted.rows.size() == before) break;
  }
  if (!lifting.weights.allFinite() || !raise(b, roundoff, lifting)) return std::nullopt;
  lifting.left = (lifting.left.array() > roundoff).select(lifting.left, 0);
  return lifting;
}

} // namespace rbvi
