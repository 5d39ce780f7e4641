"""Design of a worm drive: a worm of one of the flank forms of ISO 10828, and a wheel as its hob generates it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Self

from pydantic import model_validator

from gearmesh.design.core import Design, FlankContact, MemberBody, MemberTable, RexsSource
from gearmesh.design.keys import DERIVED, Key, Table, conflict, given_or
from gearmesh.design.measured import WormDriveMeasured
from gearmesh.design.runout import eccentricity, phase
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.common.standards.iso10828 import ThreadForm, lead_angle
from gearmesh.systems.kinds import KINDS

#: Proportions that are not given, in axial modules [DIN 3975]: diameter quotient, clearance, the wheel's outside over its throat.
QUOTIENT, CLEARANCE, OUTSIDE = 10.0, 0.2, 1.0
#: Of ZC drives, whose wheels are undercut and whose flanks end beyond the tip at the toe otherwise: profile shift of the wheel, and
#: by how many axial modules half the face is narrower
CONCAVE_SHIFT, CONCAVE_NARROWER = 0.75, 1.0
#: Shaft angle, deg, of axes at right angles.
RIGHT = 90.0
#: Largest profile shift of a wheel, either way.
LARGEST_SHIFT = 2
#: Difference of two profile shifts that are the same but for rounding.
SAME_SHIFT = 1e-6
#: Disk that grinds ZK and ZC flanks where it is not given: diameter at the rim and radius of the profile, in axial modules.
DISK, PROFILE = 80.0, 6.0
#: Forms that have a key of the worm; the others only take its default.
FORMS_OF = {
    "section": (ThreadForm.ZN,),
    "disk_diameter": (ThreadForm.ZK, ThreadForm.ZC),
    "profile_radius": (ThreadForm.ZC,),
}
#: Part of a length within which it is its default.
SAME_LENGTH = 1e-9
#: Roundings of the worm's root and of the hob's tip, in axial modules.
ROUNDING = 0.2
#: Addendum of the wheel and dedendum of the worm, in axial modules.
ADDENDUM, DEDENDUM = 1.0, 1.0 + CLEARANCE
#: largest part of the way from the reference cylinder to the base cylinder of an involute worm at which threads of hob and worm are
#: tangent
ON_FLANK = 0.8
#: lead angle (rad) of steeper threads, which are tangent at the reference cylinders where the pitch point is below: nearer to the
#: axis their flanks cross. Of 14 random drives with such a pitch point 9 of at most 16 deg are as good or better with it, 5 from
#: 22 deg on are worse
STEEP = math.radians(20.0)
#: keys that say which hob it is, and what of its setting follows from them
HOBS = {"hob.reference_diameter", "hob.threads", "hob.pitch_height"}
OF_HOB = HOBS | {"hob.center_distance", "hob.swivel_angle"}


class ThreadCount(Table):
    """How many threads a worm has."""

    threads: Annotated[int, Key("count", "number of threads z1", low=1, high=10)]


class WormTable(MemberBody, ThreadCount):
    """The worm. Its diameter follows from one of reference_diameter, quotient and lead_angle."""

    replaces = (("reference_diameter", "quotient"), ("reference_diameter", "lead_angle"))

    form: Annotated[
        str,
        Key(
            "choice",
            "flank form: ZA straight in the axial section, ZN straight in the normal section, ZI involute helicoid, ZK ground by "
            "a straight-sided disk, ZC ground by a disk with a circular-arc profile",
            choices=tuple(ThreadForm),
            source="ISO 10828",
        ),
    ] = "ZI"
    right_hand: Annotated[bool, Key("flag", "right-hand threads; else left-hand")] = True
    reference_diameter: Annotated[
        float | None,
        Key(
            "length",
            "reference diameter d1",
            low=0,
            above=True,
            default="10 axial modules, or by quotient or lead_angle",
        ),
    ] = None
    quotient: Annotated[
        float | None,
        Key("number", "diameter quotient q, in axial modules", low=2, high=100, default="by reference_diameter"),
    ] = None
    lead_angle: Annotated[
        float | None,
        Key("angle", "lead angle gamma on the reference cylinder", low=0.1, high=60, default="by reference_diameter"),
    ] = None
    section: Annotated[
        str,
        Key(
            "choice",
            "which normal section a ZN flank is straight in: of the space or of the thread",
            choices=("space", "thread"),
        ),
    ] = "space"
    length: Annotated[
        float, Key("length", "length of the thread", low=0, above=True, default="2 m sqrt(z2 + 1), DIN 3975")
    ] = DERIVED
    run_out: Annotated[
        float,
        Key(
            "length",
            "run-out beyond the length at either end: the root rises towards the tip, flanks and roundings with it, as the "
            "tool is withdrawn; 0: ends cut square",
            low=0,
        ),
    ] = 0.0
    addendum: Annotated[
        float, Key("axial coefficient", "tip above the reference cylinder", low=0, high=3, source="DIN 3975")
    ] = 1.0
    dedendum: Annotated[
        float,
        Key(
            "axial coefficient",
            "root below the reference cylinder",
            low=0,
            high=3,
            default="1.2, less where the flanks end above its rounding",
            source="DIN 3975",
        ),
    ] = DERIVED
    root_rounding: Annotated[
        float,
        Key(
            "axial coefficient",
            "rounding between flank and root cylinder, in the axial section",
            low=0,
            high=2,
            default="0.2, less where the space has no room for it",
        ),
    ] = DERIVED
    thickness: Annotated[
        float,
        Key("axial coefficient", "axial thickness of the thread before backlash", low=0.2, high=3, default="pi / 2"),
    ] = 0.5 * math.pi
    dual_lead: Annotated[
        float,
        Key(
            "number",
            "dual lead (duplex) e: leads p_z (1 + e) of right, p_z (1 - e) of left flanks; nominal thickness in the middle",
            low=-0.2,
            high=0.2,
        ),
    ] = 0.0
    disk_diameter: Annotated[
        float,
        Key("length", "diameter of the grinding disk at its rim, of ZK and ZC", low=0, above=True, default="80 m"),
    ] = DERIVED
    profile_radius: Annotated[
        float, Key("length", "radius of the disk's profile, of ZC", low=0, above=True, default="6 m")
    ] = DERIVED
    wire_diameter: Annotated[
        float | None,
        Key(
            "length",
            "diameter of the wires or balls of the measure over them",
            low=0,
            above=True,
            default="touch on the reference cylinder",
        ),
    ] = None


class WheelTable(MemberTable):
    """The wheel, as its hob generates it, or a helical gear."""

    form: Annotated[
        str,
        Key(
            "choice",
            "enveloping: as a hob generates it that stands where the worm will; helical: a cylindrical helical gear of the worm's "
            "rack, of ZI worms: contact in a point",
            choices=("enveloping", "helical"),
        ),
    ] = "enveloping"
    face_width: Annotated[
        float,
        Key(
            "length",
            "face width",
            low=0,
            above=True,
            default="2 m (sqrt(q + 1) + 0.5), DIN 3975, of ZC 2 m (sqrt(q + 1) - 0.5); less where flanks end sooner",
        ),
    ] = DERIVED
    profile_shift: Annotated[
        float,
        Key(
            "axial coefficient",
            "profile shift x2",
            low=-LARGEST_SHIFT,
            high=LARGEST_SHIFT,
            default="by center_distance, without it 0, of ZC 0.75",
        ),
    ] = DERIVED
    addendum: Annotated[
        float,
        Key(
            "axial coefficient",
            "tip above the shifted reference circle in the middle plane",
            low=0,
            high=3,
            default="1, or what the tooth has room for",
        ),
    ] = DERIVED
    tip_form: Annotated[
        str,
        Key(
            "choice",
            "throated: an arc about the worm's axis; chamfered: a cylinder and two cones, tangents of that arc; cylindrical: one "
            "cylinder of the outside diameter",
            choices=("throated", "chamfered", "cylindrical"),
        ),
    ] = "throated"
    throat_angle: Annotated[
        float, Key("angle", "angle of the cones of a chamfered throat to the wheel's axis", low=5, high=75)
    ] = 20.0
    throat_radius: Annotated[
        float,
        Key("length", "radius of the throat in the axial section", low=0, above=True, default="a - d_a2 / 2"),
    ] = DERIVED
    outside_diameter: Annotated[
        float,
        Key("length", "outside diameter d_e2", low=0, above=True, default="d_a2 + m, DIN 3975"),
    ] = DERIVED

    @property
    def throated(self) -> bool:
        """Whether its tip follows the worm."""
        return self.form == "enveloping" and self.tip_form != "cylindrical"


class HobTable(Table):
    """The hob that generates the wheel: of the worm's normal module and profile."""

    reference_diameter: Annotated[
        float,
        Key(
            "length",
            "reference diameter; larger than the worm's: contact in a point",
            low=0,
            above=True,
            default="the worm's",
        ),
    ] = DERIVED
    threads: Annotated[int | None, Key("count", "number of threads", low=1, high=20, default="the worm's")] = None
    addendum: Annotated[
        float, Key("axial coefficient", "tip above its reference cylinder: generates the root", low=0, high=3)
    ] = 1.0 + CLEARANCE
    tip_radius: Annotated[
        float, Key("axial coefficient", "tip rounding in the axial section: generates the fillet", low=0, high=2)
    ] = ROUNDING
    pitch_height: Annotated[
        float,
        Key(
            "axial coefficient",
            "height over the reference cylinders of hob and worm at which both have the same normal pitch and thickness",
            low=-LARGEST_SHIFT,
            high=LARGEST_SHIFT,
            default="the pitch point's, x2 of axes at right angles, on the flanks, at least 0 above 20 deg lead; 0 with a swivel",
        ),
    ] = DERIVED
    center_distance: Annotated[
        float,
        Key("length", "centre distance of cutting a_0", low=0, above=True, default="a + (d_0 - d_1) / 2"),
    ] = DERIVED
    swivel_angle: Annotated[
        float,
        Key(
            "angle",
            "swivel eta_0 of the hob's axis out of the worm's: towards the way that larger lead angles ask for",
            low=-90,
            high=90,
            default="gamma_w0 - gamma_w: threads of hob and worm are tangent at the height hob.pitch_height",
        ),
    ] = DERIVED
    feed: Annotated[
        str,
        Key(
            "choice",
            "tangential: along the hob's axis, the wheel turning with it; radial: towards the wheel. Both leave the same wheel; "
            "the sheet has the way, or the length of the hob, that it takes",
            choices=("tangential", "radial"),
        ),
    ] = "tangential"


