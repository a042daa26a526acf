// Tangents of surfaces in space. Each node of the multipliers has a frame {n, t_1, t_2}, made once
// from the normal of the reference mesh, so that multipliers of all mu are in the same frame. The
// smallest rotation from n to the normal of contact at the node takes it there, and that from there
// to the normal of a point beside it to the point; in the plane both give the quarter turn of the
// normal. Nothing depends on which t_1 is taken: another one turns the multipliers of its node.
//
// A node that cannot move along an axis, as on a plane of symmetry, has a frame with t_2 along it:
// the traction there is zero, as its parts from both sides of the plane cancel, and t_1 is free.
#pragma once

#include "rbvi/core/functions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace rbvi {

struct Frame {
  Point normal;
  std::array<Point, 2> tangents;
  int free = 2; ///< the tangents, from the first, along which there can be traction
};

/// n, of length 1, with t_1 in the plane of n and of the axis that is farthest from it.
inline Frame frame_of(const Point &n) {
  const auto least = [](double a, double b) { return std::abs(a) < std::abs(b); };
  Point axis{};
  axis[static_cast<std::size_t>(std::ranges::min_element(n, least) - n.begin())] = 1;
  const Point along = axis - dot(axis, n) * n, first = along / norm(along);
  return {n, {first, cross(n, first)}};
}

/// Of a node that is held along some axes: its normal is n without its parts along them, unless
/// nothing is left of n.
inline Frame frame_of(const Point &n, const std::vector<std::size_t> &held) {
  constexpr double along = 1e-6;
  Point left = n;
  for (const std::size_t axis : held)
    left[axis] = 0;
  if (held.empty() || !(norm(left) > along)) return frame_of(n);
  left = left / norm(left);
  Frame frame = frame_of(left);
  frame.free = held.size() > 1 ? 0 : 1;
  if (frame.free == 0) return frame;
  Point across{};
  across[held.front()] = 1;
  frame.tangents = {cross(across, left), across};
  return frame;
}

/// A tangent of the frame where the normal is `to`, which is not opposite to that of the frame.
inline Point carried(const Frame &frame, std::size_t tangent, const Point &to) {
  const Point &t = frame.tangents[tangent];
  return t - dot(t, to) / (1 + dot(frame.normal, to)) * (frame.normal + to);
}

} // namespace rbvi
