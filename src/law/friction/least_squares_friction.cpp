#include "rbvi/law/friction/least_squares_friction.hpp"

#include "../pivoting.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace rbvi {

namespace {

constexpr double tolerance = 1e-13;
constexpr double coarse = 0.1; ///< the residual of a basis that hardly describes the solution

/// The tangential equation of a node: x_tau = 0, w_tau = 0, or x_tau = direction * bound.
enum class Tangent { none, stick, slip };

/// Multipliers, gaps and slips at the nodes.
struct Values {
  Vector x_n, x_t, w_n, w_t;
  Vector noise_n, noise_t; ///< round-off of x - w
  double largest = 0;      ///< x
};

/// The problem in units in which H has a unit diagonal: sqrt(H_jj) x, w / sqrt(H_jj).
class Equations {
public:
  explicit Equations(const LeastSquaresProblem &problem)
      : bound_(bounds_per_node(problem.bounds, problem.gap.size())) {
    const Vector n = problem.gap_scale.cwiseSqrt(), t = problem.slip_scale.cwiseSqrt();
    normal_ = n.asDiagonal() * problem.normal;
    tangential_ = t.asDiagonal() * problem.tangential;
    gap_rows_ = n.cwiseInverse().asDiagonal() * problem.gap_rows;
    slip_rows_ = t.cwiseInverse().asDiagonal() * problem.slip_rows;
    gap_ = problem.gap.cwiseQuotient(n);
    slip_ = problem.slip.cwiseQuotient(t);
    slope_ = t.cwiseQuotient(n);
    threshold_ = t;
    for (Index j = 0; j < nodes(); ++j) {
      slope_[j] *= law(j).coefficient;
      threshold_[j] *= law(j).threshold;
    }
    matrix_.resize(2 * nodes(), modes());
    right_.resize(2 * nodes());
  }

  Index nodes() const { return gap_.size(); }
  Index modes() const { return normal_.cols(); }
  /// The largest w where x is zero.
  double largest_load() const {
    return nodes() > 0 ? std::max(gap_.cwiseAbs().maxCoeff(), slip_.cwiseAbs().maxCoeff()) : 0.0;
  }
  const FrictionBound &law(Index j) const { return bound_[at(j)]; }
  Tangent tangent(Index j, const SlipState &state) const {
    const bool together = state.state != NodeState::open;
    if (!law(j).carries_traction(together)) return Tangent::none;
    const bool sticks = together ? state.state == NodeState::stick : state.direction == 0;
    return sticks ? Tangent::stick : Tangent::slip;
  }
  /// The bound of a node whose x_tau can differ from zero.
  double bound(Index j, double x_n) const { return slope_[j] * std::max(x_n, 0.0) + threshold_[j]; }

  /// The coefficients, of minimum norm if `full_rank` turns out to be false.
  Vector solve(const std::vector<SlipState> &states, bool &full_rank) {
    assemble(states);
    qr_.compute(matrix_);
    const auto triangle = qr_.matrixQR().topRows(modes());
    full_rank = true;
    for (Index c = 0; c < modes(); ++c) {
      const double size = triangle.col(c).head(c + 1).norm();
      full_rank = full_rank && std::abs(triangle(c, c)) > tolerance * size;
    }
    if (full_rank) return qr_.solve(right_);
    const Vector size = matrix_.colwise().norm().transpose();
    const Vector unit = (size.array() > 0).select(size.cwiseInverse(), 1.0);
    Eigen::CompleteOrthogonalDecomposition<Matrix> orthogonal;
    orthogonal.setThreshold(tolerance);
    orthogonal.compute(matrix_ * unit.asDiagonal());
    return unit.cwiseProduct(orthogonal.solve(right_));
  }

