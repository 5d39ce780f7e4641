"""Design of a cylindrical gear pair [ISO 21771]: spur and helical gears on parallel axes, one may be internal."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import combinations
from typing import Any, ClassVar, Self

from pydantic import model_validator

from gearmesh.design import keys
from gearmesh.design.core import (
    Design,
    FlankContact,
    MemberTable,
    PairDesign,
    RexsSource,
    TurnedTip,
    module_key,
    pitch_key,
)
from gearmesh.design.keys import DERIVED_VALUE, MM_PER, Table, conflict, given_or
from gearmesh.design.modifications import Modified
from gearmesh.design.runout import PairRunout
from gearmesh.systems.common.internal_keys import check_ring, with_internal
from gearmesh.systems.common.pressure_angles import CoastSide, coast_pressure_angle_key
from gearmesh.systems.cylindrical.allowance_keys import (
    BallMeasurement,
    CenterDistanceAllowance,
    DiameterTolerance,
    SpanMeasurement,
    ThicknessAllowance,
    thickness_made_key,
)
from gearmesh.systems.kinds import OWN_KINDS

#: basic racks of ISO 53: addendum, dedendum and rounding of the tool's tip, in normal modules
BASIC_RACKS: dict[str, tuple[float, float, float]] = {
    "A": (1.0, 1.25, 0.38),
    "B": (1.0, 1.25, 0.30),
    "C": (1.0, 1.25, 0.25),
    "D": (1.0, 1.40, 0.39),
}
#: value of `manufacture` without generating
FORMED_MANUFACTURE = "formed"
#: default rim of an internal gear, in normal modules
DEFAULT_RIM_MODULES = 3.0


class ShaperCutter(Table):
    """The shaper cutter that generates a member, instead of a hob or rack."""

    teeth: int = keys.count("teeth of the cutter", low=6, high=1000)
    profile_shift: float = keys.coefficient("profile shift of the cutter as ground", 0.0, low=-1, high=1)
    addendum: float | None = keys.coefficient(
        "addendum of the cutter with its shift, instead of the gear's dedendum", None, low=0, high=5
    )


class Hob(Table):
    """Hob of a member: protuberance and chamfer of its profile, and the stock that it leaves for the finishing tool."""

    needs: ClassVar[tuple[tuple[str, str, str], ...]] = (
        ("protuberance_angle", "protuberance", "a protuberance"),
        ("chamfer_angle", "chamfer_diameter", "a chamfer_diameter"),
    )

    protuberance: float = keys.length(
        "protuberance pr_P0: how far the tip rounding projects beyond the hob's flank, normal to it",
        0.0,
        low=0,
        high=100,
        source="ISO 6336-3",
    )
    protuberance_angle: float | None = keys.angle(
        "pressure angle alpha_prP0 of the line from the protuberance to the hob's flank, in the normal section",
        None,
        above=0,
        high=45,
        default="half the pressure angle",
    )
    stock: float = keys.length(
        "stock q that the hob leaves on each flank, normal to it", 0.0, low=0, high=100, source="ISO 6336-3"
    )
    finished: bool = keys.flag("true: the stock is removed; false: the teeth are as the hob leaves them", True)
    finishing_diameter: float | None = keys.length(
        "diameter to which the finishing tool's sharp tip leaves an involute, where stock is more than protuberance",
        None,
        above=0,
        default="none; needed there",
    )

    chamfer_diameter: float | None = keys.length(
        "tip form diameter d_Fa at which a semi-topping hob's chamfer begins on the finished flank",
        None,
        above=0,
        default="no chamfer",
        source="ISO 21771",
    )
    chamfer_angle: float | None = keys.angle(
        "pressure angle alpha_KP0 of the hob's root, which cuts the chamfer, in the normal section",
        None,
        above=0,
        high=80,
        default="45",
    )

    @model_validator(mode="after")
    def _deep_enough(self) -> Self:
        notched = self.finished and self.stock > self.protuberance
        if notched and self.finishing_diameter is None:
            raise conflict(
                "stock",
                self.stock,
                reason=f"the finishing tool cuts below the protuberance, {self.protuberance:g}",
                allowed="at most the protuberance, or more with a finishing_diameter",
            )
        if self.finishing_diameter is not None and not notched:
            raise conflict(
                "finishing_diameter",
                self.finishing_diameter,
                reason="needs a stock larger than the protuberance",
            )
        return self

    @property
    def remaining_stock(self) -> float:
        """Stock on the flanks of the gear, along their normal: the whole stock before finishing, none after."""
        return 0.0 if self.finished else self.stock

    @property
    def relief(self) -> float:
        """Projection of the tip rounding beyond the flank of the gear, along its normal; a notch is left below 0."""
        return self.protuberance - (self.stock - self.remaining_stock)


#: keys of a tip that a hob with a chamfer cannot make
TIP_SHAPE_KEYS = ("tip_cone_angle", "tip_throat_radius", "tip_chamfer", "tip_rounding")
#: keys of the size, of which one is given
SIZE_KEYS = ("module", "diametral_pitch", "transverse_module", "transverse_diametral_pitch")


class CylindricalMember(CoastSide, TurnedTip, MemberTable, Modified):
    """One gear of a cylindrical pair."""

    usual: ClassVar[tuple[str, ...]] = ("profile_shift",)
    replaces: ClassVar = (
        ("tip_diameter", "addendum"),
        ("tip_diameter", "tip_alteration"),
        ("root_diameter", "dedendum"),
    )

    signed: ClassVar[tuple[str, ...]] = ("teeth",)
    #: Key of the floor of the gap between both halves.
    gap_key: ClassVar[str] = "gap_diameter"
    exclusive: ClassVar[tuple[tuple[str, str], ...]] = (
        ("pins", "balls"),
        *((key, "hob.chamfer_diameter") for key in TIP_SHAPE_KEYS),
        ("stock", "hob.stock"),
    )

    internal: bool = keys.flag("internal gear; a negative number of teeth means the same", False, source="ISO 21771")
    profile_shift: float = keys.coefficient(
        "profile shift x, positive towards the tip",
        DERIVED_VALUE,
        low=-5,
        high=5,
        default="0, or as the centre distance needs",
        source="ISO 21771",
    )
    addendum: float = keys.coefficient(
        "tip above the shifted pitch plane",
        DERIVED_VALUE,
        low=0,
        high=5,
        default="1; internal: as far as the mating gear has involute",
        source="ISO 53",
    )
    dedendum: float = keys.coefficient(
        "root below the shifted pitch plane", DERIVED_VALUE, low=0, high=5, default="by profile", source="ISO 53"
    )
    tip_alteration: float = keys.coefficient(
        "tip alteration k, negative where the tip is shortened",
        DERIVED_VALUE,
        low=-5,
        high=5,
        default="what keeps the profile's clearance at the centre distance",
        source="ISO 21771",
    )
    tip_diameter: float | None = keys.length(
        "tip diameter, instead of addendum and tip_alteration", None, above=0, default="from addendum"
    )
    root_diameter: float | None = keys.length(
        "root diameter, instead of dedendum", None, above=0, default="from dedendum"
    )
    tool_tip_radius: float = keys.coefficient(
        "tip rounding of the tool; 0 = sharp edge; of formed gears the radius of the root fillet, in the transverse section",
        DERIVED_VALUE,
        low=0,
        high=2,
        default="by profile, or what the tool's tooth has room for",
        source="ISO 53",
    )
    manufacture: str = keys.choice(
        "how an internal gear gets its teeth: generated by a shaper cutter, or formed by a tool with the profile of its "
        "spaces, as by broaching, wire cutting or moulding",
        ("generated", FORMED_MANUFACTURE),
        "generated",
    )
    run_out_radius: float | None = keys.length(
        "radius of the hob or milling cutter, at its tip, that leaves the teeth before a shaft thicker than their roots",
        None,
        above=0,
        default="24 mm times the root of the module in mm, where there is such a shaft",
    )
    rim: float | None = keys.length("rim outside the root of an internal gear", None, above=0, default="3 modules")
    gap_diameter: float | None = keys.length(
        "diameter of the gap between the halves of a double helical gear",
        None,
        above=0,
        default="half a module below the root",
    )
    thickness_allowance: ThicknessAllowance | None = None
    thickness_made: str = thickness_made_key()
    allowance_by: str = keys.choice(
        "how the allowance of the thickness is cut: on the flanks alone, the root as the profile shift says, or by feeding the "
        "tool on to the generating profile shift x_E, which moves the root",
        ("flanks", "feed"),
        "flanks",
        source="ISO 21771",
    )
    span: SpanMeasurement | None = None
    balls: BallMeasurement | None = None
    pins: BallMeasurement | None = None
    tip_diameter_tolerance: DiameterTolerance | None = None
    shaper: ShaperCutter | None = None
    hob: Hob | None = None

    @model_validator(mode="before")
    @classmethod
    def _negative_is_internal(cls, keys: Any) -> Any:
        """Read a tooth number below zero as an internal gear [ISO 21771]."""
        return with_internal(keys)

    @model_validator(mode="after")
    def _sound(self) -> Self:
        tip, root = self.tip_diameter, self.root_diameter
        if tip is not None and root is not None and (tip <= root) != self.internal:
            order = "smaller" if self.internal else "larger"
            raise conflict("tip_diameter", tip, must_be=f"{order} than root_diameter, {root:g}")
        check_ring(self, internal=self.internal, rim=self.rim)
        if self.formed:
            self._check_formed()
        if self.run_out_radius is not None and not self.hobbed:
            raise conflict("run_out_radius", self.run_out_radius, reason="only teeth cut by a hob or rack run out")
        if self.hob is not None and not self.hobbed:
            tool = "an internal gear has none" if self.internal else "cannot be given together with shaper"
            raise conflict("hob", None, reason=tool)
        if self.shaper is not None and self.shaper.addendum is not None:
            for key in ("dedendum", "root_diameter"):
                if key in self.model_fields_set and getattr(self, key) is not None:
                    raise conflict(
                        "shaper.addendum", self.shaper.addendum, reason=f"cannot be given together with {key}"
                    )
        return self

    def _check_formed(self) -> None:
        if not self.internal:
            raise conflict(
                "manufacture",
                self.manufacture,
                reason="only internal gears are formed; an external one is generated by a hob or shaper cutter",
            )
        if self.shaper is not None:
            raise conflict("manufacture", self.manufacture, reason="cannot be given together with shaper")
        for key in ("tool_tip_radius", "coast_tool_tip_radius"):
            if getattr(self, key) != 0.0:
                continue
            raise conflict(
                key,
                0.0,
                must_be='above 0 with manufacture = "formed": it is the radius of the root fillet',
            )

    @model_validator(mode="after")
    def _one_thickness(self) -> Self:
        if self.allowance_by == "feed" and self.formed:
            raise conflict("allowance_by", self.allowance_by, reason="no tool is fed into a formed gear")
        first, *others = [*self._thicknesses, ""]
        if others and others[0]:
            raise conflict(others[0], None, reason=f"cannot say the thickness together with {first}")
        return self

    @property
    def _thicknesses(self) -> list[str]:
        """Keys that give the thickness."""
        given = [] if self.thickness_allowance is None else ["thickness_allowance"]
        tables = {"span": self.span, "balls": self.balls, "pins": self.pins}
        return [*given, *(key for key, table in tables.items() if table is not None and table.upper is not None)]

    @property
    def thickness_key(self) -> str | None:
        """Key that gives the thickness; None if no key does."""
        return next(iter(self._thicknesses), None)

    @property
    def dedendum_counts(self) -> bool:
        """True if the dedendum gives the root, not a root diameter or a cutter's addendum."""
        return self.root_diameter is None and (self.shaper is None or self.shaper.addendum is None)

    def plain(self) -> dict[str, Any]:
        values = super().plain()
        if not self.dedendum_counts:
            values.pop("dedendum", None)
        return values

    @property
    def formed(self) -> bool:
        """True if a tool with the profile of its spaces forms it; only for internal gears."""
        return self.manufacture == FORMED_MANUFACTURE

    @property
    def shaped(self) -> bool:
        """True if a shaper cutter generates it."""
        return self.shaper is not None or (self.internal and not self.formed)

    @property
    def hobbed(self) -> bool:
        """True if a hob or rack generates it."""
        return not (self.shaped or self.formed)


