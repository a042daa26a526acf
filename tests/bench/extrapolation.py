#!/usr/bin/env python3
"""extrapolation.py TABLE COMMAND COMMIT CORES MACHINE: what scaling.csv says of larger meshes.

The page, on standard output: models of memory, time and messages with constants fitted to the table,
at 1e7 dofs on 1024 ranks, and what would break first.
"""

import itertools
import sys

import numpy as np

from scaling import SHORT, column, made_by, names, number, pick, power_law, read_measured, table

DOFS, RANKS = 1e7, 1024  # what is extrapolated to
BYTES_PER_RANK, SECONDS = 4e9, 3600  # what a rank has; what the pipeline may take
LATENCY, BANDWIDTH = 2e-6, 1e10  # of a message (s), of a rank (bytes / s)


def fit(terms, y):
    """Coefficients >= 0 that are best relative to y: least squares over every subset of terms."""
    y = np.asarray(y, float)
    weight = 1 / np.maximum(y, 1e-3 * max(y.max(), 1e-300))
    best, least = np.zeros(len(terms)), np.linalg.norm(y * weight)
    for size in range(1, len(terms) + 1):
        for subset in itertools.combinations(range(len(terms)), size):
            a = np.column_stack([terms[i] for i in subset]) * weight[:, None]
            if np.linalg.matrix_rank(a) < size:
                continue
            x = np.linalg.lstsq(a, y * weight, rcond=None)[0]
            misfit = np.linalg.norm(a @ x - y * weight)
            if (x >= 0).all() and misfit < least * (1 - 1e-9):
                best, least = np.zeros(len(terms)), misfit
                best[list(subset)] = x
    return best, least / np.sqrt(len(y))


def bytes_text(value):
    for unit, size in (("TB", 1e12), ("GB", 1e9), ("MB", 1e6)):
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{value / 1e3:.3g} kB"


def memory_model(found):
    """Bytes of a rank: terms 1, n / p, n, m^2. Returns coefficients, misfit, and m at DOFS."""
    n, p, m = column(found, "dofs"), column(found, "shared_by"), column(found, "multipliers")
    law = power_law(n, m) or (0, 0)
    terms = [np.ones(len(n)), n / p, n] + ([m**2] if law[1] > 0.7 else [])
    coefficients, misfit = fit(terms, 1e6 * column(found, "used_mb"))
    return np.append(coefficients, [0] * (4 - len(terms))), misfit, law[0] * DOFS**law[1]


def memory_lines(rows):
    """(scene, stage, coefficients, misfit, bytes at the target for each term)."""
    for scene in names(rows, "scene"):
        for stage in names(rows, "stage"):
            found = pick(rows, scene=scene, stage=stage)
            if stage == "total" or len(found) < 6 or len(names(found, "dofs")) < 2:
                continue
            if column(found, "used_mb").max() < 5:
                continue
            c, misfit, m = memory_model(found)
            yield scene, stage, c, misfit, c * np.array([1, DOFS / RANKS, DOFS, m**2])


def extrapolated_memory(rows):
    lines = []
    for scene, stage, c, misfit, at in memory_lines(rows):
        lines.append([scene, stage, number(c[0] / 1e6), number(c[1]), number(c[2]), number(c[3]),
                      f"{100 * misfit:.0f} %", bytes_text(at[0] + at[1]), bytes_text(at[2]),
                      bytes_text(at[3])])
    return ("## Memory of a rank\n\n    M = c0 + c1 n / p + c2 n + c3 m^2\n\nn dofs, m multipliers, p "
            "ranks that share the stage (of one solve: mesh, snapshots; else all). c1: bytes per dof "
            "that are shared, with the fill of a factor, whose log n is left out. c2: bytes per dof "
            "that one rank holds whatever their number, 8 for one field; all samples on each rank are "
            "8 times their number. c3: bytes per pair of multipliers, and whatever else grows like "
            "m^2 where m grows like n, modes of all dofs if there are more of them on finer meshes; "
            "where m grows like sqrt(n), as on a curve, m^2 is in c2. Constants >= 0 by least squares "
            "relative to the measured "
            "values, over all meshes and ranks.\n\n" +
            table(["scene", "stage", "c0 (MB)", "c1", "c2", "c3", "misfit", "fixed and shared",
                   "c2 n", "c3 m^2"], lines))


