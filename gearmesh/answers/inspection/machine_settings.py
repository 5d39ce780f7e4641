"""Settings of the machine that cuts or grinds a gear, as a correction may change them, and the flanks that they make.

Settings of gears without machine settings are the modifications of their flanks, as a grinding machine takes them:
slopes, crownings and twist.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError, DesignError
from gearmesh.kernel.motion.joint import Joint
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.metrology.flanks.projection import FlankProjection
from gearmesh.progress import in_turn
from gearmesh.records import dataclass
from gearmesh.systems import system as systems
from gearmesh.teeth.micro_geometry.deviations import DeviationGrid
from gearmesh.teeth.region import Side

#: tables of a member that describe machines
MACHINE_TABLES = ("concave", "convex", "cutter", "machine")
#: processes that cut both sides of the pinion at once, so that both sides have the same settings
COMPLETING_PROCESSES = ("completing", "formate_completing")
#: settings for the depth of the cut, which both sides share in all processes
DEPTH_SETTINGS = ("sliding_base", "machine_root_angle")
#: index of the blank
INDEX_SETTING = "index_angle"
#: tables of a member whose flanks are ground with modifications, with their sides
GROUND_TABLES = {f"modifications_{side}": side for side in Side}
#: modifications that a grinding machine corrects; its infeed sets the thickness
GRINDER_SETTINGS = ("profile_slope", "profile_crowning", "profile_twist", "helix_slope", "helix_crowning")
#: tooth thickness of a rolling tool; a setting only if both flanks were measured, because it merely turns a single
#: flank
THICKNESS_SETTING = "thickness"
#: swivel of a grinding worm; its feed cancels the effect on the flanks to first order
WORM_SWIVEL_SETTING = "worm_angle"
#: settings of a tool that rolls with the gear: a shaper, or the worm that replaces it
ROLLING_SETTINGS = ("shaft_angle", "offset", "axial_position", "pressure_angle", THICKNESS_SETTING)
#: settings that are moved if none are named
USUAL_SETTINGS = (
    "radial",
    "ratio_of_roll",
    "machining_offset",
    "machine_centre_to_back",
    "sliding_base",
    "machine_root_angle",
    INDEX_SETTING,
    *ROLLING_SETTINGS,
)
#: coefficients of modified roll
ROLL_COEFFICIENTS = tuple(f"modified_roll_c{k}" for k in range(2, 7))
#: settings of the blades, which belong to one side
BLADE_SETTINGS = ("tip_radius", "blade_angle", "outside.blade_angle", "inside.blade_angle")
#: settings that may be named
MOVABLE_SETTINGS = (
    *USUAL_SETTINGS,
    WORM_SWIVEL_SETTING,
    "cradle_angle",
    "tilt",
    "swivel",
    *ROLL_COEFFICIENTS,
    "point_width",
    *BLADE_SETTINGS,
)
#: polynomials in the cradle's rotation; one coefficient is moved: helical_motion.1 is the coefficient of q
MOTION_POLYNOMIALS = tuple(f"{name}_motion" for name in ("tilt", "swivel", "radial", "helical", "vertical"))
#: orders of the coefficients
MOTION_ORDERS = range(1, 7)
#: first step of lengths (mm) and angles (deg) for differences
FIRST_STEPS = {"length": 0.01, "angle": 0.01}
#: first step of other settings
FIRST_NUMBER_STEP = 1e-4
#: root mean square by which a difference step moves the flank
TARGET_MOVE_MM = 2e-3
#: limit of the factor from the first step to the final step
MAX_STEP_FACTOR = 1e3
#: root mean square that counts as no movement of the flank
MIN_MOVE_MM = 1e-9
#: factor by which the step is reduced if there is no tooth with it
STEP_DIVISOR = 4.0
#: changes of lengths (mm) and angles (deg) for which effects are stated
STATED_CHANGES = {"length": 0.01, "angle": 1.0 / 60.0}
#: change of other settings for which effects are stated
STATED_NUMBER_CHANGE = 1e-4


@dataclass(frozen=True)
class MovableSetting:
    """Setting that a correction may change."""

    #: name of the setting, with its side if the sides differ
    name: str
    #: dotted keys of the setting; several keys change together
    keys: tuple[str, ...]
    #: order of its coefficient in a polynomial; 0 for a number
    order: int = 0

    @property
    def plain_name(self) -> str:
        """Name without the side."""
        first, _, rest = self.name.partition(".")
        return rest if first in (*MACHINE_TABLES, *Side) else self.name

    @property
    def tilts(self) -> bool:
        """True for the tilt of a cutter, whose sense depends on its swivel."""
        return self.plain_name == "tilt"


def movable_settings(design: Design, name: str) -> tuple[MovableSetting, ...]:
    """Return all settings that a correction of a member may change. Raises ArgumentError for members without any."""
    table_name = design.table_named(name)
    table = getattr(design, table_name, None)
    machines = [machine for machine in MACHINE_TABLES if hasattr(table, machine)]
    if not machines:
        return _ground_settings(design, table_name)
    same_settings = getattr(design, "process", None) in COMPLETING_PROCESSES and len(machines) > 1
    made = []
    for setting in (
        *MOVABLE_SETTINGS,
        *(f"{motion}.{order}" for motion in MOTION_POLYNOMIALS for order in MOTION_ORDERS),
    ):
        base, _, order = setting.partition(".") if setting.startswith(MOTION_POLYNOMIALS) else (setting, "", "0")
        keys = {machine: f"{name}.{machine}.{base}" for machine in machines}
        keys = {machine: key for machine, key in keys.items() if type(design).key_at(key) is not None}
        if len(machines) > 1 and (setting in DEPTH_SETTINGS or (same_settings and setting not in BLADE_SETTINGS)):
            # the index of the blank, if both sides share it, only turns the gear
            if keys and setting != INDEX_SETTING:
                made.append(MovableSetting(setting, tuple(keys.values()), int(order)))
            continue
        for machine, key in keys.items():
            full = f"{machine}.{setting}" if len(machines) > 1 else setting
            made.append(MovableSetting(full, (key,), int(order)))
    return tuple(made)


def _ground_settings(design: Design, table_name: str) -> tuple[MovableSetting, ...]:
    """Return the modifications of a member, given by the name of its table, whose flanks may be modified."""
    made = tuple(
        MovableSetting(f"{side}.{setting}", (key,))
        for table, side in GROUND_TABLES.items()
        for setting in GRINDER_SETTINGS
        if type(design).key_at(key := f"{table_name}.{table}.{setting}") is not None
    )
    if not made:
        raise ArgumentError(
            "kind",
            design.kind,
            reason=f"its {table_name} is not cut with machine settings, and its flanks are not modified",
            allowed="bevel, hypoid and face gears, and members with tables of modifications",
        )
    return made


@dataclass(frozen=True)
class CutFlanks:
    """Flanks of a member for any settings, at the points of grids."""

    #: the design, with all its settings
    design: Design
    #: name of the member
    name: str
    #: measured points and deviations, by side
    grids: Mapping[Side, DeviationGrid]
    #: joint of the member
    joint: Joint

    def displacements(self, values: Mapping[str, Any]) -> Array:
        """Return the displacements (N,), mm along the normals, from the points to the flanks cut with other values of
        keys.

        The sides follow each other. Raises DesignError for values that give no tooth.
        """
        made = self.design.with_values(values)
        built_alone = self.name in systems.system_of(made).members
        member = systems.member(made, self.name).member if built_alone else systems.build(made).members[self.name]
        tooth = member.one_tooth
        parts = []
        for side, grid in self.grids.items():
            feet = FlankProjection(tooth, side).foot_points(grid.points.reshape(-1, 3))
            parts.append(-feet.distances / dot(feet.normals, grid.normals.reshape(-1, 3)))
        return np.concatenate(parts)

    @property
    def rotation(self) -> Array:
        """Displacements (N,), mm per rad of rotation of the member, or per mm of travel of a rack."""
        parts = [self.joint.along(grid.points, grid.normals) for grid in self.grids.values()]
        return np.concatenate([part.ravel() for part in parts])

    @property
    def thickness(self) -> Array:
        """Displacements (N,), mm per mm of normal tooth thickness, half on each flank."""
        return np.full(self.rotation.shape, 0.5)

    def values(self, settings: Sequence[MovableSetting], changes: Sequence[float]) -> dict[str, Any]:
        """Return the values of all keys after changes of settings."""
        values: dict[str, Any] = {}
        for setting, change in zip(settings, changes, strict=True):
            for key in setting.keys:
                before = values.get(key, self._value(key))
                if setting.order:
                    orders = [*before, *[0.0] * (setting.order - len(before))]
                    orders[setting.order - 1] += float(change)
                    values[key] = orders
                else:
                    values[key] = float(before) + float(change)
        return values

    def value(self, setting: MovableSetting) -> float:
        """Return the value of a setting, in the design's units."""
        value = self._value(setting.keys[0])
        if not setting.order:
            return float(value)
        return float(value[setting.order - 1]) if len(value) >= setting.order else 0.0

    def swivel_of(self, setting: MovableSetting) -> float:
        """Return the swivel (deg) of the cutter that a tilt belongs to."""
        return float(self._value(f"{setting.keys[0].rpartition('.')[0]}.swivel") or 0.0)

    def unit(self, setting: MovableSetting) -> str:
        """Return the unit of a setting: the design's unit of length, deg, or none."""
        unit = self._quantity(setting)
        return self.design.units if unit == "length" else "deg" if unit == "angle" else ""

    def stated_change(self, setting: MovableSetting) -> float:
        """Return the change of a setting, in its unit, for which its effect is stated."""
        return self._change(setting, STATED_CHANGES, STATED_NUMBER_CHANGE)

    def sensitivity(self, setting: MovableSetting) -> Array:
        """Return displacements (N,), mm per unit of a setting, by central differences of the exact flanks.

        They are 0 for a setting that does not move the flanks. Raises an error if the design lacks the setting, or has
        no room for it to change.
        """
        if self._value(setting.keys[0]) is None:
            raise ArgumentError(
                "settings", setting.name, reason="the design has no value of it", allowed="other settings"
            )
        step = self._change(setting, FIRST_STEPS, FIRST_NUMBER_STEP)
        size = float(np.sqrt(np.mean(self._after(setting, step) ** 2)))
        if not size > MIN_MOVE_MM:
            return np.zeros_like(self.rotation)
        # scale the step so that it moves the flank by a definite amount, well above rounding and still nearly linear
        factor = float(np.clip(TARGET_MOVE_MM / size, 1.0 / MAX_STEP_FACTOR, MAX_STEP_FACTOR))
        while True:
            by = step * factor
            try:
                return np.asarray((self._after(setting, by) - self._after(setting, -by)) / (2.0 * by))
            except DesignError:
                # a setting with little effect on the flanks may have no room for so large a step
                if factor <= 1.0:
                    raise
                factor = max(factor / STEP_DIVISOR, 1.0)

    def _after(self, setting: MovableSetting, change: float) -> Array:
        """Return displacements (N,), mm, by the change of one setting.

        Raises ArgumentError if points are outside the new flank.
        """
        made = self.displacements(self.values([setting], [change]))
        if not np.isfinite(made).all():
            raise ArgumentError(
                "settings", setting.name, reason="points that were measured are beside the flank that it makes"
            )
        return made

    def _change(self, setting: MovableSetting, by: Mapping[str, float], number: float) -> float:
        """Return the change for the quantity of a setting, in the design's units."""
        quantity = self._quantity(setting)
        return by.get(quantity, number) / (self.design.mm_per_unit if quantity == "length" else 1.0)

    def _quantity(self, setting: MovableSetting) -> str:
        key = type(self.design).key_at(setting.keys[0])
        return "number" if key is None else key.unit

    def _value(self, dotted: str) -> Any:
        table: Any = self.design.plain()
        for part in dotted.split("."):
            table = table.get(part) if isinstance(table, Mapping) else None
        # a flank without modifications has amounts of 0
        return 0.0 if table is None and dotted.rpartition(".")[0].endswith(tuple(GROUND_TABLES)) else table


