#include "friction_laws.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi::friction {

bool jump(const NodeLaws &laws) {
  for (Index i = 0; i < laws.nodes(); ++i)
    if (laws.friction_at(i).jumps()) return true;
  return false;
}

double steepest(const NodeLaws &laws) {
  double result = 0;
  for (Index i = 0; i < laws.nodes(); ++i)
    result = std::max(result, laws.friction_at(i).steepest());
  return result;
}

int steps_to(double steepest) {
  constexpr double longest = 0.25;
  return std::max(1, static_cast<int>(std::ceil(steepest / longest)));
}

NodeLaws with_slopes(NodeLaws laws, double part) {
  for (FrictionBound &law : laws.bound)
    law = law.with_slopes(part);
  return laws;
}

NodeLaws with_thresholds(NodeLaws laws, double factor) {
  for (FrictionBound &law : laws.bound)
    law = law.with_threshold(factor);
  return laws;
}

std::vector<char> jumped(const NodeLaws &laws, const Vector &x) {
  std::vector<char> result(laws.nodes());
  for (Index i = 0; i < laws.nodes(); ++i)
    result[i] = x[laws.normal[i]] > 0 && laws.friction_at(i).jumps() ? 1 : 0;
  return result;
}

NodeLaws without_jump(NodeLaws laws, const std::vector<char> &jumped) {
  for (Index i = 0; i < laws.nodes(); ++i) {
    FrictionBound &law = laws.bound[i];
    if (law.jumps()) law = law.with_threshold(jumped[i]);
    law.only_in_contact = false;
  }
  return laws;
}

NodeLaws frozen(NodeLaws laws, const Vector &bounds) {
  for (Index i = 0; i < laws.nodes(); ++i)
    laws.bound[i] = {.threshold = bounds[i]};
  return laws;
}

void describe(FrictionResult &result, const NodeLaws &laws, const ActiveSets &sets) {
  result.active.clear();
  result.states.assign(laws.nodes(), NodeState::open);
  for (Index i = 0; i < laws.nodes(); ++i) {
    if (!(result.x[laws.normal[i]] > 0)) continue;
    result.active.push_back(i);
    result.states[i] = sets.tangent_at(i) == Tangent::stick ? NodeState::stick : NodeState::slip;
  }
}

std::string reason_of(Outcome outcome, int max_iterations, int backup_steps, long undecided) {
  if (outcome == Outcome::converged) return "every condition of contact holds";
  if (outcome == Outcome::indefinite)
    return "the block of H of the nodes in contact is not positive definite: dependent "
           "constraints or an inexact H";
  if (undecided > 0)
    return "a threshold that acts in contact alone jumps where a node leaves contact: without it "
           "more nodes touch than with it (" +
           std::to_string(undecided) +
           " here), and neither is an answer; let it act everywhere (bound: everywhere), or ask "
           "nearby";
  const std::string after = " after " + std::to_string(max_iterations) + " steps: ";
  const std::string remedy = "start closer to the solution (a smaller change of the load or of "
                             "the coefficient of friction)";
  if (backup_steps == 0)
    return "the laws of friction are still violated" + after + "raise the limit, or " + remedy;
  return "neither Newton's method nor the fixed point of the friction bounds has settled" + after +
         remedy + ", lower the coefficient, or raise the limit";
}

Vector smooth_start(const Vector &diagonal, const NodeLaws &laws, const State &point) {
  Vector result = diagonal;
  for (Index i = 0; laws.tangents == 2 && i < laws.nodes(); ++i)
    if (laws.has_tangent(i)) {
      const double mean = tangential_diagonal(result, laws, i);
      result.segment(laws.tangent[i], 2).setConstant(mean);
    }
  const Index known = (result.array() > 0).count();
  const double mean = known > 0 ? result.sum() / static_cast<double>(known) : 1;
  for (Index j = 0; j < result.size(); ++j)
    result[j] = point.x[j] - point.w[j] / (result[j] > 0 ? result[j] : mean);
  return result;
}

} // namespace rbvi::friction
