"""Sheet of a spiral bevel pair: blank, cutters and machine settings for the shop; dimensions; forces.

A requested ease-off adds tables of what is reached of it, and of the residual topography.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.systems.common.bevel.accuracy import tolerance_table
from gearmesh.systems.common.bevel.blank import BevelBlank, MemberBlank, Proportions
from gearmesh.systems.common.bevel.cone_blank import ConeData, cone_dimensions
from gearmesh.systems.common.bevel.iso23509.dimension_table import pair_rows
from gearmesh.systems.common.symbol_table import Part, running_rows, table, tables_of
from gearmesh.systems.spiral_bevel.blank.proportion_choice import FACTOR_KEYS
from gearmesh.systems.spiral_bevel.design import (
    CROWN_MACHINE_KEYS,
    SYNTHESISED_KEYS,
    HypoidDesign,
    SpiralBevelDesign,
)
from gearmesh.systems.spiral_bevel.hobbing.head_sheet import head_table, head_values
from gearmesh.systems.spiral_bevel.hobbing.secondary_cut import HeadRoom
from gearmesh.systems.spiral_bevel.machine.cutting import Choices, indexed_backlash
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.spiral_bevel.machine.maker_settings import maker_table
from gearmesh.systems.spiral_bevel.machine.pair import BLADE_SIDES, HAND_SIGNS, MATING_SIDES, Sides, nominal_base
from gearmesh.systems.spiral_bevel.sheet.dimension_sheet import CutPair, dimension_tables, point_width
from gearmesh.systems.spiral_bevel.sheet.slots import slot_widths_of
from gearmesh.systems.spiral_bevel.sheet.thrusts import thrust_table
from gearmesh.systems.spiral_bevel.synthesis.flank_form import form_figures
from gearmesh.systems.spiral_bevel.synthesis.settings import mean_point, offset_data
from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import bevel_teeth
from gearmesh.systems.system import Sheet, SheetTable
from gearmesh.teeth.gear_train import GearTrain, Member
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign
    from gearmesh.systems.spiral_bevel.synthesis.settings import FlankForm
    from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import BevelTeeth


#: title of the table of hypoid gears
OFFSET_TITLE = "Pitch plane with offset [ISO 23509]"


def settings_sheet(design: FaceMilledDesign, train: GearTrain) -> Sheet:
    """Return the sheet of a spiral bevel design and its gear set, lengths in the design's units, angles in deg.

    Raises DesignError for blanks that cannot exist, and NoSolutionError if local synthesis has no solution.
    """
    design_mm, unit = design.in_mm(), design.mm_per_unit
    made = bevel_teeth(design_mm)
    blank, pinion, gear, choices = made.cut.blank, made.cut.pinion, made.cut.gear, made.choices
    index = {name: float(np.degrees(angle)) for name, angle in made.cut.index_angles.items()}
    teeth = train.members
    # free edge radii as reduced to fit the teeth
    pinion, gear = (
        {name: fit_edge_radius(side, teeth[member]) for name, side in sides.items()}
        for member, sides in (("pinion", pinion), ("gear", gear))
    )
    made_sides = [*pinion.values(), *gear.values()]
    members = teeth["pinion"], teeth["gear"]
    slots = [slot_widths_of(member.tooth, own_blank) for member, own_blank in zip(members, blank.members, strict=True)]
    cut = CutPair(blank, pinion, gear, members, indexed_backlash(made.cut), design_mm.completing)
    sides = tuple(f"{member} {name}" for member in ("pinion", "gear") for name in BLADE_SIDES)
    angles = () if design.one_crown_gear else tuple(index.values())
    narrowest = float(slots[0].min()), float(slots[1].min())
    tables = tables_of(
        (
            "Blank",
            lambda: SheetTable(
                "Blank",
                ("pinion", "gear"),
                (
                    *member_rows(_with_thicknesses(cut), unit, design.units),
                    *slot_rows(slots, unit, design.units),
                ),
            ),
        ),
        ("Pair", lambda: SheetTable("Pair", ("",), pair_rows_of(blank, unit, design.units))),
        *head_part(design, made_sides, sides, blank, lambda: head_rooms(made, members)),
        ("Settings", lambda: setting_tables(made_sides, sides, angles, unit, design.units)),
        ("Dimensions", lambda: dimension_tables(cut, design_mm.hand, narrowest, unit, design.units)),
        ("Tolerances", lambda: [tolerance_table(design_mm.accuracy_grade, blank, ("pinion", "gear"))]),
    )
    if isinstance(design_mm, HypoidDesign):
        offset = tables_of((OFFSET_TITLE, lambda: _offset_table(design_mm, made.proportions, unit, design.units)))
        tables = (*tables, *offset)
    values = (
        head_values(design_mm, blank, unit)
        if design.one_crown_gear
        else _machine_values(design, pinion, gear, choices, unit)
    )
    if design.one_crown_gear:
        nouns = {key: noun for _, noun, key in _SETTING_KEYS}
        values |= {
            f"pinion.{name}.{key}": _value(side, key, 1.0 if nouns[key] else unit)
            for name, side in pinion.items()
            for key in CROWN_MACHINE_KEYS
        }
    # chosen factors; suggested ones follow from the basic data again
    values |= {key: value for key in FACTOR_KEYS if (value := getattr(made.proportions, key)) is not None}
    if design.hobbed:
        values["head.radius"] = blank.cutter_radius / unit
    else:
        values |= {
            "gear.cutter.tip_radius": blank.cutter_radius / unit,
            "gear.cutter.point_width": point_width(gear) / unit,
        }
    edges = {f"pinion.{name}": side.blade.edge_radius for name, side in pinion.items()}
    outside_radius, inside_radius = (gear[name].blade.edge_radius for name in ("concave", "convex"))
    edges |= (
        {"gear.cutter": outside_radius}
        if outside_radius == inside_radius
        else {"gear.cutter.outside": outside_radius, "gear.cutter.inside": inside_radius}
    )
    values |= {f"{key}.edge_radius": value / unit for key, value in edges.items()}
    values |= {
        "face_width": blank.gear.face_width / unit,
        "clearance": blank.clearance / unit,
    }
    if isinstance(design_mm, SpiralBevelDesign):
        values["mean_cone_distance"] = blank.gear.mean_cone_distance / unit
    for name, member in (("pinion", blank.pinion), ("gear", blank.gear)):
        if not design.hobbed:
            values[f"{name}.root_angle"] = float(np.degrees(member.root_angle))
        values[f"{name}.face_angle"] = float(np.degrees(member.face_angle))
    forms = {name: choice.form for name, choice in choices.items() if choice.form is not None}
    if design.one_crown_gear:
        return Sheet(tables, values)
    indexed = {f"pinion.{name}.index_angle": angle for name, angle in index.items()}
    # the index of a flank with ease-off is a result; other flanks follow their settings again
    values |= {key: angle for key, angle in indexed.items() if key.split(".")[1] in forms}
    of_form = tables_of(("Flank form", lambda: form_tables(design_mm, forms)))
    return Sheet((*tables, *of_form), values, _replaced_keys(design), following=indexed)


def _machine_values(
    design: FaceMilledDesign, pinion: Sides, gear: Sides, choices: Choices, unit: float
) -> dict[str, float]:
    """Return settings and blades of face milling, and the chosen contact, by key of the design."""
    nouns = {key: noun for _, noun, key in _SETTING_KEYS}
    values = {
        f"{prefix}.{key}": _value(side, key, 1.0 if nouns[key] else unit)
        for prefix, side in (
            ("pinion.concave", pinion["concave"]),
            ("pinion.convex", pinion["convex"]),
            *([] if design.hobbed else [("gear.cutter", gear["concave"])]),
        )
        for key in (*SYNTHESISED_KEYS, "blade_height")
        if not (design.formate and prefix == "gear.cutter" and key == "ratio_of_roll")
    }
    # blades of heads may be hollow though the design leaves it open
    values |= {
        f"pinion.{name}.blade_radius": _value(side, "blade_radius", unit)
        for name, side in pinion.items()
        if design.hobbed
    }
    values |= {
        f"pinion.{name}.{key}": _value(side, key, 1.0 if nouns[key] else unit)
        for name, side in pinion.items()
        if side.settings.tilted
        for key in ("sliding_base", "machine_root_angle")
    }
    values |= {
        f"gear.cutter.{table}.blade_angle": _value(gear[name], "blade_angle", 1.0)
        for name, table in (("concave", "outside"), ("convex", "inside"))
        if gear["concave"].blade.blade_angle != gear["convex"].blade.blade_angle
    }
    values |= {
        f"pinion.{name}.{key}": value / unit
        for name, choice in choices.items()
        for key, value in (("mean_offset", choice.height), ("mean_shift", choice.along))
    }
    values |= {
        f"pinion.{name}.modified_roll_c{power}": value
        for name, side in pinion.items()
        for power, value in enumerate(side.settings.modified_roll, start=2)
        if any(choices[name].roll) or choices[name].by_roll or choices[name].form is not None
    }
    return values


def head_part(
    design: FaceMilledDesign,
    sides: list[Generated],
    names: tuple[str, ...],
    blank: BevelBlank,
    rooms: Callable[[], list[HeadRoom]],
) -> list[Part]:
    """Return the table of the head of a design, in its units, if the teeth are face-hobbed.

    `rooms`: returns the room for the blades of each member.
    """
    if not design.hobbed:
        return []
    unit, noun, one = design.mm_per_unit, design.units, design.one_crown_gear
    made = "Face hobbing head"
    return [(made, lambda: head_table(sides, names, blank, rooms(), unit, noun, one_crown_gear=one))]


def head_rooms(made: BevelTeeth, members: tuple[Member, Member]) -> list[HeadRoom]:
    """Return the room for the blades of a head in the spaces of both members."""
    cut = made.cut
    return [
        HeadRoom.of(member, sides, places)
        for member, sides, places in zip(members, (cut.pinion, cut.gear), cut.places, strict=True)
    ]


def setting_tables(
    sides: list[Generated], names: tuple[str, ...], index: tuple[float, ...], unit: float, noun: str
) -> tuple[SheetTable, SheetTable]:
    """Return the tables of cutters and machines, by this program's names and by the makers' names.

    - `sides`, `names`: sides and their names
    - `index`: index angles of the pinion's sides, deg; those of the gear's sides are 0
    - `unit`, `noun`: unit of lengths (mm) and its name
    """
    angles = (*index, *(0.0 for _ in sides[len(index) :]))
    rows = (
        *_setting_rows(_SETTING_KEYS, sides, unit, noun),
        *([("index angle of the blank", "deg", *angles)] if index else []),
        *_extra_rows(sides, unit, noun),
    )
    return SheetTable("Cutters and machine settings", names, rows), maker_table(sides, names, unit, noun)


def _replaced_keys(design: FaceMilledDesign) -> tuple[str, ...]:
    """Return the keys of a design that are replaced by the settings on the sheet."""
    keys = [f"pinion.{name}.ease_off" for name in BLADE_SIDES if design.pinion.side(name).ease_off is not None]
    keys += ["contact.ease_off"] if design.contact.ease_off is not None else []
    return (*keys, *(["gear.thickness"] if design.gear.thickness is not None else []))


def _offset_table(design: HypoidDesign, given: Proportions, unit: float, noun: str) -> SheetTable:
    """Return the table of ISO 23509 dimensions common to both members of a hypoid design in mm, with their symbols.

    `given`: proportions of the teeth.
    """
    rows = pair_rows(cone_dimensions(ConeData.of_hypoid(offset_data(design)), given))
    return SheetTable(
        OFFSET_TITLE,
        ("",),
        tuple(
            (words, noun if kind == "mm" else kind, value / unit if kind == "mm" else value)
            for _, words, kind, value in rows
        ),
        tuple(symbol for symbol, *_ in rows),
    )


def tooth_forces(design: FaceMilledDesign, torque: float, speed: float | None) -> tuple[SheetTable, ...]:
    """Return the forces on the members for a torque (Nm) on the pinion, which turns at a speed (1/min).

    Raises as `settings_sheet`.
    """
    design_mm = design.in_mm()
    made = bevel_teeth(design_mm)
    blank, gear = made.cut.blank, made.cut.gear
    base = nominal_base(blank, HAND_SIGNS[design_mm.hand])
    means = {
        name: mean_point(design_mm, blank, gear[MATING_SIDES[name]], base, made.choices[name]) for name in BLADE_SIDES
    }
    ratio = design_mm.gear.teeth / design_mm.pinion.teeth
    speeds = None if speed is None else (speed, speed / ratio)
    running = table("Torque, speed and power", ("pinion", "gear"), running_rows((torque, torque * ratio), speeds))
    forces = thrust_table(blank, means, base, torque)
    return (forces,) if speed is None else (forces, running)


def fit_edge_radius(side: Generated, member: Member) -> Generated:
    """Return the side with the edge radius of its fillet."""
    return replace(side, blade=replace(side.blade, edge_radius=edge_radius(member, side.flank)))


def edge_radius(member: Member, flank: Side) -> float:
    """Return the rounding (mm) of the blade's tip that generates a fillet of a member."""
    return member.tooth.side(flank).tool.tip_radius


