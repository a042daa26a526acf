#include "rbvi/fem/problem.hpp"

#include "means.hpp"
#include "rbvi/contact/history.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/core/warnings.hpp"
#include "rbvi/element/axisymmetric_forms.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/fem/assembly.hpp"
#include "rbvi/fem/check_scene.hpp"
#include "rbvi/method/balance.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/columns.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace rbvi {

namespace {

/// Throws bad_input where B or G has an entry that is not finite: so is a gap or a normal.
void check_finite(const Scene &scene, const Contact &contact, const Operators &operators) {
  const auto is_finite = [&](Index row) {
    bool finite = std::isfinite(operators.g[row]);
    for (SparseMatrix::InnerIterator entry(operators.b, row); entry; ++entry)
      finite = finite && std::isfinite(entry.value());
    return finite;
  };
  for (Index row = 0; row < operators.g.size(); ++row) {
    if (is_finite(row)) continue;
    const DualRow of = dual_row(contact, row);
    const Point &x = contact.interfaces[of.interface]->dual().points[of.node];
    std::string where;
    for (int k = 0; k < scene.dim; ++k)
      where += short_number(x[k]) + ' ';
    throw bad_input("the gap or the normal of " + described(scene.contacts[of.interface]) +
                    " is not finite at the point " + where + "of the reference domain, " +
                    describe(scene.parameters, operators.mu));
  }
}

Dofs numbered_dofs(const Scene &scene, const Mesh &mesh) {
  Dofs dofs = number_dofs(mesh, scene.components, scene.fixed, scene.tied);
  add_couplings(scene, mesh, dofs);
  return dofs;
}

/// The free bodies, with their springs in the scene and the loads of the imposed values behind
/// those of nothing on them, as whoever reads the scene from a file makes them.
std::vector<FreeBody> put_springs(Scene &scene, const Mesh &mesh, Dofs &dofs) {
  std::vector<FreeBody> bodies = add_springs(scene, mesh, dofs);
  if (!bodies.empty()) scene = with_imposed_loads(std::move(scene));
  return bodies;
}

/// The longest side of the box of the mesh.
double extent_of(const Mesh &mesh) {
  std::vector<double> ends(6, -std::numeric_limits<double>::infinity());
  for (const Point &x : mesh.points)
    for (std::size_t k = 0; k < 3; ++k) {
      ends[k] = std::max(ends[k], x[k]);
      ends[3 + k] = std::max(ends[3 + k], -x[k]);
    }
  over_ranks(mesh.comm, MPI_MAX, ends);
  return std::max({ends[0] + ends[3], ends[1] + ends[4], ends[2] + ends[5]});
}

Scene checked(Scene scene) {
  check_functions(scene);
  check_outputs(scene);
  return scene;
}

} // namespace

std::vector<ContactPoint> at_rest(const std::vector<Mu> &set) {
  std::vector<ContactPoint> points;
  for (const Mu &mu : set)
    points.push_back({mu, {}});
  return points;
}

Problem::Problem(MPI_Comm comm, Scene scene, const MeshOptions &options, Index contact_gather)
    : given_(checked(std::move(scene))), mesh_options_(options),
      scene_(std::make_unique<Scene>(with_imposed_loads(given_))),
      mesh_(make_mesh(comm, *scene_, options)), dofs_(numbered_dofs(*scene_, mesh_)),
      free_(put_springs(*scene_, mesh_, dofs_)), places_(place_interfaces(mesh_, dofs_, *scene_)),
      contact_(make_contact(*scene_, std::exchange(places_.meshes, {}))),
      output_cells_(cells_of_outputs(*scene_, mesh_, dofs_)),
      contact_shares_(rbvi::contact_shares(*scene_, output_cells_, places_.natural_nodes)),
      contact_gather_(contact_gather),
      a_(make_summed<Mat>(scene_->a, scene_->parameters, mesh_, dofs_)),
      f_(make_summed<Vec>(scene_->f, scene_->parameters, mesh_, dofs_)) {
  if (scene_->v_length == 0) scene_->v_product = h1_product_of(*scene_, extent_of(mesh_));
  if (!free_.empty()) stiffen_springs();
  if (imposes_values(*scene_))
    check_imposed(*scene_, generic_point(scene_->parameters), mesh_, dofs_);
  imposed_energy_ = make_imposed_energy(*scene_, mesh_, dofs_);
}

