"""Runs of programs from several threads at once."""

import os
import subprocess
import tempfile
import threading
from pathlib import Path


def run_program(command):
    """As subprocess.run, with output as text. Open MPI's files are in a directory of the thread: runs that begin and
    end at the same time can trip over one that they share."""
    base = os.environ.get("OMPI_MCA_orte_tmpdir_base", tempfile.gettempdir())
    own = Path(base) / threading.current_thread().name.rpartition("_")[2]
    own.mkdir(parents=True, exist_ok=True)
    return subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False,
                          env={**os.environ, "OMPI_MCA_orte_tmpdir_base": str(own)})
