#include "rbvi/problem/problem.hpp"

#include "rbvi/element/scalar_forms.hpp"

namespace rbvi {

namespace {

SparseMatrix reference_w_product(const ContactRegion &region, const Scene &scene) {
  std::vector<Cell> cells;
  for (const auto &vertices : region.cells) {
    Cell cell{region.dim, {}, {}};
    for (std::size_t i = 0; i <= static_cast<std::size_t>(region.dim); ++i)
      cell.reference[i] = region.points[static_cast<std::size_t>(vertices[i])];
    cells.push_back(cell);
  }
  ContactMatrix matrix(region, ContactMatrix::Columns::dual_dofs);
  return matrix.assemble(scene.w_product, {}, cells);
}

} // namespace

Problem::Problem(MPI_Comm comm, Scene scene, const MeshOptions &options)
    : scene_(std::move(scene)), mesh_(make_mesh(comm, scene_, options)),
      dofs_(number_dofs(mesh_, scene_.components, scene_.fixed_boundary)),
      contact_(make_contact_region(mesh_, dofs_, scene_.contact_region)),
      cells_(reference_cells(mesh_)), a_(make_matrix(mesh_, dofs_, scene_.a.region)),
      f_(make_vector(dofs_)), b_(contact_, ContactMatrix::Columns::contact_dofs),
      w_product_(reference_w_product(contact_, scene_)) {}

void Problem::assemble_contact(const Mu &mu, Operators &operators) {
  operators.mu = expand(scene_.parameters, mu);
  const std::vector<Cell> cells = mapped_contact_cells(contact_, scene_, operators.mu);
  operators.b = b_.assemble(scene_.b, operators.mu, cells);
  operators.g = contact_vector(contact_, scene_.g, operators.mu, cells);
  static const Form hat_integrals = constant_load("", 1);
  operators.weights = contact_vector(contact_, hat_integrals, operators.mu, cells);
  operators.obstacle.resize(contact_.dual_size());
  for (Index r = 0; r < contact_.dual_size(); ++r)
    operators.obstacle[r] = scene_.obstacle(
        operators.mu, scene_.map(operators.mu, contact_.points[static_cast<std::size_t>(r)]));
}

const Operators &Problem::assemble(const Mu &mu) {
  const Mu all = expand(scene_.parameters, mu);
  map_cells(scene_, all, mesh_, cells_);
  assemble_contact(mu, operators_);
  assemble_matrix(scene_.a, all, mesh_, dofs_, cells_, a_.get());
  if (scene_.f) assemble_vector(scene_.f, all, mesh_, dofs_, cells_, f_.get());
  operators_.a = a_.get();
  operators_.f = f_.get();
  return operators_;
}

Mat Problem::v_product() {
  if (!v_product_) {
    v_product_ = make_matrix(mesh_, dofs_, scene_.v_product.region);
    assemble_matrix(scene_.v_product, {}, mesh_, dofs_, reference_cells(mesh_), v_product_.get());
  }
  return v_product_.get();
}

} // namespace rbvi