#: item, unit ("" for the design's), key of the design
_SETTING_KEYS = (
    ("blade angle", "deg", "blade_angle"),
    ("blade radius (0 = straight)", "", "blade_radius"),
    ("blade angle holds at height", "", "blade_height"),
    ("tip radius", "", "tip_radius"),
    ("edge radius", "", "edge_radius"),
    ("radial", "", "radial"),
    ("cradle angle", "deg", "cradle_angle"),
    ("ratio of roll (cradle/blank)", "-", "ratio_of_roll"),
    ("machining offset", "", "machining_offset"),
    ("machine centre to back, along root line", "", "machine_centre_to_back"),
    ("sliding base", "", "sliding_base"),
    ("machine root angle", "deg", "machine_root_angle"),
)
#: keys whose values are angles
_ANGLE_KEYS = ("blade_angle", "cradle_angle", "machine_root_angle", "tilt", "swivel")


#: settings that not every machine and blade has, shown if one side has them
_OPTIONAL_SETTING_KEYS = (
    ("tilt", "deg", "tilt"),
    ("swivel", "deg", "swivel"),
    ("toprem height", "", "toprem.height"),
    ("toprem angle", "deg", "toprem.angle"),
    ("toprem radius (0 = straight)", "", "toprem.radius"),
)
#: item, unit of the coefficients ("" for the design's), setting, and power of the first coefficient
_POLYNOMIAL_SETTINGS = (
    ("modified roll c", "-", "modified_roll", 2),
    ("helical motion a", "", "helical_motion", 1),
    ("vertical motion a", "", "vertical_motion", 1),
    ("radial motion a", "", "radial_motion", 1),
    ("tilt motion a", "deg", "tilt_motion", 1),
    ("swivel motion a", "deg", "swivel_motion", 1),
)


