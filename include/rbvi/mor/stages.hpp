// The stages of `reduce`, declared once: their names, and which of them run for a scene.
#pragma once

#include "rbvi/mor/reduce.hpp"

namespace rbvi {

namespace stage {
inline constexpr StageName interpolation("interpolation"), pod("POD"), condensation("condensation"),
    cone("cone"), multipliers("multipliers"), riesz("Riesz representers"),
    infsup_tolerance("inf-sup tolerance"), pga("PGA"), contact_curve("contact curve"),
    collocation("collocation nodes"), projection("projection"), self_check("self-check");
} // namespace stage

/// One row per stage. `made` null: the plan, in which what hangs on the separation of the operators
/// is said as a condition; else what was done, without the seconds.
StageTable reduction_stages(const Scene &scene, const ReduceOptions &options,
                            const Reduction *made = nullptr);

} // namespace rbvi
