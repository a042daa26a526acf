// The hybrid dual basis against what complementarity says of it.
#include "../linear_algebra.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/mor/cones.hpp"

#include "multipliers.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace rbvi::hybrid_cone_test {
using namespace rbvi::testing_multipliers;

namespace {

using Nodes = std::vector<Index>;

HoldingMultipliers by_columns(const ColumnSource &columns) {
  return [columns](const Nodes &held, const Matrix &others) {
    return hold_by_columns(columns, held, others);
  };
}

/// Discrete membrane on `side`^2 free nodes pushed onto a paraboloid below its middle `inner`^2
/// nodes: x >= 0, H x + q(mu) >= 0, complementary, with q = -u_free + depth + |y|^2 / 2 - tilt . y.
struct Membrane {
  static constexpr Index side = 21, inner = 11, count = inner * inner;
  Matrix h;     ///< (A^-1) at the contact nodes
  Matrix terms; ///< q(mu) = terms * (1, depth, tilt_x, tilt_y)
  SparseMatrix product = grid_mass(inner);

  /// `reaction`: A is the Laplacian plus this multiple of the identity.
  explicit Membrane(double reaction = 0) : h(count, count), terms(count, 4) {
    Matrix line = 2 * Matrix::Identity(side, side);
    line.diagonal(1).setConstant(-1);
    line.diagonal(-1).setConstant(-1);
    Matrix a = reaction * Matrix::Identity(side * side, side * side);
    for (Index i = 0; i < side; ++i)
      for (Index j = 0; j < side; ++j) {
        a.block(i * side, j * side, side, side) += line(i, j) * Matrix::Identity(side, side);
        if (i == j) a.block(i * side, j * side, side, side) += line;
      }
    Nodes contact;
    for (Index k = 0; k < count; ++k)
      contact.push_back((k / inner + 5) * side + k % inner + 5);
    h = Matrix(a.inverse())(contact, contact);
    const Vector pushed = a.llt().solve(Vector::Ones(side * side));
    for (Index k = 0; k < count; ++k) {
      const double x = static_cast<double>(k / inner - 5) / 5,
                   y = static_cast<double>(k % inner - 5) / 5;
      terms.row(k) << (x * x + y * y) / 2 - pushed[contact[k]] / scale, 1, -x, -y;
    }
  }
  static constexpr double scale = 30; ///< about the largest deflection under a unit load

  ColumnSource columns() const {
    return [this](const Nodes &which) { return Matrix(h(Eigen::all, which)); };
  }
  HoldingMultipliers holding() const { return by_columns(columns()); }
  Vector multiplier(double depth, double tilt_x, double tilt_y) const {
    const Vector q = terms * Vector{{1, depth, tilt_x, tilt_y}};
    const LcpResult result = solve_lcp(columns(), q, {});
    EXPECT_TRUE(result.converged);
    return result.x;
  }
};

/// `per_axis`^3 parameters on a grid.
Matrix training(const Membrane &membrane, int per_axis) {
  Matrix snapshots(Membrane::count, per_axis * per_axis * per_axis);
  const auto at = [&](int k) { return 2.0 * k / (per_axis - 1) - 1; };
  Index p = 0;
  for (int a = 0; a < per_axis; ++a)
    for (int b = 0; b < per_axis; ++b)
      for (int c = 0; c < per_axis; ++c)
        snapshots.col(p++) = membrane.multiplier(0.2 + 0.05 * at(a), 0.08 * at(b), 0.08 * at(c));
  return snapshots;
}

/// The zones by their definition: contact at some mu, and open at some mu, each with `ring` layers.
struct Zones {
  Nodes permanent, moving;
};

Zones zones_of(const Matrix &snapshots, Index side, int ring) {
  Zones zones;
  for (Index k = 0; k < side * side; ++k) {
    bool ever = false, open = false;
    for (Index i = 0; i < side * side; ++i) {
      if (std::abs(i / side - k / side) > ring || std::abs(i % side - k % side) > ring) continue;
      ever = ever || (snapshots.row(i).array() > 0).any();
      open = open || (snapshots.row(i).array() == 0).any();
    }
    if (!open) zones.permanent.push_back(k);
    if (open && ever) zones.moving.push_back(k);
  }
  return zones;
}

Cone hybrid(const Matrix &snapshots, const Membrane &membrane, ConeOptions options) {
  options.type = ConeType::hybrid;
  return build_cone(snapshots, membrane.product, options, membrane.holding());
}

double largest(const Matrix &values, const Cone &cone, const SparseMatrix &product) {
  return distances_to_cone(values, cone.basis, product, cone.modes).maxCoeff();
}

/// With H = I.
HoldingMultipliers identity_holding(Index n) {
  return by_columns(
      [n](const Nodes &which) { return Matrix(Matrix::Identity(n, n)(Eigen::all, which)); });
}

/// 1 within `reach` of the centre of a side x side grid.
Vector square(Index side, Index reach) {
  Vector result = Vector::Zero(side * side);
  const Index centre = side / 2;
  for (Index i = -reach; i <= reach; ++i)
    for (Index j = -reach; j <= reach; ++j)
      result[(centre + i) * side + centre + j] = 1;
  return result;
}

Nodes nodes_of(const Vector &indicator) {
  Nodes nodes;
  for (Index k = 0; k < indicator.size(); ++k)
    if (indicator[k] > 0) nodes.push_back(k);
  return nodes;
}

} // namespace

