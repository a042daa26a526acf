#include "axis.hpp"

#include "rbvi/core/text.hpp"
#include "rbvi/par/collective.hpp"

#include <algorithm>
#include <cmath>

namespace rbvi {

void mark_axis(Mesh &mesh) {
  std::vector<double> extent{0};
  for (const Point &x : mesh.points)
    extent[0] = std::max(extent[0], std::abs(x[0]));
  over_ranks(mesh.comm, MPI_MAX, extent);
  std::vector<bool> &on = mesh.boundary[axis_of_turning];
  collectively(mesh.comm, [&] {
    for (const Point &x : mesh.points) {
      on.push_back(on_axis(x[0], extent[0]));
      if (x[0] < 0 && !on.back())
        throw bad_input("an axisymmetric body is turned about x = 0 and lies at x >= 0, but the "
                        "mesh has a node at (" +
                        short_number(x[0]) + ", " + short_number(x[1]) +
                        "): give the half at x >= 0 alone");
    }
  });
}

} // namespace rbvi