def serial_share(one, shared):
    """s of T(p) = T(1) (s + (1 - s) / p) from 1 and 2 ranks."""
    return float(np.clip(2 * shared["seconds"] / one["seconds"] - 1, 0, 1))


def time_model(rows, scene, stage, cores):
    here = pick(rows, scene=scene, stage=stage)
    ones = sorted(pick(here, ranks=1), key=lambda r: r["dofs"])
    if stage == "total" or len(ones) < 2 or ones[-1]["seconds"] < SHORT:
        return None
    rest = power_law(column(ones[-2:], "dofs"), column(ones[-2:], "seconds") -
                     column(ones[-2:], "factor_seconds"))
    last = ones[-1]
    per_factor = (last["factor_seconds"] / max(last["factorisations"], 1)) / last["dofs"]**1.5
    growth_of_counts = power_law(column(ones[-2:], "dofs"), column(ones[-2:], "factorisations"))
    count = last["factorisations"]
    if growth_of_counts:
        count *= (DOFS / last["dofs"])**max(growth_of_counts[1], 0)
    share = None
    shared = pick(here, refine=last["refine"], ranks=2, ranks_per_solve=2)
    if cores >= 2 and shared:
        share = serial_share(last, shared[0])
    seconds = 0 if rest is None else rest[0] * DOFS**rest[1]
    return {"p": None if rest is None else rest[1], "rest": seconds, "count": count,
            "factors": count * per_factor * DOFS**1.5, "share": share}


def scaled(model):
    """Seconds on RANKS ranks: if all is shared, and with the serial part."""
    work = model["rest"] + model["factors"]
    share = model["share"]
    return work / RANKS, None if share is None else work * (share + (1 - share) / RANKS)


def extrapolated_times(rows, cores):
    lines = []
    for scene in names(rows, "scene"):
        for stage in names(rows, "stage"):
            model = time_model(rows, scene, stage, cores)
            if model is None:
                continue
            shared, serial = scaled(model)
            lines.append([scene, stage, number(model["p"]), number(model["rest"]),
                          number(model["count"]), number(model["factors"]), number(model["share"]),
                          number(shared), number(serial)])
    return ("## Seconds\n\n    T(1) = c n^q + N f n^1.5,    T(p) = T(1) (s + (1 - s) / p)\n\nq and c "
            "from the two finest meshes on 1 rank without factorisations, f from the seconds of one "
            "on the finest mesh (n^1.5: nested dissection in the plane), N their number, grown as it "
            "does between those two meshes; s from 1 rank against 2 that share every solve (Amdahl). "
            "Seconds for all samples.\n\n" +
            table(["scene", "stage", "q", "c n^q", "N", "N f n^1.5", "s",
                   f"T({RANKS}), all shared", f"T({RANKS}) with s"], lines))


def message_model(rows, scene, stage):
    """What a rank sends on RANKS ranks at DOFS dofs: messages, of them to all, bytes, reductions."""
    here = [row for row in pick(rows, scene=scene, stage=stage)
            if row["ranks"] > 1 and row["ranks"] == row["ranks_per_solve"]]
    if stage == "total" or len(here) < 4 or len(names(here, "dofs")) < 2:
        return None
    n, p = column(here, "dofs"), column(here, "ranks")
    messages, _ = fit([1 - 1 / np.sqrt(p), p - 1], column(here, "messages_max"))
    volume, _ = fit([n * (p - 1) / p, n / p, np.sqrt(n / p)], 1e6 * column(here, "sent_mb") / p)
    most = [row for row in here if row["ranks"] == p.max()]
    law = power_law(column(most, "dofs"), column(most, "reductions"))
    finest = max(most, key=lambda r: r["dofs"])["reductions"]
    reductions = finest if law is None else law[0] * DOFS**max(law[1], 0)
    return {"halo": messages[0], "all": messages[1] * (RANKS - 1),
            "bytes": volume @ [DOFS, DOFS / RANKS, np.sqrt(DOFS / RANKS)],
            "bytes_all": volume[0] * DOFS, "reductions": reductions}


def message_seconds(model):
    return (LATENCY * (model["halo"] + model["all"] +
                       2 * np.log2(RANKS) * model["reductions"]) + model["bytes"] / BANDWIDTH)