void Problem::stiffen_springs() {
  const FullMu mu = generic_point(scene_->parameters);
  sum_up(scene_->a, scene_->parameters, mu, {mesh_, dofs_, map_vertices(*scene_, mu, mesh_)}, a_);
  stiffen(free_, *scene_, mu, a_);
  beta_ = Vector::Zero(motions_of(free_));
  pressed_ = make_vector(dofs_);
  if (!has_multipliers(*scene_)) return;
  Operators operators;
  Mu free_parameters;
  for (const int p : scene_->parameters.free)
    free_parameters.push_back(mu[p]);
  collectively(comm(), [&] { assemble_contact(free_parameters, operators); });
  const Matrix unresisted = unresisted_motions(operators.laws, held_by(operators));
  if (unresisted.cols() > 0)
    throw bad_input(describe(free_, mesh_.dim, unresisted) +
                    ": impose displacements that prevent it, for no contact does");
}

void Problem::relax_springs(const Vector &beta) {
  beta_ = beta;
  RBVI_CALL(VecCopy(f_.total.get(), pressed_.get()));
  add_spring_forces(free_, spring_coefficients(free_, *scene_, operators_.mu).cwiseProduct(beta_),
                    pressed_.get());
}

double Problem::spring_energy() const {
  if (free_.empty()) return 0;
  return spring_coefficients(free_, *scene_, operators_.mu).dot(beta_.cwiseAbs2()) / 2;
}

Matrix Problem::held_by(const Operators &operators) const {
  Matrix held(operators.b.rows(), motions_of(free_));
  const auto motions = rigid_motions(free_, *scene_, operators.mu, mesh_, dofs_);
  for (Index k = 0; k < held.cols(); ++k)
    held.col(k) = operators.b * restrict_to(trace(), motions[k].get());
  return held;
}

std::array<Vector, 2> Problem::pushed(const FullMu &mu) const {
  Vector sum(motions_of(free_)), terms(sum.size());
  const auto motions = rigid_motions(free_, *scene_, mu, mesh_, dofs_);
  for (Index k = 0; k < sum.size(); ++k) {
    const Vector work = local_values(motions[k].get()).cwiseProduct(local_values(f_.total.get()));
    sum[k] = work.sum();
    terms[k] = work.cwiseAbs().sum();
  }
  over_ranks(comm(), MPI_SUM, sum);
  over_ranks(comm(), MPI_SUM, terms);
  return {sum, terms};
}

std::unique_ptr<Problem> Problem::coarser(int levels) const {
  if (mesh_options_.refine < levels) return nullptr;
  MeshOptions options = mesh_options_;
  options.refine -= levels;
  options.levels = mesh_.levels;
  return std::make_unique<Problem>(comm(), given_, options, contact_gather_);
}

void Problem::assemble_contact(const Mu &mu, Operators &operators, const ContactState &state) {
  operators.mu = expand(scene_->parameters, mu);
  rbvi::assemble(contact_, operators.mu, state, operators);
  operators.laws = laws_at(contact_, operators.mu);
}

const DualLayout &Problem::dual_layout() {
  if (!dual_layout_) dual_layout_ = share_dual(contact_, places_, mesh_, dofs_);
  return *dual_layout_;
}

bool Problem::is_split(std::size_t interface) const {
  const ContactInterface &contact = *contact_.interfaces[interface];
  return ranks_of(comm()) > 1 && contact.can_be_split() && contact.dual().size() > contact_gather_;
}

/// Each rank the rows that it owns, then, where all are wanted, those of the others.
void Problem::assemble_split(ContactRows rows, const Vector &slip) {
  const DualLayout &layout = dual_layout();
  std::vector<ContactOperators> all(contact_.interfaces.size());
  collectively(comm(), [&] {
    for (std::size_t i = 0; i < all.size(); ++i)
      contact_.interfaces[i]->assemble(operators_.mu, {},
                                       is_split(i) ? layout.own[i] : WantedNodes{}, all[i]);
    operators_.laws = laws_at(contact_, operators_.mu);
  });
  for (std::size_t i = 0; i < all.size() && rows == ContactRows::all; ++i)
    if (is_split(i)) gather_rows(layout, contact_, i, all[i]);
  if (all.size() == 1)
    static_cast<ContactOperators &>(operators_) = std::move(all.front());
  else
    stack(contact_, all, operators_);
  if (slip.size() > 0) operators_.g += added_by_history(contact_, slip, operators_.weights);
}

