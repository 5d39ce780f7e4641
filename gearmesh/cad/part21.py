"""Compact text of STEP files (ISO 10303-21): equal geometry is one instance, and edges on planes have no parameter curves.

OpenCASCADE repeats every point, direction and context wherever it is needed. It writes the control points of a border with the
edge and again with the surfaces on both sides. It also writes a curve for every edge on a plane, although every reader projects
such edges itself. Without these repetitions a gear has three fifths of the size.

Points lie on the grid of CAD solids, and other numbers have eleven decimals (`io/digits.py`). The last digits differ between
processors and must not decide which instances are equal. Topology (vertices, edges, faces) is not changed.
"""

from __future__ import annotations

import gc
import re
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain

from gearmesh.io.digits import (
    PARAMETER_STEPS_PER_UNIT,
    POINT_STEPS_PER_MM,
    STEPS_PER_UNIT,
    reals_on_grid,
    values_on_grid,
)

#: kinds of instances that are merged if their values are equal; each kind follows the kinds that it refers to
_VALUE_KINDS = (
    "CARTESIAN_POINT",
    "DIRECTION",
    "( GEOMETRIC_REPRESENTATION_CONTEXT",
    "VECTOR",
    "LINE",
    "B_SPLINE_CURVE_WITH_KNOTS",
    "DEFINITIONAL_REPRESENTATION",
    "AXIS2_PLACEMENT_3D",
    "COLOUR_RGB",
    "FILL_AREA_STYLE_COLOUR",
    "FILL_AREA_STYLE",
    "SURFACE_STYLE_FILL_AREA",
    "SURFACE_SIDE_STYLE",
    "SURFACE_STYLE_USAGE",
    "PRESENTATION_STYLE_ASSIGNMENT",
)
#: beginning of the kinds of instances that colour other instances
_COLOURING_KIND = "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION"
#: number and value of an instance, whose strings may contain semicolons
_INSTANCE_PATTERN = re.compile(r"#(\d+) = ((?:[^';]++|'[^']*')*+);\n")
#: number and coordinates of a point without a name
_POINT_PATTERN = re.compile(r"#(\d+) = CARTESIAN_POINT\(\s*'',\s*\(([^()']*)\)\s*\);\n")
#: break of a long line
_FOLD_PATTERN = re.compile(r"\n\s*")
#: string, or break of a long line
_STRING_OR_FOLD = re.compile(r"'[^']*'|\n\s*")
#: reference to an instance
_REFERENCE_PATTERN = re.compile(r"#(\d+)")
#: string, or reference to an instance
_STRING_OR_REFERENCE = re.compile(r"'[^']*'|#(\d+)")
#: kind of points
_POINT_KIND = "CARTESIAN_POINT"
#: kind of positions of planes, cylinders and cones
_PLACEMENT_KIND = "AXIS2_PLACEMENT_3D"
#: other kinds of instances with reals, and no text but an empty name
_WITH_REALS = (
    *("DIRECTION", "VECTOR", "B_SPLINE_CURVE_WITH_KNOTS", "B_SPLINE_SURFACE_WITH_KNOTS", "CIRCLE", "ELLIPSE"),
    *("CYLINDRICAL_SURFACE", "CONICAL_SURFACE", "TOROIDAL_SURFACE"),
)
#: a point in space, and a point of two parameters
_POINT_TEXTS = {3: "CARTESIAN_POINT('',({},{},{}))", 2: "CARTESIAN_POINT('',({},{}))"}
#: mark between instances, which no file contains
_INSTANCE_MARK = "\x01"
#: mark between pieces of an instance, which no file contains
_PIECE_MARK = "\x02"
#: place after about 400 characters at which a long list is broken into lines
_LONG_LINE = re.compile(r"(.{400}[^,]*#\d+,)(?=#)")

#: characters outside the basic alphabet of strings [ISO 10303-21 6.4.3]
_OUTSIDE_ALPHABET = re.compile(r"[^\x20-\x7e]+")

#: rising numbers of instances, by their kinds
Numbers = dict[str, list[int]]


@dataclass(slots=True)
class _Instance:
    """A value that refers to other instances: pieces of text, with a reference between neighbouring pieces."""

    #: pieces of text, one more than references
    text: list[str]
    #: numbers of the instances
    references: list[int]

    def text_with(self, names: Mapping[int, int]) -> str:
        """Return the text of the value with other numbers."""
        pieces = [self.text[0]]
        for number, text in zip(self.references, self.text[1:], strict=True):
            pieces += ("#", str(names[number]), text)
        return "".join(pieces)


