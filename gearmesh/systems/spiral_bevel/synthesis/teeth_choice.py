"""Teeth of a design that leaves their contact open: the chosen contact, or plainer teeth that can be made.

This is the only place of this choice: blank, contact, settings and members of a design all come from here.
"""

from __future__ import annotations

from dataclasses import field, replace
from functools import lru_cache
from typing import TYPE_CHECKING

from gearmesh.design.keys import DERIVED_VALUE
from gearmesh.errors import DesignError, NoSolutionError, VagueError
from gearmesh.progress import in_turn
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.pair_blank import proportions
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
    CutSides,
    Sides,
    beside_space,
    cut_member,
    member_of,
)
from gearmesh.systems.spiral_bevel.synthesis.contact_choice import chooses, contact_choice, contact_said
from gearmesh.systems.spiral_bevel.synthesis.settings import basic_blank, gear_sides
from gearmesh.teeth.limits import crossing, undercut_margin

if TYPE_CHECKING:
    from gearmesh.systems.common.bevel.blank import BevelBlank, Proportions
    from gearmesh.systems.common.bevel.member import CutMember
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign
    from gearmesh.teeth.tooth import Tooth

#: keys on which no tooth depends
KEYS_WITHOUT_EFFECT = (
    "assembly.",
    "contact.side",
    "contact.phi1.",
    "contact.delta",
    "fe.",
    "mesh.",
    "material.",
    "name",
)
#: key whose value follows from geometry if it is left out
BASE_KEY = "sliding_base"
#: faults of teeth without a fault
NO_FAULTS = ToothFaults()
#: shares of their depth given to teeth that only the chosen contact undercuts
SHALLOW_DEPTH_SHARES = (0.95, 0.9, 0.85)
#: margin of undercut from which on no chosen contact is expected to undercut a pinion
SAFE_UNDERCUT_MARGIN = 0.2
#: least top land (mean normal modules) of a pinion whose addendum grows
MIN_LAND_MODULES = 0.2
#: largest number of designs whose teeth are cached
MAX_CACHED_DESIGNS = 64


@dataclass(frozen=True)
class BevelTeeth:
    """Teeth of a design."""

    #: proportions of the teeth
    proportions: Proportions
    #: requested contact of the pinion's sides
    choices: Choices
    #: sides of both members as they are cut
    cut: CutSides
    #: the pinion
    pinion: CutMember
    #: the gear
    gear: CutMember


def bevel_teeth(design: FaceMilledDesign) -> BevelTeeth:
    """Teeth of a design in mm with the best contact, or with the plain contact if teeth with the best do not close.

    Raises DesignError for blanks and teeth that cannot exist, before any contact is sought, and NoSolutionError if no
    pinion has the requested contact.
    """
    return _best_teeth(_key(design))


def closing_teeth(design: FaceMilledDesign) -> BevelTeeth:
    """Return teeth of a design in mm with no contact chosen.

    Raises as `bevel_teeth`, and also if teeth exist only with a chosen contact.
    """
    plain = _plain(_key(design))
    if plain.teeth is None:
        raise plain.unsolved or NoSolutionError(reason="no pinion gives the default contact")
    return plain.teeth


@dataclass(frozen=True)
class CutAlone:
    """A member that is made without the other."""

    #: blank of the pair
    blank: BevelBlank
    #: sides of the member as they are cut
    sides: Sides
    #: index positions of the sides, rad: rotation from cutting a side to its position in the tooth on +x
    places: Angles
    #: the member
    cut: CutMember


