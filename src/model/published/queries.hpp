// The solvers of published variants.
#pragma once

#include "rbvi/model/law_solver.hpp"
#include "rbvi/model/nitsche_solver.hpp"

namespace rbvi {

std::unique_ptr<QueryMethod> collocated_solver(const ReducedModel &model, const Scene &scene,
                                               const Contact &contact, const QueryOptions &options);
std::unique_ptr<InterpolatedCurve> interpolated_curve(const ReducedModel &model,
                                                      const NitscheLayer &layer);

} // namespace rbvi