class _Instances:
    """Instances of a file by their numbers."""

    def __init__(self) -> None:
        #: coordinates of points without names, until `_put_on_grid` has put them on their grids among the `plain` values
        self.points: dict[int, str] = {}
        #: texts of values without references
        self.plain: dict[int, str] = {}
        #: values with references
        self.compound: dict[int, _Instance] = {}
        #: numbers of the instances of each kind
        self.kinds: Numbers = defaultdict(list)

    def add_points(self, data: str) -> str:
        """Add all points without names, most of the instances of a file, and return the other instances."""
        pieces = _POINT_PATTERN.split(data)
        numbers = list(map(int, pieces[1::3]))
        self.points.update(zip(numbers, pieces[2::3], strict=True))
        self.kinds[_POINT_KIND] += numbers
        return "".join(pieces[::3])

    def add(self, number: int, value: str) -> None:
        """Add an instance; the lines of its value may be broken."""
        broken, refers = "\n" in value, "#" in value
        quoted = (broken or refers) and "'" in value.replace("''", "")
        if broken:
            value = _FOLD_PATTERN.sub("", value) if not quoted else _STRING_OR_FOLD.sub(_unfold, value)
        self.kinds[value[: value.index("(", 1)]].append(number)
        if not refers:
            self.plain[number] = value
        elif not quoted:
            parts = _REFERENCE_PATTERN.split(value)
            self.compound[number] = _Instance(parts[::2], list(map(int, parts[1::2])))
        else:
            matches = [match for match in _STRING_OR_REFERENCE.finditer(value) if match[1]]
            begins, ends = [0, *(match.end() for match in matches)], [*(match.start() for match in matches), len(value)]
            texts = [value[begin:end] for begin, end in zip(begins, ends, strict=True)]
            self.compound[number] = _Instance(texts, [int(match[1]) for match in matches])

    def references(self, number: int) -> list[int]:
        """Return the numbers of the instances that an instance refers to."""
        return self.compound[number].references if number in self.compound else []


def _unfold(match: re.Match[str]) -> str:
    """Return a string without its line breaks, or nothing for a line break between strings."""
    return match[0].replace("\n", "") if match[0][0] == "'" else ""


def condense(text: str) -> str:
    """Return a file of OpenCASCADE with equal instances merged and numbered from 1.

    A text in another form is returned unchanged.
    """
    head, data = text.split("DATA;\n", 1)
    data, tail = data.rsplit("ENDSEC;", 1)
    collecting = gc.isenabled()
    # garbage collection would visit 100,000 objects and all objects of OpenCASCADE again and again, for nothing
    gc.disable()
    try:
        instances, end = _Instances(), 0
        data = instances.add_points(data)
        for match in _INSTANCE_PATTERN.finditer(data):
            if match.start() != end and data[end : match.start()].strip():
                return text
            instances.add(int(match[1]), match[2])
            end = match.end()
        if data[end:].strip():
            return text
        _put_on_grid(instances)
        used = set(chain.from_iterable(value.references for value in instances.compound.values()))
        whole = [number for number in (*instances.plain, *instances.compound) if number not in used]
        _drop_curves_on_planes(instances)
        _merge(instances)
        return f"{head}DATA;\n{_renumber(instances, whole)}ENDSEC;{tail}"
    finally:
        if collecting:
            gc.enable()


def basic_alphabet(text: str) -> str:
    """Return a text with characters outside the basic alphabet as \\X2\\ or \\X4\\ and their codes [ISO 10303-21 6.4.3.3]."""

    def numbers(match: re.Match[str]) -> str:
        wide = max(match[0]) > "\uffff"
        codes = match[0].encode("utf-32-be" if wide else "utf-16-be").hex().upper()
        return f"\\X{4 if wide else 2}\\{codes}\\X0\\"

    return _OUTSIDE_ALPHABET.sub(numbers, text)