def gear_alone(design: FaceMilledDesign) -> CutAlone:
    """Return the gear of a design in mm; the pinion is computed only if the depth of the teeth is open.

    Raises as `bevel_teeth`.
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
    """Return the pinion of a design in mm; if nothing is chosen, its index needs only the gear's flanks.

    Raises as `bevel_teeth`.
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
    """A design with a text of all values on which its teeth depend.

    Designs with equal texts are equal, even if one sets values that the other leaves to their defaults.
    """

    #: values on which the teeth depend
    text: str
    #: design in mm
    design: FaceMilledDesign = field(compare=False)

    @classmethod
    def of(cls, design: FaceMilledDesign) -> _Remembered:
        """Return a design with the text of its values."""
        values = [
            (key, value)
            for key, value in design.own()
            if not key.startswith(KEYS_WITHOUT_EFFECT) and not key.endswith(BASE_KEY)
        ]
        cutters = design.pinion.concave, design.pinion.convex, design.gear.cutter
        derived = [(cutter.sliding_base, cutter.tilt, cutter.swivel, cutter.tip_radius) for cutter in cutters]
        return cls(repr((type(design), values, derived, design.head.radius, design.contact.delta)), design)

    @property
    def stated_design(self) -> _Remembered:
        """The design before sliding bases were derived from its geometry.

        The search for a contact starts from this design.
        """
        design = self.design
        pinion = {
            name: design.pinion.side(name).model_copy(update={BASE_KEY: DERIVED_VALUE})
            for name in BLADE_SIDES
            if not design.sets(f"pinion.{name}.{BASE_KEY}")
        }
        opened: dict[str, object] = {"pinion": design.pinion.model_copy(update=pinion)}
        if not design.sets(f"gear.cutter.{BASE_KEY}"):
            cutter = design.gear.cutter.model_copy(update={BASE_KEY: DERIVED_VALUE})
            opened["gear"] = design.gear.model_copy(update={"cutter": cutter})
        return _Remembered.of(design.model_copy(update=opened).fill({}))


def _key(design: FaceMilledDesign) -> _Remembered:
    """Return the design by which its teeth are chosen.

    It is the stated design, so that derived sliding bases belong to the chosen proportions. If machine settings are
    given, as on a sheet, derived sliding bases remain with them.
    """
    key = _Remembered.of(design)
    cutters = design.pinion.concave, design.pinion.convex, design.gear.cutter
    return key if any(cutter.radial is not None for cutter in cutters) else key.stated_design


@dataclass(frozen=True)
class _Plain:
    """Teeth of given proportions with the contact that the design states."""

    #: proportions of the teeth
    given: Proportions
    #: blank of the pair
    blank: BevelBlank
    #: the teeth; None if there are none
    teeth: BevelTeeth | None = None
    #: refusal of the teeth, if they cannot be made
    refusal: VagueError | None = None
    #: error of a contact that no pinion has
    unsolved: NoSolutionError | None = None
    #: faults of the teeth
    faults: ToothFaults = NO_FAULTS


@lru_cache(maxsize=MAX_CACHED_DESIGNS)
def _plain(key: _Remembered) -> _Plain:
    """Return the teeth with the best proportions. Raises DesignError for blanks and teeth that cannot exist."""
    design = key.design
    given = proportions(design)
    teeth_by_proportions = {given: _with_proportions(design, given, first=True)}

    def faults_of(asked: Proportions) -> ToothFaults:
        """Return the faults of teeth with other proportions."""
        teeth_by_proportions[asked] = _with_proportions(design, asked)
        return teeth_by_proportions[asked].faults

    first = teeth_by_proportions[given]
    chosen = chosen_proportions(design, first.blank, first.faults, faults_of)
    best = teeth_by_proportions[chosen]
    if best.refusal is not None:
        raise best.refusal
    return best if chosen == given else _saying(first, best)


