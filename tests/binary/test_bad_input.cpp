// Bad input: one line of ours, the documented status, nothing written, on 1 and 2 ranks.
#include "rbvi/io/h5.hpp"
#include "rbvi/model/model.hpp"
#include "run.hpp"

#include <algorithm>
#include <future>

namespace rbvi::bad_input_test {
namespace {

/// Every file below `directory` with its bytes, but for those of commands that still run.
std::vector<std::pair<std::string, std::string>> everything() {
  std::vector<std::pair<std::string, std::string>> files;
  for (const auto &entry : fs::recursive_directory_iterator(".")) {
    const std::string name = entry.path().string();
    if (name.ends_with(".stdout") || name.ends_with(".stderr")) continue;
    files.emplace_back(name, entry.is_regular_file() ? slurp(name) : "directory");
  }
  std::sort(files.begin(), files.end());
  return files;
}

class BadInput : public InDirectory, public testing::WithParamInterface<int> {
protected:
  /// Runs all, some at a time, and checks each; nothing in the directory may change. On 2 ranks
  /// every sixth: what is refused is the same there, that it is said once is what they show.
  void refuse(const std::vector<Refusal> &all) const {
    std::vector<Refusal> cases;
    for (std::size_t i = 0; i < all.size(); i += GetParam() == 1 ? 1 : 6)
      cases.push_back(all[i]);
    const auto files = everything();
    constexpr std::size_t at_once = 6;
    for (std::size_t begin = 0; begin < cases.size(); begin += at_once) {
      std::vector<std::future<Finished>> runs;
      const std::size_t end = std::min(begin + at_once, cases.size());
      for (std::size_t i = begin; i < end; ++i)
        runs.push_back(std::async(std::launch::async, [&, i] {
          return shell(rbvi(GetParam(), cases[i].arguments), std::to_string(i));
        }));
      for (std::size_t i = begin; i < end; ++i)
        expect_refused(cases[i], runs[i - begin].get(), GetParam());
    }
    EXPECT_TRUE(everything() == files) << "files were written or changed";
  }
  /// A good run in run/.
  void make_run() const {
    const Finished run = shell(rbvi(GetParam(), "offline -case case.yaml -out run"));
    ASSERT_EQ(run.status, 0) << run.err;
  }
};

TEST_P(BadInput, Commands) {
  refuse({{"oflfine", "nearest one is 'offline'"},
          {"inspect", "one model file"},
          {"list one more", "'more' is left over"},
          {"list nowhere", "there is no case nowhere/*/case.yaml"},
          {"offline case.yaml", "'case.yaml' is left over"},
          {"solve -case case.yaml -mu 0.2 0 0", "'0' is left over"}});
}

TEST_P(BadInput, ScenesAndOptions) {
  refuse(
      {{"offline -scene membrane -out run", "use -case cases/membrane"},
       {"offline -case case.yaml -scene membrane -out run", "leave out one of the two"},
       {"offline -case case.yaml -variant big -out run",
        "there is no variant 'big' of this case: it has published"},
       {"offline -case case.yaml -set mesh.edges -out run", "give PATH=VALUE"},
       {"offline -case case.yaml -set mesh.edges=13 -out run",
        "edges is 13: it must be a multiple of 12"},
       {"offline -case case.yaml -set mesh.egdes=24 -out run", "the nearest is 'edges'"},
       {"offline -case case.yaml -trian grid:2,2,2 -out run", "nearest one is -train"},
       {"offline -case case.yaml --pod_tolernace 1e-3 -out run", "nearest one is -pod_tolerance"},
       {"offline -case case.yaml -pod_tolerance small -out run", "'small': not a number"},
       {"offline -case case.yaml -pod_tolerance -1 -out run", "use a number from 0 to 0.5"},
       {"offline -case case.yaml -pod_tolerance 1 -out run", "use a number from 0 to 0.5"},
       {"offline -case case.yaml -pod_tol 1e-3 -out run", "nearest one is -pod_tolerance"},
       {"offline -case case.yaml -pod_tols 1e-3 -out run", "nearest one is -pod_tolerance"},
       {"offline -case case.yaml -cone_type cone -out run",
        "use one of cpg, mcpg, angle_greedy, nmf, nodal, hybrid"},
       {"offline -case case.yaml -disc_map round -out run", "use one of similarity, graded"},
       {"offline -case case.yaml -load heavy -out run", "'heavy': not a number"},
       {"offline -case case.yaml -plan maybe -out run", "use yes or no"},
       {"offline -case case.yaml -log_veiw -out run", "the nearest one is -log_view"},
       {"offline -case case.yaml -sweep_ranks_per_solve 3 -out run", "a number that divides the"},
       {"offline -case case.yaml -sweep_ranks_per_solve all -out run", "a number or auto"},
       {"offline -case case.yaml -sweep_max_failures 10 -out run", "use a number from 0 to 1"},
       {"bench -case case.yaml -bench_growth x -out run", "option -bench_growth is 'x': not a"},
       {"bench -case case.yaml -bench_growth 0,9 -out run", "use a number from 0 to 6"},
       {"bench -case case.yaml -bench_growth 1,0 -out run", "give rising numbers"},
       {"bench -case case.yaml -bench_growth 0 -sweep_ranks_per_solve 3 -out run", "that divides"},
       {"bench -case case.yaml -bench_growth 0", "use -out"},
       {"offline -case case.yaml -train grid:2,2 -out run",
        "2 counts for 3 free parameters (radius,center_x,center_y): give one for each, "
        "grid:9,9,9, or a number of random ones, random:60"},
       {"offline -case case.yaml -radius 0.24,0.16 -out run", "the lower bound comes first"},
       {"offline -case case.yaml -radius 0.2,0.2 -out run", "both bounds are the same"},
       {"offline -case case.yaml -radius 0.2 -out run", "3 counts for 2 free parameters"},
       {"offline -case case.yaml -radius 0.2 -parameters radius -out run", "fixed by -radius 0.2"},
       {"offline -case " RBVI_CASES
        "/membrane_obstacle -circle_edges 120 -mesh_refine 6 -train grid:20,20,20 -out run",
        "the stage 'interpolation' would take about"},
       {"offline -case case.yaml -options_file no -out run", "options file no"},
       {"offline -case case.yaml", "use -out"}});
}

/// Boxes, values and options of scenes where these make no sense, before a directory is made.
TEST_P(BadInput, RangesOfValidity) {
  spill("disk.yaml", "case: " RBVI_CASES "/rigid_disk\narc_edges: 40\ntrain: grid:3\n");
  spill("patch.yaml", "case: " RBVI_CASES "/patch\ntrain: grid:3\n");
  const std::string membrane = "offline -case case.yaml -out run ";
  const std::string disk = "offline -case disk.yaml -out run ";
  refuse({{membrane + "-radius -1,1", "lower bound, is -1: its range of validity is [0.02, 0.38]"},
          {membrane + "-radius 0.16,1e300", "upper bound, is 1e+300: its range of validity"},
          {membrane + "-radius 5 -train grid:2,2", "option -radius is 5: its range of validity"},
          {membrane + "-radius nan,0.2", "not finite"},
          {membrane + "-radius 0.16,inf", "not finite"},
          {membrane + "-center_x 0.3,0.35", "folds the mesh"},
          {membrane + "-load 1e300", "option load is 1e+300: its range of validity"},
          {disk + "-indentation 5", "option -indentation is 5: its range of validity"},
          {disk + "-indentation 0.05,1", "contact would reach the ends of the arc"},
          {disk + "-indentation 0.1", "(-contact_arc wide goes further)"},
          {disk + "-contact_arc wide -indentation 0.2", "is above 0.2 of the radius 0.7"},
          {disk + "-poisson_ratio 0.7", "range of validity is [-0.99, 0.499]"},
          {disk + "-poisson_ratio 0.2,0.5", "range of validity is [-0.99, 0.499]"},
          {disk + "-friction_coefficient -0.3", "range of validity is [0, 5]"},
          {disk + "-friction tresca -friction_threshold -1,1", "range of validity is [0, 150000]"},
          {disk + "-core_stiffness 0,1", "range of validity is [0.001, 1000]"},
          {disk + "-young -1", "option young is -1: its range of validity"},
          {disk + "-plan -indentation 5", "option -indentation is 5: its range of validity"},
          {"offline -case patch.yaml -indentation 5 -out run", "range of validity is [0, 0.25]"},
          {"solve -case case.yaml -radius -1,1 -mu 0.5,0,0 -csv x.csv", "range of validity"},
          {"verify -case case.yaml -radius -1,1 -out run", "range of validity"}});
}

TEST_P(BadInput, OptionsWithoutAValue) {
  refuse({{"offline -case case.yaml -out run -mesh", "option -mesh has no value"},
          {"offline -case case.yaml -radius -out run", "option -radius has no value"},
          {"offline -case case.yaml -out run -train", "option -train has no value"},
          {"solve -case case.yaml -mu 0.2,0,0 -csv", "option -csv has no value"}});
}

TEST_P(BadInput, OptionsOfPetscWithoutAPrefix) {
  const std::string offline = "offline -case case.yaml -out run ";
  refuse({{offline + "-ksp_rtol 1e-3",
           "-hf_ksp_rtol, -hf_krylov_ksp_rtol, -v_ksp_rtol, -vi_ksp_rtol, -nitsche_ksp_rtol"},
          {offline + "-pc_type lu", "need the prefix of a solver: -hf_pc_type"},
          {offline + "-mat_mumps_icntl_14 50", "prefix of a solver: -hf_mat_mumps_icntl_14"},
          {offline + "-snes_rtol 1e-3", "prefix of a solver: -vi_snes_rtol, -nitsche_snes_rtol"},
          {offline + "-eps_nev 3", "need the prefix of a solver: -pga_eps_nev, -infsup_eps_nev"},
          {offline + "-tao_type lmvm", "no object of rbvi takes PETSc's options -tao_*"}});
}

TEST_P(BadInput, OptionsOfEigenvalues) {
  const std::string offline = "offline -case case.yaml -out run ";
  const std::string disk = "offline -case disk.yaml -out run ";
  spill("disk.yaml", "case: " RBVI_CASES "/rigid_disk\narc_edges: 40\ntrain: grid:3\n");
  refuse({{offline + "-pga_eps_nev 3", "all values of a small matrix are computed"},
          {offline + "-pga_eps_tpye lapack", "asks for the option -pga_eps_tpye"},
          {offline + "-pga_eps_type nothing", "the options -pga_* do not work"},
          {offline + "-infsup_svd_view", "inf-sup constants are computed by verify"},
          {offline + "-pga_enrichment decorrelated -pga_eps_view", "makes no supremizers"},
          {disk + "-pga_eps_view", "cone and collocated alone make supremizers"},
          {disk + "-formulation nitsche -pga_eps_view", "Nitsche's method has no multipliers"},
          {"solve -case case.yaml -mu 0.2,0,0 -csv x.csv -pga_eps_view", "made by offline"}});
}

TEST_P(BadInput, OptionsOfSolversWithoutEffect) {
  const std::string offline = "offline -case case.yaml -out run ";
  refuse({{offline + "-hf_ksp_rtol 1e-3", "no effect on a direct solver: add -hf_ksp_type cg"},
          {offline + "-v_ksp_max_it 3", "no effect on a direct solver: add -v_ksp_type cg"},
          {offline + "-hf_pc_type jacobi", "no solver by itself: add -hf_ksp_type cg"},
          {offline + "-v_pc_type none", "no solver by itself: add -v_ksp_type cg"},
          {offline + "-vi_snes_rtol 1e-3", "is for -hf_method vi"},
          {offline + "-lumped yes -hf_method vi -vi_ksp_rtol 1e-3", "add -vi_ksp_type cg"},
          {offline + "-nitsche_snes_rtol 1e-3", "set -formulation nitsche"}});
}

/// What a command reads it does not write, however the file is spelt.
TEST_P(BadInput, OverwritingInputs) {
  spill("mu.csv", "radius,center_x,center_y\n0.2,0,0\n");
  fs::create_symlink("mu.csv", "link.csv");
  fs::create_directory("sub");
  spill("sub/case.yaml", slurp("case.yaml"));
  const std::string solve = "solve -case case.yaml -mu 0.2,0,0 ";
  refuse(
      {{solve + "-csv case.yaml", "-csv case.yaml would overwrite the case file"},
       {solve + "-csv ./sub/../case.yaml", "would overwrite the case file"},
       {solve + "-vtu coarse.msh", "would overwrite the file of -mesh"},
       {solve + "-train mu.csv -csv link.csv", "would overwrite the file of -train"},
       {solve + "-valid mu.csv -vtu mu.csv", "would overwrite the file of -valid"},
       {solve + "-csv x.vtu -vtu x.vtu", "would overwrite -csv"},
       {solve + "-csv x_contact.vtu -vtu x.vtu", "would overwrite -csv"},
       {"offline -case sub/case.yaml -mesh coarse.msh -out sub", "would overwrite the case file"},
       {"offline -case case.yaml -out .", "would overwrite the case file"}});
}

TEST_P(BadInput, OptionsOfBases) {
  const std::string offline = "offline -case case.yaml -out run ";
  const std::string of = "case: " RBVI_CASES "/";
  spill("nodal.yaml",
        of + "membrane_obstacle/case.yaml\ncone_level: 1\nmesh_refine: 1\ncone_type: nodal\n");
  spill("rows.yaml", of + "rigid_disk/case.yaml\neim_normal_tolerance: 1e-3\n");
  const std::string reference = "while reading option -reference_mu";
  refuse({{offline + "-cone_ring -1", "use a number from 0 to 1000"},
          {offline + "-cone_ring 0.5", "must be an integer"},
          {offline + "-cone_level 1", "-mesh_refine is 0"},
          {offline + "-cone_level 1 -mesh_refine 1 -cone_type nodal", "use -cone_type hybrid"},
          {"offline -case nodal.yaml -out run", "use -cone_type hybrid"},
          {"offline -case rows.yaml -out run", "it is for -multiplier_reduction collocated"},
          {"offline -case " RBVI_CASES
           "/rigid_disk -formulation nitsche -out run -mesh_refine 1 -cone_level 1",
           "Nitsche's method has no multipliers"},
          {offline + "-pga_enrichment both", "use one of decorrelated, online, offline"},
          {offline + "-pga_product w", "use one of v, energy"},
          {offline + "-pga_enrichment online -pga_product energy", "leave out -pga_product energy"},
          {offline + "-reference_mu 0.3,0,0", "outside [0.16, 0.24], " + reference},
          {offline + "-reference_mu 0.2,0", "2 values for 3"},
          {offline + "-reference_mu 0.2,0", reference},
          {offline + "-reference_mu a,0,0", "'a': not a number"},
          {offline + "-reference_mu nan,0,0", reference}});
}

/// Known only when the snapshots are there: they stay, and no model is written.
TEST_P(BadInput, AHybridConeThatIsTooSmall) {
  const Finished run = shell(rbvi(GetParam(), "offline -case case.yaml -out run -cone_max_size 3"));
  expect_refused({"offline -cone_max_size 3", "needs a larger -cone_max_size", 1}, run, GetParam());
  EXPECT_FALSE(fs::exists("run/model.h5"));
  EXPECT_FALSE(fs::exists("run/samples.csv"));
  const Finished again = shell(rbvi(GetParam(), "offline -case case.yaml -out run"));
  EXPECT_EQ(again.status, 0) << again.err;
  EXPECT_TRUE(contains(again.out, "all 8 were there")) << again.out;
}

TEST_P(BadInput, OptionsOfSolvers) {
  refuse({{"offline -case case.yaml -hf_pc_tpye lu -out run", "-hf_pc_tpye"},
          {"offline -case case.yaml -hf_mat_mumps_icntl14 50 -out run", "-hf_mat_mumps_icntl14"},
          {"offline -case case.yaml -v_ksp_tpye cg -out run", "-v_ksp_tpye"},
          {"offline -case case.yaml -vi_snes_max_its 9 -out run", "-vi_snes_max_its"},
          {"offline -case case.yaml -hf_pc_type nothing -out run", "nothing"},
          {"solve -case case.yaml -mu 0.2,0,0 -hf_pc_tpye lu -csv x.csv", "-hf_pc_tpye"}});
}

TEST_P(BadInput, Mu) {
  const std::string solve = "solve -case case.yaml -csv x.csv ";
  refuse({{solve, "use -mu"},
          {solve + "-mu 0.2,0", "2 values for 3"},
          {solve + "-mu 0.2,0,0,0", "4 values for 3"},
          {solve + "-mu 0.25,0,0", "radius = 0.25 is outside [0.16, 0.24]"},
          {solve + "-mu nan,0,0", "not finite"},
          {solve + "-mu a,0,0", "'a': not a number"},
          {solve + "-mu radius=0.2,centre=0", "no parameter 'centre'"}});
}

TEST_P(BadInput, CaseFiles) {
  spill("text.yaml", "membrane_obstacle\n");
  spill("brackets.yaml", "case: " RBVI_CASES "/membrane_obstacle\ntrain: [grid\n");
  spill("tab.yaml", "case: " RBVI_CASES "/membrane_obstacle\n\tload: -25\n");
  spill("list.yaml", "- scene\n- train\n");
  spill("alias.yaml", "case: *membrane\n");
  spill("old.yaml", "scene: rigid_disk\nradius: 0.7,1.3\n");
  spill("bytes.yaml", std::string("\0\1\377\376scene", 9));
  spill("empty.yaml", "");
  spill("key.yaml", "case: " RBVI_CASES "/membrane_obstacle\ntrian: grid:2,2,2\n");
  spill("short.yaml", "case: " RBVI_CASES "/membrane_obstacle\npod_tol: 1e-3\n");
  spill("nested.yaml", "case: " RBVI_CASES "/membrane_obstacle\npod: {tolerance: 1}\n");
  spill("twice.yaml", "case: " RBVI_CASES "/membrane_obstacle\nload: -25\nload: -20\n");
  spill("another.yaml", "case: key.yaml\n");
  spill("range.yaml", "case: " RBVI_CASES "/membrane_obstacle\nradius: [-1, 1]\n");
  spill("none.yaml", "case: " RBVI_CASES "/membrane_obstacle\nmesh:\n");
  fs::create_directory("directory.yaml");
  refuse({{"offline -out run", "no case is named"},
          {"offline -case no.yaml -out run", "no.yaml cannot be read"},
          {"offline -case directory.yaml -out run", "directory.yaml is a directory"},
          {"offline -case text.yaml -out run", "text.yaml is malformed at line 1"},
          {"offline -case brackets.yaml -out run", "brackets.yaml is malformed at line 3"},
          {"offline -case tab.yaml -out run", "tab.yaml is malformed at line 2"},
          {"offline -case list.yaml -out run", "list.yaml is malformed at line 1"},
          {"offline -case alias.yaml -out run", "alias.yaml is malformed at line 1"},
          {"offline -case bytes.yaml -out run", "bytes.yaml is malformed at line 1"},
          {"offline -case empty.yaml -out run", "is a list of options and names no case"},
          {"offline -case key.yaml -out run", "unknown option -trian (line 2 of key.yaml)"},
          {"offline -case short.yaml -out run",
           "-pod_tol (line 2 of short.yaml): the nearest one is -pod_tolerance"},
          {"offline -case nested.yaml -out run", "line 2: options are not nested"},
          {"offline -case nested.yaml -out run", "write 'pod_tolerance: value'"},
          {"offline -case twice.yaml -out run", "line 3: load is given again, after line 2"},
          {"offline -case another.yaml -out run", "key.yaml is a list of options, too"},
          {"offline -case range.yaml -out run", "its range of validity is [0.02, 0.38]"},
          {"offline -case none.yaml -out run", "option -mesh (line 2 of none.yaml) has no value"},
          {"offline -case /dev/zero -out run", "larger than 1 MB"}});
}

TEST_P(BadInput, Meshes) {
  spill("edge.msh", coarse_gmsh("edge"));
  spill("half.msh", coarse_gmsh().substr(0, 4000));
  spill("text.msh", "not a mesh\n");
  spill("millimetres.msh", coarse_gmsh("boundary", 1000));
  std::string torn = coarse_gmsh(); // node 1, the centre, is no longer that of its first cell
  const std::string nodes = "$Nodes\n181\n", cell = " 2 2 2 1 1 2 3\n";
  torn.replace(torn.find(nodes), nodes.size(), "$Nodes\n182\n182 0 0 0\n");
  torn.replace(torn.find(cell), cell.size(), " 2 2 2 1 182 2 3\n");
  spill("torn.msh", torn);
  std::string half = coarse_gmsh(); // an edge of the boundary is in no group
  const std::string edge = "\n1 1 2 1 1 ";
  half.replace(half.find(edge), edge.size(), "\n1 1 2 9 1 ");
  spill("part.msh", half);
  refuse({{"offline -case case.yaml -mesh no.msh -out run", "no.msh"},
          {"offline -case case.yaml -mesh text.msh -out run", "not a Gmsh mesh"},
          {"offline -case case.yaml -mesh half.msh -out run", "half.msh"},
          {"offline -case case.yaml -mesh edge.msh -out run", "no physical boundary 'boundary'"},
          {"offline -case case.yaml -mesh millimetres.msh -out run",
           "mesh file 'millimetres.msh' is not the square of side 1 about the origin"},
          {"offline -case case.yaml -mesh torn.msh -out run", "without common nodes"},
          {"offline -case case.yaml -mesh part.msh -out run",
           "'boundary' of mesh file 'part.msh' is not all four sides of the square"}});
}

TEST_P(BadInput, Models) {
  make_run();
  const std::string good = slurp("run/model.h5");
  std::string flipped = good;
  flipped[good.size() / 2] = static_cast<char>(flipped[good.size() / 2] ^ 1);
  H5Writer other_schema, sample;
  other_schema.write("scene", std::string("membrane_obstacle"));
  other_schema.commit("other_schema.h5", "model", 999);
  H5Writer older;
  older.write("scene/name", std::string("membrane_obstacle"));
  older.commit("older.h5", "model", 1);
  const std::pair<std::string, std::string> models[] = {
      {good.substr(0, good.size() / 2), "truncated"},
      {flipped, "damaged"},
      {"\211HDF\r\n\032\n and more", "not one written by rbvi"},
      {slurp("other_schema.h5"), "999"},
      {slurp("older.h5"),
       "schema version 1; this build reads version " + std::to_string(model_schema)}};
  for (const auto &[bytes, part] : models) {
    spill("run/model.h5", bytes);
    refuse({{"verify -out run", part}, {"inspect run/model.h5", part}});
  }
  fs::remove("run/model.h5");
  refuse({{"verify -out run", "run/model.h5 does not exist"},
          {"verify -case case.yaml", "use -out"},
          {"inspect run/model.h5", "does not exist"},
          {"inspect run", "is a directory"}});
}

TEST_P(BadInput, RunsOfOtherOptions) {
  make_run();
  spill("patch.yaml", "case: " RBVI_CASES "/patch\n");
  refuse({{"offline -case case.yaml -out run -load -20", "load = -25, now it is -20"},
          {"offline -case case.yaml -out run -hf_method uzawa",
           "hf_method = active_set, now it is uzawa"},
          {"offline -case case.yaml -out run -mesh_refine 1", "mesh = "},
          {"offline -case case.yaml -out run -center_x 0 -train grid:2,2", "center_x"},
          {"verify -case patch.yaml -out run", "is one of scene membrane_obstacle"},
          {"bench -case patch.yaml -out run", "is one of scene membrane_obstacle"}});
  std::string mesh = coarse_gmsh();
  const std::string centre = "\n1 0 0 0\n";
  spill("coarse.msh", mesh.replace(mesh.find(centre), centre.size(), "\n1 0.001 0 0\n"));
  refuse({{"verify -out run", "was made on another mesh"},
          {"bench -out run", "was made on another mesh"}});
  fs::remove("coarse.msh");
  refuse({{"verify -out run", "coarse.msh'"}});
}

TEST_P(BadInput, NotWritable) {
  refuse({{"offline -case case.yaml -out coarse.msh", "cannot make the directory", 1},
          {"offline -case case.yaml -out coarse.msh/run", "cannot make the directory", 1},
          {"solve -case case.yaml -mu 0.2,0,0 -csv no/x.csv", "cannot write no/x.csv", 1},
          {"solve -case case.yaml -mu 0.2,0,0 -csv /dev/full", "No space left", 1},
          {"solve -case case.yaml -mu 0.2,0,0 -vtu no/u.vtu", "cannot write no/u.vtu", 1}});
}

/// What was written before stays whole, and the run goes on once there is room.
TEST_P(BadInput, DiskFull) {
  fs::create_directory("disk");
  if (shell("unshare -rm mount -t tmpfs none disk").status != 0)
    GTEST_SKIP() << "a small file system cannot be mounted here";
  const Finished run = shell("unshare -rm sh -c 'mount -t tmpfs -o size=60k none disk; " +
                             rbvi(GetParam(), "offline -case case.yaml -out disk/run") +
                             "; status=$?; cp -r disk/run kept; exit $status'");
  expect_refused({"offline on a full disk", "No space left", 1}, run, GetParam());
  for (const auto &entry : fs::directory_iterator("kept/samples"))
    EXPECT_EQ(entry.path().extension(), ".h5") << entry.path();
  EXPECT_FALSE(fs::exists("kept/model.h5"));
  const Finished resumed = shell(rbvi(GetParam(), "offline -case case.yaml -out kept"));
  EXPECT_EQ(resumed.status, 0) << resumed.err;
  EXPECT_TRUE(contains(resumed.out, "reused")) << resumed.out;
}

INSTANTIATE_TEST_SUITE_P(Ranks, BadInput, testing::Values(1, 2),
                         [](const auto &ranks) { return "np" + std::to_string(ranks.param); });

} // namespace
} // namespace rbvi::bad_input_test
