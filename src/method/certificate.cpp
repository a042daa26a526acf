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

/// What B z is wanted to be: s at these rows.
class Wanted {
public:
  Wanted(const ColumnSource &columns, Index rows) : columns_(columns), b_(rows, 0) {}
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
  Lifting lifting(const Vector &s, Index count) const {
    Lifting result{Vector::Zero(count), -s};
    if (b_.cols() == 0) return result;
    const Vector weights = solved_twice(b_(pairs_.rows, Eigen::all), s(pairs_.rows));
    result.weights(pairs_.functions) = weights;
    result.left += b_ * weights;
    return result;
  }

private:
  const ColumnSource &columns_;
  Pairs pairs_;
  Matrix b_; ///< B of these functions
};

/// Adds a multiple of the sum of all functions of normal rows that leaves none of these below zero.
bool raise(const ColumnSource &columns, const std::vector<int> &own, const NodeLaws &laws,
           const std::vector<bool> &is_normal, double roundoff, Lifting &lifting) {
  const auto least = [&] { return lifting.left(laws.normal).minCoeff(); };
  if (least() >= -roundoff) return true;
  const Pairs all = pairs_of(own, [&](Index row) { return is_normal[row]; });
  const Vector sum = columns(all.functions).rowwise().sum();
  double raised = 0;
  for (const Index row : laws.normal) {
    if (lifting.left[row] >= -roundoff) continue;
    if (!(sum[row] > 0)) return false;
    raised = std::max(raised, -lifting.left[row] / sum[row]);
  }
  lifting.left += raised * sum;
  lifting.weights(all.functions).array() += raised;
  return least() >= -roundoff;
}

/// Which rows the lifting begins with, each with a function of its own.
class FirstRows {
public:
  FirstRows(const Vector &s, const Vector &multiplier, const NodeLaws &laws, double roundoff)
      : s_(s), x_(multiplier), laws_(laws), node_of_(s.size(), -1), is_asked_(s.size(), false) {
    for (Index node = 0; node < laws.nodes(); ++node) {
      const Index normal = laws.normal[node];
      is_asked_[normal] = s[normal] > 0 || multiplier[normal] > 0;
      if (!laws.has_tangent(node) || bound(node) == 0) continue;
      for (Index row = laws.tangent[node]; row < laws.tangent[node] + laws.tangents; ++row) {
        node_of_[row] = node;
        is_asked_[row] = std::abs(s[row]) > roundoff;
      }
    }
  }
  bool is_asked(Index row) const { return is_asked_[row]; }
  /// `lifted`: B of the row's function there.
  bool is_wanted(Index row, double lifted) const {
    const Index node = node_of_[row];
    if (node < 0) return s_[row] > 0 || x_[row] + s_[row] / lifted > 0;
    const auto at = [&](const Vector &rows) {
      return rows.segment(laws_.tangent[node], laws_.tangents);
    };
    return (at(x_) + at(s_) / lifted).norm() < bound(node);
  }

private:
  double bound(Index node) const { return laws_.bound[node].value(x_[laws_.normal[node]]); }

  const Vector &s_, &x_;
  const NodeLaws &laws_;
  std::vector<Index> node_of_; ///< of a row with friction, -1: of others
  std::vector<bool> is_asked_;
};

} // namespace

std::optional<Lifting> lift(const ColumnSource &columns, Index count, const std::vector<int> &own,
                            const Vector &s, const Vector &multiplier, const NodeLaws &laws,
                            double roundoff) {
  constexpr int most_rounds = 10;
  std::vector<bool> is_normal(own.size(), false);
  for (const Index row : laws.normal)
    is_normal[row] = true;
  Wanted wanted(columns, s.size());
  const FirstRows first(s, multiplier, laws, roundoff);
  const Pairs near = wanted.more(own, [&](Index row) { return first.is_asked(row); });
  const Matrix of_near = columns(near.functions);
  for (Index k = 0; k < of_near.cols(); ++k)
    if (const Index row = near.rows[k]; first.is_wanted(row, of_near(row, k)))
      wanted.add(row, near.functions[k], of_near.col(k));
  Lifting lifting = wanted.lifting(s, count);
  for (int round = 0; round < most_rounds; ++round) {
    const Pairs below = wanted.more(
        own, [&](Index row) { return is_normal[row] && lifting.left[row] < -roundoff; });
    if (below.rows.empty()) break;
    wanted.add(below);
    lifting = wanted.lifting(s, count);
  }
  if (!lifting.weights.allFinite() || !raise(columns, own, laws, is_normal, roundoff, lifting))
    return std::nullopt;
  for (const Index row : laws.normal)
    lifting.left[row] = std::max(0.0, lifting.left[row]);
  lifting.left = (lifting.left.array().abs() > roundoff).select(lifting.left, 0);
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
