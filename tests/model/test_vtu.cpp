// VTU files by a reader of its own, in both formats; stresses and bodies on cells.
#include "rbvi/core/error.hpp"
#include "rbvi/element/cell_fields.hpp"
#include "rbvi/element/elastic_forms.hpp"
#include "rbvi/io/vtu.hpp"
#include "rbvi/model/solution_vtu.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <random>
#include <sstream>

namespace rbvi::vtu_test {
namespace {

using Path = std::filesystem::path;

std::string attribute(const std::string &tag, const std::string &name) {
  const std::size_t at = tag.find(" " + name + "=\"");
  if (at == std::string::npos) return "";
  const std::size_t begin = at + name.size() + 3;
  return tag.substr(begin, tag.find('"', begin) - begin);
}

/// The tag with that name: "<DataArray ... Name="u" ...>".
std::string tag_of(const std::string &file, const std::string &name) {
  const std::size_t at = file.find("Name=\"" + name + "\"");
  if (at == std::string::npos) return "";
  const std::size_t begin = file.rfind('<', at);
  return file.substr(begin, file.find('>', at) + 1 - begin);
}

template <class Number> std::vector<double> decoded(const std::string &bytes) {
  std::vector<double> values;
  for (std::size_t i = 0; i + sizeof(Number) <= bytes.size(); i += sizeof(Number)) {
    Number value;
    std::memcpy(&value, bytes.data() + i, sizeof value);
    values.push_back(static_cast<double>(value));
  }
  return values;
}

/// RFC 4648, bit by bit; white space is skipped.
std::string from_base64(const std::string &text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned bits = 0;
  int count = 0;
  for (const char letter : text) {
    const std::size_t digit = digits.find(letter);
    if (digit == std::string::npos) continue;
    bits = bits << 6 | static_cast<unsigned>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 255U);
  }
  return bytes;
}

std::vector<double> values_of(const std::string &file, const std::string &name) {
  const std::string tag = tag_of(file, name), type = attribute(tag, "type");
  if (attribute(tag, "format") == "ascii") {
    const std::size_t begin = file.find(tag) + tag.size();
    std::istringstream text(file.substr(begin, file.find('<', begin) - begin));
    return {std::istream_iterator<double>(text), {}};
  }
  const std::size_t begin = file.find(tag) + tag.size();
  const std::string block = from_base64(file.substr(begin, file.find('<', begin) - begin));
  std::uint64_t size = 0;
  std::memcpy(&size, block.data(), sizeof size);
  const std::string bytes = block.substr(sizeof size);
  EXPECT_EQ(bytes.size(), size) << name;
  if (type == "Float64") return decoded<double>(bytes);
  if (type == "Int32") return decoded<std::int32_t>(bytes);
  if (type == "Int64") return decoded<std::int64_t>(bytes);
  EXPECT_EQ(type, "UInt8") << name;
  return decoded<std::uint8_t>(bytes);
}

std::vector<std::string> texts_of(const std::string &file, const std::string &name) {
  std::vector<std::string> texts(1);
  for (const double code : values_of(file, name))
    if (code == 0)
      texts.emplace_back();
    else
      texts.back() += static_cast<char>(code);
  texts.pop_back();
  return texts;
}

/// Triangles of `degree` over a square of n x n, with random fields.
Grid random_grid(int n) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  Grid grid;
  grid.points.resize((n + 1) * (n + 1), 2);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      grid.points.row(j * (n + 1) + i) << i / 3.0, j / 7.0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int k = j * (n + 1) + i;
      grid.cells.insert(grid.cells.end(), {k, k + 1, k + n + 2, k, k + n + 2, k + n + 1});
    }
  const Index nodes = grid.points.rows(), cells = 2 * n * n;
  const auto draw = [&](double) { return normal(random); };
  grid.of_nodes = {{"u", Vector::Zero(3 * nodes).unaryExpr(draw), "m"},
                   {"gap", Vector::Zero(nodes).unaryExpr(draw), "m"}};
  grid.of_cells = {{"von_mises", Vector::Zero(cells).unaryExpr(draw), "Pa"},
                   {"body", Vector::Ones(cells)}};
  grid.of_all = {{"mu_radius", Vector::Constant(1, 0.1 + 0.2), "m"},
                 {"mu_ratio", Vector::Constant(1, 0.35)}};
  grid.scene = "two_disks";
  return grid;
}

