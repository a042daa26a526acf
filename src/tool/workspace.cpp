#include "rbvi/tool/workspace.hpp"

#include "rbvi/fem/check_scene.hpp"
#include "rbvi/par/collective.hpp"

namespace rbvi {

Workspace::Workspace(MPI_Comm world, const Groups &groups, const Setup &setup)
    : world_(world), setup_(setup), shared_(groups.count() == 1) {
  collectively(world, [&] {
    group_ =
        std::make_unique<Problem>(groups.comm(), setup.scene, setup.mesh, setup.contact_gather);
    check_scene(*group_);
    check_solver_options(*group_, setup.hf);
  });
}

Problem &Workspace::world_problem() {
  if (shared_) return *group_;
  if (!all_)
    all_ = std::make_unique<Problem>(world_, setup_.scene, setup_.mesh, setup_.contact_gather);
  return *all_;
}

} // namespace rbvi
