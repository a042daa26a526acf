// What options are for: the runs that they change.
#pragma once

#include "rbvi/tool/options.hpp"

namespace rbvi {

/// Runs of one kind. An option for these alone is refused on the command line of others.
struct Use {
  const Use *within; ///< of these alone; null: of all
  bool (*in)(const OfflineOptions &options);
  const char *is_for; ///< as the refusal says it: "-hf_method uzawa"
};

/// The outermost use that the run is not of; null: it is of all of them.
const Use *unmet(const Use &use, const OfflineOptions &options);
inline bool is_of(const Use &use, const OfflineOptions &options) {
  return unmet(use, options) == nullptr;
}

namespace use {

extern const Use friction, tresca;
/// Of the mixed formulation: its solvers, its iterations, and how its multipliers are reduced.
extern const Use multipliers, active_set, uzawa, following;
extern const Use dual_basis, law, hats, collocated, rows_apart, tangential_rows;
/// Of Nitsche's method, its terms, and its rules for the curve.
extern const Use nitsche, coulomb_terms, empirical, interpolated;
/// Of models that can be asked by -online_method, and whose method is not the default.
extern const Use online, not_exact;

} // namespace use

} // namespace rbvi
