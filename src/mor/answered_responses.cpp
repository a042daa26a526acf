#include "rbvi/mor/answered_responses.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/model/free_bodies.hpp"
#include "rbvi/model/law_solver.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/small_svd.hpp"
#include "rbvi/par/turns.hpp"
#include "rbvi/solve/response_solver.hpp"

#include <Eigen/Cholesky>

namespace rbvi {

namespace {

constexpr std::size_t at_a_time = 100, most_queries = 10000; ///< queries

/// The multipliers of the loads at each mu, zero where the law has no answer. Collective.
Matrix answers_at(const Problem &problem, const CondensedLoads &loads, const ReducedModel &model,
                  QueryMethod &solver, const std::vector<Mu> &set) {
  Matrix answers = Matrix::Zero(loads.columns.cols(), std::ssize(set));
  take_turns(problem.comm(), set.size(), [&](std::size_t p) {
    try {
      const Scene &scene = problem.scene();
      const ReducedAnswer answer =
          solve_balanced(solver, model, scene, expand(scene.parameters, set[p]));
      answers.col(p) =
          !loads.units.empty() ? answer.reaction : Vector(answer.theta_b[0] * answer.lambda);
    } catch (const Error &) { // the self-check tells of such mu
    }
  });
  over_ranks(problem.comm(), MPI_SUM, answers);
  return answers;
}

} // namespace

bool awaits_answers(const Problem &problem, const CondensedLoads &loads,
                    const CondensedOptions &options) {
  const double numbers = static_cast<double>(loads.joining()) * problem.dofs().total_free;
  return (!loads.units.empty() || loads.join) && constant_stiffness(problem.scene()) &&
         options.responses > 0 && numbers > options.large_fields;
}

ResponseDirections::ResponseDirections(const Matrix &compliance) {
  root_ = (compliance + compliance.transpose()) / 2;
  if (!cholesky_in_place(root_))
    throw failure("the responses of the body to its contact loads are dependent: use "
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

int append_answered_responses(Problem &problem, const CondensedLoads &loads,
                              const ReducedModel &model, double tolerance, LinearBasis &modes) {
  const CondensedOperator &condensed = model.contact.law->condensed;
  const Index size = loads.columns.cols();
  ResponseDirections directions((condensed.terms * condensed.shape).reshaped(size, size));
  std::vector<Mu> set;
  for (const auto &training : model.contact.law->starts_mu.colwise())
    set.emplace_back(training.begin(), training.end());
  const Mu any = set.front();
  const auto solver = law_solver(model, problem.scene(), problem.contact());
  Matrix answers = answers_at(problem, loads, model, *solver, set);
  if (answers.isZero(0)) throw failure("the law of contact has no answer at any training mu");
  ParameterReader random(problem.scene().parameters,
                         "random:" + std::to_string(most_queries) + ":29");
  // A part of the tolerance each: for what is not taken, what comes between answers, what the few
  // directions leave.
  constexpr double not_taken = 0.1, between = 0.5, of_few = 0.4;
  do {
    directions.add(answers, not_taken * tolerance);
    set.clear();
    for (std::optional<Mu> mu; set.size() < at_a_time && (mu = random.next());)
      set.push_back(*mu);
    if (set.empty())
      throw failure("the responses to the answers of the law go on after " +
                    std::to_string(most_queries) +
                    " of them: use a smaller box, or -response_tolerance 0");
    answers = answers_at(problem, loads, model, *solver, set);
  } while (directions.left(answers) > between * tolerance);
  ResponseSolver body(problem.assemble(any).a, problem.trace(), "hf_");
  constexpr double dependent = 1e-9; // of a response's own norm: the modes hold it
  return static_cast<int>(append_fields(body,
                                        loads.columns * directions.coefficients(of_few * tolerance),
                                        modes, dependent, nullptr)
                              .size());
}

} // namespace rbvi
