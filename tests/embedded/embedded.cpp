// A program of others, on the serial library alone and without its flags: with the address
// sanitizer, which sees what is freed. embedded MODEL...: answers the middle of the box of each.
#include "rbvi/model/model.hpp"
#include "rbvi/model/online.hpp"
#include "tests/catalogue.hpp"

#include <cmath>
#include <cstdio>

int main(int count, char **arguments) {
  using namespace rbvi;
  for (int i = 1; i < count; ++i) {
    ReducedModel model = read_model(arguments[i], catalogue());
    OnlineSolver solver(model);
    Mu mu;
    for (int k = 0; k < model.scene.parameters.size(); ++k)
      mu.push_back((model.scene.parameters.at(k).lower + model.scene.parameters.at(k).upper) / 2);
    ReducedAnswer solution = solver.solve(mu);
    const double energy = solver.outputs(mu, solution).energy.value_or(NAN);
    const Vector field = solver.field(solution);
    // Memory of either side, freed or made larger by the other.
    solution.lambda.conservativeResize(2 * solution.lambda.size() + 1);
    solution.u = Vector::Ones(2 * solution.u.size() + 1);
    model.made.trained_mu = Matrix::Zero(7, 9);
    const ReducedModel smaller = leading(model, model.body.modes, model.contact.generators);
    if (!std::isfinite(energy) || field.size() == 0 || smaller.body.modes != model.body.modes)
      return 1;
    std::printf("%s: energy %.10g\n", arguments[i], energy);
  }
  return count > 1 ? 0 : 2;
}