def settings_named(all_settings: Sequence[MovableSetting], name: str) -> list[MovableSetting]:
    """Return the settings with a name, of one side or both. Raises ArgumentError for an unknown name."""
    matches = [setting for setting in all_settings if name in (setting.name, setting.plain_name)]
    if not matches:
        shown = list(dict.fromkeys(setting.plain_name for setting in all_settings if not setting.order))
        shown += [f"{', '.join(MOTION_POLYNOMIALS)}.1 and on"] if any(setting.order for setting in all_settings) else []
        raise ArgumentError("settings", name, must_be=f"one of {', '.join(shown)}, comma between them")
    return matches


def usable_settings(flanks: CutFlanks, names: Sequence[str]) -> dict[MovableSetting, Array]:
    """Return the named settings that move the flanks, by default the usual settings, with their sensitivity (N,).

    "radial" names a setting of both sides, "concave.radial" of one side. Raises ArgumentError for unknown names, for settings
    that do not move the flanks, and if the design refuses them all.
    """
    all_settings = movable_settings(flanks.design, flanks.name)
    made: dict[MovableSetting, Array] = {}
    for name in in_turn(names):
        matches = settings_named(all_settings, name)
        moving = {setting: column for setting in matches if (column := flanks.sensitivity(setting)).any()}
        if not moving:
            raise ArgumentError(
                "settings",
                name,
                reason="does not move the flanks that were measured",
                allowed="settings of their machine",
            )
        made |= moving
    if names:
        return made
    both_measured = len(flanks.grids) == len(Side)
    refusal: DesignError | None = None
    for setting in in_turn(all_settings):
        # settings that both sides share are not changed if only one side was measured
        one_sided = len(setting.keys) == 1 and setting.name != THICKNESS_SETTING
        if setting.plain_name in (*USUAL_SETTINGS, *GRINDER_SETTINGS) and (both_measured or one_sided):
            try:
                column = flanks.sensitivity(setting)
            except DesignError as failure:
                # for example, a machine that does not roll has no ratio of roll
                refusal = failure
                continue
            if column.any():
                made[setting] = column
    if refusal is not None and not made:
        raise ArgumentError("settings", reason=f"none can be set: {refusal}") from refusal
    return made