TEST(HybridCone, ReproducesEverySnapshotWithOneModePerTermOfTheGap) {
  const Membrane membrane;
  const Matrix snapshots = training(membrane, 4), copy = snapshots;
  const Zones zones = zones_of(snapshots, Membrane::inner, 1);
  ASSERT_GT(zones.permanent.size(), 6u);
  ASSERT_GT(zones.moving.size(), 20u);
  const Matrix on_permanent = membrane.terms(zones.permanent, Eigen::all);
  const Index rank = rank_of(on_permanent);
  const Cone cone = hybrid(snapshots, membrane, {.tolerance = 0});
  EXPECT_EQ(snapshots, copy);
  EXPECT_EQ(cone.basis.generators.cols(), static_cast<Index>(zones.moving.size()));
  EXPECT_EQ(cone.modes.columns.cols(), rank);
  EXPECT_EQ(cone.history.reason, "round-off reached");
  EXPECT_LT(largest(snapshots, cone, membrane.product), 1e-12);
}

TEST(HybridCone, ReproducesUnseenParametersWhoseEdgeStaysInTheMovingZone) {
  const Membrane membrane;
  const Matrix snapshots = training(membrane, 4);
  const Zones zones = zones_of(snapshots, Membrane::inner, 1);
  const Cone cone = hybrid(snapshots, membrane, {.tolerance = 0});
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Matrix unseen(Membrane::count, 60);
  Index kept = 0;
  std::vector<Nodes> active_sets;
  for (int k = 0; k < 60; ++k) {
    const Vector x = membrane.multiplier(0.2 + 0.05 * uniform(engine), 0.08 * uniform(engine),
                                         0.08 * uniform(engine));
    const Nodes active = nodes_of(x);
    Nodes both = zones.permanent;
    both.insert(both.end(), zones.moving.begin(), zones.moving.end());
    std::sort(both.begin(), both.end());
    if (!std::includes(active.begin(), active.end(), zones.permanent.begin(),
                       zones.permanent.end()) ||
        !std::includes(both.begin(), both.end(), active.begin(), active.end()))
      continue;
    active_sets.push_back(active);
    unseen.col(kept++) = x;
  }
  ASSERT_GT(kept, 50);
  std::sort(active_sets.begin(), active_sets.end());
  EXPECT_GT(std::unique(active_sets.begin(), active_sets.end()) - active_sets.begin(), 10);
  EXPECT_LT(largest(unseen.leftCols(kept), cone, membrane.product), 1e-12);
  // Cones of snapshots do not: what the edge does between training parameters is new.
  const Cone mcpg =
      build_cone(snapshots, membrane.product, {.type = ConeType::mcpg, .tolerance = 0});
  EXPECT_GT(largest(unseen.leftCols(kept), mcpg, membrane.product), 1e-3);
}

