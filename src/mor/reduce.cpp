#include "rbvi/mor/reduce.hpp"

#include "rbvi/core/error.hpp"

namespace rbvi {

namespace {

Pod compress_displacements(Problem &problem, const std::vector<Sample> &samples,
                           const PodOptions &options) {
  std::vector<Handle<Vec>> owned;
  std::vector<Vec> snapshots;
  for (const Sample &sample : samples) {
    owned.push_back(from_natural(problem.dofs(), sample.u));
    snapshots.push_back(owned.back().get());
  }
  return pod(snapshots, problem.v_product(), options);
}

Matrix multipliers(const std::vector<Sample> &samples) {
  Matrix lambda(samples.front().lambda.size(), static_cast<Index>(samples.size()));
  for (std::size_t p = 0; p < samples.size(); ++p)
    lambda.col(static_cast<Index>(p)) = samples[p].lambda;
  return lambda;
}

/// lift * representers as a dense distributed matrix.
Handle<Mat> supremizer_fields(const RieszSpace &riesz, const Matrix &representers) {
  PetscInt rows = 0, total = 0, stride = 0;
  RBVI_CALL(MatGetLocalSize(riesz.lift.get(), &rows, nullptr));
  RBVI_CALL(MatGetSize(riesz.lift.get(), &total, nullptr));
  Handle<Mat> fields;
  RBVI_CALL(MatCreateDense(PetscObjectComm(reinterpret_cast<PetscObject>(riesz.lift.get())), rows,
                           PETSC_DECIDE, total, static_cast<PetscInt>(representers.cols()), nullptr,
                           fields.put()));
  const PetscScalar *lift = nullptr;
  PetscScalar *values = nullptr;
  PetscInt lift_stride = 0;
  RBVI_CALL(MatDenseGetLDA(riesz.lift.get(), &lift_stride));
  RBVI_CALL(MatDenseGetLDA(fields.get(), &stride));
  RBVI_CALL(MatDenseGetArrayRead(riesz.lift.get(), &lift));
  RBVI_CALL(MatDenseGetArrayWrite(fields.get(), &values));
  using Stride = Eigen::OuterStride<>;
  Eigen::Map<Matrix, 0, Stride>(values, rows, representers.cols(), Stride(stride)).noalias() =
      Eigen::Map<const Matrix, 0, Stride>(lift, rows, representers.rows(), Stride(lift_stride)) *
      representers;
  RBVI_CALL(MatDenseRestoreArrayWrite(fields.get(), &values));
  RBVI_CALL(MatDenseRestoreArrayRead(riesz.lift.get(), &lift));
  RBVI_CALL(MatAssemblyBegin(fields.get(), MAT_FINAL_ASSEMBLY));
  RBVI_CALL(MatAssemblyEnd(fields.get(), MAT_FINAL_ASSEMBLY));
  return fields;
}

} // namespace

std::vector<Matrix> supremizers_at(Problem &problem, const RieszSpace &riesz, const Matrix &x,
                                   const std::vector<Mu> &set) {
  std::vector<Matrix> result;
  Operators op;
  for (const Mu &mu : set) {
    problem.assemble_contact(mu, op);
    result.push_back(supremizer_coordinates(riesz, op.b, x));
  }
  return result;
}

ReducedBases build_bases(Problem &problem, const std::vector<Sample> &samples,
                         const ReduceOptions &options, bool b_is_scaled, StageTimes &times) {
  if (samples.empty()) throw failure("there is no sample to build a basis from");
  ReducedBases bases;
  {
    const Stage stage("POD", times);
    bases.pod = compress_displacements(problem, samples, options.pod);
    bases.modes = static_cast<int>(bases.pod.basis.size());
  }
  {
    const Stage stage("cone", times);
    bases.cone = build_cone(multipliers(samples), problem.w_product(), options.cone);
    bases.dual = orthonormal_dual_basis(bases.cone.basis.generators, problem.w_product());
  }
  {
    const Stage stage("Riesz representers", times);
    bases.riesz = make_riesz_space(problem.v_product(), problem.trace());
  }
  {
    const Stage stage("PGA", times);
    std::vector<Mu> training;
    for (const Sample &sample : samples)
      training.push_back(sample.mu);
    if (b_is_scaled) training.resize(1);
    const Matrix modes = mode_coordinates(bases.riesz, bases.pod.basis, problem.trace());
    bases.pga =
        projected_greedy(bases.riesz, modes,
                         supremizers_at(problem, bases.riesz, bases.dual, training), options.pga);
    if (bases.pga.representers.cols() > 0)
      bases.supremizers = static_cast<int>(
          append_orthonormalised(
              bases.pod.basis, supremizer_fields(bases.riesz, bases.pga.representers).get(), 1e-10)
              .size());
  }
  return bases;
}

} // namespace rbvi
