"""Micro-geometry in a design file: tables of what is removed from the flanks of a member [ISO 21771-1; REXS 1.6].

`[pinion.modifications]` is for both flanks; `modifications_right` and `modifications_left` are added to it on theirs.
"""

from __future__ import annotations

from typing import Any, ClassVar, Self

from pydantic import model_validator

from gearmesh.design import keys
from gearmesh.design.keys import Table, conflict

#: shapes of a relief at its start
RELIEF_SHAPES = ("linear", "parabolic", "circular")
#: tools whose radial feed crowns flanks, and a crowning without twist
CROWNING_TOOLS = ("none", "worm", "disk")
#: largest amount
MAX_AMOUNT_MM = 5.0
#: source of the definitions
STANDARD_NAME = "ISO 21771-1"


def relief_amount() -> Any:
    """Return the key of the amount of a relief."""
    return keys.length("material removed at the end of the relief", above=0, high=MAX_AMOUNT_MM)


def relief_shape() -> Any:
    """Return the key of the shape of a relief."""
    about = "how it begins: with a corner, or tangent as a parabola or a circle"
    return keys.choice(about, RELIEF_SHAPES, "linear")


class ProfileRelief(Table):
    """Relief from a start on the profile to its tip or root form circle."""

    replaces: ClassVar = (
        ("start_roll_length", "start_diameter"),
        ("start_height", "start_diameter"),
        ("start_height", "start_roll_length"),
    )

    amount: float = relief_amount()
    start_diameter: float | None = keys.length(
        "diameter at which it begins", None, above=0, default="by start_roll_length"
    )
    start_roll_length: float | None = keys.length(
        "roll length at which it begins", None, above=0, default="by start_diameter"
    )
    start_height: float | None = keys.length(
        "of a rack: height over the reference plane at which it begins", None, default="gears: by diameter"
    )
    shape: str = relief_shape()

    @model_validator(mode="after")
    def _one_start(self) -> Self:
        if all(value is None for value in (self.start_diameter, self.start_roll_length, self.start_height)):
            raise conflict(
                "start_diameter",
                None,
                reason="missing; give start_diameter or start_roll_length, of a rack start_height",
            )
        return self

    @property
    def start(self) -> tuple[str, float]:
        """Start of the relief: "roll_length", "diameter" or "height", and its value in the design's units."""
        starts = {
            "roll_length": self.start_roll_length,
            "diameter": self.start_diameter,
            "height": self.start_height,
        }
        return next((name, value) for name, value in starts.items() if value is not None)


class EndRelief(Table):
    """Relief over the last part of the face."""

    amount: float = relief_amount()
    length: float = keys.length("distance from the end of the face at which it begins", above=0)
    shape: str = relief_shape()


class TriangularRelief(Table):
    """Relief of the corner that contact lines cut off, parabolic across them."""

    amount: float = relief_amount()
    length: float = keys.length("distance along the face from the corner at which it begins", above=0)


class Modifications(Table):
    """Material removed from the flanks, in the transverse plane along the line of action; all amounts add up."""

    listed_apart: ClassVar = "modifications"

    tip_relief: ProfileRelief | None = None
    root_relief: ProfileRelief | None = None
    profile_crowning: float = keys.length(
        "removed at root and tip form circle, by a parabola",
        0.0,
        low=-MAX_AMOUNT_MM,
        high=MAX_AMOUNT_MM,
        source=STANDARD_NAME,
    )
    profile_slope: float = keys.length(
        "removed at the tip; negative: at the root", 0.0, low=-MAX_AMOUNT_MM, high=MAX_AMOUNT_MM, source=STANDARD_NAME
    )
    profile_twist: float = keys.length(
        "profile slope at the heel less that at the toe",
        0.0,
        low=-MAX_AMOUNT_MM,
        high=MAX_AMOUNT_MM,
        source=STANDARD_NAME,
    )
    helix_crowning: float = keys.length(
        "removed at toe and heel, by a parabola", 0.0, low=-MAX_AMOUNT_MM, high=MAX_AMOUNT_MM, source=STANDARD_NAME
    )
    crowning_tool: str = keys.choice(
        "tool whose radial feed makes the helix crowning and so twists the flanks: a worm (hob or threaded wheel) or a disk; "
        "none: no twist",
        CROWNING_TOOLS,
        "none",
    )
    crowning_disk_diameter: float | None = keys.length(
        "diameter of the disk where it meets the reference circle", None, above=0, default="needed by the disk"
    )
    helix_slope: float = keys.length(
        "removed at the heel; negative: at the toe", 0.0, low=-MAX_AMOUNT_MM, high=MAX_AMOUNT_MM, source=STANDARD_NAME
    )
    end_relief_toe: EndRelief | None = None
    end_relief_heel: EndRelief | None = None
    triangular_end_relief_tip: TriangularRelief | None = None
    triangular_end_relief_root: TriangularRelief | None = None
    topography: str | None = keys.file(
        "CSV file of amounts over roll length or diameter and face position", None, default="none"
    )

    @model_validator(mode="after")
    def _disk_given(self) -> Self:
        """Refuse a disk without its diameter, and a diameter without its disk."""
        disk, diameter = self.crowning_tool == "disk", self.crowning_disk_diameter
        if disk and diameter is None:
            raise conflict("crowning_disk_diameter", None, reason='missing; crowning_tool = "disk" needs it')
        if diameter is not None and not disk:
            raise conflict("crowning_disk_diameter", diameter, reason='needs crowning_tool = "disk"')
        return self


class Modified(Table):
    """A member whose flanks may be modified."""

    modifications: Modifications | None = None
    modifications_right: Modifications | None = None
    modifications_left: Modifications | None = None

    @property
    def modified(self) -> bool:
        """True if the flanks have any modification."""
        return any((self.modifications, self.modifications_right, self.modifications_left))
