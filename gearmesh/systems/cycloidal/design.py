"""Design of a cycloidal drive: pins on a circle, and a member with lobes that they generate.

Pins are in the ring and the disc has lobes, or the other way round. Both turn about parallel axes, a distance apart that
is the eccentricity.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Self

from pydantic import model_validator

from gearmesh.allowed import Allowed
from gearmesh.design import keys
from gearmesh.design.core import Design, FlankContact, MemberTable
from gearmesh.design.keys import DERIVED_VALUE, Table, conflict
from gearmesh.design.measured import CycloidalMeasured, MeasuredMember
from gearmesh.design.runout import eccentricity, phase
from gearmesh.member_names import MemberNames
from gearmesh.systems.kinds import OWN_KINDS

#: name of the disc's table in a design
DISC_NAME = "disc"
#: name of the ring's table in a design
RING_NAME = "ring"
#: largest difference of the tooth numbers
MAX_DIFFERENCE = 2
#: default rim of the ring behind the pins, in pin diameters
RIM_PINS = 1.0
#: default gap between the lobes and the surface that holds the pins, in pin diameters
GAP_PINS = 0.05
#: default land of lobes that two branches of the curve cross over, in pin diameters
LAND_PINS = 0.1

#: default gap between the faces of neighbouring discs, in face widths of a disc
DISC_GAP_WIDTHS = 0.1
#: relative rounding of a face width that counts as equal
FACE_ROUNDING = 1e-9
#: largest number of discs
MAX_DISCS = 3
#: largest rotation (deg) of lobes against the output holes
MAX_AHEAD_DEG = 1.0

_NO_EDGE = "the lobes of a cycloidal drive pass smoothly from flank to flank, and pins are round"
_NO_OFFSET = "follows from eccentricity and tooth numbers: twice the eccentricity over their difference"


class CycloidalMember(MemberTable):
    """A member of a cycloidal drive: pins or lobes between plane end faces."""

    absent: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("tip_chamfer", "tip_rounding"), _NO_EDGE),
        "stock": "lobes are ground by a wheel of another pin: see the table modification",
    }


class OutputPins(Table):
    """Output pins, and the holes for them in the disc: as wide as pin, twice the eccentricity, and clearance."""

    pins: int = keys.count("number of output pins", low=2, high=200)
    pin_diameter: float = keys.length("diameter of the pins, of their rollers if they have some", above=0)
    circle: float | None = keys.length(
        "diameter of the circle through the pins' axes", None, above=0, default="in the middle of bore and lobes"
    )
    clearance: float = keys.length("diameter of a hole beyond pin and twice the eccentricity", 0.0, low=0)


class CycloidalDisc(CycloidalMember):
    """The disc, on the eccentric."""

    absent: ClassVar[Mapping[str, str]] = {**CycloidalMember.absent, "holes": "give the table output, or bolts"}


class CycloidalRing(CycloidalMember):
    """The ring around the disc."""

    absent: ClassVar[Mapping[str, str]] = {
        **CycloidalMember.absent,
        **dict.fromkeys(
            ("bore", "hex_bore", "d_bore", "keyway", "hub", "toe_hub", "heel_shaft", "toe_shaft", "web"),
            "the ring has its body outside of the teeth",
        ),
    }

    rim: float | None = keys.length(
        "rim outside of the pins' circle, or of the root of the lobes",
        None,
        above=0,
        default=f"{0.5 + RIM_PINS:g} pin diameters outside of the circle, or {RIM_PINS:g} outside of the lobes",
    )


class GrindingTable(Table):
    """Modifications of the lobes: they are ground as by pins of another size and place."""

    needs: ClassVar = (("tip_relief_start", "tip_relief", "tip_relief"),)

    equidistant: float = keys.length(
        "radius of the grinding pin beyond that of the pins; half of the backlash is added: lobes become smaller", 0.0
    )
    offset: float = keys.length(
        "radius of the circle of the grinding pin beyond that of the pins: lobes become larger", 0.0
    )
    rotation: float = keys.angle(
        "rotation of each flank towards the middle of its lobe, ground in two passes; the lobes then end in a land",
        0.0,
        low=0,
        high=2,
    )
    tip_relief: float = keys.length(
        "removed at the tip of the lobes, by a parabola over the radius", 0.0, low=0, high=5
    )
    tip_relief_start: float | None = keys.length(
        "diameter at which the relief of the tip begins, without it half way up the lobes", None, above=0
    )


class CycloidalAssembly(Table):
    """Assembly errors: the disc's axis moves from its nominal place."""

    dx: float = keys.length("change of the eccentricity: the disc's axis away from the ring's", 0.0)
    dy: float = keys.length("displacement of the disc's axis across the eccentricity", 0.0)
    dz: float = keys.length("displacement of the disc along its axis", 0.0)
    disc_eccentricity: float = eccentricity(DISC_NAME)
    disc_phase: float = phase(DISC_NAME)
    ring_eccentricity: float = eccentricity(RING_NAME)
    ring_phase: float = phase(RING_NAME)
    disc_ahead: tuple[float, ...] = keys.angle(
        "rotation of the lobes of each disc against its output holes, as phi1 grows, one for each disc; it decides how the discs "
        "share the torque",
        (),
        low=-MAX_AHEAD_DEG,
        high=MAX_AHEAD_DEG,
        most=MAX_DISCS,
    )


