#include "rbvi/solve/nitsche.hpp"

#include "contact_method.hpp"
#include "nitsche_system.hpp"
#include "rbvi/contact/force_balance.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/solve/vectors.hpp"

#include <algorithm>

namespace rbvi {

namespace {

constexpr double vanishing = 1e-9; ///< of the start: below it terms count as zero
constexpr double of_loads = 0.1;   ///< below it their residual is round-off of the loads

class ByNitsche : public ContactMethod {
public:
  ByNitsche(Problem &problem, const HfOptions &options)
      : problem_(problem), solver_(problem, options.nitsche) {}
  ContactRows begin(const Vector &slip) override {
    if (slip.size() > 0)
      throw bad_input("a history of friction is for multipliers: use -formulation mixed");
    return ContactRows::all;
  }
  void set(const Operators &) override {}
  MethodResult solve(const ContactTask &task) override;
  Solved kept(MethodResult &result) const override {
    return {.u = std::move(result.free_u), .pressures = std::move(result.pressures)};
  }

private:
  Problem &problem_;
  NitscheSolver solver_;
};

MethodResult ByNitsche::solve(const ContactTask &task) {
  const Operators &op = task.op;
  NitscheStart start{};
  if (task.near != nullptr) {
    const Vector pressures = task.starts.fit_added(
        [](const Solved &solved) { return Vector(solved.pressures.reshaped()); }, op.mu);
    start = {task.near->u.get(), pressures.reshaped(pressures.size() / 2, 2)};
  }
  NitscheSolution found = solver_.solve(op, task.near == nullptr ? nullptr : &start);
  const NitscheLayer layer = layer_of(problem_.contact());
  MethodResult result;
  result.lambda = nitsche_multiplier(layer, op.mu, found.layer);
  nitsche_outputs(layer, op.mu, nitsche_faces(layer, op.mu, layer.cells, found.layer), found.layer,
                  found.pressures, found.bounds, result.outputs);
  check_forces(layer, op.mu, found.layer);
  result.kkt.stationarity = found.residual;
  result.outputs.energy =
      image_count(problem_.scene().mirrors) * (found.energy + op.imposed_energy);
  result.residual = found.residual;
  result.iterations = found.iterations;
  result.converged = true;
  result.reason = found.reason + ", " + std::to_string(found.iterations) + " Newton steps in " +
                  std::to_string(found.outer_iterations) + " loops, " +
                  std::to_string(found.factorisations) + " factorisations";
  result.free_u = std::move(found.u);
  result.pressures = std::move(found.pressures);
  return result;
}

} // namespace

NitscheSolver::NitscheSolver(Problem &problem, const NitscheOptions &options)
    : options_(options), system_(new NitscheSystem(*this, problem, options_)) {}

NitscheSolver::~NitscheSolver() = default;

NitscheSolution NitscheSolver::solve(const Operators &op, const NitscheStart *start) {
  NitscheSystem &system = *system_;
  system.set(op);
  NitscheSolution result;
  const int factorised_before = system.factorisations;
  Handle<Vec> unknowns = like(op.f);
  Vec u = unknowns.get();
  const bool nested = system.bounds_move() && !options_.single_loop;
  if (options_.plain_steps) {
    RBVI_CALL(VecZeroEntries(u));
    system.set_bounds(u);
    if (nested) system.bounds.setZero(); // those of the body before it is pushed
  } else if (start != nullptr) {
    system.predict(*start, nitsche_bounds(system.faces, start->pressures), u);
  } else {
    system.predict_from_rest(u);
  }
  system.smallest_scale = 0;
  system.residual(u, system.force.get());
  system.smallest_scale = std::max(vanishing * system.scale, of_loads * norm(system.f.get()));
  run(nested, u, result);
  result.factorisations = system.factorisations - factorised_before;
  result.residual = system.relative_residual(u);
  result.pressures = nitsche_pressures(system.faces, system.on_layer(u));
  result.bounds = system.bounds;
  result.u = system.frames ? system.frames->turned_back(u) : std::move(unknowns);
  u = result.u.get();
  result.layer = system.on_layer(u);
  RBVI_CALL(MatMult(op.a, u, system.au.get()));
  result.energy = dot(system.au.get(), u) / 2 - dot(op.f, u);
  system.finished = true;
  return result;
}

void NitscheSolver::run(bool nested, Vec u, NitscheSolution &result) {
  NitscheSystem &system = *system_;
  const Handle<Vec> before = like(u);
  const auto newton = [&](double tolerance) {
    system.tolerance = tolerance;
    RBVI_CALL(VecCopy(u, before.get()));
    result.iterations += system.newton(u, result.reason);
    if (loop_end) loop_end(system.on_layer(u), system.bounds);
    RBVI_CALL(VecAXPY(before.get(), -1, u));
    const double size = norm(u);
    return size == 0 ? 0 : norm(before.get()) / size;
  };
  result.outer_iterations = 1;
  if (!nested) {
    newton(system.accuracy);
    return;
  }
  const double accuracy = system.accuracy;
  const bool loose = !options_.plain_steps && !loop_end;
  const auto pressures = [&] { return nitsche_pressures(system.faces, system.on_layer(u)); };
  result.outer_iterations = settle_bounds(
      laws_at_points(system.faces),
      {newton, pressures, system.bounds, loose ? std::max(1e-3, accuracy) : accuracy, accuracy});
}

std::unique_ptr<ContactMethod> make_nitsche_method(Problem &problem, const HfOptions &options) {
  if (const auto &free = problem.free_bodies(); !free.empty()) {
    const Index motions = motions_of(free);
    throw bad_input(describe(free, problem.scene().dim, Matrix::Identity(motions, motions)) +
                    ": impose displacements that prevent it, for by Nitsche's method contact "
                    "alone holds no body, or use -formulation mixed");
  }
  return std::make_unique<ByNitsche>(problem, options);
}

} // namespace rbvi
