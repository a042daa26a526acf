// Niakh (2022): (3.56), (3.57), Algorithm 3, Remark 3.3.2, Remark 3.3.3.
#include "rbvi/mor/published/gcns.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rbvi {

namespace {

constexpr double gcns_tie = 1e-10;    ///< within it of the largest, relative, counts as equal
constexpr double solve_noise = 1e-11; ///< of the largest pressure: what reduced solves leave

void check(const std::vector<GcnsSample> &samples, const Matrix &normal, const Matrix &tangential,
           const SparseMatrix &product, const GcnsOptions &options) {
  const Index nodes = normal.rows(), size = normal.cols() + tangential.cols();
  if (samples.empty()) throw failure("GCNS: there is no training sample");
  if (tangential.rows() != nodes || product.rows() != nodes || product.cols() != nodes)
    throw failure("GCNS: the two bases and the product are not of the same nodes");
  for (const GcnsSample &sample : samples)
    if (sample.h.rows() != size || sample.h.cols() != size || sample.q.size() != size ||
        sample.tangential.size() != nodes)
      throw failure("GCNS: the sizes of a sample do not fit the bases");
  if (!(options.tolerance >= 0) || options.max_nodes < 0)
    throw bad_input("GCNS: the tolerance and the largest number of nodes must not be negative");
  if (options.nodes == CollocationNodes::all && (options.tolerance > 0 || options.max_nodes > 0))
    throw bad_input("GCNS: -gcns_nodes all takes every node: leave out -gcns_tolerance and "
                    "-gcns_max_nodes");
}

/// What one reduced solution leaves at all nodes.
struct NodeAnswer {
  double error = 0; ///< |lambda_tau - T b|
  Vector excess;    ///< [|T b| - s]_+
  double scale = 0; ///< largest |T b| or s
};

class Selection {
public:
  Selection(const std::vector<GcnsSample> &samples, const Matrix &normal, const Matrix &tangential,
            const SparseMatrix &product)
      : samples_(samples), normal_(normal), tangential_(tangential), product_(product),
        starts_(samples.size()), taken_(normal.rows(), 0) {
    for (const GcnsSample &sample : samples) {
      sizes_.push_back(norm(sample.tangential));
      bounds_.push_back(bounds_per_node(sample.bounds, normal.rows()));
    }
    const double largest = *std::max_element(sizes_.begin(), sizes_.end());
    if (!(largest > 0))
      throw failure("GCNS: all tangential multipliers are zero: leave out the friction");
    for (double &size : sizes_)
      if (size <= solve_noise * largest) size = largest;
  }

  Gcns run(const GcnsOptions &options) {
    if (options.nodes == CollocationNodes::all)
      for (int node = 0; node < static_cast<int>(taken_.size()); ++node)
        take({node});
    while (step(options)) {
    }
    const auto best = std::min_element(result_.error.begin(), result_.error.end());
    const auto count = result_.count[best - result_.error.begin()];
    result_.nodes.resize(count);
    result_.reason += "; the error is least, " + short_number(*best) + ", with " +
                      std::to_string(count) + " nodes";
    return std::move(result_);
  }

private:
  /// Solves with the nodes of this step and takes those of the next; false: this was the last.
  bool step(const GcnsOptions &options) {
    const std::vector<NodeAnswer> answers = solve();
    if (answers.empty()) return false;
    record(answers);
    const std::vector<int> next = largest(answers[result_.selected.back()]);
    const auto total = result_.nodes.size() + next.size();
    if (result_.nodes.size() == taken_.size())
      result_.reason = "all nodes are taken";
    else if (options.nodes == CollocationNodes::before_rise && rises())
      result_.reason = "the error rises";
    else if (options.tolerance > 0 && result_.error.back() <= options.tolerance)
      result_.reason = "the error is within the tolerance";
    else if (next.empty())
      result_.reason = "no other node violates its bound";
    else if (options.max_nodes > 0 && total > static_cast<std::size_t>(options.max_nodes))
      result_.reason = "more nodes would exceed the largest number allowed";
    else
      take(next);
    return result_.reason.empty();
  }

  bool rises() const {
    const std::vector<double> &error = result_.error;
    return error.size() > 1 && error.back() > error[error.size() - 2];
  }

  void take(const std::vector<int> &nodes) {
    for (const int j : nodes) {
      taken_[j] = 1;
      result_.nodes.push_back(j);
    }
  }

