// A scene: the pure functions and facts that define one parametrised variational inequality
//
//   a(mu; u, v) + b(mu; v, lambda) = f(mu; v)          for all v in V
//   b(mu; u, eta) <= g(mu; eta)                        for all eta in W+        (2.7)
//
// on a reference domain. Nothing here knows of meshes in memory, MPI or PETSc, so the same
// scene serves the offline assembly and the online evaluation of sampled entries.
#pragma once

#include "rbvi/core/parameters.hpp"

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace rbvi {

/// Coordinates; in 2D the third is zero.
using Point = std::array<double, 3>;

/// One simplex: dim + 1 vertices, in the reference and in the mapped domain.
struct Cell {
  int dim = 2;
  std::array<Point, 4> reference; ///< vertices xhat
  std::array<Point, 4> mapped;    ///< h(mu)(xhat)
};

/// An integral over the cells of a region, evaluated cell by cell.
/// A bilinear form fills k*k values (row-major, test function first), a linear form k values,
/// with k = (dim + 1) * components of the spaces it couples.
struct Form {
  std::string region; ///< "" for the whole domain
  std::function<void(const Mu &mu, const Cell &cell, double *values)> kernel;
  explicit operator bool() const { return static_cast<bool>(kernel); }
};

/// Options of a scene as text, resolved (defaults filled in): "load" -> "-25".
using SceneOptions = std::map<std::string, std::string>;

struct SceneOption {
  std::string name, default_value, help;
  std::vector<std::string> choices; ///< empty: a number
};

/// Names the built-in mesh generator; `region` and `boundary` are the labels it sets.
struct MeshRecipe {
  std::string generator; ///< "square_with_disc"
  std::vector<std::string> regions;
  std::vector<std::string> boundaries;
};

struct Scene {
  std::string name;
  std::string summary; ///< one line
  int dim = 2;
  int components = 1; ///< of the displacement
  SceneOptions options;
  ParameterSpace parameters;
  std::string training = "", validation = ""; ///< default sets, as parse_set reads them
  MeshRecipe mesh;

  /// h(mu), from the reference to the mapped domain.
  std::function<Point(const Mu &, const Point &)> map;
  /// Brings a refined vertex of the interface of the contact region back onto the exact curve.
  std::function<Point(const Point &)> snap;

  std::string fixed_boundary; ///< displacement imposed here
  std::string contact_region; ///< multipliers live on the vertices of this closed region

  Form a, b, g;
  Form f;              ///< empty: no load
  Form v_product;      ///< inner product of V on the reference domain
  Form w_product;      ///< inner product of W on the reference domain
  bool lumped = false; ///< b, g by vertex quadrature: the constraint is a bound at each node

  /// psi(mu) at a point of the mapped domain: u >= psi in the contact region.
  std::function<double(const Mu &, const Point &)> obstacle;
};

struct SceneEntry {
  std::string name, summary;
  std::vector<SceneOption> options;
  Scene (*make)(const SceneOptions &);
};

/// The scenes of this build.
const std::vector<SceneEntry> &scene_catalogue();

/// Makes a scene; options that are left out take their default. Throws bad_input for an unknown
/// scene (naming those that exist), an unknown option or a value that is not allowed.
Scene make_scene(const std::string &name, const SceneOptions &options = {});

} // namespace rbvi
