"""A reduced model: answers, tables of them, traces on contacts, fields, plots."""

import ctypes
import difflib
import tempfile
import weakref
from ctypes import byref, c_char_p, c_int, c_void_p
from pathlib import Path

import numpy as np

from . import _library as library
from ._library import BadInput, call, doubles
from ._progress import shown_while


class Values(dict):
    """Numbers by name; an unknown name is refused with the nearest one."""

    def __missing__(self, name):
        raise BadInput(unknown(name, list(self), "there is no"))


def unknown(name, names, what):
    near = difflib.get_close_matches(str(name), names, 1, 0)
    return f"{what} '{name}'" + (f": the nearest one is '{near[0]}'" if near else "")


class Quantity:
    """A parameter or an output of a model: name, unit, says; lower, upper, value of a parameter;
    mean_error, largest_error (absolute, over the validation set) of an output."""

    def __init__(self, of):
        for name, _ in of._fields_:
            value = getattr(of, name)
            setattr(self, name, value.decode() if isinstance(value, bytes) else value)

    def __repr__(self):
        return ", ".join(f"{name} {value}" for name, value in vars(self).items() if value != "")


class Answer:
    """One answer: a["normal_force"], a.outputs, a.error["normal_force"] (the largest over the
    validation set), a.bound, a.residual, a.inside, a.error_u, a.error_multipliers, a.to_other,
    a.seconds, a.mu."""

    def __init__(self, mu, outputs, error, bound, facts):
        self.mu, self.outputs, self.error, self.bound = mu, outputs, error, bound
        for name, _ in facts._fields_:
            setattr(self, name, getattr(facts, name))
        self.inside = bool(self.inside)

    def __getitem__(self, name):
        return self.outputs[name]

    def __repr__(self):
        rows = [f"{name:24} {value:.10g}" + (f"  (largest error {self.error[name]:.2g})"
                                             if self.error[name] == self.error[name] else "")
                for name, value in self.outputs.items()]
        where = "" if self.inside else ", outside of the box"
        return "\n".join([f"at {self.mu}{where}: residual {self.residual:.1g}", *rows])


class Gradient:
    """Derivatives at one parameter: g["normal_force"]["radius"], NaN where an output has none;
    g.kinked["radius"]: whether a node is about to touch, lift, stick or slip as radius changes, so
    that derivatives are those of one side, or between both; g.answer, g.mu."""

    def __init__(self, answer, values, kinked):
        self.answer, self.mu = answer, answer.mu
        self.values = {name: Values(zip(answer.mu, map(float, row)))
                       for name, row in zip(answer.outputs, values)}
        self.kinked = Values(zip(answer.mu, map(bool, kinked)))

    def __getitem__(self, name):
        return Values(self.values)[name]

    def __repr__(self):
        rows = [f"d {output:24} / d {name:12} {value:.10g}" for output, row in self.values.items()
                for name, value in row.items() if value == value]
        return "\n".join([f"at {self.mu}", *rows])


class Table:
    """Answers of many parameters, in their order: t["normal_force"], t.parameters, t.residual,
    t.ok (which have an answer), t.status ("ok", or why there is none), t.frame() for pandas."""

    def __init__(self, parameters, outputs, residual, status):
        self.parameters, self.outputs, self.residual, self.status = (parameters, outputs, residual,
                                                                     status)
        self.ok = np.array([text == "ok" for text in status], dtype=bool)

    def __getitem__(self, name):
        return (self.parameters if name in self.parameters else self.outputs)[name]

    def __len__(self):
        return len(self.status)

    def frame(self):
        import pandas
        return pandas.DataFrame({**self.parameters, **self.outputs, "status": self.status})


class Grid:
    """Values on a mesh: g["pressure"], g.points (nodes x dimension, mapped), g.cells, g.units; of
    what is on cells one row a cell. On a contact in the plane g.arc is the length along it."""

    def __init__(self, of, columns):
        def array(pointer, *shape):
            return (np.ctypeslib.as_array(pointer, shape).copy() if all(shape)
                    else np.zeros(shape))
        self.points = array(of.points, of.nodes, of.dimension)
        self.cells = array(of.cell_nodes, of.cells, of.nodes_per_cell).astype(int)
        self.values, self.units = Values(), Values()
        for column in columns:
            rows = of.cells if column.of_cells else of.nodes
            values = array(column.values, rows, column.components)
            name = column.name.decode()
            self.values[name] = values[:, 0] if column.components == 1 else values
            self.units[name] = column.unit.decode()

    def __getitem__(self, name):
        return self.values[name]

    @property
    def arc(self):
        """Of lines: how far each node is along the curve from its first one."""
        return np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(self.points, axis=0), axis=1))])


