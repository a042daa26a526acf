#!/usr/bin/env python3
"""from_python.py PAGE: the blocks of the page are run, one after another, in an empty folder; but for
those that import what is optional and not there."""

import importlib.util
import os
import re
import sys
import tempfile
from pathlib import Path

MOST_LINES = 15  # of a step
OPTIONAL = ("SALib", "openturns", "pandas")

page = Path(sys.argv[1])
text = page.read_text(encoding="utf-8")
blocks = re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)
if len(blocks) < 5:
    sys.exit(f"{page.name} has {len(blocks)} blocks")
with tempfile.TemporaryDirectory() as folder:
    os.chdir(folder)
    names = {}
    for number, block in enumerate(blocks, 1):
        if block.count("\n") > MOST_LINES:
            sys.exit(f"block {number} has more than {MOST_LINES} lines")
        missing = [name for name in OPTIONAL
                   if re.search(rf"^(import|from) {name}\b", block, re.MULTILINE)
                   and importlib.util.find_spec(name) is None]
        if missing:
            print(f"block {number} is not run: {missing[0]} is not installed")
            continue
        exec(compile(block, f"block {number} of {page.name}", "exec"), names)
    if not Path("tangential_force.png").stat().st_size:
        sys.exit("there is no picture")
    os.chdir("/")
