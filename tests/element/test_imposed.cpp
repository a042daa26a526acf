// Loads and energy of imposed displacements: on one cell they are what its matrices make of the
// imposed values, however these and the operators depend on mu.
#include "../core/refuses.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/element/facet_forms.hpp"
#include "rbvi/element/imposed.hpp"
#include "rbvi/element/lagrange.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rbvi::imposed_test {
namespace {

const FullMu mu{0.7, 1.3};

Factor parameter(int number) {
  return {
      "mu" + std::to_string(number), [number](const FullMu &at) { return at[number]; }, {number}};
}

const ImposedTerm known{[](const FullMu &, const Point &x) {
                          return Point{1 + x[0] * x[1], x[1], 0};
                        },
                        std::vector{parameter(0)}},
    other{[](const FullMu &, const Point &x) {
            return Point{x[1], -2 * x[0], 0};
          },
          std::vector{parameter(0), parameter(1)}},
    general{[](const FullMu &at, const Point &x) {
              return Point{std::sin(at[1] * x[0]), std::exp(at[0] * x[1]), 0};
            },
            {},
            std::vector{0, 1}};

/// Elasticity of degree 2 with an exact and, if asked for, a mapped term, under body forces alike.
Scene body(bool mapped, std::vector<FixedBoundary> fixed) {
  Scene scene;
  scene.name = "body";
  scene.components = scene.degree = 2;
  scene.parameters = all_free({{"mu0", "", 0, 1, 0.5}, {"mu1", "", 1, 2, 1.5}});
  scene.a = {exact_term(elasticity("", lame(3, 0.2), 2), {parameter(1)})};
  const Form force{"", [](const FullMu &, const Cell &, double *values) {
                     for (int i = 0; i < 12; ++i)
                       values[i] = std::cos(1.0 + i);
                   }};
  scene.f = {exact_term(force, {parameter(0)})};
  if (mapped) {
    scene.a.push_back(mapped_term(elasticity("", lame(1, 0.4), 2), std::vector{1}));
    scene.f.push_back(mapped_term(force));
  }
  scene.fixed = std::move(fixed);
  return scene;
}

/// A cell, its first and fourth node on boundary 0, of the second one a component on boundary 1.
struct HeldCell {
  std::vector<int> imposed_by{0, 0, -1, 1, -1, -1, 0, 0, -1, -1, -1, -1};
  Cell cell{2, {{{0.1, 0.2, 0}, {2, 0.3, 0}, {0.4, 1, 0}, {}}}, {}, imposed_by.data()};
  HeldCell() {
    for (std::size_t i = 0; i < 3; ++i)
      cell.mapped[i] = {1.5 * cell.reference[i][0], cell.reference[i][1] + cell.reference[i][0], 0};
  }
};

/// The sum of some terms on the cell: exact ones on the reference domain, times theta.
Vector sum_on(const Cell &cell, const Sum &sum, Index size, bool of_imposed) {
  Vector result = Vector::Zero(size);
  for (const Term &term : sum) {
    if (term.of_imposed != of_imposed) continue;
    Cell at = cell;
    if (term.theta) at.mapped = at.reference;
    Vector values(size);
    term.form.kernel(term.theta ? FullMu{} : mu, at, values.data());
    double theta = 1;
    for (std::size_t i = 0; term.theta && i < term.theta->size(); ++i)
      theta *= (*term.theta)[i].value(mu);
    result += theta * values;
  }
  return result;
}

TEST(ImposedForms, AreThoseOfTheMatricesOfACell) {
  const HeldCell held;
  for (const bool mapped : {false, true})
    for (const auto &values : {std::vector{known, other}, {known, general}, {general}}) {
      const Scene scene =
          with_imposed_loads(body(mapped, {{"left", {}, values}, {"foot", {1}, {known}}}));
      const Vector l = imposed_values(scene, mu, node_points(2, 2, held.cell), held.imposed_by);
      EXPECT_EQ((l.array() != 0).count(), 5);
      const Matrix k = sum_on(held.cell, scene.a, 144, false).reshaped(12, 12);
      const Vector f = sum_on(held.cell, scene.f, 12, false);
      EXPECT_LE((sum_on(held.cell, scene.f, 12, true) + k * l).norm(), 1e-13 * (k * l).norm());
      const double energy = sum_on(held.cell, imposed_energy(scene), 1, true)[0];
      EXPECT_NEAR(energy, l.dot(k * l) / 2 - f.dot(l), 1e-12 * l.dot(k * l));
      Cell free = held.cell;
      free.imposed_by = nullptr;
      EXPECT_EQ(sum_on(free, scene.f, 12, true).norm(), 0);
      EXPECT_EQ(sum_on(free, imposed_energy(scene), 1, true)[0], 0);
    }
}

/// Loads of two boundaries that share facets count these once (Form::without): so does their work.
TEST(ImposedForms, TheWorkOfAMotionIsOverWhatItsLoadIsOver) {
  for (const bool mapped : {false, true}) {
    Scene scene = body(mapped, {});
    for (Term &term : scene.f)
      term.form.without = {"sides"};
    for (const std::function<PointMap> &motion :
         {everywhere(Point{1, 2, 0}), std::function<PointMap>([](const FullMu &at, const Point &x) {
            return Point{at[0] * x[1], at[1], 0};
          })}) {
      scene.motion = motion;
      const Sum energy = imposed_energy(scene);
      EXPECT_FALSE(energy.empty());
      for (const Term &term : energy)
        EXPECT_EQ(term.form.without, std::vector<std::string>{"sides"});
    }
  }
}

TEST(ImposedForms, AreExactWhereAllFactorsAreKnown) {
  const auto exact = [](const Sum &sum) {
    return std::ranges::all_of(sum, [](const Term &term) { return term.theta.has_value(); });
  };
  const Scene known_all = with_imposed_loads(body(false, {{"left", {}, {known, other}}}));
  EXPECT_EQ(known_all.f.size(), 3U);
  EXPECT_EQ(imposed_energy(known_all).size(), 5U) << "three products of values, two of the force";
  EXPECT_TRUE(exact(known_all.f) && exact(imposed_energy(known_all)));
  const Scene in_part = with_imposed_loads(body(false, {{"left", {}, {known, general}}}));
  EXPECT_EQ(in_part.f.size(), 3U);
  EXPECT_EQ(in_part.f.back().parameters, (std::vector{1, 0, 0, 1}));
  EXPECT_FALSE(exact(in_part.f) || exact(imposed_energy(in_part)));
}

TEST(ImposedForms, AreMadeOnceAndNotOfWhatIsZero) {
  Scene scene = body(true, {{"left", {}, {known}}, {"foot", {}, {}}});
  const Scene once = with_imposed_loads(scene), twice = with_imposed_loads(once);
  EXPECT_TRUE(imposes_values(once));
  EXPECT_GT(once.f.size(), scene.f.size());
  EXPECT_EQ(twice.f.size(), once.f.size());
  scene.parameters.free = {1};
  scene.parameters.all[0].value = 0; // the factor of all values
  EXPECT_FALSE(imposes_values(with_imposed_loads(scene)));
  EXPECT_EQ(with_imposed_loads(scene).f.size(), scene.f.size());
  EXPECT_TRUE(imposed_energy(with_imposed_loads(scene)).empty());
}

TEST(ImposedForms, AValueThatIsNotFiniteIsNamed) {
  const ImposedTerm bad{[](const FullMu &at, const Point &) {
    return Point{0, at[0] > 0 ? std::numeric_limits<double>::infinity() : 0, 0};
  }};
  const Scene scene = body(false, {{"left", {}, {bad}}});
  EXPECT_TRUE(refuses("imposed on the boundary 'left' is not finite at mu0=0.7 mu1=1.3",
                      [&] { imposed_value(scene, mu, 0, {}); }));
}

} // namespace
} // namespace rbvi::imposed_test
