"""What all figures share: their style, reading a run and VTU files, saving as PNG and PDF."""

import base64
import csv
import re
import xml.etree.ElementTree as xml
from typing import NamedTuple

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

# Okabe and Ito's palette: told apart with every kind of colour vision, and in grey.
BLUE, ORANGE, GREEN, PURPLE, GREY = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#666666"
SHADES = "YlGnBu"  # of bodies

COLUMN = 3.46   # inches: of one column of a journal, 88 mm
WIDTH = 5.2     # at most: of text of 9 points, at the width of a column 6 are left
LINE = 0.165    # height of a line of text
FLOOR = 1e-16  # round-off: logarithmic axes go no lower

plt.rcParams.update({
    "font.size": 9, "axes.titlesize": 9, "figure.titlesize": 9, "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.color": "#dddddd", "grid.linewidth": 0.6, "lines.linewidth": 1.6,
    "lines.markersize": 4, "legend.frameon": False, "legend.fontsize": 9, "savefig.dpi": 200,
    "pdf.fonttype": 42,
})


class Missing(Exception):
    """A file or a quantity that this run does not have; the message says how to make it."""


def model_of(run):
    path = run / "model.h5"
    if not path.is_file():
        raise Missing(f"{path} is missing: run rbvi offline -out {run} first")
    return path


def table(run, name):
    """Columns of a table of rbvi verify, by name."""
    path = run / "verify" / name
    if not path.is_file():
        raise Missing(f"{path} is missing: run rbvi verify -out {run} first")
    return np.atleast_1d(np.genfromtxt(path, delimiter=",", names=True))


def text_rows(path):
    """Rows of a CSV file by the names in its header, as text."""
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def history(run, name):
    """A convergence history of the model, e.g. pod/error."""
    path = model_of(run)
    try:
        with h5py.File(path, "r") as model:
            return model["histories/values/" + name][()].ravel()
    except (OSError, KeyError) as error:
        raise Missing(f"{path} cannot be read: {error}") from None


def texts_in(model, name):
    """A data set of texts."""
    return [text.decode() if isinstance(text, bytes) else str(text) for text in model[name][()]]


def free_parameters(run):
    """Names and units of the free parameters of the model; "" is without dimension."""
    with h5py.File(model_of(run), "r") as model:
        names, units = (texts_in(model, "parameters/" + what) for what in ("names", "units"))
        return [(names[i], units[i]) for i in np.ravel(model["parameters/free"][()]).astype(int)]


def tree_of(run):
    """(names of its path, text) of each value of the case that the model was made of."""
    with h5py.File(model_of(run), "r") as model:
        lines = model["scene/tree"].asstr()[()].splitlines()
    found = [re.match(r"((?:\\.|[^\\:])*): (.*)", line) for line in lines]
    names = [re.findall(r"(?:\\.|[^\\.])+", line[1]) for line in found]
    return [([re.sub(r"\\(.)", r"\1", name) for name in path], line[2]) for path, line in zip(names, found)]


def contact_names(run):
    """Number, from 1, -> name of the contacts of the model."""
    names = dict.fromkeys(path[1] for path, _ in tree_of(run) if path[0] == "contact")
    return dict(enumerate(names, 1))


UNITS = {"length": "", "stress": ""}  # of what is drawn, "" where the case declares none: use_units()
PREFIXES = {-9: "n", -6: "u", -3: "m", -2: "c", -1: "d", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}


def run_of(path):
    """The run that a VTU file is in."""
    return path.parent.parent if path.parent.name == "verify" else path.parent


def declared_units(run):
    """Quantity -> unit of the case of a model; nothing where it declares none."""
    return {path[1]: text for path, text in tree_of(run) if path[0] == "units"}


def use_declared(units):
    """Those of a case: what declares none has none."""
    UNITS.update(length="", stress="")
    if not units:
        return
    powers = {prefix: power for power, prefix in PREFIXES.items()}
    length, force = (powers[units[name][:-1]] for name in ("length", "force"))
    for name, unit, power in (("length", "m", length), ("stress", "Pa", force - 2 * length)):
        UNITS[name] = PREFIXES.get(power, f"1e{power} ") + unit


