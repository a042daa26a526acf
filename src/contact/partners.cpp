#include "rbvi/contact/partners.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

namespace {

constexpr double least_part = 1e-12; ///< of a slave edge: less is round-off

} // namespace

std::vector<PairPoint> Cuts::on_pieces(std::span<const EdgePoint> rule) const {
  std::vector<PairPoint> points;
  points.reserve(rule.size() * (places.size() + slave_edges));
  for (int m = 0; m + 1 < std::ssize(places); ++m) {
    const CurvePlace &begin = places[m], &end = places[m + 1];
    for (int e = std::max(begin.edge, 0); e <= std::min(end.edge, slave_edges - 1); ++e) {
      const double first = e == begin.edge ? begin.s : 0, last = e == end.edge ? end.s : 1;
      if (last - first <= least_part) continue;
      for (const EdgePoint &at : rule)
        points.emplace_back(e, m, first + at.s * (last - first), 0, at.weight * (last - first));
    }
  }
  return points;
}

std::vector<PairPoint> Cuts::at(const std::vector<CurvePlace> &slave) const {
  std::vector<PairPoint> points;
  int m = 0;
  for (const CurvePlace &here : slave) {
    while (m + 2 < std::ssize(places) && here.minus(places[m + 1]) >= 0)
      ++m;
    if (here.minus(places[m]) >= -least_part && here.minus(places[m + 1]) <= least_part)
      points.emplace_back(here.edge, m, here.s);
  }
  return points;
}

std::vector<PairPoint> Cuts::at_vertices() const {
  std::vector<CurvePlace> places_of_vertices;
  for (int edge = 0; edge < slave_edges; ++edge)
    places_of_vertices.push_back({edge, 0});
  places_of_vertices.push_back({slave_edges - 1, 1});
  return at(places_of_vertices);
}

std::vector<Index> Cuts::segments() const {
  constexpr double round_off = 1e-8;
  std::vector<Index> edges;
  for (const CurvePlace &place : places)
    edges.push_back(place.edge + static_cast<Index>(std::floor(place.s + round_off)));
  return edges;
}

} // namespace rbvi
