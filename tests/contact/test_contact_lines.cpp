// The lines that integrals over contact are taken along.
#include "../../src/contact/surface_parts.hpp"
#include "rbvi/contact/named_outputs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace rbvi::contact_lines_test {
namespace {

/// Edges of length 0.1 along y = 0 from x = 0 on.
Grid line(const Vector &pressure, const Vector &gap, const Vector &shear = {},
          const Vector &slip = {}) {
  Grid grid;
  const Index nodes = gap.size();
  grid.per_cell = 2;
  grid.points = Matrix::Zero(nodes, 2);
  grid.points.col(0) = Vector::LinSpaced(nodes, 0, 0.1 * static_cast<double>(nodes - 1));
  for (int k = 1; k < nodes; ++k)
    grid.cells.insert(grid.cells.end(), {k - 1, k});
  grid.of_nodes = {{"u", Vector::Zero(3 * nodes)},
                   {"gap", gap},
                   {"slip", slip.size() > 0 ? slip : Vector::Zero(nodes)}};
  (pressure.size() == nodes ? grid.of_nodes : grid.of_cells).push_back({"pressure", pressure});
  if (shear.size() > 0) grid.of_nodes.push_back({"tangential_stress", shear});
  return grid;
}

double measure(const std::vector<ContactLine> &lines, std::size_t field) {
  double sum = 0;
  for (const ContactLine &one : lines) {
    const auto &[first, last, middle] = one.fields;
    EXPECT_EQ(first[field], last[field]);
    sum += (last[field::x] - first[field::x]) * first[field];
  }
  return sum;
}

double whole(const std::vector<ContactLine> &lines) {
  double sum = 0;
  for (const auto &[fields, seen, measure] : lines)
    sum += fields[1][field::x] - fields[0][field::x];
  return sum;
}

TEST(ContactLines, EndWherePressureAndGapSay) {
  const double end = 0.44; // inside an edge; the zone begins before the first node
  const auto pressure = [&](double x) { return std::sqrt(std::max(0.0, end - x)); };
  const auto gap = [&](double x) { return std::pow(std::max(0.0, x - end), 1.5); };
  Vector p(8), g(8);
  for (Index k = 0; k < 8; ++k) {
    p[k] = pressure(0.1 * static_cast<double>(k));
    g[k] = gap(0.1 * static_cast<double>(k));
  }
  const auto lines = contact_lines(line(p, g), {}, 0);
  EXPECT_NEAR(whole(lines), 0.7, 1e-14);
  EXPECT_NEAR(measure(lines, field::contact), end, 0.015) << "of nodal values 0.1 apart";
  EXPECT_EQ(measure(lines, field::stick), 0) << "no friction";
  double force = 0;
  for (const auto &[fields, seen, measure] : lines) {
    force += (fields[1][field::x] - fields[0][field::x]) *
             (fields[0][field::pressure] + fields[1][field::pressure]) / 2;
    for (const std::size_t e : {0, 1})
      EXPECT_EQ(seen[e][field::pressure] > 0,
                fields[e][field::contact] > 0 && seen[e][field::x] < lines[4].fields[1][field::x])
          << "a condition sees none beyond the end, where it is zero";
  }
  EXPECT_NEAR(force, 0.1 * (p.sum() - p[0] / 2), 1e-14) << "an integral sees the multipliers";
  // The other way round, the end on the left.
  const auto turned = contact_lines(line(p.reverse(), g.reverse()), {}, 0);
  EXPECT_NEAR(measure(turned, field::contact), measure(lines, field::contact), 1e-14);
}

TEST(ContactLines, EndNearANodeThatClosesOrOpens) {
  const Vector g{{0, 0, 0, 0, 1, 3}};
  const auto width = [&](const Vector &p, const Vector &gap) {
    return measure(contact_lines(line(p, gap), {}, 0), field::contact);
  };
  Vector closing = g, opening = g;
  closing[3] = 1e-12;
  EXPECT_NEAR(width(Vector{{3, 2, 1, 0, 0, 0}}, closing), 0.3, 0.02);
  EXPECT_NEAR(width(Vector{{3, 2, 1, 1e-12, 0, 0}}, opening), 0.3, 0.02);
  EXPECT_EQ(width(Vector{{0.0, 0, 0, 0, 0, 0}}, g), 0);
  EXPECT_NEAR(width(Vector{{1.0, 1, 1, 1, 1, 1}}, Vector::Zero(6)), 0.5, 1e-15);
  EXPECT_NEAR(width(Vector{{2, 1, 0, 0, 0}}, g), 0.2, 1e-15) << "constant on edges";
}

TEST(ContactLines, CutWhereSignsChange) {
  const Vector shear{{1, 3, -1, -2}}, slip{{0, 2, 2, -6}};
  const auto lines =
      contact_lines(line(Vector::Ones(4), Vector::Zero(4), shear, slip), {.coefficient = 0.1}, 0);
  EXPECT_EQ(lines.size(), 5U);
  double tangential = 0, way = 0;
  for (const auto &[fields, seen, measure] : lines) {
    const auto &[a, b, middle] = fields;
    const double length = b[field::x] - a[field::x];
    tangential += length * std::abs(a[field::tangential] + b[field::tangential]) / 2;
    way += length * std::abs(a[field::slip] + b[field::slip]) / 2;
  }
  EXPECT_NEAR(tangential, 0.1 * (2 + (0.75 * 3 + 0.25 * 1) / 2 + 1.5), 1e-14);
  EXPECT_NEAR(way, 0.1 * (1 + 2 + (0.25 * 2 + 0.75 * 6) / 2), 1e-14);
}

/// A stick zone is a zone like contact, of what the shear is below its bound and of the slip.
TEST(ContactLines, StickEndsInsideAnEdge) {
  const double end = 0.26;
  Vector shear(8), slip(8);
  for (Index k = 0; k < 8; ++k) {
    const double x = 0.1 * static_cast<double>(k);
    shear[k] = 1 - std::sqrt(std::max(0.0, end - x));
    slip[k] = -std::pow(std::max(0.0, x - end), 1.5);
  }
  const FrictionBound bound{.coefficient = 0.5};
  const Vector pressed = Vector::Constant(8, 2.0), closed = Vector::Zero(8);
  EXPECT_NEAR(measure(contact_lines(line(pressed, closed, shear, slip), bound, 0), field::stick),
              end, 0.015);
  const Vector before = Vector::Constant(8, 0.3);
  EXPECT_NEAR(
      measure(contact_lines(line(pressed, closed, shear, slip + before), bound, 0), field::stick),
      end, 0.015)
      << "bodies that have slipped before";
  // Narrower than an edge, between nodes that slip both ways.
  Vector both(8), ways(8);
  for (Index k = 0; k < 8; ++k) {
    const double x = 0.1 * static_cast<double>(k) - 0.35, away = std::abs(x) - 0.03;
    both[k] = x < 0 ? 1 : -1;
    ways[k] = (x < 0 ? -1 : 1) * std::pow(away, 1.5);
  }
  EXPECT_NEAR(measure(contact_lines(line(pressed, closed, both, ways), bound, 0), field::stick),
              0.06, 1e-12);
}

/// Triangles of [0, 1] x [0, 1], halves of squares of side 1/4, in space.
Grid squares(const std::function<std::array<double, 2>(double, double)> &pressure_and_shear) {
  constexpr int n = 4;
  Grid grid;
  grid.per_cell = 3;
  grid.points = Matrix::Zero((n + 1) * (n + 1), 3);
  Vector pressure(grid.points.rows()), shear(3 * pressure.size());
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const Index node = i + (n + 1) * j;
      grid.points(node, 0) = i / double(n);
      grid.points(node, 1) = j / double(n);
      const auto [p, t] = pressure_and_shear(i / double(n), j / double(n));
      pressure[node] = p;
      shear.segment<3>(3 * node) << 0.6 * t, -0.8 * t, 0;
    }
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int a = i + (n + 1) * j, c = a + n + 2;
      for (const int b : {a + 1, a + n + 1})
        grid.cells.insert(grid.cells.end(), {a, b, c});
    }
  grid.of_nodes = {{"u", Vector::Zero(3 * pressure.size())},
                   {"pressure", pressure},
                   {"tangential_stress", shear}};
  return grid;
}

