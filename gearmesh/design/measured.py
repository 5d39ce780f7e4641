"""Keys of measurements: points or deviations of the flanks of the members, their pitch deviations and runout."""

from __future__ import annotations

from typing import Annotated

from gearmesh.design.keys import Key, Table

#: longest list of deviations of teeth
MAX_LISTED_TEETH = 1000
#: largest deviation in a list
MAX_DEVIATION_UM = 1000.0
#: largest seed of random pitch deviations
MAX_SEED = 999_999


def measured_file(member: str, flank: str) -> Key:
    """Return the key of the file of a flank."""
    return Key("file", f"points or deviations measured on the {member}'s {flank} flank", default="as designed")


def pitch_file(member: str) -> Key:
    """Return the key of the file of a member's pitch deviations."""
    return Key(
        "file",
        f"pitch deviations and runout of all teeth of the {member}: columns tooth, right_um, left_um, runout_um",
        default="as designed",
    )


def pitch_list(member: str, flank: str) -> Key:
    """Return the key of the index deviations of the flanks of one side."""
    return Key(
        "number",
        f"index deviations of the {flank} flanks of the {member}, um, tooth by tooth from the one on x, arcs of the reference "
        "circle as angles grow; their mean does not count",
        low=-MAX_DEVIATION_UM,
        high=MAX_DEVIATION_UM,
        most=MAX_LISTED_TEETH,
        default="those of the other side and the runout",
        source="[ISO 1328-1] 3",
    )


def runout_list(member: str) -> Key:
    """Return the key of the runout of all spaces."""
    return Key(
        "number",
        f"how far outwards a ball rests in the spaces of the {member}, um, that before the tooth on x first; their mean does not "
        "count",
        low=-MAX_DEVIATION_UM,
        high=MAX_DEVIATION_UM,
        most=MAX_LISTED_TEETH,
        default="none",
        source="[ISO 1328-1] 3",
    )


def pitch_class(member: str) -> Key:
    """Return the key of the tolerance class of random pitch deviations."""
    return Key(
        "count",
        f"tolerance class within which pitch deviations of the {member} are drawn, in the place of measured ones",
        low=1,
        high=12,
        default="accuracy_class or accuracy_grade where pitch_seed is given",
        source="[ISO 1328-1], [ISO 17485]",
    )


def pitch_seed(member: str) -> Key:
    """Return the key of the seed of random pitch deviations."""
    return Key(
        "count",
        f"number by which pitch deviations of the {member} are drawn: one number, one gear",
        low=0,
        high=MAX_SEED,
        default="none; 0 where pitch_class is given",
    )


class MeasuredTable(Table):
    """Reading of files of measured flanks."""

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
    """Measured flanks and teeth of pinion and gear."""

    pinion_right: Annotated[str | None, measured_file("pinion", "right")] = None
    pinion_left: Annotated[str | None, measured_file("pinion", "left")] = None
    gear_right: Annotated[str | None, measured_file("gear", "right")] = None
    gear_left: Annotated[str | None, measured_file("gear", "left")] = None
    pinion_pitch: Annotated[str | None, pitch_file("pinion")] = None
    pinion_pitch_right_um: Annotated[tuple[float, ...] | None, pitch_list("pinion", "right")] = None
    pinion_pitch_left_um: Annotated[tuple[float, ...] | None, pitch_list("pinion", "left")] = None
    pinion_runout_um: Annotated[tuple[float, ...] | None, runout_list("pinion")] = None
    pinion_pitch_class: Annotated[int | None, pitch_class("pinion")] = None
    pinion_pitch_seed: Annotated[int | None, pitch_seed("pinion")] = None
    gear_pitch: Annotated[str | None, pitch_file("gear")] = None
    gear_pitch_right_um: Annotated[tuple[float, ...] | None, pitch_list("gear", "right")] = None
    gear_pitch_left_um: Annotated[tuple[float, ...] | None, pitch_list("gear", "left")] = None
    gear_runout_um: Annotated[tuple[float, ...] | None, runout_list("gear")] = None
    gear_pitch_class: Annotated[int | None, pitch_class("gear")] = None
    gear_pitch_seed: Annotated[int | None, pitch_seed("gear")] = None


