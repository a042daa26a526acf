// Queries of models with bodies that contact alone holds (fem/free_motions.hpp): what their springs
// are relaxed at is found such that forces balance, from what the training samples predict.
#pragma once

#include "rbvi/method/node_laws.hpp"
#include "rbvi/model/answer.hpp"
#include "rbvi/model/reduced_body.hpp"

namespace rbvi {

/// What holds the free motions, n x k, at an answer. `held`: FreeMotions::held; `laws`: of its
/// rows.
FreeMotions free_motions_at(const BodyAtMu &body, const Matrix &motions, Matrix held,
                            NodeLaws laws);

/// That the springs add to the energy of an answer, relaxed at its beta.
double energy_of_springs(const ReducedModel &model, const Scene &scene,
                         const ReducedAnswer &answer);

/// Whether queries start from rest, by the rule of friction_answer: with friction forces may
/// balance in several answers, and this is the one of the full model.
bool rests_at_start(const ReducedModel &model, const Scene &scene);

/// As method.solve(), with the springs relaxed. Throws failure where forces do not balance, or
/// where nothing holds a motion at the answer.
ReducedAnswer solve_balanced(QueryMethod &method, const ReducedModel &model, const Scene &scene,
                             const FullMu &mu);

} // namespace rbvi
