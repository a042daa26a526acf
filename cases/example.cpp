// The whole method on one page, with the library behind rbvi and rbvi-online: a membrane on a round
// obstacle. For mu = (radius, center_x) find the displacement u in V and the pressure lambda in the
// cone W+ of non-negative functions such that
//
//   a(mu; u, v) + b(mu; v, lambda)  = f(mu; v)      for all v in V,
//   b(mu; u, eta)                  <= g(mu; eta)    for all eta in W+                         (2.7)
//
//   mpirun -n 2 build/bin/example cases/membrane_obstacle/case.yaml run/example
//
// Exit status 0: the reduced answer is right.
#include "rbvi/io/parameter_sets.hpp"
#include "rbvi/mor/fields.hpp"
#include "rbvi/mor/reduce.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/par/session.hpp"
#include "rbvi/study/errors.hpp"
#include "rbvi/tool/cases.hpp"
#include "rbvi/tool/finish.hpp"

#include <algorithm>

using namespace rbvi;

namespace {

constexpr double most_error = 1e-3; ///< relative, of u in V and of lambda in W

/// 1. The scene: parameters and their box, the reference domain and its map, a, b, f, g. Two of the
/// three parameters are free, center_y keeps its value.
Scene membrane(const std::string &file) {
  Scene scene = make_scene(scene_of_file(PETSC_COMM_WORLD, file));
  scene.parameters = free_only(scene.parameters, "radius,center_x");
  return scene;
}

/// 2. and 3. The problem on a mesh, A u + B^T lambda = F, B u <= G, lambda >= 0 at each mu, and
/// snapshots: high-fidelity answers at a few mu. Each rank is a group of its own with the whole
/// mesh. Each answer is a file in `directory`; a second run finds them there.
Sweep snapshots(const Scene &scene, const std::string &directory) {
  const Groups groups(PETSC_COMM_WORLD, 1);
  Problem problem(groups.comm(), scene, {});
  return run_sweep(PETSC_COMM_WORLD, groups, problem, {}, parse_set(scene.parameters, "grid:9,9"),
                   {directory});
}

/// 4. The primal basis V_N: modes of the displacements, orthonormal in V, as many as leave the
/// relative error e_POD(N) <= 1e-6 (2.11). The dual cone W_R+ = {sum_r x_r chi_r, x_r >= 0}: hat
/// functions where contact changes, and modes of either sign where it never ends; e(R) <= 1e-4
/// (2.34). The training grid holds the corners of the box: no ring around these nodes is needed.
ReducedBases bases_of(Problem &problem, const std::vector<Sample> &samples) {
  ReducedBases bases;
  add_modes(problem, samples, {.tolerance = 1e-6}, bases);
  const Operators &op = problem.assemble(box_centre(problem.scene().parameters));
  bases.cone =
      build_cone(multipliers_of(samples), problem.w_product(), {.ring = 0}, holding(problem, op));
  return bases;
}

/// 5. Stability. Modes alone leave beta = inf over eta of sup over v of b(mu; v, eta) at zero
/// (2.14). With T(mu) eta the supremizer of eta, V_N + span {T(mu) chi_r} is stable at one mu
/// (2.17). The projected greedy algorithm takes the few supremizers that serve every training mu:
/// it stops where sigma_S, the largest distance over mu of the supremizers at mu to V_N + S (2.21),
/// (2.27), is so small that beta_off >= sqrt(1 - sigma_S^2) beta_on >= 0.9 beta_on.
void stabilise(Problem &problem, const std::vector<Mu> &training, ReducedBases &bases) {
  const RieszSpace riesz = make_riesz_space(problem.v_product(), problem.trace());
  const Matrix dual = orthonormal_dual_basis(bases.cone.all(), problem.w_product());
  const Matrix modes = mode_coordinates(riesz, bases.pod.basis);
  std::vector<Matrix> supremizers; // this rank's share
  take_turns(problem.comm(), training.size(), [&](std::size_t p) {
    supremizers.push_back(supremizers_at(problem, riesz, dual, {{training[p]}}).front());
  });
  bases.pga = projected_greedy(problem.comm(), riesz, modes, std::move(supremizers), {});
  bases.supremizers = static_cast<int>(
      append_representers(riesz, bases.pga.representers, bases.pod.basis, 1e-10).size());

  Operators op;
  problem.assemble_contact(training.front(), op);
  const InfSup beta = infsup_constants(riesz, op.b, modes, bases.pga.coordinates, dual);
  PetscPrintf(problem.comm(), "N = %d modes, R = %d, S = %d supremizers\n", bases.modes,
              static_cast<int>(bases.cone.size()), bases.supremizers);
  PetscPrintf(problem.comm(), "beta: modes alone %.1e, online %.3e, offline %.3e\n", beta.dec,
              beta.on, beta.off);
}

/// 6. Separation: A(mu) = sum_q theta_q(mu) A_q to 1e-4 by empirical interpolation (B.32), likewise
/// B, F, G. Each term is projected once: with Z the primal and X the dual basis Z^T A_q Z, X^T B_q
/// Z, ...
ReducedModel reduced_model(Problem &problem, const std::vector<Sample> &samples,
                           const ReducedBases &bases) {
  const AffineOperators terms = separate(problem, parameters_of(samples), {.tolerance = 1e-4});
  ReducedModel model = project(problem, samples, terms, bases);
  gather_fields(problem, bases.pod.basis, model); // of the basis, for the error of u alone
  return model;
}

/// 7. One query: A_N u + B_N^T x = F_N, B_N u <= G_R, x >= 0, on one core, without the mesh. Its
/// errors |u - u_HF|_V / |u_HF|_V and |lambda - lambda_HF|_W / |lambda_HF|_W, the larger one.
double error_of_query(Problem &problem, const ReducedModel &model, const Mu &mu) {
  OnlineSolver online(model);
  const Outputs reduced = online.outputs(mu, online.solve(mu));
  const HfSolution truth = HighFidelity(problem, {}).solve(mu);
  PetscPrintf(problem.comm(), "force: %.6f reduced, %.6f high-fidelity\n",
              reduced.normal_force.value(), truth.outputs.normal_force.value());
  const std::vector<Sample> samples{{mu, truth.u, truth.lambda, truth.outputs}};
  const ModelErrors errors =
      model_errors(model, {}, make_truths(problem, model, samples), problem.w_product());
  PetscPrintf(problem.comm(), "error: %.1e of u, %.1e of lambda\n", errors.u[0], errors.lambda[0]);
  return std::max(errors.u[0], errors.lambda[0]);
}

void run(const std::string &file, const std::string &directory) {
  const Scene scene = membrane(file);
  const std::vector<Sample> samples = snapshots(scene, directory + "/samples").samples;
  Problem problem(PETSC_COMM_WORLD, scene, {}); // distributed over all ranks
  ReducedBases bases = bases_of(problem, samples);
  stabilise(problem, parameters_of(samples), bases);
  const ReducedModel model = reduced_model(problem, samples, bases);
  if (!(error_of_query(problem, model, {0.19, 0.02}) < most_error))
    throw failure("the reduced answer is off by more than it should be");
}

} // namespace

int main(int argc, char **argv) {
  Session session(argc, argv);
  return finish(PETSC_COMM_WORLD, [&] {
    if (argc != 3) throw bad_input("give the case and a directory: example CASE DIRECTORY");
    run(argv[1], argv[2]);
  });
}