def _put_on_grid(instances: _Instances) -> None:
    """Round numbers to the grids of files; the positions of planes, cylinders and cones have a finer grid than points."""
    kinds, plain, points = instances.kinds, instances.plain, instances.points
    places = {instances.references(number)[0] for number in kinds[_PLACEMENT_KIND]}
    others = [number for kind in _WITH_REALS for number in kinds[kind]]
    beside = [number for number in others if number in plain]
    # every second value is a repetition
    different = dict.fromkeys([plain[number] for number in beside], "")
    joined = reals_on_grid(_INSTANCE_MARK.join(different), STEPS_PER_UNIT)
    different.update(zip(different, joined.split(_INSTANCE_MARK), strict=False))
    plain.update((number, different[plain[number]]) for number in beside)
    # names of points, which OpenCASCADE does not give, are dropped
    for number in [number for number in kinds[_POINT_KIND] if number not in points]:
        _, coordinates = plain[number].rsplit("(", 1)
        points[number] = coordinates.rstrip(") ")
    kinds[_POINT_KIND].sort()
    split: dict[tuple[int, float], list[int]] = defaultdict(list)
    grids = {3: POINT_STEPS_PER_MM, 2: PARAMETER_STEPS_PER_UNIT}
    for number, text in points.items():
        size = text.count(",") + 1
        split[size, STEPS_PER_UNIT if number in places else grids[size]].append(number)
    for (size, per_unit), numbers in split.items():
        texts = [points[number] for number in numbers]
        known = dict.fromkeys(texts, "")
        digits = values_on_grid(map(float, ",".join(known).split(",")), per_unit)
        known.update(zip(known, map(_POINT_TEXTS[size].format, *(digits[k::size] for k in range(size))), strict=True))
        plain.update(zip(numbers, map(known.__getitem__, texts), strict=True))
    compound = [instances.compound[number] for number in others if number in instances.compound]
    joined = reals_on_grid(_INSTANCE_MARK.join(_PIECE_MARK.join(value.text) for value in compound), STEPS_PER_UNIT)
    for value, text in zip(compound, joined.split(_INSTANCE_MARK), strict=False):
        value.text = text.split(_PIECE_MARK)


def _drop_curves_on_planes(instances: _Instances) -> None:
    """Remove parameter curves on planes: edges between two planes keep the curve in space only."""
    kinds, compound = instances.kinds, instances.compound
    planes = set(kinds["PLANE"])
    on_planes = {number for number in kinds["PCURVE"] if compound[number].references[0] in planes}
    plain = {}
    for number in kinds["SURFACE_CURVE"]:
        curve, *on = compound[number].references
        kept = [pcurve for pcurve in on if pcurve not in on_planes]
        if not kept:
            plain[number] = curve
        elif len(kept) < len(on):
            text = ["SURFACE_CURVE('',", ",(", *[","] * (len(kept) - 1), "),.CURVE_3D.)"]
            compound[number] = _Instance(text, [curve, *kept])
    for number in kinds["EDGE_CURVE"]:
        references = compound[number].references
        references[2] = plain.get(references[2], references[2])


def _merge(instances: _Instances) -> None:
    """Keep the first of equal instances of `_VALUE_KINDS`, and make all references refer to it."""
    first: dict[int, int] = {}
    for kind in _VALUE_KINDS:
        known: dict[str | tuple[str | int, ...], int] = {}
        for number in instances.kinds[kind]:
            value = instances.compound.get(number)
            if value is None:
                kept = known.setdefault(instances.plain[number], number)
            else:
                value.references = [first.get(other, other) for other in value.references]
                kept = known.setdefault((*value.text, *value.references), number)
            if kept != number:
                first[number] = kept
    for value in instances.compound.values():
        value.references = [first.get(other, other) for other in value.references]


def _renumber(instances: _Instances, whole: list[int]) -> str:
    """Return the text of the instances `whole` and of all that they refer to, each followed by its references.

    OpenCASCADE writes the colours of an assembly's parts in no fixed order; here they follow the order of the parts.
    """
    coloured = {n for kind, own in instances.kinds.items() if kind.startswith(_COLOURING_KIND) for n in own}

    def place(number: int) -> tuple[bool, int]:
        if number not in coloured:
            return False, number
        return True, min(n for item in instances.references(number) for n in instances.references(item))

    wanted = sorted(whole, key=place, reverse=True)
    names: dict[int, int] = {}
    while wanted:
        number = wanted.pop()
        if number not in names:
            names[number] = len(names) + 1
            if number in instances.compound:
                wanted += reversed(instances.compound[number].references)
    lines = []
    for old, new in names.items():
        value = instances.compound.get(old)
        line = f"#{new}={instances.plain[old] if value is None else value.text_with(names)};\n"
        lines.append(_LONG_LINE.sub(r"\1\n", line) if len(line) > 500 else line)
    return "".join(lines)
