#include "uses.hpp"

#include <algorithm>

namespace rbvi {

const Use *unmet(const Use &use, const OfflineOptions &options) {
  if (use.within != nullptr)
    if (const Use *outer = unmet(*use.within, options)) return outer;
  return use.in(options) ? nullptr : &use;
}

namespace {

template <FrictionLaw law> bool has_law(const OfflineOptions &options) {
  return std::ranges::any_of(options.scene.contacts,
                             [](const ContactRecipe &c) { return c.friction == law; });
}

bool has_online_method(const OfflineOptions &options) {
  switch (options.online_method) {
  case OnlineMethod::exact:
    return true;
  case OnlineMethod::uzawa:
    return is_of(use::collocated, options);
  case OnlineMethod::kacanov:
    return is_of(use::following, options);
  case OnlineMethod::newton:
    return is_of(use::interpolated, options);
  }
  return false;
}

} // namespace

namespace use {

const Use friction{nullptr, [](const OfflineOptions &o) { return has_friction(o.scene); },
                   "contact with friction, which this scene has not: leave out -friction none"};
const Use tresca{nullptr, has_law<FrictionLaw::tresca>, "-friction tresca"};

const Use multipliers{nullptr, [](const OfflineOptions &o) { return has_multipliers(o.scene); },
                      "the mixed formulation: Nitsche's method has no multipliers"};
const Use active_set{&multipliers,
                     [](const OfflineOptions &o) { return o.hf.method == HfMethod::active_set; },
                     "-hf_method active_set"};
const Use uzawa{&multipliers,
                [](const OfflineOptions &o) { return o.hf.method == HfMethod::uzawa; },
                "-hf_method uzawa"};
const Use following{&multipliers, [](const OfflineOptions &o) { return follows_state(o.scene); },
                    "contact that follows the displacement: set -kinematics large"};

const Use dual_basis{&multipliers,
                     [](const OfflineOptions &o) {
                       return o.reduce.multipliers.reduction != MultiplierReduction::condensed;
                     },
                     "-multiplier_reduction cone or collocated"};
const Use law{&multipliers,
              [](const OfflineOptions &o) { return keeps_law(o.reduce.multipliers.reduction); },
              "-multiplier_reduction condensed or collocated"};
const Use hats{
    &multipliers,
    [](const OfflineOptions &o) { return is_of(law, o) || o.reduce.cone.type == ConeType::hybrid; },
    "hat functions, which this dual basis has none of: use -cone_type hybrid"};
const Use collocated{&multipliers,
                     [](const OfflineOptions &o) {
                       return o.reduce.multipliers.reduction == MultiplierReduction::collocated;
                     },
                     "-multiplier_reduction collocated"};
const Use rows_apart{&collocated,
                     [](const OfflineOptions &o) { return o.scene.contacts.size() == 1; },
                     "a single contact interface: use -eim_tolerance"};
const Use tangential_rows{&rows_apart, friction.in, friction.is_for};

const Use nitsche{nullptr, [](const OfflineOptions &o) { return !is_of(multipliers, o); },
                  "Nitsche's method: set -formulation nitsche"};
const Use coulomb_terms{&nitsche, has_law<FrictionLaw::coulomb>,
                        "Coulomb's friction: set -friction coulomb"};
const Use empirical{
    &nitsche, [](const OfflineOptions &o) { return o.reduce.curve.rule == CurveRule::empirical; },
    "-nitsche_quadrature empirical"};
const Use interpolated{
    &nitsche,
    [](const OfflineOptions &o) { return o.reduce.curve.rule == CurveRule::interpolated; },
    "-nitsche_quadrature interpolated"};

const Use online{nullptr, has_online_method,
                 "-multiplier_reduction collocated (uzawa), for contact with multipliers that "
                 "follows the displacement (kacanov), or for -nitsche_quadrature interpolated "
                 "(newton)"};
const Use not_exact{
    nullptr, [](const OfflineOptions &o) { return o.online_method != OnlineMethod::exact; }, ""};

} // namespace use

} // namespace rbvi