class WormDriveAssembly(Table):
    """Positions of the members against their nominal ones: assembly errors."""

    da: Annotated[float, Key("length", "change of the centre distance: the wheel away from the worm")] = 0.0
    dz1: Annotated[float, Key("length", "displacement of the worm along its axis")] = 0.0
    dz2: Annotated[float, Key("length", "displacement of the wheel along its axis")] = 0.0
    d_sigma: Annotated[float, Key("angle", "change of the shaft angle", low=-5, high=5)] = 0.0
    worm_eccentricity: Annotated[float, eccentricity("worm")] = 0.0
    worm_phase: Annotated[float, phase("worm")] = 0.0
    wheel_eccentricity: Annotated[float, eccentricity("wheel")] = 0.0
    wheel_phase: Annotated[float, phase("wheel")] = 0.0


class WormDriveDesign(Design):
    """A worm and its wheel."""

    own_kind: ClassVar[str] = "worm_drive"
    example: ClassVar[Mapping[str, Any]] = {"module": 4, "worm": {"threads": 2}, "wheel": {"teeth": 40}}
    about: ClassVar[str] = KINDS["worm_drive"].about
    called: ClassVar[str] = "Worm drive"

    module_section: Annotated[
        str,
        Key(
            "choice",
            "which module the key module gives: of the worm's axial or normal section",
            choices=("axial", "normal"),
        ),
    ] = "axial"
    pressure_angle: Annotated[
        float,
        Key(
            "angle",
            "pressure angle of the tool: axial of ZA, else normal; of ZK and ZC the disk's",
            low=5,
            high=35,
            source="ISO 10828",
        ),
    ] = 20.0
    shaft_angle: Annotated[float, Key("angle", "angle between the axes", low=45, high=135)] = RIGHT
    center_distance: Annotated[
        float, Key("length", "centre distance a", low=0, above=True, default="by wheel.profile_shift")
    ] = DERIVED
    backlash_share: Annotated[
        float,
        Key(
            "number",
            "part of the backlash by which the worm's threads are thinner; by the rest the wheel's teeth are, by thicker threads "
            "of its hob",
            low=0,
            high=1,
        ),
    ] = 1.0
    friction: Annotated[
        float | None,
        Key(
            "number",
            "coefficient of friction of the flanks, of forces and efficiency in the sheet",
            low=0,
            high=1,
            default="no friction",
        ),
    ] = None
    worm: WormTable
    wheel: WheelTable
    hob: HobTable = HobTable()
    assembly: WormDriveAssembly = WormDriveAssembly()
    measured: WormDriveMeasured | None = None
    rexs: RexsSource | None = None
    contact: FlankContact = FlankContact()

    @property
    def counted_teeth(self) -> int:
        return self.worm.threads

    @property
    def _size_symbols(self) -> Mapping[str, str]:
        section = self.module_section[0].replace("a", "x")
        return {"module": f"m_{section}", "diametral_pitch": f"P_{section}"}

    @property
    def normal_module(self) -> float:
        return self.given_module if self.module_section == "normal" else self.axial_module * math.cos(self.lead_angle)

    @property
    def axial_module(self) -> float:
        """Axial module in the design's units."""
        if self.module_section == "axial":
            return self.given_module
        return self.given_module / math.cos(self.lead_angle)

    @property
    def lead_angle(self) -> float:
        """Lead angle on the worm's reference cylinder, rad."""
        spec, m = self.worm, self.given_module
        if spec.lead_angle is not None:
            return math.radians(spec.lead_angle)
        if spec.quotient is not None:
            return math.atan(spec.threads / spec.quotient)
        diameter = QUOTIENT * m if spec.reference_diameter is None else spec.reference_diameter
        return (
            lead_angle(m, spec.threads, diameter)
            if self.module_section == "normal"
            else math.atan(m * spec.threads / diameter)
        )

    @property
    def reference_diameter(self) -> float:
        """Reference diameter of the worm in the design's units."""
        if self.worm.reference_diameter is not None:
            return self.worm.reference_diameter
        return self.axial_module * self.worm.threads / math.tan(self.lead_angle)

    @property
    def _zero_shift_distance(self) -> float:
        """Centre distance without profile shift, in the design's units."""
        return 0.5 * (self.reference_diameter + self.wheel_reference_diameter)

    @property
    def wheel_helix_angle(self) -> float:
        """Helix angle (rad) of the wheel in the pitch point, positive right-hand: gamma + 90 deg - Sigma.

        It is that of the direction in which the worm's thread crosses the common perpendicular.
        """
        angle = self.lead_angle + math.radians(RIGHT - self.shaft_angle)
        return angle if self.worm.right_hand else -angle

    @property
    def wheel_reference_diameter(self) -> float:
        """m_n z2 / cos(beta_2) in the design's units, m z2 where axes are at right angles."""
        diameter = self.wheel.teeth * self.axial_module
        if self.shaft_angle == RIGHT:
            return diameter
        return diameter * math.cos(self.lead_angle) / math.cos(self.wheel_helix_angle)

    @property
    def usual_face_width(self) -> float:
        """Face width of the wheel [DIN 3975], of ZC narrower, in the design's units."""
        concave = self.worm.form == ThreadForm.ZC
        return (
            2.0
            * self.axial_module
            * (math.sqrt(self.reference_diameter / self.axial_module + 1.0) + 0.5 - concave * CONCAVE_NARROWER)
        )

    @property
    def wheel_tip_diameter(self) -> float:
        """Tip diameter of the wheel in the middle plane as addendum and profile shift of a complete design say, in its units."""
        return self._tip_diameter(self.wheel.profile_shift)

    def _tip_diameter(self, shift: float) -> float:
        return self.wheel_reference_diameter + 2.0 * (self.wheel.addendum + shift) * self.axial_module

    def stays(self, dotted: str, values: Mapping[str, Any]) -> bool:
        # another hob is set up by its own diameter
        return super().stays(dotted, values) and not (dotted in OF_HOB and HOBS & values.keys())

    @property
    def keeps_from_crossing(self) -> str:
        """Of wheels that a larger hob has cut: steep threads cross them, however they are mounted.

        Returns
        -------
        str
            Empty with a hob of the worm's size.

        Examples
        --------
        >>> gm.load("samples/worm_drive_zk_oversize.toml").keeps_from_crossing[:14]
        "the worm's own"
        """
        if self.wheel.form == "helical" or not self.hob.reference_diameter > self.reference_diameter * (
            1.0 + SAME_LENGTH
        ):
            return ""
        return "the worm's own hob (hob.reference_diameter left out), or a smaller lead angle of the worm, keeps them apart"

    def derived_values(self) -> dict[str, float]:
        """What the file leaves out [DIN 3975], but for face width, addendum and rounding (`face_width.derived_values`).

        The throat follows from the addendum, and is left open with it.

        Returns
        -------
        dict of str to float
            By dotted key, in the file's units.

        Examples
        --------
        >>> sorted(gm.load("samples/worm_drive.toml", complete=False).derived_values())[:2]
        ['center_distance', 'contact.delta']
        """
        m, d1, wheel = self.axial_module, self.reference_diameter, self.wheel
        concave = self.worm.form == ThreadForm.ZC
        usual = self._zero_shift_distance + (CONCAVE_SHIFT * m if concave else 0.0)
        shift = given_or(wheel.profile_shift, (given_or(self.center_distance, usual) - self._zero_shift_distance) / m)
        distance = given_or(self.center_distance, self._zero_shift_distance + shift * m)
        tip = self._tip_diameter(shift)
        placed = wheel.form == "helical" or math.isfinite(self.hob.swivel_angle)
        height = 0.0 if placed else self.pitch_height_of(distance)
        cutting, swivel = self.usual_cutting(distance, given_or(self.hob.pitch_height, height))
        return {
            **super().derived_values(),
            "center_distance": distance,
            "worm.length": 2.0 * m * math.sqrt(wheel.teeth + 1.0),
            "worm.disk_diameter": DISK * m,
            "worm.profile_radius": PROFILE * m,
            "wheel.profile_shift": shift,
            "wheel.throat_radius": distance - 0.5 * tip,
            "wheel.outside_diameter": tip + (OUTSIDE * m if wheel.throated else 0.0),
            "hob.reference_diameter": d1,
            "hob.pitch_height": height,
            "hob.center_distance": cutting,
            "hob.swivel_angle": swivel,
        }

    def pitch_height_of(self, distance: float) -> float:
        """How high (axial modules) the pitch point is over the worm's reference cylinder at a centre distance of the drive.

        On the common perpendicular r from the worm's axis, where it moves over the wheel along its own thread: with the worm's
        screw parameter P and K = m z2 / 2, (a - r) (r cos(psi) - P sin(psi)) = K r, psi = 90 deg - Sigma. Where flanks end
        sooner, near the base cylinder of the involute worm of these angles, it is as far as they go; of steep threads at least 0.

        Parameters
        ----------
        distance : float
            Centre distance, in the design's units.

        Returns
        -------
        float
            x2 where axes are at right angles, at most an addendum either way; 0 where there is no such point, and below it from
            a lead angle of 20 deg on.

        Examples
        --------
        >>> round(gm.load("samples/worm_drive.toml").pitch_height_of(127.0), 9)
        0.4
        """
        m, psi = self.axial_module, math.radians(RIGHT - self.shaft_angle)
        across = 0.5 * m * self.worm.threads * math.sin(psi)
        middle = 0.5 * (distance * math.cos(psi) + across - 0.5 * m * self.wheel.teeth) / math.cos(psi)
        square = middle**2 - distance * across / math.cos(psi)
        transverse_angle = math.atan(math.tan(math.radians(self.pressure_angle)) / math.sin(self.lead_angle))
        if square < 0.0:
            return 0.0
        over_base = 0.5 * self.reference_diameter * (1.0 - math.cos(transverse_angle)) / m
        height = (middle + math.sqrt(square) - 0.5 * self.reference_diameter) / m
        lowest = 0.0 if self.lead_angle > STEEP else max(-ADDENDUM, -ON_FLANK * over_base)
        # of an unshifted wheel rounding is left
        return 0.0 if abs(height) < SAME_SHIFT else min(max(height, lowest), ADDENDUM)

    def usual_cutting(self, distance: float, height: float) -> tuple[float, float]:
        """Centre distance, in the design's units, and swivel angle, deg, of a hob whose thread is tangent to the worm's.

        Parameters
        ----------
        distance : float
            Centre distance of the drive.
        height : float
            Height over the reference cylinders of both at which they are tangent, axial modules.

        Returns
        -------
        tuple of float
            a_0 and eta_0.

        Examples
        --------
        >>> gm.load("samples/worm_drive.toml").usual_cutting(125.0, 0.0)
        (125.0, 0.0)
        """
        m, d1, threads = self.axial_module, self.reference_diameter, self.hob.threads or self.worm.threads
        d0 = given_or(self.hob.reference_diameter, d1)
        if (d0, threads) == (d1, self.worm.threads):
            return distance, 0.0
        flat = math.atan2(m * self.worm.threads, d1 + 2.0 * height * m)
        swivel = lead_angle(m * math.cos(flat), threads, d0 + 2.0 * height * m) - flat
        return distance + 0.5 * (d0 - d1), math.degrees(swivel)

    @model_validator(mode="after")
    def _one_diameter(self) -> Self:
        given = [key for key in ("reference_diameter", "quotient", "lead_angle") if getattr(self.worm, key) is not None]
        if len(given) > 1:
            raise conflict(
                f"worm.{given[1]}",
                getattr(self.worm, given[1]),
                reason=f"cannot be given together with worm.{given[0]}",
            )
        if self.module_section == "normal" and self.worm.reference_diameter is not None:
            least = self.given_module * self.worm.threads
            if self.worm.reference_diameter <= least:
                raise conflict(
                    "worm.reference_diameter", self.worm.reference_diameter, must_be=f"more than m_n z1, {least:.6g}"
                )
        return self

    @model_validator(mode="after")
    def _one_shift(self) -> Self:
        shift, distance = self.wheel.profile_shift, self.center_distance
        if "center_distance" in self.model_fields_set and "profile_shift" in self.wheel.model_fields_set:
            own = (distance - self._zero_shift_distance) / self.axial_module
            if abs(shift - own) > SAME_SHIFT:
                reason = f"cannot be given together with center_distance = {distance:.7g}, which makes it {own:.7g}"
                raise conflict("wheel.profile_shift", shift, reason=reason)
        return self

    @model_validator(mode="after")
    def _distance_of_a_shift(self) -> Self:
        """A centre distance that is too far off is refused by its own name, and not by that of the shift that follows from it."""
        distance, far = self.center_distance, LARGEST_SHIFT * self.axial_module
        if "center_distance" in self.model_fields_set and "profile_shift" not in self.wheel.model_fields_set:
            middle = self._zero_shift_distance
            if abs(distance - middle) > far * (1.0 + SAME_SHIFT):
                reason = f"makes wheel.profile_shift {(distance - middle) / self.axial_module:.4g}"
                allowed = f"from {at_least(middle - far)} to {at_most(middle + far)} {self.units}"
                raise conflict("center_distance", distance, reason=reason, allowed=allowed)
        return self

    @property
    def keys_of_other_forms(self) -> tuple[str, ...]:
        """Keys of the worm that its flank form does not have.

        Returns
        -------
        tuple of str
            Without their table.

        Examples
        --------
        >>> gm.load("samples/worm_drive.toml").keys_of_other_forms
        ('section', 'disk_diameter', 'profile_radius')
        """
        return tuple(key for key, forms in FORMS_OF.items() if self.worm.form not in forms)

    @model_validator(mode="after")
    def _keys_of_the_form(self) -> Self:
        """Refuse what nothing would be done with; a default may be stated."""
        worm = self.worm
        for key in self.keys_of_other_forms:
            value = getattr(worm, key)
            if key not in worm.model_fields_set or value == type(worm).model_fields[key].default:
                continue
            usual = {"disk_diameter": DISK, "profile_radius": PROFILE}.get(key)
            if usual and (math.isnan(value) or math.isclose(value, usual * self.axial_module, rel_tol=SAME_LENGTH)):
                continue
            reason = f"nothing is done with it where worm.form is {worm.form}"
            raise conflict(f"worm.{key}", value, reason=reason, allowed=f"with {' and '.join(FORMS_OF[key])}")
        return self

    @model_validator(mode="after")
    def _helical_wheel(self) -> Self:
        """A helical gear has one rack for both flanks, that of an involute worm."""
        if self.wheel.form == "helical" and self.worm.form != "ZI":
            reason = f"goes with involute worms, worm.form is {self.worm.form}"
            raise conflict("wheel.form", self.wheel.form, reason=reason, allowed="enveloping")
        if self.wheel.form == "helical" and self.worm.dual_lead:
            reason = "cannot be given together with wheel.form = helical"
            raise conflict("worm.dual_lead", self.worm.dual_lead, reason=reason, allowed="0")
        return self
