// What a new model does not answer, before a user finds out.
#pragma once

#include "rbvi/model/online.hpp"

#include <functional>

namespace rbvi {

/// Random ones: 200, fewer (at least 20) of a model of more than 500 functions, whose queries take
/// long.
int queries_of_check(const ReducedModel &model);

/// These, and corners and faces of the box.
std::vector<Mu> parameters_of_check(const ReducedModel &model);

/// Told, before each query, how many were asked, of how many.
using QueriesAsked = std::function<void(int done, int all)>;

/// Asks `model` at so many random parameters of its box, the same on every machine, and at its
/// corners and faces (corners_and_faces), and collects what SelfCheck holds. Costs so many queries
/// without the outputs of the scene; `asked` is told of each. Throws bad_input where model, scene
/// and options do not fit.
SelfCheck self_check(const ReducedModel &model, const Scene &scene, int queries,
                     QueryOptions options = {}, const QueriesAsked &asked = {});

/// "200 random queries and 14 at corners and faces, all answered; largest residual 3e-14
/// (radius=0.8), ...": lines for people; says what to do where it is not clean.
void print_self_check(std::ostream &out, const SelfCheck &check, const ParameterSpace &space);

} // namespace rbvi
