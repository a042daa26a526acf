"""Rows of the stress table about 100000 random queries and the corners of the box, on a model of each case."""

import itertools
import re
import shutil
from collections import Counter

import models
from lab import ENERGY, Refused, Wrong, check_residual, deviation, judge, read_table, refusal, shape_deviation, sizes

ASKED = ("membrane hybrid", "two disks condensed", "two disks cone", "disk coulomb condensed",
         "disk coulomb collocated", "disk coulomb nitsche empirical", "disk large coulomb condensed",
         "patch one condensed", "roller condensed", "roller nitsche", "seal condensed", "bracket condensed",
         "joint condensed", "bolted_flange condensed")
COUNT, LOOKED_AT = 100000, 6
WITHIN, SHAPES_WITHIN = 1e-3, 0.05  # energies and forces; peaks and widths


def asked(lab, scene):
    """Answers are compared with high-fidelity ones at some queries; where there is none the reason is looked up."""
    made = models.Models(lab, scene)
    train, run = "corners + random:40:3" if scene.case != "two_disks" else "grid:21", made.folder / "base"
    ended = lab.run(lab.rbvi, "offline", "-case", made.case, "-out", run, "-train", train, *scene.reduction)
    if not (run / "model.h5").exists():  # one of samples that failed is made of the others
        raise Refused(refusal(ended))
    rows = []
    for at in (made.table("corners.csv", corners(lab, run)), f"random:{COUNT}:7"):
        answers = made.folder / "answers.csv"
        ended = lab.run(lab.online, run / "model.h5", "--queries", at, "--out", answers, seconds=1200)
        if ended.status not in (0, 1):
            raise Wrong(f"status {ended.status}: {ended.err.strip()[:300]}")
        rows += read_table(answers)
    if len(rows) <= COUNT:
        raise Wrong(f"{len(rows)} rows")
    good, refused = [row for row in rows if row["status"] == "ok"], [row for row in rows if row["status"] != "ok"]
    for row in good:
        check_residual(row)
    names = list(rows[0])[:list(rows[0]).index(ENERGY)]
    places = [good[k * (len(good) - 1) // (LOOKED_AT - 1)] for k in range(LOOKED_AT)]
    right = [lab.solve(made.case, models.mu({name: row[name] for name in names})) for row in places]
    apart = deviation(places, right, sizes(right))
    if apart > WITHIN:
        raise Wrong(f"{apart:.1e} from high-fidelity answers")
    if refused:
        raise Refused(why(lab, made.case, names, refused, len(rows)))
    return apart, WITHIN, shape_deviation(places, right), SHAPES_WITHIN


def corners(lab, run):
    """Of the box of the model."""
    told = lab.answer(lab.online, run / "model.h5").out
    found = re.findall(r"^ *(?:parameters +)?(\S+) +\[(\S+), (\S+)\]", told, re.MULTILINE)
    return [dict(zip((name for name, _, _ in found), map(float, ends)))
            for ends in itertools.product(*((low, high) for _, low, high in found))]


def why(lab, case, names, refused, count):
    """The reasons, which full solves must share, or a model without enough samples."""
    reasons = Counter(row["status"].partition(", while solving")[0] for row in refused)
    text = f"{len(refused)} of {count}: " + "; ".join(f"{reason} ({number})" for reason, number in reasons.items())
    for row in refused[::max(1, len(refused) // 3)]:
        if "reduce again" in row["status"]:
            continue
        try:
            lab.solve(case, models.mu({name: row[name] for name in names}))
        except Refused:
            continue
        raise Wrong(f"{text}, where a full solve has an answer")
    return text


def rows(lab, scene):
    yield from judge(scene.name, f"{COUNT} random queries and the corners", lambda: asked(lab, scene))
    shutil.rmtree(lab.work / scene.name.replace(" ", "_"))
