#include "rbvi/fem/free_motions.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/fem/imposed.hpp"
#include "rbvi/fem/means.hpp"
#include "rbvi/fem/rigid_body_modes.hpp"
#include "rbvi/par/collective.hpp"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

/// Squares of sines between motions and what holds them, and energies relative to those of a rough
/// field: less is round-off.
constexpr double held = 1e-12;
constexpr long most_told = 3; ///< bodies

/// A connected part of the mesh: its box.
struct Body {
  Point low, high;
  Point centre() const { return (low + high) / 2; }
  double size() const { return norm(high - low) / 2; }
};

struct Bodies {
  const Mesh &mesh;
  const Dofs &dofs;
  std::vector<Point> at;    ///< per local node of an owned cell
  std::vector<int> of_node; ///< -1: of no owned cell
  std::vector<Body> all;
  bool turned = false; ///< about x = 0: the one rigid motion is along it

  int modes() const { return dofs.components == 1 || turned ? 1 : mesh.dim == 2 ? 3 : 6; }
  /// The rigid motions of the body of a node there, rotations about the centre.
  Vector motions(std::size_t node, int component) const {
    const Body &body = all[of_node[node]];
    const Point x = (at[node] - body.centre()) / body.size();
    return Vector::NullaryExpr(modes(), [&](Index mode) {
      return rigid_displacement(mesh.dim, turned ? 1 : static_cast<int>(mode), component, x);
    });
  }
  std::size_t dof(std::size_t node, int c) const {
    return node * static_cast<std::size_t>(dofs.components) + static_cast<std::size_t>(c);
  }
};

/// `mapped`: where the vertices are; empty: as in the reference mesh. Collective.
Bodies find_bodies(const Scene &scene, const Mesh &mesh, const Dofs &dofs,
                   const MappedVertices &mapped) {
  const std::size_t nodes = mesh.points.size();
  Bodies bodies{
      mesh, dofs, std::vector<Point>(nodes), std::vector<int>(nodes, -1), {}, scene.axisymmetric};
  const auto count = static_cast<Index>(mesh.bodies);
  Matrix highest = Matrix::Constant(6, count, -std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < mesh.cells.size(); ++k) {
    Cell cell = cell_of(mesh, k, mapped);
    if (!mapped.empty()) cell.reference = cell.mapped;
    const std::vector<Point> points = node_points(mesh.dim, mesh.degree, cell);
    const auto numbers = nodes_of(mesh, k);
    for (std::size_t i = 0; i < points.size(); ++i) {
      bodies.at[numbers[i]] = points[i];
      bodies.of_node[numbers[i]] = mesh.body[k];
      for (Index c = 0; c < 3; ++c) {
        double &high = highest(c, mesh.body[k]), &low = highest(3 + c, mesh.body[k]);
        high = std::max(high, points[i][c]);
        low = std::max(low, -points[i][c]);
      }
    }
  }
  over_ranks(mesh.comm, MPI_MAX, highest);
  for (Index b = 0; b < count; ++b)
    bodies.all.push_back({{-highest(3, b), -highest(4, b), -highest(5, b)},
                          {highest(0, b), highest(1, b), highest(2, b)}});
  return bodies;
}

/// Modes x (modes * bodies): sums over the dofs of each body.
using Grams = Matrix;

/// Motions at the fixed dofs. Collective.
Grams held_by_displacements(const Bodies &bodies) {
  const Index modes = bodies.modes();
  Grams grams = Grams::Zero(modes, modes * std::ssize(bodies.all));
  for (std::size_t node = 0; node < bodies.of_node.size(); ++node)
    for (int c = 0; c < bodies.dofs.components && bodies.of_node[node] >= 0; ++c) {
      if (bodies.dofs.free[bodies.dof(node, c)] >= 0) continue;
      const Vector motions = bodies.motions(node, c);
      grams.middleCols(bodies.of_node[node] * modes, modes) += motions * motions.transpose();
    }
  over_ranks(bodies.mesh.comm, MPI_SUM, grams);
  return grams;
}

/// What motions differ by on the boundaries that move as one, from their mean there. Collective.
void add_tied(const Bodies &bodies, const std::vector<TiedBoundary> &tied, Grams &grams) {
  const Index modes = bodies.modes();
  for (const auto &[name, component] : tied) {
    Matrix sums = Matrix::Zero(modes + 1, (modes + 1) * std::ssize(bodies.all)); // of (motions, 1)
    for (std::size_t node = 0; node < bodies.of_node.size(); ++node) {
      const int body = bodies.of_node[node];
      if (body < 0 || !bodies.mesh.boundary.at(name)[node]) continue;
      Vector here(modes + 1);
      here << bodies.motions(node, component), 1;
      sums.middleCols(body * (modes + 1), modes + 1) += here * here.transpose();
    }
    over_ranks(bodies.mesh.comm, MPI_SUM, sums);
    for (Index body = 0; body < std::ssize(bodies.all); ++body) {
      const Matrix own = sums.middleCols(body * (modes + 1), modes + 1);
      if (own(modes, modes) == 0) continue;
      const Vector whole = own.col(modes).head(modes);
      grams.middleCols(body * modes, modes) +=
          own.topLeftCorner(modes, modes) - whole * whole.transpose() / own(modes, modes);
    }
  }
}

