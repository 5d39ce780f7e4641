"""Keys of what was measured of a gear set: files of points or deviations of the flanks of its members."""

from __future__ import annotations

from typing import Annotated

from gearmesh.design.keys import Key, Table


def measured_file(member: str, flank: str) -> Key:
    """Key of the file of a flank."""
    return Key("file", f"points or deviations measured on the {member}'s {flank} flank", default="as designed")


class MeasuredTable(Table):
    """How files of measured flanks are read."""

    axial_position: Annotated[
        str,
        Key(
            "choice",
            "of measured points: that of the file, or the one that fits best; rotation about the axis is always free",
            choices=("measured", "free"),
        ),
    ] = "measured"
    stiffness: Annotated[
        float | None,
        Key(
            "number",
            "stiffness of the smoothing spline through the deviations; 0 = none",
            low=0,
            high=1e3,
            default="0 for whole grids, else by cross-validation",
        ),
    ] = None


class PairMeasured(MeasuredTable):
    """Measured flanks of pinion and gear."""

    pinion_right: Annotated[str | None, measured_file("pinion", "right")] = None
    pinion_left: Annotated[str | None, measured_file("pinion", "left")] = None
    gear_right: Annotated[str | None, measured_file("gear", "right")] = None
    gear_left: Annotated[str | None, measured_file("gear", "left")] = None


class WormDriveMeasured(MeasuredTable):
    """Measured flanks of worm and wheel."""

    worm_right: Annotated[str | None, measured_file("worm", "right")] = None
    worm_left: Annotated[str | None, measured_file("worm", "left")] = None
    wheel_right: Annotated[str | None, measured_file("wheel", "right")] = None
    wheel_left: Annotated[str | None, measured_file("wheel", "left")] = None


class RackMeasured(MeasuredTable):
    """Measured flanks of pinion and rack."""

    pinion_right: Annotated[str | None, measured_file("pinion", "right")] = None
    pinion_left: Annotated[str | None, measured_file("pinion", "left")] = None
    rack_right: Annotated[str | None, measured_file("rack", "right")] = None
    rack_left: Annotated[str | None, measured_file("rack", "left")] = None


class PlanetaryMeasured(MeasuredTable):
    """Measured flanks of the members of a planetary gear set; all planets have the same."""

    sun_right: Annotated[str | None, measured_file("sun", "right")] = None
    sun_left: Annotated[str | None, measured_file("sun", "left")] = None
    planet_right: Annotated[str | None, measured_file("planet", "right")] = None
    planet_left: Annotated[str | None, measured_file("planet", "left")] = None
    ring_right: Annotated[str | None, measured_file("ring", "right")] = None
    ring_left: Annotated[str | None, measured_file("ring", "left")] = None
