// Queries by the law of contact and friction at the nodes: the condensed operator and the gap at
// mu, the law, then the displacement in V_N by A_N u = F_N - B_N^T x. At every node by
// friction_answer; where contact follows the displacement, linearised at the states of
// method/nonlinear.hpp, the body answering by its compliance on the contact dofs, so that the
// multipliers are those of the full problem. Where the self-check met another answer to the law at
// all nodes, every query is solved by the rule of the high-fidelity solver and looks for others.
#pragma once

#include "rbvi/core/variants.hpp"
#include "rbvi/model/answer.hpp"
#include "rbvi/model/model.hpp"

#include <memory>

namespace rbvi {

struct Contact;

/// Whether the self-check met another answer at some parameter: its distance
/// (ReducedAnswer::to_other) and the parameter are the history "self_check/other".
bool has_several_answers(const ReducedModel &model);

using LawSolverMaker = std::unique_ptr<QueryMethod> (*)(const ReducedModel &, const Scene &,
                                                        const Contact &, const QueryOptions &);
/// The laws on fewer functions than nodes.
std::map<MultiplierReduction, LawSolverMaker> &law_solvers();

/// All must outlive it. Throws bad_input where they do not fit. Its answers throw failure, saying
/// what to try, if the law is not met to 1e-8.
std::unique_ptr<QueryMethod> law_solver(const ReducedModel &model, const Scene &scene,
                                        const Contact &contact, const QueryOptions &options = {});

} // namespace rbvi