class CylindricalAssembly(PairRunout, CenterDistanceAllowance):
    """Position of the gear against its nominal one: assembly errors."""

    usual: ClassVar[tuple[str, ...]] = ("center_distance",)

    center_distance: float | None = keys.length(
        "centre distance", None, above=0, default="nominal teeth mesh without backlash"
    )
    dx: float = keys.length("offset of the gear along x, away from the pinion's axis if external", 0.0)
    dy: float = keys.length("offset of the gear along y", 0.0)
    dz: float = keys.length("offset of the gear along its axis", 0.0)
    gamma_h: float = keys.angle("misalignment of the gear's axis about x", 0.0, low=-10, high=10)
    gamma_v: float = keys.angle("misalignment of the gear's axis about y", 0.0, low=-10, high=10)


#: Class of flank tolerances.
def accuracy_class_key() -> Any:
    """Return the key of the flank tolerance class."""
    return keys.count("flank tolerance class, for the data sheet alone", 6, low=1, high=11, source="ISO 1328-1")


class ToothingKeys(Design):
    """Keys of the designs of all cylindrical gears and racks: size, basic rack, helix, backlash."""

    usual: ClassVar[tuple[str, ...]] = ("pressure_angle", "helix_angle", "hand")

    #: Names of the tables of members.
    toothed: ClassVar[tuple[str, ...]] = ("pinion", "gear")
    replaces: ClassVar = (("transverse_pressure_angle", "pressure_angle"), ("circumferential_backlash", "backlash"))
    exclusive: ClassVar[tuple[tuple[str, str], ...]] = tuple(
        (second, first) for first, second in combinations(SIZE_KEYS, 2)
    )
    transverse_module: float | None = module_key("transverse module", "given by module")
    transverse_diametral_pitch: float | None = pitch_key(
        "transverse diametral pitch, per inch in any units", "given by module"
    )
    profile: str = keys.choice(
        "basic rack: addendum, dedendum and tip rounding", tuple(BASIC_RACKS), "A", source="ISO 53"
    )
    pressure_angle: float = keys.angle(
        "normal pressure angle; with a coast_pressure_angle that of the drive side, the pinion's right flanks",
        DERIVED_VALUE,
        low=1,
        high=45,
        default="20, or by transverse_pressure_angle",
        source="ISO 53",
    )
    transverse_pressure_angle: float | None = keys.angle(
        "transverse pressure angle, instead of the normal one", None, low=1, high=60, default="by pressure_angle"
    )
    coast_pressure_angle: float | None = coast_pressure_angle_key()
    helix_angle: float = keys.angle("helix angle at the reference cylinder", 0.0, low=0, high=60)
    hand: str = keys.choice("hand of the pinion's helix", ("right", "left"), "right")
    backlash: float = keys.length(
        "normal backlash j_bn at the centre distance; each tooth is thinned for half of it",
        DERIVED_VALUE,
        low=-10,
        high=1000,
        default="as shifts, allowances and centre distance give",
        source="ISO 21771",
    )
    circumferential_backlash: float | None = keys.length(
        "backlash j_wt on the working pitch circles, instead of backlash",
        None,
        low=-10,
        high=1000,
        default="by backlash",
        source="ISO 21771",
    )

    @property
    def kind_in_words(self) -> str:
        if self.called:
            return self.called
        inside = any(spec.internal for spec in self.specs.values())
        return f"{'internal ' if inside else ''}{self._trace} gear{'s' if len(self.specs) > 1 else ''}".capitalize()

    @property
    def _trace(self) -> str:
        """Word for the teeth by their helix."""
        return "helical" if self.helix_angle else "spur"

    @property
    def _size_symbols(self) -> Mapping[str, str]:
        normal = "_n" if self.helix_angle else ""
        return {
            "module": f"m{normal}",
            "diametral_pitch": f"P{normal}",
            "transverse_module": "m_t",
            "transverse_diametral_pitch": "P_t",
        }

    @model_validator(mode="after")
    def _one_size(self) -> Self:
        if all(getattr(self, name) is None for name in SIZE_KEYS):
            raise conflict("module", None, reason=f"missing; give one of {', '.join(SIZE_KEYS)}")
        return self

    @model_validator(mode="after")
    def _series_fit_the_diameters(self) -> Self:
        for name, allowance in self._series():
            allowance.check_series(f"{name}.thickness_allowance", self._series_diameter(name), self.mm_per_unit)
        return self

    def _series(self) -> list[tuple[str, ThicknessAllowance]]:
        """Return names and allowances of the members whose allowances are given by a series."""
        given = [(name, spec.thickness_allowance) for name, spec in self.specs.items()]
        return [(name, table) for name, table in given if table is not None and table.series is not None]

    def _series_diameter(self, name: str) -> float:
        """Return the reference diameter of a member, or of the pinion of a rack, mm."""
        member = getattr(self, name)
        teeth = member.teeth if isinstance(member, CylindricalMember) else self.counted_teeth
        return float(teeth * self.given_module * self.mm_per_unit / math.cos(math.radians(self.helix_angle)))

    @property
    def given_module(self) -> float:
        """Normal module, in the design's units."""
        per_inch = MM_PER["inch"] / self.mm_per_unit
        cosine = math.cos(math.radians(self.helix_angle))
        if self.transverse_module is not None:
            return self.transverse_module * cosine
        if self.transverse_diametral_pitch is not None:
            return per_inch / self.transverse_diametral_pitch * cosine
        return super().given_module

    @property
    def normal_angle(self) -> float:
        """Normal pressure angle, deg."""
        if self.transverse_pressure_angle is not None:
            tangent = math.tan(math.radians(self.transverse_pressure_angle))
            return math.degrees(math.atan(tangent * math.cos(math.radians(self.helix_angle))))
        return given_or(self.pressure_angle, 20.0)

    @property
    def coast_angle(self) -> float | None:
        """Normal pressure angle of the coast side of asymmetric teeth, deg; None for symmetric teeth.

        Teeth are asymmetric, too, if a tool has another tip rounding, or teeth another tip edge, on the coast side.
        """
        coast = self.normal_angle if self.coast_pressure_angle is None else self.coast_pressure_angle
        other = any(spec.sides_differ for spec in self.specs.values())
        return coast if other or coast != self.normal_angle else None

    def derived_values(self) -> dict[str, float]:
        """Return the defaults that the profile gives; the system derives those that follow from the mesh.

        Returns
        -------
        dict of str to float
            By dotted key, in the file's units.

        Examples
        --------
        >>> sorted(gm.load("samples/helical.toml", complete=False).derived_values())[:2]
        ['contact.delta', 'contact.phi1.start']
        """
        defaults = super().derived_values()
        if self.transverse_pressure_angle is None:
            defaults["pressure_angle"] = 20.0
        for name, spec in self.specs.items():
            if spec.dedendum_counts:
                defaults[f"{name}.dedendum"] = BASIC_RACKS[self.profile][1]
        for name, allowance in self._series():
            ends = allowance.by_series(self._series_diameter(name))
            defaults |= {f"{name}.thickness_allowance.{end}": value / self.mm_per_unit for end, value in ends.items()}
        return defaults

    def stays(self, dotted: str, values: Mapping[str, Any]) -> bool:
        # the ends of an allowance follow from the diameter
        return super().stays(dotted, values) and "thickness_allowance." not in dotted

    @property
    def specs(self) -> dict[str, Any]:
        """Tables of the members by name."""
        given = {name: getattr(self, name) for name in self.toothed}
        return {name: spec for name, spec in given.items() if spec is not None}

    def with_allowances(self) -> list[str]:
        """Return the names of the members whose thickness is given.

        Returns
        -------
        list of str
            Of those that there are.

        Raises
        ------
        DesignError
            Where a backlash says the thicknesses, too.

        Examples
        --------
        >>> design.with_allowances()
        []
        """
        names = [name for name, spec in self.specs.items() if spec.thickness_key is not None]
        for name in names:
            for key in ("backlash", "circumferential_backlash"):
                if key in self.model_fields_set and not math.isnan(value := getattr(self, key) or math.nan):
                    other = self.name_in_texts(f"{name}.{self.specs[name].thickness_key}")
                    raise conflict(key, value, reason=f"cannot be given together with {other}")
        return names

    def plain(self) -> dict[str, Any]:
        values = super().plain()
        if self.with_allowances():
            # the thicknesses give the backlash
            values.pop("backlash", None)
        return values


