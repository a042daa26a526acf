// Contact by Nitsche's method, without multipliers.
#include "contact_method.hpp"

#include "rbvi/core/local_fit.hpp"

namespace rbvi {

namespace {

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
  Solved kept(const Mu &mu, MethodResult &result) const override {
    return {.mu = mu, .u = std::move(result.free_u), .pressures = std::move(result.pressures)};
  }

private:
  Matrix predicted_pressures(const ContactTask &task) const;

  Problem &problem_;
  NitscheSolver solver_;
};

Matrix ByNitsche::predicted_pressures(const ContactTask &task) const {
  const ParameterSpace &space = problem_.scene().parameters;
  const auto count = std::ssize(task.solved);
  Matrix pressures(task.solved.front().pressures.size(), count), points(space.size(), count);
  for (Index p = 0; p < count; ++p) {
    const Solved &solved = task.solved[p];
    pressures.col(p) = solved.pressures.reshaped();
    points.col(p) = parts_of_box(space, expand(space, solved.mu));
  }
  return local_fit(pressures, points, parts_of_box(space, expand(space, task.mu)))
      .reshaped(pressures.rows() / 2, 2);
}

MethodResult ByNitsche::solve(const ContactTask &task) {
  const Operators &op = task.op;
  NitscheStart start{};
  if (task.near != nullptr) start = {task.near->u.get(), predicted_pressures(task)};
  NitscheSolution found = solver_.solve(op, task.near == nullptr ? nullptr : &start);
  const NitscheLayer layer = layer_of(problem_.contact());
  MethodResult result;
  result.lambda = nitsche_multiplier(layer, op.mu, found.layer);
  nitsche_outputs(layer, op.mu, nitsche_faces(layer, op.mu, layer.cells, found.layer), found.layer,
                  found.pressures, found.bounds, result.outputs);
  result.kkt.stationarity = found.residual;
  result.outputs.energy =
      image_count(problem_.scene().mirrors) * (found.energy + op.imposed_energy);
  result.residual = *(result.outputs.kkt_residual = found.residual);
  result.outputs.iterations = result.iterations = found.iterations;
  result.converged = true;
  result.reason = found.reason + ", " + std::to_string(found.iterations) + " Newton steps in " +
                  std::to_string(found.outer_iterations) + " loops, " +
                  std::to_string(found.factorisations) + " factorisations";
  result.free_u = std::move(found.u);
  result.pressures = std::move(found.pressures);
  return result;
}

} // namespace

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
