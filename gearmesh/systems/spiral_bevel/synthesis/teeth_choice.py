"""The teeth of a design, where it leaves their contact open: what is chosen, or what plainer can be made.

The one place that decides: whoever asks for the blank, the contact, the settings or the members of a design asks here.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import TYPE_CHECKING

from gearmesh.design.keys import DERIVED
from gearmesh.errors import DesignError, NoSolutionError, VagueError
from gearmesh.progress import in_turn
from gearmesh.systems.spiral_bevel.blank.proportion_choice import (
    FACTOR_KEYS,
    ToothFaults,
    chosen_proportions,
    factors,
    open_factors,
)
from gearmesh.systems.spiral_bevel.machine.cutting import Choices, cut_pinion, cut_sides, pinion_places
from gearmesh.systems.spiral_bevel.machine.pair import (
    BLADE_SIDES,
    Angles,
    CutMember,
    CutSides,
    Sides,
    beside_space,
    cut_member,
    member_of,
)
from gearmesh.systems.spiral_bevel.synthesis.contact_choice import chooses, contact_choice, contact_said
from gearmesh.systems.spiral_bevel.synthesis.settings import basic_blank, gear_sides, proportions
from gearmesh.teeth.limits import crossing, undercut_margin

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.blank.blank import BevelBlank, Proportions
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign
    from gearmesh.teeth.tooth import Tooth

#: keys on which no tooth depends
ASIDE = ("assembly.", "contact.side", "contact.phi1.", "contact.delta", "fe.", "mesh.", "material.", "name")
#: the key that geometry itself gives where it is left open
BASE = "sliding_base"
#: what teeth are without a fault
WHOLE = ToothFaults()
#: parts of their depth that teeth get which are whole but for the contact that is chosen
SHALLOWER = (0.95, 0.9, 0.85)
#: margin of undercut from which on no contact that is chosen is taken to undercut a pinion
NEAR_UNDERCUT = 0.2
#: top land (mean normal modules) that a pinion keeps when its addendum grows
LAND = 0.2
#: designs whose teeth are remembered
REMEMBERED = 64


@dataclass(frozen=True)
class BevelTeeth:
    """What is made of a design: the proportions of its teeth, the contact that is asked of the pinion's sides, how they are `cut`,
    and the members."""

    proportions: Proportions
    choices: Choices
    cut: CutSides
    pinion: CutMember
    gear: CutMember


def bevel_teeth(design: FaceMilledDesign) -> BevelTeeth:
    """The teeth of a design in mm, with the contact that is best, or where no teeth with that close, with the plain one.

    Raises DesignError for blanks and teeth that cannot exist, before any contact has been looked for, NoSolutionError where no
    pinion gives the contact asked for.
    """
    return _best_teeth(_key(design))


def closing_teeth(design: FaceMilledDesign) -> BevelTeeth:
    """Teeth of a design in mm, with nothing of the contact chosen.

    Raises as `bevel_teeth` does, and where a contact would have to be chosen for there to be any.
    """
    plain = _plain(_key(design))
    if plain.teeth is None:
        raise plain.unsolved or NoSolutionError(reason="no pinion gives the default contact")
    return plain.teeth


@dataclass(frozen=True)
class CutAlone:
    """A member that is made without the other: the pair's blank, its own sides as they are cut, how far (rad) each is turned to
    stand in its tooth on +x, and the member."""

    blank: BevelBlank
    sides: Sides
    places: Angles
    cut: CutMember


def gear_alone(design: FaceMilledDesign) -> CutAlone:
    """The gear of a design in mm, for which the pinion is only looked at as far as the depth of the teeth is open.

    Raises as `bevel_teeth` does.
    """
    if not open_factors(design):
        blank = basic_blank(design, proportions(design))
        sides = gear_sides(design, blank)
        places = beside_space(sides, blank.gear.teeth)
        return CutAlone(blank, sides, places, member_of(design, blank, "gear", sides, places))
    key = _key(design)
    first = _plain(key)
    if first.teeth is not None and not _may_become_shallower(design, first):
        made = first.teeth
        return CutAlone(first.blank, made.cut.gear, made.cut.places[1], made.gear)
    made = _best_teeth(key)
    return CutAlone(made.cut.blank, made.cut.gear, made.cut.places[1], made.gear)


def pinion_alone(design: FaceMilledDesign) -> CutAlone:
    """The pinion of a design in mm; where nothing is chosen of it, the gear's flanks alone are asked for its index.

    Raises as `bevel_teeth` does.
    """
    if open_factors(design) or any(chooses(design, name) for name in BLADE_SIDES):
        made = bevel_teeth(design)
        return CutAlone(made.cut.blank, made.cut.pinion, made.cut.places[0], made.pinion)
    blank = basic_blank(design, proportions(design))
    choices = {name: contact_said(design, blank, name) for name in BLADE_SIDES}
    sides, turns = cut_pinion(design, blank, choices, gear_sides(design, blank))
    places = pinion_places(design, blank, sides, turns)
    return CutAlone(blank, sides, places, member_of(design, blank, "pinion", sides, places))


@dataclass(frozen=True)
class _Remembered:
    """A design by all that its teeth depend on; of designs that are equal one may set what the other leaves to its default."""

    text: str
    design: FaceMilledDesign = field(compare=False)

    @classmethod
    def of(cls, design: FaceMilledDesign) -> _Remembered:
        own = [(key, value) for key, value in design.own() if not key.startswith(ASIDE) and not key.endswith(BASE)]
        cutters = design.pinion.concave, design.pinion.convex, design.gear.cutter
        derived = [(cutter.sliding_base, cutter.tilt, cutter.swivel, cutter.tip_radius) for cutter in cutters]
        return cls(repr((type(design), own, derived, design.contact.delta)), design)

    @property
    def stated_design(self) -> _Remembered:
        """The design before sliding bases were derived of its geometry, which the search for a contact is to find."""
        design = self.design
        pinion = {
            name: design.pinion.side(name).model_copy(update={BASE: DERIVED})
            for name in BLADE_SIDES
            if not design.sets(f"pinion.{name}.{BASE}")
        }
        opened: dict[str, object] = {"pinion": design.pinion.model_copy(update=pinion)}
        if not design.sets(f"gear.cutter.{BASE}"):
            cutter = design.gear.cutter.model_copy(update={BASE: DERIVED})
            opened["gear"] = design.gear.model_copy(update={"cutter": cutter})
        return _Remembered.of(design.model_copy(update=opened).fill({}))


def _key(design: FaceMilledDesign) -> _Remembered:
    """The design by which its teeth are chosen: as it is stated, so that derived sliding bases are those of the proportions that
    are chosen; but where machine settings are given, as a sheet has them, derived sliding bases stay with them."""
    key = _Remembered.of(design)
    cutters = design.pinion.concave, design.pinion.convex, design.gear.cutter
    return key if any(cutter.radial is not None for cutter in cutters) else key.stated_design


@dataclass(frozen=True)
class _Plain:
    """The blank of `given` proportions, the teeth with the contact that the design says, None where no pinion gives that
    (`unsolved`) or they are refused (`refusal`); `faults`: what is wrong with the teeth."""

    given: Proportions
    blank: BevelBlank
    teeth: BevelTeeth | None = None
    refusal: VagueError | None = None
    unsolved: NoSolutionError | None = None
    faults: ToothFaults = WHOLE


@lru_cache(maxsize=REMEMBERED)
def _plain(key: _Remembered) -> _Plain:
    """With the proportions that are best. Raises DesignError for blanks and teeth that cannot exist."""
    design = key.design
    given = proportions(design)
    teeth_by_proportions = {given: _with_proportions(design, given, first=True)}

    def faults_of(asked: Proportions) -> ToothFaults:
        teeth_by_proportions[asked] = _with_proportions(design, asked)
        return teeth_by_proportions[asked].faults

    first = teeth_by_proportions[given]
    chosen = chosen_proportions(design, first.blank, first.faults, faults_of)
    best = teeth_by_proportions[chosen]
    if best.refusal is not None:
        raise best.refusal
    return best if chosen == given else _saying(first, best)


def _with_proportions(design: FaceMilledDesign, given: Proportions, *, first: bool = False) -> _Plain:
    """The teeth of given proportions. Raises DesignError for blanks that cannot exist.

    Of the `first` that are tried the land is not looked at where nothing is undercut: they are taken.
    """
    blank = basic_blank(design, given)
    try:
        teeth = _make(design, (given, blank), {name: contact_said(design, blank, name) for name in BLADE_SIDES})
    except NoSolutionError as failure:
        return _Plain(given, blank, unsolved=failure)
    except VagueError as refusal:
        return _Plain(given, blank, refusal=refusal, faults=ToothFaults(refused=True))
    undercut = _undercut(teeth)
    taken = first and not any(undercut)
    thin = not taken and _land(teeth.pinion.member.tooth) < LAND * blank.mean_normal_module
    return _Plain(given, blank, teeth, faults=ToothFaults(undercut, thin))


def _undercut(teeth: BevelTeeth) -> tuple[float, float]:
    """How much (mm) undercut takes from (pinion, gear), at most."""
    first, second = (max(member.lost.values(), default=0.0) for member in (teeth.pinion, teeth.gear))
    return first, second


def _land(tooth: Tooth) -> float:
    """The thinnest top land (mm)."""
    sections = tooth.even
    radius = crossing(tooth.blank.tip, tooth.blank.axial, sections.stations)[0]
    return float((radius * (sections.left.tip_angle - sections.right.tip_angle)).min())


def _saying(first: _Plain, best: _Plain) -> _Plain:
    """The `best` teeth, whose blank says which factors they have instead of those that the `first` ones had, and why."""
    old, new = (factors(plain.given, plain.blank) for plain in (first, best))
    changed = [k for k in range(2) if new[k] != old[k]]
    said, instead = (" and ".join(f"{FACTOR_KEYS[k]} = {pair[k]:.4g}" for k in changed) for pair in (new, old))
    why = f"{first.refusal.key}: {first.refusal.reason}" if first.refusal else "teeth would be undercut"
    blank = replace(
        best.blank, warnings=(*best.blank.warnings, f"{said}: the default, instead of {instead}; with that {why}")
    )
    teeth = None if best.teeth is None else replace(best.teeth, cut=replace(best.teeth.cut, blank=blank))
    return replace(best, blank=blank, teeth=teeth)


@lru_cache(maxsize=REMEMBERED)
def _search(key: _Remembered, blank: BevelBlank) -> Choices:
    return {name: contact_choice(key.design, blank, name) for name in in_turn(BLADE_SIDES)}


@lru_cache(maxsize=REMEMBERED)
def _best_teeth(key: _Remembered) -> BevelTeeth:
    """With the proportions of the plain teeth; shallower where those are whole and the contact that is chosen undercuts them."""
    design, first = key.design, _plain(key)
    if first.teeth is not None and not any(chooses(design, name) for name in BLADE_SIDES):
        return first.teeth
    best = _with_contact(key, first)
    if not _may_become_shallower(design, first):
        return best
    for part in SHALLOWER:
        if not any(_undercut(best)):
            break
        depth, share = factors(first.given, first.blank)
        less = _with_proportions(design, replace(first.given, depth_factor=part * depth, addendum_factor=share))
        if less.teeth is None or any(less.faults.undercut):
            break
        shallower = _with_contact(key, _saying(_with_proportions(design, proportions(design)), less))
        best = shallower if sum(_undercut(shallower)) < sum(_undercut(best)) else best
    return best


def _may_become_shallower(design: FaceMilledDesign, first: _Plain) -> bool:
    """Whether the contact that is chosen may undercut the pinion of teeth that are whole without, and their depth is free."""
    if first.teeth is None or any(first.faults.undercut) or "depth_factor" not in open_factors(design):
        return False
    return undercut_margin(first.teeth.pinion.member.tooth) < NEAR_UNDERCUT


def _with_contact(key: _Remembered, first: _Plain) -> BevelTeeth:
    """The teeth with the contact that is chosen, or the plain ones."""
    plain = first.teeth
    try:
        choices = _search(key.stated_design, first.blank)
        return _make(key.design, (first.given, first.blank), choices, None if plain is None else plain.gear)
    except (DesignError, NoSolutionError):
        # a blank that has room for the one contact may have none for the other
        if plain is None:
            raise
        return plain


def _make(
    design: FaceMilledDesign, basis: tuple[Proportions, BevelBlank], choices: Choices, gear: CutMember | None = None
) -> BevelTeeth:
    """The teeth of some proportions and their blank with a contact, on which the gear does not depend; that first: what is wrong
    with it would show on the pinion."""
    given, blank = basis
    cut = cut_sides(design, blank, choices)
    gear = cut_member(design, cut, "gear") if gear is None else gear
    return BevelTeeth(given, choices, cut, cut_member(design, cut, "pinion"), gear)
