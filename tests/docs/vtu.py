#!/usr/bin/env python3
"""vtu.py OUT: every VTU file below OUT (small_runs.py) is XML, and VTK reads the numbers that
cases/figure_tools.py reads. Without VTK (python3-vtk9) only the first is checked, and the exit status
is 77: skipped.
"""

import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "cases"))

from figure_tools import array_reader

try:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
except ImportError:
    vtkXMLUnstructuredGridReader = None


def arrays_of(path):
    """(section, name) -> numbers, as figures.py reads them."""
    root, numbers = array_reader(path.read_bytes(), path)
    return {(name, array.get("Name")): numbers(array)
            for name in ("FieldData", "Points", "Cells", "PointData", "CellData")
            for array in next(root.iter(name)).findall("DataArray")}


def arrays_of_vtk(path):
    """The same as VTK reads them."""
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(path))
    reader.Update()
    if reader.GetErrorCode() != 0:
        raise ValueError(f"VTK reports error {reader.GetErrorCode()}")
    grid = reader.GetOutput()
    cells = grid.GetCells()
    found = {("Points", "points"): grid.GetPoints().GetData(),
             ("Cells", "connectivity"): cells.GetConnectivityArray(),
             ("Cells", "types"): grid.GetCellTypesArray()}
    for section, fields in (("FieldData", grid.GetFieldData()), ("PointData", grid.GetPointData()),
                            ("CellData", grid.GetCellData())):
        for k in range(fields.GetNumberOfArrays()):
            array = fields.GetAbstractArray(k)
            found[section, array.GetName()] = array
    found = {name: [array.GetValue(k) for k in range(array.GetNumberOfValues())]
             if array.IsA("vtkStringArray") else vtk_to_numpy(array).ravel()
             for name, array in found.items()}
    # VTK's offsets begin with a zero, those of a file with the end of the first cell.
    found["Cells", "offsets"] = vtk_to_numpy(cells.GetOffsetsArray())[1:]
    return found


def differences(path):
    """What is wrong with a file, in words."""
    ours = arrays_of(path)
    if vtkXMLUnstructuredGridReader is None:
        return []
    theirs = arrays_of_vtk(path)
    wrong = [f"{' '.join(name)} is read by one alone" for name in ours.keys() ^ theirs.keys()]
    return wrong + [f"{' '.join(name)} differs" for name in ours.keys() & theirs.keys()
                    if not np.array_equal(ours[name], theirs[name])]


def main(out):
    paths = sorted(out.rglob("*.vtu"))
    wrong, formats = [], set()
    for path in paths:
        try:
            root = xml.parse(path).getroot()
            formats |= {array.get("format") for array in root.iter("DataArray")}
            wrong += [f"{path}: {line}" for line in differences(path)]
        except (xml.ParseError, ValueError) as error:
            wrong.append(f"{path}: {error}")
    if formats != {"ascii", "binary"}:
        wrong.append(f"the files have the formats {sorted(formats)}, not ascii and binary")
    print("\n".join(wrong) or f"{len(paths)} files are read")
    if not wrong and vtkXMLUnstructuredGridReader is None:
        print("skipped: VTK is not installed (python3-vtk9)")
        return 77
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1])))
