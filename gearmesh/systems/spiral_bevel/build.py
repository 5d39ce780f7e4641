"""Construction of spiral, zerol and straight bevel gears cut by head cutters [AB; CR3553; ISO 23509]."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.spiral_bevel.blank.proportion_choice import open_factors
from gearmesh.systems.spiral_bevel.hobbing.head import larger_radii
from gearmesh.systems.spiral_bevel.hobbing.secondary_cut import HeadRoom, refuse_second_pass, slots_are_wide
from gearmesh.systems.spiral_bevel.machine.gear_cradle import upright_cutter
from gearmesh.systems.spiral_bevel.machine.pair import (
    BLADE_SIDES,
    MATING_SIDES,
    Angles,
    Sides,
    bevel_pair,
    undercut_warnings,
)
from gearmesh.systems.spiral_bevel.synthesis.flank_form import form_figures, form_warnings
from gearmesh.systems.spiral_bevel.synthesis.settings import (
    basic_blank,
    gear_sides,
    longer_than_standard,
    pinion_root_angle,
)
from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import bevel_teeth, closing_teeth, gear_alone, pinion_alone
from gearmesh.systems.system import ToolPart
from gearmesh.teeth.gear_train import GearTrain, Member

if TYPE_CHECKING:
    from gearmesh.systems.common.bevel.blank import BevelBlank, MemberBlank
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign
    from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import BevelTeeth, CutAlone


#: key of the radius of the gear's cutter, which determines how straight the teeth are
STRAIGHT_KEY = "gear.cutter.tip_radius"
#: key of the radius of the head of face hobbing
HEAD_KEY = "head.radius"
#: largest cutter radius that is tried, in mean cone distances
MAX_RADIUS_SHARE = 100.0
#: largest tilt (deg) of a cutter, that of the key
MAX_TILT_DEG = 60.0
#: number of halvings of the range of possible radii
RADIUS_HALVINGS = 12
#: share of the largest possible radius that is used: at the limit the chosen contact may have no pinion
KEPT_RADIUS_SHARE = 0.99


def build(design: FaceMilledDesign) -> GearTrain:
    """Return the pair of a spiral bevel design (in mm).

    Raises DesignError for blanks and teeth that cannot exist, and NoSolutionError if no pinion has the requested
    contact.
    """
    teeth = bevel_teeth(design)
    train = bevel_pair(design, teeth.cut, teeth.pinion, teeth.gear)
    head = [line for made in _members(teeth) for line in _head_warnings(design, teeth.cut.blank, *made)]
    forms = {name: choice.form for name, choice in teeth.choices.items()}
    form = forms[design.contact.pinion_side]
    figures = None if form is None else form_figures(form)
    return replace(
        train,
        pairs=tuple(replace(pair, figures=figures) for pair in train.pairs),
        warnings=(
            *train.warnings,
            *head,
            *form_warnings(design, forms),
            *longer_than_standard(design, teeth.cut.blank),
        ),
    )


def try_build(design: FaceMilledDesign) -> BevelTeeth:
    """Return teeth of a design in mm without a choice of the contact.

    Raises as `build`, and also if teeth exist only with a chosen contact.
    """
    made = closing_teeth(_leant(design))
    for member, sides, _ in _members(made) if design.hobbed else ():
        refuse_second_pass(member.name, sides, _blank_of(made.cut.blank, member))
    return made


def gear_part(design: FaceMilledDesign) -> ToolPart:
    """Return the gear of a design in mm; of the pinion only the data on which the gear depends are computed.

    Raises as `build`.
    """
    return _part(design, cut_alone(design, "gear"))


def pinion_part(design: FaceMilledDesign) -> ToolPart:
    """Return the pinion of a design in mm; the gear need not fit it. Raises as `build`."""
    return _part(design, cut_alone(design, "pinion"))


def cut_alone(design: FaceMilledDesign, name: str) -> CutAlone:
    """Return the member "pinion" or "gear" of a design in mm.

    Of the other member only the data on which it depends are computed. Raises as `build`.
    """
    radius = _straightest_radius(design)
    design = design.fill(radius) if radius else design
    if name == "pinion":
        return pinion_alone(_leant(design))
    return gear_alone(_leant(design) if open_factors(design) else design)


def _part(design: FaceMilledDesign, made: CutAlone) -> ToolPart:
    """Return a member with its warnings."""
    own = (
        *made.blank.warnings,
        *undercut_warnings(made.cut, made.blank),
        *_head_warnings(design, made.blank, made.cut.member, made.sides, made.places),
    )
    return ToolPart(made.cut.member, warnings=own)


def _members(teeth: BevelTeeth) -> tuple[tuple[Member, Sides, Angles], ...]:
    """Return both members, each with its sides and their index positions (rad)."""
    cut = teeth.cut
    return (teeth.gear.member, cut.gear, cut.places[1]), (teeth.pinion.member, cut.pinion, cut.places[0])


def _blank_of(blank: BevelBlank, member: Member) -> MemberBlank:
    """Return the blank of a member of a pair."""
    return blank.pinion if member.name == "pinion" else blank.gear


def _head_warnings(
    design: FaceMilledDesign, blank: BevelBlank, member: Member, sides: Sides, places: Angles
) -> tuple[str, ...]:
    """Return the warnings on secondary cuts of a face-hobbed member. Raises VagueError for a head too small to clear it."""
    if not design.hobbed:
        return ()
    refuse_second_pass(member.name, sides, _blank_of(blank, member))
    if design.one_crown_gear and slots_are_wide(member.tooth):
        return ()
    return HeadRoom.of(member, sides, places).warnings


def _leant(design: FaceMilledDesign) -> FaceMilledDesign:
    """Return the design with tilt and swivel where it leaves them out."""
    leaning = _leaning(design)
    return design.fill(leaning) if leaning else design


def left_to_geometry(design: FaceMilledDesign) -> dict[str, float]:
    """Return settings that follow from the geometry, in the design's units, by dotted key.

    They are the radius of the straightest teeth or of a larger head, tilt and swivel for a gear that is not generated, and
    sliding bases of tilted cutters and of pairs with offset.

    One crown gear leaves none. Raises DesignError and NoSolutionError as `build`.
    """
    if design.one_crown_gear:
        return {}
    radius = _straightest_radius(design) or _larger_head(design)
    design = design.fill(radius) if radius else design
    leaning = _leaning(design)
    return {**radius, **leaning, **_sliding_bases(design.fill(leaning) if leaning else design)}


def _straightest_radius(design: FaceMilledDesign) -> dict[str, float]:
    """Return the largest possible radius of the gear's cutter for a design with `straightest`, by dotted key.

    The result is empty if the radius is given. Raises as `build` if even a cutter as large as the mean cone distance is
    impossible.
    """
    cutter = design.gear.cutter
    if not cutter.straightest or cutter.tip_radius is not None:
        return {}

    def with_radius(radius: float) -> FaceMilledDesign:
        return design.fill({STRAIGHT_KEY: radius})

    def works(logarithms: Array, _: NDArray[np.intp]) -> NDArray[np.bool_]:
        return np.array([_is_made(with_radius(float(radius))) for radius in np.exp(logarithms)])

    least = basic_blank(design.in_mm()).gear.mean_cone_distance / design.mm_per_unit
    try_build(with_radius(least).in_mm())
    most = MAX_RADIUS_SHARE * least
    if _is_made(with_radius(most)):
        return {STRAIGHT_KEY: float(at_most(most))}
    # bisection over the logarithm of the radius
    low, _ = last_true(works, np.log([least]), np.log([most]), rounds=RADIUS_HALVINGS)
    return {STRAIGHT_KEY: float(at_most(max(least, KEPT_RADIUS_SHARE * float(np.exp(low[0])))))}


def _larger_head(design: FaceMilledDesign) -> dict[str, float]:
    """Return the radius of a larger head than the usual one where that cannot cut a hypoid pair, by dotted key.

    The gear is generated. The result is empty if the radius is given, the usual head cuts the pair, or no larger one does.
    """
    if not design.hobbed or design.formate or design.head.radius is not None or design.one_crown_gear:
        return {}
    try:
        _refuse_cut_twice(design)
    except NoSolutionError:
        return {}
    except DesignError:
        blank = basic_blank(design.in_mm())
        for radius in larger_radii(blank.cutter_radius, blank.gear.mean_cone_distance):
            key = {HEAD_KEY: float(at_least(radius / design.mm_per_unit))}
            try:
                _refuse_cut_twice(design.fill(key))
            except (DesignError, NoSolutionError):
                continue
            return key
    return {}


def _refuse_cut_twice(design: FaceMilledDesign) -> None:
    """Raise as `build` for a face-hobbed design with the chosen contact."""
    made = bevel_teeth(design.in_mm())
    for member, sides, _ in _members(made):
        refuse_second_pass(member.name, sides, _blank_of(made.cut.blank, member))


def _is_made(design: FaceMilledDesign) -> bool:
    """Return True if a design can be built."""
    try:
        try_build(design.in_mm())
    except (DesignError, NoSolutionError):
        return False
    return True


def _leaning(design: FaceMilledDesign) -> dict[str, float]:
    """Return tilt and swivel (deg) that are left out, by dotted key."""
    design_mm, angles = design.in_mm(), dict[str, float]()
    for name in BLADE_SIDES:
        if design_mm.leans(name):
            blank, angle = basic_blank(design_mm), float(np.radians(pinion_root_angle(design_mm, name) or 0.0))
            leant = upright_cutter(design_mm, blank, gear_sides(design_mm, blank)[MATING_SIDES[name]], angle)
            _refuse_leaning(design, float(np.degrees(leant[0])))
            angles |= {
                f"pinion.{name}.{key}": float(np.degrees(x)) for key, x in zip(("tilt", "swivel"), leant, strict=True)
            }
    return angles


def _refuse_leaning(design: FaceMilledDesign, tilt: float) -> None:
    """Raise DesignError for a gear that is not generated, if its pinion's cutters would have to be tilted too far.

    `tilt`: tilt of the pinion's cutters, deg.
    """
    if tilt > MAX_TILT_DEG:
        raise DesignError(
            "process",
            design.process,
            shown=f'"{design.process}"',
            reason=f"the pinion's cutters would be tilted by {tilt:.3g} deg to be upright on its root line",
            allowed=f"up to {MAX_TILT_DEG:.3g} deg: fewer teeth of the pinion, or a process that generates the gear",
        )


def _sliding_bases(design: FaceMilledDesign) -> dict[str, float]:
    """Return the sliding bases that are left out, in the design's units, by dotted key."""
    members = design.pinion.concave, design.pinion.convex, design.gear.cutter
    # the head that cuts the gear has no settings of its own
    open_bases = [np.isnan(spec.sliding_base) and not (design.hobbed and spec is members[2]) for spec in members]
    if not any(open_bases):
        return {}
    cut = bevel_teeth(design.in_mm()).cut
    sides = {"gear.cutter": cut.gear["concave"], **{f"pinion.{name}": cut.pinion[name] for name in BLADE_SIDES}}
    keys = ("pinion.concave", "pinion.convex", "gear.cutter")
    return {
        f"{key}.sliding_base": sides[key].settings.sliding_base / design.mm_per_unit
        for key, left_open in zip(keys, open_bases, strict=True)
        if left_open
    }