  Values evaluate(const Vector &y) const {
    Values v{normal_ * y, tangential_ * y, gap_rows_ * y + gap_, slip_rows_ * y + slip_, {}, {}, 0};
    if (nodes() > 0) v.largest = std::max(v.x_n.cwiseAbs().maxCoeff(), v.x_t.cwiseAbs().maxCoeff());
    const Vector size = y.cwiseAbs();
    const auto noise = [&](const Matrix &rows, const Vector &constant) -> Vector {
      const Vector terms = rows.cwiseAbs() * size + constant.cwiseAbs();
      return tolerance * (terms.array() + v.largest);
    };
    v.noise_n = noise(gap_rows_, gap_);
    v.noise_t = noise(slip_rows_, slip_);
    return v;
  }

private:
  void assemble(const std::vector<SlipState> &states) {
    const Index m = nodes();
    Vector open(m), stick(m), force(m), pressure(m);
    for (Index j = 0; j < m; ++j) {
      const SlipState &state = states[at(j)];
      const Tangent kind = tangent(j, state);
      const double sign = kind == Tangent::slip ? state.direction : 0;
      const bool apart = state.state == NodeState::open;
      open[j] = apart ? 1 : 0;
      stick[j] = kind == Tangent::stick ? 1 : 0;
      force[j] = 1 - stick[j];
      pressure[j] = apart ? 0 : -sign * slope_[j];
      right_[j] = apart ? 0 : -gap_[j];
      right_[m + j] = kind == Tangent::stick ? -slip_[j] : sign * threshold_[j];
    }
    const Vector closed = 1 - open.array();
    for (Index c = 0; c < modes(); ++c) {
      matrix_.col(c).head(m) =
          open.cwiseProduct(normal_.col(c)) + closed.cwiseProduct(gap_rows_.col(c));
      matrix_.col(c).tail(m) = stick.cwiseProduct(slip_rows_.col(c)) +
                               force.cwiseProduct(tangential_.col(c)) +
                               pressure.cwiseProduct(normal_.col(c));
    }
  }

  std::vector<FrictionBound> bound_; ///< of each node
  Matrix normal_, tangential_, gap_rows_, slip_rows_;
  Vector gap_, slip_, slope_, threshold_;
  Matrix matrix_;
  Vector right_;
  Eigen::HouseholderQR<Matrix> qr_;
};

/// The states that the laws predict from the values, and how far the values violate them.
struct Verdict {
  std::vector<SlipState> next;
  Vector change;        ///< how far a node is beyond the edge of its state, where the next differs
  double violation = 0; ///< largest, of the laws: x - Proj(x - w)
  double misfit = 0;    ///< largest, of the equations of the states
};

class Judge {
public:
  Judge(const Equations &equations, const Values &values, const std::vector<SlipState> &states)
      : equations_(equations), v_(values),
        states_(states), verdict_{.next = states, .change = Vector::Zero(equations.nodes())} {}

  Verdict all() {
    for (Index j = 0; j < equations_.nodes(); ++j) {
      const bool together = touches(j);
      raise(verdict_.violation, together ? v_.w_n[j] : v_.x_n[j]);
      raise(verdict_.misfit, states_[at(j)].state != NodeState::open ? v_.w_n[j] : v_.x_n[j]);
      tangential(j, together);
    }
    return std::move(verdict_);
  }

private:
  static void raise(double &largest, double value) { largest = std::max(largest, std::abs(value)); }

  bool touches(Index j) {
    const bool before = states_[at(j)].state != NodeState::open;
    const double y = v_.x_n[j] - v_.w_n[j];
    double edge = v_.noise_n[j];
    if (before) edge = equations_.law(j).jumps() ? 0 : -edge;
    const bool result = y > edge;
    if (result != before) raise(verdict_.change[j], y);
    return result;
  }

  void tangential(Index j, bool together) {
    const SlipState &now = states_[at(j)];
    const Tangent kind = equations_.tangent(j, now);
    const double x = v_.x_t[j], w = v_.w_t[j], bound = equations_.bound(j, v_.x_n[j]);
    SlipState &next = verdict_.next[at(j)];
    next = {together ? NodeState::slip : NodeState::open, 0};
    if (equations_.law(j).carries_traction(together)) {
      raise(verdict_.violation, x - std::clamp(x - w, -bound, bound));
      next.direction = direction(j, kind, now.direction, bound);
      if (together && next.direction == 0) next.state = NodeState::stick;
    } else {
      raise(verdict_.violation, x);
    }
    const double fixed = kind == Tangent::slip ? now.direction * bound : 0;
    raise(verdict_.misfit, kind == Tangent::stick ? w : x - fixed);
  }