class CylindricalKeys(ToothingKeys):
    """Keys of the designs of cylindrical gears, in addition to `ToothingKeys`."""

    shift_sharing: str = keys.choice(
        "how the sum of profile shifts that the centre distance needs is divided where they are not given: for equal specific "
        "sliding, in equal parts, or by the numbers of teeth",
        ("sliding", "equal", "teeth"),
        "sliding",
    )
    accuracy_class: int = accuracy_class_key()


class HalvesKeys(ToothingKeys):
    """Keys of the designs of gears and racks that may be double helical, in addition to `ToothingKeys`."""

    arrangement: str = keys.choice(
        "one helix, or two of opposite hands side by side, the first, at the toe, with the pinion's hand; face widths are then "
        "those of both halves and the gap together",
        ("single", "double_helical"),
        "single",
        source="ISO 21771",
    )
    gap: float = keys.length(
        "width of the gap between the halves of double helical gears; 0: they meet in a plane", 0.0, low=0
    )

    @model_validator(mode="after")
    def _sound_halves(self) -> Self:
        if not self.double_helical:
            if self.gap != 0.0:
                raise conflict("gap", self.gap, reason='needs arrangement = "double_helical"')
        elif self.helix_angle == 0.0:
            raise conflict("helix_angle", 0.0, must_be="above 0 for double helical gears")
        for name, spec in self.specs.items():
            if self.double_helical and spec.face_width <= self.gap:
                narrowest = min(member.face_width for member in self.specs.values())
                raise conflict(
                    "gap",
                    self.gap,
                    must_be=f"below the face width, {narrowest:g}, which it is part of",
                    other=(f"{name}.face_width", spec.face_width, f"above the gap, {self.gap:g}, which is part of it"),
                )
            floor = getattr(spec, spec.gap_key)
            if floor is not None and self.gap == 0.0:
                raise conflict(f"{name}.{spec.gap_key}", floor, reason="needs a gap above 0")
        return self

    @property
    def _trace(self) -> str:
        return "double helical" if self.double_helical else super()._trace

    @property
    def double_helical(self) -> bool:
        return self.arrangement == "double_helical"

    def _refuse_uneven_load(self, assembly: Table) -> None:
        """Refuse assembly errors of double helical members that would load the halves unequally."""
        for key in ("dz", "gamma_h", "gamma_v") if self.double_helical else ():
            if (value := getattr(assembly, key)) != 0.0:
                raise conflict(
                    f"assembly.{key}", value, must_be="0 for double helical gears: it would load their halves unequally"
                )

    def plain(self) -> dict[str, Any]:
        values = super().plain()
        if not self.double_helical and "arrangement" not in self.model_fields_set:
            del values["arrangement"], values["gap"]
        return values


