// What solvers with friction ask of the laws of all nodes, and the laws on the way to them.
#pragma once

#include "friction_newton.hpp"

namespace rbvi::friction {

bool jump(const NodeLaws &laws);       ///< whether a bound jumps where contact begins
double steepest(const NodeLaws &laws); ///< the largest slope of a bound
/// Steps in which slopes grow from zero, by at most 0.25 each, to `steepest` of them all.
int steps_to(double steepest);
/// The laws with slopes, or thresholds, times a factor.
NodeLaws with_slopes(NodeLaws laws, double part);
NodeLaws with_thresholds(NodeLaws laws, double factor);
/// The nodes whose bounds have jumped.
std::vector<char> jumped(const NodeLaws &laws, const Vector &x);
/// The laws with the thresholds of those nodes alone, whatever touches.
NodeLaws without_jump(NodeLaws laws, const std::vector<char> &jumped);
/// The laws with these bounds, which do not follow the pressure.
NodeLaws frozen(NodeLaws laws, const Vector &bounds);

/// Fills in the list of nodes in contact and the states of all nodes.
void describe(FrictionResult &result, const NodeLaws &laws, const ActiveSets &sets);

/// How a solver ended; known: not to be followed any further.
enum class Outcome { converged, known, cycles, indefinite, limit };
/// FrictionResult::reason. `undecided`: nodes that lift off with their thresholds and touch
/// without.
std::string reason_of(Outcome outcome, int max_iterations, int backup_steps, long undecided);

/// FrictionResult::start. `diagonal`: H_jj, 0: unknown.
Vector smooth_start(const Vector &diagonal, const NodeLaws &laws, const State &point);

} // namespace rbvi::friction
