// Ranges of validity: where a scene makes sense, beside the box that a reduced model is made for.
#pragma once

#include "rbvi/core/scene.hpp"

namespace rbvi {

/// "[0.02, 0.38]"; of an infinite end "at least 0", "at most 1"; "any number".
std::string describe(const Range &range);

/// Throws bad_input unless `value` is in the range; `what` begins the message: "option -young".
void check_range(const Range &range, double value, const std::string &what);

/// Throws bad_input where a coefficient of a contact interface is not finite, naming the interface
/// by its boundary or region. `all`: the values of all parameters.
void check_contacts(const Scene &scene, const FullMu &all);

/// Throws bad_input where parameters that are valid one by one make no sense together, or where a
/// coefficient of a, f, an imposed displacement or a contact interface is not finite.
void check_together(const Scene &scene, const FullMu &all);

/// Throws bad_input where such a coefficient is not finite at one of these, free parameters.
void check_set(const Scene &scene, const std::vector<Mu> &set);

/// Throws bad_input unless mu (the free parameters) is in the box, or with `allow_outside` in the
/// range of validity, and where a coefficient of a contact interface is not finite.
void check_query(const Scene &scene, const Mu &mu, bool allow_outside);

/// Throws bad_input if the box of a free parameter, the value of a fixed one, or a corner of the
/// box leaves the range of validity.
void check_box(const Scene &scene);

} // namespace rbvi
