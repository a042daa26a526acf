// What a model must be, smaller ones cut out of it, and what is printed of it.
#include "full_model.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/model/print.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace rbvi::model_parts_test {
namespace {

TEST(CheckModel, NamesWhatDoesNotFit) {
  const auto refused = [](auto change) {
    ReducedModel model = full_model();
    change(model);
    try {
      check_model(model);
    } catch (const Error &) {
      return true;
    }
    return false;
  };
  using M = ReducedModel;
  EXPECT_FALSE(refused([](M &) {}));
  // A hybrid cone continues its hats with negative values, and need not have modes.
  EXPECT_FALSE(refused([](M &m) { m.contact.dual_basis(0, 0) = -1; }));
  EXPECT_FALSE(refused([](M &m) {
    m.contact.dual_basis(0, 0) = -1;
    m.contact.free_modes = 0;
  }));
  EXPECT_TRUE(refused([](M &m) { m.body.modes = 4; }));
  EXPECT_TRUE(refused([](M &m) { m.body.a.reduced(0, 0) = std::nan(""); }));
  EXPECT_TRUE(refused([](M &m) { m.contact.dual_basis(0, 0) = std::nan(""); }));
  EXPECT_TRUE(refused([](M &m) { m.contact.free_modes = -1; }));
  EXPECT_TRUE(refused([](M &m) { m.contact.free_modes = 5; }));
  EXPECT_TRUE(refused([](M &m) { m.fields.cells[0] = 5; }));
  EXPECT_TRUE(refused([](M &m) { m.contact.interfaces.clear(); }));
  EXPECT_TRUE(refused([](M &m) { m.contact.interfaces[0].nodes[0] = -1; }));
  EXPECT_TRUE(refused([](M &m) { m.contact.interfaces[0].mesh.entities[0] = 3; }));
  EXPECT_TRUE(refused([](M &m) { m.contact.interfaces[0].mesh.entities.push_back(0); }));
  EXPECT_TRUE(refused([](M &m) { m.contact.b.samples[0].contributions[0].cell = 99; }));
  EXPECT_TRUE(refused([](M &m) { m.contact.b.samples[0].contributions.back().entry = 2; }));
  EXPECT_TRUE(refused([](M &m) { m.contact.b.samples[0].corners = 6; }));
  EXPECT_TRUE(refused([](M &m) { m.contact.b.samples.clear(); }));
  EXPECT_TRUE(refused([](M &m) { m.contact.g.samples.push_back(m.contact.g.samples[0]); }));
  EXPECT_TRUE(refused([](M &m) { m.contact.interfaces.push_back(m.contact.interfaces[0]); }))
      << "b has samples";
  EXPECT_TRUE(refused([](M &m) { m.body.a = {}; }));
  EXPECT_TRUE(refused([](M &m) { m.contact.trace_dofs = {0, 1, 3}; })) << "there are three";
  EXPECT_TRUE(refused([](M &m) { m.contact.trace_dofs = {1, 0, 2}; })) << "does not rise";
  EXPECT_TRUE(refused([](M &m) { m.body.a_change.range = Matrix::Ones(m.primal_size(), 1); }));
}

/// The leading part of A, B, F, G as dense matrices is the top left corner of the whole.
TEST(Leading, IsTheTopLeftCorner) {
  const ReducedModel model = full_model();
  const ReducedModel part = leading(model, 4, 3);
  check_model(part);
  EXPECT_EQ(part.body.modes, 3);
  EXPECT_EQ(part.body.supremizers, 1);
  for (int q = 0; q < model.body.a.size(); ++q)
    for (Index j = 0, at = 0; j < 4; ++j)
      for (Index i = j; i < 4; ++i, ++at)
        EXPECT_EQ(part.body.a.reduced(at, q),
                  model.body.a.reduced(5 * j - j * (j - 1) / 2 + i - j, q));
  for (Index i = 0; i < 3; ++i)
    for (Index j = 0; j < 4; ++j)
      EXPECT_EQ(part.contact.b.reduced(j * 3 + i, 1), model.contact.b.reduced(j * 4 + i, 1));
  EXPECT_EQ(part.body.f.reduced, model.body.f.reduced.topRows(4));
  EXPECT_EQ(part.contact.g.reduced, model.contact.g.reduced.topRows(3));
  EXPECT_EQ(part.made.validation_enriched.count, 0);
  EXPECT_EQ(leading(model, 5, 4).made.validation_enriched.count, 64);
  EXPECT_THROW(leading(model, 6, 4), Error);
  EXPECT_THROW(leading(model, 0, 4), Error);
  EXPECT_THROW(leading(model, 5, 5), Error);
}

TEST(Leading, CutsTheModesFirst) {
  ReducedModel model = full_model();
  model.contact.free_modes = 2;
  EXPECT_EQ(leading(model, 5, 4).contact.free_modes, 2);
  EXPECT_EQ(leading(model, 5, 3).contact.free_modes, 1);
  EXPECT_EQ(leading(model, 5, 2).contact.free_modes, 0);
  EXPECT_EQ(leading(model, 5, 1).contact.free_modes, 0);
}

TEST(Leading, WithoutSupremizersNothingIsMadeOnline) {
  ReducedModel model = full_model();
  model.body.online_enriched = true;
  EXPECT_TRUE(leading(model, 5, 4).body.online_enriched);
  EXPECT_TRUE(leading(model, 4, 4).body.online_enriched);
  EXPECT_FALSE(leading(model, 3, 4).body.online_enriched);
  EXPECT_FALSE(leading(model, 2, 4).body.online_enriched);
  ReducedModel plain = model;
  plain.body.online_enriched = false;
  const ReducedModel cut = leading(model, 3, 4), same = leading(plain, 3, 4);
  const Mu mu{0.2, 0.01};
  EXPECT_EQ(OnlineSolver(cut).solve(mu).u, OnlineSolver(same).solve(mu).u);
}

TEST(Leading, DecorrelatedKeepsItsOwnErrors) {
  ReducedModel model = full_model();
  model.made.validation_decorrelated = {64, 0.1, 0.2, 0.3, 0.4};
  EXPECT_EQ(expected_errors(model).u_max, 2e-4);
  EXPECT_EQ(expected_errors(leading(model, 3, 4)).u_max, 0.2);
  EXPECT_EQ(expected_errors(leading(model, 3, 3)).count, 0);
  EXPECT_EQ(expected_errors(leading(model, 2, 4)).count, 0);
}

TEST(PrintModel, ShowsParametersSizesAndErrors) {
  std::ostringstream out;
  print_model(out, full_model());
  for (const char *part : {"membrane_obstacle", "radius", "[0.16, 0.24] m", "0.01 (fixed) m",
                           "supremizers", "-pod_tolerance", "0.0004 largest"})
    EXPECT_NE(out.str().find(part), std::string::npos) << part << " in\n" << out.str();
}

TEST(PrintModel, ShowsModesAndOnlineEnrichmentWhereTheyAre) {
  const auto printed = [](const ReducedModel &model) {
    std::ostringstream out;
    print_model(out, model);
    return out.str();
  };
  ReducedModel model = full_model(); // 3 generators and a mode
  EXPECT_NE(printed(model).find("functions of either sign"), std::string::npos) << printed(model);
  EXPECT_EQ(printed(model).find("made online"), std::string::npos);
  model.contact.free_modes = 0;
  model.body.online_enriched = true;
  EXPECT_EQ(printed(model).find("functions of either sign"), std::string::npos);
  EXPECT_NE(printed(model).find("made online"), std::string::npos);
}

} // namespace
} // namespace rbvi::model_parts_test
