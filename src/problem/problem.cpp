#include "rbvi/problem/problem.hpp"

#include "rbvi/core/error.hpp"

namespace rbvi {

Problem::Problem(MPI_Comm comm, Scene scene, const MeshOptions &options)
    : scene_(std::make_unique<const Scene>(std::move(scene))),
      mesh_(make_mesh(comm, *scene_, options)),
      dofs_(number_dofs(mesh_, scene_->components, scene_->fixed)),
      places_(place_interfaces(mesh_, dofs_, *scene_)),
      contact_(make_contact(*scene_, places_.meshes)), cells_(reference_cells(mesh_)),
      a_(make_matrix(mesh_, dofs_, scene_->a.region)), f_(make_vector(dofs_)) {}

void Problem::assemble_contact(const Mu &mu, Operators &operators) {
  operators.mu = expand(scene_->parameters, mu);
  rbvi::assemble(contact_, operators.mu, {}, operators);
  operators.bound = contact_.interfaces.front()->bound(operators.mu);
  operators.normal = contact_.nodes();
}

std::vector<double> Problem::stiffness_values(const FullMu &all_parameters) const {
  if (!scene_->a_parameters) return all_parameters;
  std::vector<double> values;
  for (const int i : *scene_->a_parameters)
    values.push_back(all_parameters[static_cast<std::size_t>(i)]);
  return values;
}

const Operators &Problem::assemble(const Mu &mu) {
  const FullMu all = expand(scene_->parameters, mu);
  assemble_contact(mu, operators_);
  const std::vector<double> values = stiffness_values(all);
  const bool new_a = a_made_at_ != values;
  if (new_a || scene_->f) map_cells(*scene_, all, mesh_, cells_);
  if (new_a) {
    a_made_at_.reset();
    assemble_matrix(scene_->a, all, mesh_, dofs_, cells_, a_.get());
    a_made_at_ = values;
  }
  if (scene_->f) assemble_vector(scene_->f, all, mesh_, dofs_, cells_, f_.get());
  operators_.a = a_.get();
  operators_.f = f_.get();
  return operators_;
}

Mat Problem::v_product() {
  if (!v_product_) {
    v_product_ = make_matrix(mesh_, dofs_, scene_->v_product.region);
    assemble_matrix(scene_->v_product, {}, mesh_, dofs_, reference_cells(mesh_), v_product_.get());
  }
  return v_product_.get();
}

} // namespace rbvi