class CycloidalDesign(Design):
    """A cycloidal drive."""

    usual: ClassVar[tuple[str, ...]] = ("eccentricity", "pin_circle", "pin_diameter")
    absent: ClassVar[Mapping[str, str]] = {
        **dict.fromkeys(("module", "diametral_pitch"), _NO_OFFSET),
    }
    own_kind: ClassVar[str] = "cycloidal"
    example: ClassVar[Mapping[str, Any]] = {
        "eccentricity": 1.5,
        "pin_circle": 100,
        "pin_diameter": 10,
        "disc": {"teeth": 19, "face_width": 12},
        "ring": {"teeth": 20, "face_width": 12},
    }
    about: ClassVar[str] = OWN_KINDS["cycloidal"].about
    called: ClassVar[str] = "Cycloidal drive"

    eccentricity: float = keys.length("distance of the axes of disc and ring", above=0)
    pin_circle: float = keys.length("diameter of the circle through the pins' axes", above=0)
    pin_diameter: float = keys.length("diameter of the pins, of their rollers if they have some", above=0)
    form: str = keys.choice(
        "which member has the pins; the other one has lobes", ("pins_in_ring", "pins_in_disc"), "pins_in_ring"
    )
    support_diameter: float = keys.length(
        "diameter of the surface between the pins, which holds them",
        DERIVED_VALUE,
        above=0,
        default=f"the pins' circle, or what leaves a gap of {GAP_PINS:g} pin diameters to the lobes",
    )
    discs: int = keys.count("number of discs, on eccentrics evenly spaced around the axis", 1, low=1, high=MAX_DISCS)
    disc_gap: float | None = keys.length(
        "gap between the faces of neighbouring discs",
        None,
        low=0,
        default=f"{DISC_GAP_WIDTHS:g} face widths of a disc; there is none with one disc",
    )
    lobe_diameter: float | None = keys.length(
        "diameter at which the lobes are cut off; without it they are whole, or with a rotation or a difference of two have "
        f"a land of {LAND_PINS:g} pin diameters",
        None,
        above=0,
    )
    modification: GrindingTable = GrindingTable()
    disc: CycloidalDisc
    ring: CycloidalRing
    output: OutputPins | None = None
    assembly: CycloidalAssembly = CycloidalAssembly()
    measured: CycloidalMeasured | None = None
    contact: FlankContact = FlankContact()

    @property
    def member_names(self) -> MemberNames:
        """Discs and ring, which mesh, and output pins."""
        return MemberNames(tuple((name, RING_NAME) for name in self.disc_names), carried=self.output_pin_names)

    @property
    def disc_names(self) -> tuple[str, ...]:
        """Names of the discs: "disc", or "disc_1", "disc_2" and so on."""
        return (DISC_NAME,) if self.discs == 1 else tuple(f"{DISC_NAME}_{k + 1}" for k in range(self.discs))

    @property
    def output_pin_names(self) -> tuple[str, ...]:
        """Names of the output pins: "output_pin_1" and so on."""
        return () if self.output is None else tuple(f"output_pin_{k + 1}" for k in range(self.output.pins))

    @property
    def arm_angles(self) -> tuple[float, ...]:
        """Angles (rad) of the eccentrics of all discs about the axis of the ring; the first is on x."""
        return tuple(2.0 * math.pi * k / self.discs for k in range(self.discs))

    @property
    def disc_places(self) -> tuple[float, ...]:
        """Distances of the middles of all discs from the first along the axis."""
        gap = DISC_GAP_WIDTHS * self.disc.face_width if self.disc_gap is None else self.disc_gap
        return tuple(k * (self.disc.face_width + gap) for k in range(self.discs))

    @property
    def counted_teeth(self) -> int:
        return self.disc.teeth

    @property
    def pins_in_ring(self) -> bool:
        """True if the pins are in the ring, False if they are in the disc."""
        return self.form == "pins_in_ring"

    @property
    def difference(self) -> int:
        """Teeth of the ring less those of the disc."""
        return self.ring.teeth - self.disc.teeth

    @property
    def given_module(self) -> float:
        """Module of the pitch circles: twice the eccentricity over the difference of the tooth numbers."""
        return 2.0 * self.eccentricity / self.difference

    @property
    def _size(self) -> str:
        return f", e = {self.eccentricity:g} {self.units}"

    def derived_values(self) -> dict[str, float]:
        return {**super().derived_values(), "support_diameter": self._usual_support}

    @property
    def _usual_support(self) -> float:
        """Diameter of the surface between the pins: their circle, or beyond the lobes' way."""
        gap = GAP_PINS * self.pin_diameter
        reach = 0.5 * (self.pin_circle - self.pin_diameter) + 2.0 * self.eccentricity + gap
        if self.pins_in_ring:
            return max(self.pin_circle, 2.0 * reach)
        reach = 0.5 * (self.pin_circle + self.pin_diameter) - 2.0 * self.eccentricity - gap
        return min(self.pin_circle, 2.0 * reach)

    @model_validator(mode="after")
    def _one_size(self) -> Self:
        """Refuse tooth numbers whose difference is not 1 or 2; the eccentricity gives the size."""
        if not 1 <= self.difference <= MAX_DIFFERENCE:
            allowed = " or ".join(str(self.disc.teeth + more) for more in range(1, MAX_DIFFERENCE + 1))
            raise conflict("ring.teeth", self.ring.teeth, must_be=f"{allowed}, 1 or 2 more than disc.teeth")
        return self

    @model_validator(mode="after")
    def _several_discs(self) -> Self:
        """Refuse a gap without a second disc, a ring that does not reach all discs, and rotations of other discs."""
        ahead = self.assembly.disc_ahead
        if ahead and (self.discs == 1 or len(ahead) != self.discs):
            reason = "there is one disc" if self.discs == 1 else f"there are {self.discs} discs"
            allowed = "left out, or 2 discs" if self.discs == 1 else f"{self.discs} values"
            raise conflict("assembly.disc_ahead", f"{len(ahead)} values", reason=reason, allowed=allowed)
        if self.discs == 1:
            if self.disc_gap is not None:
                raise conflict("disc_gap", self.disc_gap, reason="there is one disc", allowed="left out, or 2 discs")
            return self
        for name, table in ((DISC_NAME, self.disc), (RING_NAME, self.ring)):
            if table.mount is not None:
                table.mount.refuse_stiffness(
                    f"{name}.mount",
                    "must be left out with several discs: several discs share the torque on rigid bearings",
                )
        least = self.disc_places[-1] + self.disc.face_width
        if self.ring.face_width < least * (1.0 - FACE_ROUNDING):
            raise conflict(
                "ring.face_width",
                self.ring.face_width,
                reason=f"{self.discs} discs are wider",
                allowed=Allowed.at_least(least, self.units),
            )
        return self

    @model_validator(mode="after")
    def _pins_out_of_place(self) -> Self:
        """Refuse lobes that are farther out: pins alone are single parts."""
        lobed, pinned = (DISC_NAME, RING_NAME) if self.pins_in_ring else (RING_NAME, DISC_NAME)
        key = MeasuredMember(lobed).farther_out
        given = None if self.measured is None else getattr(self.measured, key)
        if given is not None:
            raise conflict(
                f"measured.{key}",
                f"{len(given)} values",
                reason=f"the {lobed} has lobes",
                allowed=f"measured.{MeasuredMember(pinned).farther_out}",
            )
        return self

    @model_validator(mode="after")
    def _shortened(self) -> Self:
        """Refuse an eccentricity with which the pitch circle of the pins is not inside of their centres."""
        pins = self.ring.teeth if self.pins_in_ring else self.disc.teeth
        most = 0.5 * self.pin_circle * self.difference / pins
        if not self.eccentricity < most:
            raise conflict(
                "eccentricity",
                self.eccentricity,
                reason="the curve of the pins' centres has loops",
                allowed=Allowed.less_than(most, self.units, "pin_circle (ring.teeth - disc.teeth) / (2 pins)"),
            )
        return self

    @model_validator(mode="after")
    def _apart(self) -> Self:
        """Refuse pins that touch each other."""
        pins = self.ring.teeth if self.pins_in_ring else self.disc.teeth
        most = self.pin_circle * math.sin(math.pi / pins)
        if not self.pin_diameter < most:
            raise conflict(
                "pin_diameter",
                self.pin_diameter,
                reason=f"{pins} pins on this circle touch each other",
                allowed=Allowed.less_than(most, self.units),
            )
        return self
