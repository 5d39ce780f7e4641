"""Keys of measurements: points or deviations of the flanks of the members, their pitch deviations and runout."""

from __future__ import annotations

from typing import Any

from gearmesh.design import keys
from gearmesh.design.keys import Table

#: longest list of deviations of teeth
MAX_LISTED_TEETH = 1000
#: largest deviation in a list
MAX_DEVIATION_UM = 1000.0
#: largest seed of random pitch deviations
MAX_SEED = 999_999


def measured_file(member: str, flank: str) -> Any:
    """Return the key of the file of a flank."""
    return keys.file(f"points or deviations measured on the {member}'s {flank} flank", None, default="as designed")


def pitch_file(member: str) -> Any:
    """Return the key of the file of a member's pitch deviations."""
    return keys.file(
        f"pitch deviations and runout of all teeth of the {member}: columns tooth, right_um, left_um, runout_um",
        None,
        default="as designed",
    )


def pitch_list(member: str, flank: str) -> Any:
    """Return the key of the index deviations of the flanks of one side."""
    return keys.number(
        f"index deviations of the {flank} flanks of the {member}, um, tooth by tooth from the one on x, arcs of the reference "
        "circle as angles grow; their mean does not count",
        None,
        low=-MAX_DEVIATION_UM,
        high=MAX_DEVIATION_UM,
        most=MAX_LISTED_TEETH,
        default="those of the other side and the runout",
        source="[ISO 1328-1] 3",
    )


def radial_list(member: str) -> Any:
    """Return the key of the distances by which pins are farther from the axis than their circle says."""
    return keys.number(
        f"how far outwards the pins of the {member} are out of place, um, from the one on x; all of it counts",
        None,
        low=-MAX_DEVIATION_UM,
        high=MAX_DEVIATION_UM,
        most=MAX_LISTED_TEETH,
        default="none; of the member with pins alone",
    )


def runout_list(member: str) -> Any:
    """Return the key of the runout of all spaces."""
    return keys.number(
        f"how far outwards a ball rests in the spaces of the {member}, um, that before the tooth on x first; their mean does not "
        "count",
        None,
        low=-MAX_DEVIATION_UM,
        high=MAX_DEVIATION_UM,
        most=MAX_LISTED_TEETH,
        default="none",
        source="[ISO 1328-1] 3",
    )


def pitch_class(member: str) -> Any:
    """Return the key of the tolerance class of random pitch deviations."""
    return keys.count(
        f"tolerance class within which pitch deviations of the {member} are drawn, in the place of measured ones",
        None,
        low=1,
        high=12,
        default="accuracy_class or accuracy_grade where pitch_seed is given",
        source="[ISO 1328-1], [ISO 17485]",
    )


def pitch_seed(member: str) -> Any:
    """Return the key of the seed of random pitch deviations."""
    return keys.count(
        f"number by which pitch deviations of the {member} are drawn: one number, one gear",
        None,
        low=0,
        high=MAX_SEED,
        default="none; 0 where pitch_class is given",
    )


class MeasuredTable(Table):
    """Reading of files of measured flanks."""

    axial_position: str = keys.choice(
        "of measured points: that of the file, or the one that fits best; rotation about the axis is always free",
        ("measured", "free"),
        "measured",
    )
    stiffness: float | None = keys.number(
        "stiffness of the smoothing spline through the deviations; 0 = none",
        None,
        low=0,
        high=1e3,
        default="0 for whole grids, else by cross-validation",
    )


class PairMeasured(MeasuredTable):
    """Measured flanks and teeth of pinion and gear."""

    pinion_right: str | None = measured_file("pinion", "right")
    pinion_left: str | None = measured_file("pinion", "left")
    gear_right: str | None = measured_file("gear", "right")
    gear_left: str | None = measured_file("gear", "left")
    pinion_pitch: str | None = pitch_file("pinion")
    pinion_pitch_right_um: tuple[float, ...] | None = pitch_list("pinion", "right")
    pinion_pitch_left_um: tuple[float, ...] | None = pitch_list("pinion", "left")
    pinion_runout_um: tuple[float, ...] | None = runout_list("pinion")
    pinion_pitch_class: int | None = pitch_class("pinion")
    pinion_pitch_seed: int | None = pitch_seed("pinion")
    gear_pitch: str | None = pitch_file("gear")
    gear_pitch_right_um: tuple[float, ...] | None = pitch_list("gear", "right")
    gear_pitch_left_um: tuple[float, ...] | None = pitch_list("gear", "left")
    gear_runout_um: tuple[float, ...] | None = runout_list("gear")
    gear_pitch_class: int | None = pitch_class("gear")
    gear_pitch_seed: int | None = pitch_seed("gear")


