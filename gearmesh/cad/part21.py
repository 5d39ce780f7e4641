"""STEP's text, ISO 10303-21, said once: equal geometry is one instance, and planes do without curves in their parameters.

OpenCASCADE writes every point, direction and context where it is needed, a border's control points with the edge and again
with the surfaces on both sides, and for every edge on a plane a curve that every reader projects itself. Without these a gear
is three fifths of its size. Points are on the grid of CAD solids, other numbers have
eleven decimals (`io/digits.py`): last digits, which differ between processors, do not decide which are equal. Topology (vertices,
edges, faces) is left alone.
"""

from __future__ import annotations

import re

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
_INSTANCE = re.compile(r"#(\d+) = ((?:'[^']*'|[^';])*);\n")
_STRING_OR_FOLD = re.compile(r"'[^']*'|\n\s*")
_STRING_OR_REFERENCE = re.compile(r"'[^']*'|#(\d+)")
_PCURVE = re.compile(r"PCURVE\('[^']*',#(\d+),")
_SURFACE_CURVE = re.compile(r"SURFACE_CURVE\('[^']*',#(\d+),\(([#\d,]+)\),\.\w+\.\)")
_EDGE_CURVE = re.compile(r"(EDGE_CURVE\('[^']*',#\d+,#\d+,)#(\d+)(,.*)")
#: instances with reals, and no text but an empty name: points, and others
_POINT, _PLACEMENT = "CARTESIAN_POINT(", "AXIS2_PLACEMENT_3D("
_WITH_REALS = (
    *("DIRECTION(", "VECTOR(", "B_SPLINE_CURVE_WITH_KNOTS(", "B_SPLINE_SURFACE_WITH_KNOTS(", "CIRCLE(", "ELLIPSE("),
    *("CYLINDRICAL_SURFACE(", "CONICAL_SURFACE(", "TOROIDAL_SURFACE("),
)
#: commas of a point in space, beside those of two parameters
_COMMAS_IN_SPACE = 3
#: long lists are broken into lines of about so many characters
_LINE = re.compile(r"(.{400}[^,]*#\d+,)(?=#)")

#: characters that a string of the standard does not have as they are [ISO 10303-21 6.4.3]
_BEYOND = re.compile(r"[^\x20-\x7e]+")

#: instances by number
Instances = dict[int, str]


def condense(text: str) -> str:
    """A whole file as OpenCASCADE writes it, with equal instances merged and numbered anew from 1.

    A text that is written otherwise is returned as it is.
    """
    head, data = text.split("DATA;\n", 1)
    data, tail = data.rsplit("ENDSEC;", 1)
    instances = {int(number): _unfold(value) for number, value in _INSTANCE.findall(data)}
    _on_grid(instances)
    if _INSTANCE.sub("", data).strip():
        return text
    used = {number for value in instances.values() for number in _references(value)}
    whole = [number for number in instances if number not in used]
    _drop_curves_on_planes(instances)
    _merge(instances)
    return f"{head}DATA;\n{_renumber(instances, whole)}ENDSEC;{tail}"


def basic_alphabet(text: str) -> str:
    """A text with all but the characters of the basic alphabet as \\X2\\ or \\X4\\ and their numbers [ISO 10303-21 6.4.3.3]."""

    def numbers(match: re.Match[str]) -> str:
        wide = max(match[0]) > "\uffff"
        codes = match[0].encode("utf-32-be" if wide else "utf-16-be").hex().upper()
        return f"\\X{4 if wide else 2}\\{codes}\\X0\\"

    return _BEYOND.sub(numbers, text)


def _unfold(value: str) -> str:
    """A value in one line; a string goes on where its line is broken."""
    if "\n" not in value:
        return value
    return _STRING_OR_FOLD.sub(lambda match: match[0].replace("\n", "") if match[0][0] == "'" else "", value)


def _on_grid(instances: Instances) -> None:
    """Put numbers on the grids of files; places of planes, cylinders and cones are known better than points on them."""
    places = {_references(value)[0] for value in instances.values() if value.startswith(_PLACEMENT)}
    for number, value in instances.items():
        if value.startswith(_POINT) and number not in places:
            in_space = value.count(",") == _COMMAS_IN_SPACE
            instances[number] = reals_on_grid(value, POINT_STEPS_PER_MM if in_space else PARAMETER_STEPS_PER_UNIT)
        elif value.startswith((_POINT, *_WITH_REALS)):
            instances[number] = reals_on_grid(value, STEPS_PER_UNIT)


def _references(value: str) -> list[int]:
    # most instances are points, without any
    if "#" not in value:
        return []
    return [int(number) for number in _STRING_OR_REFERENCE.findall(value) if number]


def _rename(value: str, names: dict[int, int]) -> str:
    """A value with its references replaced where `names` has others."""
    if "#" not in value:
        return value
    return _STRING_OR_REFERENCE.sub(
        lambda match: f"#{names.get(int(match[1]), match[1])}" if match[1] else match[0], value
    )


def _drop_curves_on_planes(instances: Instances) -> None:
    """Leave edges with their curves in the parameters of other surfaces only, and those between planes with the curve itself."""
    planes = {number for number, value in instances.items() if value.startswith("PLANE(")}
    pcurves = {n: int(match[1]) for n, value in instances.items() if (match := _PCURVE.match(value))}
    plain = {}
    for number, value in instances.items():
        if match := _SURFACE_CURVE.fullmatch(value):
            on = [int(number_text) for number_text in match[2].replace("#", "").split(",")]
            kept = [pcurve for pcurve in on if pcurves.get(pcurve) not in planes]
            if not kept:
                plain[number] = match[1]
            elif len(kept) < len(on):
                listed = ",".join(f"#{pcurve}" for pcurve in kept)
                instances[number] = f"SURFACE_CURVE('',#{match[1]},({listed}),.CURVE_3D.)"
    for number, value in instances.items():
        if (match := _EDGE_CURVE.fullmatch(value)) and int(match[2]) in plain:
            instances[number] = f"{match[1]}#{plain[int(match[2])]}{match[3]}"


def _merge(instances: Instances) -> None:
    """Leave the first of equal `_VALUES`, and refer to it."""
    kinds: dict[str, list[int]] = {kind: [] for kind in _VALUES}
    for number, value in instances.items():
        kind = value[: value.index("(", 1)]
        if kind in kinds:
            kinds[kind].append(number)
    first: dict[int, int] = {}
    for numbers in kinds.values():
        known: dict[str, int] = {}
        for number in numbers:
            value = instances[number] = _rename(instances[number], first)
            if known.setdefault(value, number) != number:
                first[number] = known[value]
    for number, value in instances.items():
        if number not in first:
            instances[number] = _rename(value, first)


def _renumber(instances: Instances, whole: list[int]) -> str:
    """The text of `whole` and all that they refer to, each before what it refers to first.

    OpenCASCADE gathers the colours of the parts of an assembly in no fixed order; here it is that of what they colour.
    """
    references = {number: _references(value) for number, value in instances.items()}

    def place(number: int) -> tuple[bool, int]:
        coloured = instances[number].startswith("MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION")
        return coloured, min(n for item in references[number] for n in references[item]) if coloured else number

    wanted = sorted(whole, key=place, reverse=True)
    names: dict[int, int] = {}
    while wanted:
        number = wanted.pop()
        if number not in names:
            names[number] = len(names) + 1
            wanted += reversed(references[number])
    lines = (f"#{new}={_rename(instances[old], names)};\n" for old, new in names.items())
    return "".join(_LINE.sub(r"\1\n", line) if len(line) > 500 else line for line in lines)