class WormDriveMeasured(MeasuredTable):
    """Measured flanks and teeth of worm and wheel."""

    worm_right: Annotated[str | None, measured_file("worm", "right")] = None
    worm_left: Annotated[str | None, measured_file("worm", "left")] = None
    wheel_right: Annotated[str | None, measured_file("wheel", "right")] = None
    wheel_left: Annotated[str | None, measured_file("wheel", "left")] = None
    worm_pitch: Annotated[str | None, pitch_file("worm")] = None
    worm_pitch_right_um: Annotated[tuple[float, ...] | None, pitch_list("worm", "right")] = None
    worm_pitch_left_um: Annotated[tuple[float, ...] | None, pitch_list("worm", "left")] = None
    worm_runout_um: Annotated[tuple[float, ...] | None, runout_list("worm")] = None
    worm_pitch_class: Annotated[int | None, pitch_class("worm")] = None
    worm_pitch_seed: Annotated[int | None, pitch_seed("worm")] = None
    wheel_pitch: Annotated[str | None, pitch_file("wheel")] = None
    wheel_pitch_right_um: Annotated[tuple[float, ...] | None, pitch_list("wheel", "right")] = None
    wheel_pitch_left_um: Annotated[tuple[float, ...] | None, pitch_list("wheel", "left")] = None
    wheel_runout_um: Annotated[tuple[float, ...] | None, runout_list("wheel")] = None
    wheel_pitch_class: Annotated[int | None, pitch_class("wheel")] = None
    wheel_pitch_seed: Annotated[int | None, pitch_seed("wheel")] = None


class RackMeasured(MeasuredTable):
    """Measured flanks of pinion and rack, and teeth of the pinion."""

    pinion_right: Annotated[str | None, measured_file("pinion", "right")] = None
    pinion_left: Annotated[str | None, measured_file("pinion", "left")] = None
    rack_right: Annotated[str | None, measured_file("rack", "right")] = None
    rack_left: Annotated[str | None, measured_file("rack", "left")] = None
    pinion_pitch: Annotated[str | None, pitch_file("pinion")] = None
    pinion_pitch_right_um: Annotated[tuple[float, ...] | None, pitch_list("pinion", "right")] = None
    pinion_pitch_left_um: Annotated[tuple[float, ...] | None, pitch_list("pinion", "left")] = None
    pinion_runout_um: Annotated[tuple[float, ...] | None, runout_list("pinion")] = None
    pinion_pitch_class: Annotated[int | None, pitch_class("pinion")] = None
    pinion_pitch_seed: Annotated[int | None, pitch_seed("pinion")] = None


class PlanetaryMeasured(MeasuredTable):
    """Measured flanks and teeth of the members of a planetary gear set; all planets have the same."""

    sun_right: Annotated[str | None, measured_file("sun", "right")] = None
    sun_left: Annotated[str | None, measured_file("sun", "left")] = None
    planet_right: Annotated[str | None, measured_file("planet", "right")] = None
    planet_left: Annotated[str | None, measured_file("planet", "left")] = None
    ring_right: Annotated[str | None, measured_file("ring", "right")] = None
    ring_left: Annotated[str | None, measured_file("ring", "left")] = None
    sun_pitch: Annotated[str | None, pitch_file("sun")] = None
    sun_pitch_right_um: Annotated[tuple[float, ...] | None, pitch_list("sun", "right")] = None
    sun_pitch_left_um: Annotated[tuple[float, ...] | None, pitch_list("sun", "left")] = None
    sun_runout_um: Annotated[tuple[float, ...] | None, runout_list("sun")] = None
    sun_pitch_class: Annotated[int | None, pitch_class("sun")] = None
    sun_pitch_seed: Annotated[int | None, pitch_seed("sun")] = None
    planet_pitch: Annotated[str | None, pitch_file("planet")] = None
    planet_pitch_right_um: Annotated[tuple[float, ...] | None, pitch_list("planet", "right")] = None
    planet_pitch_left_um: Annotated[tuple[float, ...] | None, pitch_list("planet", "left")] = None
    planet_runout_um: Annotated[tuple[float, ...] | None, runout_list("planet")] = None
    planet_pitch_class: Annotated[int | None, pitch_class("planet")] = None
    planet_pitch_seed: Annotated[int | None, pitch_seed("planet")] = None
    ring_pitch: Annotated[str | None, pitch_file("ring")] = None
    ring_pitch_right_um: Annotated[tuple[float, ...] | None, pitch_list("ring", "right")] = None
    ring_pitch_left_um: Annotated[tuple[float, ...] | None, pitch_list("ring", "left")] = None
    ring_runout_um: Annotated[tuple[float, ...] | None, runout_list("ring")] = None
    ring_pitch_class: Annotated[int | None, pitch_class("ring")] = None
    ring_pitch_seed: Annotated[int | None, pitch_seed("ring")] = None
