#!/usr/bin/env python3
"""shell_pages.py RBVI completion|man: what bash completes, and the manual page, from what
`RBVI -help -json` prints, on standard output. cmake --install installs both.

    source <(python3 cases/shell_pages.py build/bin/rbvi completion)
    man -l <(python3 cases/shell_pages.py build/bin/rbvi man)
"""

import json
import subprocess
import sys

COMPLETION = """\
# What bash completes behind rbvi and rbvi-online: shell_pages.py makes this of their options.

_rbvi_words() {{
  mapfile -t COMPREPLY < <(compgen -W "$1" -- "${{COMP_WORDS[COMP_CWORD]}}")
}}

_rbvi() {{
  COMPREPLY=()
  if ((COMP_CWORD == 1)); then
    _rbvi_words "{commands} help -help -version"
    return
  fi
  case ${{COMP_WORDS[COMP_CWORD-1]}} in
{choices}
  esac
  [[ ${{COMP_WORDS[COMP_CWORD]}} == -* ]] || return 0
  case ${{COMP_WORDS[1]}} in
{options}
  esac
}}

_rbvi_online() {{
  COMPREPLY=()
  [[ ${{COMP_WORDS[COMP_CWORD]}} == -* ]] || return 0
  _rbvi_words "{online}"
}}

complete -o default -F _rbvi rbvi
complete -o default -F _rbvi_online rbvi-online
"""

MANUAL = """\
.\\" shell_pages.py makes this of the options of rbvi.
.TH RBVI 1 "" rbvi "User commands"
.SH NAME
rbvi, rbvi\\-online \\- reduced bases for variational inequalities: obstacle and contact problems
.SH SYNOPSIS
.B rbvi
.I COMMAND
[\\fIoptions\\fR]
.br
.B rbvi\\-online
.I MODEL
[\\fIoptions\\fR]
.SH DESCRIPTION
rbvi solves parametrised problems of contact, and makes reduced models of their answers, which
rbvi\\-online asks. rbvi runs under mpirun, rbvi\\-online without it. Options have one or two dashes.
.SH COMMANDS
{commands}.SH OPTIONS OF RBVI
Each can stand in the case file below \\fIoptions:\\fR, too. Options of a case:
.BR "rbvi \\-help \\-case FILE" .
{options}.SH OPTIONS OF RBVI-ONLINE
{online}.SH EXIT STATUS
0: done. 1: it failed, or some samples did. 2: the input is wrong, and nothing was written.
128 + signal: it was stopped, and the same command goes on.
"""

# The option of a command that reads no case.
WITHOUT_CASE = {"compare": "-csv", "new": "-mesh"}


def completion(dump):
    def rows(cases):
        return "\n".join(f"    {name}) _rbvi_words \"{' '.join(words)}\"{end} ;;" for name, words, end in cases)

    choices = [("-" + option["name"], [choice["name"] for choice in option["choices"]], "; return")
               for option in dump["options"] if option["choices"]]
    options = [(command["name"], ["-" + name for name in command["options"]] or [WITHOUT_CASE.get(command["name"], "-help")], "")
               for command in dump["commands"]]
    return COMPLETION.format(commands=" ".join(command["name"] for command in dump["commands"]),
                             choices=rows(choices), options=rows(options),
                             online=" ".join("--" + option["name"] for option in dump["online"]))


def roff(text):
    """As words of a line that is no request."""
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + text if text[:1] in (".", "'") else text


def tagged(tag, text):
    return f".TP\n.B {roff(tag)}\n{roff(text)}\n"


def manual(dump):
    options = group = ""
    for option in dump["options"]:
        if option["group"] != group:
            group = option["group"]
            options += f".SS {roff(group)}\n"
        values = ", ".join(choice["name"] for choice in option["choices"]) or option["values"]
        default = f" [{option['default']}]" if option["default"] else ""
        options += tagged("-" + option["name"], f"{option['help']}: {values}{default}")
    return MANUAL.format(
        commands="".join(tagged(command["usage"], command["does"]) for command in dump["commands"]),
        options=options,
        online="".join(tagged(f"--{option['name']} {option['values']}".strip(), option["help"])
                       for option in dump["online"]))


def main(rbvi, page):
    dump = json.loads(subprocess.run([rbvi, "-help", "-json"], check=True, capture_output=True).stdout)
    sys.stdout.write({"completion": completion, "man": manual}[page](dump))


if __name__ == "__main__":
    main(*sys.argv[1:])
