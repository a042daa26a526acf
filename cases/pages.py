#!/usr/bin/env python3
"""pages.py RBVI options|schema|keys [--write]: the pages that `RBVI -help -json` is the source of.

    python3 cases/pages.py build/bin/rbvi options > cases/OPTIONS.md
    python3 cases/pages.py build/bin/rbvi schema > cases/case.schema.json
    python3 cases/pages.py build/bin/rbvi keys --write

The first two are printed. Of CASE_FILE.md the tables of keys alone are made, between the text that stands
there: without --write they are compared, and the exit status is 1 where one is another. To be run where
the folder cases is.
"""

import json
import re
import subprocess
import sys
from pathlib import Path

CASE_FILE = Path(__file__).resolve().parent / "CASE_FILE.md"
OF_SOLIDS = ("surfaces", "sphere", "cylinder", "cone")  # tables that stand in their section
KEYS = re.compile(r"(<!-- keys of (.*?) -->\n).*?(<!-- end of the keys -->)", re.DOTALL)

INTRODUCTION = """\
# Options

This page is written by [pages.py](pages.py) from what `rbvi -help -json` prints.

Every option of rbvi can stand in the case file, below `options:`, or on the command line, with one or
two dashes; if it stands in both, the command line wins. Options in PETSc's own files (`~/.petscrc`, `.petscrc`,
`petscrc`) and variables (`PETSC_OPTIONS`) come last: they are told, and `-skip_petscrc` leaves out the
files. `-case` also takes a file of options alone, one `name: value` per line without the dash, that
begins with `case: FILE` (a run leaves such a file in its directory); two bounds may be a list `[0.16,
0.24]`. File names in a file are looked for beside it, then in the working directory. An unknown name, a name that stands there twice, and on the command line one without effect, is an error.
A flag without a value means yes.

The words of this page are explained where a group of options begins, and in the
[glossary](GLOSSARY.md). Numbers in brackets are equations of Niakh (2022): u is the
displacement, lambda the multipliers (pressure and friction stress), A and B are the matrices of the
forms a and b, and mu is a parameter, the list of all numbers that vary.
"""

# What the words mean that the options of a group use.
GROUPS = {
    "Run": """
A run has a directory. `offline` solves the full (high-fidelity) problem at the parameters of a
training set and makes a reduced model of the answers; `verify` compares the model with full answers
at a validation set; `bench` measures times; `solve` solves the full problem once.
""",
    "High-fidelity solver": """
The full problem is solved by a method that finds out where the bodies touch. Eliminating the
displacement leaves a problem for the multipliers alone, with the matrix B A^-1 B^T: that problem is
called condensed.
""",
    "Large deformations": """
With `-kinematics large` the condition of contact depends on the displacement. It is then linearised,
solved, and linearised again at the new state, until neither u nor the multipliers change.
""",
    "Sweep": """
The full problem is solved at all parameters of a set. The MPI ranks form groups; each group takes the
next parameter from one queue.
""",
    "Bases": """
The displacement is combined from a few modes (POD of the snapshots, which are the full answers at the
training parameters). Pressures must not be negative: where multipliers are reduced, they are combined
with coefficients >= 0 from the functions of a dual basis; what these can form is a cone.
""",
    "Stability": """
A pair of bases determines the pressure only if its inf-sup constant beta is positive. Supremizers are
displacements that join the modes for that purpose. beta_HF is the constant of the full problem,
beta_on that with the supremizers of each parameter, beta_off that with one set for all parameters;
sigma is the largest distance of the supremizers of a parameter to that set. Multipliers that are
reduced to a cone need supremizers; the law at every node and Nitsche's method do not.
""",
    "Separation": """
Matrices and vectors that depend on mu are separated: written as short sums of fixed terms times
functions of mu, exactly where the scene says how, otherwise by empirical interpolation (EIM).
""",
    "Multipliers": """
The law is the set of conditions at a node: no penetration, no tension, and with friction a bound on the
tangential stress. lambda_n are the normal multipliers, lambda_tau the tangential ones. A displacement under
a unit load is A^-1 B^T e, what a load of 1 on one multiplier causes. `collocated` holds the bound of
friction at its collocation nodes alone.
""",
    "Nitsche's method": """
With `-formulation nitsche` contact and friction are terms of one equation for u, without multipliers.
Newton's method solves it; a reduced model integrates these terms by one of three rules.
""",
}

OF_CASES = """
## Case files

The keys of a case file have [a page of their own](CASE_FILE.md).
"""

