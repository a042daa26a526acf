// The high-fidelity solution against a closed form: a membrane on a disc over a paraboloid.
#include "rbvi/contact/obstacle.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/element/quadrature.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

namespace rbvi::radial_obstacle_test {
namespace {

using std::numbers::pi;

// Closed form of a radial obstacle problem: a membrane on the disc of radius a fixed at its rim,
// under a constant load f < 0, held by the obstacle psi = -c rho^2.
//
// It touches on rho <= s; outside, -Laplace u = f gives u = A + B ln rho - f rho^2 / 4. u(a) = 0
// and u = psi, u' = psi' at s leave one equation for s. On the contact set the multiplier is lambda
// = -Laplace psi - f = 4 c - f.
struct RadialObstacle {
  double a, f, c;    ///< radius of the rim, load, curvature of the obstacle
  double s;          ///< radius of the contact set
  double log_factor; ///< B

  double u(double rho) const;
  double multiplier() const; ///< on the contact set
  double force() const;      ///< its integral
  double area() const;       ///< of the contact set
  double energy() const;     ///< int |grad u|^2 / 2 - f u
};

/// Solves for s by bisection to round-off. Needs f < 0 < c and a load that reaches the obstacle's
/// top; throws failure otherwise.
RadialObstacle radial_obstacle(double a, double f, double c) {
  // u'(s) = B / s - f s / 2 = -2 c s gives B; u(a) - u(s) = -psi(s) is left for s.
  const auto log_factor = [&](double s) { return s * s * (f / 2 - 2 * c); };
  const auto excess = [&](double s) {
    return log_factor(s) * std::log(a / s) - f / 4 * (a * a - s * s) - c * s * s;
  };
  double low = 1e-12 * a, high = a;
  if (!(f < 0 && c > 0 && excess(low) > 0 && excess(high * (1 - 1e-9)) < 0))
    throw failure("the radial obstacle problem has no ring-free contact set for these data");
  for (int k = 0; k < 200; ++k) {
    const double middle = (low + high) / 2;
    (excess(middle) > 0 ? low : high) = middle;
  }
  return {a, f, c, low, log_factor(low)};
}

double RadialObstacle::u(double rho) const {
  if (rho <= s) return -c * rho * rho;
  return log_factor * std::log(rho / a) - f / 4 * (rho * rho - a * a);
}

double RadialObstacle::multiplier() const {
  return 4 * c - f;
}

double RadialObstacle::area() const {
  return pi * s * s;
}

double RadialObstacle::force() const {
  return multiplier() * area();
}

double RadialObstacle::energy() const {
  // Green: int |grad u|^2 = int f u + int lambda u, so J = -int f u / 2 + int lambda u / 2.
  const auto power = [](double x) { return x * x * x * x; };
  const double inside = -c * pi * power(s) / 2; // int u over the contact set
  const double b = log_factor;
  const auto log_part = [&](double rho) { return rho * rho / 2 * (std::log(rho / a) - 0.5); };
  const double outside = 2 * pi *
                         (b * (log_part(a) - log_part(s)) -
                          f / 4 * ((power(a) - power(s)) / 4 - a * a * (a * a - s * s) / 2));
  return -f * (inside + outside) / 2 + multiplier() * inside / 2;
}

constexpr double rim = 0.5, load = -25, curvature = 20, region = 0.3;

TEST(RadialObstacle, SatisfiesItsOwnEquations) {
  const RadialObstacle o = radial_obstacle(rim, load, curvature);
  EXPECT_NEAR(o.u(rim), 0, 1e-15);
  EXPECT_LT(o.s, region);
  const double h = 1e-5, x = 0.4; // -u'' - u'/rho = f outside the contact set
  EXPECT_NEAR(-(o.u(x + h) - 2 * o.u(x) + o.u(x - h)) / (h * h) -
                  (o.u(x + h) - o.u(x - h)) / (2 * h * x),
              load, 1e-4);
  EXPECT_NEAR(o.u(o.s * (1 + 1e-9)), o.u(o.s), 1e-8); // C1 at the edge of contact
  EXPECT_NEAR((o.u(o.s + h) - o.u(o.s)) / h, (o.u(o.s) - o.u(o.s - h)) / h, 1e-2);
}

TEST(RadialObstacle, EnergyIsTheIntegralOfTheSolution) {
  const RadialObstacle o = radial_obstacle(rim, load, curvature);
  double energy = 0;
  const int n = 200000;
  for (int i = 0; i < n; ++i) {
    const double h = rim / n, x = (i + 0.5) * h;
    const double slope = (o.u(x + h / 2) - o.u(x - h / 2)) / h;
    energy += 2 * std::numbers::pi * x * h * (slope * slope / 2 - load * o.u(x));
  }
  EXPECT_NEAR(energy, o.energy(), 1e-7 * std::abs(o.energy()));
}

TEST(RadialObstacle, RefusesDataWithoutContact) {
  EXPECT_THROW(radial_obstacle(rim, 1, curvature), Error);
  EXPECT_THROW(radial_obstacle(rim, load, -1), Error);
}

/// Gmsh text of a disc of `rings` rings of 6 k nodes; region "obstacle" up to 0.3.
std::string disc_mesh(int rings) {
  std::string nodes, elements;
  int count = 0, element = 0;
  const auto first = [](int k) { return k == 0 ? 1 : 2 + 3 * k * (k - 1); };
  const auto node = [&](int k, int i) { return k == 0 ? 1 : first(k) + i % (6 * k); };
  for (int k = 0; k <= rings; ++k)
    for (int i = 0; i < std::max(1, 6 * k); ++i) {
      const double angle = k == 0 ? 0 : std::numbers::pi * i / (3 * k), r = rim * k / rings;
      char line[128];
      std::snprintf(line, sizeof line, "%d %.17g %.17g 0\n", ++count, r * std::cos(angle),
                    r * std::sin(angle));
      nodes += line;
    }
  const auto triangle = [&](int k, int a, int b, int c) {
    const int tag = rim * k / rings <= region + 1e-12 ? 2 : 3;
    elements += std::to_string(++element) + " 2 2 " + std::to_string(tag) + " 1 " +
                std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  };
  for (int k = 1; k <= rings; ++k)
    for (int s = 0; s < 6; ++s)
      for (int i = 0; i < k; ++i) {
        triangle(k, node(k - 1, s * (k - 1) + i), node(k, s * k + i), node(k, s * k + i + 1));
        if (i + 1 < k)
          triangle(k, node(k - 1, s * (k - 1) + i), node(k, s * k + i + 1),
                   node(k - 1, s * (k - 1) + i + 1));
      }
  for (int i = 0; i < 6 * rings; ++i)
    elements += std::to_string(++element) + " 1 2 1 1 " + std::to_string(node(rings, i)) + " " +
                std::to_string(node(rings, i + 1)) + "\n";
  return "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n1 1 \"boundary\"\n2 2 "
         "\"obstacle\"\n"
         "2 3 \"rest\"\n$EndPhysicalNames\n$Nodes\n" +
         std::to_string(count) + "\n" + nodes + "$EndNodes\n$Elements\n" + std::to_string(element) +
         "\n" + elements + "$EndElements\n";
}

Scene radial_scene(bool lumped) {
  Scene scene = make_scene("membrane_obstacle", {{"lumped", lumped ? "yes" : "no"}});
  scene.mesh.facts.clear(); // a disc in place of the square, with an obstacle of another radius
  scene.curves.clear();
  scene.map = [](const FullMu &, const Point &x) { return x; };
  const auto height = [](const FullMu &, const Point &x) {
    return -curvature * (x[0] * x[0] + x[1] * x[1]);
  };
  scene.contacts = {obstacle({"obstacle", height, lumped})};
  return scene;
}

/// The pressure against the exact one, which is constant up to the edge of contact and zero beyond.
struct Pressure {
  double l2 = 0, l1 = 0; ///< squared, and as it is; integrals over the region
};

Pressure pressure_errors(const InterfaceMesh &disc, const Vector &lambda,
                         const RadialObstacle &exact) {
  constexpr int parts = 10; // of each edge of a cell
  Pressure errors;
  for (Index e = 0; e < disc.count(); ++e) {
    const int *cell = disc.nodes_of(e);
    std::array<Point, 3> x;
    for (std::size_t i = 0; i < 3; ++i)
      x[i] = disc.points[cell[i]];
    const double area = std::abs((x[1][0] - x[0][0]) * (x[2][1] - x[0][1]) -
                                 (x[2][0] - x[0][0]) * (x[1][1] - x[0][1])) /
                        (2 * parts * parts);
    for (int i = 0; i < parts; ++i)
      for (int j = 0; j < 2 * (parts - i) - 1; ++j) { // centres of small triangles, both ways up
        const double third = j % 2 == 0 ? 1.0 / 3 : 2.0 / 3;
        const double s = (i + third) / parts, t = (j / 2 + third) / parts;
        const std::array weights{1 - s - t, s, t};
        double rho_x = 0, rho_y = 0, value = 0;
        for (std::size_t k = 0; k < 3; ++k) {
          rho_x += weights[k] * x[k][0];
          rho_y += weights[k] * x[k][1];
          value += weights[k] * lambda[cell[k]];
        }
        const double off = value - (std::hypot(rho_x, rho_y) < exact.s ? exact.multiplier() : 0);
        errors.l2 += area * off * off;
        errors.l1 += area * std::abs(off);
      }
  }
  return errors;
}

struct DiscSolution {
  HfSolution solution;
  Pressure errors;
};

DiscSolution solve_on_disc(int rings, bool lumped) {
  int rank = 0, process = static_cast<int>(getpid());
  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Bcast(&process, 1, MPI_INT, 0, PETSC_COMM_WORLD);
  const auto file =
      std::filesystem::temp_directory_path() / ("rbvi_disc_" + std::to_string(process) + ".msh");
  if (rank == 0) std::ofstream(file) << disc_mesh(rings);
  MPI_Barrier(PETSC_COMM_WORLD);
  Problem problem(PETSC_COMM_WORLD, radial_scene(lumped), {file.string(), 0});
  if (rank == 0) std::filesystem::remove(file);
  HfSolution solution = HighFidelity(problem, {}).solve({0.2, 0, 0});
  const Pressure errors = pressure_errors(problem.contact().interfaces.front()->mesh(),
                                          solution.lambda, radial_obstacle(rim, load, curvature));
  return {std::move(solution), errors};
}

TEST(HighFidelity, ConvergesToTheRadialSolution) {
  const RadialObstacle o = radial_obstacle(rim, load, curvature);
  for (const bool lumped : {false, true}) {
    std::vector<double> energy, force;
    for (const int rings : {10, 20, 40}) {
      const HfSolution s = solve_on_disc(rings, lumped).solution;
      EXPECT_LE(s.kkt.largest(), 1e-12);
      energy.push_back(std::abs(*s.outputs.energy / o.energy() - 1));
      force.push_back(std::abs(*s.outputs.normal_force / o.force() - 1));
    }
    EXPECT_LE(energy[2], 1.5e-3);
    EXPECT_GT(std::log2(energy[0] / energy[1]), 1.8);
    EXPECT_GT(std::log2(energy[1] / energy[2]), 1.8);
    EXPECT_LE(force[2], 1e-2);
  }
}

/// Error of the gradient over the square, against that of the closed form.
double gradient_error(const Problem &problem, const Vector &u, const RadialObstacle &exact) {
  const Mesh &mesh = problem.mesh();
  const auto count = static_cast<std::size_t>(nodes_per_cell(2, mesh.degree));
  std::array<std::array<double, 3>, most_nodes> slopes{};
  double square = 0;
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    const auto x = cell_of(mesh, k).reference;
    const Simplex s = simplex(2, x);
    const auto nodes = nodes_of(mesh, k);
    for (const QuadraturePoint &q : simplex_quadrature(2, 7)) {
      lagrange_gradients(2, mesh.degree, q.barycentric, s, slopes);
      std::array<double, 2> at{}, error{};
      for (std::size_t c = 0; c < 2; ++c) {
        for (std::size_t i = 0; i < 3; ++i)
          at[c] += q.barycentric[i] * x[i][c];
        for (std::size_t i = 0; i < count; ++i)
          error[c] += u[mesh.natural_node[nodes[i]]] * slopes[i][c];
      }
      const double rho = std::hypot(at[0], at[1]);
      const double slope =
          rho <= exact.s ? -2 * exact.c * rho : exact.log_factor / rho - exact.f / 2 * rho;
      square += q.weight * s.volume *
                (std::pow(error[0] - slope * at[0] / rho, 2) +
                 std::pow(error[1] - slope * at[1] / rho, 2));
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, &square, 1, MPI_DOUBLE, MPI_SUM, problem.comm());
  return std::sqrt(square);
}

/// The radial solution on a square whose frame has its values. Degree 1 converges with order 1;
/// u is in H^(5/2 - eps), which leaves 3/2 to degree 2, by exact integrals. By vertex quadrature
/// the pressure of degree 2 is a row of point loads: order 1.
TEST(HighFidelity, GradientsConvergeToTheRadialSolutionOnASquare) {
  struct Order {
    const char *degree, *lumped;
    double least, most, error;
  };
  const double c = 1.25 / (0.2 * 0.2);
  const RadialObstacle exact = radial_obstacle(0.55, load, c);
  ASSERT_LT(exact.s, 0.2) << "in the reference disc";
  int turn = 0; // each rank takes its share: orders do not depend on their number
  for (const auto &[degree, lumped, least, most, error] :
       {Order{"1", "no", 0.9, 1.1, 0.12}, Order{"1", "yes", 0.9, 1.1, 0.12},
        Order{"2", "yes", 0.9, 1.1, 0.12}, Order{"2", "no", 1.35, 1.75, 0.01}}) {
    if (turn++ % ranks_of(PETSC_COMM_WORLD) != rank_of(PETSC_COMM_WORLD)) continue;
    SCOPED_TRACE(std::string("degree ") + degree + ", lumped " + lumped);
    Scene scene = make_scene("membrane_obstacle",
                             {{"degree", degree}, {"lumped", lumped}, {"circle_edges", "24"}});
    scene.fixed.front().values = {{[exact](const FullMu &, const Point &x) {
                                     return Point{exact.u(std::hypot(x[0], x[1])), 0, 0};
                                   },
                                   std::vector<Factor>{}}};
    std::vector<double> errors;
    for (const int refine : {0, 1, 2}) {
      Problem problem(PETSC_COMM_SELF, scene, {"", refine});
      const HfSolution s = HighFidelity(problem, {}).solve({0.2, 0, 0});
      errors.push_back(gradient_error(problem, s.u, exact));
    }
    const double order = std::log2(errors[0] / errors[2]) / 2;
    EXPECT_GT(order, least) << errors[0] << " " << errors[1] << " " << errors[2];
    EXPECT_LT(order, most);
    EXPECT_LT(errors[2], error);
  }
}

/// On concentric rings contact gains a whole ring at once: means over meshes whose rings lie
/// differently about its edge. Along the six spokes their triangles are far from equilateral, and
/// the weights of vertex quadrature not those that the discrete Laplacian of a parabola has: 1.4 %.
TEST(HighFidelity, VertexQuadratureHasTheBetterPressure) {
  const RadialObstacle o = radial_obstacle(rim, load, curvature);
  constexpr int meshes = 10;
  Pressure consistent, lumped;
  double area = 0;
  for (int rings = 20; rings < 20 + meshes; ++rings) {
    const Pressure c = solve_on_disc(rings, false).errors;
    const auto [s, l] = solve_on_disc(rings, true);
    consistent.l2 += c.l2;
    consistent.l1 += c.l1;
    lumped.l2 += l.l2;
    lumped.l1 += l.l1;
    EXPECT_NEAR(*s.outputs.peak_pressure, o.multiplier(), 2e-2 * o.multiplier()) << rings;
    area += *s.outputs.contact_measure / meshes;
  }
  EXPECT_NEAR(area, o.area(), 1e-2 * o.area());
  EXPECT_LE(std::sqrt(lumped.l2 / consistent.l2), 0.87);
  EXPECT_LE(lumped.l1 / consistent.l1, 0.77);
}

} // namespace
} // namespace rbvi::radial_obstacle_test
