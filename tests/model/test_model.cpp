// Model files: what is written is read, and what does not fit is refused.
#include "files.hpp"
#include "full_model.hpp"

#include "../core/refuses.hpp"
#include "rbvi/core/error.hpp"
#include "rbvi/io/h5.hpp"
#include "rbvi/model/online.hpp"
#include "tests/catalogue.hpp"

namespace rbvi::model_test {
namespace {

using Path = std::filesystem::path;

struct ModelFile : InOwnDirectory {
  Path path = directory / "model.h5";
};

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

/// Ranges of validity are the scene's: no file changes them, and none may leave them.
TEST_F(ModelFile, ABoxOutsideTheRangesOfItsSceneIsRefused) {
  const auto refusal = [&](double lower, double upper) -> std::string {
    ReducedModel model = full_model();
    model.scene.parameters.all[0].lower = lower;
    model.scene.parameters.all[0].upper = upper;
    model.scene.parameters.all[0].valid = {};
    write_model(model, path);
    try {
      EXPECT_EQ(read_model(path, catalogue()).scene.parameters.all[0].valid.upper, 0.38);
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

/// A program's scene is known by its name and its version.
TEST_F(ModelFile, AProgramsSceneIsMadeByItsEntry) {
  const auto program = [](int version) {
    SceneEntry entry{
        "own", "", {}, [](const SceneOptions &) { return make_scene("membrane_obstacle"); }};
    entry.version = version;
    return Registry{entry};
  };
  ReducedModel model = full_model();
  const ParameterSpace parameters = model.scene.parameters;
  model.scene = make_scene(program(3).front());
  model.scene.parameters = parameters;
  write_model(model, path);
  const ReducedModel read = read_model(path, program(3));
  EXPECT_EQ(read.scene.tree, "program: own\nversion: 3\n");
  EXPECT_EQ(OnlineSolver(read).solve({0.2, 0.01}).u, OnlineSolver(model).solve({0.2, 0.01}).u);
  for (const std::string part : {"the program's scene own is another one: version is 4, it was 3",
                                 "use the program that made it, while reading"})
    EXPECT_TRUE(refuses(part, [&] { (void)read_model(path, program(4)); }));
  EXPECT_TRUE(refuses("unknown scene 'own'", [&] { (void)read_model(path, catalogue()); }));
  model.scene.tree.clear();
  write_model(model, path);
  EXPECT_TRUE(refuses("a scene without a name", [&] { (void)read_model(path, catalogue()); }));
}

TEST_F(ModelFile, ReturnsTheModel) {
  const ReducedModel model = full_model();
  write_model(model, path);
  const ReducedModel copy = read_model(path, catalogue());
  EXPECT_EQ(copy.scene.name, model.scene.name);
  EXPECT_EQ(copy.scene.options, model.scene.options);
  EXPECT_EQ(copy.scene.parameters.free, model.scene.parameters.free);
  EXPECT_EQ(copy.scene.parameters.all[1].value, 0.01);
  EXPECT_EQ(copy.scene.parameters.all[2].unit, "m");
  EXPECT_EQ(copy.made.settings, model.made.settings);
  EXPECT_EQ(copy.made.mesh_fingerprint, model.made.mesh_fingerprint);
  EXPECT_EQ(copy.primal_size(), 5);
  EXPECT_EQ(copy.body.modes, 3);
  EXPECT_EQ(copy.contact.generators, 4);
  EXPECT_EQ(copy.contact.free_modes, 1);
  EXPECT_FALSE(copy.body.online_enriched);
  expect_same(copy.body.a, model.body.a);
  expect_same(copy.contact.b, model.contact.b);
  expect_same(copy.body.f, model.body.f);
  expect_same(copy.contact.g, model.contact.g);
  EXPECT_EQ(copy.contact.dual_basis, model.contact.dual_basis);
  EXPECT_EQ(copy.contact.trace, model.contact.trace);
  EXPECT_TRUE(synthetic::same(copy.contact.interfaces, model.contact.interfaces));
  EXPECT_EQ(copy.fields.basis, model.fields.basis);
  EXPECT_EQ(copy.fields.points, model.fields.points);
  EXPECT_EQ(copy.fields.cells, model.fields.cells);
  EXPECT_EQ(copy.made.histories, model.made.histories);
  EXPECT_EQ(copy.made.stage_seconds, model.made.stage_seconds);
  EXPECT_EQ(copy.made.validation_enriched.lambda_max, 4e-4);
  EXPECT_EQ(copy.made.validation_decorrelated.count, 0);
  ASSERT_EQ(copy.made.validation_enriched.outputs.size(), 2U);
  EXPECT_EQ(copy.made.validation_enriched.outputs[0].name, "energy");
  EXPECT_EQ(copy.made.validation_enriched.outputs[0].max_of_value, 6);
  EXPECT_EQ(errors_of_outputs(copy), (ErrorOfOutput{{"energy", 2}}));
  EXPECT_EQ(copy.made.self_check.queries, 200);
  EXPECT_EQ(copy.made.self_check.unanswered, 3);
  EXPECT_EQ(copy.made.self_check.at_boundary, 8);
  EXPECT_EQ(copy.made.self_check.scale, 0.25);
  EXPECT_EQ(copy.made.validation_enriched.unanswered, 2);
  EXPECT_EQ(copy.made.validated_mu, model.made.validated_mu);
  EXPECT_EQ(copy.made.self_check.unanswered_at, (Mu{0.2, 0.01}));
  EXPECT_EQ(copy.made.self_check.reason, "contact opens");
  EXPECT_EQ(copy.made.self_check.residual.at, (Mu{0.17, 0}));
  EXPECT_EQ(copy.made.self_check.penetration.value, 1e-3);
  EXPECT_TRUE(copy.made.self_check.friction.at.empty());
}

TEST_F(ModelFile, ReturnsWhatLargeModelsHave) {
  ReducedModel model = full_model();
  const Index n = model.primal_size(), terms = model.body.a.size();
  model.body.a.reduced = model.body.a.reduced.leftCols(1).eval();
  model.body.a_change = {Vector::Ones(terms), Matrix::Ones(n, 2), Matrix::Ones(3, terms)};
  model.contact.trace_dofs = {0, 2};
  model.contact.trace = model.contact.trace({0, 2}, Eigen::all).eval();
  write_model(model, path);
  const ReducedModel copy = read_model(path, catalogue());
  EXPECT_EQ(copy.body.a.reduced, model.body.a.reduced);
  EXPECT_EQ(copy.body.a_change.scales, model.body.a_change.scales);
  EXPECT_EQ(copy.body.a_change.range, model.body.a_change.range);
  EXPECT_EQ(copy.body.a_change.cores, model.body.a_change.cores);
  EXPECT_EQ(copy.contact.trace_dofs, model.contact.trace_dofs);
  EXPECT_EQ(copy.contact.trace, model.contact.trace);
  EXPECT_EQ(copy.contact_dofs(), model.contact_dofs());
}

TEST_F(ModelFile, WithoutFieldsAnswersTheSame) {
  write_model(full_model(), path);
  const ReducedModel with = read_model(path, catalogue()),
                     without = read_model(path, catalogue(), false);
  EXPECT_EQ(without.fields.basis.size(), 0);
  OnlineSolver a(with), b(without);
  const Mu mu{0.2, 0.01};
  const ReducedAnswer solution = a.solve(mu);
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
  ReducedModel again = read_model(path, catalogue());
  again.made.settings["verified"] = "yes";
  write_model(again, path);
  EXPECT_EQ(std::filesystem::last_write_time(fields), written) << "the same fields stay";
  EXPECT_EQ(read_model(path, catalogue()).made.settings, again.made.settings);

  const auto refusal = [&]() -> std::string {
    EXPECT_NO_THROW(read_model(path, catalogue(), false));
    try {
      (void)read_model(path, catalogue());
    } catch (const Error &error) {
      EXPECT_EQ(error.status(), Status::bad_input);
      return error.what();
    }
    return "";
  };
  std::filesystem::rename(fields, directory / "away");
  EXPECT_NE(refusal().find("model.fields.h5 is missing"), std::string::npos);
  ReducedModel other = model;
  other.fields.basis(0, 0) += 1e-9;
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
  model.body.f = model.contact.g = {};
  write_model(model, path);
  const ReducedModel copy = read_model(path, catalogue());
  OnlineSolver solver(copy);
  EXPECT_EQ(solver.solve({0.2, 0, 0}).u.norm(), 0);
  EXPECT_EQ(leading(copy, 2, 3).body.f.size(), 0);
}

TEST_F(ModelFile, OnlineEnrichedModelsAnswerTheSame) {
  ReducedModel model = full_model();
  model.body.online_enriched = true;
  model.body.supremizers = 2;
  write_model(model, path);
  const ReducedModel copy = read_model(path, catalogue());
  EXPECT_TRUE(copy.body.online_enriched);
  const Mu mu{0.2, 0.01};
  EXPECT_EQ(OnlineSolver(copy).solve(mu).u, OnlineSolver(model).solve(mu).u);
}

/// What the program before wrote: nothing of it is read, and the message says which is which.
TEST_F(ModelFile, AnOlderSchemaIsRefused) {
  H5Writer older;
  older.write("scene/name", std::string("membrane_obstacle"));
  older.commit(path, "model", 1);
  try {
    (void)read_model(path, catalogue());
    FAIL() << "accepted";
  } catch (const Error &error) {
    const std::string message = error.what();
    EXPECT_EQ(error.status(), Status::bad_input);
    EXPECT_EQ(message.find('\n'), std::string::npos);
    const std::string now = "version " + std::to_string(model_schema);
    for (const std::string &part : {std::string("model.h5"), std::string("schema version 1"), now,
                                    std::string("make it again by rbvi offline")})
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
    EXPECT_THROW(read_model(path, catalogue()), Error) << "byte " << i;
    std::ofstream(path, std::ios::binary) << good.substr(0, i);
    EXPECT_THROW(read_model(path, catalogue()), Error) << "length " << i;
  }
}

TEST_F(ModelFile, WhatThisBuildLacksIsBadInput) {
  const auto refused = [&](const ReducedModel &model) {
    write_model(model, path);
    try {
      (void)read_model(path, catalogue());
    } catch (const Error &error) {
      return error.status() == Status::bad_input;
    }
    return false;
  };
  ReducedModel model = full_model();
  EXPECT_FALSE(refused(model));
  model.scene.tree = "program: bridge\nversion: 1\n";
  EXPECT_TRUE(refused(model));
  model.scene.tree = "rbvi: 1\nphysics: magnetism\n";
  EXPECT_TRUE(refused(model));
  model = full_model();
  model.scene.parameters.all[0].name = "diameter";
  EXPECT_TRUE(refused(model));
}

} // namespace
} // namespace rbvi::model_test