OF_SCENES = """
## Scenes

Each scene has options and parameters of its own. A parameter is an option, too: with two bounds,
`-radius 0.18,0.22`, it is free and varies between them, with one value, `-radius 0.2`, it is fixed;
`-parameters` names those that are free. The bounds of all free parameters are the box of a model. No
box, no value and no query may leave the range of validity. `rbvi -help -case FILE` also prints what a
mesh for the scene must have.

Some scenes share options, which their case files define. `-degree` is that of the finite elements for the
displacement. `-lumped yes` takes the contact integrals b and g by values at the vertices alone (vertex
quadrature). `-formulation` writes contact with multipliers (mixed) or without them, by Nitsche's method
(nitsche). In a case of your own these are the keys `degree`, `lumped` and `formulation`.
"""

OF_PETSC = """
## PETSc and SLEPc

The solvers of PETSc and SLEPc take their own options behind these prefixes: `-hf_pc_type`,
`-nitsche_snes_monitor`, `-pga_eps_view`, ... An option is refused if a solver would read it and not
follow it, or if nothing in the run reads it. A case file may hold SLEPc's options of another command.
Which of SLEPc's objects are needed is known in the end: a warning names options of the others.
"""

OF_PETSC_MORE = """
Linear solvers are direct; iterative ones (`-hf_ksp_type cg`) have rtol 1e-13, that of `vi` 1e-12.
`-nitsche_snes_rtol` [1e-12] is that of the residual relative to its terms at the start. Of PETSc itself, `-log_view`
shows one stage per step; its own options are for the command line alone.

SLEPc solves the eigenproblems of the projected greedy algorithm. If b(mu) is a multiple of one fixed
form (rbvi says B(mu) = s(mu) B), one singular value decomposition replaces them all. Each rank has objects of its
own for its share of the parameters, of type lapack: this type returns all pairs of a small matrix,
which iterative types do not do for clustered values (fewer than all are an error). `-infsup_eps_` alone
is iterative, by objects of all ranks: where that is faster (m^3 > 1e5 n for m multipliers and n
displacement dofs) beta_HF and c_HF are the smallest and the largest eigenvalue of
B V^-1 B^T x = beta^2 W x, with one factorisation of V for all parameters and one of [V B^T; B 0] for
each, both over the ranks, and without a dense matrix. `-infsup_svd_` is of the same two constants
elsewhere, and of all others: these take a dense matrix of the size of the contact dofs, but for verify
where beta_HF is iterated and B(mu) = s(mu) B.
"""

OF_ONLINE = """
## rbvi-online

`rbvi-online MODEL` alone prints what the model is. Options have one or two dashes, and
`--name value` or `--name=value`.
"""

OPTION_HEAD = ["option", "default", "values", ""]


def code(text):
    return f"`{text}`"


def row(cells):
    return "|" + "".join((" " if cell else "") + cell.replace("|", "\\|") + " |" for cell in cells) + "\n"


def head(cells):
    return "\n" + row(cells) + "|" + "---|" * len(cells) + "\n"


def option_row(option):
    names = ", ".join(code(choice["name"]) for choice in option["choices"])
    return row([code("-" + option["name"]), option["default"], names or option["values"], option["help"]])


def explained(option):
    """What each choice of an option means."""
    if not option["choices"]:
        return ""
    return head([code("-" + option["name"]), ""]) + "".join(
        row([code(choice["name"]), choice["is"]]) for choice in option["choices"])


def tables_of_groups(options):
    text = after = group = ""
    for option in options:
        if option["group"] != group:
            group = option["group"]
            text += after + f"\n## {group}\n" + GROUPS.get(group, "") + head(OPTION_HEAD)
            after = ""
        text += option_row(option)
        after += explained(option)
    return text + after


def table_title(table):
    """contact.*.friction -> `contact: NAME: friction:`"""
    if not table:
        return "At the top"
    return code(" ".join(("NAME" if part == "*" else part) + ":" for part in table.split(".")))


def tables_of_keys(keys):
    text, table = "", None
    for key in keys:
        if key["table"] != table:
            table = key["table"]
            text += f"\n{table_title(table)}\n" + head(["key", "value", ""])
        says = "; ".join(part for part in (key["says"], "needed" if key["needed"] else "") if part)
        text += row([code("NAME" if key["name"] == "*" else key["name"]),
                     key["value"].replace("|", "or"), says])
    return text


def refreshed_keys(page, keys):
    """The page with the tables of the keys of each section between its marks."""
    sections = {}
    for key in keys:
        of_solids = any(part in OF_SOLIDS for part in key["table"].split("."))
        name = "solids" if of_solids else key["table"].split(".")[0] or "the top"
        sections.setdefault(name, []).append(key)
    told = KEYS.findall(page)
    if sorted(name for _, name, _ in told) != sorted(sections):
        sys.exit(f"{CASE_FILE.name} has marks for the keys of {', '.join(name for _, name, _ in told)}; "
                 f"the sections are {', '.join(sections)}")
    return KEYS.sub(lambda mark: mark[1] + tables_of_keys(sections[mark[2]]) + "\n" + mark[3], page)


