"""Settings of the machine that cuts or grinds a gear which a correction may move, and the flanks that it makes with other values.

Of gears without machine settings they are the modifications of their flanks, as a grinder takes them: slopes, crownings and twist.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError, DesignError
from gearmesh.kernel.motion.joint import Joint
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.metrology.flanks.projection import FlankProjection
from gearmesh.progress import in_turn
from gearmesh.systems import system as systems
from gearmesh.teeth.micro_geometry.deviations import DeviationGrid
from gearmesh.teeth.region import Side

#: tables of a member that are machines
MACHINES = ("concave", "convex", "cutter", "machine")
#: processes that cut both sides of the pinion at once: settings are those of both
COMPLETING = ("completing", "formate_completing")
#: settings that both sides have in common whatever the process: they set the depth of the cut
OF_DEPTH = ("sliding_base", "machine_root_angle")
#: the index of the blank
INDEX = "index_angle"
#: tables of a member whose flanks are ground with modifications, and what a grinder corrects of them; thickness is its infeed's
GROUND = {f"modifications_{side}": side for side in Side}
OF_GRINDER = ("profile_slope", "profile_crowning", "profile_twist", "helix_slope", "helix_crowning")
#: settings of a tool that rolls with the gear, as a shaper does or the worm in its place; `THICKNESS`: of both flanks alone, as
#: it turns one; `SWIVEL`: of the worm, whose feed takes up what it does to the flanks to first order
THICKNESS, SWIVEL = "thickness", "worm_angle"
OF_ROLLING = ("shaft_angle", "offset", "axial_position", "pressure_angle", THICKNESS)
#: settings that are moved where none are named, and those that may be named
USUAL = (
    "radial",
    "ratio_of_roll",
    "machining_offset",
    "machine_centre_to_back",
    "sliding_base",
    "machine_root_angle",
    INDEX,
    *OF_ROLLING,
)
ROLL = tuple(f"modified_roll_c{k}" for k in range(2, 7))
#: of the blades, of one side each
OF_BLADES = ("tip_radius", "blade_angle", "outside.blade_angle", "inside.blade_angle")
MOVABLE = (*USUAL, SWIVEL, "cradle_angle", "tilt", "swivel", *ROLL, "point_width", *OF_BLADES)
#: polynomials in the cradle's rotation, moved by one coefficient: helical_motion.1 is that of q
MOTIONS = tuple(f"{name}_motion" for name in ("tilt", "swivel", "radial", "helical", "vertical"))
ORDERS = range(1, 7)
#: first step of a setting by its unit (mm, deg), else; root mean square (mm) by which the flank is moved for its sensitivity, the
#: factor by which the step may change for that, and what counts as none
STEPS, STEP = {"length": 0.01, "angle": 0.01}, 1e-4
MOVED, FACTOR, NONE = 2e-3, 1e3, 1e-9
#: by how much the step is less where there is no tooth with it
SMALLER = 4.0
#: changes for which effects are stated: of a length (mm), an angle (deg), else
STATED, STATED_NUMBER = {"length": 0.01, "angle": 1.0 / 60.0}, 1e-4


@dataclass(frozen=True)
class MovableSetting:
    """A setting by its dotted `keys`, of several that move together; `order` of its coefficient in a polynomial, 0: a number."""

    name: str
    keys: tuple[str, ...]
    order: int = 0

    @property
    def plain_name(self) -> str:
        """Its name without the side that it is of."""
        first, _, rest = self.name.partition(".")
        return rest if first in (*MACHINES, *Side) else self.name

    @property
    def tilts(self) -> bool:
        """True for the tilt of a cutter, whose sense depends on its swivel."""
        return self.plain_name == "tilt"


def movable_settings(design: Design, name: str) -> tuple[MovableSetting, ...]:
    """All that a correction of a member may move. Raises DesignError for members that no machine with settings cuts."""
    own = design.table_named(name)
    table = getattr(design, own, None)
    machines = [machine for machine in MACHINES if hasattr(table, machine)]
    if not machines:
        return _ground_settings(design, own)
    both = getattr(design, "process", None) in COMPLETING and len(machines) > 1
    made = []
    for setting in (*MOVABLE, *(f"{motion}.{order}" for motion in MOTIONS for order in ORDERS)):
        base, _, order = setting.partition(".") if setting.startswith(MOTIONS) else (setting, "", "0")
        keys = {machine: f"{name}.{machine}.{base}" for machine in machines}
        keys = {machine: key for machine, key in keys.items() if type(design).key_at(key) is not None}
        if len(machines) > 1 and (setting in OF_DEPTH or (both and setting not in OF_BLADES)):
            # the blank's index, if it is that of both sides, turns the gear
            if keys and setting != INDEX:
                made.append(MovableSetting(setting, tuple(keys.values()), int(order)))
            continue
        for machine, key in keys.items():
            full = f"{machine}.{setting}" if len(machines) > 1 else setting
            made.append(MovableSetting(full, (key,), int(order)))
    return tuple(made)


def _ground_settings(design: Design, own: str) -> tuple[MovableSetting, ...]:
    """Those of a member, by the name of its table, whose flanks may be modified."""
    made = tuple(
        MovableSetting(f"{side}.{setting}", (key,))
        for table, side in GROUND.items()
        for setting in OF_GRINDER
        if type(design).key_at(key := f"{own}.{table}.{setting}") is not None
    )
    if not made:
        raise ArgumentError(
            "kind",
            design.kind,
            reason=f"its {own} is not cut with machine settings, and its flanks are not modified",
            allowed="bevel, hypoid and face gears, and members with tables of modifications",
        )
    return made


@dataclass(frozen=True)
class CutFlanks:
    """Flanks of a member of a `design` that states all settings, at the points of grids: of any other settings."""

    design: Design
    name: str
    grids: Mapping[Side, DeviationGrid]
    joint: Joint

    def displacements(self, values: Mapping[str, Any]) -> Array:
        """How far (N,), mm along the normals, the flanks cut with other values of keys are beyond the points, side by side.

        Raises DesignError for values with which there is no tooth.
        """
        made = self.design.with_values(values)
        alone = self.name in systems.system_of(made).members
        member = systems.member(made, self.name).member if alone else systems.build(made).members[self.name]
        tooth = member.one_tooth
        parts = []
        for side, grid in self.grids.items():
            feet = FlankProjection(tooth, side).foot_points(grid.points.reshape(-1, 3))
            parts.append(-feet.distances / dot(feet.normals, grid.normals.reshape(-1, 3)))
        return np.concatenate(parts)

    @property
    def rotation(self) -> Array:
        """Displacements (N,), mm per rad of rotation of the member, of a rack along it."""
        parts = [self.joint.along(grid.points, grid.normals) for grid in self.grids.values()]
        return np.concatenate([part.ravel() for part in parts])

    @property
    def thickness(self) -> Array:
        """Displacements (N,), mm per mm of normal tooth thickness, half on either flank."""
        return np.full(self.rotation.shape, 0.5)

    def values(self, settings: Sequence[MovableSetting], changes: Sequence[float]) -> dict[str, Any]:
        """Values of all keys after changes of settings."""
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
        """Of a setting, in the design's units."""
        value = self._value(setting.keys[0])
        if not setting.order:
            return float(value)
        return float(value[setting.order - 1]) if len(value) >= setting.order else 0.0

    def swivel_of(self, setting: MovableSetting) -> float:
        """Swivel (deg) of the cutter that a tilt belongs to."""
        return float(self._value(f"{setting.keys[0].rpartition('.')[0]}.swivel") or 0.0)

    def unit(self, setting: MovableSetting) -> str:
        """Of a setting: the design's unit of length, deg, or none."""
        unit = self._quantity(setting)
        return self.design.units if unit == "length" else "deg" if unit == "angle" else ""

    def stated_change(self, setting: MovableSetting) -> float:
        """The change of a setting, in its unit, for which its effect is stated."""
        return self._change(setting, STATED, STATED_NUMBER)

    def sensitivity(self, setting: MovableSetting) -> Array:
        """Displacements (N,), mm per unit of a setting, by central differences of the exact flanks; 0 where it moves none.

        Raises DesignError where the design has not the setting, or no room for it to move.
        """
        if self._value(setting.keys[0]) is None:
            raise ArgumentError(
                "settings", setting.name, reason="the design has no value of it", allowed="other settings"
            )
        step = self._change(setting, STEPS, STEP)
        size = float(np.sqrt(np.mean(self._after(setting, step) ** 2)))
        if not size > NONE:
            return np.zeros_like(self.rotation)
        factor = float(np.clip(MOVED / size, 1.0 / FACTOR, FACTOR))
        while True:
            by = step * factor
            try:
                return np.asarray((self._after(setting, by) - self._after(setting, -by)) / (2.0 * by))
            except DesignError:
                # a setting that moves the flanks little may have no room for so much of it
                if factor <= 1.0:
                    raise
                factor = max(factor / SMALLER, 1.0)

    def _after(self, setting: MovableSetting, change: float) -> Array:
        """Displacements (N,), mm, by the change of one setting. Raises ArgumentError where points are beside the flank."""
        made = self.displacements(self.values([setting], [change]))
        if not np.isfinite(made).all():
            raise ArgumentError(
                "settings", setting.name, reason="points that were measured are beside the flank that it makes"
            )
        return made

    def _change(self, setting: MovableSetting, by: Mapping[str, float], number: float) -> float:
        """A change by the quantity that a setting is, in the design's units."""
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
        return 0.0 if table is None and dotted.rpartition(".")[0].endswith(tuple(GROUND)) else table


