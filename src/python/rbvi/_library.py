"""librbvi by ctypes: the declarations of rbvi.h, and its errors as exceptions."""

import ctypes
import os
import subprocess
import sys
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_uint, c_void_p
from pathlib import Path

HERE = Path(__file__).absolute().parent
EXTRAPOLATE = 1
OK, NO_ANSWER, BAD_INPUT, BUSY = range(4)


class RbviError(Exception):
    """What rbvi refuses, or has no answer to: one line that says what to do."""


class NoAnswer(RbviError):
    """The method has no answer at this parameter."""


class BadInput(RbviError, ValueError):
    """The call, its numbers or the file are wrong."""


class Parameter(ctypes.Structure):
    _fields_ = [("name", c_char_p), ("unit", c_char_p), ("says", c_char_p), ("lower", c_double),
                ("upper", c_double), ("value", c_double)]


class Output(ctypes.Structure):
    _fields_ = [("name", c_char_p), ("unit", c_char_p), ("says", c_char_p), ("kind", c_int),
                ("mean_error", c_double), ("largest_error", c_double)]


class Answer(ctypes.Structure):
    _fields_ = [("inside", c_int), ("residual", c_double), ("seconds", c_double),
                ("error_u", c_double), ("error_multipliers", c_double), ("to_other", c_double)]


class Grid(ctypes.Structure):
    _fields_ = [("nodes", c_size_t), ("dimension", c_size_t), ("cells", c_size_t),
                ("nodes_per_cell", c_size_t), ("columns", c_size_t), ("points", POINTER(c_double)),
                ("cell_nodes", POINTER(c_int))]


class Column(ctypes.Structure):
    _fields_ = [("name", c_char_p), ("unit", c_char_p), ("of_cells", c_int),
                ("components", c_size_t), ("values", POINTER(c_double))]


REASON = ctypes.CFUNCTYPE(None, c_size_t, c_char_p, c_void_p)
DOUBLES = POINTER(c_double)

# What each function takes; those without a status also what they return.
FUNCTIONS = {
    "open": [c_char_p, POINTER(c_void_p)],
    "parameter_at": [c_void_p, c_size_t, POINTER(Parameter)],
    "output_at": [c_void_p, c_size_t, POINTER(Output)],
    "scene": [c_void_p, POINTER(c_char_p)],
    "workspace_new": [c_void_p, POINTER(c_void_p)],
    "solve": [c_void_p, DOUBLES, c_uint],
    "outputs": [c_void_p, DOUBLES],
    "errors": [c_void_p, DOUBLES, DOUBLES],
    "gradients": [c_void_p, DOUBLES, POINTER(c_int)],
    "answer_of": [c_void_p, POINTER(Answer)],
    "solve_many": [c_void_p, DOUBLES, c_size_t, c_uint, c_uint, DOUBLES, DOUBLES, POINTER(c_int),
                   REASON, c_void_p],
    "value": [c_void_p, c_size_t, c_char_p, POINTER(ctypes.c_double)],
    "contact_name": [c_void_p, c_size_t, POINTER(c_char_p)],
    "contact": [c_void_p, c_size_t, POINTER(Grid)],
    "field": [c_void_p, POINTER(Grid)],
    "column_at": [c_void_p, c_size_t, POINTER(Column)],
}
OTHERS = {
    "version": ([], c_char_p),
    "error": ([], c_char_p),
    "close": ([c_void_p], None),
    "workspace_free": ([c_void_p], None),
    "parameter_count": ([c_void_p], c_size_t),
    "output_count": ([c_void_p], c_size_t),
    "contact_count": ([c_void_p], c_size_t),
}


def places(name, variable):
    """Where a file may be: named by a variable, in this package, or in a build or an install that
    this package is in."""
    if variable in os.environ:
        return [Path(os.environ[variable])]
    folders = [HERE, *HERE.parents[:5]]
    return [folder / part / name for folder in folders
            for part in ("", "bin", "lib", "lib/x86_64-linux-gnu")]


def load():
    found = next((path for path in places("librbvi.so.1", "RBVI_LIBRARY") if path.exists()), None)
    try:
        library = ctypes.CDLL(str(found or "librbvi.so.1"))
    except OSError as error:
        raise ImportError(f"librbvi.so.1 is not found ({error}): build rbvi, or set RBVI_LIBRARY to "
                          "its file") from None
    for name, takes in FUNCTIONS.items():
        function = getattr(library, f"rbvi_{name}")
        function.argtypes, function.restype = takes, c_int
    for name, (takes, gives) in OTHERS.items():
        function = getattr(library, f"rbvi_{name}")
        function.argtypes, function.restype = takes, gives
    return library


LIBRARY = load()


def call(name, *arguments):
    """A function with a status; raises what it refuses."""
    status = getattr(LIBRARY, f"rbvi_{name}")(*arguments)
    if status != OK:
        raise (NoAnswer if status == NO_ANSWER else BadInput)(LIBRARY.rbvi_error().decode())


def asked(kind, name, *arguments):
    """The last argument of a function, which it fills."""
    value = kind()
    call(name, *arguments, byref(value))
    return value


def doubles(array):
    return array.ctypes.data_as(DOUBLES)


def program(name):
    """The path of a program of rbvi."""
    variable = "RBVI" if name == "rbvi" else "RBVI_ONLINE"
    found = next((path for path in places(name, variable) if path.is_file()), None)
    return str(found or name)


def run(command, quiet=False):
    """A program; what it writes is shown as it comes. Raises its last line where it fails."""
    lines = []
    try:
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              text=True) as process:
            for line in process.stdout:
                lines.append(line.rstrip())
                if not quiet:
                    print(line, end="", file=sys.stdout, flush=True)
    except FileNotFoundError:
        raise RbviError(f"{command[0]} is not found: put it on PATH, or set RBVI and RBVI_ONLINE to "
                        "the files of the programs") from None
    if process.returncode != 0:
        kind = BadInput if process.returncode == 2 else RbviError
        raise kind(next((line for line in reversed(lines) if line), f"{command[0]} failed"))
    return lines
