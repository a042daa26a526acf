// Tangents of surfaces in space. Each node of the multipliers has a frame {n, t_1, t_2}, made once
// from the normal of the reference mesh, so that multipliers of all mu are in the same frame. The
// smallest rotation from n to the normal of contact at the node takes it there, and that from there
// to the normal of a point beside it to the point; in the plane both give the quarter turn of the
// normal. Nothing depends on which t_1 is taken: another one turns the multipliers of its node.
#pragma once

#include "rbvi/core/functions.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rbvi {

struct Frame {
  Point normal;
  std::array<Point, 2> tangents;
};

/// n, of length 1, with t_1 in the plane of n and of the axis that is farthest from it.
inline Frame frame_of(const Point &n) {
  const auto least = [](double a, double b) { return std::abs(a) < std::abs(b); };
  Point axis{};
  axis[static_cast<std::size_t>(std::ranges::min_element(n, least) - n.begin())] = 1;
  const Point along = axis - dot(axis, n) * n, first = along / norm(along);
  return {n, {first, cross(n, first)}};
}

/// A tangent of the frame where the normal is `to`, which is not opposite to that of the frame.
inline Point carried(const Frame &frame, std::size_t tangent, const Point &to) {
  const Point &t = frame.tangents[tangent];
  return t - dot(t, to) / (1 + dot(frame.normal, to)) * (frame.normal + to);
}

} // namespace rbvi