const Operators &Problem::assemble(const Mu &mu, ContactRows rows, const Vector &slip) {
  const FullMu all = expand(scene_->parameters, mu);
  check_contacts(*scene_, all);
  if (imposes_values(*scene_)) check_imposed(*scene_, all, mesh_, dofs_);
  operators_.mu = all;
  bool any_split = false;
  for (std::size_t i = 0; i < contact_.interfaces.size(); ++i)
    any_split = any_split || is_split(i);
  if (any_split)
    assemble_split(rows, slip);
  else
    assemble_contact(mu, operators_, {{}, slip});
  collectively(comm(), [&] { check_finite(*scene_, contact_, operators_); });
  const bool new_a = differs(a_, scene_->a, all), new_f = differs(f_, scene_->f, all);
  if (!a_.made_at || (new_a && a_.mapped) || (new_f && f_.mapped))
    mapped_ = map_vertices(*scene_, all, mesh_);
  if (new_a) sum_up(scene_->a, scene_->parameters, all, {mesh_, dofs_, mapped_}, a_);
  if (new_f) sum_up(scene_->f, scene_->parameters, all, {mesh_, dofs_, mapped_}, f_);
  operators_.a = a_.total.get();
  operators_.f = free_.empty() ? f_.total.get() : pressed_.get();
  if (!free_.empty()) relax_springs(beta_);
  if (!imposed_energy_.sum.empty())
    operators_.imposed_energy = energy_at(imposed_energy_, *scene_, all, mesh_, dofs_, mapped_);
  return operators_;
}

Vector Problem::imposed_displacement(const Mu &mu) const {
  return natural_imposed(*scene_, expand(scene_->parameters, mu), mesh_, dofs_);
}

void add_named_outputs(const Problem &problem, const FullMu &mu, const Vector &u,
                       const Vector &lambda, Outputs &outputs) {
  const Index components = problem.dofs().components;
  const auto at = [&](const auto &nodes) {
    Vector own(std::ssize(nodes) * components);
    for (std::size_t k = 0; k < nodes.size(); ++k)
      own.segment(static_cast<Index>(k) * components, components) =
          u.segment(nodes[k] * components, components);
    return own;
  };
  std::optional<Vector> at_cells;
  const auto of_cells = [&](int output) {
    if (!at_cells) at_cells = at(problem.output_cells().nodes);
    return cell_output(problem.scene(), output, mu, problem.output_cells(), *at_cells);
  };
  const OutputSources sources{problem.contact_shares(),
                              [&](std::size_t i) { return at(problem.places().natural_nodes[i]); },
                              of_cells};
  add_named_outputs(problem.scene(), problem.contact(), mu, sources, lambda, outputs);
  add_gap_error(problem.scene(), problem.contact(), mu, sources.of_interface, lambda, outputs);
}

Mat Problem::v_product() {
  if (!v_product_) {
    v_product_ = make_matrix(mesh_, dofs_);
    rbvi::assemble(forms_of(scene_->v_product), {}, mesh_, dofs_, {}, v_product_.get());
  }
  return v_product_.get();
}

double strained_share(const Problem &problem, const FullMu &mu, const Vector &u) {
  const Mesh &mesh = problem.mesh();
  const int count = nodes_per_cell(mesh.dim, mesh.degree), dim = mesh.dim;
  std::vector<double> volumes{0, 0}; // of what is strained, of all
  std::array<double, 4> middle{};
  std::fill_n(middle.begin(), dim + 1, 1.0 / (dim + 1));
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    Cell cell = cell_of(mesh, k);
    map_cell(problem.scene(), mu, cell);
    const Simplex geometry = simplex(dim, cell.mapped);
    std::array<std::array<double, 3>, most_nodes> slopes{};
    lagrange_gradients(dim, mesh.degree, middle, geometry, slopes);
    const std::array<int, most_nodes> nodes = nodes_of(mesh, k);
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
    for (int i = 0; i < count; ++i)
      for (int c = 0; c < dim; ++c)
        gradient.row(c) +=
            u[mesh.natural_node[nodes[i]] * dim + c] * Eigen::RowVector3d::Map(slopes[i].data());
    const double volume = geometry.volume * circumference(problem.scene().axisymmetric,
                                                          point_at(cell.mapped, middle, dim + 1));
    volumes[1] += volume;
    const double strain = (gradient + gradient.transpose()).norm() / 2,
                 turn = (gradient - gradient.transpose()).norm() / (2 * std::numbers::sqrt2);
    if (std::max(strain, turn) > large_strain) volumes[0] += volume;
  }
  over_ranks(problem.comm(), MPI_SUM, volumes);
  return volumes[0] / volumes[1];
}

} // namespace rbvi