  /// Zero: sticks. A node that slips does not turn back before it has been stuck (friction.hpp).
  int direction(Index j, Tangent kind, int now, double bound) {
    const double y = v_.x_t[j] - v_.w_t[j], noise = v_.noise_t[j];
    const int sign = y > 0 ? 1 : -1;
    // The bound of a node that just came into contact was zero.
    if (kind == Tangent::none) return std::abs(y) > noise ? sign : 0;
    if (!(bound > 0)) return now;
    if (kind == Tangent::slip) {
      if (now * y >= bound - noise) return now;
      raise(verdict_.change[j], bound - now * y);
      return 0;
    }
    if (!(std::abs(y) > bound + noise)) return 0;
    raise(verdict_.change[j], std::abs(y) - bound);
    return sign;
  }

  const Equations &equations_;
  const Values &v_;
  const std::vector<SlipState> &states_;
  Verdict verdict_;
};

/// Block exchange of the states; where it ends, the change of the first node alone, without the
/// changes that are smaller than what the basis misses of the equations.
class LeastSquaresSolver {
public:
  explicit LeastSquaresSolver(const LeastSquaresProblem &problem) : equations_(problem) {}

  LeastSquaresResult run(std::vector<SlipState> states) {
    const int limit = 50 + 4 * static_cast<int>(equations_.nodes());
    for (int k = 1; k <= limit; ++k) {
      bool full_rank = true;
      const Vector y = equations_.solve(states, full_rank);
      const Values values = equations_.evaluate(y);
      const Verdict verdict = Judge(equations_, values, states).all();
      const double residual = relative(verdict.violation, values.largest);
      const auto now = [&] { return Candidate{y, states, residual, full_rank}; };
      if (best_.y.size() == 0 || residual < best_.residual) best_ = now();
      std::vector<Index> changes = beyond(verdict, 0);
      if (changes.empty())
        return finish(now(), k, true, reason("the states have settled", residual));
      if (!choose(states, verdict, changes)) {
        if (!changes.empty()) return alternating(k);
        return finish(now(), k, residual <= coarse,
                      reason("the states alternate, at nodes that are nearer to the edge of their "
                             "law than the residual",
                             residual));
      }
      for (const Index j : changes)
        states[at(j)] = verdict.next[at(j)];
    }
    return alternating(limit);
  }

  std::vector<SlipState> first_states() const {
    const std::vector<SlipState> open(at(equations_.nodes()));
    const Values values = equations_.evaluate(Vector::Zero(equations_.modes()));
    return Judge(equations_, values, open).all().next;
  }

  /// As the solver would write them.
  std::vector<SlipState> usual(std::vector<SlipState> states) const {
    for (Index j = 0; j < equations_.nodes(); ++j) {
      SlipState &state = states[at(j)];
      const bool together = state.state != NodeState::open;
      state.direction = std::clamp(state.direction, -1, 1);
      if (!equations_.law(j).carries_traction(together) || state.state == NodeState::stick)
        state.direction = 0;
      if (!together) continue;
      if (!equations_.law(j).carries_traction(true))
        state.state = NodeState::slip;
      else if (state.direction == 0)
        state.state = NodeState::stick;
    }
    return states;
  }

private:
  struct Candidate {
    Vector y;
    std::vector<SlipState> states;
    double residual = 0;
    bool full_rank = true;
  };

  double relative(double violation, double largest) const {
    if (violation == 0) return 0;
    return violation / (largest > 0 ? largest : equations_.largest_load());
  }

