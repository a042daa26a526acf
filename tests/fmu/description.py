#!/usr/bin/env python3
"""description.py MODELS ONLINE: the units that ONLINE makes of small runs are archives as FMI 2.0 wants them, and their
modelDescription.xml keeps its rules. Each rule is tried with a description that breaks it."""

import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path
from xml.etree import ElementTree

ATTRIBUTES = {  # of each element: needed, allowed besides
    "fmiModelDescription": ({"fmiVersion", "modelName", "guid"},
                            {"description", "author", "version", "copyright", "license", "generationTool",
                             "generationDateAndTime", "variableNamingConvention", "numberOfEventIndicators"}),
    "CoSimulation": ({"modelIdentifier"},
                     {"needsExecutionTool", "canHandleVariableCommunicationStepSize", "canInterpolateInputs",
                      "maxOutputDerivativeOrder", "canRunAsynchronuously", "canBeInstantiatedOnlyOncePerProcess",
                      "canNotUseMemoryManagementFunctions", "canGetAndSetFMUstate", "canSerializeFMUstate",
                      "providesDirectionalDerivative"}),
    "UnitDefinitions": (set(), set()),
    "Unit": ({"name"}, set()),
    "BaseUnit": (set(), {"kg", "m", "s", "A", "K", "mol", "cd", "rad", "factor", "offset"}),
    "LogCategories": (set(), set()),
    "Category": ({"name"}, {"description"}),
    "ModelVariables": (set(), set()),
    "ScalarVariable": ({"name", "valueReference"}, {"description", "causality", "variability", "initial"}),
    "Real": (set(), {"quantity", "unit", "displayUnit", "min", "max", "nominal", "start"}),
    "Integer": (set(), {"quantity", "min", "max", "start"}),
    "Boolean": (set(), {"start"}),
    "ModelStructure": (set(), set()),
    "Outputs": (set(), set()),
    "InitialUnknowns": (set(), set()),
    "Unknown": ({"index"}, {"dependencies", "dependenciesKind"}),
}
CHILDREN = {
    "fmiModelDescription": ["CoSimulation", "UnitDefinitions", "LogCategories", "ModelVariables", "ModelStructure"],
    "UnitDefinitions": ["Unit"], "Unit": ["BaseUnit"], "LogCategories": ["Category"],
    "ModelVariables": ["ScalarVariable"], "ScalarVariable": ["Real", "Integer", "Boolean"],
    "ModelStructure": ["Outputs", "InitialUnknowns"], "Outputs": ["Unknown"], "InitialUnknowns": ["Unknown"],
}
MANY = {"Unit", "Category", "ScalarVariable", "Unknown"}
LEGAL = {("input", "continuous", None), ("input", "discrete", None),
         ("output", "continuous", "calculated"), ("output", "discrete", "calculated")}
TYPES = {"Real": float, "Integer": int}


def element_defects(element):
    """Elements and attributes, their order and number."""
    needed, allowed = ATTRIBUTES[element.tag]
    names = set(element.attrib)
    if needed - names or names - needed - allowed:
        yield f"{element.tag} has the attributes {sorted(names)}"
    order = CHILDREN.get(element.tag, [])
    tags = [child.tag for child in element]
    if any(tag not in order for tag in tags) or tags != sorted(tags, key=order.index):
        yield f"{element.tag} has the elements {tags}"
        return
    for tag in set(tags) - MANY:
        if tags.count(tag) > 1:
            yield f"{element.tag} has several {tag}"
    if order and set(order) <= MANY and not tags:
        yield f"{element.tag} is empty"
    for child in element:
        yield from element_defects(child)


def variable_defects(variables, units):
    names = [one.get("name") for one in variables]
    if len(set(names)) < len(names) or "" in names:
        yield "names of variables are not unique"
    references = [(one[0].tag, one.get("valueReference")) for one in variables]
    if len(set(references)) < len(references):
        yield "value references of a type are not unique"
    for one in variables:
        name, typed = one.get("name"), one[0]
        causality = one.get("causality", "local")
        variability = one.get("variability", "continuous")
        if (causality, variability, one.get("initial")) not in LEGAL:
            yield f"{name}: causality, variability and initial do not go together"
        if variability == "continuous" and typed.tag != "Real":
            yield f"{name}: what is no real is not continuous"
        if not re.fullmatch(r"\d+", one.get("valueReference")) or int(one.get("valueReference")) >= 2**32:
            yield f"{name}: the value reference is none"
        if ("start" in typed.attrib) != (causality == "input"):
            yield f"{name}: inputs have a start, calculated outputs have none"
        try:
            low, start, high = (TYPES[typed.tag](typed.get(key, typed.get("min", "0")))
                                for key in ("min", "start", "max"))
            if not low <= start <= high or high == float("inf") or low == -float("inf"):
                yield f"{name}: min <= start <= max does not hold"
        except ValueError:
            yield f"{name}: a bound is no number"
        if typed.get("unit", None) not in units | {None}:
            yield f"{name}: its unit is not defined"


