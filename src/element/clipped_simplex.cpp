#include "clipped_simplex.hpp"

#include "rbvi/core/dense.hpp"

#include <cmath>
#include <optional>

namespace rbvi {

namespace {

constexpr int halvings = 6;    // of a triangle three times two, of a tetrahedron two times three
constexpr int looks = 4;       // halvings that are made where it passes somewhere in the whole
constexpr int bisections = 45; // of an edge, to round-off

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

class Clip {
public:
  explicit Clip(const std::function<bool(const Barycentric &)> &holds) : holds_(holds) {}

  void add(const Piece &piece, int depth) {
    std::size_t from = 0, to = 0;
    double longest = 0;
    bool held = holds_(piece.corners[0]), same = true;
    for (int i = 0; i <= piece.dim; ++i) {
      const Barycentric &a = piece.corners[static_cast<std::size_t>(i)];
      same = same && holds_(a) == held;
      for (int j = 0; j < i; ++j) {
        const Barycentric &b = piece.corners[static_cast<std::size_t>(j)];
        same = same && holds_(between(a, b, 0.5)) == held;
        double square = 0;
        for (std::size_t k = 0; k < a.size(); ++k)
          square += (a[k] - b[k]) * (a[k] - b[k]);
        if (square <= longest) continue;
        longest = square;
        from = static_cast<std::size_t>(j);
        to = static_cast<std::size_t>(i);
      }
    }
    if (same && depth >= looks) {
      if (held) pieces.push_back(piece);
    } else if (depth == halvings) {
      cut(piece);
    } else {
      const Barycentric middle = between(piece.corners[from], piece.corners[to], 0.5);
      for (const std::size_t corner : {from, to}) {
        Piece half = piece;
        half.corners[corner] = middle;
        add(half, depth + 1);
      }
    }
  }

  std::vector<Piece> pieces;

private:
  /// Where the condition ends on the way from a, where it holds, to b.
  Barycentric end(const Barycentric &a, const Barycentric &b) const {
    double low = 0, high = 1;
    for (int step = 0; step < bisections; ++step) {
      const double middle = (low + high) / 2;
      (holds_(between(a, b, middle)) ? low : high) = middle;
    }
    return between(a, b, (low + high) / 2);
  }

  void cut(const Piece &piece) {
    std::vector<Barycentric> in, out;
    for (int i = 0; i <= piece.dim; ++i) {
      const Barycentric &a = piece.corners[static_cast<std::size_t>(i)];
      (holds_(a) ? in : out).push_back(a);
    }
    if (in.empty()) return;
    if (out.empty()) return pieces.push_back(piece);
    if (in.size() == 1) { // a corner of it
      Piece corner{piece.dim, {in[0]}};
      for (std::size_t i = 0; i < out.size(); ++i)
        corner.corners[i + 1] = end(in[0], out[i]);
      return pieces.push_back(corner);
    }
    if (piece.dim == 2) {
      const Barycentric first = end(in[0], out[0]), second = end(in[1], out[0]);
      pieces.push_back({2, {in[0], in[1], second}});
      return pieces.push_back({2, {in[0], second, first}});
    }
    if (in.size() == 3)
      return prism({in[0], in[1], in[2]},
                   {end(in[0], out[0]), end(in[1], out[0]), end(in[2], out[0])});
    prism({in[0], end(in[0], out[0]), end(in[0], out[1])},
          {in[1], end(in[1], out[0]), end(in[1], out[1])});
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
