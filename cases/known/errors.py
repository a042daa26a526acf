#!/usr/bin/env python3
"""errors.py RBVI [CASE ...]: errors of the obstacle problems beside this file, over meshes.

Each case is solved on the mesh of 30 edges along the rim (10 of string_on_bed) and on its refinements. u is
compared with the formula in all triangles, in the norms of L2 and of H1 (that of the gradient), relative.
Without cases it writes the table of README.md, with cases it compares their rows: the exit status is 1
where a number on the page is not that of the program, or an order is less than ORDERS. Needs gmsh.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

import numpy as np  # noqa: E402
from figure_tools import read_grid  # noqa: E402

PAGE = HERE / "README.md"
HEAD = ("| case | longest edge | largest error | L2, relative | order | H1, relative | order |\n"
        "|---|---|---|---|---|---|---|\n")
LEVELS = 4
ORDERS = (1.7, 0.95)  # of L2 and of H1, at least, from the second mesh on
A = 0.5               # end of contact of all cases
# Points of a triangle and their weights, exact for polynomials of degree 4.
NEAR, FAR = 0.445948490915965, 0.091576213509771
POINTS = np.array([[1 - 2 * at if k == own else at for k in range(3)] for at in (NEAR, FAR) for own in range(3)])
WEIGHTS = np.repeat([0.223381589678011, 0.109951743655322], 3)


def round_solution(inside, beyond):
    """u and its gradient from u(r) and u'(r) inside and beyond the radius A."""
    def at(x, y):
        r = np.maximum(np.hypot(x, y), 1e-30)
        (u, slope), (far, far_slope) = inside(r), beyond(r)
        slope = np.where(r < A, slope, far_slope)
        return np.where(r < A, u, far), slope * x / r, slope * y / r
    return at


def bed(x, y):
    stiff = np.pi
    beyond = (2 * A * np.sinh(stiff * (1 - x)) / (stiff * np.cosh(stiff * (1 - A))))
    slope = -2 * A * np.cosh(stiff * (1 - x)) / np.cosh(stiff * (1 - A))
    height = A**2 + 2 * A * np.tanh(stiff * (1 - A)) / stiff
    return np.where(x < A, height - x**2, beyond), np.where(x < A, -2 * x, slope), 0 * y


TOP, CEILING = A**2 * (1 - 2 * np.log(A)), 1 - A**2 + 2 * A**2 * np.log(A)
CASES = {  # parameters, edges of the first mesh, u and its gradient
    "membrane_disk": (f"height={TOP}", 30, round_solution(
        lambda r: (TOP - r**2, -2 * r), lambda r: (-2 * A**2 * np.log(r), -2 * A**2 / r))),
    "membrane_on_floor": (f"a={A}", 30, round_solution(
        lambda r: (0 * r, 0 * r), lambda r: ((r**2 - A**2)**2, 4 * r * (r**2 - A**2)))),
    "membrane_under_ceiling": (f"load=4,ceiling={CEILING}", 30, round_solution(
        lambda r: (0 * r + CEILING, 0 * r),
        lambda r: (1 - r**2 + 2 * A**2 * np.log(r), 2 * A**2 / r - 2 * r))),
    "string_on_bed": (f"height={A**2 + 2 * A * np.tanh(np.pi * (1 - A)) / np.pi}", 10, bed),
}


def errors_of(grid, exact):
    """Longest edge; largest error at nodes; relative errors in L2 and of the gradient."""
    corners, at_corners = grid.points[grid.cells][:, :, :2], grid.of_nodes["u"][grid.cells]
    sides = corners[:, 1:] - corners[:, :1]
    areas = np.abs(np.linalg.det(sides)) / 2
    gradient = np.linalg.solve(sides, (at_corners[:, 1:] - at_corners[:, :1])[:, :, None])[:, :, 0]
    at = np.einsum("pc,ncx->npx", POINTS, corners)
    u, dx, dy = exact(at[:, :, 0], at[:, :, 1])

    def norm(squares):
        return np.sqrt(areas @ (squares @ WEIGHTS))

    value = norm((at_corners @ POINTS.T - u)**2) / norm(u**2)
    slope = norm((gradient[:, None, 0] - dx)**2 + (gradient[:, None, 1] - dy)**2) / norm(dx**2 + dy**2)
    nodes = np.abs(grid.of_nodes["u"] - exact(*grid.points[:, :2].T)[0]).max()
    return np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(), nodes, value, slope


def rows(program, case):
    """Rows of a case, and whether its orders are what they should be."""
    mu, edges, exact = CASES[case]
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for level in range(LEVELS):
            path = Path(folder) / "u.vtu"
            subprocess.run([program, "solve", "-case", str(HERE / case), "-set", f"mesh.set.edges={edges}",
                            "-mesh_refine", str(level), "-mu", mu, "-vtu", str(path)], check=True,
                           stdout=subprocess.DEVNULL)
            found.append(errors_of(read_grid(path), exact))
    found = np.array(found)
    orders = np.log(found[:-1, 2:] / found[1:, 2:]) / np.log(found[:-1, :1] / found[1:, :1])
    texts = []
    for (h, largest, value, slope), order in zip(found, [None, *orders]):
        first, second = ("", "") if order is None else (f"{one:.2f}" for one in order)
        texts.append(f"| `{case}` | {h:.3f} | {largest:.1e} | {value:.1e} | {first} | {slope:.1e} | {second} |")
    return texts, bool(np.all(orders >= ORDERS))


def same(one, other):
    """Rows with the same words, errors to a tenth."""
    cells, others = ([cell.strip() for cell in row.split("|")] for row in (one, other))
    return cells[:2] == others[:2] and len(cells) == len(others) and all(
        a == b or (a and b and abs(float(a) - float(b)) <= 0.1 * abs(float(b))) for a, b in zip(cells[2:], others[2:]))


def main(program, cases):
    text, table, failed = PAGE.read_text(encoding="utf-8"), [], 0
    for case in cases or CASES:
        now, holds = rows(program, case)
        table += now
        printed = [row for row in text.splitlines() if row.startswith(f"| `{case}` |")]
        if not holds or (cases and not (len(printed) == len(now) and all(map(same, printed, now)))):
            print(f"{case}: orders less than {ORDERS}, or other errors than in README.md: now\n" + "\n".join(now))
            failed = 1
    if not cases:
        start = text.index(HEAD) + len(HEAD)
        PAGE.write_text(text[:start] + "\n".join(table) + text[text.index("\n\n", start - 1):], encoding="utf-8")
    return failed


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2:]))