class Model:
    """A reduced model of rbvi.

    m = Model("model.h5")           or an image of rbvi-online --pack
    a = m(radius=0.8)               an answer; parameters that are left out keep their values
    m.table({"radius": [...]})      many, on all cores
    m.gradient(radius=0.8)          derivatives of the outputs by the parameters
    m.contact(radius=0.8)           pressure, gap, ... along the contact
    m.field(radius=0.8)             displacement and stresses of the bodies
    m.plot("normal_force", x="radius")
    m.map("normal_force", x="radius", y="friction")    colours and contours over two parameters
    m.sobol(["normal_force"])       Sobol's indices over the box; m.sobol(...).plot(): bars
    m.openturns("normal_force")     a function of OpenTURNS; m.distribution(): the box
    m.parameters, m.outputs         what there is, with units, boxes and errors
    """

    def __new__(cls, file):
        # help(m) shows what this model has: each has a class of its own for its text.
        return super().__new__(type("Model", (cls,), {}))

    def __init__(self, file):
        self._file = str(file)
        self._handle = self._open(Path(file))
        weakref.finalize(self, library.LIBRARY.rbvi_close, self._handle)
        self._workspace = library.asked(c_void_p, "workspace_new", self._handle)
        weakref.finalize(self, library.LIBRARY.rbvi_workspace_free, self._workspace)
        self.scene = library.asked(c_char_p, "scene", self._handle).value.decode()
        self.parameters = self._all("parameter", library.Parameter)
        self.outputs = self._all("output", library.Output)
        self.contacts = [
            library.asked(c_char_p, "contact_name", self._handle, i).value.decode()
            for i in range(library.LIBRARY.rbvi_contact_count(self._handle))]
        type(self).__doc__ = self._text()

    @staticmethod
    def _open(path):
        with open(path, "rb") as file:
            is_image = file.read(8) == b"rbvi-img"
        if is_image:
            return library.asked(c_void_p, "open", str(path).encode())
        with tempfile.TemporaryDirectory() as folder:
            image = Path(folder) / "model.rbvi"
            library.run([library.program("rbvi-online"), str(path), "--pack", str(image)], True)
            return library.asked(c_void_p, "open", str(image).encode())

    def _all(self, what, kind):
        count = getattr(library.LIBRARY, f"rbvi_{what}_count")(self._handle)
        all_of = [Quantity(library.asked(kind, f"{what}_at", self._handle, i))
                  for i in range(count)]
        return Values({one.name: one for one in all_of})

    def _text(self):
        lines = [f"The reduced model {self._file} of the scene {self.scene}.", "",
                 "Parameters (keywords of a call):"]
        for one in self.parameters.values():
            lines.append(f"  {one.name}: {one.lower:g} to {one.upper:g} {one.unit}, {one.value:g} "
                         f"where it is left out. {one.says}".rstrip())
        lines += ["", "Outputs:"]
        for one in self.outputs.values():
            error = f" (largest error {one.largest_error:.2g})" * (
                one.largest_error == one.largest_error)
            lines.append(f"  {one.name}{f' ({one.unit})' if one.unit else ''}: {one.says}{error}")
        return "\n".join([*lines, "", Model.__doc__])

    def __repr__(self):
        return (f"<rbvi.Model {self._file}: {', '.join(self.parameters)} -> "
                f"{len(self.outputs)} outputs>")

    def _number(self, name, value):
        """A value of a parameter, of a choice its name, too."""
        if not isinstance(value, str):
            return value
        place = list(self.parameters).index(name)
        return library.asked(ctypes.c_double, "value", self._handle, place, value.encode()).value

    def _mu(self, values):
        """All parameters, those that are left out at their values."""
        for name in values:
            if name not in self.parameters:
                raise BadInput(unknown(name, list(self.parameters), "the model has no parameter"))
        return np.array([self._number(name, values.get(name, one.value))
                         for name, one in self.parameters.items()], dtype=float)

    def _solve(self, mu, extrapolate):
        call("solve", self._workspace, doubles(mu), library.EXTRAPOLATE * bool(extrapolate))

    def __call__(self, *, extrapolate=False, **parameters):
        """The answer at these parameters. Raises NoAnswer, or BadInput outside of the box unless
        `extrapolate`."""
        mu = self._mu(parameters)
        self._solve(mu, extrapolate)
        outputs, error, bound = (np.empty(len(self.outputs)) for _ in range(3))
        call("outputs", self._workspace, doubles(outputs))
        call("errors", self._workspace, doubles(error), doubles(bound))
        named = [Values(zip(self.outputs, map(float, one))) for one in (outputs, error, bound)]
        facts = library.asked(library.Answer, "answer_of", self._workspace)
        return Answer(dict(zip(self.parameters, map(float, mu))), *named, facts)

    def gradient(self, *, extrapolate=False, **parameters):
        """The derivatives of all outputs by all parameters, and the answer beside them."""
        answer = self(extrapolate=extrapolate, **parameters)
        values = np.empty((len(self.outputs), len(self.parameters)))
        kinked = np.empty(len(self.parameters), dtype=np.intc)
        call("gradients", self._workspace, doubles(values),
             kinked.ctypes.data_as(ctypes.POINTER(c_int)))
        return Gradient(answer, values, kinked)

    def _rows(self, parameters):
        """rows x parameters, from an array, a dict or a DataFrame."""
        if not hasattr(parameters, "keys"):
            rows = np.atleast_2d(np.asarray(parameters, dtype=float))
            if rows.shape[1] != len(self.parameters):
                raise BadInput(f"an array has a column for each of {', '.join(self.parameters)}: "
                               f"this one has {rows.shape[1]}")
            return rows
        given = {str(name): parameters[name] for name in parameters.keys()}
        lengths = {len(values) for values in given.values() if np.ndim(values) > 0}
        if len(lengths) > 1:
            raise BadInput(f"the columns have different lengths: {sorted(lengths)}")
        count = lengths.pop() if lengths else 1
        self._mu(dict.fromkeys(given, 0))  # names
        columns = {name: np.broadcast_to(
            np.asarray([self._number(name, one) for one in np.atleast_1d(values)], dtype=float)
            if np.asarray(values).dtype.kind in "OU" else np.asarray(values, dtype=float), count)
            for name, values in given.items()}
        return np.column_stack([columns.get(name, np.full(count, one.value))
                                for name, one in self.parameters.items()])

    def table(self, parameters, *, extrapolate=False, threads=0, progress=None):
        """The answers of many parameters, in their order: an array rows x parameters, a dict of
        columns or a DataFrame; `threads` 0: all cores. Rows without an answer are NaN, and
        Table.status says why. `progress`: a line on standard error says how many are done and how
        long the others take; None: on a terminal, from two seconds on."""
        rows = np.ascontiguousarray(self._rows(parameters))
        outputs = np.empty((len(rows), len(self.outputs)))
        residual, status = np.empty(len(rows)), ["ok"] * len(rows)
        statuses = np.full(len(rows), -1, dtype=np.intc)  # of each row, once it is done

        def tell(row, reason, _):
            status[row] = reason.decode()

        def solve():
            call("solve_many", self._handle, doubles(rows), len(rows), threads,
                 library.EXTRAPOLATE * bool(extrapolate), doubles(outputs), doubles(residual),
                 statuses.ctypes.data_as(ctypes.POINTER(c_int)), library.REASON(tell), None)

        shown_while(solve, lambda: np.count_nonzero(statuses >= 0), len(rows), progress)
        return Table(Values(zip(self.parameters, rows.T)), Values(zip(self.outputs, outputs.T)),
                     residual, status)

    def _grid(self, name, *where):
        grid = library.asked(library.Grid, name, self._workspace, *where)
        return Grid(grid, [library.asked(library.Column, "column_at", self._workspace, i)
                           for i in range(grid.columns)])

    def contact(self, contact=None, *, extrapolate=False, **parameters):
        """Pressure, gap, normal, displacement, ... on a contact (its name; None: the first)."""
        if contact is not None and contact not in self.contacts:
            raise BadInput(unknown(contact, self.contacts, "there is no contact"))
        self._solve(self._mu(parameters), extrapolate)
        return self._grid("contact", 0 if contact is None else self.contacts.index(contact))

    def field(self, *, extrapolate=False, **parameters):
        """Displacement and stresses of the bodies; the model's fields must be beside it."""
        self._solve(self._mu(parameters), extrapolate)
        return self._grid("field")

    def openturns(self, outputs=None, *, extrapolate=False):
        """An openturns.Function of the parameters, in their order, to these outputs (a name, a list;
        None: all). A point without an answer raises, as OpenTURNS takes NaN for a number; outside
        of the box there is none unless `extrapolate`."""
        from ._openturns import function_of
        return function_of(self, outputs, extrapolate)

    def distribution(self):
        """The box as a distribution of OpenTURNS: parameters are uniform and independent."""
        from ._openturns import box_of
        return box_of(self)

    @property
    def samples(self):
        """The training samples, rows of the parameters; None where the model is an image, which does not
        have them, or h5py is not installed."""
        try:
            import h5py
            with h5py.File(self._file, "r") as file:
                return file["training/mu"][()].T
        except (ImportError, OSError):
            return None

    def map(self, output, x=None, y=None, samples=True, count=41, axes=None, **parameters):
        """An output over two parameters as colours and contours, in matplotlib, with the training samples
        (`samples`: True those of the model, False none, else rows of the parameters) and lines where numbers
        of nodes in contact, or of those that stick, change; `x`, `y`: the first two parameters without a
        value among `parameters`. Returns the axes."""
        from ._figures import parameter_map
        self._mu(parameters)  # names
        free = [name for name in self.parameters if name not in parameters and name not in (x, y)]
        over = [name or free.pop(0) if name or free else None for name in (x, y)]
        if None in over or over[0] == over[1]:
            raise BadInput(f"a map is over two parameters; free are {', '.join(filter(None, over)) or 'none'}")
        self.outputs[output]  # refuses an unknown one
        points = self.samples if samples is True else samples if samples is not False else None
        return parameter_map(self, output, over, points, count, axes, parameters)

    def sobol(self, outputs=None, count=4096, seed=1):
        """Sobol's indices of these outputs (a name, a list; None: all), over the box, in which parameters are
        uniform and independent, from count (p + 2) random points for p parameters: a Sensitivity."""
        from ._sensitivity import Sensitivity
        names = [outputs] if isinstance(outputs, str) else list(outputs or self.outputs)
        for name in names:
            self.outputs[name]  # refuses an unknown one
        return Sensitivity(lambda rows: self._columns(rows, names), {
            name: (one.lower, one.upper) for name, one in self.parameters.items()}, names, count, seed)

    def _columns(self, rows, outputs):
        """Outputs at these parameters, points x outputs; NoAnswer where a point has none."""
        table = self.table(rows)
        if not table.ok.all():
            raise library.NoAnswer(f"{np.count_nonzero(~table.ok)} of {len(table)} points have no answer; the "
                                   f"first: {table.status[int(np.argmin(table.ok))]}")
        return np.column_stack([table[name] for name in outputs])

    def plot(self, output, x=None, count=101, axes=None, **parameters):
        """An output over a parameter, with the band of its largest error, in matplotlib; `x`: the
        first parameter without a value among `parameters`. Returns the axes."""
        import matplotlib.pyplot as plt
        of = self.outputs[output]
        free = [name for name in self.parameters if name not in parameters]
        over = self.parameters[x if x is not None else free[0] if free else list(self.parameters)[0]]
        at = np.linspace(over.lower, over.upper, count)
        values = self.table({**parameters, over.name: at})[output]
        axes = axes or plt.subplots()[1]
        line, = axes.plot(at, values)
        if of.largest_error == of.largest_error:
            axes.fill_between(at, values - of.largest_error, values + of.largest_error, alpha=0.3,
                              color=line.get_color(), linewidth=0)
        axes.set_xlabel(f"{over.name} ({over.unit})" if over.unit else over.name)
        axes.set_ylabel(f"{output} ({of.unit})" if of.unit else output)
        return axes
