// Boundary value problems on triangles and tetrahedra of degree 1 and 2: patch tests, orders of
// convergence, the same answers on any number of ranks.
#include "../cube_mesh.hpp"
#include "../mesh/temporary_file.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/quadrature.hpp"
#include "rbvi/element/scalar_forms.hpp"
#include "rbvi/fem/assembly.hpp"

#include <gtest/gtest.h>
#include <petscksp.h>

#include <cmath>
#include <functional>

namespace rbvi::convergence_test {
namespace {

using Vertices = std::array<Point, 4>;
using Function = std::function<double(const Eigen::Vector3d &, int component)>;

Eigen::Vector3d vector_of(const Point &x) {
  return Eigen::Vector3d(x.data());
}

/// A rectangle of triangles, or with a mesh file a cube of tetrahedra; held all around.
struct Body {
  Scene scene;
  Mesh mesh;
  Dofs all, free; ///< without and with what is held

  Body(int degree, int components, const MeshOptions &options, MPI_Comm comm = PETSC_COMM_WORLD)
      : scene(make(degree, components, options)), mesh(make_mesh(comm, scene, options)),
        all(number_dofs(mesh, components, {})), free(number_dofs(mesh, components, scene.fixed)) {}

private:
  static Scene make(int degree, int components, const MeshOptions &options) {
    Scene scene;
    scene.name = "body";
    scene.dim = options.file.empty() ? 2 : 3;
    scene.degree = degree;
    scene.components = components;
    scene.mesh.generator = "one_block";
    scene.mesh.boundaries = options.file.empty()
                                ? std::vector<std::string>{"sides", "top", "contact"}
                                : std::vector<std::string>{"boundary"};
    for (const std::string &name : scene.mesh.boundaries)
      scene.fixed.push_back({name, {}});
    return scene;
  }
};

/// Values at all nodes, in natural order.
Vector interpolate(const Body &body, const Function &u) {
  const Mesh &mesh = body.mesh;
  const int components = body.scene.components;
  Vector natural = Vector::Zero(body.all.total);
  for (std::size_t node = 0; node < mesh.points.size(); ++node)
    for (int c = 0; c < components && mesh.owned_node[node]; ++c)
      natural[mesh.natural_node[node] * components + c] = u(vector_of(mesh.points[node]), c);
  MPI_Allreduce(MPI_IN_PLACE, natural.data(), static_cast<int>(natural.size()), MPI_DOUBLE, MPI_SUM,
                mesh.comm);
  return natural;
}

Handle<Mat> matrix_of(const Body &body, const Form &form, const Dofs &dofs) {
  Handle<Mat> matrix = make_matrix(body.mesh, dofs);
  assemble({{&form}}, {}, body.mesh, dofs, {}, matrix.get());
  return matrix;
}

/// M x, in natural order.
Vector times(const Body &body, const Form &form, const Vector &x) {
  const Handle<Vec> image = make_vector(body.all);
  RBVI_CALL(
      MatMult(matrix_of(body, form, body.all).get(), from_natural(body.all, x).get(), image.get()));
  return to_natural(body.all, image.get());
}

/// The u in natural order with a(u, v) = f(v) that has the values of `held` all around.
Vector solve(const Body &body, const Form &a, const Form &f, const Function &held) {
  Vector u = interpolate(body, held);
  Vector residual = -times(body, a, u);
  if (f) {
    const Handle<Vec> load = make_vector(body.all);
    assemble({{&f}}, {}, body.mesh, body.all, {}, load.get());
    residual += to_natural(body.all, load.get());
  }
  const Handle<Mat> matrix = matrix_of(body, a, body.free);
  const Handle<Vec> rhs = from_natural(body.free, residual), change = make_vector(body.free);
  Handle<KSP> ksp;
  PC pc = nullptr;
  RBVI_CALL(KSPCreate(body.mesh.comm, ksp.put()));
  RBVI_CALL(KSPSetType(ksp.get(), KSPCG));
  RBVI_CALL(KSPGetPC(ksp.get(), &pc));
  RBVI_CALL(PCSetType(pc, PCJACOBI));
  RBVI_CALL(KSPSetTolerances(ksp.get(), 1e-14, PETSC_DEFAULT, PETSC_DEFAULT, 2000));
  RBVI_CALL(KSPSetOperators(ksp.get(), matrix.get(), matrix.get()));
  RBVI_CALL(KSPSolve(ksp.get(), rhs.get(), change.get()));
  KSPConvergedReason reason = KSP_CONVERGED_ITERATING;
  RBVI_CALL(KSPGetConvergedReason(ksp.get(), &reason));
  EXPECT_GT(reason, 0);
  return u + to_natural(body.free, change.get());
}

struct Harmonic {
  int dim;
  /// e^x sin(y + 0.3), in 3D e^(sqrt 2 x) sin(y + 0.3) sin(z + 0.2), less x^2 / 2: -Laplace u = 1.
  double value(const Eigen::Vector3d &x) const {
    return std::exp(rate() * x[0]) * wave(x, -1) - x[0] * x[0] / 2;
  }
  Eigen::Vector3d gradient(const Eigen::Vector3d &x) const {
    const double e = std::exp(rate() * x[0]);
    return {rate() * e * wave(x, -1) - x[0], e * wave(x, 1), dim == 3 ? e * wave(x, 2) : 0};
  }

private:
  double rate() const { return std::sqrt(dim - 1.0); }
  /// The product of sines, that of direction `along` differentiated.
  double wave(const Eigen::Vector3d &x, int along) const {
    const double y = along == 1 ? std::cos(x[1] + 0.3) : std::sin(x[1] + 0.3);
    const double z = along == 2 ? std::cos(x[2] + 0.2) : std::sin(x[2] + 0.2);
    return dim == 3 ? y * z : y;
  }
};

struct Errors {
  double l2, h1; ///< of the values, of the gradients
};

Errors errors_of(const Body &body, const Vector &u, const Harmonic &exact) {
  const Mesh &mesh = body.mesh;
  const auto count = static_cast<std::size_t>(nodes_per_cell(mesh.dim, mesh.degree));
  std::array<double, most_nodes> phi{};
  std::array<std::array<double, 3>, most_nodes> slopes{};
  std::array<double, 2> squares{};
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    const Vertices x = cell_of(mesh, k).reference;
    const Simplex s = simplex(mesh.dim, x);
    const auto nodes = nodes_of(mesh, k);
    for (const QuadraturePoint &q : simplex_quadrature(mesh.dim, 7)) {
      Eigen::Vector3d y = Eigen::Vector3d::Zero();
      for (std::size_t i = 0; i <= static_cast<std::size_t>(mesh.dim); ++i)
        y += q.barycentric[i] * vector_of(x[i]);
      lagrange_values(mesh.dim, mesh.degree, q.barycentric, phi);
      lagrange_gradients(mesh.dim, mesh.degree, q.barycentric, s, slopes);
      double value = -exact.value(y);
      Eigen::Vector3d gradient = -exact.gradient(y);
      for (std::size_t i = 0; i < count; ++i) {
        const double at_node = u[mesh.natural_node[nodes[i]]];
        value += at_node * phi[i];
        gradient += at_node * Eigen::Vector3d(slopes[i].data());
      }
      squares[0] += q.weight * s.volume * value * value;
      squares[1] += q.weight * s.volume * gradient.squaredNorm();
    }
  }
  MPI_Allreduce(MPI_IN_PLACE, squares.data(), 2, MPI_DOUBLE, MPI_SUM, mesh.comm);
  return {std::sqrt(squares[0]), std::sqrt(squares[1])};
}

Vector solve_poisson(const Body &body) {
  const Harmonic exact{body.mesh.dim};
  const int degree = body.mesh.degree;
  return solve(body, laplace("", degree), constant_load("", 1, degree),
               [&](const Eigen::Vector3d &x, int) { return exact.value(x); });
}

/// On similar meshes, each of half the edges of the one before: refined triangles, Kuhn's cubes
/// (the refinement of tetrahedra changes their shapes).
TEST(Poisson, ConvergesWithTheOrderOfTheDegree) {
  for (int dim : {2, 3})
    for (int degree : {1, 2}) {
      SCOPED_TRACE("dim " + std::to_string(dim) + ", degree " + std::to_string(degree));
      std::vector<Errors> errors;
      for (int level : {1, 2}) {
        const TemporaryFile cube(cube_mesh(4 * level));
        const Body body(degree, 1, dim == 2 ? MeshOptions{"", level} : MeshOptions{cube.name(), 0});
        errors.push_back(errors_of(body, solve_poisson(body), {dim}));
      }
      const double l2 = std::log2(errors[0].l2 / errors[1].l2);
      const double h1 = std::log2(errors[0].h1 / errors[1].h1);
      EXPECT_NEAR(h1, degree, 0.05);
      EXPECT_NEAR(l2, degree + 1, 0.05);
    }
}

TEST(Poisson, QuadraticTetrahedraDoNotDependOnTheNumberOfRanks) {
  const TemporaryFile cube(cube_mesh(3, 0.2));
  const Body shared(2, 1, {cube.name(), 1}), own(2, 1, {cube.name(), 1}, PETSC_COMM_SELF);
  EXPECT_EQ(shared.mesh.total_nodes, own.mesh.total_nodes);
  for (int c = 0; c < 3; ++c) {
    const Function coordinate = [c](const Eigen::Vector3d &x, int) { return x[c]; };
    EXPECT_EQ(interpolate(shared, coordinate), interpolate(own, coordinate)) << c;
  }
  const Vector u = solve_poisson(shared), alone = solve_poisson(own);
  EXPECT_LT((u - alone).norm(), 1e-11 * alone.norm());
}

TEST(QuadraticTetrahedra, HaveANodeForEachVertexAndEdge) {
  const int n = 3;
  const TemporaryFile cube(cube_mesh(n, 0.2));
  const Body body(2, 1, {cube.name(), 0});
  // Along the axes, across the faces of the boxes, and along their long diagonals.
  const int edges = 3 * n * (n + 1) * (n + 1) + 3 * n * n * (n + 1) + n * n * n;
  EXPECT_EQ(body.mesh.total_vertices, (n + 1) * (n + 1) * (n + 1));
  EXPECT_EQ(body.mesh.total_nodes, body.mesh.total_vertices + edges);
  EXPECT_EQ(body.free.total_free, (2 * n - 1) * (2 * n - 1) * (2 * n - 1)) << "the inner nodes";
  const int vtk[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}; // VTK_QUADRATIC_TETRA
  for (std::size_t k = 0; k < body.mesh.cells.size(); ++k) {
    const auto nodes = nodes_of(body.mesh, k);
    const auto point = [&](int i) {
      const int node = nodes[i];
      return vector_of(body.mesh.points[node]);
    };
    for (int e = 0; e < 6; ++e)
      EXPECT_LT((point(4 + e) - (point(vtk[e][0]) + point(vtk[e][1])) / 2).norm(), 1e-15);
  }
}

/// u = (x y, y z, z x) on the unit cube: int |u|^2 = 1/3, int |grad u|^2 = 2.
TEST(QuadraticTetrahedra, NormsOfQuadraticFieldsAreExact) {
  const TemporaryFile cube(cube_mesh(2, 0.2));
  const Body body(2, 3, {cube.name(), 0});
  const Vector u =
      interpolate(body, [](const Eigen::Vector3d &x, int c) { return x[c] * x[(c + 1) % 3]; });
  const double length = 0.4;
  EXPECT_NEAR(u.dot(times(body, h1_product(length, 3, 2), u)), 1.0 / 3 + 2 * length * length,
              1e-13);
}

/// A polynomial field without body forces: (lambda + shear) grad div u + shear Laplace u = 0.
struct Balanced {
  Eigen::Matrix3d slope = Eigen::Matrix3d::Zero();
  std::array<Eigen::Matrix3d, 3> curvature; ///< of each component, symmetric

