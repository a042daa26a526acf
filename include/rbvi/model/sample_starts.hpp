// Where a query starts, told by mu and the model alone: what the answer at the nearest training
// parameter leaves. That answer starts from rest, is found when first asked for, and kept.
#pragma once

#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"

#include <optional>
#include <vector>

namespace rbvi {

template <class Start> class SampleStarts {
public:
  /// `samples`: free parameters x samples; there may be none.
  SampleStarts(const ParameterSpace &space, const Matrix &samples)
      : points_(parts_of_box(space, samples)), starts_(samples.cols()) {}
  /// `here`: as parts of the box. `from_rest(k)`: what the answer at sample k leaves; where that
  /// throws failure, and where there are no samples, a query starts from rest: Start{}.
  template <class FromRest> const Start &nearest(const Vector &here, FromRest &&from_rest) {
    if (starts_.empty()) return rest_;
    Index k = 0;
    (points_.colwise() - here).colwise().squaredNorm().minCoeff(&k);
    std::optional<Start> &start = starts_[k];
    if (!start) {
      start.emplace();
      try {
        *start = from_rest(k);
      } catch (const Error &) { // has no answer
      }
    }
    return *start;
  }

private:
  Matrix points_;
  std::vector<std::optional<Start>> starts_;
  const Start rest_{};
};

} // namespace rbvi
