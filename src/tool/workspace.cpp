#include "rbvi/tool/workspace.hpp"

#include "rbvi/fem/check_scene.hpp"
#include "rbvi/par/collective.hpp"

namespace rbvi {

Workspace::Workspace(MPI_Comm world, const Groups &groups, const ToolOptions &options)
    : world_(world), options_(options), shared_(groups.count() == 1) {
  collectively(world, [&] {
    group_ = std::make_unique<Problem>(groups.comm(), options.scene, options.mesh,
                                       options.contact_gather);
    check_scene(*group_);
    check_solver_options(*group_, options.hf);
  });
}

Problem &Workspace::world_problem() {
  if (shared_) return *group_;
  if (!all_)
    all_ =
        std::make_unique<Problem>(world_, options_.scene, options_.mesh, options_.contact_gather);
  return *all_;
}

} // namespace rbvi
