#include "rbvi/element/clipped_simplex.hpp"

#include "rbvi/core/dense.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace rbvi {

namespace {

constexpr int halvings = 6;    // of a triangle three times two, of a tetrahedron two times three
constexpr int looks = 4;       // halvings that are made where it passes somewhere in the whole
constexpr int bisections = 40; // of an edge, to round-off of differences

Barycentric between(const Barycentric &a, const Barycentric &b, double s) {
  Barycentric result{};
  for (std::size_t k = 0; k < result.size(); ++k)
    result[k] = (1 - s) * a[k] + s * b[k];
  return result;
}

/// Whether it holds, or does not, at all points of the whole that quarters of its edges tell.
std::optional<bool> at_all_points(int dim, const std::function<bool(const Barycentric &)> &holds) {
  constexpr int parts = 4;
  const bool first = holds({1, 0, 0, 0});
  for (int i = 0; i <= parts; ++i)
    for (int j = 0; i + j <= parts; ++j)
      for (int k = dim == 2 ? parts - i - j : 0; i + j + k <= parts; ++k) {
        const auto share = [](int count) { return static_cast<double>(count) / parts; };
        if (holds({share(i), share(j), share(k), share(parts - i - j - k)}) != first)
          return std::nullopt;
      }
  return first;
}

/// The corners of a piece on both sides of the condition's end, and where it ends between them.
struct Cut {
  std::vector<Barycentric> in, out;
  std::vector<std::vector<Barycentric>> ends; ///< of each corner in it, to each one out of it
};

class Clip {
public:
  explicit Clip(const std::function<bool(const Barycentric &)> &holds) : holds_(holds) {}

  /// `depth`: halvings that made it.
  void add(const Piece &piece, int depth) {
    const bool held = holds_(piece.corners[0]);
    if (depth >= looks && is_everywhere(piece, held)) {
      if (held) pieces.push_back(piece);
      return;
    }
    if (depth == 0 || depth == looks || depth == halvings)
      if (const Cut cut = cut_of(piece); depth == halvings || is_straight(cut))
        return add_cut(piece, cut);
    const auto [from, to] = longest_edge(piece);
    const Barycentric middle = between(piece.corners[from], piece.corners[to], 0.5);
    for (const std::size_t corner : {from, to}) {
      Piece half = piece;
      half.corners[corner] = middle;
      add(half, depth + 1);
    }
  }

  std::vector<Piece> pieces;

private:
  /// As the corners and the middles of edges tell.
  bool is_everywhere(const Piece &piece, bool held) const {
    for (std::size_t i = 0; i <= static_cast<std::size_t>(piece.dim); ++i) {
      if (holds_(piece.corners[i]) != held) return false;
      for (std::size_t j = 0; j < i; ++j)
        if (holds_(between(piece.corners[i], piece.corners[j], 0.5)) != held) return false;
    }
    return true;
  }

  static std::pair<std::size_t, std::size_t> longest_edge(const Piece &piece) {
    std::pair<std::size_t, std::size_t> edge;
    double longest = 0;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(piece.dim); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        double square = 0;
        for (std::size_t k = 0; k < piece.corners[i].size(); ++k)
          square += std::pow(piece.corners[i][k] - piece.corners[j][k], 2);
        if (square <= longest) continue;
        longest = square;
        edge = {j, i};
      }
    return edge;
  }

  /// Where the condition ends on the way from a, where it holds, to b.
  Barycentric end(const Barycentric &a, const Barycentric &b) const {
    double low = 0, high = 1;
    for (int step = 0; step < bisections; ++step) {
      const double middle = (low + high) / 2;
      (holds_(between(a, b, middle)) ? low : high) = middle;
    }
    return between(a, b, (low + high) / 2);
  }