/// Energies of motions by a term, relative to that of a rough field in the same body. Collective.
void add_energy(const Bodies &bodies, const Term &term, const FullMu &mu,
                const MappedVertices &mapped, Grams &grams) {
  const Index modes = bodies.modes(), each = modes + 1;
  const int components = bodies.dofs.components;
  Matrix fields = Matrix::Zero(std::ssize(bodies.of_node) * components, each);
  for (std::size_t node = 0; node < bodies.of_node.size(); ++node)
    for (int c = 0; c < components && bodies.of_node[node] >= 0; ++c)
      fields.row(static_cast<Index>(bodies.dof(node, c))) << bodies.motions(node, c).transpose(),
          std::cos(double(bodies.mesh.natural_node[node] * components + c));
  Matrix products(fields.rows(), each);
  collectively(bodies.mesh.comm, [&] {
    for (Index j = 0; j < each; ++j)
      products.col(j) =
          product_with({{&term.form}}, term.theta ? FullMu{} : mu, bodies.mesh, bodies.dofs,
                       term.theta ? MappedVertices{} : mapped, fields.col(j));
  });
  Matrix energies = Matrix::Zero(each, each * std::ssize(bodies.all));
  for (Index row = 0; row < fields.rows(); ++row)
    if (const int body = bodies.of_node[row / components]; body >= 0)
      energies.middleCols(body * each, each) += fields.row(row).transpose() * products.row(row);
  over_ranks(bodies.mesh.comm, MPI_SUM, energies);
  for (Index body = 0; body < std::ssize(bodies.all); ++body)
    if (const double rough = energies(modes, body * each + modes); rough > 0)
      grams.middleCols(body * modes, modes) += energies.block(0, body * each, modes, modes) / rough;
}

/// Of each body an orthonormal basis of the motions that are free, its columns.
std::vector<Matrix> free_motions(const Grams &grams) {
  std::vector<Matrix> free;
  for (Index first = 0; first < grams.cols(); first += grams.rows()) {
    const Matrix gram = grams.middleCols(first, grams.rows());
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(gram);
    free.push_back(eigen.eigenvectors().leftCols(
        (eigen.eigenvalues().array() <= held * std::max(1.0, gram.trace())).count()));
  }
  return free;
}

/// Takes from the free motions of all bodies together those that stretch a spring. Collective.
void hold_by_couplings(const Bodies &bodies, std::vector<Matrix> &free) {
  constexpr double stretched = 1e-6; // of the size of a motion
  std::vector<Index> first{0};
  for (const Matrix &motions : free)
    first.push_back(first.back() + motions.cols());
  const std::vector<Coupling> &couplings = bodies.dofs.couplings;
  if (couplings.empty() || first.back() == 0) return;
  Matrix stretches = Matrix::Zero(std::ssize(couplings), first.back());
  for (Index k = 0; k < stretches.rows(); ++k) {
    const Vector functional = mean_functional(couplings[k].means, bodies.mesh, bodies.dofs);
    for (Index i = 0; i < functional.size(); ++i) {
      const auto node = static_cast<std::size_t>(i / bodies.dofs.components);
      const int body = bodies.of_node[node];
      if (functional[i] == 0 || body < 0 || free[body].cols() == 0) continue;
      const Vector motions = bodies.motions(node, static_cast<int>(i % bodies.dofs.components));
      stretches.row(k).segment(first[body], free[body].cols()) +=
          functional[i] * motions.transpose() * free[body];
    }
  }
  over_ranks(bodies.mesh.comm, MPI_SUM, stretches);
  const Eigen::JacobiSVD<Matrix> svd(stretches, Eigen::ComputeFullV);
  const auto held_ones = (svd.singularValues().array() > stretched).count();
  const Matrix left = svd.matrixV().rightCols(first.back() - held_ones);
  for (std::size_t body = 0; body < free.size(); ++body) {
    if (left.cols() == 0) free[body].resize(Eigen::NoChange, 0);
    if (free[body].cols() == 0) continue;
    const Matrix own = free[body] * left.middleRows(first[body], free[body].cols());
    const Eigen::JacobiSVD<Matrix> range(own, Eigen::ComputeThinU);
    free[body] = range.matrixU().leftCols((range.singularValues().array() > stretched).count());
  }
}

bool is_free(const Matrix &motions) {
  return motions.cols() > 0;
}

std::string vector_text(const Bodies &bodies, const Point &x) {
  std::string text;
  for (int c = 0; c < bodies.mesh.dim; ++c)
    text.append(c == 0 ? "(" : ", ").append(short_number(std::abs(x[c]) < 1e-9 ? 0 : x[c]));
  return text.append(")");
}

/// Of either sign.
std::string direction_text(const Bodies &bodies, const Point &x) {
  const double sign = *std::ranges::max_element(x, {}, [](double part) { return std::abs(part); });
  return vector_text(bodies, x / std::copysign(1, sign));
}

