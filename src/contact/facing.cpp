#include "rbvi/contact/facing.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

namespace rbvi {

void check_pressed_side(double cosine, const Point &x) {
  if (!(cosine > 0))
    throw failure(
        "contact through the body: it is pressed at (" + short_number(x[0]) + ", " +
        short_number(x[1]) +
        ") of its boundary from inside, as what it faces there lies behind it; move less, "
        "or pose contact on a shorter boundary");
}

} // namespace rbvi
