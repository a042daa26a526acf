#include "rbvi/contact/contact_pair.hpp"

#include <algorithm>

namespace rbvi {

SlaveLines slave_lines(const Partners &partners, bool whole) {
  const CurveShape &shape = partners.slave.shape();
  const auto vertex_at = [&](Index edge, double s) { return shape.ends[edge][s > 0.5 ? 1 : 0]; };
  std::vector<const PairPoint *> of_vertex(shape.vertices(), nullptr);
  for (const PairPoint &p : partners.vertices)
    of_vertex[vertex_at(p.slave_edge, p.s)] = &p;
  auto cut = partners.cuts.begin();
  std::vector<std::array<int, 2>> at_vertex(shape.vertices(), {-1, -1}); // facing nothing, or not
  SlaveLines lines;
  const auto place = [&](Index edge, double s, bool faced) {
    const bool inside = s > 0 && s < 1;
    int own = -1, &number = inside ? own : at_vertex[vertex_at(edge, s)][faced ? 1 : 0];
    if (number >= 0) return number;
    number = static_cast<int>(std::ssize(lines.places));
    lines.places.push_back({edge, s});
    lines.partners.push_back(!faced ? nullptr : inside ? &*cut++ : of_vertex[vertex_at(edge, s)]);
    return number;
  };
  const auto add = [&](Index edge, double begin, double end, bool faced) {
    if (!(end > begin) || !(faced || whole)) return;
    for (const double s : {begin, end})
      lines.cells.push_back(place(edge, s, faced));
    lines.parts.push_back({edge, begin, end});
    lines.faced.push_back(faced);
  };
  auto part = partners.faced.begin();
  for (Index e = 0; e < shape.edges(); ++e) {
    double last = 0;
    for (; part != partners.faced.end() && part->edge == e; ++part) {
      add(e, last, part->begin, false);
      add(e, part->begin, part->end, true);
      last = part->end;
    }
    add(e, last, 1, false);
  }
  return lines;
}

std::vector<CurvePlace> middles_of(const SlaveLines &lines) {
  std::vector<CurvePlace> middles;
  for (const auto &[edge, begin, end] : lines.parts)
    middles.push_back({edge, (begin + end) / 2});
  return middles;
}

Vector fitted_middles(const Partners &partners, const SlaveLines &lines, const Vector &at_places,
                      const std::function<double(const PairPoint &)> &value) {
  Vector middles(std::ssize(lines.parts));
  for (Index k = 0; k < middles.size(); ++k) {
    const auto &[edge, begin, end] = lines.parts[k];
    const double first = at_places[lines.cells[2 * k]], last = at_places[lines.cells[2 * k + 1]];
    double product = 0, square = 0;
    for (const PairPoint &p :
         std::ranges::equal_range(partners.points, edge, {}, &PairPoint::slave_edge)) {
      const double t = (p.s - begin) / (end - begin), bubble = 4 * t * (1 - t);
      if (!(bubble > 0)) continue;
      product += bubble * (value(p) - (1 - t) * first - t * last);
      square += bubble * bubble;
    }
    middles[k] = (first + last) / 2 + (square > 0 ? product / square : 0);
  }
  return middles;
}

} // namespace rbvi