struct VtuFile : testing::Test {
  Path directory = Path(testing::TempDir()) / ("rbvi_vtu_" + std::to_string(::getpid()));
  void SetUp() override { std::filesystem::create_directories(directory); }
  void TearDown() override { std::filesystem::remove_all(directory); }
  std::string written(const Grid &grid, VtuFormat format) const {
    write_vtu(directory / "u.vtu", grid, format);
    std::ostringstream bytes;
    bytes << std::ifstream(directory / "u.vtu", std::ios::binary).rdbuf();
    return bytes.str();
  }
};

TEST_F(VtuFile, BothFormatsHoldTheSameNumbersToTheLastBit) {
  const Grid grid = random_grid(4);
  const std::string ascii = written(grid, VtuFormat::ascii),
                    encoded = written(grid, VtuFormat::base64);
  EXPECT_EQ(attribute(encoded.substr(encoded.find("<VTKFile")), "header_type"), "UInt64");
  const std::string order = attribute(encoded.substr(encoded.find("<VTKFile")), "byte_order");
  EXPECT_TRUE(order == "LittleEndian" || order == "BigEndian");
  for (const char *name : {"points", "connectivity", "offsets", "types", "u", "gap", "von_mises",
                           "body", "mu_radius", "mu_ratio"}) {
    const std::vector<double> values = values_of(ascii, name);
    EXPECT_FALSE(values.empty()) << name;
    EXPECT_EQ(values_of(encoded, name), values) << name;
  }
  EXPECT_EQ(values_of(encoded, "u"),
            std::vector<double>(grid.of_nodes[0].values.begin(), grid.of_nodes[0].values.end()));
  EXPECT_EQ(attribute(tag_of(encoded, "u"), "NumberOfComponents"), "3");
  EXPECT_EQ(values_of(encoded, "types"), std::vector<double>(32, 5));
  EXPECT_EQ(values_of(encoded, "offsets")[1], 6);
}

TEST_F(VtuFile, FieldDataSaysSceneParametersAndUnits) {
  for (const VtuFormat format : {VtuFormat::ascii, VtuFormat::base64}) {
    const std::string file = written(random_grid(2), format);
    EXPECT_EQ(texts_of(file, "scene"), std::vector<std::string>{"two_disks"});
    EXPECT_EQ(texts_of(file, "units"),
              (std::vector<std::string>{"points: m", "u: m", "gap: m", "von_mises: Pa", "body: -",
                                        "mu_radius: m", "mu_ratio: -"}));
    EXPECT_EQ(values_of(file, "mu_radius"), std::vector<double>{0.1 + 0.2});
    EXPECT_LT(file.find("<FieldData>"), file.find("<Piece "));
  }
}

/// Groups of a mesh have names of any kind.
TEST_F(VtuFile, NamesOfAnyTextAreXml) {
  Grid grid = random_grid(2);
  grid.of_cells[0].name = "a<b & \"c\"";
  const std::string file = written(grid, VtuFormat::ascii);
  EXPECT_EQ(values_of(file, "a&lt;b &amp; &quot;c&quot;").size(), 8U);
}

TEST_F(VtuFile, LargeGridsAreInBase64) {
  Grid grid;
  grid.points = Matrix::Zero(2000, 2);
  EXPECT_EQ(vtu_format(grid), VtuFormat::ascii);
  grid.points = Matrix::Zero(2001, 2);
  EXPECT_EQ(vtu_format(grid), VtuFormat::base64);
}

TEST_F(VtuFile, CellsHaveTheTypesOfVtk) {
  // VTK_LINE, VTK_TRIANGLE, VTK_TETRA, VTK_QUADRATIC_TRIANGLE, VTK_QUADRATIC_TETRA
  const std::vector<std::pair<int, int>> types{{2, 3}, {3, 5}, {4, 10}, {6, 22}, {10, 24}};
  for (const auto &[nodes, type] : types) {
    Grid grid;
    grid.points = Matrix::Zero(nodes, 3);
    grid.per_cell = nodes;
    for (int i = 0; i < nodes; ++i)
      grid.cells.push_back(i);
    EXPECT_EQ(values_of(written(grid, VtuFormat::ascii), "types"), std::vector<double>{1.0 * type});
  }
}

