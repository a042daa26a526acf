// The half-disk on its rigid disk by Nitsche's method, for the tests of solves.
#pragma once

#include "rbvi/core/error.hpp"
#include "rbvi/solve/high_fidelity.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rbvi::nitsche_disk {

/// Free: radius, indentation, friction, core_stiffness, poisson_ratio.
inline Scene disk(const std::string &friction, SceneOptions options = {}) {
  options["friction"] = friction;
  options.insert({"formulation", "nitsche"});
  Scene scene = make_scene("rigid_disk", options);
  scene.parameters.free = {0, 1, 2, 3, 4};                    // all but the offset
  if (!has_friction(scene)) scene.parameters.free.pop_back(); // there is no such parameter
  return scene;
}

inline Scene small_disk(const std::string &friction, SceneOptions options = {}) {
  options.insert({"arc_edges", "40"});
  return disk(friction, options);
}

inline Mu with_radius(double radius, double friction = 0.1, double indentation = 0.09) {
  return {radius, indentation, friction, 1, 0.35};
}

/// Without the value of friction where there is none.
inline Mu suited(Mu mu, const Scene &scene) {
  if (!has_friction(scene)) mu.erase(mu.begin() + 2);
  return mu;
}

inline HfSolution solve(MPI_Comm comm, const Scene &scene, const Mu &mu,
                        const NitscheOptions &nitsche = {}) {
  Problem problem(comm, scene, {});
  HfOptions options;
  options.nitsche = nitsche;
  return HighFidelity(problem, options).solve(suited(mu, scene));
}

/// On each rank by itself: a factorisation that is spread over ranks takes long.
inline HfSolution solve(const Scene &scene, const Mu &mu, const NitscheOptions &nitsche = {}) {
  return solve(PETSC_COMM_SELF, scene, mu, nitsche);
}

/// `tolerance` is relative.
inline void expect_equal(const HfSolution &a, const HfSolution &b, double tolerance) {
  EXPECT_LE((a.u - b.u).norm(), tolerance * b.u.norm());
  EXPECT_LE((a.lambda - b.lambda).norm(), tolerance * b.lambda.norm());
}

const std::vector<std::string> laws{"none", "tresca", "coulomb"};

/// The normal part of lambda is even about the middle of the arc, the tangential one odd.
/// `tolerance` is relative.
inline void expect_symmetric(const HfSolution &s, Index vertices, double tolerance) {
  const Vector normal = s.lambda.head(vertices);
  const double near = tolerance * normal.maxCoeff();
  EXPECT_LE((normal - normal.reverse()).cwiseAbs().maxCoeff(), near);
  if (s.lambda.size() == vertices) return;
  const Vector tangential = s.lambda.tail(vertices);
  EXPECT_LE((tangential + tangential.reverse()).cwiseAbs().maxCoeff(), near);
}

/// Sets an option of PETSc until the end of its scope.
class PetscOption {
public:
  PetscOption(const char *name, const char *value) : name_(name) {
    RBVI_CALL(PetscOptionsSetValue(nullptr, name, value));
  }
  ~PetscOption() { PetscOptionsClearValue(nullptr, name_); }
  PetscOption(const PetscOption &) = delete;
  PetscOption &operator=(const PetscOption &) = delete;

private:
  const char *name_;
};

} // namespace rbvi::nitsche_disk
