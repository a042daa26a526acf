#include "rbvi/mor/reduce.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/model/self_check.hpp"
#include "rbvi/mor/high_fidelity_pair.hpp"
#include "rbvi/mor/nodal_dual_basis.hpp"
#include "rbvi/mor/reduced_balance.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/methods.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace rbvi {

namespace {

Mu reference_of(const Problem &problem, const ReduceOptions &options) {
  return options.reference.empty() ? box_centre(problem.scene().parameters) : options.reference;
}

Cone build_dual_basis(Problem &problem, const Mu &reference, const Matrix &snapshots,
                      ConeOptions options) {
  if (options.level > 0) options.hats = hats_of_level(problem, options.level);
  if (options.type != ConeType::hybrid) return build_cone(snapshots, problem.w_product(), options);
  const HoldingMultipliers hold = holding(problem, problem.assemble(reference));
  return build_cone(snapshots, problem.w_product(), options, hold);
}

/// A copy of the modes, orthonormal in another product.
LinearBasis orthonormalised(const LinearBasis &modes, Mat product) {
  LinearBasis copy;
  RBVI_CALL(BVDuplicate(modes.columns.get(), copy.columns.put()));
  RBVI_CALL(BVCopy(modes.columns.get(), copy.columns.get()));
  RBVI_CALL(BVSetMatrix(copy.columns.get(), product, PETSC_FALSE));
  RBVI_CALL(BVOrthogonalize(copy.columns.get(), nullptr));
  RBVI_CALL(BVOrthogonalize(copy.columns.get(), nullptr)); // the modes can be far from orthogonal
  return copy;
}

/// Vectors that span S_R(mu) for every mu, in coordinates, on rank 0: T X itself where b only
/// scales, else the representers of all contact dofs that b couples with X at some training mu.
/// `supremizers`: of this rank's turns among `training` mu. Collective.
std::vector<Matrix> span_of_supremizers(MPI_Comm comm, const RieszSpace &riesz,
                                        std::vector<Matrix> supremizers, std::size_t training) {
  if (training == 1) return supremizers;
  const auto factor = riesz.factor.triangularView<Eigen::Lower>();
  Vector coupling = Vector::Zero(riesz.factor.rows());
  for (const Matrix &t : supremizers)
    coupling =
        coupling.cwiseMax(Matrix(factor.transpose().solve(t)).rowwise().lpNorm<Eigen::Infinity>());
  over_ranks(comm, MPI_MAX, coupling);
  if (rank_of(comm) != 0) return {};
  std::vector<Index> touched;
  for (Index i = 0; i < coupling.size(); ++i)
    if (coupling[i] > 1e-12 * coupling.maxCoeff()) touched.push_back(i);
  return {Matrix(riesz.factor.transpose())(Eigen::all, touched)};
}

/// B^T X: all contact dofs x columns of X. Not collective.
Matrix loads_at(Problem &problem, const ContactPoint &at, const Matrix &dual) {
  Operators op;
  problem.assemble_contact(at.mu, op, at.state);
  return op.b.transpose() * dual;
}

/// Contact dofs that b couples with the dual basis at some training mu. Collective.
std::vector<Index> coupled_dofs(Problem &problem, const Matrix &dual,
                                const std::vector<ContactPoint> &training) {
  std::vector<PetscInt> coupled(problem.trace().size, 0);
  Operators op;
  take_turns(problem.comm(), training.size(), [&](std::size_t p) {
    problem.assemble_contact(training[p].mu, op, training[p].state);
    for (Index i = 0; i < dual.rows(); ++i) {
      if ((dual.row(i).array() == 0).all()) continue;
      for (SparseMatrix::InnerIterator entry(op.b, i); entry; ++entry)
        if (entry.value() != 0) coupled[entry.col()] = 1;
    }
  });
  over_ranks(problem.comm(), MPI_MAX, coupled);
  std::vector<Index> dofs;
  for (std::size_t i = 0; i < coupled.size(); ++i)
    if (coupled[i] != 0) dofs.push_back(static_cast<Index>(i));
  return dofs;
}

} // namespace

const std::vector<std::string> &enrichment_names() {
  static const std::vector<std::string> names{"decorrelated", "online", "offline"};
  return names;
}

const std::vector<std::string> &product_names() {
  static const std::vector<std::string> names{"v", "energy"};
  return names;
}