def _setting_rows(
    items: tuple[tuple[str, str, str], ...], sides: list[Generated], unit: float, units: str
) -> tuple[tuple[Any, ...], ...]:
    """Return the rows of settings; values are lengths over `unit` (mm), angles in deg."""
    return tuple(
        (item, noun or units, *(_value(side, key, 1.0 if noun else unit) for side in sides))
        for item, noun, key in items
    )


def _extra_rows(sides: list[Generated], unit: float, units: str) -> Iterator[tuple[Any, ...]]:
    """Return the rows of tilt, toprem and motions that at least one side has."""
    for row in _setting_rows(_OPTIONAL_SETTING_KEYS, sides, unit, units):
        if any(row[2:]):
            yield row
    for item, noun, key, first in _POLYNOMIAL_SETTINGS:
        polynomials = [getattr(side.settings, key) for side in sides]
        scale = {"deg": np.pi / 180.0, "-": 1.0, "": unit}[noun]
        for power in range(max(map(len, polynomials))):
            values = [
                float(polynomial[power] / scale) if power < len(polynomial) else 0.0 for polynomial in polynomials
            ]
            if any(values):
                yield f"{item}{power + first}", f"{noun or units}/rad^{power + first}" if noun != "-" else "-", *values


def slot_rows(widths: list[Array], unit: float, units: str) -> Iterator[tuple[Any, ...]]:
    """Return the rows of slot widths, a column per member."""
    for k, place in enumerate(("toe", "mean", "heel")):
        yield f"slot width at the root, {place}", units, *(float(width[k] / unit) for width in widths)


