// A reduction as a list of stages: the plan, the report at its end, the memory and the time that
// are foreseen, the refusal of what does not fit, and reduce() read this list. Each way to reduce
// the multipliers is a file of mor with its list: pair_reduction.cpp, condensed_reduction.cpp,
// nitsche_reduction.cpp, published/collocated_reduction.cpp.
#pragma once

#include "rbvi/mor/reduce.hpp"

#include <functional>

namespace rbvi {

/// What stages work on, and what they leave for each other.
struct Reducing {
  Problem &problem;
  const std::vector<Sample> &samples;
  ReduceOptions options;
  Reduction &made;
  Matrix multipliers{};    ///< of the samples, as columns; by Nitsche's method none
  Handle<Mat> stiffness{}; ///< at the reference parameter, where it is the product of supremizers
  RieszSpace riesz{};
  Matrix dual{};                        ///< orthonormal functions that span the dual space
  std::vector<ContactPoint> training{}; ///< of the supremizers
  bool basis_changed = false;           ///< and is projected again
  int unanswered = 0;                   ///< queries of the self-check
  bool met = true;                      ///< the others, to round-off
};

/// What memory and time are foreseen from; numbers, all of them.
struct ReductionSize {
  double samples, dofs, contact, multipliers; ///< contact: dofs of the contact region
  double ranks;
  double axes, points, square;  ///< of the condensed operator: of its grid, entries of a term
  double entries, factor;       ///< of A, of its factor
  double loads;                 ///< of the condensed operator, each a column of A^-1
  double factorisation;         ///< seconds
  double of_a, of_f, of_b;      ///< samples of A and F, numbers of those of B
  double terms = 1;             ///< of A
  double joined = 0, modes = 0; ///< functions that join the modes; with them
  double model = 0;             ///< of the reduced model
  double self_check = 0;        ///< seconds
  /// Responses to so many loads, shared among the ranks.
  double responses(double count) const;
};

/// Numbers that each rank holds in a stage, and the first one; seconds, right to a factor of two or
/// so on the processors that they were measured on.
struct StageNeed {
  double numbers = 0, on_first = numbers, seconds = 0;
};

inline constexpr double column_seconds = 2e-10;   ///< for an entry of a factor, of many columns
inline constexpr double product_seconds = 2e-10;  ///< for a number times a number, in matrices
inline constexpr double span_factorisations = 60; ///< factorisations that responses in a span take
inline constexpr double most_terms = 100;         ///< of the condensed operator; twice what A has
inline constexpr const char *fewer_samples =
    "fewer samples (-train) or a coarser mesh (-mesh_refine, -mesh)";
inline constexpr const char *coarser_hats =
    "fewer samples (-train), -cone_level where multipliers have hat functions, or a coarser mesh "
    "(-mesh_refine, -mesh)";

/// A stage of a reduction. It may stand a second time in a list, without a row, where it goes on.
struct ReductionStage {
  StageName name;
  /// What will be done (`made` null), or was. Null: it stands before.
  StageRow (*row)(const Scene &scene, const ReduceOptions &options, const Reduction *made);
  void (*run)(Reducing &at) = nullptr; ///< collective; null: nothing is to be done
  StageNeed (*need)(const ReductionSize &size) = nullptr;
  const char *smaller = coarser_hats; ///< what makes it smaller, for errors
};

/// Functions that join the modes, and the numbers that the model has besides, foreseen.
struct Joining {
  double functions = 0, stored = 0;
};

/// A way to reduce the multipliers.
struct ReductionWay {
  MultiplierReduction reduction;
  const char *name, *says; ///< a choice of -multiplier_reduction; "": it is none
  bool law;                ///< the law at nodes (NodalLaw), not a pair of spaces
  bool dual_basis;         ///< it has functions of the multipliers, and supremizers
  /// Throws bad_input for a scene or options that it is not for.
  void (*check)(const Scene &scene, const ReduceOptions &options);
  std::vector<ReductionStage> (*stages)(const Scene &scene, const ReduceOptions &options);
  Joining (*joining)(const Scene &scene, const ReduceOptions &options, const ReductionSize &size);
  /// Runs `attempt`, the stages behind the interpolation with at.options, until the self-check is
  /// content; null: once.
  void (*repeats)(Reducing &at, const std::function<void()> &attempt) = nullptr;
};

/// Those that add_reduction() entered come last.
const std::vector<ReductionWay> &reduction_ways();
/// Adds a way, unless it is there. To be called before options are read.
void add_reduction(const ReductionWay &way);
/// "auto", "cone", "condensed" and, where it was added, "collocated": in the order of
/// MultiplierReduction.
const std::vector<std::string> &multiplier_reduction_names();
/// Of a scene; `chosen` automatic: the one that suits it.
const ReductionWay &way_of(const Scene &scene, MultiplierReduction chosen);

/// The whole list for a scene.
std::vector<ReductionStage> stages_of(const Scene &scene, const ReduceOptions &options);
/// A reduction before its first stage, its stages declared. Throws failure where there is no
/// sample, or no contact in any; bad_input for options that do not fit the scene.
Reducing start_reducing(Problem &problem, const std::vector<Sample> &samples,
                        const ReduceOptions &options, Reduction &made);
/// Runs the stages of a list from the first of the name `from` on to the last before the first of
/// the name `until`, both empty: all of them. Collective.
void run_stages(const std::vector<ReductionStage> &list, Reducing &at, const char *from = "",
                const char *until = "");

} // namespace rbvi
