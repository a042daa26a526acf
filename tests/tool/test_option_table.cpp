// The table of options: what models keep of it.
#include "rbvi/tool/options.hpp"
#include "tests/catalogue.hpp"

#include <gtest/gtest.h>

#include <set>

namespace rbvi::option_table_test {
namespace {

ToolOptions options_of(const std::string &scene, const SceneOptions &own = {}) {
  ToolOptions options;
  options.scene = make_scene(scene, own);
  options.train = "grid:3";
  return options;
}

std::set<std::string> names_kept(const ToolOptions &options) {
  std::set<std::string> names;
  for (const auto &[name, value] : kept_settings(options))
    names.insert(name);
  return names;
}

const std::set<std::string> of_all{"training", "mesh_refine", "pod_tolerance", "eim_tolerance"};
const std::set<std::string> of_dual_bases{"cone_type",   "cone_tolerance", "cone_feasibility",
                                          "cone_ring",   "cone_level",     "pga_enrichment",
                                          "pga_product", "pga_tolerance",  "pga_beta_fraction"};

std::set<std::string> both(std::set<std::string> one, const std::set<std::string> &other) {
  one.insert(other.begin(), other.end());
  return one;
}

TEST(OptionTable, AModelKeepsWhatItDependsOn) {
  const ToolOptions membrane = options_of("membrane_obstacle");
  EXPECT_EQ(names_kept(membrane), both(of_all, of_dual_bases));
  EXPECT_EQ(names_kept(options_of("rigid_disk", {{"formulation", "nitsche"}})),
            both(of_all, {"nitsche_quadrature"}));
  ToolOptions disk = options_of("rigid_disk");
  disk.reduce.multipliers.reduction = MultiplierReduction::condensed;
  const std::set<std::string> of_supports =
      both(of_all, {"condensed_tolerance", "multiplier_reduction", "cone_level"});
  EXPECT_EQ(names_kept(disk), of_supports);
  disk.reduce.multipliers.reduction = MultiplierReduction::collocated;
  disk.reduce.eim_normal = 1e-3;
  EXPECT_EQ(names_kept(disk), both(both(of_supports, of_dual_bases),
                                   {"tangential_tolerance", "eim_normal_tolerance"}));
}

TEST(OptionTable, ValuesAreKeptAsText) {
  ToolOptions options = options_of("membrane_obstacle");
  options.reduce.infsup_tolerance = true;
  options.reduce.product = SupremizerProduct::energy;
  options.mesh.file = "/no/../square.msh";
  const std::map<std::string, std::string> kept = kept_settings(options);
  EXPECT_EQ(kept.at("training"), "grid:3");
  EXPECT_EQ(kept.at("pod_tolerance"), "1e-06");
  EXPECT_EQ(kept.at("cone_type"), "hybrid");
  EXPECT_EQ(kept.at("pga_tolerance"), "infsup");
  EXPECT_EQ(kept.at("pga_product"), "energy");
  EXPECT_EQ(kept.at("mesh_file"), "/square.msh");
}

} // namespace
} // namespace rbvi::option_table_test