TEST(HybridCone, GeneratorsAreNodalAndDoNotMoveThePermanentNodes) {
  const Membrane membrane;
  const Matrix snapshots = training(membrane, 3);
  const Zones zones = zones_of(snapshots, Membrane::inner, 1);
  const Cone cone = hybrid(snapshots, membrane, {.tolerance = 0});
  const Matrix &generators = cone.basis.generators;
  ASSERT_EQ(generators.cols(), static_cast<Index>(zones.moving.size()));
  Matrix outside = cone.all();
  outside(zones.permanent, Eigen::all).setZero();
  EXPECT_EQ(outside.rightCols(cone.modes.columns.cols()).norm(), 0);
  const Matrix on_moving = generators(zones.moving, Eigen::all);
  EXPECT_TRUE(on_moving.isDiagonal(0));
  EXPECT_GT(on_moving.diagonal().minCoeff(), 0);
  outside(zones.moving, Eigen::all).setZero();
  EXPECT_EQ(outside.norm(), 0);
  for (const auto &column : generators.colwise())
    EXPECT_NEAR(norm(column, membrane.product), 1, 1e-12);
  const Matrix displacements = membrane.h * generators;
  EXPECT_LT(displacements(zones.permanent, Eigen::all).norm(), 1e-12 * displacements.norm());
}

TEST(HybridCone, ModesAreOrthonormalInW) {
  const Membrane membrane;
  const Cone cone = hybrid(training(membrane, 3), membrane, {.tolerance = 0});
  const Matrix &modes = cone.modes.columns;
  ASSERT_GT(modes.cols(), 1);
  EXPECT_LT((modes.transpose() * (membrane.product * modes) -
             Matrix::Identity(modes.cols(), modes.cols()))
                .norm(),
            1e-12);
}

/// Bilinear hat functions of every other node of the grid, at all of its nodes.
SparseMatrix coarse_hats() {
  constexpr Index inner = Membrane::inner, coarse = (inner + 1) / 2;
  Matrix line = Matrix::Zero(inner, coarse);
  for (Index i = 0; i < inner; ++i) {
    line(i, i / 2) += 0.5;
    line(i, (i + 1) / 2) += 0.5;
  }
  Matrix hats(inner * inner, coarse * coarse);
  for (Index i = 0; i < inner; ++i)
    for (Index k = 0; k < coarse; ++k)
      for (Index j = 0; j < inner; ++j)
        hats.block(i * inner + j, k * coarse, 1, coarse) = line(i, k) * line.row(j);
  return hats.sparseView();
}

TEST(HybridCone, HatsOfSingleNodesAreTheDefault) {
  const Membrane membrane;
  const Matrix snapshots = training(membrane, 3);
  SparseMatrix identity(Membrane::count, Membrane::count);
  identity.setIdentity();
  EXPECT_EQ(hybrid(snapshots, membrane, {.tolerance = 0}).all(),
            hybrid(snapshots, membrane, {.tolerance = 0, .hats = identity}).all());
}

/// Those that reach into the moving zone, whole in it, one for each node of the coarser grid: their
/// sum is 1 there, so that a uniform pressure is held; and they do not move what stays in contact.
TEST(HybridCone, CoarserHatsCoverTheMovingZone) {
  const Membrane membrane;
  const Matrix snapshots = training(membrane, 4);
  const SparseMatrix hats = coarse_hats();
  const Zones fine = zones_of(snapshots, Membrane::inner, 0);
  const Cone cone = hybrid(snapshots, membrane, {.tolerance = 0, .ring = 0, .hats = hats});
  const Matrix &generators = cone.basis.generators;
  Index reaching = 0;
  for (Index c = 0; c < hats.cols(); ++c) {
    const Vector on_moving = Matrix(hats)(fine.moving, c);
    if (on_moving.maxCoeff() == 0) continue;
    const Vector generator = generators(fine.moving, reaching);
    EXPECT_LE((generator / generator.norm() - on_moving / on_moving.norm()).norm(), 1e-14);
    ++reaching;
  }
  EXPECT_EQ(generators.cols(), reaching);
  EXPECT_LT(reaching, static_cast<Index>(fine.moving.size()));
  const Matrix on_moving = generators(fine.moving, Eigen::all);
  const Vector ones = Vector::Ones(on_moving.rows());
  EXPECT_LE((on_moving * on_moving.completeOrthogonalDecomposition().solve(ones) - ones).norm(),
            1e-12);
  Nodes still; // contact that no coarse hat of the moving zone makes move
  for (const Index node : fine.permanent)
    if ((cone.modes.columns.row(node).array() != 0).any()) still.push_back(node);
  ASSERT_FALSE(still.empty());
  const Matrix displacements = membrane.h * generators;
  EXPECT_LT(displacements(still, Eigen::all).norm(), 1e-12 * displacements.norm());
}