TEST_F(VtuFile, SizesThatDoNotFitAreRefused) {
  Grid grid = random_grid(2);
  grid.of_cells[0].values.conservativeResize(7);
  EXPECT_THROW(written(grid, VtuFormat::ascii), Error);
  grid = random_grid(2);
  grid.per_cell = 5;
  EXPECT_THROW(written(grid, VtuFormat::base64), Error);
  EXPECT_FALSE(std::filesystem::exists(directory / "u.vtu"));
}

/// One quadratic or linear cell, mapped by a shear and a stretch, its material that of its centre.
struct OneCell {
  Scene scene;
  Matrix points;
  std::vector<int> cells;
  static constexpr double lambda = 9, shear = 4;

  OneCell(int dim, int degree) {
    scene.dim = scene.components = dim;
    scene.degree = degree;
    scene.map = [](const FullMu &mu, const Point &x) -> Point {
      return {mu[0] * x[0] + 0.3 * x[1], x[1] - 0.1 * x[2], 1.1 * x[2]};
    };
    scene.materials = {{{}, [](const FullMu &mu, const Point &centre) {
                          return centre[0] < 1 ? Lame{mu[0] * lambda, mu[0] * shear} : Lame{0, 0};
                        }}};
    points = Matrix::Zero(dim + 1, dim);
    points.bottomRows(dim).setIdentity();
    if (degree == 2) {
      const std::array<std::array<int, 2>, 6> edges{
          {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};
      const Matrix vertices = points;
      const Index middles = dim * (dim + 1) / 2;
      points.conservativeResize(dim + 1 + middles, dim);
      for (Index e = 0; e < middles; ++e) {
        const auto [i, j] = edges[e];
        points.row(dim + 1 + e) = (vertices.row(i) + vertices.row(j)) / 2;
      }
    }
    for (Index i = 0; i < points.rows(); ++i)
      cells.push_back(static_cast<int>(i));
  }
  /// A field of the mapped domain.
  Vector displacement(const FullMu &mu, const std::function<Point(const Point &)> &field) const {
    Vector u(3 * points.rows());
    for (Index i = 0; i < points.rows(); ++i) {
      const Point value = field(scene.map(mu, point_of(points, i)));
      u.segment<3>(3 * i) << value[0], value[1], value[2];
    }
    return u;
  }
};

TEST(CentreStresses, OfALinearDisplacementAreExact) {
  const FullMu mu{1.7};
  for (const int dim : {2, 3})
    for (const int degree : {1, 2}) {
      const OneCell cell(dim, degree);
      Eigen::Matrix3d m;
      m << 0.3, -0.2, 0.05, 0.7, 0.1, 0.4, -0.3, 0.6, 0.2;
      if (dim == 2) m.row(2).setZero(), m.col(2).setZero();
      const Vector u = cell.displacement(mu, [&](const Point &x) -> Point {
        const Eigen::Vector3d v = m * Eigen::Vector3d(x[0], x[1], x[2]);
        return {v[0], v[1], v[2]};
      });
      const double lambda = 1.7 * OneCell::lambda, shear = 1.7 * OneCell::shear;
      const double trace = lambda * m.trace();
      const Matrix s = centre_stresses(cell.scene, mu, cell.points, cell.cells, {}, u);
      ASSERT_EQ(s.cols(), dim == 2 ? 4 : 6);
      EXPECT_NEAR(s(0, 0), trace + 2 * shear * m(0, 0), 1e-12);
      EXPECT_NEAR(s(0, 1), trace + 2 * shear * m(1, 1), 1e-12);
      EXPECT_NEAR(s(0, 2), trace + 2 * shear * m(2, 2), 1e-12); // plane strain: lambda tr(eps)
      EXPECT_NEAR(s(0, 3), shear * (m(0, 1) + m(1, 0)), 1e-12);
      if (dim == 3) {
        EXPECT_NEAR(s(0, 4), shear * (m(1, 2) + m(2, 1)), 1e-12);
        EXPECT_NEAR(s(0, 5), shear * (m(0, 2) + m(2, 0)), 1e-12);
      }
    }
}

/// u_x = x^2: eps_xx = 2 x at the centre, which a linear cell through the vertices would miss.
TEST(CentreStresses, OfAQuadraticDisplacementAreThoseOfTheCentre) {
  const FullMu mu{1};
  for (const int dim : {2, 3}) {
    const OneCell cell(dim, 2);
    const Vector u = cell.displacement(mu, [](const Point &x) -> Point {
      return {x[0] * x[0], 0, 0};
    });
    const double centre = (1 + 0.3) / (dim + 1); // of the mapped vertices
    const Matrix s = centre_stresses(cell.scene, mu, cell.points, cell.cells, {}, u);
    EXPECT_NEAR(s(0, 0), (OneCell::lambda + 2 * OneCell::shear) * 2 * centre, 1e-12);
    EXPECT_NEAR(s(0, 1), OneCell::lambda * 2 * centre, 1e-12);
  }
}

/// In plane stress nothing acts across the plate; in plane strain lambda tr(eps) does.
TEST(CentreStresses, AcrossAThinPlateThereIsNone) {
  OneCell cell(2, 1);
  const FullMu mu{1};
  Vector u = Vector::Zero(3 * cell.points.rows());
  u[3] = 0.1; // stretched along x
  for (const bool thin : {true, false}) {
    cell.scene.materials = {{{}, isotropic(everywhere(15.0), everywhere(0.3), thin)}};
    const Matrix s = centre_stresses(cell.scene, mu, cell.points, cell.cells, {}, u);
    EXPECT_EQ(s(0, 2) == 0, thin);
    EXPECT_GT(s(0, 0), 0);
  }
}

/// Every elastic scene has a material; the core of the half-disk is stiffer.
TEST(CentreStresses, MaterialsAreThoseOfTheScenes) {
  EXPECT_TRUE(make_scene("membrane_obstacle").materials.empty());
  for (const char *name : {"two_disks", "patch"}) {
    const Scene scene = make_scene(name, {{"young", "15"}});
    const Lame material = scene.materials[0].of_cell(expand(scene.parameters, {1}), {0.1, 0.1, 0});
    EXPECT_NEAR(material.shear, 15 / (2 * 1.35), 1e-13) << name;
    EXPECT_NEAR(material.lambda, 15 * 0.35 / (1.35 * 0.3), 1e-13) << name;
  }
  const Scene disk = make_scene("rigid_disk");
  const FullMu mu = expand(free_only(disk.parameters, "core_stiffness"), {3});
  EXPECT_NEAR(disk.materials[0].of_cell(mu, {0, -0.3, 0}).shear,
              3 * disk.materials[0].of_cell(mu, {0, -0.9, 0}).shear, 1e-12);
}

TEST(VonMises, IsThatOfThePrincipalStresses) {
  Matrix s(2, 6);
  s << 3, -1, 2, 0, 0, 0, // principal stresses themselves
      5, 5, 5, 0, 0, 2;   // a pressure and a shear
  const Vector found = von_mises(s);
  EXPECT_NEAR(found[0], std::sqrt((16 + 9 + 1) / 2.0), 1e-13);
  EXPECT_NEAR(found[1], 2 * std::sqrt(3.0), 1e-13);
  EXPECT_NEAR(von_mises(s.leftCols(4))[0], found[0], 1e-13);
}

TEST(BodyNumbers, CountConnectedPartsFromTheFirstNode) {
  // Two triangles that share a node, one alone, and another pair: nodes 0-4, 5-7, 8-11.
  const std::vector<int> cells{8, 9, 10, 0, 1, 2, 5, 6, 7, 2, 3, 4, 9, 10, 11};
  EXPECT_EQ(body_numbers(cells, 3, 12, 5), (Vector(5) << 2, 3, 1, 3, 2).finished());
  EXPECT_EQ(body_numbers(cells, 3, 12, 8), (Vector(5) << 1, 2, 3, 2, 1).finished());
}

} // namespace
} // namespace rbvi::vtu_test
