#include "synthetic.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/io/h5.hpp"
#include "rbvi/rom/online.hpp"
#include "rbvi/rom/print.hpp"
#include "rbvi/rom/solution_vtu.hpp"

#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <unistd.h>

namespace rbvi {
namespace {

using Path = std::filesystem::path;

struct ModelFile : testing::Test {
  Path directory = Path(testing::TempDir()) / ("rbvi_model_" + std::to_string(::getpid()));
  Path path = directory / "model.h5";
  void SetUp() override { std::filesystem::create_directories(directory); }
  void TearDown() override { std::filesystem::remove_all(directory); }
};

std::string slurp(const Path &path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

void expect_same(const AffineTerms &a, const AffineTerms &b) {
  EXPECT_EQ(a.reduced, b.reduced);
  EXPECT_EQ(a.interpolation, b.interpolation);
  EXPECT_EQ(a.error, b.error);
  ASSERT_EQ(a.samples.size(), b.samples.size());
  for (std::size_t k = 0; k < a.samples.size(); ++k) {
    const SampleMesh &x = a.samples[k], &y = b.samples[k];
    EXPECT_EQ(x.vertices, y.vertices);
    EXPECT_EQ(x.corners, y.corners);
    ASSERT_EQ(x.contributions.size(), y.contributions.size());
    for (std::size_t i = 0; i < x.contributions.size(); ++i) {
      EXPECT_EQ(x.contributions[i].entry, y.contributions[i].entry);
      EXPECT_EQ(x.contributions[i].cell, y.contributions[i].cell);
      EXPECT_EQ(x.contributions[i].local, y.contributions[i].local);
    }
  }
}

ReducedModel full_model() {
  ReducedModel model = synthetic::random_model({3, 2, 4, 3, 2, 1, 2}, 11);
  model.parameters = free_only(model.parameters, "radius,center_y");
  model.parameters.all[1].value = 0.01;
  model.settings = {{"-pod_tolerance", "1e-3"}, {"-cone", "mcpg"}};
  model.mesh_fingerprint = "0123456789abcdef";
  model.free_modes = 1;
  model.a.error = 1e-3;
  model.histories = {{"pod/error", {1, 0.1}}, {"cone/e_orth", {}}};
  model.stage_seconds = {{"snapshots", 12.5}};
  model.validation_enriched = {64, 1e-4, 2e-4, 3e-4, 4e-4};
  model.validation_enriched.outputs = {{"energy", 1, 2, 3, 4, 5, 6},
                                       {"kkt_residual", 0, 1e-15, 0, 0, 0, 0}};
  model.self_check = {200, 3, {0.2, 0.01}, "contact opens", {1e-12, {0.17, 0}}, {1e-3, {0.2, 0}}};
  return model;
}

/// Ranges of validity are the scene's: no file changes them, and none may leave them.
TEST_F(ModelFile, ABoxOutsideTheRangesOfItsSceneIsRefused) {
  const auto refusal = [&](double lower, double upper) -> std::string {
    ReducedModel model = full_model();
    model.parameters.all[0].lower = lower;
    model.parameters.all[0].upper = upper;
    model.parameters.all[0].valid = {};
    write_model(model, path);
    try {
      EXPECT_EQ(scene_of(read_model(path)).parameters.all[0].valid.upper, 0.38);
    } catch (const Error &error) {
      EXPECT_EQ(error.status(), Status::bad_input);
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal(0.16, 0.24), "");
  for (const auto &[lower, upper] : {std::pair(-1.0, 0.2), {0.16, 1e300}, {0.24, 0.16}})
    EXPECT_NE(refusal(lower, upper).find("range of validity is [0.02, 0.38]"), std::string::npos);
}

TEST_F(ModelFile, ReturnsTheModel) {
  const ReducedModel model = full_model();
  write_model(model, path);
  const ReducedModel copy = read_model(path);
  EXPECT_EQ(copy.scene_name, model.scene_name);
  EXPECT_EQ(copy.scene_options, model.scene_options);
  EXPECT_EQ(copy.parameters.free, model.parameters.free);
  EXPECT_EQ(copy.parameters.all[1].value, 0.01);
  EXPECT_EQ(copy.parameters.all[2].unit, "m");
  EXPECT_EQ(copy.settings, model.settings);
  EXPECT_EQ(copy.mesh_fingerprint, model.mesh_fingerprint);
  EXPECT_EQ(copy.primal_size(), 5);
  EXPECT_EQ(copy.modes, 3);
  EXPECT_EQ(copy.generators, 4);
  EXPECT_EQ(copy.free_modes, 1);
  EXPECT_FALSE(copy.online_enriched);
  expect_same(copy.a, model.a);
  expect_same(copy.b, model.b);
  expect_same(copy.f, model.f);
  expect_same(copy.g, model.g);
  EXPECT_EQ(copy.dual_basis, model.dual_basis);
  EXPECT_EQ(copy.contact_trace, model.contact_trace);
  EXPECT_TRUE(synthetic::same(copy.interfaces, model.interfaces));
  EXPECT_EQ(copy.primal_basis, model.primal_basis);
  EXPECT_EQ(copy.mesh_points, model.mesh_points);
  EXPECT_EQ(copy.mesh_cells, model.mesh_cells);
  EXPECT_EQ(copy.histories, model.histories);
  EXPECT_EQ(copy.stage_seconds, model.stage_seconds);
  EXPECT_EQ(copy.validation_enriched.lambda_max, 4e-4);
  EXPECT_EQ(copy.validation_decorrelated.count, 0);
  ASSERT_EQ(copy.validation_enriched.outputs.size(), 2U);
  EXPECT_EQ(copy.validation_enriched.outputs[0].name, "energy");
  EXPECT_EQ(copy.validation_enriched.outputs[0].max_of_value, 6);
  EXPECT_EQ(errors_of_outputs(copy), (ErrorOfOutput{{"energy", 2}}));
  EXPECT_EQ(copy.self_check.queries, 200);
  EXPECT_EQ(copy.self_check.unanswered, 3);
  EXPECT_EQ(copy.self_check.unanswered_at, (Mu{0.2, 0.01}));
  EXPECT_EQ(copy.self_check.reason, "contact opens");
  EXPECT_EQ(copy.self_check.residual.at, (Mu{0.17, 0}));
  EXPECT_EQ(copy.self_check.penetration.value, 1e-3);
  EXPECT_TRUE(copy.self_check.friction.at.empty());
}

TEST_F(ModelFile, ReturnsWhatLargeModelsHave) {
  ReducedModel model = full_model();
  const Index n = model.primal_size(), terms = model.a.size();
  model.a.reduced = model.a.reduced.leftCols(1).eval();
  model.a_change = {Vector::Ones(terms), Matrix::Ones(n, 2), Matrix::Ones(3, terms)};
  model.trace_dofs = {0, 2};
  model.contact_trace = model.contact_trace({0, 2}, Eigen::all).eval();
  write_model(model, path);
  const ReducedModel copy = read_model(path);
  EXPECT_EQ(copy.a.reduced, model.a.reduced);
  EXPECT_EQ(copy.a_change.scales, model.a_change.scales);
  EXPECT_EQ(copy.a_change.range, model.a_change.range);
  EXPECT_EQ(copy.a_change.cores, model.a_change.cores);
  EXPECT_EQ(copy.trace_dofs, model.trace_dofs);
  EXPECT_EQ(copy.contact_trace, model.contact_trace);
  EXPECT_EQ(copy.contact_dofs(), model.contact_dofs());
}

TEST_F(ModelFile, WithoutFieldsAnswersTheSame) {
  write_model(full_model(), path);
  const ReducedModel with = read_model(path), without = read_model(path, false);
  EXPECT_EQ(without.primal_basis.size(), 0);
  OnlineSolver a(with), b(without);
  const Mu mu{0.2, 0.01};
  const ReducedSolution solution = a.solve(mu);
  EXPECT_EQ(solution.u, b.solve(mu).u);
  EXPECT_EQ(*a.outputs(mu, solution).max_penetration, *b.outputs(mu, solution).max_penetration);
  EXPECT_THROW(b.field(solution), Error);
}

TEST_F(ModelFile, FieldsHaveAFileOfTheirOwn) {
  const Path fields = fields_file(path);
  EXPECT_EQ(fields, directory / "model.fields.h5");
  const ReducedModel model = full_model();
  write_model(model, path);
  const auto written = std::filesystem::last_write_time(fields);
  ReducedModel again = read_model(path);
  again.settings["verified"] = "yes";
  write_model(again, path);
  EXPECT_EQ(std::filesystem::last_write_time(fields), written) << "the same fields stay";
  EXPECT_EQ(read_model(path).settings, again.settings);

  const auto refusal = [&]() -> std::string {
    EXPECT_NO_THROW(read_model(path, false));
    try {
      (void)read_model(path);
    } catch (const Error &error) {
      EXPECT_EQ(error.status(), Status::bad_input);
      return error.what();
    }
    return "";
  };
  std::filesystem::rename(fields, directory / "away");
  EXPECT_NE(refusal().find("model.fields.h5 is missing"), std::string::npos);
  ReducedModel other = model;
  other.primal_basis(0, 0) += 1e-9;
  write_model(other, directory / "other.h5");
  std::filesystem::rename(fields_file(directory / "other.h5"), fields);
  EXPECT_NE(refusal().find("has the fields of another model"), std::string::npos);
  std::filesystem::rename(directory / "away", fields);
  EXPECT_EQ(refusal(), "");
  std::string bad = slurp(fields);
  bad[bad.size() / 2] = static_cast<char>(bad[bad.size() / 2] ^ 1);
  std::ofstream(fields, std::ios::binary) << bad;
  EXPECT_NE(refusal().find("damaged"), std::string::npos);
}

TEST_F(ModelFile, NoLoadAndNoGapAreModels) {
  ReducedModel model = synthetic::random_model({3, 2, 4, 2, 1, 1, 1}, 12);
  model.f = model.g = {};
  write_model(model, path);
  const ReducedModel copy = read_model(path);
  OnlineSolver solver(copy);
  EXPECT_EQ(solver.solve({0.2, 0, 0}).u.norm(), 0);
  EXPECT_EQ(leading(copy, 2, 3).f.size(), 0);
}

TEST_F(ModelFile, OnlineEnrichedModelsAnswerTheSame) {
  ReducedModel model = full_model();
  model.online_enriched = true;
  model.supremizers = 2;
  write_model(model, path);
  const ReducedModel copy = read_model(path);
  EXPECT_TRUE(copy.online_enriched);
  const Mu mu{0.2, 0.01};
  EXPECT_EQ(OnlineSolver(copy).solve(mu).u, OnlineSolver(model).solve(mu).u);
}

/// What the program before wrote: nothing of it is read, and the message says which is which.
TEST_F(ModelFile, AnOlderSchemaIsRefused) {
  H5Writer older;
  older.write("scene/name", std::string("membrane_obstacle"));
  older.commit(path, "model", 1);
  try {
    (void)read_model(path);
    FAIL() << "accepted";
  } catch (const Error &error) {
    const std::string message = error.what();
    EXPECT_EQ(error.status(), Status::bad_input);
    EXPECT_EQ(message.find('\n'), std::string::npos);
    const std::string now = "version " + std::to_string(model_schema);
    for (const std::string &part : {std::string("model.h5"), std::string("schema version 1"), now,
                                    std::string("make it again")})
      EXPECT_NE(message.find(part), std::string::npos) << message;
  }
}

TEST_F(ModelFile, DamageIsNoticed) {
  write_model(full_model(), path);
  const std::string good = slurp(path);
  for (std::size_t i = 0; i < good.size(); i += 211) {
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ (1 << (i % 8)));
    std::ofstream(path, std::ios::binary) << bad;
    EXPECT_THROW(read_model(path), Error) << "byte " << i;
    std::ofstream(path, std::ios::binary) << good.substr(0, i);
    EXPECT_THROW(read_model(path), Error) << "length " << i;
  }
}

TEST_F(ModelFile, WhatThisBuildLacksIsBadInput) {
  const auto refused = [&](const ReducedModel &model) {
    write_model(model, path);
    try {
      (void)read_model(path);
    } catch (const Error &error) {
      return error.status() == Status::bad_input;
    }
    return false;
  };
  ReducedModel model = full_model();
  model.scene_name = "bridge";
  EXPECT_TRUE(refused(model));
  model = full_model();
  model.scene_options["colour"] = "red";
  EXPECT_TRUE(refused(model));
  model = full_model();
  model.parameters.all[0].name = "diameter";
  EXPECT_TRUE(refused(model));
}

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
  EXPECT_FALSE(refused([](M &m) { m.dual_basis(0, 0) = -1; }));
  EXPECT_FALSE(refused([](M &m) {
    m.dual_basis(0, 0) = -1;
    m.free_modes = 0;
  }));
  EXPECT_TRUE(refused([](M &m) { m.modes = 4; }));
  EXPECT_TRUE(refused([](M &m) { m.a.reduced(0, 0) = std::nan(""); }));
  EXPECT_TRUE(refused([](M &m) { m.dual_basis(0, 0) = std::nan(""); }));
  EXPECT_TRUE(refused([](M &m) { m.free_modes = -1; }));
  EXPECT_TRUE(refused([](M &m) { m.free_modes = 5; }));
  EXPECT_TRUE(refused([](M &m) { m.mesh_cells[0] = 5; }));
  EXPECT_TRUE(refused([](M &m) { m.interfaces.clear(); }));
  EXPECT_TRUE(refused([](M &m) { m.interfaces[0].nodes[0] = -1; }));
  EXPECT_TRUE(refused([](M &m) { m.interfaces[0].mesh.entities[0] = 3; }));
  EXPECT_TRUE(refused([](M &m) { m.interfaces[0].mesh.entities.push_back(0); }));
  EXPECT_TRUE(refused([](M &m) { m.b.samples[0].contributions[0].cell = 99; }));
  EXPECT_TRUE(refused([](M &m) { m.b.samples[0].contributions.back().entry = 2; }));
  EXPECT_TRUE(refused([](M &m) { m.b.samples[0].corners = 6; }));
  EXPECT_TRUE(refused([](M &m) { m.b.samples.clear(); }));
  EXPECT_TRUE(refused([](M &m) { m.g.samples.push_back(m.g.samples[0]); }));
  EXPECT_TRUE(refused([](M &m) { m.interfaces.push_back(m.interfaces[0]); })) << "b has samples";
  EXPECT_TRUE(refused([](M &m) { m.a = {}; }));
  EXPECT_TRUE(refused([](M &m) { m.trace_dofs = {0, 1, 3}; })) << "there are three";
  EXPECT_TRUE(refused([](M &m) { m.trace_dofs = {1, 0, 2}; })) << "does not rise";
  EXPECT_TRUE(refused([](M &m) { m.a_change.range = Matrix::Ones(m.primal_size(), 1); }));
}

/// The leading part of A, B, F, G as dense matrices is the top left corner of the whole.
TEST(Leading, IsTheTopLeftCorner) {
  const ReducedModel model = full_model();
  const ReducedModel part = leading(model, 4, 3);
  check_model(part);
  EXPECT_EQ(part.modes, 3);
  EXPECT_EQ(part.supremizers, 1);
  for (int q = 0; q < model.a.size(); ++q)
    for (Index j = 0, at = 0; j < 4; ++j)
      for (Index i = j; i < 4; ++i, ++at)
        EXPECT_EQ(part.a.reduced(at, q), model.a.reduced(5 * j - j * (j - 1) / 2 + i - j, q));
  for (Index i = 0; i < 3; ++i)
    for (Index j = 0; j < 4; ++j)
      EXPECT_EQ(part.b.reduced(j * 3 + i, 1), model.b.reduced(j * 4 + i, 1));
  EXPECT_EQ(part.f.reduced, model.f.reduced.topRows(4));
  EXPECT_EQ(part.g.reduced, model.g.reduced.topRows(3));
  EXPECT_EQ(part.validation_enriched.count, 0);
  EXPECT_EQ(leading(model, 5, 4).validation_enriched.count, 64);
  EXPECT_THROW(leading(model, 6, 4), Error);
  EXPECT_THROW(leading(model, 0, 4), Error);
  EXPECT_THROW(leading(model, 5, 5), Error);
}

TEST(Leading, CutsTheModesFirst) {
  ReducedModel model = full_model();
  model.free_modes = 2;
  EXPECT_EQ(leading(model, 5, 4).free_modes, 2);
  EXPECT_EQ(leading(model, 5, 3).free_modes, 1);
  EXPECT_EQ(leading(model, 5, 2).free_modes, 0);
  EXPECT_EQ(leading(model, 5, 1).free_modes, 0);
}

TEST(Leading, WithoutSupremizersNothingIsMadeOnline) {
  ReducedModel model = full_model();
  model.online_enriched = true;
  EXPECT_TRUE(leading(model, 5, 4).online_enriched);
  EXPECT_TRUE(leading(model, 4, 4).online_enriched);
  EXPECT_FALSE(leading(model, 3, 4).online_enriched);
  EXPECT_FALSE(leading(model, 2, 4).online_enriched);
  ReducedModel plain = model;
  plain.online_enriched = false;
  const ReducedModel cut = leading(model, 3, 4), same = leading(plain, 3, 4);
  const Mu mu{0.2, 0.01};
  EXPECT_EQ(OnlineSolver(cut).solve(mu).u, OnlineSolver(same).solve(mu).u);
}

TEST(Leading, DecorrelatedKeepsItsOwnErrors) {
  ReducedModel model = full_model();
  model.validation_decorrelated = {64, 0.1, 0.2, 0.3, 0.4};
  EXPECT_EQ(expected_errors(model).u_max, 2e-4);
  EXPECT_EQ(expected_errors(leading(model, 3, 4)).u_max, 0.2);
  EXPECT_EQ(expected_errors(leading(model, 3, 3)).count, 0);
  EXPECT_EQ(expected_errors(leading(model, 2, 4)).count, 0);
}

TEST(PrintModel, ShowsParametersSizesAndErrors) {
  std::ostringstream out;
  print_model(out, full_model());
  for (const char *part : {"membrane_obstacle", "radius", "[0.16, 0.24] m", "0.01 (fixed) m",
                           "supremizers", "-pod_tolerance", "0.0004 max"})
    EXPECT_NE(out.str().find(part), std::string::npos) << part << " in\n" << out.str();
}

TEST(PrintModel, ShowsModesAndOnlineEnrichmentWhereTheyAre) {
  const auto printed = [](const ReducedModel &model) {
    std::ostringstream out;
    print_model(out, model);
    return out.str();
  };
  ReducedModel model = full_model(); // 3 generators and a mode
  EXPECT_NE(printed(model).find("free modes"), std::string::npos) << printed(model);
  EXPECT_EQ(printed(model).find("made online"), std::string::npos);
  model.free_modes = 0;
  model.online_enriched = true;
  EXPECT_EQ(printed(model).find("free modes"), std::string::npos);
  EXPECT_NE(printed(model).find("made online"), std::string::npos);
}

/// The numbers of one DataArray.
std::vector<double> data_array(const std::string &vtu, const std::string &name) {
  const std::size_t begin = vtu.find('>', vtu.find("Name=\"" + name + "\"")) + 1;
  std::istringstream text(vtu.substr(begin, vtu.find('<', begin) - begin));
  return {std::istream_iterator<double>(text), {}};
}

TEST_F(ModelFile, VtuHoldsTheMappedFieldAndContact) {
  const ReducedModel model = full_model();
  OnlineSolver solver(model);
  const Mu mu{0.18, 0.02};
  const ReducedSolution solution = solver.solve(mu);
  const auto write = [&](const std::filesystem::path &file) {
    return write_vtu(file, solver.scene(), expand(model.parameters, mu), model,
                     solver.field(solution), solver.multiplier(solution));
  };
  const std::vector<std::filesystem::path> files = write(directory / "u.vtu");
  EXPECT_EQ(files, (std::vector{directory / "u.vtu", directory / "u_contact.vtu"}));
  const std::string field = slurp(directory / "u.vtu");
  const std::vector<double> points = data_array(field, "points"), u = data_array(field, "u");
  ASSERT_EQ(points.size(), 15U);
  ASSERT_EQ(u.size(), 5U);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(u[std::size_t(i)], solver.field(solution)[i]);
    const Point x = solver.scene().map({0.18, 0.01, 0.02}, point_of(model.mesh_points, i));
    EXPECT_EQ(points[std::size_t(3 * i)], x[0]);
    EXPECT_EQ(points[std::size_t(3 * i + 1)], x[1]);
  }
  EXPECT_EQ(data_array(field, "connectivity").size(), 12U);
  EXPECT_EQ(data_array(field, "offsets"), (std::vector<double>{3, 6, 9, 12}));
  EXPECT_EQ(data_array(field, "types"), (std::vector<double>{5, 5, 5, 5}));
  EXPECT_EQ(data_array(field, "mu_radius"), std::vector<double>{0.18});
  EXPECT_EQ(data_array(field, "mu_center_x"), std::vector<double>{0.01});
  EXPECT_EQ(data_array(field, "body"), (std::vector<double>(4, 1)));
  EXPECT_EQ(field.find("von_mises"), std::string::npos) << "a membrane has no stresses";
  const std::string contact = slurp(directory / "u_contact.vtu");
  const Vector pressure = solver.multiplier(solution);
  EXPECT_EQ(data_array(contact, "pressure"),
            (std::vector<double>(pressure.data(), pressure.data() + 3)));
  EXPECT_EQ(data_array(contact, "gap").size(), 3U);
  EXPECT_THROW(write(path / "no" / "u.vtu"), Error);
}

/// A high-fidelity solution is written with a model that has nothing else.
TEST_F(ModelFile, VtuReadsFieldsAndInterfacesAlone) {
  const ReducedModel model = full_model();
  ReducedModel bare;
  bare.mesh_points = model.mesh_points;
  bare.mesh_cells = model.mesh_cells;
  bare.interfaces = model.interfaces;
  const Scene scene = scene_of(model);
  const Vector u = Vector::LinSpaced(5, 0, 1), lambda = Vector::LinSpaced(3, 1, 2);
  const auto written = [&](const ReducedModel &of) {
    write_vtu(directory / "u.vtu", scene, {0.2, 0, 0}, of, u, lambda);
    return slurp(directory / "u.vtu") + slurp(directory / "u_contact.vtu");
  };
  EXPECT_EQ(written(bare), written(model));
}

} // namespace
} // namespace rbvi