  Balanced(int dim, int degree, const Lame &material) {
    for (int c = 0; c < 3; ++c) {
      Eigen::Matrix3d &h = curvature[c];
      h.setZero();
      for (int i = 0; i < dim && c < dim; ++i) {
        slope(c, i) = std::sin(1.0 + 2 * c + 5 * i);
        for (int j = 0; j < dim && degree == 2; ++j)
          h(i, j) = std::cos(1.0 + c + i + j);
      }
    }
    for (int c = 0; c < dim && degree == 2; ++c) { // u_c's share of x_(c+1)^2 has no divergence
      Eigen::Matrix3d &h = curvature[c];
      double of_divergence = 0;
      for (int i = 0; i < dim; ++i)
        of_divergence += curvature[i](i, c);
      h((c + 1) % dim, (c + 1) % dim) -=
          h.trace() + (material.lambda + material.shear) / material.shear * of_divergence;
    }
  }
  double operator()(const Eigen::Vector3d &x, int c) const {
    return slope.row(c).dot(x) + x.dot(curvature[c] * x) / 2;
  }
};

TEST(Elasticity, PassesThePatchTestOfItsDegree) {
  const Lame material = lame(15, 0.35);
  const TemporaryFile cube(cube_mesh(3, 0.2));
  for (int dim : {2, 3})
    for (int degree : {1, 2}) {
      SCOPED_TRACE("dim " + std::to_string(dim) + ", degree " + std::to_string(degree));
      const Body body(degree, dim, {dim == 2 ? "" : cube.name(), 0});
      const Balanced exact(dim, degree, material);
      const Vector expected = interpolate(body, exact);
      const Vector u =
          solve(body, elasticity("", material, degree), {}, [&](const Eigen::Vector3d &x, int c) {
            const bool rim = x.head(dim).minCoeff() == 0 || x[0] == 1 ||
                             x[1] == (dim == 2 ? 0.5 : 1) || (dim == 3 && x[2] == 1);
            return rim ? exact(x, c) : 0;
          });
      EXPECT_LT((u - expected).cwiseAbs().maxCoeff(), 1e-11);
    }
}

} // namespace
} // namespace rbvi::convergence_test