def use_units(source):
    """Those of the case of a run; of a VTU file without a model beside it, those in the file. What cannot be
    read is told where it is drawn."""
    run, path = (run_of(source), source) if source.suffix == ".vtu" else (source, source / "u.vtu")
    use_declared({})
    try:
        if (run / "model.h5").is_file():
            use_declared(declared_units(run))
            return
        units = {}
        for file in (path, *path.parent.glob(f"{path.stem}_contact*.vtu")):
            units.update(read_grid(file).units)
        UNITS.update(length=units["points"].strip("-"), stress=units.get("pressure", "").strip("-"))
    except (Missing, OSError, KeyError):
        return


def label_in(what, name):
    """"x (mm)"; "x" of a case without units."""
    return f"{name} ({UNITS[what]})" if UNITS[what] else name


def in_length(name):
    return label_in("length", name)


def in_stress(name):
    return label_in("stress", name)


def amount(number, what):
    """"0.2 mm"."""
    return f"{number:.3g} {UNITS[what]}".strip()


def wider(points):
    """The coordinate along which points are spread more, and its name: what is drawn along an
    upright curve is drawn over y."""
    which = int(np.ptp(points[:, 1]) > np.ptp(points[:, 0]))
    return points[:, which], "xy"[which]


def with_unit(name, unit):
    return f"{name} ({unit or '-'})"


class Grid(NamedTuple):
    """A VTU file. Fields by name: one number each, or rows of three."""
    points: np.ndarray  # n x 3
    cells: np.ndarray   # m x nodes per cell; a quadratic triangle as four linear ones, of tetrahedra the vertices
    edges: np.ndarray   # k x 2: of the elements, those of quadratic ones in halves; none of tetrahedra
    corners: np.ndarray  # vertices of each element
    of_nodes: dict
    of_cells: dict
    of_all: dict        # field data: "mu_radius", ...
    units: dict         # of all fields by name, "-" without dimension


def array_reader(data, path):
    """The XML of a VTU file with numbers in ASCII or base64, and a function from its arrays to
    numbers or, of type String, texts."""
    root = xml.fromstring(data)
    if root.tag != "VTKFile" or root.get("type") != "UnstructuredGrid":
        raise Missing(f"{path} is not a VTU file of an unstructured grid")
    order = ">" if root.get("byte_order") == "BigEndian" else "<"
    types = {"Float64": "f8", "Int32": "i4", "Int64": "i8", "UInt8": "u1"}

    def numbers(array):
        if array.get("type") == "String":
            return bytes(map(int, array.text.split())).decode().rstrip("\0").split("\0")
        kind = np.dtype(order + types[array.get("type")])
        if array.get("format") == "binary":
            block = base64.b64decode(array.text)
            size = int(np.frombuffer(block, order + "u8", 1)[0])
            return np.frombuffer(block, kind, size // kind.itemsize, 8)
        return np.array((array.text or "").split(), kind)

    return root, numbers


def unique_edges(cells, per_cell):
    """Each edge once; of quadratic triangles (0, 3), (3, 1), ..."""
    sides = {2: [[0, 1]], 3: [[0, 1], [1, 2], [2, 0]],
             6: [[0, 3], [3, 1], [1, 4], [4, 2], [2, 5], [5, 0]]}[per_cell]
    return np.unique(np.sort(cells[:, sides].reshape(-1, 2), axis=1), axis=0)


def read_grid(path):
    """A VTU file of rbvi as a Grid."""
    if not path.is_file():
        raise Missing(f"{path} is missing: make it with rbvi-online {path.parent}/model.h5 "
                      f"--mu VALUES --vtu {path.parent}/u.vtu")
    try:
        root, numbers = array_reader(path.read_bytes(), path)
        section = {name: {array.get("Name"): numbers(array)
                          for array in next(root.iter(name)).findall("DataArray")}
                   for name in ("FieldData", "Points", "Cells", "PointData", "CellData")}
    except (xml.ParseError, StopIteration, KeyError, ValueError) as error:
        reason = str(error) or "a part is missing"
        raise Missing(f"{path} is not a VTU file that rbvi wrote: {reason}") from None
    points = section["Points"]["points"].reshape(-1, 3)
    per_cell = int(section["Cells"]["offsets"][0])
    cells = section["Cells"]["connectivity"].astype(int).reshape(-1, per_cell)
    solid, repeats = per_cell in (4, 10), 1
    corners = cells[:, :4 if solid else 3]
    edges = np.zeros((0, 2), int) if solid else unique_edges(cells, per_cell)
    if solid:
        cells = corners
    elif per_cell == 6:
        cells = cells[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]]].reshape(-1, 3)
        repeats = 4
    of_nodes = {name: values.reshape(-1, 3) if values.size == 3 * len(points) else values
                for name, values in section["PointData"].items()}
    of_cells = {name: np.repeat(values, repeats) for name, values in section["CellData"].items()}
    of_all = section["FieldData"]
    units = dict(line.rsplit(": ", 1) for line in of_all.pop("units"))
    return Grid(points, cells, edges, corners, of_nodes, of_cells, of_all, units)


