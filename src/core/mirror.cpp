#include "rbvi/core/mirror.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

int image_count(const MirrorPlanes &planes) {
  return 1 << planes.size();
}

constexpr double round_off = 1e-7; // of the size of what is asked for

Vector image_counts(const MirrorPlanes &planes, const std::vector<Point> &points) {
  Vector counts = Vector::Constant(std::ssize(points), image_count(planes));
  if (planes.empty() || points.empty()) return counts;
  Point least = points.front(), most = least;
  for (const Point &x : points)
    for (std::size_t c = 0; c < 3; ++c) {
      least[c] = std::min(least[c], x[c]);
      most[c] = std::max(most[c], x[c]);
    }
  for (const auto &[component, position] : planes)
    for (std::size_t i = 0; i < points.size(); ++i)
      if (std::abs(points[i][component] - position) <= round_off * norm(most - least))
        counts[static_cast<Index>(i)] /= 2;
  return counts;
}

bool cancels(const MirrorPlanes &planes, std::size_t component) {
  return std::ranges::find(planes, static_cast<int>(component), &MirrorPlane::component) !=
         planes.end();
}

bool has_image(const MirrorPlanes &planes, int image, const OutputFields &begin,
               const OutputFields &end) {
  const double most =
      round_off * std::hypot(end[field::x] - begin[field::x], end[field::y] - begin[field::y]);
  for (std::size_t k = 0; k < planes.size(); ++k) {
    const auto &[component, position] = planes[k];
    const std::size_t place = component == 0 ? field::x : field::y;
    if (((image >> k) & 1) != 0 && std::abs(begin[place] - position) < most &&
        std::abs(end[place] - position) < most)
      return false;
  }
  return true;
}

void reflect(const MirrorPlanes &planes, int image, OutputFields &fields) {
  for (std::size_t k = 0; k < planes.size(); ++k) {
    if (((image >> k) & 1) == 0) continue;
    const bool along_x = planes[k].component == 0;
    double &place = fields[along_x ? field::x : field::y];
    place = 2 * planes[k].position - place;
    for (const std::size_t turned :
         {along_x ? field::ux : field::uy, along_x ? field::nx : field::ny, field::sigma_xy,
          field::tangential, field::slip})
      fields[turned] = -fields[turned];
  }
}

} // namespace rbvi
