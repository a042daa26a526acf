// What a model file keeps of imposed displacements: on sampled cells, interfaces and the whole
// mesh.
#include "synthetic.hpp"

#include "rbvi/core/error.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

namespace rbvi::imposed_model_test {
namespace {

ReducedModel model_with_imposed() {
  ReducedModel model = synthetic::random_model({3, 2, 4, 3, 2, 2, 2}, 11);
  model.body.imposed_energy = {
      Matrix::Constant(1, 1, 3), Matrix::Identity(1, 1), {model.body.f.samples.front()}};
  model.body.imposed_energy.samples.front().contributions = {{0, 0, 0}};
  const Index cells = model.body.f.samples.front().vertices.rows() / 3;
  for (AffineTerms *terms : {&model.body.f, &model.body.imposed_energy})
    terms->samples.front().imposed_by.assign(3 * cells, 2);
  model.contact.interfaces.front().mesh.imposed_by = {-1, 0, 1};
  model.fields.imposed_by.assign(model.fields.basis.rows(), -1);
  return model;
}

TEST(ImposedInModelFile, ComesBack) {
  const auto path = std::filesystem::path(testing::TempDir()) /
                    ("rbvi_imposed_" + std::to_string(::getpid()) + ".h5");
  const ReducedModel model = model_with_imposed();
  write_model(model, path);
  const ReducedModel copy = read_model(path, catalogue()),
                     answers = read_model(path, catalogue(), false);
  std::filesystem::remove(path);
  EXPECT_EQ(copy.body.imposed_energy.reduced, model.body.imposed_energy.reduced);
  EXPECT_EQ(copy.body.imposed_energy.interpolation, model.body.imposed_energy.interpolation);
  for (const auto member : {&BodyModel::f, &BodyModel::imposed_energy}) {
    EXPECT_EQ((copy.body.*member).samples.front().imposed_by,
              (model.body.*member).samples.front().imposed_by);
    EXPECT_EQ((copy.body.*member).samples.front().vertices,
              (model.body.*member).samples.front().vertices);
  }
  EXPECT_EQ(copy.contact.interfaces.front().mesh.imposed_by, (std::vector{-1, 0, 1}));
  EXPECT_EQ(copy.fields.imposed_by, model.fields.imposed_by);
  EXPECT_TRUE(answers.fields.imposed_by.empty()) << "a field";
}

TEST(ImposedInModelFile, SizesThatDoNotFitAreRefused) {
  ReducedModel model = model_with_imposed();
  EXPECT_NO_THROW(check_model(model));
  model.fields.imposed_by.pop_back();
  EXPECT_THROW(check_model(model), Error);
  model = model_with_imposed();
  model.contact.interfaces.front().mesh.imposed_by.pop_back();
  EXPECT_THROW(check_model(model), Error);
  model = model_with_imposed();
  model.body.f.samples.front().imposed_by.pop_back();
  EXPECT_THROW(check_model(model), Error);
}

} // namespace
} // namespace rbvi::imposed_model_test