class CylindricalDesign(HalvesKeys, CylindricalKeys, PairDesign):
    """A pair of spur or helical gears on parallel axes."""

    own_kind: ClassVar[str] = "cylindrical"
    example: ClassVar[Mapping[str, Any]] = {
        "module": 2,
        "pinion": {"teeth": 18, "face_width": 20},
        "gear": {"teeth": 45, "face_width": 20},
    }
    about: ClassVar[str] = OWN_KINDS["cylindrical"].about
    absent: ClassVar[Mapping[str, str]] = {
        "shaft_angle": 'the axes of kind "cylindrical" are parallel; kind "beveloid" has crossed helical gears, '
        "whose helix angles give the shaft angle",
    }

    pinion: CylindricalMember
    gear: CylindricalMember
    rexs: RexsSource | None = None
    assembly: CylindricalAssembly = CylindricalAssembly()
    contact: FlankContact = FlankContact()

    @model_validator(mode="after")
    def _thickness_said_once(self) -> Self:
        self.with_allowances()
        return self

    @model_validator(mode="after")
    def _evenly_loaded(self) -> Self:
        self._refuse_uneven_load(self.assembly)
        return self

    @model_validator(mode="after")
    def _one_inside_the_other(self) -> Self:
        if self.pinion.internal and self.gear.internal:
            raise conflict("gear.internal", True, reason="only one of two meshing gears can be internal")
        ring, other = (self.pinion, self.gear) if self.pinion.internal else (self.gear, self.pinion)
        if ring.internal and ring.teeth <= other.teeth:
            name = "pinion" if self.pinion.internal else "gear"
            raise conflict(
                f"{name}.teeth",
                ring.teeth,
                reason=f"an internal gear needs more teeth than its mating gear, {other.teeth}",
            )
        return self
