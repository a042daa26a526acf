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

/// Rows, and the lifting function of each.
struct Pairs {
  std::vector<Index> rows, functions;
};

/// `known`, and of the rows that `wants` holds for one of each function that is not there yet.
template <class Wants>
Pairs pairs_of(const std::vector<int> &own, const Wants &wants, Pairs known = {}) {
  for (std::size_t row = 0; row < own.size(); ++row) {
    const Index function = own[row];
    if (function < 0 || !wants(static_cast<Index>(row)) ||
        std::ranges::find(known.functions, function) != known.functions.end())
      continue;
    known.rows.push_back(static_cast<Index>(row));
    known.functions.push_back(function);
  }
  return known;
}

/// With one step of refinement.
Matrix solved_twice(const Matrix &square, const Matrix &right) {
  const Eigen::PartialPivLU<Matrix> lu(square);
  const Matrix once = lu.solve(right);
  return once + lu.solve(right - square * once);
}

/// What B_n z is wanted to be: s at these rows.
class Wanted {
public:
  explicit Wanted(const ColumnSource &columns, Index rows) : columns_(columns), b_(rows, 0) {}
  void add(const Pairs &pairs) {
    const Matrix columns = columns_(pairs.functions);
    for (Index k = 0; k < columns.cols(); ++k)
      add(pairs.rows[k], pairs.functions[k], columns.col(k));
  }
  void add(Index row, Index function, const Vector &column) {
    pairs_.rows.push_back(row);
    pairs_.functions.push_back(function);
    b_.conservativeResize(b_.rows(), b_.cols() + 1);
    b_.rightCols(1) = column;
  }
  /// Those that `wants` holds for and that are not there yet.
  template <class Wants> Pairs more(const std::vector<int> &own, const Wants &wants) const {
    Pairs result = pairs_of(own, wants, pairs_);
    const auto known = std::ssize(pairs_.rows);
    result.rows.erase(result.rows.begin(), result.rows.begin() + known);
    result.functions.erase(result.functions.begin(), result.functions.begin() + known);
    return result;
  }
  Lifting lifting(const Vector &s) const {
    Lifting result{pairs_.functions, Vector(b_.cols()), -s};
    if (b_.cols() == 0) return result;
    result.weights = solved_twice(b_(pairs_.rows, Eigen::all), s(pairs_.rows));
    result.left += b_ * result.weights;
    return result;
  }

private:
  const ColumnSource &columns_;
  Pairs pairs_;
  Matrix b_; ///< B_n of these functions
};

/// Adds a multiple of the sum of all functions that leaves no row below zero.
bool raise(const ColumnSource &columns, Index count, double roundoff, Lifting &lifting) {
  if (lifting.left.minCoeff() >= -roundoff) return true;
  std::vector<Index> all(count);
  std::iota(all.begin(), all.end(), 0);
  const Vector sum = columns(all).rowwise().sum();
  for (Index row = 0; row < sum.size(); ++row) {
    if (lifting.left[row] >= -roundoff) continue;
    if (!(sum[row] > 0)) return false;
    lifting.raised = std::max(lifting.raised, -lifting.left[row] / sum[row]);
  }
  lifting.left += lifting.raised * sum;
  return lifting.left.minCoeff() >= -roundoff;
}

} // namespace

std::optional<Lifting> lift(const ColumnSource &columns, Index count, const std::vector<int> &own,
                            const Vector &s, const Vector &multiplier, double roundoff) {
  constexpr int most_rounds = 10;
  Wanted wanted(columns, s.size());
  const Pairs near = wanted.more(own, [&](Index row) { return s[row] > 0 || multiplier[row] > 0; });
  const Matrix of_near = columns(near.functions);
  for (Index k = 0; k < of_near.cols(); ++k)
    if (const Index row = near.rows[k];
        s[row] > 0 || multiplier[row] + s[row] / of_near(row, k) > 0)
      wanted.add(row, near.functions[k], of_near.col(k));
  Lifting lifting = wanted.lifting(s);
  for (int round = 0; round < most_rounds; ++round) {
    const Pairs below = wanted.more(own, [&](Index row) { return lifting.left[row] < -roundoff; });
    if (below.rows.empty()) break;
    wanted.add(below);
    lifting = wanted.lifting(s);
  }
  if (!lifting.weights.allFinite() || !raise(columns, count, roundoff, lifting))
    return std::nullopt;
  lifting.left = (lifting.left.array() > roundoff).select(lifting.left, 0);
  return lifting;
}

std::optional<std::vector<LinearOutput>> linear_outputs(const ColumnSource &columns, Index count,
                                                        const std::vector<int> &own,
                                                        const Vector &multiplier,
                                                        const Vector &left, const Matrix &outputs) {
  constexpr double near = 0.1; // of the widest gap
  const double widest = left.maxCoeff();
  Pairs pairs = pairs_of(own, [&](Index row) { return multiplier[row] > 0; });
  pairs = pairs_of(
      own, [&](Index row) { return left[row] <= near * widest; }, std::move(pairs));
  const Matrix lifted = columns(pairs.functions),
               weights =
                   solved_twice(lifted(pairs.rows, Eigen::all), outputs(pairs.rows, Eigen::all));
  if (!weights.allFinite()) return std::nullopt;
  Matrix missed = outputs - lifted * weights;
  missed(pairs.rows, Eigen::all).setZero();
  std::vector<LinearOutput> result;
  for (Index k = 0; k < outputs.cols(); ++k) {
    LinearOutput one{Vector::Zero(count), 0};
    one.weights(pairs.functions) = weights.col(k);
    for (Index row = 0; row < missed.rows(); ++row) {
      if (missed(row, k) == 0) continue;
      if (multiplier[row] > 0 || !(left[row] > 0)) return std::nullopt;
      one.far = std::max(one.far, std::abs(missed(row, k)) / left[row]);
    }
    result.push_back(std::move(one));
  }
  return result;
}

} // namespace rbvi
