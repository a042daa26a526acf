#include "rbvi/problem/problem.hpp"

#include "rbvi/contact/pair/contact_pair.hpp"
#include "rbvi/contact/support/support_outputs.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/scalar_forms.hpp"

namespace rbvi {

namespace {

SparseMatrix region_product(const ContactRegion &region, const Scene &scene) {
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

/// -u <= -psi at every node of the region.
SparseMatrix minus_trace(const ContactRegion &region) {
  SparseMatrix result(region.dual_size(), region.trace.size);
  for (Index i = 0; i < region.dual_size(); ++i)
    if (const int dof = region.contact_dof[static_cast<std::size_t>(i)]; dof >= 0)
      result.insert(i, dof) = -1;
  result.makeCompressed();
  return result;
}

} // namespace

Problem::Problem(MPI_Comm comm, Scene scene, const MeshOptions &options)
    : scene_(std::move(scene)), mesh_(make_mesh(comm, scene_, options)),
      dofs_(number_dofs(mesh_, scene_.components, scene_.fixed)), cells_(reference_cells(mesh_)),
      a_(make_summed<Mat>(scene_.a, scene_.parameters, mesh_, dofs_)),
      f_(make_summed<Vec>(scene_.f, scene_.parameters, mesh_, dofs_)) {
  if (scene_.degree != 1 && !scene_.support && !scene_.pair)
    throw bad_input("scene " + scene_.name +
                    ": degree 2 is for contact of two bodies or with a rigid support");
  if (scene_.support) {
    support_ = make_contact_support(mesh_, dofs_, *scene_.support);
    w_product_ = multiplier_product(support_->curve, *scene_.support);
  } else if (scene_.pair) {
    curves_ = make_contact_curves(mesh_, dofs_, scene_);
    const auto slave = curves_->points.begin();
    w_product_ = multiplier_product({slave, slave + curves_->slave_nodes},
                                    scene_.pair->discretisation.multiplier, scene_.degree);
  } else {
    contact_ = make_contact_region(mesh_, dofs_, scene_.contact_region);
    b_.emplace(*contact_, ContactMatrix::Columns::contact_dofs);
    w_product_ = region_product(*contact_, scene_);
    operators_.nodal_b = minus_trace(*contact_);
  }
}

void Problem::assemble_obstacle(Operators &operators) {
  const std::vector<Cell> cells = mapped_contact_cells(*contact_, scene_, operators.mu);
  operators.b = b_->assemble(scene_.b, operators.mu, cells);
  operators.g = contact_vector(*contact_, scene_.g, operators.mu, cells);
  static const Form hat_integrals = constant_load("", 1);
  operators.weights = contact_vector(*contact_, hat_integrals, operators.mu, cells);
  operators.nodal_b = operators_.nodal_b;
  operators.nodal_gap.resize(contact_->dual_size());
  for (Index r = 0; r < contact_->dual_size(); ++r)
    operators.nodal_gap[r] = -scene_.obstacle(
        operators.mu, scene_.map(operators.mu, contact_->points[static_cast<std::size_t>(r)]));
}

void Problem::assemble_pair(Operators &operators) {
  PairOperators pair = couple_at(scene_, operators.mu, curves_->points, curves_->slave_nodes);
  operators.b = std::move(pair.b);
  operators.g = std::move(pair.g);
  operators.weights = std::move(pair.weights);
  operators.nodal_b = std::move(pair.nodal_b);
  operators.nodal_gap = std::move(pair.nodal_gap);
}

void Problem::assemble_support(Operators &operators) {
  SupportOperators support = couple_with_support(scene_, operators.mu, support_->curve);
  operators.b = std::move(support.b);
  operators.g = std::move(support.g);
  operators.weights = std::move(support.weights);
  operators.nodal_b = std::move(support.nodal_b);
  operators.nodal_gap = std::move(support.nodal_gap);
  operators.bound = friction_bound(scene_.support->friction, operators.mu);
}

void Problem::assemble_contact(const Mu &mu, Operators &operators) {
  operators.mu = expand(scene_.parameters, mu);
  if (scene_.nitsche) return;
  if (scene_.support)
    assemble_support(operators);
  else if (scene_.pair)
    assemble_pair(operators);
  else
    assemble_obstacle(operators);
  operators.normal = operators.weights.size();
}

const Trace &Problem::trace() const {
  return support_ ? support_->trace : curves_ ? curves_->trace : contact_->trace;
}

const Operators &Problem::assemble(const Mu &mu) {
  const FullMu all = expand(scene_.parameters, mu);
  assemble_contact(mu, operators_);
  const bool new_a = differs(a_, scene_.a, all), new_f = differs(f_, scene_.f, all);
  if (!a_.made_at || (new_a && a_.mapped) || (new_f && f_.mapped))
    map_cells(scene_, all, mesh_, cells_);
  if (new_a) sum_up(scene_.a, scene_.parameters, all, mesh_, dofs_, cells_, a_);
  if (new_f) sum_up(scene_.f, scene_.parameters, all, mesh_, dofs_, cells_, f_);
  operators_.a = a_.total.get();
  operators_.f = f_.total.get();
  return operators_;
}

Mat Problem::v_product() {
  if (!v_product_) {
    v_product_ = make_matrix(mesh_, dofs_);
    rbvi::assemble(forms_of(scene_.v_product), {}, mesh_, dofs_, reference_cells(mesh_),
                   v_product_.get());
  }
  return v_product_.get();
}

} // namespace rbvi
