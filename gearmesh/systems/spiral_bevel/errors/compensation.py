"""Machine settings that restore the contact of a misassembled pair [AB; CR3553 3.5].

Local synthesis is repeated with the gear in its misaligned position. Path, ellipse and parabola of the aligned pair are
restored at the same point of the gear, and index angles keep the backlash.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.contact.flanks import analyse, touching_jets
from gearmesh.design.keys import DERIVED_VALUE
from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Z_AXIS
from gearmesh.kernel.surface.curvature import shape_operator, tangent_basis
from gearmesh.kernel.surface.surface import Jet
from gearmesh.systems.spiral_bevel.build import build
from gearmesh.systems.spiral_bevel.design import SYNTHESISED_KEYS
from gearmesh.systems.spiral_bevel.hobbing.head import refuse_hobbing
from gearmesh.systems.spiral_bevel.machine.cutting import indexed_backlash, pinion_places
from gearmesh.systems.spiral_bevel.machine.pair import (
    BLADE_SIDES,
    HAND_SIGNS,
    Angles,
    CutSides,
    Sides,
    displaced_frames,
    without_errors,
)
from gearmesh.systems.spiral_bevel.machine.thickness import mean_thickness
from gearmesh.systems.spiral_bevel.synthesis.local_synthesis import MeanContact, contact_of
from gearmesh.systems.spiral_bevel.synthesis.settings import (
    ContactChoice,
    contact_at,
    mean_contact,
    pinion_values,
    roll_of,
    side_of,
    synthesise,
)
from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import bevel_teeth
from gearmesh.systems.system import Setting

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign, PinionSide
    from gearmesh.systems.spiral_bevel.machine.generated import Generated


def compensate(design: FaceMilledDesign) -> list[Setting]:
    """Return the settings of both sides of the pinion for the gear in its misaligned position.

    Raises NoSolutionError if no setting restores the contact, and DesignError for the contact of an ease-off and for pairs
    by one crown gear.
    """
    if design.one_crown_gear:
        refuse_hobbing(design, "compensation changes machines by local synthesis, not those of one crown gear")
    for name in BLADE_SIDES:
        if design.ease_off(name) is not None:
            raise DesignError(
                design.ease_off_key(name),
                reason="compensation is for contact given by its values at the mean point",
                allowed="a design with settings, as gearmesh settings writes it",
            )
    design_mm = design.in_mm()
    teeth = bevel_teeth(design_mm)
    blank = teeth.cut.blank
    pinion_frame, gear_frame = displaced_frames(design_mm, blank)
    unit = design.mm_per_unit
    rows: list[Setting] = []
    turns: Angles = {}
    made: Sides = {}
    for name in BLADE_SIDES:
        # contact of the aligned pair at phi1 = 0
        (gears,) = build(design.with_values({**without_errors(design), "contact.side": f"pinion_{name}"}).in_mm()).pairs
        path = analyse(gears, np.zeros(1))
        if path.kind[0] != "point":
            raise NoSolutionError(
                reason=f"the aligned pair does not touch at the mean point of pinion.{name}",
                remedy="check its settings",
            )
        pinion, gear = (_single(jet) for jet in touching_jets(gears, path))
        base = gears.gear.mount.base
        # its path, ellipse and parabola are the requested contact of the new synthesis
        nominal = _as_it_touches(gear, base, HAND_SIGNS[design_mm.hand], blank.gear.pitch_apex)
        e1, e2 = tangent_basis(pinion)
        basis = np.stack((e1, e2))
        asked = contact_of(basis.T @ shape_operator(pinion, e1, e2) @ basis, nominal, design_mm.contact.delta)
        # small further turn of the gear, from contact with the aligned pinion, to contact in the misaligned position
        further_turn, displaced = mean_contact(
            gear.move(base.inverse), pinion_frame.inverse @ gear_frame, HAND_SIGNS[design_mm.hand], blank
        )
        turns[name] = teeth.cut.turns[name] + gears.gear.mount.sign * float(path.phi2[0]) + further_turn
        # values chosen for the aligned pair remain; the synthesis determines the others anew
        spec, choice = design_mm.pinion.side(name), teeth.choices[name]
        second_roll = choice.second_roll(blank.pinion.teeth / blank.gear.teeth)
        kept = _chosen_values(spec, choice, second_roll)
        before = {**pinion_values(design_mm, blank, name, nominal, choice), **kept}
        free = _base_free(design_mm, design, name)
        values = synthesise(free, blank, name, displaced, asked, second_roll)
        after = {**values, **kept}
        made[name] = side_of(free, blank, name, values, roll_of(spec, choice, blank))
        for key in (
            *SYNTHESISED_KEYS,
            *(["blade_height"] if spec.blade_radius or design_mm.hobbed else []),
            *([] if spec.upright else ["sliding_base"]),
            *(["blade_radius"] if before["blade_radius"] != values["blade_radius"] else []),
            *kept,
        ):
            number = key == "ratio_of_roll" or key.startswith("modified_roll")
            length = not number and key not in ("cradle_angle", "blade_angle", "machine_root_angle")
            scale = unit if length else 1.0
            noun = "" if number else design.units if length else "deg"
            effect = f"path {np.degrees(asked.path_angle):.4g} deg, ellipse {2.0 * asked.semi_major_axis:.4g} mm long"
            rows.append(Setting(f"pinion.{name}.{key}", before[key] / scale, after[key] / scale, noun, effect))
    return rows if design_mm.completing else [*rows, *_index_rows(design, teeth.cut, made, turns)]


def _index_rows(design: FaceMilledDesign, cut: CutSides, made: Sides, turns: Angles) -> list[Setting]:
    """Return the index angles of the sides in `made`, or the thickness if the design gives it; both keep the backlash.

    `turns` (rad) is the rotation of the gear, as cut, to contact with each side in the misaligned position.
    """
    design_mm, unit = design.in_mm(), design.mm_per_unit
    free = {"pinion.thickness": None}
    free |= {f"pinion.{name}.{key}": None for name in BLADE_SIDES for key in ("index_angle", "mesh_angle")}
    open_index = design_mm.with_values(
        {**free, "backlash": indexed_backlash(cut) if design_mm.indexed else design_mm.backlash}
    )
    places = pinion_places(open_index, cut.blank, made, turns)
    if design_mm.pinion.thickness is not None:
        after_mm = mean_thickness(cut.blank.pinion, made, places)
        key, noun = "pinion.thickness", design.units
        return [Setting(key, design_mm.pinion.thickness / unit, after_mm / unit, noun, "backlash kept")]
    before, after = cut.index_angles, replace(cut, pinion=made, places=(places, cut.places[1])).index_angles
    meshing = [name for name in BLADE_SIDES if design_mm.pinion.side(name).mesh_angle is not None]
    return [
        *(
            Setting(
                f"pinion.{name}.index_angle",
                float(np.degrees(before[name])),
                float(np.degrees(after[name])),
                "deg",
                "backlash kept",
            )
            for name in BLADE_SIDES
        ),
        *(
            Setting(
                f"pinion.{name}.mesh_angle",
                _mesh_angle(cut.pinion[name]),
                _mesh_angle(made[name]),
                "deg",
                "phi1 = 0 at the mean point",
            )
            for name in meshing
        ),
    ]


def _mesh_angle(side: Generated) -> float:
    """Return the mesh angle (deg) of a side of the pinion."""
    return float(np.degrees(side.hand * side.turned))


def _chosen_values(spec: PinionSide, choice: ContactChoice, second_roll: float) -> dict[str, float]:
    """Return the values chosen for open keys of a side, which remain, by key.

    The keys are those of the mean point's place (mm), the modified roll, and the machine root angle (deg) of a tilted
    cutter. `second_roll`: chosen coefficient of modified roll of the second order.
    """
    chosen = {"mean_offset": choice.height, "mean_shift": choice.along}
    roll = (second_roll, *choice.roll)
    if any(roll):
        chosen |= {f"modified_roll_c{k}": getattr(spec, f"modified_roll_c{k}") + c for k, c in enumerate(roll, 2)}
    chosen = {key: value for key, value in chosen.items() if value != getattr(spec, key)}
    if not spec.upright and spec.machine_root_angle is not None:
        chosen["machine_root_angle"] = spec.machine_root_angle
    return chosen


def _base_free(own: FaceMilledDesign, design: FaceMilledDesign, name: str) -> FaceMilledDesign:
    """Return the design in mm with a derived sliding base of a tilted cutter, unless `design` sets it.

    `own`: the design in mm.
    """
    spec = own.pinion.side(name)
    if spec.upright or design.sets(f"pinion.{name}.sliding_base"):
        return own
    free = own.pinion.model_copy(update={name: spec.model_copy(update={"sliding_base": DERIVED_VALUE})})
    return own.model_copy(update={"pinion": free})


def _as_it_touches(gear: Jet, base: Rigid, sense: int, apex: float) -> MeanContact:
    """Return the gear's data at its actual contact with the ratio at that contact: n . v12 = 0."""
    axis, origin = base.rotation[:, 2], base.translation
    pinion_arm = gear.n @ np.cross(Z_AXIS, gear.r)
    gear_arm = gear.n @ np.cross(-axis, gear.r - origin)
    return contact_at(gear, base, sense, float(pinion_arm / gear_arm), apex)


def _single(jet: Jet) -> Jet:
    """Return the jet of the only point of a batch."""
    return Jet(*(getattr(jet, name)[0] for name in ("r", "n", "r_u", "r_v", "n_u", "n_v")))
