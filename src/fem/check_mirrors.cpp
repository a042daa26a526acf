#include "check_mirrors.hpp"

#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/par/collective.hpp"

#include <cmath>

namespace rbvi {

namespace {

/// Of nodes on a plane, on this rank.
struct OnPlane {
  double moved = 0;   ///< by the map and the motion
  bool loose = false; ///< one can leave it
};

OnPlane nodes_on(const Problem &problem, const MirrorPlane &plane, double round_off) {
  const Scene &scene = problem.scene();
  const Mesh &mesh = problem.mesh();
  const Dofs &dofs = problem.dofs();
  const FullMu mu = generic_point(scene.parameters);
  const auto c = static_cast<std::size_t>(plane.component);
  OnPlane found;
  for (std::size_t node = 0; node < mesh.points.size(); ++node) {
    const Point &x = mesh.points[node];
    if (std::abs(x[c] - plane.position) > round_off) continue;
    const bool elastic = scene.components > 1;
    const double motion = elastic && scene.motion ? std::abs(scene.motion(mu, x)[c]) : 0;
    found.moved = std::max(found.moved, motion + std::abs(scene.map(mu, x)[c] - plane.position));
    if (!elastic) continue;
    const std::size_t dof = node * static_cast<std::size_t>(dofs.components) + c;
    found.loose = found.loose || dofs.free[dof] >= 0 ||
                  (!dofs.imposed_by.empty() && dofs.imposed_by[dof] >= 0);
  }
  return found;
}

void check(const Problem &problem, const MirrorPlane &plane) {
  const bool along_x = plane.component == 0;
  std::vector<double> ends{1e300, 1e300}; // least, then minus the largest
  for (const Point &x : problem.mesh().points) {
    ends[0] = std::min(ends[0], x[plane.component]);
    ends[1] = std::min(ends[1], -x[plane.component]);
  }
  over_ranks(problem.comm(), MPI_MIN, ends);
  const double least = ends[0], largest = -ends[1], round_off = 1e-7 * (largest - least);
  const auto is_there = [&](double end) { return std::abs(end - plane.position) <= round_off; };
  const std::string where = std::string(along_x ? "x" : "y") + " = " + short_number(plane.position);
  if (!is_there(least) && !is_there(largest))
    throw bad_input("the mesh does not end at the plane of symmetry " + where +
                    ": it reaches from " + short_number(least) + " to " + short_number(largest) +
                    "; mirror: {" + (along_x ? "x" : "y") + ": ...} names another plane");
  const OnPlane own = nodes_on(problem, plane, round_off);
  std::vector<double> most{own.moved, own.loose ? 1.0 : 0.0};
  over_ranks(problem.comm(), MPI_MAX, most);
  if (!(most[0] <= 10 * round_off))
    throw bad_input("the map or the motion moves the plane of symmetry " + where +
                    ": it must stay where it is");
  if (most[1] > 0)
    throw bad_input("nodes on the plane of symmetry " + where + " can leave it: impose " +
                    (along_x ? "ux" : "uy") + ": 0 on the whole boundary that is there");
}

} // namespace

void check_mirrors(const Problem &problem) {
  for (const MirrorPlane &plane : problem.scene().mirrors)
    check(problem, plane);
}

} // namespace rbvi
