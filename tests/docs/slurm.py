#!/usr/bin/env python3
"""slurm.py ROOT: which programs mpi-scripts/sweep.slurm starts, by a SLURM of two shell scripts: from
any folder, a run directory for each case."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

SRUN = '#!/bin/sh\necho "$@"\n'
SCONTROL = '#!/bin/sh\necho "   Command={script} some options"\n'


def program(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    path.chmod(0o755)


def main(root):
    with tempfile.TemporaryDirectory() as scratch:
        scratch = Path(scratch)
        project, elsewhere, spool = (scratch / name for name in ("project", "else where", "spool"))
        script = project / "mpi-scripts/sweep.slurm"
        program(script, (Path(root) / "mpi-scripts/sweep.slurm").read_text())
        program(spool / "slurm_script", script.read_text())
        program(scratch / "bin/srun", SRUN)
        program(scratch / "bin/scontrol", SCONTROL.format(script=script))
        for name in ("disk", "membrane_obstacle"):
            (project / "cases" / name).mkdir(parents=True)
            (project / "cases" / name / "case.yaml").write_text("rbvi: 1\n")
        elsewhere.mkdir()
        (elsewhere / "own.yaml").write_text("rbvi: 1\n")

        def started(*arguments, folder=elsewhere, **more):
            environment = {**os.environ, "PATH": f"{scratch}/bin:/usr/bin:/bin", "SLURM_JOB_ID": "7",
                           "SLURM_SUBMIT_DIR": str(folder), **more}
            environment.pop("RBVI", None) if "RBVI" not in more else None
            ended = subprocess.run([spool / "slurm_script", *arguments], cwd=spool, env=environment,
                                   capture_output=True, text=True)
            return ended.returncode, ended.stdout.splitlines(), ended.stderr

        status, _, words = started()
        assert status == 2 and len(words.splitlines()) == 1, words
        rbvi = project / "build/bin/rbvi"
        program(rbvi, SRUN)

        def expect(arguments, case, run, *options, **more):
            of = more.get("RBVI", str(rbvi))
            wanted = [f"{of} offline -case {case} -out {run}" + "".join(" " + word for word in options),
                      f"{of} verify -out {run}"]
            assert started(*arguments, **more) == (0, wanted, ""), (started(*arguments, **more), wanted)

        expect((), project / "cases/membrane_obstacle", "run/membrane_obstacle")
        expect(("own.yaml",), "own.yaml", "run/own")
        disk = project / "cases/disk"
        for case in (str(disk), f"{disk}/case.yaml", f"{disk}/"):
            expect((case,), case, "run/disk")
        expect(("case.yaml", "here", "-train", "4"), "case.yaml", "here", "-train", "4", folder=disk)
        expect(("case.yaml",), "case.yaml", "run/disk", folder=disk)
        expect((".",), ".", "run/disk", folder=disk)
        expect(("own.yaml",), "own.yaml", "run/own", RBVI=str(scratch / "bin/srun"))


if __name__ == "__main__":
    main(sys.argv[1])
