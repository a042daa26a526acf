// The page cases/OPTIONS.md.
#include "../database.hpp"
#include "../table.hpp"

#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/rom/online_tool.hpp"

#include <algorithm>

namespace rbvi {

namespace {

constexpr const char *introduction = R"(# Options

This page is printed by `rbvi -help -markdown`.

Every option of rbvi can stand in the case file or on the command line, which wins, with one or two
dashes. A case file is YAML: one `name: value` per line, without the dash; bounds may be a list
`[0.16, 0.24]`. File names in it are looked for beside it, then in the working directory. An unknown
name is an error, a name that stands there twice, too. A flag without a value means yes. Numbers in
brackets are equations of Niakh (2022).
)";

constexpr const char *of_scenes = R"(
## Scenes

Each scene has options and parameters of its own. A parameter is an option, too: two bounds
`-radius 0.18,0.22` free it, one value `-radius 0.2` fixes it; `-parameters` names those that are
free. No box, no value and no query leaves the range of validity. `rbvi -help -scene NAME` prints
what a mesh for the scene must have, too.
)";

constexpr const char *of_petsc = R"(
## PETSc and SLEPc

Options of their objects work under these prefixes: `-hf_pc_type`, `-nitsche_snes_monitor`,
`-pga_eps_view`, ... One that a solver would read and not follow is refused, and so is one that
nothing of the run asks for; SLEPc's of another command may stand in a case file.
)";

constexpr const char *of_petsc_more = R"(
Linear solvers are direct; iterative ones (`-hf_ksp_type cg`) have rtol 1e-12. `-nitsche_snes_rtol`
[1e-12] is that of the residual relative to its terms. Of PETSc itself, `-log_view` shows one stage
per step.

SLEPc solves the eigenproblems of the projected greedy, and the one singular value decomposition
that replaces them where b only scales. Each rank has objects of its own for the parameters that are its
share, of type lapack: it returns all pairs of a small matrix, which iterative types do not do for
clustered values (fewer than all are an error). `-infsup_eps_` alone is iterative: where that is
faster (m^3 > 1e5 n for m multipliers and n displacement dofs) beta_HF is the smallest eigenvalue of
B V^-1 B^T x = beta^2 W x by inverse iteration, with one factorisation of [V B^T; B 0] for each
parameter (the other constants still need a dense matrix of the size of the contact dofs).
)";

constexpr const char *of_online = R"(
## rbvi-online

`rbvi-online MODEL` alone prints what the model is. Options have one or two dashes, and
`--name value` or `--name=value`.
)";

std::string code(const std::string &text) {
  return std::string("`").append(text).append("`");
}

std::string row(const std::vector<std::string> &cells) {
  std::string text = "|";
  for (const std::string &cell : cells) {
    text += cell.empty() ? "" : " ";
    for (const char c : cell)
      text += c == '|' ? std::string("\\|") : std::string(1, c);
    text += " |";
  }
  return text + "\n";
}

/// The first two lines of a table, behind an empty one.
std::string head(const std::vector<std::string> &cells) {
  std::string text = "\n";
  text.append(row(cells)).append("|");
  for (std::size_t i = 0; i < cells.size(); ++i)
    text += "---|";
  return text + "\n";
}

std::string option_row(const Option &option) {
  std::vector<std::string> names;
  for (const Choice &choice : option.choices)
    names.push_back(code(choice.name));
  return row({code("-" + option.name), option.default_value,
              names.empty() ? option.values : joined(names), option.help});
}

const std::vector<std::string> option_head{"option", "default", "values", ""};

/// What each choice of an option means.
std::string explained(const Option &option) {
  if (option.choices.empty()) return "";
  std::string text = head({code("-" + option.name), ""});
  for (const Choice &choice : option.choices)
    text += row({code(choice.name), choice.is});
  return text;
}

std::string tables_of_groups() {
  std::string text, after, group;
  for (const Option &option : tool_options()) {
    if (option.group != group) {
      text += after + "\n## " + option.group + "\n" + head(option_head);
      group = option.group;
      after.clear();
    }
    text += option_row(option);
    after += explained(option);
  }
  return text + after;
}

std::string table_of_parameters(const SceneEntry &entry) {
  std::string text =
      head({"parameter", "unit", "box", "value while fixed", "range of validity", ""});
  for (const auto &[p, choice] : parameters_of(entry))
    text += row({code("-" + p.name), p.unit, describe(Range{p.lower, p.upper}),
                 short_number(p.value), describe(p.valid), choice.empty() ? "" : "with " + choice});
  const Scene scene = make_scene(entry.name);
  return text + "\nFree by default: " + names_of(scene.parameters) + "; `-train " + scene.training +
         "`, `-valid " + scene.validation + "`.\n";
}

std::string section_of(const SceneEntry &entry) {
  std::string text = "\n### " + entry.name + "\n\n" + entry.summary + ".\n" + head(option_head);
  for (const SceneOption &option : entry.options)
    text += option_row(described(option));
  return text + table_of_parameters(entry);
}

std::string table_of_prefixes() {
  std::string text = head({"prefix", "of"});
  for (const SolverPrefix &solver : solver_objects()) {
    std::vector<std::string> kinds;
    for (const std::string &kind : solver.kinds)
      kinds.push_back(code(std::string("-").append(solver.prefix).append(kind)));
    text += row({joined(kinds), solver.of});
  }
  return text;
}

} // namespace

std::string options_page() {
  std::string text = introduction + tables_of_groups() + of_scenes;
  for (const SceneEntry &entry : scene_catalogue())
    text += section_of(entry);
  text += of_petsc + table_of_prefixes() + of_petsc_more + of_online;
  text += head({"option", "value", ""});
  for (const OnlineOption &option : online_options())
    text += row({code("--" + option.name), option.values, option.help});
  return text;
}

} // namespace rbvi
