// Solutions of reduced models as VTU files: a membrane, two bodies.
#include "../contact/curves.hpp"
#include "files.hpp"
#include "full_model.hpp"
#include "synthetic_pair.hpp"

#include "rbvi/core/error.hpp"
#include "rbvi/model/online.hpp"
#include "rbvi/model/solution_vtu.hpp"

namespace rbvi::solution_vtu_test {
namespace {

using synthetic::p0;
using synthetic::p1;

struct ModelVtu : InOwnDirectory {};

TEST_F(ModelVtu, VtuHoldsTheMappedFieldAndContact) {
  const ReducedModel model = full_model();
  OnlineSolver solver(model);
  const Mu mu{0.18, 0.02};
  const ReducedAnswer solution = solver.solve(mu);
  const auto write = [&](const std::filesystem::path &file) {
    return write_vtu(file, solver.scene(), expand(model.scene.parameters, mu), model,
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
    const Point x = solver.scene().map({0.18, 0.01, 0.02}, point_of(model.fields.points, i));
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
  EXPECT_THROW(write(directory / "model.h5" / "no" / "u.vtu"), Error);
}

/// A high-fidelity solution is written with a model that has nothing else.
TEST_F(ModelVtu, VtuReadsFieldsAndInterfacesAlone) {
  const ReducedModel model = full_model();
  ReducedModel bare;
  bare.fields.points = model.fields.points;
  bare.fields.cells = model.fields.cells;
  bare.contact.interfaces = model.contact.interfaces;
  const Scene scene = model.scene;
  const Vector u = Vector::LinSpaced(5, 0, 1), lambda = Vector::LinSpaced(3, 1, 2);
  const auto written = [&](const ReducedModel &of) {
    write_vtu(directory / "u.vtu", scene, {0.2, 0, 0}, of, u, lambda);
    return slurp(directory / "u.vtu") + slurp(directory / "u_contact.vtu");
  };
  EXPECT_EQ(written(bare), written(model));
}

/// Text of an element: its fields.
std::string section(const std::string &vtu, const std::string &name) {
  const std::size_t begin = vtu.find("<" + name + ">"), end = vtu.find("</" + name + ">");
  return vtu.substr(begin, end - begin);
}

struct Written {
  std::string bodies, contact;
  Vector w, lambda, gap;
  std::vector<Index> paired;
};

struct PairVtu : InOwnDirectory {
  Written write(const ReducedModel &model, const Scene &scene, const Mu &mu) const {
    OnlineSolver solver(model, scene);
    const ReducedAnswer solution = solver.solve(mu);
    Written result{"",
                   "",
                   solver.field(solution),
                   solver.multiplier(solution),
                   solver.contact_gap(solution),
                   synthetic::mapped_pair(model, scene, solution.mu).paired};
    write_vtu(directory / "u.vtu", scene, solution.mu, model, result.w, result.lambda);
    result.bodies = slurp(directory / "u.vtu");
    result.contact = slurp(directory / "u_contact.vtu");
    return result;
  }
};

TEST_F(PairVtu, ShowsBothBodiesWithTheirMotion) {
  const ReducedModel model = synthetic::random_pair_model({}, 11, p0());
  const Mu mu{0.8};
  const Written file = write(model, p0(), mu);
  const Index nodes = model.fields.points.rows();
  const std::vector<double> points = data_array(file.bodies, "points"),
                            u = data_array(file.bodies, "u");
  ASSERT_EQ(points.size(), static_cast<std::size_t>(3 * nodes));
  ASSERT_EQ(u.size(), points.size());
  for (Index i = 0; i < nodes; ++i) {
    const Point x = point_of(model.fields.points, i),
                image = p0().map(expand(p0().parameters, mu), x);
    const auto k = static_cast<std::size_t>(3 * i);
    EXPECT_EQ(points[k], image[0]);
    EXPECT_EQ(points[k + 1], image[1]);
    EXPECT_EQ(u[k], file.w[2 * i]);
    EXPECT_EQ(u[k + 1], (x[1] > 0 ? -0.09 : 0.09) + file.w[2 * i + 1]);
    EXPECT_EQ(u[k + 2], 0);
  }
  EXPECT_EQ(data_array(file.bodies, "connectivity").size(), model.fields.cells.size());
}

/// What lies on the contact curve at mu = 0.8, where the slave arc reaches beyond the master arc:
/// vertices that have a partner, and the point of the last edge up to which it has one.
void expect_curve(const Written &file, const ReducedModel &model, const Scene &scene) {
  const std::size_t count = file.paired.size();
  ASSERT_GT(count, 4U);
  ASSERT_LT(count, 12U) << "every node has a partner";
  const std::vector<double> points = data_array(file.contact, "points"),
                            u = data_array(file.contact, "u"),
                            gap = data_array(file.contact, "gap");
  ASSERT_EQ(points.size(), 3 * (count + 1));
  ASSERT_EQ(u.size(), points.size());
  EXPECT_EQ(data_array(file.contact, "connectivity").size(), 2 * count);
  EXPECT_EQ(data_array(file.contact, "types"), std::vector<double>(count, 3));
  const auto &[curves, nodes] = model.contact.interfaces.front();
  for (std::size_t k = 0; k < count; ++k) {
    const auto node = static_cast<std::size_t>(file.paired[k]);
    const Point image = scene.map(expand(scene.parameters, {0.8}), curves.points[node]);
    EXPECT_EQ(points[3 * k], image[0]);
    EXPECT_EQ(points[3 * k + 1], image[1]);
    const Index dof = 2 * nodes[node];
    EXPECT_EQ(u[3 * k], file.w[dof]);
    EXPECT_EQ(u[3 * k + 1], -0.09 + file.w[dof + 1]);
    EXPECT_NEAR(gap[k], file.gap[static_cast<Index>(k)], 1e-14);
  }
}

/// In the file of the bodies: the upper one, whose curve is the slave, is the first.
TEST_F(PairVtu, NumbersTheBodiesAndHasTheirStresses) {
  const ReducedModel model = synthetic::random_pair_model({}, 11, p0());
  const std::string cells = section(write(model, p0(), {0.8}).bodies, "CellData");
  const std::vector<double> body = data_array(cells, "body");
  ASSERT_EQ(3 * body.size(), model.fields.cells.size());
  for (std::size_t k = 0; k < body.size(); ++k) {
    const bool upper = model.fields.points(model.fields.cells[3 * k], 1) > 0;
    EXPECT_EQ(body[k], upper ? 1 : 2);
  }
  for (const char *name : {"von_mises", "sigma_xx", "sigma_yy", "sigma_zz", "sigma_xy"})
    EXPECT_EQ(data_array(cells, name).size(), body.size()) << name;
}

TEST_F(PairVtu, ConstantPressureIsDrawnPerEdge) {
  const ReducedModel model = synthetic::random_pair_model({}, 12, p0());
  const Written file = write(model, p0(), {0.8});
  expect_curve(file, model, p0());
  const std::vector<double> pressure = data_array(section(file.contact, "CellData"), "pressure");
  ASSERT_EQ(pressure.size(), file.paired.size());
  for (std::size_t k = 0; k < pressure.size(); ++k)
    EXPECT_EQ(pressure[k], file.lambda[std::min<Index>(file.paired[k] / 2, 4)]);

  const std::vector<double> nodal = data_array(section(file.contact, "PointData"), "pressure"),
                            points = data_array(file.contact, "points");
  ASSERT_EQ(nodal.size(), file.paired.size() + 1);
  EXPECT_DOUBLE_EQ(nodal.front(), pressure.front());
  EXPECT_DOUBLE_EQ(nodal.back(), pressure.back());
  const auto length = [&](std::size_t k) {
    return std::hypot(points[3 * k + 3] - points[3 * k], points[3 * k + 4] - points[3 * k + 1]);
  };
  for (std::size_t k = 1; k < pressure.size(); ++k)
    EXPECT_NEAR(nodal[k],
                (length(k - 1) * pressure[k - 1] + length(k) * pressure[k]) /
                    (length(k - 1) + length(k)),
                1e-13);
}

TEST_F(PairVtu, LinearPressureIsDrawnPerNode) {
  const ReducedModel model = synthetic::random_pair_model({}, 12, p1());
  const Written file = write(model, p1(), {0.8});
  expect_curve(file, model, p1());
  const std::vector<double> pressure = data_array(section(file.contact, "PointData"), "pressure");
  ASSERT_EQ(pressure.size(), file.paired.size() + 1);
  for (std::size_t k = 0; k < file.paired.size(); ++k)
    EXPECT_EQ(pressure[k], file.lambda[file.paired[k]]);
  EXPECT_EQ(section(file.contact, "CellData").find("pressure"), std::string::npos);
}

/// Where the slave curve is covered to its end, the last macro-edge has three edges.
TEST_F(PairVtu, TheLastMacroEdgeMayHaveThreeEdges) {
  const ReducedModel model = synthetic::random_pair_model({}, 12, p0());
  const Written file = write(model, p0(), {1.3});
  const std::vector<double> pressure = data_array(section(file.contact, "CellData"), "pressure");
  ASSERT_EQ(pressure.size(), 11U);
  for (std::size_t k = 8; k < 11; ++k)
    EXPECT_EQ(pressure[k], file.lambda[4]);
  EXPECT_EQ(pressure[7], file.lambda[3]);
}

TEST_F(ModelVtu, ContactFilesHaveTheNamesOfSeveralContacts) {
  Scene scene = make_scene("roller");
  using Paths = std::vector<std::filesystem::path>;
  EXPECT_EQ(contact_files("run/u.vtu", scene),
            (Paths{"run/u_contact_upper_plate.vtu", "run/u_contact_lower_plate.vtu"}));
  scene.contacts[0].name = "a/b";
  scene.contacts[1].name = "a b";
  EXPECT_EQ(contact_files("u.vtu", scene), (Paths{"u_contact_a_b.vtu", "u_contact_a_b_.vtu"}));
  for (ContactRecipe &contact : scene.contacts)
    contact.name.clear();
  EXPECT_EQ(contact_files("u.vtu", scene), (Paths{"u_contact_1.vtu", "u_contact_2.vtu"}));
  scene.contacts.pop_back();
  EXPECT_EQ(contact_files("u.vtu", scene), Paths{"u_contact.vtu"});
}

TEST_F(PairVtu, WithoutFieldsNothingIsWritten) {
  ReducedModel model = synthetic::random_pair_model({}, 13, p0());
  OnlineSolver solver(model, p0());
  const ReducedAnswer solution = solver.solve({1});
  const Vector w = solver.field(solution), lambda = solver.multiplier(solution);
  model.fields.points.resize(0, 0);
  model.fields.cells.clear();
  EXPECT_THROW(write_vtu(directory / "u.vtu", p0(), {1}, model, w, lambda), Error);
  EXPECT_FALSE(std::filesystem::exists(directory / "u.vtu"));
  EXPECT_FALSE(std::filesystem::exists(directory / "u_contact.vtu"));
}

} // namespace
} // namespace rbvi::solution_vtu_test
