"""The command `size`: pairs of cylindrical gears that have a ratio, a module and a centre distance, and planetary sets."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import gearmesh as gm
from gearmesh.app.options import Json, PressureAngle, option
from gearmesh.app.terminal import refuse_unwritable, show, working, write_text
from gearmesh.errors import ArgumentError, OutputError
from gearmesh.formats import TOML_SUFFIX, refuse_suffix
from gearmesh.lengths import in_mm
from gearmesh.numerals import parse_number, with_point
from gearmesh.records import dataclass


def size(
    ratio: Annotated[float, option("--ratio Z2/Z1", "Gear ratio.")],
    center_distance: Annotated[str | None, option("--center-distance LEN", "Centre distance; bare = mm.")] = None,
    module: Annotated[
        str | None, option("--module LEN", "Normal module; bare = mm. [default: planetary: all of ISO 54]")
    ] = None,
    internal: Annotated[bool, option("--internal", "The gear is internal.")] = False,
    planetary: Annotated[bool, option("--planetary", "Planetary sets instead of pairs.")] = False,
    outside_diameter: Annotated[
        str | None,
        option("--outside-diameter LEN", "Outside diameter of the ring with its rim, instead of --center-distance."),
    ] = None,
    planets: Annotated[int | None, option("--planets N", "Number of planets. [default: 3]")] = None,
    fixed: Annotated[
        str | None, option("--fixed ring|carrier|sun", "The fixed member, for the ratio. [default: ring]")
    ] = None,
    unequal: Annotated[
        bool,
        option("--unequal", "Also sets whose planets cannot be equally spaced, with planets at the nearest angles."),
    ] = False,
    helix: Annotated[str, option("--helix DEG[:DEG]", "Helix angle, or its range.")] = "0",
    shifts: Annotated[
        str, option("--shifts X[:X]", "Range of the sum of the profile shifts, of sun and planet.")
    ] = "-0.5:1.2",
    tolerance: Annotated[float, option("--tolerance PERCENT", "Permissible relative error of the ratio.")] = 1.0,
    pressure_angle: PressureAngle = 20.0,
    face_width: Annotated[str | None, option("--face-width LEN", "Width of all faces. [default: 10 modules]")] = None,
    most: Annotated[int, option("--most N", "Number of pairs to print, at most.", min=1)] = 20,
    choose: Annotated[int, option("--choose N", "The pair whose design to write.")] = 1,
    output: Annotated[Path | None, option("-o --output FILE.toml", "Write the design of the chosen pair.")] = None,
    json_file: Json = None,
) -> None:
    """Tooth numbers, helix angles and profile shifts with which cylindrical gears have a ratio and a centre distance.

    Lists all pairs: pairs without faults first, then by the worst specific sliding. With --planetary it lists sets of sun,
    planets and ring: sets without faults first, then sets with exactly the ratio, then by the largest module. Strength is not
    considered.
    """
    from gearmesh.design.files import with_version

    if output is not None:
        refuse_suffix(output, TOML_SUFFIX)
        if output.exists():
            raise OutputError("cannot write", output, reason="it exists already")
    for file in (output, json_file):
        refuse_unwritable(file)
    shared = Shared(
        pressure_angle,
        _range("--helix", helix),
        _range("--shifts", shifts),
        0.01 * tolerance,
        _optional("--face-width", face_width),
    )
    with working("sizes"):
        if planetary:
            if internal:
                raise ArgumentError("--internal", None, reason="cannot be given together with --planetary")
            of_sets: dict[str, Any] = {"planets": planets, "fixed": fixed}
            sets = gm.size_planetary(
                ratio,
                outside_diameter=_optional("--outside-diameter", outside_diameter),
                center_distance=_optional("--center-distance", center_distance),
                module=_optional("--module", module),
                unequal=unequal,
                **{name: value for name, value in of_sets.items() if value is not None},
                **vars(shared),
            )
            text, document, listings = with_version(sets.keys(choose)), sets.json, sets.first_sets(most)
        else:
            given = {
                "outside-diameter": outside_diameter,
                "planets": planets,
                "fixed": fixed,
                "unequal": unequal or None,
            }
            for option, value in given.items():
                if value is not None:
                    raise ArgumentError(f"--{option}", None, reason="needs --planetary")
            pairs = gm.size(
                ratio,
                _length("--center-distance", center_distance),
                _length("--module", module),
                internal=internal,
                **vars(shared),
            )
            text, document, listings = with_version(pairs.keys(choose)), pairs.json, pairs.first_pairs(most)
    write_text(json_file, document)
    if output is not None:
        write_text(str(output), lambda: text)
    if json_file != "-":
        show(listings)


@dataclass(frozen=True)
class Shared:
    """Requirements for pairs and for planetary sets."""

    #: normal pressure angle, deg
    pressure_angle: float
    #: range of the helix angle, deg
    helix: tuple[float, float]
    #: range of the sum of the profile shift coefficients, for sets of sun and planet
    shifts: tuple[float, float]
    #: permissible relative error of the ratio
    tolerance: float
    #: width of all faces, mm, None for the default
    face_width: float | None


def _optional(option: str, text: str | None) -> float | None:
    return None if text is None else _length(option, text)


def _length(option: str, text: str | None) -> float:
    if text is None:
        raise ArgumentError(option, None, reason="missing; give a length as 64mm or 2.5in")
    return in_mm(option, text, examples="64mm or 2.5in; bare = mm")


def _range(option: str, text: str) -> tuple[float, float]:
    low, colon, high = text.partition(":")
    first, last = parse_number(low), parse_number(high if colon else low)
    if first is None or last is None:
        raise ArgumentError(option, text, must_be="a number, or two as LOW:HIGH", remedy=with_point(text))
    return first, last
