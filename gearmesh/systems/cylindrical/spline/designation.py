"""Designations of involute splines: text to profile, size and tolerances, in mm.

DIN 5480 W 45x2x21 8f / N 9H          DIN 5480 N 45x2x21 9H
ISO 4156 INT/EXT 24z x 2.5m x 30R x 5H/5f
ANSI B92.1 24T 12/24P 30 flat 5
"""

from __future__ import annotations

import re

from gearmesh.records import dataclass
from gearmesh.systems.cylindrical.spline.profiles import REFERENCE_MODULES, SPLINE_PROFILES

#: forms of designations, for refusals
DESIGNATION_FORMS = (
    'as "DIN 5480 W 45x2x21 8f / N 9H", "ISO 4156 INT/EXT 24z x 2.5m x 30P x 5H/5f" (P flat, R fillet root) or '
    '"ANSI B92.1 24T 12/24P 30 flat"'
)
_NUMBER_PATTERN = r"(\d+(?:[.,]\d+)?)"
_BY_PATTERN = r"\s*[x*\u00d7]\s*"
_GRADE_PATTERN = r"(\d+[A-Za-z]+)"
_DIN_PATTERN = re.compile(
    rf"DIN\s*5480\s*-?\s*([WN]?)\s*{_NUMBER_PATTERN}{_BY_PATTERN}{_NUMBER_PATTERN}(?:{_BY_PATTERN}30)?{_BY_PATTERN}(\d+)(?:(?:{_BY_PATTERN}|\s+){_GRADE_PATTERN})?"
    rf"(?:\s*/\s*([WN]?)\s*{_GRADE_PATTERN})?"
)
_ISO_PATTERN = re.compile(
    rf"ISO\s*4156\s*-?\s*(INT/EXT|INT|EXT)?\s*(\d+)\s*[zZ]{_BY_PATTERN}{_NUMBER_PATTERN}\s*m{_BY_PATTERN}{_NUMBER_PATTERN}\s*([PR])"
    rf"(?:{_BY_PATTERN}{_GRADE_PATTERN}(?:\s*/\s*{_GRADE_PATTERN})?)?"
)
_ANSI_PATTERN = re.compile(
    rf"ANSI\s*B92\.1\s*-?\s*(\d+)\s*[TzZ]\s*{_NUMBER_PATTERN}\s*/\s*{_NUMBER_PATTERN}\s*P?\s*{_NUMBER_PATTERN}\s*(flat|fillet)"
    r"(?:\s*(?:side fit)?\s*([4-7]))?"
)


@dataclass(frozen=True)
class Designation:
    """Size and tolerances that a designation gives."""

    #: name of the basic rack
    profile: str
    #: number of teeth
    teeth: int
    #: module, mm; None if it gives a diametral pitch
    module: float | None = None
    #: diametral pitch, 1/inch; None if it gives a module
    diametral_pitch: float | None = None
    #: reference diameter, mm; None without one
    reference_diameter: float | None = None
    #: tolerance of the shaft, "" without one
    shaft: str = ""
    #: tolerance of the hub, "" without one
    hub: str = ""


def parse_designation(text: str) -> Designation | str:
    """Return what a designation says, or the allowed forms as text."""
    stripped = " ".join(text.split())
    if (match := _DIN_PATTERN.fullmatch(stripped)) is not None:
        return _din(match)
    if (match := _ISO_PATTERN.fullmatch(stripped)) is not None:
        return _iso(match)
    if (match := _ANSI_PATTERN.fullmatch(stripped)) is not None:
        return _ansi(match)
    return DESIGNATION_FORMS


def _din(match: re.Match[str]) -> Designation | str:
    side, diameter, module, teeth, first, other, second = match.groups()
    grades = {"W": "", "N": ""}
    for which, grade in ((side, first), (other, second)):
        if grade:
            # hubs have capital letters
            grades[which or ("N" if grade[-1].isupper() else "W")] = grade
    m, reference = _value(module), _value(diameter)
    if not m > 0.0 or not reference > REFERENCE_MODULES * m:
        return DESIGNATION_FORMS
    return Designation("DIN 5480", int(teeth), m, None, reference, grades["W"], grades["N"])


def _iso(match: re.Match[str]) -> Designation | str:
    _, teeth, module, angle, root, first, second = match.groups()
    profile = f"ISO 4156 {_value(angle):g} {'flat' if root == 'P' else 'fillet'}"
    if profile not in SPLINE_PROFILES:
        return _angles("ISO 4156")
    grades = {True: "", False: ""}
    for grade in (first, second):
        if grade:
            grades[grade[-1].isupper()] = grade
    return Designation(profile, int(teeth), _value(module), shaft=grades[False], hub=grades[True])


def _ansi(match: re.Match[str]) -> Designation | str:
    teeth, pitch, stub, angle, root, number = match.groups()
    profile = f"ANSI B92.1 {_value(angle):g} {root}"
    if profile not in SPLINE_PROFILES:
        return _angles("ANSI B92.1")
    if _value(stub) != 2.0 * _value(pitch):
        return f"a second pitch of {2.0 * _value(pitch):g}, twice the first"
    return Designation(profile, int(teeth), diametral_pitch=_value(pitch), shaft=number or "", hub=number or "")


def _angles(standard: str) -> str:
    """Return the profiles of a standard as text."""
    return "one of " + ", ".join(f'"{name}"' for name in SPLINE_PROFILES if name.startswith(standard))


def _value(text: str) -> float:
    return float(text.replace(",", "."))
