#!/usr/bin/env python3
"""shell_pages.py ROOT RBVI: what bash completes by cases/shell_pages.py; groff, where it is there, finds no
fault in its manual page."""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path


def completed(script, program, *words):
    """What bash offers for the last word."""
    line = " ".join(f"'{word}'" for word in (program, *words))
    ask = (f"source {script}; COMP_WORDS=({line}); COMP_CWORD={len(words)}; "
           f"$(complete -p {program} | sed 's/.*-F \\([^ ]*\\) .*/\\1/'); printf '%s\\n' \"${{COMPREPLY[@]}}\"")
    return subprocess.run(["bash", "-euc", ask], check=True, capture_output=True, text=True).stdout.split()


def main(root, rbvi):
    with tempfile.TemporaryDirectory() as folder:
        for page in ("completion", "man"):
            with open(Path(folder) / page, "w", encoding="utf-8") as file:
                subprocess.run([sys.executable, Path(root) / "cases/shell_pages.py", rbvi, page], check=True,
                               stdout=file)
        check(Path(folder) / "completion", Path(folder) / "man")


def check(script, page):
    assert completed(script, "rbvi", "off") == ["offline"]
    assert {"check", "compare"} == set(completed(script, "rbvi", "c"))
    assert "-pod_tolerance" in completed(script, "rbvi", "offline", "-pod")
    assert completed(script, "rbvi", "solve", "-pod") == []
    assert "uzawa" in completed(script, "rbvi", "solve", "-hf_method", "")
    assert completed(script, "rbvi", "offline", "cases") == [], "names of files are bash's own"
    assert completed(script, "rbvi-online", "model.h5", "--qu") == ["--queries"]
    text = page.read_text()
    for part in (".SH NAME", "\\-pod_tolerance", "\\-\\-queries", "rbvi offline"):
        assert part in text, part
    if shutil.which("groff"):
        told = subprocess.run(["groff", "-man", "-Tutf8", "-ww", "-z", page], capture_output=True, text=True)
        assert told.returncode == 0 and not told.stderr, told.stderr


if __name__ == "__main__":
    main(*sys.argv[1:])