def defects(text):
    """What is wrong with a description, one line each."""
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        return [f"it is not well-formed: {error}"]
    found = list(element_defects(root))
    if found:
        return found
    unit = root.find("CoSimulation")
    if root.get("fmiVersion") != "2.0" or unit is None:
        found.append("it is no unit of co-simulation, FMI 2.0")
    elif not re.fullmatch(r"[A-Za-z_]\w*", unit.get("modelIdentifier"), re.ASCII):
        found.append("the identifier is no name in C")
    if not re.fullmatch(r"\{[0-9a-f]{8}(-[0-9a-f]{4}){3}-[0-9a-f]{12}\}", root.get("guid")):
        found.append("the GUID is none")
    units = [one.get("name") for one in root.iter("Unit")]
    if len(set(units)) < len(units):
        found.append("units are not unique")
    variables = list(root.find("ModelVariables"))
    found += variable_defects(variables, set(units))
    outputs = [str(i) for i, one in enumerate(variables, 1) if one.get("causality") == "output"]
    for name in ("Outputs", "InitialUnknowns"):
        if [one.get("index") for one in root.find(f"ModelStructure/{name}")] != outputs:
            found.append(f"{name} does not list the outputs in their order")
    return found


BROKEN = [  # what is replaced, once
    (r"</ModelVariables>", ""), (r' guid="\{', ' guid="'), (r' modelName="[^"]*"', ""),
    (r'fmiVersion="2.0"', 'fmiVersion="2.1"'), (r'modelIdentifier="', 'modelIdentifier="1'),
    (r'name="\w+" valueReference="1"', 'name="residual" valueReference="1"'),
    (r'valueReference="1"', 'valueReference="0"'), (r'valueReference="1"', 'valueReference="-1"'), (r' start="[^"]*"', ""), (r' start="[^"]*"', ' start="1e300"'),
    (r' start="[^"]*"', ' start="nan"'), (r'causality="input"', 'causality="parameter"'),
    (r' initial="calculated"', ""),
    (r' variability="discrete"', ""), (r"<Real/>", '<Real start="1"/>'), (r"<Real", '<Real unit="furlong"'),
    (r'<Unknown index="\d+"/>', ""), (r'<Unknown index="\d+"/>', '<Unknown index="1"/>'),
    (r"<LogCategories>", "<LogCategories/><LogCategories>"),
    (r"<Category", "<Sort"), (r"canInterpolateInputs", "interpolates"), (r"(?s)<Outputs>.*</Outputs>", "<Outputs/>"),
]


def check_rules(text):
    for pattern, other in BROKEN:
        broken, count = re.subn(pattern, other, text, count=1)
        if count != 1:
            sys.exit(f"{pattern} is nowhere in the description")
        if not defects(broken):
            sys.exit(f"{pattern} replaced by {other!r} is no defect")


def check_archive(path, model):
    """The description in the archive; model: its image."""
    with zipfile.ZipFile(path) as archive:
        if archive.testzip() is not None:
            sys.exit(f"{archive.testzip()} is damaged")
        text = archive.read("modelDescription.xml").decode()
        identifier = re.search(r'modelIdentifier="(\w+)"', text).group(1)
        names = ["modelDescription.xml", f"binaries/linux64/{identifier}.so", "resources/model.rbvi"]
        if archive.namelist() != names:
            sys.exit(f"the archive has {archive.namelist()}")
        for entry in archive.infolist():
            if entry.compress_type != zipfile.ZIP_STORED or entry.extract_version > 20 or entry.flag_bits & 8:
                sys.exit(f"{entry.filename} is not stored plainly")
        if archive.read("resources/model.rbvi") != model:
            sys.exit("the image is another one")
    return text


def main(models, online):
    rows = set()
    with tempfile.TemporaryDirectory() as folder:
        for name in ("membrane", "two_disks", "disk_condensed", "nitsche_empirical", "roller"):
            model, alone = Path(models) / name / "model.h5", Path(folder) / "model.h5"
            unit, image = Path(folder) / f"{name}.fmu", Path(folder) / "image.rbvi"
            alone.write_bytes(model.read_bytes())  # no fields are beside it, and none in the unit
            for of, option, file in ((model, "--fmu", unit), (alone, "--pack", image)):
                subprocess.run([online, of, option, file], check=True, capture_output=True)
            text = check_archive(unit, image.read_bytes())
            again = Path(folder) / "again.fmu"
            subprocess.run([online, image, "--fmu", again], check=True, capture_output=True)
            if again.read_bytes() != unit.read_bytes():
                sys.exit(f"{name}: the unit of the image is another one than that of the model")
            found = defects(text)
            if found:
                sys.exit(f"{name}: " + "; ".join(found))
            if not rows:  # of any description the same
                check_rules(text)
            rows.add(text)
    if len(rows) < 5:
        sys.exit("units of different models have the same description")
    print(f"{len(rows)} descriptions keep the rules of FMI 2.0, and {len(BROKEN)} that break one are found out")


if __name__ == "__main__":
    main(*sys.argv[1:])