std::vector<Matrix> supremizers_at(Problem &problem, const RieszSpace &riesz, const Matrix &x,
                                   const std::vector<ContactPoint> &set) {
  std::vector<Matrix> result;
  Operators op;
  for (const ContactPoint &at : set) {
    problem.assemble_contact(at.mu, op, at.state);
    result.push_back(supremizer_coordinates(riesz, op.b, x));
  }
  return result;
}

void add_supremizers(Problem &problem, const std::vector<ContactPoint> &training,
                     const ReduceOptions &options, Matrix dual, ReducedBases &bases,
                     StageTable &stages) {
  const bool energy = options.product == SupremizerProduct::energy;
  bases.online_enriched = options.enrichment == Enrichment::online;
  Handle<Mat> stiffness;
  RieszSpace riesz;
  dual = orthonormal_dual_basis(dual, problem.w_product());
  {
    const Stage stage(stages, stage::riesz);
    if (energy)
      RBVI_CALL(MatDuplicate(problem.assemble(reference_of(problem, options)).a, MAT_COPY_VALUES,
                             stiffness.put()));
    const std::vector<Index> dofs = coupled_dofs(problem, dual, training);
    riesz = make_riesz_space(energy ? stiffness.get() : problem.v_product(), problem.trace(), dofs,
                             training.size() == 1
                                 ? loads_at(problem, training.front(), dual)(dofs, Eigen::all)
                                 : Matrix());
  }
  PgaOptions pga = options.pga;
  if (will_run(stages, stage::infsup_tolerance)) {
    const Stage stage(stages, stage::infsup_tolerance);
    pga.tolerance =
        infsup_tolerance(problem, energy ? stiffness.get() : problem.v_product(), training);
    bases.infsup_tolerance = pga.tolerance;
  }
  const Stage stage(stages, stage::pga);
  const Matrix modes =
      energy ? mode_coordinates(riesz, orthonormalised(bases.pod.basis, stiffness.get()))
             : mode_coordinates(riesz, bases.pod.basis);
  std::vector<Matrix> supremizers;
  take_turns(problem.comm(), training.size(), [&](std::size_t p) {
    supremizers.push_back(riesz.loads.size() > 0
                              ? Matrix(riesz.factor.transpose())
                              : supremizers_at(problem, riesz, dual, {training[p]}).front());
  });
  dual.resize(0, 0); // its room is wanted for what follows
  if (bases.online_enriched) {
    supremizers =
        span_of_supremizers(problem.comm(), riesz, std::move(supremizers), training.size());
    pga = {.tolerance = 1e-9}; // all but what the modes hold
  }
  bases.pga = projected_greedy(problem.comm(), riesz, modes, std::move(supremizers), pga);
  if (bases.pga.representers.cols() == 0) return;
  bases.supremizers = static_cast<int>(
      append_representers(riesz, bases.pga.representers, bases.pod.basis, 1e-10).size());
}

namespace {

/// Of bodies that contact alone holds, at the training parameters: with them in the space the
/// forces of its answers balance to round-off. Collective.
void add_rigid_motions(Problem &problem, const std::vector<Sample> &samples, LinearBasis &basis) {
  constexpr double outside = 1e-8;
  constexpr int enough = 3; // samples in a row that add none
  if (problem.free_bodies().empty()) return;
  const Mat layout = problem.v_product();
  int without = 0;
  for (std::size_t p = 0; p < samples.size() && without < enough; ++p) {
    const auto motions = rigid_motions(problem.free_bodies(), problem.scene(),
                                       expand(problem.scene().parameters, samples[p].mu),
                                       problem.mesh(), problem.dofs());
    Matrix columns(std::ssize(problem.dofs().natural_owned), std::ssize(motions));
    for (Index k = 0; k < columns.cols(); ++k)
      columns.col(k) = local_values(motions[k].get());
    const bool added =
        !append_orthonormalised(basis, dense_like(layout, columns).get(), outside).empty();
    without = added ? 0 : without + 1;
  }
}

} // namespace

void add_modes(Problem &problem, const std::vector<Sample> &samples, const PodOptions &options,
               ReducedBases &bases, StageTable &stages) {
  const Stage stage(stages, stage::pod);
  std::vector<Handle<Vec>> owned;
  std::vector<Vec> snapshots;
  for (const Sample &sample : samples) {
    owned.push_back(from_natural(problem.dofs(), displacement(problem.comm(), sample)));
    snapshots.push_back(owned.back().get());
  }
  bases.pod = pod(snapshots, problem.v_product(), options);
  const PetscInt modes = bases.pod.basis.size();
  add_rigid_motions(problem, samples, bases.pod.basis);
  std::vector<double> &error = bases.pod.error; // what is left of the snapshots is as before
  error.insert(error.begin() + modes, static_cast<std::size_t>(bases.pod.basis.size() - modes),
               error[static_cast<std::size_t>(modes)]);
  bases.modes = static_cast<int>(bases.pod.basis.size());
}

