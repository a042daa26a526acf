#include "rbvi/contact/pair/contact_pair.hpp"

namespace rbvi {

namespace {

constexpr double round_off = 1e-9; ///< of the weight of a multiplier

} // namespace

bool is_partial(double weight, double whole) {
  return !(weight > (1 - round_off) * whole);
}

double ends_in_contact(const Vector &whole, const Vector &weights, const Vector &lambda,
                       double least, std::array<bool, 2> closed) {
  const Index count = whole.size();
  const auto carries_from = [&](Index first, Index step) {
    Index row = first;
    while (row >= 0 && row < count && !(weights[row] > round_off * whole[row]))
      row += step;
    if ((row == first && closed[step > 0 ? 0 : 1]) || row < 0 || row >= count) return false;
    do {
      if (lambda[row] > least) return true;
      row += step;
    } while (row >= 0 && row < count && is_partial(weights[row], whole[row]));
    return false;
  };
  return (carries_from(0, 1) ? 1.0 : 0.0) + (carries_from(count - 1, -1) ? 1.0 : 0.0);
}

} // namespace rbvi
