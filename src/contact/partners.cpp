#include "rbvi/contact/partners.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace rbvi {

namespace {

constexpr double least_part = 1e-12; ///< of a slave edge: less is round-off

FacedPart cut(const FacedPart &part, const CurvePlace &begin, const CurvePlace &end) {
  return {part.master_edge, begin, end, part.t_at(begin), part.t_at(end)};
}

} // namespace

/// > 0: a point of the slave curve is to the right of the normal at an end of a master edge.
double PartnerSearch::beside(Index master_edge, Index end, const Point &x) const {
  return cross(x - master_.end(master_edge, end), field_.normals[master_edge][end])[2];
}

/// Whether a slave edge runs as the master curve does at an end of its edge.
bool PartnerSearch::alike(Index master_edge, Index end, Index slave_edge) const {
  return cross(slave_.end(slave_edge, 1) - slave_.end(slave_edge, 0),
               field_.normals[master_edge][end])[2] > 0;
}

/// Goes along the vertices of the section, and along the piece from one's normal to the next's.
/// Places on a closed piece count on beyond its last edge.
class PartnerSearch::Sweep {
public:
  Sweep(PartnerSearch &search, const CurveChain &piece, const CurveSection &section)
      : search_(search), piece_(piece), section_(section) {
    const NodalCurve &slave = search.slave_;
    for (Index k = 0; k < piece.vertices(); ++k)
      centre_ =
          centre_ + slave.point(piece.first_vertex + k) / static_cast<double>(piece.vertices());
    for (Index k = 0; k < piece.vertices(); ++k)
      radius_ = std::max(radius_, norm(slave.point(piece.first_vertex + k) - centre_));
    size_ = edge_length(slave.end(piece.first_edge, 0), slave.end(piece.first_edge, 1));
  }

  void run() {
    const auto count = std::ssize(section_.edges);
    std::optional<CurvePlace> last; // of the vertex before
    bool found = false;
    for (Index v = 0; v <= count; ++v) {
      std::optional<CurvePlace> here = last ? next(v, last->edge) : nearest(v);
      if (v > 0 && (last || here))
        add(section_.edges[v - 1], last ? *last : begin_of(v, here->edge),
            here ? *here : end_of(v, last->edge));
      found = found || here;
      last = here;
    }
    if (!found) add_inside_of_an_edge();
  }

private:
  /// Vertex v of the section as an end of one of its edges.
  std::pair<Index, Index> vertex(Index v) const {
    const auto count = std::ssize(section_.edges);
    return v < count ? std::pair{section_.edges[v], Index{0}}
                     : std::pair{section_.edges[count - 1], Index{1}};
  }
  Index edge(Index unwrapped) const {
    return piece_.first_edge + (unwrapped - piece_.first_edge) % piece_.edges;
  }
  /// An open piece ends there; a closed one is followed once around.
  Index last_edge(Index from) const {
    return piece_.loop ? from + piece_.edges : piece_.first_edge + piece_.edges - 1;
  }
  double beside(Index v, const Point &x) const {
    const auto [master_edge, end] = vertex(v);
    return search_.beside(master_edge, end, x);
  }
  double beside(Index v, Index e, Index end) const {
    return beside(v, search_.slave_.end(edge(e), end));
  }
  bool alike(Index v, Index e) const {
    const auto [master_edge, end] = vertex(v);
    return search_.alike(master_edge, end, edge(e));
  }

