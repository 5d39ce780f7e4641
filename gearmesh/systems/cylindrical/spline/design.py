"""Design of an involute spline: shaft and hub with as many teeth on one axis [DIN 5480, ISO 4156, ANSI B92.1]."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Self

from pydantic import model_validator

from gearmesh.design import keys
from gearmesh.design.core import Design, FlankContact, MemberBody, PlaneFaces
from gearmesh.design.keys import DERIVED_VALUE, MM_PER, Table, conflict
from gearmesh.design.modifications import Modified
from gearmesh.design.runout import eccentricity, phase
from gearmesh.member_names import MemberNames
from gearmesh.systems.common.internal_keys import NOT_INSIDE
from gearmesh.systems.common.standards import ansi_b92_1, din5480, iso4156
from gearmesh.systems.cylindrical.allowance_keys import BallMeasurement, ThicknessAllowance, thickness_made_key
from gearmesh.systems.cylindrical.design import FORMED_MANUFACTURE, ShaperCutter
from gearmesh.systems.cylindrical.spline.designation import DESIGNATION_FORMS, Designation, parse_designation
from gearmesh.systems.cylindrical.spline.profiles import (
    DEFAULT_PROFILE,
    FINE_PITCH,
    REFERENCE_MODULES,
    SPLINE_PROFILES,
    SplineProfile,
)
from gearmesh.systems.kinds import OWN_KINDS

#: name of the shaft's table in a design
SHAFT_NAME = "shaft"
#: name of the hub's table in a design
HUB_NAME = "hub"
#: names of the members in order
MEMBER_NAMES = (SHAFT_NAME, HUB_NAME)
#: limit of the profile shift, modules
MAX_SHIFT = 2
#: difference of a key and the same key by the designation, as a share, that is rounding
DESIGNATION_ROUNDING = 1e-9
#: decimals of a profile shift by the reference diameter
SHIFT_DECIMALS = 12
#: largest difference of a given profile shift from the shift by the reference diameter
SHIFT_ROUNDING = 1e-9
#: keys that give the size, from which defaults of the members follow
SIZE_KEYS = {
    "designation",
    "profile",
    "module",
    "diametral_pitch",
    "teeth",
    "reference_diameter",
    "profile_shift",
    "pressure_angle",
}

#: reason why the clearance is no key
_FROM_FIT = "the clearance follows from the thickness allowances of shaft and hub"


class SplineMember(PlaneFaces, MemberBody):
    """Shaft or hub of a spline."""

    usual: ClassVar[tuple[str, ...]] = ("tolerance",)
    replaces: ClassVar = (("tip_diameter", "addendum"), ("root_diameter", "dedendum"))
    absent: ClassVar[Mapping[str, str]] = {"teeth": "shaft and hub have the key teeth of the design"}

    addendum: float = keys.coefficient(
        "tip beyond the shifted pitch plane", DERIVED_VALUE, low=0, high=5, default="by profile"
    )
    dedendum: float = keys.coefficient(
        "root beyond the shifted pitch plane", DERIVED_VALUE, low=0, high=5, default="by profile"
    )
    tip_diameter: float | None = keys.length(
        "tip diameter, instead of addendum", None, above=0, default="from addendum"
    )
    root_diameter: float | None = keys.length(
        "root diameter, instead of dedendum", None, above=0, default="from dedendum"
    )
    tool_tip_radius: float = keys.coefficient(
        "tip rounding of the tool; of a formed hub the radius of the root fillet",
        DERIVED_VALUE,
        low=0,
        high=2,
        default="by profile, or what a space has room for",
    )
    tolerance: str | None = keys.text(
        'class and deviation, as "5f" of a shaft and "5H" of a hub, "5" by ANSI B92.1; gives thickness_allowance '
        "and effective_variation",
        None,
        default="by designation",
        source="ISO 4156-1, DIN 5480-1, ANSI B92.1",
    )
    thickness_allowance: ThicknessAllowance | None = None
    effective_variation: float | None = keys.length(
        "effective variation lambda: by how much deviations of pitch, profile and helix make a shaft thicker, a space narrower",
        None,
        low=0,
        high=10,
        default="by tolerance, else 0",
        source="ISO 4156-1",
    )
    thickness_made: str = thickness_made_key()
    pins: BallMeasurement | None = None

    @property
    def thickness_given(self) -> bool:
        """True if allowances or limits of a measure give the thickness."""
        return self.thickness_allowance is not None or (self.pins is not None and self.pins.upper is not None)


class SplineShaft(SplineMember, Modified):
    """The shaft, with external teeth."""

    run_out_radius: float | None = keys.length(
        "radius of the hob or milling cutter, at its tip, that leaves the teeth before a shaft thicker than their roots",
        None,
        above=0,
        default="24 mm times the root of the module in mm, where there is such a shaft",
    )
    shaper: ShaperCutter | None = None


class SplineHub(SplineMember):
    """The hub, with internal teeth."""

    absent: ClassVar[Mapping[str, str]] = {
        **SplineMember.absent,
        **dict.fromkeys(("bore", *NOT_INSIDE), "the hub has its body outside of the teeth"),
    }

    manufacture: str = keys.choice(
        "how the hub gets its teeth: formed by a tool with the profile of its spaces, as a broach, or generated by a shaper "
        "cutter",
        (FORMED_MANUFACTURE, "generated"),
        FORMED_MANUFACTURE,
    )
    rim: float | None = keys.length("rim outside of the root", None, above=0, default="3 modules")
    shaper: ShaperCutter | None = None

    @model_validator(mode="after")
    def _one_tool(self) -> Self:
        if self.shaper is not None and self.manufacture == FORMED_MANUFACTURE:
            raise conflict("shaper", None, reason='needs manufacture = "generated"')
        return self


class SplineAssembly(Table):
    """Assembly errors: the hub's axis moves from that of the shaft."""

    dx: float = keys.length("offset of the hub along x", 0.0)
    dy: float = keys.length("offset of the hub along y", 0.0)
    dz: float = keys.length("offset of the hub along its axis", 0.0)
    gamma_h: float = keys.angle("tilt of the hub's axis about x", 0.0, low=-10, high=10)
    gamma_v: float = keys.angle("tilt of the hub's axis about y", 0.0, low=-10, high=10)
    shaft_eccentricity: float = eccentricity(SHAFT_NAME)
    shaft_phase: float = phase(SHAFT_NAME)
    hub_eccentricity: float = eccentricity(HUB_NAME)
    hub_phase: float = phase(HUB_NAME)


