// What check draws of a case: its mesh, its surface, and what its contacts face.
#include "rbvi/model/solution_vtu.hpp"
#include "rbvi/par/collective.hpp"
#include "rbvi/tool/commands.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>

namespace rbvi::check_test {
namespace {

namespace fs = std::filesystem;

/// Numbers of an array in ASCII; none where the file does not have it.
std::vector<double> array_in(const fs::path &file, const std::string &name) {
  std::ostringstream all;
  all << std::ifstream(file).rdbuf();
  const std::string text = all.str();
  const std::size_t at = text.find("Name=\"" + name + "\"");
  if (at == std::string::npos) return {};
  std::istringstream numbers(text.substr(text.find('>', at) + 1));
  std::vector<double> values;
  for (double value = 0; numbers >> value;)
    values.push_back(value);
  return values;
}

/// A contact at one place in the box.
struct Partners {
  std::vector<double> points, gap, normal, way;
  explicit Partners(const fs::path &file)
      : points(array_in(file, "points")), gap(array_in(file, "gap")),
        normal(array_in(file, "normal")), way(array_in(file, "to_partner")) {}
  double least() const { return *std::ranges::min_element(gap); }
  double mean() const {
    return std::accumulate(gap.begin(), gap.end(), 0.0) / static_cast<double>(gap.size());
  }
  Point partner(std::size_t i) const {
    return {points[3 * i] + way[3 * i], points[3 * i + 1] + way[3 * i + 1],
            points[3 * i + 2] + way[3 * i + 2]};
  }
};

class Check : public testing::Test {
protected:
  /// Collective; the files are those of the first rank.
  void check(const std::string &name, const SceneOptions &choices = {}) {
    options_.scene = make_scene(name, choices);
    int process = static_cast<int>(getpid());
    MPI_Bcast(&process, 1, MPI_INT, 0, PETSC_COMM_WORLD);
    folder_ = fs::temp_directory_path() / ("rbvi_check_" + std::to_string(process));
    options_.vtu = (folder_ / "u.vtu").string();
    const Problem problem(PETSC_COMM_WORLD, options_.scene, options_.mesh);
    collectively(PETSC_COMM_WORLD, [&] {
      if (rank_of(PETSC_COMM_WORLD) != 0) return;
      fs::create_directories(folder_);
      written_ = write_check(options_.vtu, problem, mesh_with_groups(options_.scene, ""));
    });
  }
  ~Check() override {
    if (first()) fs::remove_all(folder_);
  }
  Partners at(const std::string &place) const {
    return Partners(folder_ / ("u_partners" + place + ".vtu"));
  }
  bool first() const { return rank_of(PETSC_COMM_WORLD) == 0; }

  ToolOptions options_;
  fs::path folder_;
  std::vector<fs::path> written_;
};

TEST_F(Check, TheMeshAndItsSurfaceHaveTheirGroups) {
  check("rigid_disk");
  if (!first()) return;
  ASSERT_EQ(written_.size(), 5U);
  EXPECT_EQ(files_of_check(options_.vtu, options_.scene).size(), 5U);
  const std::vector<double> core = array_in(folder_ / "u_mesh.vtu", "core"),
                            arc = array_in(folder_ / "u_surface.vtu", "arc"),
                            contact = array_in(folder_ / "u_surface.vtu", "contact"),
                            free = array_in(folder_ / "u_surface.vtu", "(free)");
  EXPECT_GT(std::ranges::count(core, 1), 0);
  EXPECT_GT(std::ranges::count(core, 0), 0);
  ASSERT_EQ(arc.size(), free.size());
  for (std::size_t i = 0; i < arc.size(); ++i)
    EXPECT_EQ(free[i], arc[i] - contact[i]) << "the top is held, the rest of the arc is free";
}

/// Whatever the normal of contact is: gaps are what the way to the partner has along it.
TEST_F(Check, PartnersOnADiskLieOnIt) {
  for (const SceneOptions &choice : std::vector<SceneOptions>{
           {}, {{"gap", "ray"}}, {{"gap", "vertical"}}, {{"kinematics", "large"}}}) {
    check("rigid_disk", choice);
    if (!first()) continue;
    const Partners middle = at("_middle");
    ASSERT_FALSE(middle.gap.empty());
    for (std::size_t i = 0; i < middle.gap.size(); ++i) {
      const auto [x, y, z] = middle.partner(i);
      EXPECT_NEAR(std::hypot(x, y + 2.001), 1, 1e-12);
      const Point n{middle.normal[3 * i], middle.normal[3 * i + 1], 0},
          way{middle.way[3 * i], middle.way[3 * i + 1], 0};
      EXPECT_NEAR(norm(n), 1, 1e-14);
      EXPECT_NEAR(dot(way, n), middle.gap[i], 1e-12);
    }
  }
  if (!first()) return;
  const Partners middle = at("_middle");
  // They are equally deep at all radii: the mean decides.
  EXPECT_LT(at("_least").mean(), middle.mean());
  EXPECT_GT(at("_largest").mean(), middle.mean());
}

/// One body against the curve of the other, the second contact in files of its own.
TEST_F(Check, BodiesFaceEachOtherAndEachContactHasItsFiles) {
  check("two_disks");
  if (first()) {
    const Partners middle = at("_middle");
    ASSERT_FALSE(middle.gap.empty());
    for (std::size_t i = 0; i < middle.gap.size(); ++i) {
      const auto [x, y, z] = middle.partner(i);
      EXPECT_EQ(x, middle.points[3 * i]) << "below it";
      EXPECT_NEAR(y, middle.points[3 * i + 1] - middle.gap[i], 1e-15);
    }
  }
  check("roller");
  if (!first()) return;
  EXPECT_EQ(files_of_check(options_.vtu, options_.scene).size(), 8U);
  EXPECT_EQ(written_.size(), 6U) << "the gap of the second one does not vary in the box";
  for (const char *place : {"_upper_plate_middle", "_lower_plate_middle"}) {
    const Partners plate = at(place);
    ASSERT_GT(plate.gap.size(), 3U) << place;
    const Point a = plate.partner(0), b = plate.partner(1), c = plate.partner(plate.gap.size() - 1);
    EXPECT_NEAR(cross(b - a, c - a)[2], 0, 1e-14) << "partners on a plate lie on a line";
  }
}

TEST_F(Check, AMembraneFacesItsObstacle) {
  check("membrane_obstacle");
  if (!first()) return;
  const Partners middle = at("_middle");
  ASSERT_FALSE(middle.gap.empty());
  double highest = -1;
  for (std::size_t i = 0; i < middle.gap.size(); ++i) {
    EXPECT_EQ(middle.partner(i)[2], -middle.gap[i]);
    highest = std::max(highest, -middle.gap[i]);
  }
  EXPECT_EQ(highest, -middle.least());
}

} // namespace
} // namespace rbvi::check_test