/// "along (0, 1)": directions, the columns, orthonormal.
std::string translations_text(const Bodies &bodies, const Matrix &directions) {
  const Index dim = bodies.mesh.dim;
  if (directions.cols() == dim) return "move in every direction";
  const auto column = [&](Index j) {
    Point direction{};
    for (Index c = 0; c < dim; ++c)
      direction[c] = directions(c, j);
    return direction;
  };
  const bool one = directions.cols() == 1;
  return (one ? "move along " : "move at right angles to ") +
         direction_text(bodies, one ? column(0) : cross(column(0), column(1)));
}

/// Of turns, the columns: about a point in the plane, about an axis in space.
std::string turn_text(const Bodies &bodies, const Body &body, const Matrix &turns) {
  if (bodies.mesh.dim == 3)
    return turns.cols() > 1 ? "turn"
                            : "turn about an axis along " +
                                  direction_text(bodies, {turns(4, 0), turns(5, 0), turns(3, 0)});
  // The velocity (t_x - w y, t_y + w x) at (x, y) from the centre, in sizes, is zero there.
  const double scale = body.size() / turns(2, 0);
  return "turn about " +
         vector_text(bodies, body.centre() + Point{-turns(1, 0) * scale, turns(0, 0) * scale, 0});
}

/// "move along (0, 1) and turn about (0.5, 0)".
std::string motions_text(const Bodies &bodies, const Body &body, const Matrix &free) {
  if (bodies.turned) return "move along (0, 1)";
  if (free.cols() == bodies.modes()) return free.cols() == 1 ? "move" : "move and turn";
  const Index dim = bodies.mesh.dim;
  // Combinations without a turn are the translations, those at right angles to them turn.
  const Eigen::JacobiSVD<Matrix> svd(free.bottomRows(free.rows() - dim), Eigen::ComputeFullV);
  const auto turning = (svd.singularValues().array() > std::sqrt(held)).count();
  const Matrix all = free * svd.matrixV();
  std::vector<std::string> texts;
  if (free.cols() > turning)
    texts.push_back(translations_text(bodies, all.topRightCorner(dim, free.cols() - turning)));
  if (turning > 0) texts.push_back(turn_text(bodies, body, all.leftCols(turning)));
  return joined(texts, " and ");
}

/// Numbers of the bodies that have a cell in a region.
std::vector<PetscInt> bodies_in(const Mesh &mesh, const std::vector<bool> &region) {
  std::vector<PetscInt> in(static_cast<std::size_t>(mesh.bodies), 0);
  for (std::size_t k = 0; k < region.size(); ++k)
    if (region[k]) in[mesh.body[k]] = 1;
  over_ranks(mesh.comm, MPI_MAX, in);
  return in;
}

/// "the body", or which of several.
std::vector<std::string> names_of(const Bodies &bodies) {
  if (bodies.all.size() == 1) return {"the body"};
  std::vector<std::string> regions(bodies.all.size());
  for (const auto &[name, cells] : bodies.mesh.region) {
    const std::vector<PetscInt> in = bodies_in(bodies.mesh, cells);
    for (std::size_t body = 0; body < in.size(); ++body)
      if (in[body] != 0) regions[body] += (regions[body].empty() ? "'" : ", '") + name + "'";
  }
  std::vector<std::string> names;
  for (std::size_t body = 0; body < bodies.all.size(); ++body)
    names.push_back("the body " + (regions[body].empty() ? "" : regions[body] + " ") + "between " +
                    vector_text(bodies, bodies.all[body].low) + " and " +
                    vector_text(bodies, bodies.all[body].high));
  return names;
}

} // namespace

void check_held(const Scene &scene, const Mesh &mesh, const Dofs &dofs) {
  if (std::ranges::none_of(free_motions(held_by_displacements(find_bodies(scene, mesh, dofs, {}))),
                           is_free))
    return;
  const FullMu mu = generic_point(scene.parameters);
  const MappedVertices mapped = map_vertices(scene, mu, mesh);
  const Bodies bodies = find_bodies(scene, mesh, dofs, mapped);
  Grams grams = held_by_displacements(bodies);
  add_tied(bodies, scene.tied, grams);
  for (const Term &term : scene.a)
    if (term.form.means.empty()) add_energy(bodies, term, mu, mapped, grams);
  std::vector<Matrix> free = free_motions(grams);
  hold_by_couplings(bodies, free);
  const long all = std::ranges::count_if(free, is_free);
  if (all == 0) return;
  const std::vector<std::string> names = names_of(bodies);
  std::string found;
  long told = 0;
  for (std::size_t body = 0; body < free.size() && told < most_told; ++body)
    if (is_free(free[body]))
      found.append(told++ == 0 ? "" : ", ")
          .append(names[body] + " can " + motions_text(bodies, bodies.all[body], free[body]));
  if (all > told) found.append(" (and " + std::to_string(all - told) + " more)");
  throw bad_input(found + ": impose displacements that prevent it; contact alone holds no body");
}

} // namespace rbvi
