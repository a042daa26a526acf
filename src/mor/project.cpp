// Niakh (2022): (1.25), (1.26), (3.41), (3.42).
#include "rbvi/mor/reduce.hpp"

#include "cone_tools.hpp"
#include "eim_terms.hpp"
#include "rbvi/model/packed.hpp"
#include "rbvi/model/training_samples.hpp"
#include "rbvi/mor/fields.hpp"
#include "rbvi/mor/nodal_dual_basis.hpp"
#include "rbvi/mor/operator_entries.hpp"
#include "rbvi/mor/output_candidates.hpp"
#include "rbvi/mor/stiffness_change.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/columns.hpp"
#include "rbvi/par/progress.hpp"
#include "rounding.hpp"

#include <algorithm>
#include <utility>

namespace rbvi {

namespace {

/// V^T A V, its lower triangle column by column; a block of columns of A V at a time. Collective.
Vector project_stiffness(Mat a, Mat basis) {
  constexpr PetscInt width = 64;
  PetscInt n = 0, stride = 0, local = 0;
  PetscScalar *values = nullptr;
  RBVI_CALL(MatGetSize(basis, nullptr, &n));
  RBVI_CALL(MatGetLocalSize(basis, &local, nullptr));
  RBVI_CALL(MatDenseGetLDA(basis, &stride));
  Matrix lower = Matrix::Zero(n, n);
  for (PetscInt first = 0; first < n; first += width) {
    const PetscInt count = std::min(width, n - first);
    Handle<Mat> block, product;
    RBVI_CALL(MatDenseGetArray(basis, &values));
    RBVI_CALL(MatCreateDense(comm_of(a), local, PETSC_DECIDE, PETSC_DETERMINE, count,
                             values + std::ptrdiff_t{first} * stride, block.put()));
    RBVI_CALL(MatDenseSetLDA(block.get(), stride));
    RBVI_CALL(MatAssemblyBegin(block.get(), MAT_FINAL_ASSEMBLY));
    RBVI_CALL(MatAssemblyEnd(block.get(), MAT_FINAL_ASSEMBLY));
    RBVI_CALL(MatMatMult(a, block.get(), MAT_INITIAL_MATRIX, PETSC_DEFAULT, product.put()));
    RBVI_CALL(MatDenseRestoreArray(basis, &values));
    lower.block(first, first, n - first, count).noalias() =
        BorrowedRows(basis).rows().rightCols(n - first).transpose() *
        BorrowedRows(product.get()).rows();
  }
  over_ranks(comm_of(a), MPI_SUM, lower);
  return pack(lower);
}

/// V^T F. Collective.
Vector project_load(MPI_Comm comm, Vec f, Mat basis) {
  Vector result = BorrowedRows(basis).rows().transpose() * local_values(f);
  over_ranks(comm, MPI_SUM, result);
  return result;
}

/// The training numbers that some operator was sampled at, each once; A where it is still to be
/// projected.
std::vector<int> sampled_snapshots(const AffineOperators &affine, bool with_a) {
  std::vector<int> all;
  if (with_a) all = affine.a.snapshots;
  for (const Eim *operator_eim : {&affine.b, &affine.b_tangential, &affine.f, &affine.g})
    all.insert(all.end(), operator_eim->snapshots.begin(), operator_eim->snapshots.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

double error_of(const Eim &eim) {
  return eim.error.empty() ? 0 : eim.error.back();
}

AffineTerms start_terms(const Eim &eim, const std::vector<SampleMesh> &samples, Index entries,
                        Index exact = 0) {
  return {Matrix::Zero(entries, exact + eim.size()), eim.interpolation, samples, error_of(eim),
          static_cast<int>(exact)};
}

/// B^n and B^tau apart have one interpolation matrix, block diagonal.
AffineTerms start_terms_of_b(const AffineOperators &affine, Index entries) {
  AffineTerms terms = start_terms(affine.b, affine.sample_b, entries);
  const Eim &other = affine.b_tangential;
  const Index first = affine.b.size(), count = other.size();
  if (count == 0) return terms;
  terms.reduced = Matrix::Zero(entries, first + count);
  terms.interpolation.conservativeResizeLike(Matrix::Zero(first + count, first + count));
  terms.interpolation.bottomRightCorner(count, count) = other.interpolation;
  terms.error = std::max(terms.error, error_of(other));
  return terms;
}

} // namespace

void describe_mesh(const Problem &problem, ReducedModel &model) {
  model.made.mesh_fingerprint = problem.mesh().fingerprint;
  const auto &interfaces = problem.contact().interfaces;
  for (std::size_t i = 0; i < interfaces.size(); ++i) {
    const std::vector<PetscInt> &nodes = problem.places().natural_nodes[i];
    model.contact.interfaces.push_back({interfaces[i]->mesh(), {nodes.begin(), nodes.end()}});
  }
}

namespace {

/// X^T B V.
Matrix sandwiched(const Eigen::Ref<const Matrix> &x, const SparseMatrix &b, const Matrix &v) {
  if (!mostly_zero(x)) return x.transpose() * (b * v);
  const SparseMatrix sparse = x.sparseView();
  return SparseMatrix(SparseMatrix(sparse.transpose()) * b) * v;
}

/// Adds a snapshot of B to the terms that contain it: of B^n and B^tau apart each has its own.
void accumulate_b(const Problem &problem, const AffineOperators &affine, int snapshot,
                  const Operators &op, const Matrix &trace, ReducedModel &model) {
  Index first = 0;
  for (const auto &[eim, row, rows] : rows_of_b(affine, problem)) {
    const Index begin = std::exchange(first, first + eim.size());
    if (!uses(eim, snapshot)) continue;
    const Matrix reduced = sandwiched(model.contact.dual_basis.middleRows(row, rows),
                                      op.b.middleRows(row, rows), trace);
    accumulate(eim, snapshot, reduced.reshaped(),
               model.contact.b.reduced.middleCols(begin, eim.size()));
  }
}

/// The training multipliers, where they are, and the displacements that contact follows.
void store_multipliers(const Problem &problem, const std::vector<Sample> &samples,
                       const Matrix &basis, NodalLaw &law) {
  law.starts = nodal_coefficients(basis, multipliers_of(samples));
  law.starts_mu = as_columns(parameters_of(samples), static_cast<int>(samples.front().mu.size()));
  if (!follows_state(problem.scene())) return;
  law.states.resize(problem.trace().size, law.starts.cols());
  for (std::size_t p = 0; p < samples.size(); ++p)
    law.states.col(p) = displacement(problem.comm(), samples[p])(problem.places().natural_dofs);
}

/// e_EIM along the terms, and the training number of each.
void add_separation(const AffineOperators &affine,
                    std::map<std::string, std::vector<double>> &histories) {
  const bool apart = affine.b_tangential.size() > 0;
  const auto add = [&](const std::string &name, const Eim &eim) {
    histories["eim/" + name] = eim.error;
    histories["eim_selected/" + name] = {eim.snapshots.begin(), eim.snapshots.end()};
  };
  add("a", affine.a);
  add(apart ? "b_normal" : "b", affine.b);
  if (apart) add("b_tangential", affine.b_tangential);
  add("f", affine.f);
  add("g", affine.g);
}

/// The model's names and sizes.
ReducedModel start_model(const Problem &problem, const ReducedBases &bases) {
  const Scene &scene = problem.scene();
  ReducedModel model;
  model.scene = scene;
  model.body.modes = bases.modes;
  model.body.supremizers = bases.supremizers + bases.responses;
  model.body.online_enriched = bases.online_enriched;
  model.contact.dual_basis = bases.nodal_dual.rows() > 0 ? bases.nodal_dual : bases.cone.all();
  model.contact.free_modes = static_cast<int>(bases.cone.modes.columns.cols());
  model.contact.generators = static_cast<int>(model.contact.dual_basis.cols());
  return model;
}

NodalLaw start_law(const Problem &problem, const std::vector<Sample> &samples,
                   const AffineOperators &affine, const ReducedBases &bases,
                   const ReducedModel &model) {
  NodalLaw law;
  for (Index column = 0; column < model.contact.generators; ++column) {
    Index row = 0;
    model.contact.dual_basis.col(column).cwiseAbs().maxCoeff(&row);
    if (dual_row(problem.contact(), row).normal) ++law.normal;
  }
  law.reduction = bases.reduction;
  law.mended = bases.mended;
  law.basis = bases.multipliers.basis;
  law.condensed = bases.condensed;
  if (affine.b_tangential.size() > 0)
    law.apart = {affine.b.size(), error_of(affine.b), error_of(affine.b_tangential)};
  store_multipliers(problem, samples, model.contact.dual_basis, law);
  return law;
}

/// The separated operators, their terms zero.
void start_operators(const Problem &problem, const std::vector<Sample> &samples,
                     const AffineOperators &affine, const ReducedBases &bases,
                     ReducedModel &model) {
  const Index n = model.primal_size(), generators = model.contact.generators;
  model.body.a = start_terms(affine.a, affine.sample_a, 0, std::ssize(problem.a_terms().exact));
  model.contact.b = start_terms_of_b(affine, generators * n);
  model.body.f = start_terms(affine.f, affine.sample_f, n, std::ssize(problem.f_terms().exact));
  model.contact.g = start_terms(affine.g, affine.sample_g, generators);
  if (bases.nodal_dual.size() > 0)
    model.contact.law = start_law(problem, samples, affine, bases, model);
}

/// Adds the operators of the snapshots that the terms are made of. Collective.
void project_snapshots(Problem &problem, const std::vector<Sample> &samples,
                       const AffineOperators &affine, Mat basis, ReducedModel &model) {
  const bool with_a = model.body.a_change.rank() == 0;
  const std::vector<int> snapshots = sampled_snapshots(affine, with_a);
  Progress progress("samples of operators projected", static_cast<int>(snapshots.size()),
                    rank_of(problem.comm()) == 0);
  int done = 0;
  for (const int p : snapshots) {
    progress.update(done++);
    const Operators &op = problem.assemble(samples[p].mu);
    if (with_a && uses(affine.a, p))
      accumulate(affine.a, p, project_stiffness(problem.a_terms().mapped.get(), basis),
                 model.body.a.reduced.rightCols(affine.a.size()));
    if (affine.b_size() > 0) accumulate_b(problem, affine, p, op, model.contact.trace, model);
    if (uses(affine.g, p))
      accumulate(affine.g, p, model.contact.dual_basis.transpose() * op.g, model.contact.g.reduced);
    if (uses(affine.f, p))
      accumulate(affine.f, p, project_load(problem.comm(), problem.f_terms().mapped.get(), basis),
                 model.body.f.reduced.rightCols(affine.f.size()));
  }
}

/// The first column of A's terms where they differ on few functions, else its exact terms, and
/// room for those of the snapshots; the exact terms of F. Collective.
void project_exact(Problem &problem, const std::vector<Sample> &samples,
                   const AffineOperators &affine, Mat basis, ReducedModel &model) {
  const Index n = model.primal_size();
  StiffnessChange &change = model.body.a_change;
  std::vector<Mu> set;
  for (const int p : affine.a.snapshots)
    set.push_back(samples[p].mu);
  if (model.contact.generators > 0 && !model.contact.law && !model.body.online_enriched)
    change = stiffness_change(problem, affine.a, set, basis);
  const bool few = change.rank() > 0;
  model.body.a.reduced.setZero(n * (n + 1) / 2, few ? 1 : model.body.a.size());
  if (few) {
    problem.assemble(set.front());
    model.body.a.reduced.col(0) = project_stiffness(problem.a_terms().mapped.get(), basis);
  }
  Index q = 0;
  for (const Handle<Mat> &term : problem.a_terms().exact)
    model.body.a.reduced.col(q++) = project_stiffness(term.get(), basis);
  q = 0;
  for (const Handle<Vec> &term : problem.f_terms().exact)
    model.body.f.reduced.col(q++) = project_load(problem.comm(), term.get(), basis);
}

/// The springs of bodies that contact alone holds. Collective.
void project_springs(const Problem &problem, const std::vector<Sample> &samples, Mat basis,
                     BodyModel &body) {
  const std::vector<FreeBody> &bodies = problem.free_bodies();
  if (bodies.empty()) return;
  const Index motions = motions_of(bodies);
  for (const FreeBody &free : bodies)
    body.spring_terms.insert(body.spring_terms.end(), static_cast<std::size_t>(free.motions.cols()),
                             free.term);
  body.springs.resize(body.modes + body.supremizers, motions);
  for (Index k = 0; k < motions; ++k) {
    const Handle<Vec> force = make_vector(problem.dofs());
    add_spring_forces(bodies, Vector::Unit(motions, k), force.get());
    body.springs.col(k) = project_load(problem.comm(), force.get(), basis);
  }
  body.motions.resize(motions, std::ssize(samples));
  for (std::size_t p = 0; p < samples.size(); ++p)
    body.motions.col(p) = spring_lengths(
        bodies, from_natural(problem.dofs(), displacement(problem.comm(), samples[p])).get());
}

/// The primal basis at the nodes that outputs are taken from. Collective.
void project_outputs(const Problem &problem, const std::vector<Sample> &samples, Mat basis,
                     OutputModel &outputs) {
  outputs.cells = candidate_cells(problem.comm(), problem.scene(), problem.output_cells(), samples);
  const std::vector<int> &nodes = outputs.cells.nodes;
  if (nodes.empty()) return;
  const Index components = problem.dofs().components;
  PetscInt n = 0;
  RBVI_CALL(MatGetSize(basis, nullptr, &n));
  outputs.basis.resize(std::ssize(nodes) * components, n);
  for (PetscInt j = 0; j < n; ++j) {
    Vec column = nullptr;
    RBVI_CALL(MatDenseGetColumnVecRead(basis, j, &column));
    const Vector whole = to_natural(problem.dofs(), column);
    RBVI_CALL(MatDenseRestoreColumnVecRead(basis, j, &column));
    for (std::size_t k = 0; k < nodes.size(); ++k)
      outputs.basis.col(j).segment(static_cast<Index>(k) * components, components) =
          whole.segment(nodes[k] * components, components);
  }
}

/// Leaves in the trace of a large pair of spaces the nodes over which contact moves, those that
/// generators reach and free modes do not, and two layers around them.
void restrict_trace(Problem &problem, const Mu &any, ReducedModel &model) {
  constexpr Index large = 100000;
  constexpr int layers = 2;
  if (model.contact.law || model.contact.b.size() == 0 || model.contact.trace.size() < large ||
      !problem.scene().outputs.empty())
    return;
  const auto nonzero = [](const auto &row) { return (row.array() != 0).any(); };
  std::vector<bool> near(model.contact.dual_basis.rows());
  for (Index row = 0; row < model.contact.dual_basis.rows(); ++row)
    near[row] = nonzero(model.contact.dual_basis.row(row).head(model.contact.generators -
                                                               model.contact.free_modes)) &&
                !nonzero(model.contact.dual_basis.row(row).tail(model.contact.free_modes));
  for (int layer = 0; layer < layers; ++layer)
    add_neighbours(near, problem.w_product());
  Operators op;
  problem.assemble_contact(any, op);
  std::vector<bool> known(model.contact.trace.rows(), false);
  for (Index row = 0; row < op.b.rows(); ++row)
    for (SparseMatrix::InnerIterator entry(op.b, row); entry; ++entry)
      if (near[row]) known[entry.col()] = true;
  for (std::size_t dof = 0; dof < known.size(); ++dof)
    if (known[dof]) model.contact.trace_dofs.push_back(static_cast<int>(dof));
  model.contact.trace = model.contact.trace(model.contact.trace_dofs, Eigen::all).eval();
}

void store_histories(const AffineOperators &affine, const ReducedBases &bases,
                     std::map<std::string, std::vector<double>> &histories) {
  const ConeHistory &cone = bases.cone.history;
  histories["pod/error"] = bases.pod.error;
  histories["cone/size"] = {cone.size.begin(), cone.size.end()};
  histories["cone/error"] = cone.error;
  histories["cone/e_orth"] = cone.e_orth;
  histories["cone/gram_condition"] = cone.gram_condition;
  histories["normal_cone/error"] = bases.multipliers.normal.error;
  histories["tangential/error"] = bases.multipliers.tangential;
  histories["pga/sigma"] = bases.pga.sigma;
  if (bases.infsup_tolerance > 0) histories["pga/tolerance"] = {bases.infsup_tolerance};
  histories["pga/selected"] = {bases.pga.selected.begin(), bases.pga.selected.end()};
  add_separation(affine, histories);
}

/// The trace tells of displacements alone, whose error is that of the responses to answers: each
/// function to a digit more than that.
void round_trace(double left, Matrix &trace) {
  constexpr double beside = 0.1;
  for (auto column : trace.colwise())
    if (const double size = column.lpNorm<Eigen::Infinity>(); left > 0 && size > 0)
      round_entries(column, beside * left * size);
}

} // namespace

ReducedModel project(Problem &problem, const std::vector<Sample> &samples,
                     const AffineOperators &affine, const ReducedBases &bases) {
  ReducedModel model = start_model(problem, bases);
  describe_mesh(problem, model);
  start_operators(problem, samples, affine, bases, model);
  model.body.imposed_energy = separate_imposed_energy(problem);
  {
    const BorrowedColumns basis(bases.pod.basis.columns.get());
    project_exact(problem, samples, affine, basis.get(), model);
    project_springs(problem, samples, basis.get(), model.body);
    model.contact.trace = restrict_to(problem.trace(), basis.get());
    project_outputs(problem, samples, basis.get(), model.outputs);
    project_snapshots(problem, samples, affine, basis.get(), model);
  }
  restrict_trace(problem, samples.front().mu, model);
  round_trace(bases.left_by_answers, model.contact.trace);
  model.fields.key = key_of_fields(problem, bases.pod.basis);
  store_histories(affine, bases, model.made.histories);
  return model;
}

} // namespace rbvi
