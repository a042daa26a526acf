// The supremizers of a reduced pair of spaces, offline.
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/model/law_problem.hpp"
#include "rbvi/mor/high_fidelity_pair.hpp"
#include "rbvi/par/collective.hpp"
#include "shared_stages.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace rbvi {

namespace {

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

/// The functions of the multipliers that the bases have: dual dofs x any number.
Matrix dual_functions(const ReducedBases &bases) {
  return bases.nodal_dual.size() > 0
             ? multiplier_functions(bases.nodal_dual, bases.multipliers.basis)
             : bases.cone.all();
}

/// The product in which supremizers are made.
Mat product_of(const Reducing &at) {
  return at.stiffness ? at.stiffness.get() : at.problem.v_product();
}

void make_riesz(Reducing &at) {
  at.training = contact_points(at.samples);
  if (at.made.affine.b_size() == 1) at.training.resize(1);
  at.dual = orthonormal_dual_basis(dual_functions(at.made.bases), at.problem.w_product());
  at.stiffness = {};
  if (at.options.product == SupremizerProduct::energy)
    RBVI_CALL(MatDuplicate(at.problem.assemble(reference_of(at.problem, at.options)).a,
                           MAT_COPY_VALUES, at.stiffness.put()));
  const std::vector<Index> dofs = coupled_dofs(at.problem, at.dual, at.training);
  at.riesz = make_riesz_space(
      product_of(at), at.problem.trace(), dofs,
      at.training.size() == 1 ? loads_at(at.problem, at.training.front(), at.dual)(dofs, Eigen::all)
                              : Matrix());
}

void find_tolerance(Reducing &at) {
  at.made.bases.infsup_tolerance = infsup_tolerance(at.problem, product_of(at), at.training);
}

/// Of the greedy, or the span of all supremizers, behind the modes.
void add_supremizers(Reducing &at) {
  ReducedBases &bases = at.made.bases;
  const RieszSpace riesz = std::exchange(at.riesz, {});
  Matrix dual = std::exchange(at.dual, {});
  PgaOptions pga = at.options.pga;
  if (at.options.infsup_tolerance && at.options.enrichment == Enrichment::offline)
    pga.tolerance = bases.infsup_tolerance;
  const Matrix modes =
      at.stiffness ? mode_coordinates(riesz, orthonormalised(bases.pod.basis, at.stiffness.get()))
                   : mode_coordinates(riesz, bases.pod.basis);
  std::vector<Matrix> supremizers;
  take_turns(at.problem.comm(), at.training.size(), [&](std::size_t p) {
    supremizers.push_back(riesz.loads.size() > 0
                              ? Matrix(riesz.factor.transpose())
                              : supremizers_at(at.problem, riesz, dual, {at.training[p]}).front());
  });
  dual.resize(0, 0); // its room is wanted for what follows
  bases.online_enriched = at.options.enrichment == Enrichment::online;
  if (bases.online_enriched) {
    supremizers =
        span_of_supremizers(at.problem.comm(), riesz, std::move(supremizers), at.training.size());
    pga = {.tolerance = 1e-9}; // all but what the modes hold
  }
  bases.pga = projected_greedy(at.problem.comm(), riesz, modes, std::move(supremizers), pga);
  if (bases.pga.representers.cols() == 0) return;
  bases.supremizers = static_cast<int>(
      append_representers(riesz, bases.pga.representers, bases.pod.basis, 1e-10).size());
}

/// When the greedy stops.
std::string pga_target(const ReduceOptions &options) {
  if (options.infsup_tolerance) return "sigma <= beta_HF / c_HF at all training mu";
  if (options.pga.tolerance > 0) return "sigma <= " + short_number(options.pga.tolerance);
  return "beta_off >= " + short_number(options.pga.stability) + " beta_on";
}

StageRow pga_row(const Scene &scene, const ReduceOptions &options, const Reduction *made) {
  const std::string product = options.product == SupremizerProduct::energy ? " in energy" : "";
  if (made == nullptr && options.enrichment == Enrichment::online)
    return {stage::pga, "the span of all supremizers" + product};
  if (made == nullptr)
    return {stage::pga, "supremizers" + product + " until " + pga_target(options) +
                            (separable_contact(scene) ? "; one SVD if B(mu) = s(mu) B" : "")};
  const ReducedBases &bases = made->bases;
  return {stage::pga, "S = " + counted(bases.supremizers, "supremizer") + product + ", sigma " +
                          short_number(bases.pga.sigma.back()) + ", " + bases.pga.reason};
}

} // namespace

Matrix multiplier_functions(const Matrix &nodal, const MultiplierBasis &basis) {
  return nodal * multiplier_coefficients(basis);
}

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

double generators_of(const ReductionSize &size) {
  return size.responses(size.joined) + 5 * size.multipliers * size.joined;
}

Joining supremizers_join(const Scene &scene, const ReduceOptions &options,
                         const ReductionSize &size) {
  constexpr double moving_part = 1 / 8.0; // of the multipliers, which a cone has hats for
  if (options.enrichment == Enrichment::decorrelated) return {};
  const bool hats = options.cone.type >= ConeType::nodal;
  const double coarser = std::pow(2, scene.dim * options.cone.level);
  return {
      std::min(hats ? size.multipliers * moving_part / coarser : size.samples, size.multipliers)};
}

void add_supremizer_stages(const ReduceOptions &options, std::vector<ReductionStage> &list) {
  if (options.enrichment == Enrichment::decorrelated) {
    list.push_back({stage::pga, [](const Scene &, const ReduceOptions &, const Reduction *) {
                      return StageRow{stage::pga, "no supremizers are wanted (-pga_enrichment)",
                                      StageKind::skipped};
                    }});
    return;
  }
  list.push_back({stage::riesz,
                  [](const Scene &, const ReduceOptions &of, const Reduction *) {
                    return StageRow{stage::riesz, of.product == SupremizerProduct::energy
                                                      ? "one factorisation of A at the reference mu"
                                                      : "one factorisation of V for all mu"};
                  },
                  make_riesz,
                  [](const ReductionSize &size) {
                    return StageNeed{.numbers = generators_of(size),
                                     .seconds = size.factorisation + size.joined * size.factor /
                                                                         size.ranks *
                                                                         column_seconds};
                  }});
  if (options.infsup_tolerance && options.enrichment == Enrichment::offline)
    list.push_back({stage::infsup_tolerance,
                    [](const Scene &, const ReduceOptions &, const Reduction *made) {
                      return StageRow{
                          stage::infsup_tolerance,
                          "smallest beta_HF / c_HF" +
                              (made == nullptr
                                   ? " over the training set"
                                   : ": " + short_number(made->bases.infsup_tolerance))};
                    },
                    find_tolerance,
                    [](const ReductionSize &size) {
                      return StageNeed{iterates_constants(size.multipliers, size.dofs)
                                           ? 4 * size.factor / size.ranks
                                           : size.factor + 4 * size.contact * size.contact};
                    }});
  list.push_back({stage::pga, pga_row, add_supremizers, [](const ReductionSize &size) {
                    constexpr double of_coordinate = 1e-8; // seconds
                    return StageNeed{
                        .numbers = generators_of(size) + 1.5 * size.dofs * size.joined / size.ranks,
                        .seconds = of_coordinate * size.multipliers * size.joined * size.joined};
                  }});
}

} // namespace rbvi