def is_solid(grid):
    """Whether a file has tetrahedra."""
    return grid.corners.shape[1] == 4


def von_mises(grid, inside):
    """Label with what of the stress is drawn, that of the cells inside, and the end of its colours."""
    stress = grid.of_cells["von_mises"]
    top = stress[inside].max() if inside.any() else stress.max()
    where = "inside" if is_solid(grid) else "elsewhere"
    more = f"; {where} up to {stress.max():.3g}" if stress.max() > 1.005 * top else ""
    return in_stress("von Mises stress of cells" + more), (0, top or 1)


def beside(path, suffix):
    """u.vtu, "_mesh" -> u_mesh.vtu"""
    return path.with_name(path.stem + suffix + path.suffix)


def parameters_of(grid):
    """"radius = 0.85 m, ..." of a VTU file."""
    values = [(name[3:].replace("_", " "), numbers[0], grid.units[name])
              for name, numbers in grid.of_all.items() if name.startswith("mu_")]
    return ",  ".join(f"{name} {value:.4g}{'' if unit == '-' else ' ' + unit}"
                      for name, value, unit in values)


def label_plane(axis, names="xy"):
    axis.set_aspect("equal")
    axis.grid(False)
    axis.locator_params(nbins=4)
    axis.set_xlabel(in_length(names[0]))
    axis.set_ylabel(in_length(names[1]))


def clip_at_floor(axis):
    """Zeros and round-off of a logarithmic axis are drawn at the floor, and a line says so."""
    clipped = False
    for line in axis.lines:
        values = np.asarray(line.get_ydata(), float)
        low = values < FLOOR
        if np.any(low):
            line.set_ydata(np.where(low, FLOOR, values))
            clipped = True
    if clipped:
        axis.text(0.01, 0.01, f"values below {FLOOR:.0e} drawn there", color=GREY, transform=axis.transAxes)
        axis.relim()
        axis.autoscale_view(scalex=False)


def whole_decades(axis):
    """At least two."""
    low, high = axis.dataLim.intervaly
    if not (np.isfinite(low) and np.isfinite(high)):
        return
    low, high = np.floor(np.log10(max(low, FLOOR))), np.ceil(np.log10(max(high, FLOOR)))
    if high < low + 2:
        low, high = max(low - 1, np.log10(FLOOR)), high + 1
    axis.set_ylim(10 ** low / 1.5, 10 ** high * 1.5)


def write(figure, path):
    figure.savefig(path, bbox_inches="tight", pad_inches=0.02)
    figure.savefig(path.with_suffix(".pdf"), bbox_inches="tight", pad_inches=0.02, metadata={"CreationDate": None})


def save(figure, directory, name):
    """Writes directory/name, a PNG file, and the same as PDF. Logarithmic axes without limits of
    their own show whole decades."""
    directory.mkdir(exist_ok=True)
    for axis in figure.axes:
        if axis.get_yscale() == "log":
            chosen = not axis.get_autoscaley_on()
            clip_at_floor(axis)
            if not chosen:
                whole_decades(axis)
    path = directory / name
    write(figure, path)
    plt.close(figure)
    print(f"wrote {path}, {path.with_suffix('.pdf')}")


def log_axis(axis, xlabel, ylabel, title):
    axis.set_yscale("log")
    axis.set_xlabel(xlabel)
    axis.set_ylabel(ylabel)
    axis.set_title(title, loc="left")
