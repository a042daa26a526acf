// -help.
#include "database.hpp"
#include "rbvi/core/outputs.hpp"
#include "rbvi/tool/cases.hpp"
#include "table.hpp"

#include <cstdio>

namespace rbvi {

namespace {

std::string what_is(const MeshRecipe &recipe, const std::string &part) {
  for (const MeshFact &fact : recipe.facts)
    if (fact.part == part) return fact.is;
  return "";
}

/// One line per part of the mesh.
std::string contract(const Scene &scene) {
  const MeshRecipe &recipe = scene.mesh;
  std::string text;
  const auto add = [&](const std::string &part, const char *kind) {
    std::array<char, 40> head{};
    std::snprintf(head.data(), head.size(), "    %-16s %-11s", part.c_str(), kind);
    text += head.data() + what_is(recipe, part == "(all)" ? "" : part) + "\n";
  };
  add("(all)", scene.dim == 2 ? "triangles" : "tetrahedra");
  for (const std::string &name : recipe.regions)
    add(name, "region");
  for (const std::string &name : recipe.boundaries)
    add(name, "boundary");
  return text;
}

/// "name  help: choices [default], values". `range`: what stands before the range of a number.
void print_line(const Option &option, const std::string &range) {
  std::string line = option.help;
  for (std::size_t i = 0; i < option.choices.size(); ++i)
    line += (i == 0 ? ": " : " | ") + option.choices[i].name;
  if (!option.default_value.empty()) line += " [" + option.default_value + "]";
  if (option.kind == OptionKind::number || option.kind == OptionKind::integer)
    line += range + option.values;
  std::printf("  -%-28s %s\n", option.name.c_str(), line.c_str());
}

/// Options, parameters and the mesh of one scene.
void print_scene(const SceneEntry &entry) {
  std::printf("\nScene %s: %s\n", entry.name.c_str(), entry.summary.c_str());
  for (const SceneOption &option : entry.options)
    print_line(described(option), ", valid in ");
  for (const auto &[parameter, choice] : parameters_of(entry))
    print_line(described(parameter),
               choice.empty() ? ", valid in " : ", with " + choice + ", valid in ");
  for (const auto &[variant, says] : entry.variants)
    std::printf("  -variant %-20s %s\n", variant.c_str(), says.c_str());
  print_mesh_contract(entry);
}

/// `command` "": of all.
void print_options(const std::string &command = "") {
  std::printf("Options [default], range:\n");
  std::string group;
  for (const Option &option : tool_options()) {
    if (!command.empty() && !serves(option, command)) continue;
    if (option.group != group) std::printf(" %s\n", (group = option.group).c_str());
    print_line(option, ", ");
  }
}

void print_command(const Command &command) {
  std::printf("%s\n  %s\n", command.usage.c_str(), command.does.c_str());
  if (!command.options) return;
  print_options(command.name);
  std::printf("Those of a case: rbvi -help -case FILE; of PETSc's objects, outputs: rbvi -help\n");
}

void print_solver_objects() {
  std::printf("\nOptions of PETSc's and SLEPc's objects (and -log_view, ...):\n");
  for (const SolverPrefix &solver : solver_objects()) {
    std::string all;
    for (const std::string &kind : solver.kinds)
      all.append(all.empty() ? "-" : ", -").append(solver.prefix + kind + "*");
    std::printf("  %s: %s\n", all.c_str(), solver.of.c_str());
  }
}

} // namespace

void print_mesh_contract(const SceneEntry &entry) {
  const Scene scene = make_scene(entry);
  const std::string own = contract(scene);
  std::printf("  %s (Gmsh 2.2, 4.0 or 4.1, order 1) has these parts as physical groups.\n%s%s",
              scene.mesh.generator.empty() ? "The mesh of the case, mesh: file or -mesh FILE"
                                           : "A mesh of your own, -mesh FILE",
              scene.mesh.facts.empty()
                  ? ""
                  : "  Its vertices are where it says below, to a millionth of its size, and its\n"
                    "  edges run along the rims of regions:\n",
              own.c_str());
  for (const auto &[choice, other_scene] : variants(entry))
    if (const std::string other = contract(other_scene); other != own)
      std::printf("  With %s:\n%s", choice.c_str(), other.c_str());
}

void print_help(const Registry &registry, const std::string &scene, const std::string &command) {
  for (const SceneEntry &own : registry)
    if (own.name == scene) return print_scene(own);
  if (!scene.empty()) return print_scene(scene_of_file(MPI_COMM_SELF, scene));
  for (const Command &known : commands())
    if (known.name == command) return print_command(known);
  std::printf("rbvi COMMAND -case FILE [options]        (under mpirun; one dash or two)\n");
  for (const Command &known : commands())
    std::printf("  %-21s %s\n", known.name.c_str(), known.does.c_str());
  if (command == "help") {
    std::printf(
        "COMMAND -help: options of a command; -help -case FILE: those of a case, and its mesh; "
        "-help: all\n");
    return;
  }
  std::printf(
      "  COMMAND -help         usage and options of a command\n"
      "  -help -case FILE      options, parameters and mesh of a case\n"
      "  -help -json           options, keys of case files and scenes, for programs; explained\n"
      "                        by the page cases/OPTIONS.md\n\n");
  print_options();
  for (const SceneEntry &entry : registry)
    print_scene(entry);
  std::printf("\nOutputs (columns of tables):\n");
  for (const OutputColumn &column : output_columns())
    std::printf("  %-25s %s\n", column.name.c_str(), column.says);
  print_solver_objects();
  std::printf(
      "\nExit status: 0 done, 1 it failed or some samples did, 2 the input is wrong (nothing is\n"
      "written), 128 + signal it was stopped: the same command goes on.\n");
}

} // namespace rbvi