ReducedBases build_bases(Problem &problem, const std::vector<Sample> &samples,
                         const ReduceOptions &options, bool b_is_scaled, StageTable &stages) {
  const Matrix multipliers = multipliers_of(samples);
  ReducedBases bases;
  add_modes(problem, samples, options.pod, bases, stages);
  bases.cone = timed(stages, stage::cone, [&] {
    return build_dual_basis(problem, reference_of(problem, options), multipliers, options.cone);
  });
  if (!will_run(stages, stage::pga)) return bases;
  std::vector<ContactPoint> training = contact_points(samples);
  if (b_is_scaled) training.resize(1);
  add_supremizers(problem, training, options, bases.cone.all(), bases, stages);
  return bases;
}

namespace {

/// What a self-check found, on every rank.
struct Checked {
  int unanswered = 0;
  bool met = true;                                                ///< to round-off
  int wrong() const { return met ? 0 : std::max(1, unanswered); } ///< queries
};

/// Collective. The self-check into the model of rank 0.
Checked check_answers(const Problem &problem, ReducedModel &model, StageTable &stages) {
  const Stage stage(stages, stage::self_check);
  std::array<int, 2> found{};
  collectively(problem.comm(), [&] {
    if (rank_of(problem.comm()) != 0) return;
    look_for_other_answers(model, problem.scene());
    model.made.self_check = self_check(model, problem.scene(), queries_of_check(model));
    found = {model.made.self_check.unanswered, model.made.self_check.answered() ? 1 : 0};
  });
  MPI_Bcast(found.data(), 2, MPI_INT, 0, problem.comm());
  compare_balance(problem, model);
  return {found[0], found[1] != 0};
}

void add_collocation(Problem &problem, const std::vector<Sample> &samples,
                     const GcnsOptions &options, Reduction &result) {
  const Stage stage(result.stages, stage::collocation);
  result.collocation = collocate(result.model, problem, samples, options);
  const Gcns &nodes = result.collocation;
  result.model.made.histories["gcns/nodes"] = {nodes.count.begin(), nodes.count.end()};
  result.model.made.histories["gcns/error"] = nodes.error;
  result.model.made.histories["gcns/violation"] = nodes.violation;
}

/// ContactModel::starts. Collective.
void add_starts_of_pair(const Problem &problem, const std::vector<Mu> &training,
                        ReducedModel &model) {
  Matrix starts = Matrix::Zero(model.contact.generators, std::ssize(training));
  OnlineSolver solver(model, problem.scene());
  take_turns(problem.comm(), training.size(), [&](std::size_t p) {
    try {
      starts.col(static_cast<Index>(p)) = solver.solve(training[p]).lambda;
    } catch (const Error &) { // has no answer
    }
  });
  over_ranks(problem.comm(), MPI_SUM, starts);
  model.contact.starts = std::move(starts);
}

struct CheckedPair {
  ReducedBases bases;
  ReducedModel model;
  int ring, wrong;
};

CheckedPair checked_pair(Problem &problem, const std::vector<Sample> &samples,
                         const ReduceOptions &options, const AffineOperators &affine,
                         StageTable &stages) {
  CheckedPair pair{build_bases(problem, samples, options, affine.b_size() == 1, stages),
                   {},
                   options.cone.ring,
                   0};
  pair.model = timed(stages, stage::projection,
                     [&] { return project(problem, samples, affine, pair.bases); });
  pair.wrong = check_answers(problem, pair.model, stages).wrong();
  return pair;
}

/// A pair whose answers are checked. The zones of a hybrid cone are those of the training samples:
/// where contact opens or closes between them, its layers of nodes are doubled until every query is
/// answered, or until all nodes are in the zones; the narrowest ring that answers most is kept. A
/// training set without the corners of the box does not know how far contact reaches: at least one.
/// A bound of the size of the cone bounds its ring as well; without supremizers its ring is not why
/// queries have no answer.
void reduce_pair(Problem &problem, const std::vector<Sample> &samples, ReduceOptions options,
                 Reduction &result) {
  constexpr int widest = 64;
  const bool widens = options.cone.type == ConeType::hybrid && options.cone.max_size == 0 &&
                      will_run(result.stages, stage::pga);
  if (widens && options.cone.ring == 0 &&
      !holds_corners(problem.scene().parameters, parameters_of(samples)))
    options.cone.ring = 1;
  // One pair at a time: its fields are as large as the mesh.
  CheckedPair pair = checked_pair(problem, samples, options, result.affine, result.stages);
  const auto hats = [&] { return pair.bases.cone.basis.generators.cols(); };
  int best = pair.ring, fewest = pair.wrong;
  while (widens && fewest > 0 && options.cone.ring < widest) {
    const Index before = hats();
    const int last = std::exchange(options.cone.ring, std::max(1, 2 * options.cone.ring));
    pair = {};
    pair = checked_pair(problem, samples, options, result.affine, result.stages);
    if (hats() == before) {
      pair.ring = last; // the same pair
      break;
    }
    if (pair.wrong < fewest) {
      fewest = pair.wrong;
      best = pair.ring;
    }
  }
  if (pair.ring != best) {
    options.cone.ring = best;
    pair = {};
    pair = checked_pair(problem, samples, options, result.affine, result.stages);
  }
  result.bases = std::move(pair.bases);
  result.model = std::move(pair.model);
  result.ring = pair.ring;
  const Stage stage(result.stages, stage::self_check);
  add_starts_of_pair(problem, parameters_of(samples), result.model);
}

/// The published reduction, of one interface, interpolates B^n and B^tau apart. The others see B in
/// the condensed operator alone, which grows with the square of the number of its terms.
std::optional<RowOptions> rows_apart(const Scene &scene, const ReduceOptions &options) {
  if (options.multipliers.reduction != MultiplierReduction::collocated || scene.contacts.size() > 1)
    return std::nullopt;
  RowOptions apart{options.eim, options.eim};
  apart.normal.tolerance = options.eim_normal.value_or(options.eim.tolerance);
  apart.tangential.tolerance = options.eim_tangential.value_or(options.eim.tolerance);
  return apart;
}

void make_law(Problem &problem, const std::vector<Sample> &samples, const ReduceOptions &options,
              Reduction &result) {
  result.bases = build_law_bases(problem, samples, options, result.affine, result.stages);
  {
    const Stage stage(result.stages, stage::projection);
    result.model = project(problem, samples, result.affine, result.bases);
    if (result.bases.condensed.terms.size() > 0) add_starts(result.model, problem);
  }
  compress_responses(problem, samples, result.affine, result.bases, result.model, result.stages);
  if (will_run(result.stages, stage::collocation))
    add_collocation(problem, samples, options.gcns, result);
}

/// The law at nodes; at all of them where contact reaches the edge of those near it.
void reduce_law(Problem &problem, const std::vector<Sample> &samples, ReduceOptions options,
                Reduction &result) {
  make_law(problem, samples, options, result);
  const Checked checked = check_answers(problem, result.model, result.stages);
  if (checked.unanswered == 0 || result.bases.dropped == 0) return;
  options.condensed.ring = std::numeric_limits<double>::infinity();
  result.bases = {}; // one basis at a time: its fields are as large as the mesh
  make_law(problem, samples, options, result);
  check_answers(problem, result.model, result.stages);
}

} // namespace

Reduction reduce(Problem &problem, const std::vector<Sample> &samples, const ReduceOptions &given) {
  ReduceOptions options = given;
  options.multipliers.reduction = reduction_of(problem.scene(), given.multipliers.reduction);
  check_reduction(problem.scene(), options);
  const std::vector<Mu> training = parameters_of(samples);
  if (training.empty()) throw failure("there is no sample to build a basis from");
  Reduction result;
  result.stages = reduction_stages(problem.scene(), options);
  result.affine = timed(result.stages, stage::interpolation, [&] {
    return separate(problem, training, options.eim, rows_apart(problem.scene(), options));
  });
  if (options.multipliers.reduction == MultiplierReduction::none) {
    reduce_nitsche(problem, samples, options, result);
    check_answers(problem, result.model, result.stages);
  } else if (keeps_law(options.multipliers.reduction)) {
    reduce_law(problem, samples, options, result);
  } else {
    reduce_pair(problem, samples, options, result);
  }
  result.stages =
      finished_stages(result.stages, reduction_stages(problem.scene(), options, &result));
  return result;
}

} // namespace rbvi