def extrapolated_messages(rows):
    lines = []
    for scene in names(rows, "scene"):
        for stage in names(rows, "stage"):
            model = message_model(rows, scene, stage)
            if model is None or model["bytes"] + model["reductions"] == 0:
                continue
            lines.append([scene, stage, number(model["halo"], 4), number(model["all"], 4),
                          bytes_text(model["bytes"]), bytes_text(model["bytes_all"]),
                          number(model["reductions"], 4), number(message_seconds(model))])
    return ("## Messages of a rank\n\n    messages = k1 (1 - 1 / sqrt(p)) + k2 (p - 1)\n    bytes = b1 "
            "n (p - 1) / p + b2 n / p + b3 sqrt(n / p)\n    seconds = 2e-6 (messages + 2 log2(p) "
            "reductions) + bytes / 1e10\n\nk1: to the neighbours of a piece of the plane, k2: to "
            "everybody; b1: whole fields, b2: a part once, b3: the rim of a piece. Reductions grow "
            "with n as they do between the meshes. Latency 2 microseconds and 10 GB/s are assumed. "
            "Messages of MUMPS are not among those that PETSc counts.\n\n" +
            table(["scene", "stage", "to neighbours", "to everybody", "bytes", "of whole fields",
                   "reductions", "seconds"], lines))


def breaks(rows, cores):
    """Whatever is beyond what a rank or the pipeline has, by how much, worst first."""
    found = []
    of_terms = ("fixed", "shared, c1 n / p", "on every rank or on one, c2 n", "dense in m, c3 m^2")
    for scene, stage, _, _, at in memory_lines(rows):
        for term, size in zip(of_terms, at):
            found.append((size / BYTES_PER_RANK, scene, stage, f"memory {term}", bytes_text(size)))
    for scene in names(rows, "scene"):
        for stage in names(rows, "stage"):
            model = time_model(rows, scene, stage, cores)
            if model is not None:
                shared, serial = scaled(model)
                seconds = shared if serial is None else serial
                what = "seconds that ranks do not share" if serial else "seconds"
                found.append((seconds / SECONDS, scene, stage, what, f"{number(seconds)} s"))
            model = message_model(rows, scene, stage)
            if model is not None:
                seconds = message_seconds(model)
                found.append((seconds / SECONDS, scene, stage, "messages", f"{number(seconds)} s"))
    return sorted(found, reverse=True)


def fewest_ranks(rows):
    """For each scene the ranks that one solve needs, by the shared memory of the snapshots."""
    texts = []
    for scene, stage, c, _, at in memory_lines(rows):
        if stage != "snapshots":
            continue
        left = BYTES_PER_RANK - at[0] - at[2] - at[3]
        texts.append(f"{scene}: " + (f"{max(1, int(np.ceil(c[1] * DOFS / left)))}" if left > 0 else
                                     "no number, as what is not shared is too large already"))
    return "; ".join(texts)


def page(rows, cores, source):
    lines = [[number(ratio), *what] for ratio, *what in breaks(rows, cores)[:15]]
    return (f"# Extrapolated to {DOFS:.0e} dofs on {RANKS} ranks\n\n{source} Constants of the models "
            "below are fitted to [scaling.csv](scaling.csv), none is adjusted by hand. The samples are "
            "as many as were measured, and all ranks share every solve.\n\n"
            "## What would break first\n\nAgainst "
            f"{bytes_text(BYTES_PER_RANK)} of a rank and {SECONDS} s for a stage: above 1 it does not "
            "fit. Worst first.\n\n" +
            table(["of what there is", "scene", "stage", "what", "how much"], lines) +
            f"\nRanks that one solve needs for its memory: {fewest_ranks(rows)}.\n\n" +
            extrapolated_memory(rows) + "\n" + extrapolated_times(rows, cores) + "\n" +
            extrapolated_messages(rows))


def main(path, command, commit, cores, machine):
    cores = int(cores)
    rows = read_measured(path, cores)
    if len(names(rows, "refine")) < 2:
        print("# Not extrapolated\n\nThat takes two meshes and more.")
        return
    print(page(rows, cores, made_by(rows, command, commit, cores, machine)).rstrip())


if __name__ == "__main__":
    main(*sys.argv[1:])
