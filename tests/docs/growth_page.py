#!/usr/bin/env python3
"""growth_page.py ROOT: the page that cases/growth.py makes of a table has its exponents and its gaps."""

import sys
from pathlib import Path


def rows_on(refine, per_solve, stages=("mesh", "snapshots")):
    """Work like dofs^1.25, memory like dofs above what is resident."""
    dofs = 1000.0 * 4 ** refine
    row = dict.fromkeys("ranks multipliers samples modes sample_seconds iterations model_mb fields_mb "
                        "cpu_sum messages reductions solves cg_steps".split(), 2.0)
    row |= {"scene": "membrane", "refine": refine, "ranks_per_solve": per_solve, "dofs": dofs,
            "resident_mb": 50.0, "seconds": dofs ** 1.25, "memory_max_mb": 50 + 1e-3 * dofs,
            "factorisations": 7.0}
    return [row | {"stage": stage} for stage in (*stages, "total")]


def main(root):
    sys.path.insert(0, str(root / "cases"))
    from growth import exponent, page
    dofs = [100, 400, 1600]
    assert abs(exponent(dofs, [3 * n ** 1.5 for n in dofs]) - 1.5) < 1e-12
    for x, y in [([100], [1]), ([100, 100], [1, 2]), ([100, 400], [0, 2]), ([], [])]:
        assert exponent(x, y) is None, "two meshes with positive values are needed"
    text = page([row for refine in (0, 1) for per_solve in (1, 2) for row in rows_on(refine, per_solve)])
    for part in ["## 1 rank per solve", "## 2 ranks per solve", "| 1.25 |", "| 1.00 |", "| 7 / 7 |"]:
        assert part in text, f"{part} is missing:\n{text}"
    text = page(rows_on(0, 1) + rows_on(1, 1, ("mesh",)))
    assert "| 7 / - |" in text, f"a stage that did not run has no number:\n{text}"
    print("the page of growth is right")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve())