def section_of(scene):
    text = f"\n### {scene['name']}\n\n{scene['summary']}.\n"
    if scene["options"]:
        text += head(OPTION_HEAD) + "".join(map(option_row, scene["options"]))
    text += head(["parameter", "unit", "box", "value while fixed", "range of validity", ""])
    for p in scene["parameters"]:
        text += row([code("-" + p["name"]), p["unit"], p["box"], p["value"], p["valid"],
                     "with " + p["with"] if p["with"] else ""])
    return text + (f"\nFree by default: {scene['free']}; `-train {scene['training']}`, "
                   f"`-valid {scene['validation']}`.\n")


def table_of_solvers(solvers):
    return head(["prefix", "of"]) + "".join(
        row([", ".join(code("-" + solver["prefix"] + kind) for kind in solver["kinds"]), solver["of"]])
        for solver in solvers)


def options_page(dump):
    online = head(["option", "value", ""]) + "".join(
        row([code("--" + option["name"]), option["values"], option["help"]]) for option in dump["online"])
    return (INTRODUCTION + tables_of_groups(dump["options"]) + OF_CASES + OF_SCENES
            + "".join(map(section_of, dump["scenes"])) + OF_PETSC + table_of_solvers(dump["solvers"])
            + OF_PETSC_MORE + OF_ONLINE + online)


def json_object(members):
    """On one line if it is short, else a member on each. Values are JSON."""
    parts = [f"{json.dumps(name)}: {value}" for name, value in members]
    line = "{" + ", ".join(parts) + "}"
    if len(line) < 90 and "\n" not in line:
        return line
    return "{" + ("\n" + ",\n".join(parts)).replace("\n", "\n  ") + "\n}"


def one_of(alternatives):
    """YAML takes yes and no for words or, in its version 1.1, for what is true and false."""
    words = []
    for word in map(str.strip, alternatives.split("|")):
        words.append(word if word[0].isdigit() else json.dumps(word))
        words += {"yes": ["true"], "no": ["false"]}.get(word, [])
    return [("enum", "[" + ", ".join(words) + "]")]


def members_of(value):
    """What the words of the table of keys allow."""
    if value == "anything":
        return []
    is_open = "expression" in value or "parameter" in value
    if (" | " in value and "[" not in value and not is_open) or value == "1":
        return one_of(value)
    types = []
    if not value.startswith("[") and value != "table":
        types = ["string", "number"]
        if not value.startswith("expression") and value != "number":
            types.append("boolean")
    if "table" in value:
        types += ["object", "null"]
    if any(word in value for word in ("[", "expressions", "names", "regions", "boundaries", "list")):
        types.append("array")
    members = [("type", json.dumps(types[0] if len(types) == 1 else types))]
    if "[" in value:
        items = value[value.index("[") + 1:value.index("]")].split(",")
        members += [("items", json_object(members_of(items[0].strip()))),
                    ("minItems", len(items)), ("maxItems", len(items))]
    return members


def members_of_table(keys, table):
    """The keys of a table; those of its entries where their names are the author's."""
    entries = table + ".*"
    if any(key["table"] == entries for key in keys):
        entry = [("type", json.dumps("object"))] + members_of_table(keys, entries)
        return [("additionalProperties", json_object(entry))]
    properties, needed, others = [], [], "false"
    for key in keys:
        if key["table"] != table:
            continue
        own = members_of(key["value"])
        if key["says"]:
            own.append(("description", json.dumps(key["says"])))
        own += members_of_table(keys, (table + "." if table else "") + key["name"])
        if key["name"] == "*":
            others = json_object(own)
        else:
            properties.append((key["name"], json_object(own)))
        if key["needed"]:
            needed.append(key["name"])
    if not properties and others == "false":
        return []
    return ([("properties", json_object(properties))] * bool(properties)
            + [("required", json.dumps(needed))] * bool(needed) + [("additionalProperties", others)])


def schema(dump):
    """A JSON Schema (draft-07) of case files, which editors complete and check them by."""
    return json_object([("$schema", json.dumps("http://json-schema.org/draft-07/schema#")),
                        ("title", json.dumps("rbvi case file")), ("type", json.dumps("object"))]
                       + members_of_table(dump["keys"], "")) + "\n"


def main(rbvi, page, *words):
    dump = json.loads(subprocess.run([rbvi, "-help", "-json"], check=True, capture_output=True).stdout)
    if page != "keys":
        sys.stdout.write({"options": options_page, "schema": schema}[page](dump))
        return
    told = CASE_FILE.read_text(encoding="utf-8")
    made = refreshed_keys(told, dump["keys"])
    if words == ("--write",):
        CASE_FILE.write_text(made, encoding="utf-8")
    elif made != told:
        sys.exit("CASE_FILE.md has other keys: python3 cases/pages.py build/bin/rbvi keys --write")


if __name__ == "__main__":
    main(*sys.argv[1:])