  /// Where the normal of the vertex meets the piece, of several places the nearest; none where they
  /// do not run alike.
  std::optional<CurvePlace> nearest(Index v) const {
    const auto [master_edge, end] = vertex(v);
    const Point &origin = search_.master_.end(master_edge, end),
                &n = search_.field_.normals[master_edge][end];
    const double round_off = 1e-12 * size_;
    if (std::abs(cross(centre_ - origin, n)[2]) > radius_ + round_off) return {};
    std::optional<CurvePlace> found;
    double least = std::numeric_limits<double>::infinity();
    for (Index e = piece_.first_edge; e < piece_.first_edge + piece_.edges; ++e) {
      const double a = beside(v, e, 0), b = beside(v, e, 1);
      if (!(a <= round_off && b >= -round_off && a < b)) continue;
      const double s = std::clamp(a / (a - b), 0.0, 1.0);
      const double away = std::abs(dot(search_.slave_.at(e, s) - origin, n));
      if (!(away < least)) continue;
      least = away;
      found = {e, s};
    }
    return found ? next(v, found->edge) : found;
  }

  /// The same, searched from edge `from` onwards; none where the piece ends or turns away first.
  std::optional<CurvePlace> next(Index v, Index from) const {
    const double round_off = 1e-12 * size_;
    const Index last = last_edge(from);
    while (from < last && beside(v, from, 1) <= round_off && alike(v, from + 1))
      ++from;
    if (beside(v, from, 1) < -round_off) return {};
    constexpr double settled = 1e-14;
    const auto [master_edge, end] = vertex(v);
    const Point &n = search_.field_.normals[master_edge][end];
    const double a = beside(v, from, 0), b = beside(v, from, 1);
    double low = 0, high = 1, s = a < 0 && b > 0 ? a / (a - b) : a < 0 ? 1 : 0;
    for (int k = 0; k < 60 && high - low > 1e-15; ++k) { // safeguarded Newton steps
      const double value = beside(v, search_.slave_.at(edge(from), s));
      (value > 0 ? high : low) = s;
      const double step = s - value / cross(search_.slave_.tangent(edge(from), s), n)[2];
      if (std::abs(step - s) <= settled) break;
      s = step > low && step < high ? step : 0.5 * (low + high);
    }
    return CurvePlace{from, s};
  }

  /// Where what runs alike begins, and ends, that edge e is in.
  CurvePlace begin_of(Index v, Index e) const {
    const Index first = piece_.loop ? e - piece_.edges + 1 : piece_.first_edge;
    while (e > first && alike(v, e - 1 + (piece_.loop ? piece_.edges : 0)))
      --e;
    return {e, 0};
  }
  CurvePlace end_of(Index v, Index e) const {
    const Index last = last_edge(e) - (piece_.loop ? 1 : 0);
    while (e < last && alike(v, e + 1))
      ++e;
    return {e, 1};
  }

  /// One master edge is longer than all of the piece that runs as it does.
  void add_inside_of_an_edge() {
    const auto middle = [&](Index e) { return search_.slave_.at(edge(e), 0.5); };
    for (Index v = 0; v < std::ssize(section_.edges); ++v)
      for (Index e = piece_.first_edge; e < piece_.first_edge + piece_.edges; ++e)
        if (alike(v, e) && beside(v, middle(e)) > 0 && beside(v + 1, middle(e)) < 0)
          return add(section_.edges[v], begin_of(v, e), end_of(v, e));
  }

  /// Cut where a closed piece begins.
  void add(Index master_edge, const CurvePlace &begin, const CurvePlace &end) {
    if (!(end.minus(begin) > 0)) return;
    const auto wrapped = [&](const CurvePlace &place, Index turns) {
      return CurvePlace{place.edge - turns * piece_.edges, place.s};
    };
    const Index end_of_piece = piece_.first_edge + piece_.edges;
    for (Index turns = -1; turns <= 1; ++turns) {
      const FacedPart whole{master_edge, wrapped(begin, turns), wrapped(end, turns)};
      const CurvePlace first{piece_.first_edge, 0}, last{end_of_piece - 1, 1};
      const FacedPart part = cut(whole, whole.begin.minus(first) < 0 ? first : whole.begin,
                                 whole.end.edge >= end_of_piece ? last : whole.end);
      if (part.end.minus(part.begin) > 0) search_.parts_.push_back(part);
    }
  }

  PartnerSearch &search_;
  const CurveChain &piece_;
  const CurveSection &section_;
  Point centre_{};
  double radius_ = 0, size_ = 0;
};

