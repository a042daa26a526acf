"""Reduced models of contact and obstacle problems: answers in Python, by librbvi.

    import rbvi
    m = rbvi.Model("run/model.h5")
    a = m(radius=0.8)
    a["normal_force"], a.error["normal_force"], a.residual

Model answers; new, check, solve, offline and verify run the programs on a case file.
"""

from ._library import LIBRARY, BadInput, NoAnswer, RbviError
from .model import Answer, Gradient, Grid, Model, Table
from .programs import check, new, offline, solve, verify

__all__ = ["Answer", "BadInput", "Gradient", "Grid", "Model", "NoAnswer", "RbviError", "Table",
           "check", "new", "offline", "solve", "verify"]
__version__ = LIBRARY.rbvi_version().decode()
