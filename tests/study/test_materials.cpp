// Bodies of several materials: against closed forms, and against one material by place.
#include "../mesh/temporary_file.hpp"
#include "reduced.hpp"

#include "rbvi/contact/contact.hpp"
#include "rbvi/element/cell_fields.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/scene/case.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <sstream>

#include <unistd.h>

namespace rbvi::materials_test {
namespace {

using testing_reduced::Reduced;

/// The unit square of 2 n x 2 n squares, each cut in two: region "soft" is its lower (`layers`) or
/// left half, "hard" the other.
std::string square(int n, bool layers) {
  const int m = 2 * n;
  std::ostringstream nodes, elements;
  const auto node = [m](int i, int j) { return 1 + i + (m + 1) * j; };
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= m; ++i)
      nodes << node(i, j) << ' ' << double(i) / m << ' ' << double(j) / m << " 0\n";
  int count = 0;
  const auto edge = [&](int group, int a, int b) {
    elements << ++count << " 1 2 " << group << " 1 " << a << ' ' << b << '\n';
  };
  for (int i = 0; i < m; ++i) {
    edge(1, node(i, 0), node(i + 1, 0));
    edge(2, node(i, m), node(i + 1, m));
    edge(3, node(0, i), node(0, i + 1));
    edge(3, node(m, i), node(m, i + 1));
  }
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < m; ++i) {
      const std::string group = (layers ? j : i) < n ? " 2 2 4 1 " : " 2 2 5 1 ";
      elements << ++count << group << node(i, j) << ' ' << node(i + 1, j) << ' '
               << node(i + 1, j + 1) << '\n';
      elements << ++count << group << node(i, j) << ' ' << node(i + 1, j + 1) << ' '
               << node(i, j + 1) << '\n';
    }
  std::ostringstream out;
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n1 1 \"floor\"\n1 2 \"top\"\n"
         "1 3 \"sides\"\n2 4 \"soft\"\n2 5 \"hard\"\n$EndPhysicalNames\n$Nodes\n"
      << (m + 1) * (m + 1) << '\n'
      << nodes.str() << "$EndNodes\n$Elements\n"
      << count << '\n'
      << elements.str() << "$EndElements\n";
  return out.str();
}

struct Materials : ::testing::Test {
  std::optional<TemporaryFile> file;
  MeshOptions mesh(bool layers) {
    file.reset();
    file.emplace(square(4, layers));
    return {file->name(), 0};
  }
};

Scene scene_of(const std::string &materials, const std::string &sides,
               const std::string &contact = "", int degree = 2) {
  const std::string text =
      "rbvi: 1\nphysics: plane_strain\nmesh: {file: square.msh, degree: " + std::to_string(degree) +
      "}\n"
      "parameters: {k: {range: [2, 40], default: 3}, depth: {range: [0.01, 0.05], default: 0.02}}\n"
      "materials: " +
      materials + "\nimposed: {top: {at: top, ux: 0, uy: -depth}" + sides +
      "}\ncontact: {floor: {at: floor, against: {plane: {normal: [0, -1], position: 0}}" + contact +
      "}}\n";
  return make_scene(read_case(text, "square.yaml"), {});
}

const std::string by_region = "{a: {at: soft, E: 1, nu: 0.2}, b: {at: hard, E: k, nu: 0.4}}";

/// Two layers in series under uniaxial strain: one pressure,
/// depth / (1/2 / M_soft + 1/2 / M_hard).
TEST_F(Materials, LayersActInSeries) {
  Problem problem(PETSC_COMM_WORLD, scene_of(by_region, ", sides: {at: sides, ux: 0}"), mesh(true));
  for (const double k : {2.0, 40.0}) {
    const HfSolution solution = HighFidelity(problem, {}).solve({k, 0.03});
    const auto [soft_lambda, soft_shear] = lame(1, 0.2);
    const auto [hard_lambda, hard_shear] = lame(k, 0.4);
    const double soft = soft_lambda + 2 * soft_shear, hard = hard_lambda + 2 * hard_shear;
    EXPECT_NEAR(solution.outputs.normal_force.value(), 0.03 / (0.5 / soft + 0.5 / hard), 1e-12);
  }
}

/// By region and by place: the same answers, stresses and reduced answers, by multipliers and by
/// Nitsche's method with both materials on the floor.
TEST_F(Materials, ByRegionAreThoseByPlace) {
  for (const std::string contact :
       {", friction: {coulomb: 0.3}", ", formulation: nitsche, nitsche_gamma0: 100"}) {
    const MeshOptions options = mesh(false);
    const std::string by_place =
        "{all: {at: all, E: 'x < 0.5 ? 1 : k', nu: 'x < 0.5 ? 0.2 : 0.4'}}";
    Reduced regions(scene_of(by_region, "", contact), "grid:2,2", PETSC_COMM_WORLD, options);
    Reduced places(scene_of(by_place, "", contact), "grid:2,2", PETSC_COMM_WORLD, options);
    for (std::size_t i = 0; i < regions.samples.size(); ++i) {
      const Outputs &found = regions.samples[i].outputs, &wanted = places.samples[i].outputs;
      EXPECT_NEAR(found.energy.value(), wanted.energy.value(), 1e-12);
      EXPECT_NEAR(found.peak_pressure.value(), wanted.peak_pressure.value(), 1e-9);
    }
    regions.reduce(testing_reduced::everything());
    places.reduce(testing_reduced::everything());
    const Mu mu{7, 0.03};
    OnlineSolver one(regions.model), other(places.model);
    const double energy = one.outputs(mu, one.solve(mu)).energy.value();
    EXPECT_NEAR(energy, other.outputs(mu, other.solve(mu)).energy.value(), 1e-9) << contact;
    const FullMu all = expand(one.scene().parameters, mu);
    const Vector u = Vector::LinSpaced(3 * regions.model.fields.points.rows(), 0, 1);
    const auto stresses = [&](const ReducedModel &model, const Scene &scene) {
      return centre_stresses(scene, all, model.fields.points, model.fields.cells,
                             model.fields.materials, u);
    };
    const Matrix found = stresses(regions.model, one.scene()),
                 wanted = stresses(places.model, other.scene());
    EXPECT_LE((found - wanted).cwiseAbs().maxCoeff(), 1e-12 * wanted.cwiseAbs().maxCoeff());
  }
}