/// H changes with mu: the modes take that up, and the history says how well.
TEST(HybridCone, HistoryIsABoundThatFalls) {
  const Membrane reference;
  Matrix snapshots(Membrane::count, 0);
  for (const double reaction : {0.0, 0.002, 0.004, 0.008}) {
    const Matrix more = training(Membrane(reaction), 3);
    snapshots.conservativeResize(Eigen::NoChange, snapshots.cols() + more.cols());
    snapshots.rightCols(more.cols()) = more;
  }
  const Cone cone = hybrid(snapshots, reference, {.tolerance = 1e-6});
  const ConeHistory &history = cone.history;
  const auto hats = static_cast<int>(cone.basis.generators.cols());
  ASSERT_GT(cone.modes.columns.cols(), 4);
  ASSERT_EQ(history.size.size(), static_cast<std::size_t>(cone.modes.columns.cols()) + 2);
  ASSERT_EQ(history.error.size(), history.size.size());
  ASSERT_EQ(history.gram_condition.size() + 1, history.size.size());
  EXPECT_EQ(history.size.front(), 0);
  EXPECT_EQ(history.error.front(), 1);
  EXPECT_TRUE(history.selected.empty());
  EXPECT_TRUE(history.e_orth.empty());
  EXPECT_EQ(history.reason, "tolerance reached");
  EXPECT_LE(history.error.back(), 1e-6);
  EXPECT_GT(history.error[history.error.size() - 2], 1e-6);
  for (std::size_t k = 1; k < history.size.size(); ++k) {
    const auto modes = static_cast<Index>(k) - 1;
    EXPECT_EQ(history.size[k], hats + modes);
    if (k > 1) {
      EXPECT_LE(history.error[k], history.error[k - 1]);
    }
    const FreeModes some{cone.modes.columns.leftCols(modes)};
    EXPECT_LE(distances_to_cone(snapshots, cone.basis, reference.product, some).maxCoeff(),
              history.error[k] + 1e-13);
    const Matrix part = cone.all().leftCols(hats + modes);
    const Vector gram = symmetric_eigenvalues(part.transpose() * (reference.product * part));
    // The eigenvalues of the Gram matrix carry the condition number times round-off.
    const double condition = history.gram_condition[k - 1];
    EXPECT_NEAR(condition * gram.minCoeff() / gram.maxCoeff(), 1, 1e-14 * condition + 1e-10);
  }
}

TEST(HybridCone, RingsGrowTheMovingAndErodeThePermanentNodes) {
  const Index side = 15, n = side * side;
  Matrix snapshots(n, 2);
  snapshots << square(side, 3), square(side, 5);
  for (int ring = 0; ring <= 5; ++ring) {
    const Cone cone = build_cone(snapshots, grid_mass(side),
                                 {.type = ConeType::hybrid, .ring = ring}, identity_holding(n));
    const Index inner = 3 - ring, outer = std::min<Index>(5 + ring, side / 2);
    const Vector permanent = inner >= 0 ? square(side, inner) : Vector(Vector::Zero(n));
    EXPECT_EQ(nodes_of(cone.basis.generators.rowwise().sum()),
              nodes_of(square(side, outer) - permanent))
        << ring;
    EXPECT_EQ(nodes_of(cone.modes.columns.cwiseAbs().rowwise().sum()), nodes_of(permanent)) << ring;
  }
}

TEST(HybridCone, WithoutPermanentNodesItIsNodal) {
  const SparseMatrix product = grid_mass(11);
  const Matrix snapshots = moving_bumps(11, 3, 0.4);
  ASSERT_TRUE((snapshots.rowwise().minCoeff().array() == 0).all());
  for (const int ring : {0, 1, 3}) {
    const Cone cone = build_cone(snapshots, product, {.type = ConeType::hybrid, .ring = ring});
    const Cone nodal = build_cone(snapshots, product, {.type = ConeType::nodal, .ring = ring});
    EXPECT_LT((cone.basis.generators - nodal.basis.generators).norm(), 1e-13);
    EXPECT_EQ(cone.modes.columns.cols(), 0);
    EXPECT_EQ(cone.history.size, nodal.history.size);
    EXPECT_EQ(cone.history.error, nodal.history.error);
  }
}