  Cut cut_of(const Piece &piece) const {
    Cut cut;
    for (std::size_t i = 0; i <= static_cast<std::size_t>(piece.dim); ++i)
      (holds_(piece.corners[i]) ? cut.in : cut.out).push_back(piece.corners[i]);
    for (const Barycentric &a : cut.in) {
      std::vector<Barycentric> &ends = cut.ends.emplace_back();
      for (const Barycentric &b : cut.out)
        ends.push_back(end(a, b));
    }
    return cut;
  }

  /// Whether the condition changes between the corners once, where it ends on edges and half way
  /// between, to `thin`.
  bool is_straight(const Cut &cut) const {
    constexpr double thin = 1e-6;
    if (cut.in.empty() || cut.out.empty()) return false;
    for (const bool held : {true, false}) {
      const std::vector<Barycentric> &side = held ? cut.in : cut.out;
      for (std::size_t i = 0; i < side.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
          for (const double s : {0.25, 0.5, 0.75})
            if (holds_(between(side[i], side[j], s)) != held) return false;
    }
    std::vector<Barycentric> ends;
    for (const std::vector<Barycentric> &of : cut.ends)
      ends.insert(ends.end(), of.begin(), of.end());
    for (std::size_t i = 0; i < ends.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        for (const double s : {0.25, 0.5, 0.75}) {
          const Barycentric at = between(ends[i], ends[j], s);
          for (const Barycentric &corner : cut.in)
            if (!holds_(between(at, corner, thin))) return false;
          for (const Barycentric &corner : cut.out)
            if (holds_(between(at, corner, thin))) return false;
        }
    return true;
  }

  void add_cut(const Piece &piece, const Cut &cut) {
    const auto &[in, out, ends] = cut;
    if (in.empty()) return;
    if (out.empty()) return pieces.push_back(piece);
    if (in.size() == 1) { // a corner of it
      Piece corner{piece.dim, {in[0]}};
      std::ranges::copy(ends[0], corner.corners.begin() + 1);
      return pieces.push_back(corner);
    }
    if (piece.dim == 2) {
      pieces.push_back({2, {in[0], in[1], ends[1][0]}});
      return pieces.push_back({2, {in[0], ends[1][0], ends[0][0]}});
    }
    if (in.size() == 3) return prism({in[0], in[1], in[2]}, {ends[0][0], ends[1][0], ends[2][0]});
    prism({in[0], ends[0][0], ends[0][1]}, {in[1], ends[1][0], ends[1][1]});
  }

  void prism(const std::array<Barycentric, 3> &p, const std::array<Barycentric, 3> &q) {
    pieces.push_back({3, {p[0], p[1], p[2], q[2]}});
    pieces.push_back({3, {p[0], p[1], q[1], q[2]}});
    pieces.push_back({3, {p[0], q[0], q[1], q[2]}});
  }

  const std::function<bool(const Barycentric &)> &holds_;
};

} // namespace

Barycentric Piece::at(const Barycentric &own) const {
  Barycentric result{};
  for (int i = 0; i <= dim; ++i)
    for (std::size_t k = 0; k < result.size(); ++k)
      result[k] += own[static_cast<std::size_t>(i)] * corners[static_cast<std::size_t>(i)][k];
  return result;
}

double Piece::share() const {
  Matrix coordinates(dim + 1, dim + 1);
  for (int i = 0; i <= dim; ++i)
    for (int k = 0; k <= dim; ++k)
      coordinates(i, k) = corners[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)];
  return std::abs(coordinates.determinant());
}

std::vector<Piece> pieces_where(int dim, const std::function<bool(const Barycentric &)> &holds) {
  Clip clip(holds);
  Piece whole{dim, {}};
  for (int i = 0; i <= dim; ++i)
    whole.corners[static_cast<std::size_t>(i)][static_cast<std::size_t>(i)] = 1;
  if (const std::optional<bool> all = at_all_points(dim, holds))
    return *all ? std::vector{whole} : std::vector<Piece>{};
  clip.add(whole, 0);
  return std::move(clip.pieces);
}

} // namespace rbvi