/// Over squares, an integral of what `value` and where `condition` says.
double over(const ContactSurface &surface, const std::function<double(const double *)> &value,
            const std::function<bool(const double *)> &condition = nullptr) {
  OutputForm form;
  form.conditional = condition != nullptr;
  form.values = [&](const FullMu &, const double *fields, std::size_t count, double *results) {
    std::array<double, field::count> at;
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t c = 0; c < at.size(); ++c)
        at[c] = fields[c * count + i];
      results[i] = value(at.data());
      results[count + i] = condition == nullptr || condition(at.data()) ? 1 : 0;
    }
  };
  const FullMu mu;
  const MirrorPlanes mirrors;
  OutputLines lines(form, mu, mirrors);
  surface.add_to(lines);
  return lines.sums().integral;
}

double one(const double *) {
  return 1;
}

/// Nodes touch up to x = 3/4 and stick up to x = 1/4, and so it is up to the middles of the edges
/// beyond them.
TEST(ContactSurface, HasTheAreasOfItsNodes) {
  const FrictionBound bound{0.5};
  const auto in_contact = [](const double *at) { return at[field::contact]; };
  const auto sticking = [](const double *at) { return at[field::stick]; };
  const ContactSurface surface(
      squares([](double x, double) {
        return x < 0.8 ? std::array{2.0, x < 0.3 ? 0.4 : 1.0} : std::array{0.0, 0.0};
      }),
      bound, 0);
  EXPECT_NEAR(over(surface, one), 1, 1e-14);
  EXPECT_NEAR(over(surface, in_contact), 0.875, 1e-14);
  EXPECT_NEAR(over(surface, sticking), 0.375, 1e-14);
  EXPECT_NEAR(over(surface,
                   [](const double *at) { return at[field::stick] * at[field::x] * at[field::y]; }),
              0.375 * 0.375 / 4, 1e-14);
  // A single node has a quarter of its triangles, one that is out leaves the rest of them.
  const ContactSurface others(squares([](double x, double y) {
                                return std::array{2.0, x == 0.5 && y == 0.5 ? 0.4 : 1.0};
                              }),
                              bound, 0);
  EXPECT_NEAR(over(others, sticking), 6 * 0.25 / 32, 1e-14);
  EXPECT_NEAR(over(others, in_contact), 1, 1e-14);
}

/// Straight conditions askew to the triangles cut them exactly, and a traction is squared as it is.
TEST(ContactSurface, IsCutWhereAConditionSays) {
  const ContactSurface surface(squares([](double x, double y) {
                                 return std::array{2.0, 0.2 * (x + y)};
                               }),
                               {0.5}, 0);
  for (const double place : {0.31, 0.7, 1.2}) {
    const double corner = std::max(0.0, place - 1);
    EXPECT_NEAR(
        over(surface, one, [&](const double *at) { return at[field::x] + at[field::y] < place; }),
        place * place / 2 - corner * corner, 1e-10);
    EXPECT_NEAR(over(surface, one,
                     [&](const double *at) { return 3 * at[field::x] - at[field::y] > place; }),
                1 - (place + 0.5) / 3, 1e-10);
  }
  EXPECT_NEAR(
      over(surface, [](const double *at) { return at[field::tangential] * at[field::tangential]; }),
      0.04 * (2.0 / 3 + 0.5), 1e-14);
}

} // namespace
} // namespace rbvi::contact_lines_test
