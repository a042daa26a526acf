// What outputs of a scene's own are made of: sums over straight lines of expressions in fields. A
// part of a line on which a condition holds ends inside it, so that its measure is continuous in
// mu.
#pragma once

#include "rbvi/core/formula.hpp"
#include "rbvi/core/scene.hpp"

#include <algorithm>
#include <limits>

namespace rbvi {

struct OutputSums {
  double measure = 0, integral = 0;
  double least = std::numeric_limits<double>::infinity(), largest = -least;
};

/// One output at one mu, over many lines.
class OutputLines {
public:
  OutputLines(const OutputForm &form, const FullMu &mu) : form_(form), mu_(mu) {}

  /// Adds a line, s in [0, 1]: fields(s) along it; weight(fields) is what its measure is weighted
  /// by.
  template <class Fields, class Weight> void add(const Fields &fields, const Weight &weight) {
    parts(fields, [&](double from, double to) {
      for (const auto &[s, share] : gauss) {
        const OutputFields at = fields(from + (to - from) * s);
        const double weighted = (to - from) * share * weight(at);
        sums_.measure += weighted;
        sums_.integral += weighted * value(at)[0];
      }
      for (const double s : {from, (from + to) / 2, to}) {
        const double found = value(fields(s))[0];
        sums_.least = std::min(sums_.least, found);
        sums_.largest = std::max(sums_.largest, found);
      }
    });
  }

  const OutputSums &sums() const { return sums_; }

private:
  struct GaussPoint {
    double s, weight;
  };
  /// Exact to degree 5.
  static constexpr double away = 0.38729833462074168852; // sqrt(0.15)
  static constexpr std::array<GaussPoint, 3> gauss{
      {{0.5 - away, 5.0 / 18}, {0.5, 8.0 / 18}, {0.5 + away, 5.0 / 18}}};

  /// Value and condition.
  std::array<double, 2> value(const OutputFields &fields) const {
    std::array<double, 2> result{0, 1};
    form_.values(mu_, fields.data(), result.data());
    return result;
  }

  /// Calls use(from, to) for the parts on which the condition holds.
  template <class Fields, class Use> void parts(const Fields &fields, const Use &use) const {
    if (!form_.conditional) return use(0.0, 1.0);
    constexpr int samples = 8; // crossings closer to each other than that are not seen
    const auto holds = [&](double s) { return value(fields(s))[1] != 0; };
    bool held = holds(0);
    double from = 0;
    for (int k = 1; k <= samples; ++k) {
      double low = double(k - 1) / samples, high = double(k) / samples;
      if (holds(high) == held) continue;
      for (int step = 0; step < 50; ++step) {
        const double middle = (low + high) / 2;
        (holds(middle) == held ? low : high) = middle;
      }
      const double crossing = (low + high) / 2;
      if (held) use(from, crossing);
      from = crossing;
      held = !held;
    }
    if (held) use(from, 1.0);
  }

  const OutputForm &form_;
  const FullMu &mu_;
  OutputSums sums_;
};

/// Of so many mirror images; not finite over nothing.
double output_value(const OutputForm &form, const OutputSums &sums, double images);

} // namespace rbvi
