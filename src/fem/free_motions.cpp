#include "rbvi/fem/free_motions.hpp"

#include "means.hpp"
#include "motion_text.hpp"
#include "rbvi/core/box.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/core/text.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/fem/imposed.hpp"
#include "rbvi/fem/rigid_body_modes.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/stored_scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbvi {

namespace {

struct Bodies {
  const Mesh &mesh;
  const Dofs &dofs;
  std::vector<Point> at;    ///< per local node of an owned cell
  std::vector<int> of_node; ///< -1: of no owned cell
  std::vector<MeshPart> all;
  bool turned = false; ///< about x = 0: the one rigid motion is along it

  int modes() const { return dofs.components == 1 || turned ? 1 : mesh.dim == 2 ? 3 : 6; }
  /// The rigid motions of the body of a node there, rotations about the centre.
  Vector motions(std::size_t node, int component) const {
    const MeshPart &body = all[of_node[node]];
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
        (eigen.eigenvalues().array() <= motion_is_held * std::max(1.0, gram.trace())).count()));
  }
  return free;
}

/// Takes from the free motions of all bodies together those that stretch one of these springs.
/// Collective.
void hold_by_couplings(const Bodies &bodies, const std::vector<Coupling> &couplings,
                       std::vector<Matrix> &free) {
  constexpr double stretched = 1e-6; // of the size of a motion
  std::vector<Index> first{0};
  for (const Matrix &motions : free)
    first.push_back(first.back() + motions.cols());
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
                    vector_text(bodies.mesh.dim, bodies.all[body].low) + " and " +
                    vector_text(bodies.mesh.dim, bodies.all[body].high));
  return names;
}

/// Throws bad_input where only springs without stiffness somewhere in the box hold a motion.
/// `free`: those that nothing but springs holds, `left`: those that no spring does. Collective.
void check_lasting(const Scene &scene, const Bodies &bodies, std::vector<Matrix> free,
                   const std::vector<Matrix> &left) {
  const std::vector<Mu> box = corners_and_faces(scene.parameters);
  std::vector<Coupling> lasting;
  std::string lost;
  auto coupling = bodies.dofs.couplings.begin(); // one for each spring, in their order
  for (const Term &term : scene.a) {
    if (term.form.means.empty()) continue;
    const auto zero = std::ranges::find_if(box, [&](const Mu &mu) {
      return !(coefficient_of(term, expand(scene.parameters, mu)) > 0);
    });
    if (zero == box.end())
      lasting.push_back(*coupling);
    else
      lost = "the spring on " + boundaries_of(term.form.means) + " has no stiffness at " +
             describe(scene.parameters, *zero);
    ++coupling;
  }
  if (lost.empty()) return;
  hold_by_couplings(bodies, lasting, free);
  for (std::size_t body = 0; body < free.size(); ++body)
    if (free[body].cols() > left[body].cols())
      throw bad_input(lost + ", and nothing else holds " + names_of(bodies)[body] +
                      ": let the stiffness stay above 0");
}

/// A node with springs: its free dofs and the motions there.
struct SpringNode {
  std::vector<PetscInt> rows;
  Matrix motions; ///< rows x modes
};

/// The node of a body nearest to a point, the one of the least natural number. Collective.
SpringNode nearest_node(const Bodies &bodies, int body, const Point &to) {
  struct {
    double distance = std::numeric_limits<double>::infinity();
    int natural = std::numeric_limits<int>::max();
  } nearest;
  std::size_t here = 0;
  for (std::size_t node = 0; node < bodies.of_node.size(); ++node) {
    if (bodies.of_node[node] != body || !bodies.mesh.owned_node[node]) continue;
    const double distance = norm(bodies.at[node] - to);
    const auto natural = static_cast<int>(bodies.mesh.natural_node[node]);
    if (std::pair(distance, natural) >= std::pair(nearest.distance, nearest.natural)) continue;
    nearest.distance = distance;
    nearest.natural = natural;
    here = node;
  }
  const int mine = nearest.natural;
  MPI_Allreduce(MPI_IN_PLACE, &nearest, 1, MPI_DOUBLE_INT, MPI_MINLOC, bodies.mesh.comm);
  const int components = bodies.dofs.components;
  Matrix found = Matrix::Zero(components, 1 + bodies.modes());
  if (mine == nearest.natural && bodies.of_node[here] == body)
    for (int c = 0; c < components; ++c)
      found.row(c) << double(bodies.dofs.free[bodies.dof(here, c)]),
          bodies.motions(here, c).transpose();
  over_ranks(bodies.mesh.comm, MPI_SUM, found);
  SpringNode node{{}, Matrix(0, bodies.modes())};
  for (int c = 0; c < components; ++c) {
    if (found(c, 0) < 0) continue;
    node.rows.push_back(static_cast<PetscInt>(found(c, 0)));
    node.motions.conservativeResize(std::ssize(node.rows), Eigen::NoChange);
    node.motions.bottomRows(1) = found.row(c).tail(bodies.modes());
  }
  return node;
}

/// Near the corners of its box, which they hold like the whole body. Collective.
void choose_springs(const Bodies &bodies, FreeBody &body) {
  Matrix motions(0, bodies.modes());
  for (int corner = 0; corner < 1 << bodies.mesh.dim; ++corner) {
    Point at{};
    for (int c = 0; c < bodies.mesh.dim; ++c)
      at[c] = ((corner >> c) & 1) != 0 ? body.part.high[c] : body.part.low[c];
    const SpringNode node = nearest_node(bodies, body.number, at);
    if (node.rows.empty() || std::ranges::find(body.rows, node.rows.front()) != body.rows.end())
      continue;
    body.rows.insert(body.rows.end(), node.rows.begin(), node.rows.end());
    motions.conservativeResize(std::ssize(body.rows), Eigen::NoChange);
    motions.bottomRows(std::ssize(node.rows)) = node.motions;
  }
  const ThinQr qr = thin_qr(motions * body.motions);
  if (!(qr.r.diagonal().cwiseAbs().minCoeff() > 1e-6))
    throw bad_input(body.name + " has too few nodes that can move");
  body.springs = qr.q;
}