def _value(side: Generated, key: str, unit: float) -> float:
    """Return the value of a key of the design for a side: an angle in deg, or a length or number over `unit`."""
    if key.startswith("toprem."):
        measure = getattr(side.blade.toprem, key.removeprefix("toprem."), 0.0)
        return float(np.degrees(measure)) if key == "toprem.angle" else float(measure) / unit
    source = {"blade_height": "height"}.get(key, key)
    value = getattr(side.blade if hasattr(side.blade, source) else side.settings, source)
    return float(np.degrees(value)) if key in _ANGLE_KEYS else float(value) / unit


def _with_thicknesses(cut: CutPair) -> tuple[MemberBlank, ...]:
    """Return the members' blanks with the thicknesses of the teeth as cut."""
    return tuple(
        replace(member, thickness=thickness)
        for member, thickness in zip(cut.blank.members, cut.thicknesses, strict=True)
    )


def member_rows(members: tuple[MemberBlank, ...], unit: float, noun: str) -> tuple[tuple[Any, ...], ...]:
    """Return the rows of the table "Blank", one column per member; lengths over `unit` (mm) in `noun`."""

    def row(item: str, kind: str, pick: Callable[[MemberBlank], float]) -> tuple[Any, ...]:
        """Return one row; `pick` returns the value of a member."""
        scale = {"deg": np.pi / 180.0, "": unit, "-": 1.0}[kind]
        return (
            item,
            kind or noun,
            *(pick(member) if kind == "-" else float(pick(member) / scale) for member in members),
        )

    def tip(member: MemberBlank) -> float:
        """Return rho (mm) of the tip on the back cone."""
        back = member.outer_cone_distance * np.sin(member.pitch_angle)
        return float(back + member.outer_addendum * np.cos(member.pitch_angle))

    return (
        row("teeth", "-", lambda m: m.teeth),
        row("pitch angle", "deg", lambda m: m.pitch_angle),
        row("face angle", "deg", lambda m: m.face_angle),
        row("root angle", "deg", lambda m: m.root_angle),
        row("outer pitch diameter", "", lambda m: 2.0 * m.outer_cone_distance * np.sin(m.pitch_angle)),
        row("outer tip diameter", "", lambda m: 2.0 * tip(m)),
        row("apex to crown", "", lambda m: m.crown(m.outer_cone_distance)),
        row("face apex beyond pitch apex", "", lambda m: m.tip_radius / np.tan(m.face_angle) - m.pitch_apex),
        row("mean addendum", "", lambda m: m.mean_addendum),
        row("mean dedendum", "", lambda m: m.mean_dedendum),
        row("outer addendum", "", lambda m: m.outer_addendum),
        row("outer dedendum", "", lambda m: m.outer_dedendum),
        row("mean normal thickness", "", lambda m: m.thickness),
    )