TEST(HybridCone, AllPermanentIsAProperOrthogonalDecomposition) {
  const SparseMatrix product = grid_mass(6);
  const Matrix snapshots = moving_bumps(6, 2, 0.1).array() + 0.5;
  const Cone cone = build_cone(snapshots, product, {.type = ConeType::hybrid, .tolerance = 0},
                               identity_holding(36));
  const ConeHistory &history = cone.history;
  const Matrix &modes = cone.modes.columns;
  EXPECT_EQ(cone.basis.generators.cols(), 0);
  ASSERT_EQ(history.size.size(), static_cast<std::size_t>(modes.cols()) + 1);
  EXPECT_EQ(history.error.front(), 1);
  const Matrix factor = product_factor(product);
  const double scale = (factor * snapshots).colwise().norm().maxCoeff();
  for (std::size_t k = 0; k < history.size.size(); ++k) {
    EXPECT_EQ(history.size[k], static_cast<int>(k));
    const Matrix known = factor * modes.leftCols(static_cast<Index>(k));
    const Matrix left = factor * snapshots - known * (known.transpose() * (factor * snapshots));
    EXPECT_NEAR(history.error[k], left.colwise().norm().maxCoeff() / scale, 1e-13);
  }
  EXPECT_LT(history.error.back(), 1e-12);
  // Never empty, as no greedy cone is.
  EXPECT_EQ(build_cone(snapshots, product, {.type = ConeType::hybrid, .tolerance = 2},
                       identity_holding(36))
                .size(),
            1);
}

TEST(HybridCone, EqualSingularValuesStayTogether) {
  // Singular values 4 + 1 and three times 1.
  const Matrix snapshots = Matrix::Ones(4, 4) + Matrix::Identity(4, 4);
  const auto modes = [&](double tolerance, int max_size) {
    const Cone cone =
        build_cone(snapshots, identity(4),
                   {.type = ConeType::hybrid, .tolerance = tolerance, .max_size = max_size},
                   identity_holding(4));
    EXPECT_EQ(cone.history.size.back(), cone.size());
    return cone.size();
  };
  // With one mode the remainder of each snapshot is a column of I - 1 1^T / 4: sqrt(3/4).
  const double one = std::sqrt(0.75 / 7);
  EXPECT_EQ(modes(1.01 * one, 0), 1);
  EXPECT_EQ(modes(0.99 * one, 0), 4);
  for (int max_size = 1; max_size <= 3; ++max_size)
    EXPECT_EQ(modes(0, max_size), 1);
  EXPECT_EQ(modes(0, 4), 4);
}

TEST(HybridCone, SizesItCannotHaveAreRefused) {
  const Membrane membrane;
  const Matrix snapshots = training(membrane, 3);
  const auto moving = static_cast<int>(zones_of(snapshots, Membrane::inner, 1).moving.size());
  const Cone hats = hybrid(snapshots, membrane, {.tolerance = 0, .max_size = moving});
  EXPECT_EQ(hats.size(), moving);
  EXPECT_EQ(hats.history.reason, "size reached");
  // The tilts in x and in y make a pair of modes, which is cut as one.
  for (int more = 1; more <= 4; ++more) {
    const auto size =
        hybrid(snapshots, membrane, {.tolerance = 0, .max_size = moving + more}).size();
    EXPECT_LE(size, moving + more);
    EXPECT_GE(size, moving + more - 1);
  }
  try {
    hybrid(snapshots, membrane, {.max_size = moving - 1});
    FAIL() << "accepted";
  } catch (const Error &error) {
    EXPECT_EQ(error.status(), Status::failed);
    EXPECT_NE(std::string(error.what()).find("-cone_max_size"), std::string::npos) << error.what();
  }
}

TEST(HybridCone, NeedsADefiniteCondensedOperator) {
  const Membrane membrane;
  const Matrix snapshots = training(membrane, 3);
  const ConeOptions options{.type = ConeType::hybrid};
  EXPECT_THROW(build_cone(snapshots, membrane.product, options), Error);
  const ColumnSource negative = [&](const Nodes &which) {
    return Matrix(-membrane.h(Eigen::all, which));
  };
  try {
    build_cone(snapshots, membrane.product, options, by_columns(negative));
    FAIL() << "accepted";
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("-reference_mu"), std::string::npos) << error.what();
  }
}

} // namespace rbvi::hybrid_cone_test
