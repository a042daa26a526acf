// The options of rbvi, for -help.
#include "rbvi/core/outputs.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/tool/options/options.hpp"

#include <cstdio>

namespace rbvi {

const std::vector<OptionHelp> &tool_options() {
  static const std::vector<OptionHelp> options{
      {"case", "",
       "case file (YAML, one 'option: value' per line); the command line beats it. Without it: "
       "that of -out"},
      {"scene", "", "name of the scene (rbvi list); with its defaults no case file is needed"},
      {"out", "", "run directory"},
      {"parameters", "", "names of the free parameters; the others keep their value"},
      {"train", "", "training set: grid:5,5,5 | random:COUNT:SEED | file.csv"},
      {"valid", "", "validation set, as -train"},
      {"mu", "", "parameter of one solve: 0.18,0.02,-0.01 or radius=0.18,center_x=0.02"},
      {"vtu", "", "file for the field of one solve"},
      {"csv", "", "file for the table of outputs"},
      {"plan", "no", "print which stages will run, and stop"},
      {"verify_stability", "yes", "verify inf-sup constants and bounds too, not errors alone"},
      {"mesh", "", "Gmsh file instead of the built-in mesh"},
      {"mesh_refine", "0", "uniform refinements"},
      {"hf_method", "active_set", "high-fidelity solver: active_set | uzawa | vi"},
      {"uzawa_tolerance", "1e-6", "relative change of the multiplier"},
      {"uzawa_max_iterations", "20000", "limit of iterations"},
      {"uzawa_accelerated", "no", "Nesterov's extrapolation with restart"},
      {"uzawa_step", "0", "step rho; 0 is 1 / largest eigenvalue of B A^-1 B^T"},
      {"nitsche_loop", "nested",
       "Coulomb's bound: frozen in an outer loop (nested), or following every Newton step "
       "(single)"},
      {"nitsche_bounds", "none",
       "Nitsche's method: the nodes' normal displacements are bounded by the gap: none | "
       "nonpenetration"},
      {"sweep_ranks_per_solve", "1", "ranks that share one solve; divides the ranks"},
      {"sweep_max_failures", "0.1",
       "share of a set that may fail: where more does, no model is made, nothing measured"},
      {"pod_tolerance", "1e-6", "relative error of the displacement modes (2.11)"},
      {"pod_max_size", "0", "most modes; 0 is no bound"},
      {"cone_type", "hybrid",
       "dual basis: cpg | mcpg | angle_greedy | nmf | nodal | hybrid (README)"},
      {"cone_tolerance", "1e-4", "relative error of the cone (2.34); not used by nodal"},
      {"cone_max_size", "0", "most generators; 0 is no bound"},
      {"cone_feasibility", "0", "mcpg: tolerated negative part, as a fraction of the maximum"},
      {"cone_ring", "1",
       "nodal, hybrid: layers of nodes around moving contact; hybrid takes more (README)"},
      {"pga_enrichment", "offline", "supremizers: decorrelated (none) | online | offline"},
      {"pga_product", "v", "they are taken in the V product or in energy: v | energy"},
      {"reference_mu", "",
       "mu of that energy, and of the hybrid cone's; default: centre of the box"},
      {"pga_tolerance", "0",
       "on max sigma (2.27); infsup: the smallest beta_HF / c_HF; 0 uses -pga_beta_fraction"},
      {"pga_beta_fraction", "0.9", "stop when beta_off >= this fraction of beta_on is sure"},
      {"pga_max_size", "0", "most supremizers; 0 is no bound"},
      {"eim_tolerance", "1e-4", "relative error of the separated operators (B.32)"},
      {"eim_normal_tolerance", "",
       "collocated: that of B^n, the rows of lambda_n (3.61a); default: -eim_tolerance"},
      {"eim_tangential_tolerance", "",
       "collocated: that of B^tau, the rows of lambda_tau (3.61b); default: -eim_tolerance"},
      {"eim_max_size", "0", "most terms; 0 is no bound"},
      {"condensed_tolerance", "1e-9",
       "rigid support: relative error of the condensed operator as a function of mu"},
      {"response_tolerance", "3e-3",
       "rigid support: responses A^-1 B^T join the modes, of further A down to this; 0: none"},
      {"multiplier_reduction", "condensed",
       "rigid support: condensed (every node) | collocated | cones | joint (README)"},
      {"multiplier_exact", "yes",
       "answers of a further reduction that break the law at some node are mended by exact steps"},
      {"tangential_tolerance", "1e-4",
       "relative error of the modes of lambda_tau (collocated), of both multipliers (joint)"},
      {"joint_extra_nodes", "4", "joint: collocation nodes beyond the number of modes"},
      {"nitsche_quadrature", "empirical",
       "Nitsche's method reduced, integrals over the curve: empirical (few points) | full | "
       "interpolated (EIM)"},
      {"nitsche_quadrature_tolerance", "0",
       "empirical: relative error that it may add to u; 0: as much as the modes leave"},
      {"nitsche_eim_tolerance", "1e-6", "interpolated: relative error over (mu, Newton step)"},
      {"nitsche_eim_validation", "",
       "interpolated: further mu, as -train, whose steps measure that error, too"},
      {"gcns_tolerance", "0", "collocated: e_GCNS at which the selection of nodes stops"},
      {"gcns_max_nodes", "0", "collocated: most collocation nodes; 0 is no bound"}};
  return options;
}

namespace {

std::string validity(const SceneOption &option) {
  return option.choices.empty() ? ", valid in " + describe(option.valid) : "";
}

/// Options, parameters and the mesh of one scene.
void print_scene(const SceneEntry &entry) {
  const Scene scene = make_scene(entry.name);
  std::printf("\nScene %s: %s\n", entry.name.c_str(), entry.summary.c_str());
  for (const SceneOption &option : entry.options)
    std::printf("  -%-24s %s [%s]%s\n", option.name.c_str(), option.help.c_str(),
                option.default_value.c_str(), validity(option).c_str());
  for (const Parameter &p : scene.parameters.all)
    std::printf("  -%-24s parameter: bounds a,b or a fixed value [%g,%g]%s, valid in %s\n",
                p.name.c_str(), p.lower, p.upper, (p.unit.empty() ? "" : " " + p.unit).c_str(),
                describe(p.valid).c_str());
  print_mesh_contract(scene);
}

} // namespace

void print_help(const std::string &scene) {
  if (!scene.empty()) {
    (void)make_scene(scene);
    for (const SceneEntry &entry : scene_catalogue())
      if (entry.name == scene) print_scene(entry);
    return;
  }
  std::printf("rbvi COMMAND -case FILE [options]        (under mpirun; one dash or two)\n"
              "  offline   snapshots, bases, interpolation, reduced model into -out\n"
              "  verify    reduced against high-fidelity over the validation set\n"
              "  solve     one high-fidelity solve at -mu\n"
              "  bench     run time against error\n"
              "  list      the scenes of this build\n"
              "  inspect FILE   what a model file holds\n"
              "  -help -scene NAME   options, parameters and mesh of one scene\n\n"
              "Options [default]:\n");
  for (const OptionHelp &option : tool_options())
    std::printf("  -%-24s %s%s\n", option.name.c_str(), option.help.c_str(),
                option.default_value.empty() ? "" : (" [" + option.default_value + "]").c_str());
  for (const SceneEntry &entry : scene_catalogue())
    print_scene(entry);
  std::printf("\nOutputs (columns of tables):\n");
  for (const OutputColumn &column : output_columns())
    std::printf("  %-25s %s\n", column.name, column.says);
  std::printf(
      "\nPETSc options: -hf_ksp_*, -hf_pc_* (stiffness), -vi_snes_* (vi), -v_ksp_*, -v_pc_*\n"
      "(Riesz representers), -nitsche_snes_*, -nitsche_ksp_*, -nitsche_pc_*, -log_view, ...\n"
      "SLEPc options: -pga_eps_*, -pga_svd_* (offline: the projected greedy), -infsup_svd_*,\n"
      "-infsup_eps_* (verify: inf-sup constants; eps: beta_HF of many multipliers)\n"
      "Exit status: 0 done, 1 it failed or some samples did, 2 the input is wrong (nothing is\n"
      "written), 128 + signal it was stopped: the same command goes on.\n");
}

} // namespace rbvi
