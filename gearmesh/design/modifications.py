"""Micro-geometry in a design file: tables of what is removed from the flanks of a member [ISO 21771-1; REXS 1.6].

`[pinion.modifications]` is for both flanks; `modifications_right` and `modifications_left` are added to it on theirs.
"""

from __future__ import annotations

from typing import Annotated, ClassVar, Self

from pydantic import model_validator

from gearmesh.design.keys import Key, Table, conflict

#: shapes of a relief at its start
RELIEF_SHAPES = ("linear", "parabolic", "circular")
#: largest amount
MAX_AMOUNT_MM = 5.0
#: source of the definitions
STANDARD_NAME = "ISO 21771-1"

Removed = Annotated[
    float, Key("length", "material removed at the end of the relief", low=0, high=MAX_AMOUNT_MM, above=True)
]
Begun = Annotated[
    str, Key("choice", "how it begins: with a corner, or tangent as a parabola or a circle", choices=RELIEF_SHAPES)
]


class ProfileRelief(Table):
    """Relief from a start on the profile to its tip or root form circle."""

    replaces: ClassVar = (
        ("start_roll_length", "start_diameter"),
        ("start_height", "start_diameter"),
        ("start_height", "start_roll_length"),
    )

    amount: Removed
    start_diameter: Annotated[
        float | None, Key("length", "diameter at which it begins", low=0, above=True, default="by start_roll_length")
    ] = None
    start_roll_length: Annotated[
        float | None, Key("length", "roll length at which it begins", low=0, above=True, default="by start_diameter")
    ] = None
    start_height: Annotated[
        float | None,
        Key("length", "of a rack: height over the reference plane at which it begins", default="gears: by diameter"),
    ] = None
    shape: Begun = "linear"

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

    amount: Removed
    length: Annotated[float, Key("length", "distance from the end of the face at which it begins", low=0, above=True)]
    shape: Begun = "linear"


class TriangularRelief(Table):
    """Relief of the corner that contact lines cut off, parabolic across them."""

    amount: Removed
    length: Annotated[
        float, Key("length", "distance along the face from the corner at which it begins", low=0, above=True)
    ]


class Modifications(Table):
    """Material removed from the flanks, in the transverse plane along the line of action; all amounts add up."""

    listed_apart: ClassVar = "modifications"

    tip_relief: ProfileRelief | None = None
    root_relief: ProfileRelief | None = None
    profile_crowning: Annotated[
        float,
        Key(
            "length",
            "removed at root and tip form circle, by a parabola",
            low=-MAX_AMOUNT_MM,
            high=MAX_AMOUNT_MM,
            source=STANDARD_NAME,
        ),
    ] = 0.0
    profile_slope: Annotated[
        float,
        Key(
            "length",
            "removed at the tip; negative: at the root",
            low=-MAX_AMOUNT_MM,
            high=MAX_AMOUNT_MM,
            source=STANDARD_NAME,
        ),
    ] = 0.0
    profile_twist: Annotated[
        float,
        Key(
            "length",
            "profile slope at the heel less that at the toe",
            low=-MAX_AMOUNT_MM,
            high=MAX_AMOUNT_MM,
            source=STANDARD_NAME,
        ),
    ] = 0.0
    helix_crowning: Annotated[
        float,
        Key(
            "length",
            "removed at toe and heel, by a parabola",
            low=-MAX_AMOUNT_MM,
            high=MAX_AMOUNT_MM,
            source=STANDARD_NAME,
        ),
    ] = 0.0
    helix_slope: Annotated[
        float,
        Key(
            "length",
            "removed at the heel; negative: at the toe",
            low=-MAX_AMOUNT_MM,
            high=MAX_AMOUNT_MM,
            source=STANDARD_NAME,
        ),
    ] = 0.0
    end_relief_toe: EndRelief | None = None
    end_relief_heel: EndRelief | None = None
    triangular_end_relief_tip: TriangularRelief | None = None
    triangular_end_relief_root: TriangularRelief | None = None
    topography: Annotated[
        str | None, Key("file", "CSV file of amounts over roll length or diameter and face position", default="none")
    ] = None


class Modified(Table):
    """A member whose flanks may be modified."""

    modifications: Modifications | None = None
    modifications_right: Modifications | None = None
    modifications_left: Modifications | None = None

    @property
    def modified(self) -> bool:
        """True if the flanks have any modification."""
        return any((self.modifications, self.modifications_right, self.modifications_left))
