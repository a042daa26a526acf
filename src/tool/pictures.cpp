#include "pictures.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/output_table.hpp"
#include "rbvi/io/write_atomically.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/model/solution_vtu.hpp"
#include "rbvi/mor/reduce.hpp"
#include "rbvi/study/output_errors.hpp"
#include "rbvi/tool/tables.hpp"

#include <algorithm>
#include <sstream>

namespace rbvi {

namespace {

namespace fs = std::filesystem;

/// Equal steps of the coordinate of each free parameter.
std::vector<Mu> along_parameters(const Scene &scene, const Mu &middle) {
  constexpr int steps = 32;
  std::vector<Mu> lines;
  for (std::size_t i = 0; i < middle.size(); ++i) {
    const int p = scene.parameters.free[i];
    const Parameter &parameter = scene.parameters.all[p];
    const Coordinate *own = coordinate_of(scene, p);
    const double low = own ? own->of(parameter.lower) : parameter.lower,
                 high = own ? own->of(parameter.upper) : parameter.upper;
    for (int k = 0; k <= steps; ++k) {
      const double x = low + (high - low) * k / steps, value = own ? own->back(x) : x;
      lines.push_back(middle);
      lines.back()[i] = std::clamp(value, parameter.lower, parameter.upper);
    }
  }
  return lines;
}

/// The middle, and where the normal force of the others is least and largest.
std::vector<Mu> far_apart(const Mu &middle, const std::vector<Mu> &set,
                          const std::vector<Outputs> &outputs) {
  std::vector<Mu> chosen{middle};
  if (set.empty()) return chosen;
  const auto force = [](const Outputs &of) { return of.normal_force.value_or(0); };
  const auto [least, largest] = std::ranges::minmax_element(outputs, {}, force);
  chosen.push_back(set[static_cast<std::size_t>(least - outputs.begin())]);
  chosen.push_back(set[static_cast<std::size_t>(largest - outputs.begin())]);
  return chosen;
}

void write_stresses(OnlineSolver &solver, const std::vector<Mu> &set, const fs::path &path) {
  const Contact &contact = solver.contact();
  const std::vector<Point> points = dual_points(contact);
  std::vector<Mu> mus;
  Table table;
  std::vector<double> interface, x, y, pressure, tangential;
  for (const Mu &mu : set) {
    const Matrix stress = by_node(contact, solver.multiplier(solver.solve(mu, true)));
    for (std::size_t i = 0, row = 0; i < contact.interfaces.size(); ++i)
      for (Index node = 0; node < contact.interfaces[i]->dual().nodes(); ++node, ++row) {
        mus.push_back(mu);
        interface.push_back(static_cast<double>(i + 1));
        x.push_back(points[row][0]);
        y.push_back(points[row][1]);
        pressure.push_back(stress(static_cast<Index>(row), 0));
        tangential.push_back(stress(static_cast<Index>(row), 1));
      }
  }
  table.add(solver.scene().parameters, mus);
  table.add("interface", interface);
  table.add("x", x);
  table.add("y", y);
  table.add("pressure", pressure);
  table.add("tangential", tangential);
  table.write(path);
}

} // namespace

void write_pictures(const ReducedModel &model, const std::vector<Mu> &set,
                    const std::vector<Outputs> &outputs, const fs::path &out) {
  const Mu middle = box_centre(model.scene.parameters);
  const std::vector<Mu> lines = along_parameters(model.scene, middle);
  std::ostringstream table;
  write_csv(table, model.scene.parameters, lines, reduced_outputs(model, lines));
  write_atomically(out / "along.csv", table.str());
  for (const char *file : {"stresses.csv", "u.vtu"})
    fs::remove(out / file);
  OnlineSolver solver(model);
  try {
    write_stresses(solver, far_apart(middle, set, outputs), out / "stresses.csv");
    const ReducedAnswer answer = solver.solve(middle);
    write_vtu(out / "u.vtu", model.scene, answer.mu, model, solver.field(answer),
              solver.multiplier(answer));
  } catch (const Error &error) { // an answer that is not there is told where it was asked for
    if (error.status() == Status::bad_input) throw;
  }
}

} // namespace rbvi
