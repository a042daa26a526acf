#include "rbvi/mor/answered_responses.hpp"

#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/free_bodies.hpp"
#include "rbvi/model/law_solver.hpp"
#include "rbvi/model/reduced_body.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/small_svd.hpp"
#include "rbvi/solve/response_solver.hpp"

#include <Eigen/Cholesky>

namespace rbvi {

namespace {

constexpr std::size_t at_a_time = 100, most_queries = 10000; ///< queries
constexpr int most_factorisations = 100;                     ///< for responses where A changes

// Parts of a tolerance, for what is not taken, what comes between answers, what few directions
// leave.
constexpr double not_taken = 0.1, between = 0.5, of_few = 0.4;

/// `part` of the answer at each mu, `size` numbers, zero where the law has none. Collective.
template <class Part>
Matrix parts_at(const Problem &problem, const ReducedModel &model, QueryMethod &solver,
                const std::vector<Mu> &set, Index size, Part &&part) {
  Matrix parts = Matrix::Zero(size, std::ssize(set));
  take_turns(problem.comm(), set.size(), [&](std::size_t p) {
    try {
      const Scene &scene = problem.scene();
      parts.col(static_cast<Index>(p)) =
          part(solve_balanced(solver, model, scene, expand(scene.parameters, set[p])));
    } catch (const Error &) { // the self-check tells of such mu
    }
  });
  over_ranks(problem.comm(), MPI_SUM, parts);
  return parts;
}

/// `part` of what the model answers at the training parameters, at corners and faces of the box and
/// at random ones, a hundred at a time, to `take`, until it returns false for some of these: there
/// was no more in them. False where the law has no answer at any of the first. Collective. Throws
/// failure where there are always new ones.
template <class Part, class Take>
bool take_answers(const Problem &problem, const ReducedModel &model, Index size, Part &&part,
                  Take &&take) {
  std::vector<Mu> set;
  for (const auto &training : model.contact.law->starts_mu.colwise())
    set.emplace_back(training.begin(), training.end());
  const std::vector<Mu> boundary = corners_and_faces(problem.scene().parameters);
  set.insert(set.end(), boundary.begin(), boundary.end());
  const auto solver = law_solver(model, problem.scene(), problem.contact());
  Matrix answers = parts_at(problem, model, *solver, set, size, part);
  if (answers.isZero(0)) return false;
  ParameterReader random(problem.scene().parameters,
                         "random:" + std::to_string(most_queries) + ":29");
  take(answers);
  do {
    set.clear();
    for (std::optional<Mu> mu; set.size() < at_a_time && (mu = random.next());)
      set.push_back(*mu);
    if (set.empty())
      throw failure(
          "displacements under the contact loads of further answers are still new after " +
          std::to_string(most_queries) + " answers: use a smaller box, or -response_tolerance 0");
    answers = parts_at(problem, model, *solver, set, size, part);
  } while (take(answers));
  return true;
}

} // namespace

bool responses_await(double loads, double dofs, bool varies, const CondensedOptions &options) {
  constexpr double many = 200; // where A changes: ten times as many functions to choose from
  return options.responses > 0 && (loads * dofs > options.large_fields || (varies && loads > many));
}

bool awaits_answers(const Problem &problem, const CondensedLoads &loads,
                    const CondensedOptions &options) {
  const Scene &scene = problem.scene();
  const bool varies = !parameters_beside_common(scene.a, scene.parameters).empty();
  return (!loads.units.empty() || loads.join) &&
         responses_await(static_cast<double>(loads.joining()), problem.dofs().total_free, varies,
                         options);
}

ResponseDirections::ResponseDirections(const Matrix &compliance) {
  root_ = (compliance + compliance.transpose()) / 2;
  if (!cholesky_in_place(root_))
    throw failure("the displacements under unit loads on the contact are dependent: use "
                  "-response_tolerance 0");
  root_.transposeInPlace();
}

namespace {

/// As many of the first singular vectors as leave at most this of every column.
Matrix leading_vectors(const Matrix &columns, double allowed) {
  const SmallSvd svd = small_svd(columns);
  const Matrix parts = svd.values.asDiagonal() * svd.right.transpose();
  Index count = 0;
  while (count < svd.values.size() &&
         parts.bottomRows(parts.rows() - count).colwise().norm().maxCoeff() > allowed)
    ++count;
  return svd.left.leftCols(count);
}

} // namespace

void ResponseDirections::add(const Matrix &answers, double tolerance) {
  const Matrix moved = root_.triangularView<Eigen::Upper>() * answers;
  largest_ = std::max(largest_, moved.colwise().norm().maxCoeff());
  constexpr double dependent = 0.5; // none is: they are orthonormal and beside the space
  space_.append(leading_vectors(space_.remainder(moved), tolerance * largest_), dependent);
  const Index before = parts_.cols(), known = parts_.rows(), size = space_.columns().cols();
  parts_.conservativeResize(size, before + moved.cols());
  parts_.bottomRows(size - known).setZero(); // add() has left them out
  parts_.rightCols(moved.cols()) = space_.coordinates(moved);
}

double ResponseDirections::left(const Matrix &answers) const {
  const Matrix moved = root_.triangularView<Eigen::Upper>() * answers;
  return space_.remainder(moved).colwise().norm().maxCoeff() / largest_;
}

Matrix ResponseDirections::coefficients(double tolerance) const {
  return solve_upper(root_, space_.columns() * leading_vectors(parts_, tolerance * largest_));
}

Matrix ResponseDirections::weighted_coefficients(double tolerance) const {
  const Matrix leading = leading_vectors(parts_, tolerance * largest_);
  const Vector sizes = (leading.transpose() * parts_).rowwise().lpNorm<Eigen::Infinity>();
  return solve_upper(root_, space_.columns() * leading * sizes.asDiagonal());
}

ResponseSpace append_answered_responses(Problem &problem, const CondensedLoads &loads,
                                        const ReducedModel &model, double tolerance,
                                        LinearBasis &modes) {
  const CondensedOperator &condensed = model.contact.law->condensed;
  const Index size = loads.columns.cols();
  // At the first point of the grid all functions but the first are zero.
  ResponseDirections directions((condensed.terms * condensed.shape.col(0)).reshaped(size, size));
  const Scene &scene = problem.scene();
  const bool scales = !constant_stiffness(scene);
  const auto multipliers = [&](const ReducedAnswer &answer) {
    const double softer = scales ? 1 / common_coefficient(scene.a, scene.parameters, answer.mu) : 1;
    return Vector(!loads.units.empty() ? softer * answer.reaction
                                       : softer * answer.theta_b[0] * answer.lambda);
  };
  const bool answered = take_answers(problem, model, size, multipliers, [&](const Matrix &answers) {
    if (directions.left(answers) <= between * tolerance) return false; // infinite before the first
    directions.add(answers, not_taken * tolerance);
    return true;
  });
  if (!answered) throw failure("the law of contact has no answer at any training mu");
  const Mu any(model.contact.law->starts_mu.col(0).begin(),
               model.contact.law->starts_mu.col(0).end());
  if (!condensed.grid.axes.empty()) {
    const ResponseSearch search{condensed.grid.axes, expand(scene.parameters, any), tolerance,
                                most_factorisations};
    return append_responses(problem, loads.columns,
                            directions.weighted_coefficients(of_few * tolerance), search, modes);
  }
  ResponseSolver body(problem.assemble(any).a, problem.trace(), "hf_");
  constexpr double dependent = 1e-9; // of a response's own norm: the modes hold it
  const auto appended = append_fields(
      body, loads.columns * directions.coefficients(of_few * tolerance), modes, dependent, nullptr);
  return {.points = 1, .functions = static_cast<int>(appended.size())};
}

namespace {

/// Each over its norm, but for those below a part of the largest so far.
Matrix relative_columns(const Matrix &columns, double &largest) {
  constexpr double small = 1e-2;
  const Eigen::RowVectorXd norms = columns.colwise().norm();
  largest = std::max(largest, norms.maxCoeff());
  if (largest == 0) return columns;
  return columns * norms.cwiseMax(small * largest).cwiseInverse().asDiagonal();
}

} // namespace

bool factorises_for_displacements(const Problem &problem, const ReducedModel &model) {
  constexpr Index cheap = 100; // functions: their factor takes less than the law
  const NodalLaw &law = *model.contact.law;
  return model.primal_size() > cheap && law.condensed.terms.size() > 0 && !law.on_functions() &&
         law.states.size() == 0 && model.body.a.size() > 2 && problem.free_bodies().empty();
}

Matrix answered_displacements(const Problem &problem, const ReducedModel &model) {
  const Index n = model.primal_size();
  const ReducedBody body(model, problem.scene());
  BodyAtMu at_mu(body);
  const bool loaded = at_mu.has_load();
  constexpr double dependent = 0.5; // none is: they are orthonormal and beside the space
  OrthonormalColumns space;
  space.append(Matrix::Identity(n, model.body.modes), dependent);
  const auto displacements = [&](const ReducedAnswer &answer) {
    if (!loaded) return answer.u;
    at_mu.set(answer.mu);
    Vector both(2 * n);
    both << answer.u, at_mu.response(at_mu.load());
    return both;
  };
  constexpr int most_times = 20; // of a hundred answers
  int times = 0;
  const auto is_worth_it = [&] {
    return 4 * space.columns().cols() < 3 * n && times <= most_times;
  };
  double largest = 0, largest_load = 0;
  const auto take = [&](const Matrix &answers) {
    Matrix parts = relative_columns(answers.topRows(n), largest);
    if (loaded) {
      parts.conservativeResize(Eigen::NoChange, 2 * answers.cols());
      parts.rightCols(answers.cols()) = displacement_tolerance / load_tolerance *
                                        relative_columns(answers.bottomRows(n), largest_load);
    }
    const Matrix rest = space.remainder(parts);
    if (rest.colwise().norm().maxCoeff() <= displacement_tolerance) return false;
    space.append(leading_vectors(rest, not_taken * displacement_tolerance), dependent);
    ++times;
    return is_worth_it();
  };
  const bool answered = take_answers(problem, model, loaded ? 2 * n : n, displacements, take);
  return answered && is_worth_it() ? space.columns() : Matrix();
}

} // namespace rbvi