  /// Answers at all mu; none if one was not found, and the selection ends with what it has.
  std::vector<NodeAnswer> solve() {
    std::vector<NodeAnswer> answers;
    for (std::size_t k = 0; k < samples_.size(); ++k) {
      const GcnsSample &sample = samples_[k];
      std::vector<FrictionBound> bounds =
          bounds_at(bounds_[k], {result_.nodes.begin(), result_.nodes.end()});
      const CollocatedProblem problem{.h = sample.h,
                                      .q = sample.q,
                                      .normal_rows = normal_(result_.nodes, Eigen::all),
                                      .tangential_rows = tangential_(result_.nodes, Eigen::all),
                                      .bounds = std::move(bounds)};
      CollocatedResult solved = solve_collocated(problem, starts_[k]);
      if (!solved.converged && starts_[k].size() > 0) solved = solve_collocated(problem);
      if (!solved.converged) {
        result_.reason = "training problem " + std::to_string(k) + " with " +
                         std::to_string(result_.nodes.size()) + " nodes: " + solved.reason;
        if (result_.error.empty()) throw failure("GCNS: " + result_.reason);
        return {};
      }
      answers.push_back(answer(sample, bounds_[k], solved.x));
      starts_[k] = std::move(solved.x);
    }
    return answers;
  }

  NodeAnswer answer(const GcnsSample &sample, const std::vector<FrictionBound> &bounds,
                    const Vector &x) const {
    const Vector pressure = normal_ * x.head(normal_.cols());
    const Vector traction = tangential_ * x.tail(tangential_.cols());
    const Vector s =
        Vector::NullaryExpr(pressure.size(), [&](Index j) { return bounds[j].value(pressure[j]); });
    NodeAnswer result;
    result.error = norm(sample.tangential - traction);
    result.excess = (traction.cwiseAbs() - s).cwiseMax(0.0);
    result.scale = std::max(traction.cwiseAbs().maxCoeff(), s.maxCoeff());
    return result;
  }

  /// The history of this step; mu_q is the first of those with the largest violation.
  void record(const std::vector<NodeAnswer> &answers) {
    double error = 0, violation = 0;
    for (std::size_t k = 0; k < answers.size(); ++k) {
      error = std::max(error, answers[k].error / sizes_[k]);
      violation = std::max(violation, answers[k].excess.maxCoeff());
    }
    int selected = 0;
    while (answers[selected].excess.maxCoeff() < (1 - gcns_tie) * violation)
      ++selected;
    result_.count.push_back(static_cast<int>(result_.nodes.size()));
    result_.error.push_back(error);
    result_.violation.push_back(violation);
    result_.selected.push_back(selected);
  }

  /// The nodes not taken where the violation is largest; none where it is zero.
  std::vector<int> largest(const NodeAnswer &answer) const {
    double most = 0;
    for (std::size_t j = 0; j < taken_.size(); ++j)
      if (taken_[j] == 0) most = std::max(most, answer.excess[j]);
    std::vector<int> result;
    if (most <= solve_noise * answer.scale) return result;
    const double least = most * (1 - gcns_tie) - 0.1 * solve_noise * answer.scale;
    for (std::size_t j = 0; j < taken_.size(); ++j)
      if (taken_[j] == 0 && answer.excess[j] >= least) result.push_back(static_cast<int>(j));
    return result;
  }

  double norm(const Vector &values) const {
    return std::sqrt(std::max(0.0, values.dot(product_ * values)));
  }

  const std::vector<GcnsSample> &samples_;
  const Matrix &normal_, &tangential_;
  const SparseMatrix &product_;
  std::vector<double> sizes_;                      ///< |lambda_tau|
  std::vector<std::vector<FrictionBound>> bounds_; ///< of each sample, per node
  std::vector<Vector> starts_;                     ///< solutions of the step before
  std::vector<char> taken_;
  Gcns result_;
};

} // namespace

Gcns select_collocation_nodes(const std::vector<GcnsSample> &samples, const Matrix &normal_basis,
                              const Matrix &tangential_basis, const SparseMatrix &product,
                              const GcnsOptions &options) {
  check(samples, normal_basis, tangential_basis, product, options);
  return Selection(samples, normal_basis, tangential_basis, product).run(options);
}

} // namespace rbvi
