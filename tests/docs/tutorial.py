#!/usr/bin/env python3
"""tutorial.py PAGE BIN SCRATCH: runs a tutorial as it stands.

YAML on the page is appended to the case file, lines that begin with "$ " are run (programs are those
in BIN), and what the page prints below one must stand in its output in this order: words as they
are, numbers to 1e-6; "..." stands for any lines. It also counts what a reader types.
"""

import os
import re
import shutil
import subprocess
import sys
import time
from pathlib import Path

MOST_COMMANDS, MOST_LINES = 6, 30
NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:e[-+]?\d+)?")


def blocks_of(page):
    """Kind and lines of each fenced block."""
    return [(kind, text.splitlines()) for kind, text in
            re.findall(r"^```(\w*)\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)]


def is_like(printed, shown):
    """A line of the page is the beginning of one that is printed."""
    if NUMBER.sub("#", shown).split() != NUMBER.sub("#", printed).split()[:len(shown.split())]:
        return False
    pairs = zip(NUMBER.findall(shown), NUMBER.findall(printed))
    return all(abs(float(a) - float(b)) <= 1e-6 * max(abs(float(a)), 1e-3) for a, b in pairs)


def missing_line(shown, printed, like=is_like):
    """The first line of the page that is not where it should be; nothing if all are."""
    lines, anywhere = iter(printed), False
    for line in shown:
        if line.strip() == "...":
            anywhere = True
            continue
        for found in lines:
            if like(found, line):
                break
            if not anywhere:
                return line
        else:
            return line
        anywhere = False
    return None


def run(lines, scratch, environment, like=is_like):
    """The number of commands of a block that print its lines; nothing where one does not."""
    commands = [k for k, line in enumerate(lines) if line.startswith("$ ")]
    for begin, end in zip(commands, commands[1:] + [len(lines)]):
        done = subprocess.run(lines[begin][2:], shell=True, cwd=scratch, env=environment, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        line = missing_line(lines[begin + 1:end], done.stdout.splitlines(), like)
        if done.returncode != 0 or line is not None:
            print(f"{lines[begin]}\nends with {done.returncode}, and lacks: {line}\n{done.stdout}")
            return None
    return len(commands)


def main(page, programs, scratch):
    shutil.rmtree(scratch, ignore_errors=True)
    scratch.mkdir(parents=True)
    (scratch / "cases").symlink_to(page.resolve().parent)
    environment = dict(os.environ, PATH=f"{programs}:{os.environ['PATH']}")
    commands = typed = 0
    start = time.monotonic()
    for kind, lines in blocks_of(page.read_text(encoding="utf-8")):
        if kind == "yaml":
            with open(scratch / "block/case.yaml", "a", encoding="utf-8") as case:
                case.write("\n" + "\n".join(lines) + "\n")
            typed += len(lines)
            continue
        count = run(lines, scratch, environment)
        if count is None:
            return 1
        commands += count
    print(f"{commands} commands, {commands + typed} typed lines, {time.monotonic() - start:.1f} s")
    return 0 if 0 < commands <= MOST_COMMANDS and commands + typed <= MOST_LINES else 1


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), Path(sys.argv[2]).resolve(), Path(sys.argv[3])))
