#!/usr/bin/python3
"""refuses_all.py WORK: the stress table fails a program that refuses everything, each row of it that was answered."""

import subprocess
import sys
from pathlib import Path

STRESS = Path(__file__).resolve().parent / "stress.py"


def main(work):
    programs = work / "bin"
    programs.mkdir(parents=True, exist_ok=True)
    for name in ("rbvi", "rbvi-online"):
        (programs / name).write_text("#!/bin/sh\necho 'rbvi: no' >&2\nexit 1\n", encoding="ascii")
        (programs / name).chmod(0o755)
    done = subprocess.run([sys.executable, STRESS, programs, work / "runs", "--only", "solves", "patch one"],
                          capture_output=True, text=True, check=False)
    if done.returncode == 77:
        return 77
    told = done.stdout.count("is refused, and was answered")
    same = done.stdout.count("\nsame ")
    print(done.stdout[-400:] + done.stderr)
    return 0 if done.returncode == 1 and told > 5 and same == 0 else 1


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]).resolve()))
