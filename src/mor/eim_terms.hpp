// Terms of an operator from the snapshots that they combine.
#pragma once

#include "rbvi/mor/eim.hpp"

#include <algorithm>

namespace rbvi {

/// Adds a snapshot's projection to every term that contains it: a column each.
template <class Terms>
void accumulate(const Eim &eim, int snapshot, const Vector &projected, Terms &&terms) {
  for (int i = 0; i < eim.size(); ++i)
    if (eim.snapshots[i] == snapshot)
      for (int j = i; j < eim.size(); ++j)
        terms.col(j) += eim.combination(i, j) * projected;
}

inline bool uses(const Eim &eim, int snapshot) {
  return std::find(eim.snapshots.begin(), eim.snapshots.end(), snapshot) != eim.snapshots.end();
}

} // namespace rbvi