/// Numbers of materials come back from the files of a model, and are asked for.
/// Values between which nothing is smooth: one factorisation each, and the law and u are exact.
TEST_F(Materials, ChoicesAreExact) {
  const auto scene = [](const std::string &young) {
    return make_scene(
        read_case("rbvi: 1\nphysics: plane_strain\nmesh: {file: square.msh, degree: 2}\n"
                  "parameters: {kind: {values: [weak, layered, strong, odd], default: layered}, "
                  "depth: {range: [0.01, 0.05], default: 0.02}}\n"
                  "materials: {all: {at: all, E: '" +
                      young +
                      "', nu: 0.3}}\n"
                      "imposed: {top: {at: top, ux: 0, uy: -depth}}\n"
                      "contact: {floor: {at: floor, against: {plane: {normal: [0, -1], position: "
                      "0}}}}\n",
                  "square.yaml"),
        {});
  };
  for (const char *young :
       {"kind == weak ? 1 : kind == strong ? 30 : kind == odd ? 1 + 5*x : y < 0.5 ? 1 : 30",
        "kind == weak ? 1 : kind == strong ? 30 : kind == odd ? 7 : 3"}) {
    SCOPED_TRACE(young);
    Reduced r(scene(young), "grid:4,4", PETSC_COMM_WORLD, mesh(true));
    r.reduce({});
    EXPECT_LE(r.bases.factorisations, 8);
    const std::vector<Sample> truth =
        testing_reduced::solve_all(r.problem, parse_set(r.problem.scene().parameters, "grid:4,3"));
    const ModelErrors errors = r.errors_at(truth);
    EXPECT_LT(errors.lambda.maxCoeff(), 1e-8);
    EXPECT_LT(errors.u.maxCoeff(), 1e-4);
  }
}

TEST_F(Materials, FilesKeepThem) {
  Reduced regions(scene_of(by_region, ", sides: {at: sides, ux: 0}"), "grid:2,2", PETSC_COMM_WORLD,
                  mesh(true));
  regions.reduce(testing_reduced::everything());
  if (rank_of(PETSC_COMM_WORLD) != 0) return;
  const ReducedModel &model = regions.model;
  EXPECT_EQ(std::ranges::count(model.fields.materials, 0), 64) << "half of the cells are soft";
  EXPECT_EQ(model.contact.interfaces.front().mesh.materials, std::vector<int>(8, 0));
  const auto path = std::filesystem::path(testing::TempDir()) /
                    ("rbvi_materials_" + std::to_string(::getpid()) + ".h5");
  write_model(model, path);
  ReducedModel again = read_model(path, catalogue());
  std::filesystem::remove(path);
  std::filesystem::remove(fields_file(path));
  EXPECT_EQ(again.fields.materials, model.fields.materials);
  EXPECT_EQ(again.contact.interfaces.front().mesh.materials,
            model.contact.interfaces.front().mesh.materials);
  again.fields.materials.back() = 2;
  EXPECT_THROW(OnlineSolver{again}, Error);
}

/// The warning looks at the material beside contact.
TEST_F(Materials, LockingIsOfTheRegionThatTouches) {
  for (const bool below : {true, false}) {
    const std::string materials =
        "{a: {at: soft, E: 1, nu: " + std::string(below ? "0.49" : "0.3") +
        "}, b: {at: hard, E: k, nu: " + (below ? "0.3" : "0.49") + "}}";
    const Scene scene = scene_of(materials, "", "", 1);
    const Problem problem(PETSC_COMM_WORLD, scene, mesh(true));
    EXPECT_EQ(locking_ratio(scene, {3, 0.02}, material_points(problem.contact())) > 0, below);
  }
}

TEST_F(Materials, EachCellHasOne) {
  const MeshOptions options = mesh(true);
  const auto said = [&](const Scene &scene) -> std::string {
    try {
      const Problem problem(PETSC_COMM_WORLD, scene, options);
      return "";
    } catch (const Error &error) {
      return error.what();
    }
  };
  EXPECT_NE(said(scene_of("{a: {at: soft, E: k, nu: 0.2}}", "")).find("without a material"),
            std::string::npos);
  Scene twice = scene_of(by_region, "");
  twice.materials.push_back({{"hard"}, twice.materials[0].of_cell});
  EXPECT_NE(said(twice).find("has two materials"), std::string::npos);
}

} // namespace
} // namespace rbvi::materials_test
