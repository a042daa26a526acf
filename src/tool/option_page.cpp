// The page cases/OPTIONS.md.
#include "database.hpp"
#include "table.hpp"

#include "rbvi/core/text.hpp"
#include "rbvi/core/validity.hpp"
#include "rbvi/model/online_tool.hpp"
#include "rbvi/tool/cases.hpp"

#include <algorithm>
#include <map>

namespace rbvi {

namespace {

constexpr const char *introduction = R"(# Options

This page is printed by `rbvi -help -markdown`.

Every option of rbvi can stand in the case file, below `options:`, or on the command line, with one or
two dashes; if it stands in both, the command line wins. Options in PETSc's own files (`~/.petscrc`, `.petscrc`,
`petscrc`) and variables (`PETSC_OPTIONS`) come last: they are told, and `-skip_petscrc` leaves out the
files. `-case` also takes a file of options alone, one `name: value` per line without the dash, that
begins with `case: FILE` (a run leaves such a file in its directory); two bounds may be a list `[0.16,
0.24]`. File names in a file are looked for beside it, then in the working directory. An unknown name, a name that stands there twice, and on the command line one without effect, is an error.
A flag without a value means yes.

The words of this page are explained where a group of options begins, and in the
[glossary](README.md#glossary). Numbers in brackets are equations of Niakh (2022): u is the
displacement, lambda the multipliers (pressure and friction stress), A and B are the matrices of the
forms a and b, and mu is a parameter, the list of all numbers that vary.
)";

/// What the words mean that the options of a group use.
const std::map<std::string, const char *> introductions{{"Run", R"(
A run has a directory. `offline` solves the full (high-fidelity) problem at the parameters of a
training set and makes a reduced model of the answers; `verify` compares the model with full answers
at a validation set; `bench` measures times; `solve` solves the full problem once.
)"},
                                                        {"High-fidelity solver", R"(
The full problem is solved by a method that finds out where the bodies touch. Eliminating the
displacement leaves a problem for the multipliers alone, with the matrix B A^-1 B^T: that problem is
called condensed.
)"},
                                                        {"Large deformations", R"(
With `-kinematics large` the condition of contact depends on the displacement. It is then linearised,
solved, and linearised again at the new state, until neither u nor the multipliers change.
)"},
                                                        {"Sweep", R"(
The full problem is solved at all parameters of a set. The MPI ranks form groups; each group takes the
next parameter from one queue.
)"},
                                                        {"Bases", R"(
The displacement is combined from a few modes (POD of the snapshots, which are the full answers at the
training parameters). Pressures must not be negative: where multipliers are reduced, they are combined
with coefficients >= 0 from the functions of a dual basis; what these can form is a cone.
)"},
                                                        {"Stability", R"(
A pair of bases determines the pressure only if its inf-sup constant beta is positive. Supremizers are
displacements that join the modes for that purpose. beta_HF is the constant of the full problem,
beta_on that with the supremizers of each parameter, beta_off that with one set for all parameters;
sigma is the largest distance of the supremizers of a parameter to that set. Multipliers that are
reduced to a cone need supremizers; the law at every node and Nitsche's method do not.
)"},
                                                        {"Separation", R"(
Matrices and vectors that depend on mu are separated: written as short sums of fixed terms times
functions of mu, exactly where the scene says how, otherwise by empirical interpolation (EIM).
)"},
                                                        {"Multipliers", R"(
The law is the set of conditions at a node: no penetration, no tension, and with friction a bound on the
tangential stress. lambda_n are the normal multipliers, lambda_tau the tangential ones. A response is the
displacement A^-1 B^T e that a unit load on one multiplier causes. `collocated` holds the bound of
friction at its collocation nodes alone.
)"},
                                                        {"Nitsche's method", R"(
With `-formulation nitsche` contact and friction are terms of one equation for u, without multipliers.
Newton's method solves it; a reduced model integrates these terms by one of three rules.
)"}};

constexpr const char *of_cases = R"(
## Case files

A case file (YAML) is a scene: the body, what holds, loads and touches it, and the parameters of all
that. `rbvi new NAME` writes one to begin with, `rbvi check FILE` tells every defect of one with its
line and column, and which terms are exact; with `-run` it proves the answers below `tests:`. `rbvi
-help -schema` prints these keys as a JSON Schema, for editors.

**Numbers are expressions** in parameters, in the names of `let:` and, where a point is meant, in x, y
(and nx, ny, the normal, in tractions): `+ - * / ^`, comparisons, `and or not`, `condition ? a : b`, pi,
`sqrt cbrt exp log log10 log2 sin cos tan asin acos atan sinh cosh tanh abs sign floor ceil pow atan2
min max hypot`. Quote an expression that holds `: `, `?` or, inside of `[ ]`, a comma. What occurs in a
term decides what becomes of it: where the domain does not move, or moves by a similarity (stiffness), a
term that separates into functions of parameters and of the point is exact; every other one is
interpolated. A parameter without a range is a constant, which a run may change (`-young 20`) or free
(`-young 10,30`). With `units:` a number may have a unit, and becomes one of that system: `205 GPa`;
also behind the name of a parameter, `-young '1 GPa,2 GPa'`. Numbers of a parameter without a unit are
in its `unit:`, in the file and in options, tables, queries and answers; expressions see its value in
the units of the case. Dimensions are checked as far as they are known. A parameter has a name of its
own: neither that of an option of rbvi nor a column of its tables nor a word of expressions (`pi`). `mu`
alone is allowed, as coefficients of friction go by it: `-mu` is the point, and `-mu mu=0.3` the
parameter there; it has no option.

**A path** such as `contact.support.friction` leads to a value. `-set mesh.edges=200` puts one there;
`choices:` are options of the case whose alternatives do; a variant (`-variant NAME`) does so before all
of these. An empty value takes away what is there.
)";

constexpr const char *of_scenes = R"(
## Scenes

Each scene has options and parameters of its own. A parameter is an option, too: with two bounds,
`-radius 0.18,0.22`, it is free and varies between them, with one value, `-radius 0.2`, it is fixed;
`-parameters` names those that are free. The bounds of all free parameters are the box of a model. No
box, no value and no query may leave the range of validity. `rbvi -help -case FILE` also prints what a
mesh for the scene must have.

Some scenes share options. `-degree` is that of the finite elements for the displacement. `-lumped yes`
takes the contact integrals b and g by values at the vertices alone (vertex quadrature). `-formulation`
writes contact with multipliers (mixed) or without them, by Nitsche's method (nitsche).
)";

