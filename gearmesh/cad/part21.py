"""STEP's text, ISO 10303-21, said once: equal geometry is one instance, and planes do without curves in their parameters.

OpenCASCADE writes every point, direction and context where it is needed, a border's control points with the edge and again
with the surfaces on both sides, and for every edge on a plane a curve that every reader projects itself. Without these a gear
is three fifths of its size. Points are on the grid of CAD solids, other numbers have
eleven decimals (`io/digits.py`): last digits, which differ between processors, do not decide which are equal. Topology (vertices,
edges, faces) is left alone.
"""

from __future__ import annotations

import gc
import re
from collections import defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain

from gearmesh.io.digits import PARAMETER_STEPS_PER_UNIT, POINT_STEPS_PER_MM, STEPS_PER_UNIT, reals_on_grid

#: instances without an identity of their own, each kind after those that it refers to: equal values are one
_VALUES = (
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
#: how kinds of instances begin that colour others
_COLOURED = "MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION"
_INSTANCE = re.compile(r"#(\d+) = ((?:[^';]++|'[^']*')*+);\n")
_FOLD = re.compile(r"\n\s*")
_STRING_OR_FOLD = re.compile(r"'[^']*'|\n\s*")
_REFERENCE = re.compile(r"#(\d+)")
_STRING_OR_REFERENCE = re.compile(r"'[^']*'|#(\d+)")
#: instances with reals, and no text but an empty name: points, and others
_POINT, _PLACEMENT = "CARTESIAN_POINT", "AXIS2_PLACEMENT_3D"
_WITH_REALS = (
    *("DIRECTION", "VECTOR", "B_SPLINE_CURVE_WITH_KNOTS", "B_SPLINE_SURFACE_WITH_KNOTS", "CIRCLE", "ELLIPSE"),
    *("CYLINDRICAL_SURFACE", "CONICAL_SURFACE", "TOROIDAL_SURFACE"),
)
#: commas of a point in space, beside those of two parameters
_COMMAS_IN_SPACE = 3
#: what no text of a file has: between instances, and between the pieces of one
_APART, _BETWEEN = "\x01", "\x02"
#: long lists are broken into lines of about so many characters
_LINE = re.compile(r"(.{400}[^,]*#\d+,)(?=#)")

#: characters that a string of the standard does not have as they are [ISO 10303-21 6.4.3]
_BEYOND = re.compile(r"[^\x20-\x7e]+")

#: numbers of instances, rising, by their kinds
Numbers = dict[str, list[int]]


@dataclass(slots=True)
class _Instance:
    """A value that refers to others: its `text` in pieces, between which are the `references`, numbers of instances."""

    text: list[str]
    references: list[int]

    def text_with(self, names: Mapping[int, int]) -> str:
        """The value with other numbers."""
        pieces = [self.text[0]]
        for number, text in zip(self.references, self.text[1:], strict=True):
            pieces += ("#", str(names[number]), text)
        return "".join(pieces)


class _Instances:
    """What a file has, by numbers: texts of `plain` values, most of them points, and `compound` values; the numbers by `kinds`."""

    def __init__(self) -> None:
        self.plain: dict[int, str] = {}
        self.compound: dict[int, _Instance] = {}
        self.kinds: Numbers = defaultdict(list)

    def add(self, number: int, value: str) -> None:
        """Take a value, the lines of whose text may be folded."""
        quoted = "'" in value.replace("''", "")
        if "\n" in value:
            value = _FOLD.sub("", value) if not quoted else _STRING_OR_FOLD.sub(_unfold, value)
        self.kinds[value[: value.index("(", 1)]].append(number)
        if "#" not in value:
            self.plain[number] = value
        elif not quoted:
            parts = _REFERENCE.split(value)
            self.compound[number] = _Instance(parts[::2], list(map(int, parts[1::2])))
        else:
            matches = [match for match in _STRING_OR_REFERENCE.finditer(value) if match[1]]
            begins, ends = [0, *(match.end() for match in matches)], [*(match.start() for match in matches), len(value)]
            texts = [value[begin:end] for begin, end in zip(begins, ends, strict=True)]
            self.compound[number] = _Instance(texts, [int(match[1]) for match in matches])

    def references(self, number: int) -> list[int]:
        """Numbers of what an instance refers to."""
        return self.compound[number].references if number in self.compound else []


def _unfold(match: re.Match[str]) -> str:
    """A string, which goes on where its line is broken, or nothing for a break between."""
    return match[0].replace("\n", "") if match[0][0] == "'" else ""


def condense(text: str) -> str:
    """A whole file as OpenCASCADE writes it, with equal instances merged and numbered anew from 1.

    A text that is written otherwise is returned as it is.
    """
    head, data = text.split("DATA;\n", 1)
    data, tail = data.rsplit("ENDSEC;", 1)
    collecting = gc.isenabled()
    # none of 100,000 objects is garbage, and those of OpenCASCADE would be gone through again and again
    gc.disable()
    try:
        instances, end = _Instances(), 0
        for match in _INSTANCE.finditer(data):
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
    """A text with all but the characters of the basic alphabet as \\X2\\ or \\X4\\ and their numbers [ISO 10303-21 6.4.3.3]."""

    def numbers(match: re.Match[str]) -> str:
        wide = max(match[0]) > "\uffff"
        codes = match[0].encode("utf-32-be" if wide else "utf-16-be").hex().upper()
        return f"\\X{4 if wide else 2}\\{codes}\\X0\\"

    return _BEYOND.sub(numbers, text)


def _put_on_grid(instances: _Instances) -> None:
    """Put numbers on the grids of files; places of planes, cylinders and cones are known better than points on them."""
    kinds, plain = instances.kinds, instances.plain
    places = {instances.references(number)[0] for number in kinds[_PLACEMENT]}
    points = [number for number in kinds[_POINT] if number not in places]
    in_space = [number for number in points if plain[number].count(",") == _COMMAS_IN_SPACE]
    on_surfaces = [number for number in points if plain[number].count(",") != _COMMAS_IN_SPACE]
    others = [number for kind in _WITH_REALS for number in kinds[kind]]
    beside = [number for number in others if number in plain]
    beside += [number for number in kinds[_POINT] if number in places]
    for numbers, per_unit in (
        (in_space, POINT_STEPS_PER_MM),
        (on_surfaces, PARAMETER_STEPS_PER_UNIT),
        (beside, STEPS_PER_UNIT),
    ):
        joined = reals_on_grid(_APART.join(plain[number] for number in numbers), per_unit)
        plain.update(zip(numbers, joined.split(_APART), strict=False))
    compound = [instances.compound[number] for number in others if number in instances.compound]
    joined = reals_on_grid(_APART.join(_BETWEEN.join(value.text) for value in compound), STEPS_PER_UNIT)
    for value, text in zip(compound, joined.split(_APART), strict=False):
        value.text = text.split(_BETWEEN)


def _drop_curves_on_planes(instances: _Instances) -> None:
    """Leave edges with their curves in the parameters of other surfaces only, and those between planes with the curve itself."""
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
    """Leave the first of equal `_VALUES`, and refer to it."""
    first: dict[int, int] = {}
    for kind in _VALUES:
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
    """The text of `whole` and all that they refer to, each before what it refers to first.

    OpenCASCADE gathers the colours of the parts of an assembly in no fixed order; here it is that of what they colour.
    """
    coloured = {n for kind, own in instances.kinds.items() if kind.startswith(_COLOURED) for n in own}

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
        lines.append(_LINE.sub(r"\1\n", line) if len(line) > 500 else line)
    return "".join(lines)