class WormDriveMeasured(MeasuredTable):
    """Measured flanks and teeth of worm and wheel."""

    worm_right: str | None = measured_file("worm", "right")
    worm_left: str | None = measured_file("worm", "left")
    wheel_right: str | None = measured_file("wheel", "right")
    wheel_left: str | None = measured_file("wheel", "left")
    worm_pitch: str | None = pitch_file("worm")
    worm_pitch_right_um: tuple[float, ...] | None = pitch_list("worm", "right")
    worm_pitch_left_um: tuple[float, ...] | None = pitch_list("worm", "left")
    worm_runout_um: tuple[float, ...] | None = runout_list("worm")
    worm_pitch_class: int | None = pitch_class("worm")
    worm_pitch_seed: int | None = pitch_seed("worm")
    wheel_pitch: str | None = pitch_file("wheel")
    wheel_pitch_right_um: tuple[float, ...] | None = pitch_list("wheel", "right")
    wheel_pitch_left_um: tuple[float, ...] | None = pitch_list("wheel", "left")
    wheel_runout_um: tuple[float, ...] | None = runout_list("wheel")
    wheel_pitch_class: int | None = pitch_class("wheel")
    wheel_pitch_seed: int | None = pitch_seed("wheel")


class CycloidalMeasured(Table):
    """Measured places of the lobes of a cycloidal drive and of its pins."""

    disc_pitch: str | None = pitch_file("disc")
    disc_pitch_right_um: tuple[float, ...] | None = pitch_list("disc", "right")
    disc_pitch_left_um: tuple[float, ...] | None = pitch_list("disc", "left")
    disc_radial_um: tuple[float, ...] | None = radial_list("disc")
    ring_pitch: str | None = pitch_file("ring")
    ring_pitch_right_um: tuple[float, ...] | None = pitch_list("ring", "right")
    ring_pitch_left_um: tuple[float, ...] | None = pitch_list("ring", "left")
    ring_radial_um: tuple[float, ...] | None = radial_list("ring")


class RackMeasured(MeasuredTable):
    """Measured flanks of pinion and rack, and teeth of the pinion."""

    pinion_right: str | None = measured_file("pinion", "right")
    pinion_left: str | None = measured_file("pinion", "left")
    rack_right: str | None = measured_file("rack", "right")
    rack_left: str | None = measured_file("rack", "left")
    pinion_pitch: str | None = pitch_file("pinion")
    pinion_pitch_right_um: tuple[float, ...] | None = pitch_list("pinion", "right")
    pinion_pitch_left_um: tuple[float, ...] | None = pitch_list("pinion", "left")
    pinion_runout_um: tuple[float, ...] | None = runout_list("pinion")
    pinion_pitch_class: int | None = pitch_class("pinion")
    pinion_pitch_seed: int | None = pitch_seed("pinion")


class PlanetaryMeasured(MeasuredTable):
    """Measured flanks and teeth of the members of a planetary gear set; all planets have the same."""

    sun_right: str | None = measured_file("sun", "right")
    sun_left: str | None = measured_file("sun", "left")
    planet_right: str | None = measured_file("planet", "right")
    planet_left: str | None = measured_file("planet", "left")
    ring_right: str | None = measured_file("ring", "right")
    ring_left: str | None = measured_file("ring", "left")
    sun_pitch: str | None = pitch_file("sun")
    sun_pitch_right_um: tuple[float, ...] | None = pitch_list("sun", "right")
    sun_pitch_left_um: tuple[float, ...] | None = pitch_list("sun", "left")
    sun_runout_um: tuple[float, ...] | None = runout_list("sun")
    sun_pitch_class: int | None = pitch_class("sun")
    sun_pitch_seed: int | None = pitch_seed("sun")
    planet_pitch: str | None = pitch_file("planet")
    planet_pitch_right_um: tuple[float, ...] | None = pitch_list("planet", "right")
    planet_pitch_left_um: tuple[float, ...] | None = pitch_list("planet", "left")
    planet_runout_um: tuple[float, ...] | None = runout_list("planet")
    planet_pitch_class: int | None = pitch_class("planet")
    planet_pitch_seed: int | None = pitch_seed("planet")
    ring_pitch: str | None = pitch_file("ring")
    ring_pitch_right_um: tuple[float, ...] | None = pitch_list("ring", "right")
    ring_pitch_left_um: tuple[float, ...] | None = pitch_list("ring", "left")
    ring_runout_um: tuple[float, ...] | None = runout_list("ring")
    ring_pitch_class: int | None = pitch_class("ring")
    ring_pitch_seed: int | None = pitch_seed("ring")
