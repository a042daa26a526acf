#include "rbvi/core/extremes.hpp"

#include <algorithm>

namespace rbvi {

std::vector<Mu> extremes_of_box(const ParameterSpace &space) {
  constexpr int bits = 5; // of the number of a corner; further parameters follow the first ones
  const int size = space.size();
  Mu centre;
  for (int i = 0; i < size; ++i)
    centre.push_back((space.at(i).lower + space.at(i).upper) / 2);
  std::vector<Mu> set;
  const auto move = [&](int i, bool up) {
    set.back()[static_cast<std::size_t>(i)] = up ? space.at(i).upper : space.at(i).lower;
  };
  for (int corner = 0; corner < 1 << std::min(size, bits); ++corner) {
    set.push_back(centre);
    for (int i = 0; i < size; ++i)
      move(i, (corner >> i % bits) % 2 != i / bits % 2);
  }
  for (int i = 0; i < size && size > 1; ++i)
    for (const bool up : {false, true}) {
      set.push_back(centre);
      move(i, up);
    }
  return set;
}

} // namespace rbvi