  static std::vector<Index> beyond(const Verdict &verdict, double size) {
    std::vector<Index> result;
    for (Index j = 0; j < verdict.change.size(); ++j)
      if (verdict.change[j] > size) result.push_back(j);
    return result;
  }

  /// The changes to make now; false: none is left (empty), or the states are where they have been.
  bool choose(const std::vector<SlipState> &states, const Verdict &verdict,
              std::vector<Index> &changes) {
    std::string key;
    for (const SlipState &s : states)
      key.push_back(static_cast<char>(static_cast<int>(s.state) + 4 * (s.direction + 1)));
    if (policy_.after(key, changes.size()) == pivoting::Exchange::block) return true;
    changes = beyond(verdict, verdict.misfit);
    if (changes.empty()) return false;
    changes.erase(changes.begin() + 1, changes.end());
    return visited_alone_.insert(key).second;
  }

  static std::string reason(const std::string &what, double residual) {
    if (residual <= coarse) return what;
    return what + ", with a violation of " + short_number(residual) + remedy();
  }
  static std::string remedy() {
    return " of the largest multiplier: add modes or collocation nodes, or start from the states "
           "of a problem that is closer";
  }

  LeastSquaresResult alternating(int iterations) {
    const bool converged = best_.residual <= 1e-6;
    return finish(best_, iterations, converged,
                  "the states alternate, with a violation of " + short_number(best_.residual) +
                      (converged ? " of the largest multiplier" : remedy()));
  }

  static LeastSquaresResult finish(Candidate candidate, int iterations, bool converged,
                                   std::string reason) {
    if (!candidate.full_rank)
      reason += "; the equations do not determine all modes: add collocation nodes";
    return {.y = std::move(candidate.y),
            .states = std::move(candidate.states),
            .iterations = iterations,
            .residual = candidate.residual,
            .converged = converged,
            .reason = std::move(reason)};
  }

  Equations equations_;
  Candidate best_;
  pivoting::Policy<std::string, std::size_t> policy_{/*patience=*/11};
  std::set<std::string> visited_alone_; ///< from where a single node was changed
};

void check(const LeastSquaresProblem &p, const std::vector<SlipState> &start) {
  const Index nodes = p.gap.size(), modes = p.normal.cols();
  for (const Matrix *rows : {&p.normal, &p.tangential, &p.gap_rows, &p.slip_rows}) {
    if (rows->rows() != nodes || rows->cols() != modes)
      throw failure("least squares: a matrix is " + std::to_string(rows->rows()) + " x " +
                    std::to_string(rows->cols()) + " instead of " + std::to_string(nodes) + " x " +
                    std::to_string(modes));
    if (!rows->allFinite()) throw failure("least squares: a matrix is not finite");
  }
  for (const Vector *vector : {&p.slip, &p.gap_scale, &p.slip_scale})
    if (vector->size() != nodes)
      throw failure("least squares: a vector has " + std::to_string(vector->size()) +
                    " entries instead of " + std::to_string(nodes));
  if (!p.gap.allFinite() || !p.slip.allFinite())
    throw failure("least squares: the right-hand side is not finite");
  for (const Vector *scale : {&p.gap_scale, &p.slip_scale})
    if (!scale->allFinite() || !(scale->array() > 0).all())
      throw failure("least squares: the diagonal of H is not positive");
  if (2 * nodes < modes)
    throw failure("least squares: " + std::to_string(2 * nodes) + " equations for " +
                  std::to_string(modes) + " modes: add collocation nodes");
  if (!start.empty() && start.size() != at(nodes))
    throw failure("least squares: the first guess has " + std::to_string(start.size()) +
                  " states instead of " + std::to_string(nodes));
  bounds_per_node(p.bounds, nodes);
}

} // namespace

LeastSquaresResult solve_least_squares(const LeastSquaresProblem &problem,
                                       const std::vector<SlipState> &start) {
  check(problem, start);
  LeastSquaresSolver solver(problem);
  return solver.run(start.empty() ? solver.first_states() : solver.usual(start));
}

} // namespace rbvi
