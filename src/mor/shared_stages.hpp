// Stages that several reductions have, and the reductions.
#pragma once

#include "rbvi/mor/reduction.hpp"

namespace rbvi {

/// Separation of the operators, made by `separates`, and POD.
std::vector<ReductionStage> first_stages(const Scene &scene, void (*separates)(Reducing &));
/// All rows of B in one.
void separate_jointly(Reducing &at);

/// The nodal dual basis of the law at nodes, made when it is first asked for; condensed of the
/// nodes near contact. Collective.
const Matrix &nodal_dual_of(Reducing &at);
/// The condensed operator on it.
ReductionStage condensation_stage();
/// The supremizers of a pair of spaces.
void add_supremizer_stages(const ReduceOptions &options, std::vector<ReductionStage> &list);

/// Projection, made by `projects`; before it a word where the scene has no friction.
void add_projection(const Scene &scene, void (*projects)(Reducing &),
                    std::vector<ReductionStage> &list);
void project_bases(Reducing &at);
/// With the answers at the training parameters, where a query starts from.
void project_law(Reducing &at);
/// What answers with bounds need, where it is wanted; behind the last projection.
void add_bounds(const ReduceOptions &options, std::vector<ReductionStage> &list);
ReductionStage self_check_stage();

/// Whether some term has no coefficient of its own.
bool has_mapped_terms(const Sum &sum);

/// The parameter at which A is the product of supremizers, and of the hybrid cone.
Mu reference_of(const Problem &problem, const ReduceOptions &options);

/// What the pair of spaces needs in memory until it has its supremizers, numbers.
double generators_of(const ReductionSize &size);
/// Functions of the multipliers, and as many supremizers unless none are wanted.
Joining supremizers_join(const Scene &scene, const ReduceOptions &options,
                         const ReductionSize &size);

inline constexpr StageName pair_stages("cone, PGA");

extern const ReductionWay cone_way, condensed_way, nitsche_way;

} // namespace rbvi