def usable_settings(flanks: CutFlanks, names: Sequence[str]) -> dict[MovableSetting, Array]:
    """The settings named, "radial" or of one side "concave.radial", or the usual ones, that move the flanks, with their
    sensitivity (N,). Raises DesignError for names that there are not and for settings that do not move the flanks."""
    every = movable_settings(flanks.design, flanks.name)
    made: dict[MovableSetting, Array] = {}
    for name in in_turn(names):
        matches = [setting for setting in every if name in (setting.name, setting.plain_name)]
        if not matches:
            shown = list(dict.fromkeys(setting.plain_name for setting in every if not setting.order))
            shown += [f"{', '.join(MOTIONS)}.1 and on"] if any(setting.order for setting in every) else []
            raise ArgumentError("settings", name, must_be=f"one of {', '.join(shown)}, comma between them")
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
    whole = len(flanks.grids) == len(Side)
    for setting in in_turn(every):
        # what both sides have in common is left alone where one was measured
        of_one = len(setting.keys) == 1 and setting.name != THICKNESS
        if setting.plain_name in (*USUAL, *OF_GRINDER) and (whole or of_one):
            try:
                column = flanks.sensitivity(setting)
            except DesignError:
                # a machine that does not roll has no ratio of roll
                continue
            if column.any():
                made[setting] = column
    return made