PartnerSearch::PartnerSearch(const NodalCurve &slave, const NodalCurve &master, MasterField field)
    : slave_(slave), master_(master), field_(std::move(field)) {
  parts_.reserve(static_cast<std::size_t>(slave.edges() + master.edges()));
  for (const CurveChain &piece : slave.shape().pieces)
    for (const CurveSection &section : field_.sections)
      Sweep(*this, piece, section).run();
  sort_parts();
}

/// One after the other along the slave curve: where a part lies behind another it is not seen.
void PartnerSearch::sort_parts() {
  const auto later = [](const FacedPart &a, const FacedPart &b) {
    return a.begin.minus(b.begin) < 0;
  };
  if (!std::ranges::is_sorted(parts_, later)) std::ranges::stable_sort(parts_, later);
  std::vector<FacedPart> sorted;
  sorted.reserve(parts_.size());
  for (std::size_t k = 0; k < parts_.size(); ++k) {
    FacedPart part = parts_[k];
    if (!sorted.empty() && part.begin.minus(sorted.back().end) < 0) {
      FacedPart &last = sorted.back();
      const bool inside = part.end.minus(last.end) < 0;
      const CurvePlace &end = inside ? part.end : last.end;
      const double middle = end.minus({0}) / 2 + part.begin.minus({0}) / 2;
      const CurvePlace at{static_cast<Index>(middle), middle - std::floor(middle)};
      if (gap_at(last, at) <= gap_at(part, at)) {
        if (inside) continue;
        part = cut(part, last.end, part.end);
      } else {
        if (inside) { // what is left of the last one behind the new one
          const FacedPart rest = cut(last, part.end, last.end);
          parts_.insert(std::upper_bound(parts_.begin() + static_cast<std::ptrdiff_t>(k) + 1,
                                         parts_.end(), rest, later),
                        rest);
        }
        last = cut(last, last.begin, part.begin);
        if (!(last.end.minus(last.begin) > 0)) sorted.pop_back();
      }
    }
    if (part.end.minus(part.begin) > 0) sorted.push_back(part);
  }
  parts_ = std::move(sorted);
}

/// How far a place is from its partner in a part; infinite without one.
double PartnerSearch::gap_at(const FacedPart &part, const CurvePlace &place) const {
  PairPoint point{static_cast<int>(place.edge), static_cast<int>(part.master_edge), place.s,
                  part.t_at(place)};
  try {
    (void)project(point);
  } catch (const Error &) {
    return std::numeric_limits<double>::infinity();
  }
  return norm(slave_.at(place.edge, place.s) - master_.at(part.master_edge, point.t));
}

std::vector<PairPoint> PartnerSearch::on_parts(std::span<const EdgePoint> rule) const {
  std::vector<PairPoint> points;
  points.reserve(rule.size() * (parts_.size() + static_cast<std::size_t>(slave_.edges())));
  for (const FacedPart &part : parts_) {
    const CurvePlace &begin = part.begin, &end = part.end;
    for (Index e = begin.edge; e <= end.edge; ++e) {
      const double first = e == begin.edge ? begin.s : 0, last = e == end.edge ? end.s : 1;
      if (last - first <= least_part) continue;
      for (const EdgePoint &at : rule) {
        const double s = first + at.s * (last - first);
        points.emplace_back(static_cast<int>(e), static_cast<int>(part.master_edge), s,
                            part.t_at({e, s}), at.weight * (last - first));
      }
    }
  }
  return points;
}

std::vector<PairPoint> PartnerSearch::at(const std::vector<CurvePlace> &places) const {
  std::vector<PairPoint> points;
  for (const CurvePlace &here : places) {
    const auto faces = [&](const FacedPart &part) {
      return here.minus(part.begin) >= -least_part && here.minus(part.end) <= least_part;
    };
    auto after = std::ranges::upper_bound(
        parts_, 0.0, {}, [&](const FacedPart &part) { return part.begin.minus(here); });
    if (after != parts_.begin() && faces(*std::prev(after))) --after;
    if (after == parts_.end() || !faces(*after)) continue;
    points.emplace_back(static_cast<int>(here.edge), static_cast<int>(after->master_edge), here.s,
                        after->t_at(here));
  }
  return points;
}