def pair_rows_of(blank: BevelBlank, unit: float, noun: str) -> tuple[tuple[Any, ...], ...]:
    """Return the rows of the table "Pair"; lengths over `unit` (mm) in `noun`."""
    gear = blank.gear
    lengths = [
        ("outer cone distance", gear.outer_cone_distance),
        ("mean cone distance", gear.mean_cone_distance),
        ("inner cone distance", gear.inner_cone_distance),
        ("face width", gear.face_width),
        ("mean normal module", blank.mean_normal_module),
        ("mean working depth", blank.mean_working_depth),
        ("clearance", blank.clearance),
    ]
    angles = [
        ("shaft angle", blank.shaft_angle),
        ("mean spiral angle", gear.spiral_angle),
        ("outer spiral angle", gear.end_spiral_angles[0]),
        ("inner spiral angle", gear.end_spiral_angles[1]),
    ]
    return (
        *((item, noun, float(value / unit)) for item, value in lengths),
        *((item, "deg", float(np.degrees(value))) for item, value in angles),
    )


#: decimals of values in um
UM_DECIMALS = 2


def form_tables(design: FaceMilledDesign, forms: dict[str, FlankForm]) -> Iterator[SheetTable]:
    """Return the requested and reached ease-off, and the residual topography of each side, um."""
    if not forms:
        return
    rows: dict[str, list[float | None]] = {}
    for name, form in forms.items():
        target = design.ease_off(name)
        for key, value in form.parameters.items():
            rows.setdefault(key, []).extend((_um(1e3 * getattr(target, key)), _um(1e3 * value)))
        figures = form_figures(form)
        rows.setdefault("residual_max", []).extend((None, _um(figures.ease_off_residual_max)))
        rows.setdefault("residual_rms", []).extend((None, _um(figures.ease_off_residual_rms)))
    heads = tuple(f"{name} {what}" for name in forms for what in ("asked", "reached"))
    yield SheetTable("Ease-off", heads, tuple((key, "um", *values) for key, values in rows.items()))
    for name, form in forms.items():
        # rows from the pinion's tip downwards
        x, y, um = (grid[:, ::-2] for grid in (form.along, form.up, 1e3 * form.residual))
        row_numbers = np.flatnonzero(np.isfinite(um).any(axis=0))
        yield SheetTable(
            f"Residual topography of pinion {name}, toe (-1) to heel (1), gear's tip (-1) to pinion's tip (1)",
            tuple(f"{value:.4g}" for value in x[:, 0]),
            tuple((f"{y[0, k]:.2f}", "um", *map(_um, um[:, k])) for k in row_numbers),
        )


def _um(value: float) -> float | None:
    """Return a value (um) as it is reported, or None."""
    return round(float(value), UM_DECIMALS) + 0.0 if np.isfinite(value) else None
