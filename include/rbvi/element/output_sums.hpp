// What outputs of a scene's own are made of: sums over straight lines of expressions in fields. A
// part of a line on which a condition holds ends inside it, so that its measure is continuous in
// mu. They are of the whole body: of the images of a line, too.
#pragma once

#include "rbvi/core/formula.hpp"
#include "rbvi/core/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace rbvi {

struct OutputSums {
  double measure = 0, integral = 0;
  double least = std::numeric_limits<double>::infinity(), largest = -least;
};

/// One output at one mu, over many lines.
class OutputLines {
public:
  OutputLines(const OutputForm &form, const FullMu &mu, const MirrorPlanes &mirrors)
      : form_(form), mu_(mu), mirrors_(mirrors) {}

  /// Adds so many lines, s in [0, 1]: fields(line, s) along each; weight(line, fields) is what its
  /// measure is weighted by.
  template <class Fields, class Weight>
  void add(std::size_t lines, const Fields &fields, const Weight &weight) {
    add(lines, fields, fields, weight);
  }
  /// The same where the condition sees other fields. Where nothing is faced, so that there is a
  /// pressure and no gap, what depends on the gap has no value and is left out.
  template <class Fields, class Seen, class Weight>
  void add(std::size_t lines, const Fields &fields, const Seen &seen, const Weight &weight) {
    for (int image = 0; image < image_count(mirrors_); ++image)
      with_image(image, lines, fields,
                 [&](const std::vector<std::size_t> &own, const auto &reflected) {
                   find_parts(own.size(), reflected(seen));
                   add_parts(reflected(fields), [&](std::size_t line, const OutputFields &at) {
                     return weight(own[line], at);
                   });
                 });
  }
  /// Of one image, lines that the condition holds all along.
  template <class Fields, class Weight>
  void add_whole(int image, std::size_t lines, const Fields &fields, const Weight &weight) {
    with_image(image, lines, fields,
               [&](const std::vector<std::size_t> &own, const auto &reflected) {
                 parts_.clear();
                 for (std::size_t line = 0; line < own.size(); ++line)
                   parts_.push_back({line, 0, 1});
                 add_parts(reflected(fields), [&](std::size_t line, const OutputFields &at) {
                   return weight(own[line], at);
                 });
               });
  }
  bool is_conditional() const { return form_.conditional; }
  int images() const { return image_count(mirrors_); }
  /// Whether the condition holds at the image of these fields.
  bool holds(int image, OutputFields fields) const {
    reflect(mirrors_, image, fields);
    std::array<double, 2> value_and_condition;
    form_.values(mu_, fields.data(), 1, value_and_condition.data());
    return value_and_condition[1] != 0;
  }

  /// The measure and the integral, or of a maximum and a minimum these.
  const OutputSums &sums() const { return sums_; }

  struct Place {
    double s, weight;
  };
  /// Where a line is asked: of a maximum and a minimum at ends and middle, else at Gauss points.
  const std::array<Place, 3> &places() const {
    const bool extreme = form_.kind == OutputForm::Kind::max || form_.kind == OutputForm::Kind::min;
    return extreme ? ends : gauss;
  }

private:
  /// add(lines that the image has, reflected), reflected(fields)(number of such a line, s).
  template <class Fields, class Add>
  void with_image(int image, std::size_t lines, const Fields &fields, const Add &add) {
    std::vector<std::size_t> own;
    for (std::size_t line = 0; line < lines; ++line)
      if (mirrors_.empty() || has_image(mirrors_, image, fields(line, 0), fields(line, 1)))
        own.push_back(line);
    add(own, [&](const auto &of) {
      return [&](std::size_t line, double s) {
        OutputFields at = of(own[line], s);
        reflect(mirrors_, image, at);
        return at;
      };
    });
  }

  template <class Fields, class Weight> void add_parts(const Fields &fields, const Weight &weight) {
    std::vector<double> weights(places().size() * parts_.size());
    std::vector<bool> open(weights.size());
    evaluate(weights.size(), [&](std::size_t i) {
      const auto &[line, from, to] = parts_[i / places().size()];
      const auto &[s, share] = places()[i % places().size()];
      const OutputFields at = fields(line, from + (to - from) * s);
      weights[i] = (to - from) * share * weight(line, at);
      open[i] = std::isnan(at[field::gap]) && !std::isnan(at[field::pressure]);
      return at;
    });
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (open[i] && std::isnan(results_[i])) continue;
      sums_.measure += weights[i];
      sums_.integral += weights[i] * results_[i];
      sums_.least = std::min(sums_.least, results_[i]);
      sums_.largest = std::max(sums_.largest, results_[i]);
    }
  }

  /// Exact to degree 5.
  static constexpr double away = 0.38729833462074168852; // sqrt(0.15)
  static constexpr std::array<Place, 3> gauss{
      {{0.5 - away, 5.0 / 18}, {0.5, 8.0 / 18}, {0.5 + away, 5.0 / 18}}},
      ends{{{0, 0}, {0.5, 0}, {1, 0}}};

  /// Of a line: where the condition holds.
  struct Part {
    std::size_t line;
    double from, to;
  };

  /// Into results_: the values at so many points, and behind them the conditions.
  template <class At> void evaluate(std::size_t count, const At &fields_at) {
    columns_.resize(field::count * count);
    results_.resize(2 * count);
    for (std::size_t i = 0; i < count; ++i) {
      const OutputFields fields = fields_at(i);
      for (std::size_t c = 0; c < fields.size(); ++c)
        columns_[c * count + i] = fields[c];
    }
    if (count > 0) form_.values(mu_, columns_.data(), count, results_.data());
  }

  template <class Fields> void find_parts(std::size_t lines, const Fields &fields) {
    parts_.clear();
    if (!form_.conditional) {
      for (std::size_t line = 0; line < lines; ++line)
        parts_.push_back({line, 0, 1});
      return;
    }
    constexpr std::size_t samples = 8; // crossings closer to each other than that are not seen
    evaluate((samples + 1) * lines, [&](std::size_t i) {
      return fields(i / (samples + 1), double(i % (samples + 1)) / samples);
    });
    for (std::size_t line = 0; line < lines; ++line) {
      const double *holds = &results_[(samples + 1) * (lines + line)];
      double from = 0;
      for (std::size_t k = 1; k <= samples; ++k) {
        const bool held = holds[k - 1] != 0;
        if ((holds[k] != 0) == held) continue;
        const double crossing = crossing_between(double(k - 1) / samples, double(k) / samples, held,
                                                 [&](double s) { return fields(line, s); });
        if (held) parts_.push_back({line, from, crossing});
        from = crossing;
      }
      if (holds[samples] != 0) parts_.push_back({line, from, 1});
    }
  }

  template <class Fields>
  double crossing_between(double low, double high, bool held, const Fields &fields) const {
    for (int step = 0; step < 50; ++step) {
      const double middle = (low + high) / 2;
      std::array<double, 2> value_and_condition;
      form_.values(mu_, fields(middle).data(), 1, value_and_condition.data());
      ((value_and_condition[1] != 0) == held ? low : high) = middle;
    }
    return (low + high) / 2;
  }

  const OutputForm &form_;
  const FullMu &mu_;
  const MirrorPlanes &mirrors_;
  OutputSums sums_;
  std::vector<Part> parts_;
  std::vector<double> columns_, results_; ///< of evaluate()
};

/// Not finite over nothing.
double output_value(const OutputForm &form, const OutputSums &sums);

} // namespace rbvi