std::vector<PairPoint> PartnerSearch::at_vertices() const {
  std::vector<CurvePlace> places;
  for (const CurveChain &piece : slave_.shape().pieces) {
    for (Index k = 0; k < piece.edges; ++k)
      places.push_back({piece.first_edge + k, 0});
    if (!piece.loop) places.push_back({piece.first_edge + piece.edges - 1, 1});
  }
  return at(places);
}

std::vector<FacedEdge> PartnerSearch::faced() const {
  std::vector<FacedEdge> result;
  for (const FacedPart &part : parts_)
    for (Index e = part.begin.edge; e <= part.end.edge; ++e) {
      const double begin = e == part.begin.edge ? part.begin.s : 0,
                   end = e == part.end.edge ? part.end.s : 1;
      if (end - begin <= least_part) continue;
      if (!result.empty() && result.back().edge == e && begin - result.back().end <= least_part)
        result.back().end = end;
      else
        result.push_back({e, begin > least_part ? begin : 0, end});
      if (1 - end <= least_part) result.back().end = 1;
    }
  return result;
}

std::vector<Index> PartnerSearch::segments() const {
  constexpr double round_off = 1e-8;
  std::vector<Index> result;
  for (const FacedPart &part : parts_)
    for (const CurvePlace &place : {part.begin, part.end})
      result.push_back(place.edge + static_cast<Index>(std::floor(place.s + round_off)));
  return result;
}

/// Newton's method for (y - y(t)) x n(t) = 0, from the t that the point has.
Bend PartnerSearch::project(PairPoint &point) const {
  constexpr double round_off = 1e-13, settled = 1e-8; // what is left is the square of the last step
  const Index master_edge = point.master_edge;
  const auto &normals = field_.normals[master_edge];
  const auto sum = [&](const std::array<double, 3> &functions) {
    Point result{};
    for (Index k = 0; k < master_.per_edge(); ++k)
      result = result + functions[k] * normals[k];
    return result;
  };
  const Point y = slave_.at(point.slave_edge, point.s);
  if (field_.vertical) { // both are linear in x
    const double begin = master_.end(master_edge, 0)[0], end = master_.end(master_edge, 1)[0];
    point.t = (y[0] - begin) / (end - begin);
    point.normal = {0, 1, 0};
    return {};
  }
  double t = std::clamp(point.t, 0.0, 1.0), last = 1;
  for (int k = 0; k < 30; ++k) {
    const Point away = y - master_.at(master_edge, t);
    const Point field = sum(edge_functions(master_.degree(), t));
    const Point turn = sum(edge_slopes(master_.degree(), t));
    const Point tangent = master_.tangent(master_edge, t);
    const double size = norm(field);
    const double step = cross(away, field)[2] / (cross(tangent, field) - cross(away, turn))[2];
    if (std::abs(step) > round_off && std::abs(last) > settled) {
      t += std::clamp(step, -0.5, 0.5);
      last = step;
      continue;
    }
    point.t = t;
    point.normal = {field[0] / size, field[1] / size, 0};
    const double stretch = norm(tangent);
    // d n = -k tau along the curve
    const Point tau{point.normal[1], -point.normal[0], 0};
    return {stretch, -(tau[0] * turn[0] + tau[1] * turn[1]) / (size * stretch)};
  }
  throw failure("the bodies do not face each other at (" + short_number(y[0]) + ", " +
                short_number(y[1]) +
                ") of the first contact curve, which has no projection onto the second one there: "
                "try a smaller indentation, or more -nonlinear_load_steps");
}

} // namespace rbvi