def _with_proportions(design: FaceMilledDesign, given: Proportions, *, first: bool = False) -> _Plain:
    """Return the teeth of given proportions. Raises DesignError for blanks that cannot exist.

    The land of the `first` teeth is not measured unless they are undercut, because otherwise they are accepted.
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
    thin = not taken and _land(teeth.pinion.member.tooth) < MIN_LAND_MODULES * blank.mean_normal_module
    return _Plain(given, blank, teeth, faults=ToothFaults(undercut, thin))


def _undercut(teeth: BevelTeeth) -> tuple[float, float]:
    """Return the largest height (mm) lost to undercut of (pinion, gear)."""
    pinion_loss, gear_loss = (max(member.lost.values(), default=0.0) for member in (teeth.pinion, teeth.gear))
    return pinion_loss, gear_loss


def _land(tooth: Tooth) -> float:
    """Return the least width of the top land (mm)."""
    sections = tooth.even
    radius = crossing(tooth.blank.tip, tooth.blank.axial, sections.stations)[0]
    return float((radius * (sections.left.tip_angle - sections.right.tip_angle)).min())


def _saying(first: _Plain, best: _Plain) -> _Plain:
    """Return the `best` teeth with a warning.

    The warning has their factors, the factors of the `first` teeth, and the fault of the `first` teeth.
    """
    old, new = (factors(plain.given, plain.blank) for plain in (first, best))
    changed = [k for k in range(2) if new[k] != old[k]]
    said, instead = (" and ".join(f"{FACTOR_KEYS[k]} = {pair[k]:.4g}" for k in changed) for pair in (new, old))
    why = f"{first.refusal.key}: {first.refusal.reason}" if first.refusal else "teeth would be undercut"
    blank = replace(
        best.blank, warnings=(*best.blank.warnings, f"{said}: the default, instead of {instead}; with that {why}")
    )
    teeth = None if best.teeth is None else replace(best.teeth, cut=replace(best.teeth.cut, blank=blank))
    return replace(best, blank=blank, teeth=teeth)


@lru_cache(maxsize=MAX_CACHED_DESIGNS)
def _search(key: _Remembered, blank: BevelBlank) -> Choices:
    """Return the chosen contact of both sides of the pinion."""
    return {name: contact_choice(key.design, blank, name) for name in in_turn(BLADE_SIDES)}


@lru_cache(maxsize=MAX_CACHED_DESIGNS)
def _best_teeth(key: _Remembered) -> BevelTeeth:
    """Return the teeth with the proportions of the plain teeth and the chosen contact.

    The teeth become shallower if the plain teeth are whole but the chosen contact undercuts them.
    """
    design, first = key.design, _plain(key)
    if first.teeth is not None and not any(chooses(design, name) for name in BLADE_SIDES):
        return first.teeth
    best = _with_contact(key, first)
    if not _may_become_shallower(design, first):
        return best
    for part in SHALLOW_DEPTH_SHARES:
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
    """Return True if the chosen contact may undercut the pinion of otherwise whole teeth, and their depth is free."""
    if first.teeth is None or any(first.faults.undercut) or "depth_factor" not in open_factors(design):
        return False
    return undercut_margin(first.teeth.pinion.member.tooth) < SAFE_UNDERCUT_MARGIN


def _with_contact(key: _Remembered, first: _Plain) -> BevelTeeth:
    """Return the teeth with the chosen contact, or else the plain teeth."""
    plain = first.teeth
    try:
        choices = _search(key.stated_design, first.blank)
        return _make(key.design, (first.given, first.blank), choices, None if plain is None else plain.gear)
    except (DesignError, NoSolutionError):
        # a blank with room for the plain contact may have none for the chosen one
        if plain is None:
            raise
        return plain


def _make(
    design: FaceMilledDesign, basis: tuple[Proportions, BevelBlank], choices: Choices, gear: CutMember | None = None
) -> BevelTeeth:
    """Return the teeth of some proportions and their blank with a contact.

    The gear does not depend on the contact. It is cut first, because a fault of the gear shows on the pinion as well.
    """
    given, blank = basis
    cut = cut_sides(design, blank, choices)
    gear = cut_member(design, cut, "gear") if gear is None else gear
    return BevelTeeth(given, choices, cut, cut_member(design, cut, "pinion"), gear)