class SplineDesign(Design):
    """An involute spline: shaft and hub."""

    own_kind: ClassVar[str] = "spline"
    usual: ClassVar[tuple[str, ...]] = ("designation", "profile")
    absent: ClassVar[Mapping[str, str]] = {
        "backlash": _FROM_FIT,
        "helix_angle": "teeth of splines are straight",
        "center_distance": "shaft and hub have one axis",
    }
    example: ClassVar[Mapping[str, Any]] = {
        "designation": "DIN 5480 W 45x2x21",
        "shaft": {"face_width": 30},
        "hub": {"face_width": 30},
    }
    about: ClassVar[str] = OWN_KINDS["spline"].about
    called: ClassVar[str] = "Involute spline"

    designation: str | None = keys.text(
        "profile, size and tolerances by a standard, lengths in mm, " + DESIGNATION_FORMS,
        None,
        default="by the keys below",
    )
    profile: str = keys.choice(
        "basic rack: pressure angle, addenda, dedenda and roundings", tuple(SPLINE_PROFILES), DEFAULT_PROFILE
    )
    teeth: int | None = keys.count("number of teeth of shaft and hub", None, low=5, high=1000, default="by designation")
    reference_diameter: float | None = keys.length(
        "reference diameter d_B, which gives the profile shift",
        None,
        above=0,
        default="by profile_shift",
        source="DIN 5480-1",
    )
    profile_shift: float = keys.coefficient(
        "profile shift of the shaft; the hub has the opposite one",
        DERIVED_VALUE,
        low=-MAX_SHIFT,
        high=MAX_SHIFT,
        default="0, or by reference_diameter",
        source="DIN 5480-1",
    )
    pressure_angle: float = keys.angle("pressure angle", DERIVED_VALUE, low=14.5, high=45, default="by profile")
    shaft: SplineShaft
    hub: SplineHub
    assembly: SplineAssembly = SplineAssembly()
    contact: FlankContact = FlankContact()

    def __init__(self, /, **keys: Any) -> None:
        """Validate; keys that the designation alone gives count as left out."""
        super().__init__(**keys)
        if self.designation is not None:
            self.model_fields_set.difference_update(_said(self.designation, self.mm_per_unit).keys() - keys.keys())

    @model_validator(mode="before")
    @classmethod
    def _by_designation(cls, keys: Any) -> Any:
        """Fill in the keys that a designation gives; refuse other values of them."""
        text = keys.get("designation") if isinstance(keys, Mapping) else None
        if not isinstance(text, str):
            return keys
        said = _said(text, MM_PER.get(str(keys.get("units", "mm")), 1.0))
        for key, value in said.items():
            given = keys.get(key)
            if given is not None and not _alike(given, value):
                own = f'"{value}"' if isinstance(value, str) else f"{value:g}"
                raise conflict(key, given, reason=f'the designation "{text}" gives {own}')
        rivals = [key for key in ("module", "diametral_pitch") if key not in said]
        for key in rivals:
            if keys.get(key) is not None:
                raise conflict(key, keys[key], reason="cannot be given together with designation")
        return {**keys, **said}

    @model_validator(mode="after")
    def _one_tooth_number(self) -> Self:
        if self.teeth is None:
            raise conflict("teeth", None, reason="missing; give teeth, or a designation")
        return self

    @model_validator(mode="after")
    def _one_shift(self) -> Self:
        own = self._designed_shift
        if abs(own) > MAX_SHIFT:
            key = "reference_diameter" if self.designation is None else "designation"
            reason = f"{self.counted_teeth} teeth need a profile shift of {own:.4g} for this diameter"
            raise conflict(key, getattr(self, key), reason=reason, allowed=f"shifts from {-MAX_SHIFT} to {MAX_SHIFT}")
        if self.reference_diameter is not None and abs(self.profile_shift - own) > SHIFT_ROUNDING:
            raise conflict("profile_shift", self.profile_shift, reason=f"reference_diameter gives {own:.9g}")
        return self

    @model_validator(mode="after")
    def _known_tolerances(self) -> Self:
        for name in MEMBER_NAMES:
            given = getattr(self, name).tolerance
            if given is None:
                continue
            if self._by_ansi:
                if ansi_b92_1.parse(given) is None:
                    raise conflict(f"{name}.tolerance", given, must_be="a class from 4 to 7")
                continue
            letters, classes = _letters(name), iso4156.CLASS_FACTORS
            parse, numbers = iso4156.parse, f"{min(classes)} to {max(classes)}"
            if self._by_din5480:
                letters = tuple(din5480.HUB_UNITS if name == HUB_NAME else din5480.SHAFT_UNITS)
                parse, numbers = din5480.parse, f"{din5480.TOLERANCE_GRADES[0]} to {din5480.TOLERANCE_GRADES[-1]}"
            if parse(given, letters) is None:
                raise conflict(
                    f"{name}.tolerance", given, must_be=f"a class, {numbers}, and one of {', '.join(letters)}"
                )
        return self

    @property
    def basic_rack(self) -> SplineProfile:
        """Proportions of the profile."""
        return SPLINE_PROFILES[self.profile]

    @property
    def _by_iso4156(self) -> bool:
        """True if the profile is of ISO 4156, whose tolerances are known."""
        return self.profile.startswith("ISO 4156")

    @property
    def _by_din5480(self) -> bool:
        """True if the profile is of DIN 5480, whose tolerances are known."""
        return self.profile == "DIN 5480"

    @property
    def _by_ansi(self) -> bool:
        """True if the profile is of ANSI B92.1, whose tolerances are known."""
        return self.profile.startswith("ANSI B92.1")

    @property
    def member_names(self) -> MemberNames:
        """Shaft and hub."""
        return MemberNames((MEMBER_NAMES,))

    @property
    def counted_teeth(self) -> int:
        assert self.teeth is not None
        return self.teeth

    @property
    def _tooth_numbers(self) -> tuple[int, ...]:
        return (self.counted_teeth,)

    @property
    def _designed_shift(self) -> float:
        """Profile shift by the reference diameter; 0 without one."""
        if self.reference_diameter is None:
            return 0.0
        over = self.reference_diameter / self.given_module - self.counted_teeth - REFERENCE_MODULES
        return round(0.5 * over, SHIFT_DECIMALS)

    def tolerance(self, name: str) -> str:
        """Return the tolerance of a member, given or by designation.

        Parameters
        ----------
        name : str
            "shaft" or "hub".

        Returns
        -------
        str
            Empty without one.

        Examples
        --------
        >>> gm.load("samples/spline.toml").tolerance("hub")
        '9H'
        """
        given: str | None = getattr(self, name).tolerance
        if given is not None or self.designation is None:
            return given or ""
        said = parse_designation(self.designation)
        assert isinstance(said, Designation)
        return said.hub if name == HUB_NAME else said.shaft

    def member_tolerance(self, name: str) -> iso4156.SplineTolerance | None:
        """Return the limits by the tolerance of a member.

        Parameters
        ----------
        name : str
            "shaft" or "hub".

        Returns
        -------
        SplineTolerance or None
            mm; None without a tolerance whose limits are known.

        Examples
        --------
        >>> round(gm.load("samples/spline.toml").member_tolerance("hub").total, 6)
        0.071
        """
        module = self.given_module * self.mm_per_unit
        if self._by_din5480:
            units = din5480.HUB_UNITS if name == HUB_NAME else din5480.SHAFT_UNITS
            grade = din5480.parse(self.tolerance(name), tuple(units))
            if grade is None or module > din5480.LARGEST_MODULE_MM:
                return None
            modules = self.counted_teeth + 2.0 * self.profile_shift + REFERENCE_MODULES
            return din5480.tolerance(*grade, module, round(module * modules, 6))
        if self._by_ansi:
            number = ansi_b92_1.parse(self.tolerance(name))
            pitch = round(MM_PER["inch"] / module, 6)
            return None if number is None else ansi_b92_1.tolerance(number, pitch, self.counted_teeth)
        parsed = iso4156.parse(self.tolerance(name), _letters(name))
        too_large = module * self.counted_teeth > iso4156.LARGEST_DIAMETER_MM
        if parsed is None or too_large:
            return None
        return iso4156.tolerance(*parsed, module, self.counted_teeth, getattr(self, name).face_width * self.mm_per_unit)

    def derived_values(self) -> dict[str, float]:
        """Return the defaults that the profile gives; the roundings of tools follow from the room that they have.

        Returns
        -------
        dict of str to float
            By dotted key, in the file's units.

        Examples
        --------
        >>> gm.load("samples/spline.toml", complete=False).derived_values()["shaft.dedendum"]
        0.6
        """
        rack, module = self.basic_rack, self.given_module
        fine = (
            self.diametral_pitch is not None
            and self.diametral_pitch >= FINE_PITCH
            and not math.isnan(rack.fine_dedendum)
        )
        # a thinner shaft of ISO 4156 is smaller, too
        smaller = 0.5 * self._deviation / (module * math.tan(math.radians(rack.pressure_angle)))
        return {
            **super().derived_values(),
            "profile_shift": self._designed_shift,
            "pressure_angle": rack.pressure_angle,
            "shaft.addendum": rack.shaft[0] - smaller,
            "shaft.dedendum": (rack.fine_dedendum if fine else rack.shaft[1]) + smaller,
            "hub.addendum": rack.hub_addendum(self.counted_teeth),
            "hub.dedendum": rack.hub[1],
        }

    def stays(self, dotted: str, values: Mapping[str, Any]) -> bool:
        # heights, roundings and the shift follow from designation, profile and size
        return super().stays(dotted, values) and not (SIZE_KEYS & values.keys() and not dotted.startswith("contact."))

    @property
    def _deviation(self) -> float:
        """Fundamental deviation of the shaft's thickness, in the design's units, positive towards thinner teeth."""
        own = self.member_tolerance(SHAFT_NAME) if self._by_iso4156 else None
        return 0.0 if own is None else max(0.0, -own.effective) / self.mm_per_unit


def _letters(name: str) -> tuple[str, ...]:
    """Return the letters of the tolerances of a member that ISO 4156 has."""
    return iso4156.HUB_LETTERS if name == HUB_NAME else iso4156.SHAFT_LETTERS


def _said(text: str, mm_per_unit: float) -> dict[str, Any]:
    """Return the keys that a designation gives, in a design's units. Refuses other texts."""
    said = parse_designation(text)
    if isinstance(said, str):
        raise conflict("designation", text, must_be=said)
    values = {
        "profile": said.profile,
        "teeth": said.teeth,
        "module": None if said.module is None else said.module / mm_per_unit,
        "diametral_pitch": said.diametral_pitch,
        "reference_diameter": None if said.reference_diameter is None else said.reference_diameter / mm_per_unit,
    }
    return {key: value for key, value in values.items() if value is not None}


def _alike(given: Any, value: Any) -> bool:
    """True if a given value is that of the designation, up to rounding."""
    if isinstance(value, str) or isinstance(given, bool) or not isinstance(given, int | float):
        return bool(given == value)
    return bool(abs(given - value) <= DESIGNATION_ROUNDING * abs(value))