/// The first of the exact terms of a on cells of the body whose theta varies least, of those that
/// are positive: Lame's lambda vanishes at Poisson's ratio 0; -1: none is. Collective.
int term_on(const Scene &scene, const Mesh &mesh, int body) {
  const std::vector<Mu> box = corners_and_faces(scene.parameters);
  double least = std::numeric_limits<double>::infinity();
  int result = -1;
  for (std::size_t q = 0; q < scene.a.size(); ++q) {
    const Term &term = scene.a[q];
    const std::string &region = term.form.region;
    if (!term.theta || !term.form.boundary.empty() || !term.form.means.empty()) continue;
    if (!region.empty() && bodies_in(mesh, mesh.region.at(region))[body] == 0) continue;
    Vector theta(std::ssize(box) + 1);
    theta[0] = coefficient_of(term, generic_point(scene.parameters));
    for (Index k = 1; k < theta.size(); ++k)
      theta[k] = coefficient_of(term, expand(scene.parameters, box[k - 1]));
    const double variation = theta.maxCoeff() / theta.minCoeff();
    if (!(theta.minCoeff() > 0 && variation < (1 - 1e-6) * least)) continue;
    least = variation;
    result = static_cast<int>(q);
  }
  return result;
}

} // namespace

std::vector<FreeBody> free_bodies(const Scene &scene, const Mesh &mesh, const Dofs &dofs) {
  const auto is_free = [](const Matrix &motions) { return motions.cols() > 0; };
  if (std::ranges::none_of(free_motions(held_by_displacements(find_bodies(scene, mesh, dofs, {}))),
                           is_free))
    return {};
  const FullMu mu = generic_point(scene.parameters);
  const MappedVertices mapped = map_vertices(scene, mu, mesh);
  const Bodies bodies = find_bodies(scene, mesh, dofs, mapped);
  Grams grams = held_by_displacements(bodies);
  add_tied(bodies, scene.tied, grams);
  for (const Term &term : scene.a)
    if (term.form.means.empty()) add_energy(bodies, term, mu, mapped, grams);
  std::vector<Matrix> free = free_motions(grams);
  const std::vector<Matrix> without_springs = free;
  hold_by_couplings(bodies, dofs.couplings, free);
  check_lasting(scene, bodies, without_springs, free);
  if (std::ranges::none_of(free, is_free)) return {};
  const std::vector<std::string> names = names_of(bodies);
  std::vector<FreeBody> result;
  for (std::size_t body = 0; body < free.size(); ++body)
    if (is_free(free[body]))
      result.push_back(
          {names[body], static_cast<int>(body), bodies.turned, bodies.all[body], free[body]});
  return result;
}

std::vector<FreeBody> add_springs(Scene &scene, const Mesh &mesh, Dofs &dofs) {
  std::vector<FreeBody> result = free_bodies(scene, mesh, dofs);
  if (result.empty()) return result;
  if (scene.components == 1)
    throw bad_input(
        describe(result, mesh.dim, Matrix::Identity(motions_of(result), motions_of(result))) +
        ": impose displacements that prevent it");
  const Bodies bodies =
      find_bodies(scene, mesh, dofs, map_vertices(scene, generic_point(scene.parameters), mesh));
  for (FreeBody &body : result) {
    choose_springs(bodies, body);
    body.term = static_cast<int>(scene.a.size());
    add_held_body(scene, term_on(scene, mesh, body.number));
    dofs.couplings.push_back({{}, body.rows, std::vector<double>(body.rows.size(), 0)});
  }
  return result;
}

std::vector<Handle<Vec>> rigid_motions(const std::vector<FreeBody> &bodies, const Scene &scene,
                                       const FullMu &mu, const Mesh &mesh, const Dofs &dofs) {
  const Bodies parts = find_bodies(scene, mesh, dofs, map_vertices(scene, mu, mesh));
  const std::vector<Matrix> free = free_motions(held_by_displacements(parts));
  std::vector<Handle<Vec>> result;
  for (const FreeBody &body : bodies) {
    // Points that displacements hold may move with mu, and with them what a turn is about.
    const bool by_displacements = free[body.number].cols() == body.motions.cols();
    const Matrix &now = free[body.number];
    const Matrix motions =
        by_displacements ? Matrix(now * (now.transpose() * body.motions)) : body.motions;
    for (Index k = 0; k < motions.cols(); ++k) {
      Handle<Vec> motion = make_vector(dofs);
      for (std::size_t node = 0; node < parts.of_node.size(); ++node) {
        if (parts.of_node[node] != body.number || !mesh.owned_node[node]) continue;
        for (int c = 0; c < dofs.components; ++c)
          if (const PetscInt row = dofs.free[parts.dof(node, c)]; row >= 0)
            RBVI_CALL(VecSetValue(motion.get(), row, parts.motions(node, c).dot(motions.col(k)),
                                  INSERT_VALUES));
      }
      RBVI_CALL(VecAssemblyBegin(motion.get()));
      RBVI_CALL(VecAssemblyEnd(motion.get()));
      result.push_back(std::move(motion));
    }
  }
  return result;
}

} // namespace rbvi