constexpr const char *of_petsc = R"(
## PETSc and SLEPc

The solvers of PETSc and SLEPc take their own options behind these prefixes: `-hf_pc_type`,
`-nitsche_snes_monitor`, `-pga_eps_view`, ... An option is refused if a solver would read it and not
follow it, or if nothing in the run reads it. A case file may hold SLEPc's options of another command.
Which of SLEPc's objects are needed is known in the end: a warning names options of the others.
)";

constexpr const char *of_petsc_more = R"(
Linear solvers are direct; iterative ones (`-hf_ksp_type cg`) have rtol 1e-13, that of `vi` 1e-12.
`-nitsche_snes_rtol` [1e-12] is that of the residual relative to its terms at the start. Of PETSc itself, `-log_view`
shows one stage per step; its own options are for the command line alone.

SLEPc solves the eigenproblems of the projected greedy algorithm. If b(mu) is a multiple of one fixed
form ("B only scales"), one singular value decomposition replaces them all. Each rank has objects of its
own for its share of the parameters, of type lapack: this type returns all pairs of a small matrix,
which iterative types do not do for clustered values (fewer than all are an error). `-infsup_eps_` alone
is iterative, by objects of all ranks: where that is faster (m^3 > 1e5 n for m multipliers and n
displacement dofs) beta_HF and c_HF are the smallest and the largest eigenvalue of
B V^-1 B^T x = beta^2 W x, with one factorisation of V for all parameters and one of [V B^T; B 0] for
each, both over the ranks, and without a dense matrix. `-infsup_svd_` is of the same two constants
elsewhere, and of all others: these take a dense matrix of the size of the contact dofs, but for verify
where beta_HF is iterated and b only scales.
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
      const auto words = introductions.find(option.group);
      text += after + "\n## " + option.group + "\n" +
              (words == introductions.end() ? "" : words->second) + head(option_head);
      group = option.group;
      after.clear();
    }
    text += option_row(option);
    after += explained(option);
  }
  return text + after;
}

/// "contact.*.friction" -> "`contact: NAME: friction:`"
std::string table_title(const std::string &table) {
  if (table.empty()) return "At the top";
  std::string text;
  for (const std::string &part : split(table, '.'))
    text += (text.empty() ? "" : " ") + (part == "*" ? "NAME" : part) + ":";
  return code(text);
}

std::string tables_of_keys() {
  std::string text, table = "-";
  for (const CaseKey &key : case_keys()) {
    if (key.table != table)
      text.append("\n")
          .append(table_title(key.table))
          .append("\n")
          .append(head({"key", "value", ""}));
    table = key.table;
    std::string value = key.value;
    for (std::size_t at = value.find('|'); at != std::string::npos; at = value.find('|', at + 3))
      value.replace(at, 1, "or");
    text += row({code(key.name == "*" ? "NAME" : key.name), value,
                 key.says + (key.needed ? (key.says.empty() ? "needed" : "; needed") : "")});
  }
  return text;
}

std::string table_of_parameters(const SceneEntry &entry) {
  std::string text =
      head({"parameter", "unit", "box", "value while fixed", "range of validity", ""});
  for (const auto &[p, choice] : parameters_of(entry))
    text +=
        row({code("-" + p.name), p.unit, p.lower < p.upper ? describe(Range{p.lower, p.upper}) : "",
             short_number(p.value), describe(p.valid), choice.empty() ? "" : "with " + choice});
  const Scene scene = make_scene(entry);
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

std::string options_page(const Registry &registry) {
  std::string text = introduction + tables_of_groups() + of_cases + tables_of_keys() + of_scenes;
  for (const SceneEntry &entry : registry.scenes)
    text += section_of(entry);
  for (const SceneEntry &entry : cases_in("cases"))
    text += section_of(entry);
  text += of_petsc + table_of_prefixes() + of_petsc_more + of_online;
  text += head({"option", "value", ""});
  for (const OnlineOption &option : online_options())
    text += row({code("--" + option.name), option.values, option.help});
  return text;
}

} // namespace rbvi
