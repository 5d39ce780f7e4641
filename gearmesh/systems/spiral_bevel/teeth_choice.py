"""The teeth of a design, where it leaves their contact open: what is chosen, or what plainer can be made.

The one place that decides: whoever asks for the blank, the contact, the settings or the members of a design asks here.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING

from gearmesh.design.keys import DERIVED
from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.systems.spiral_bevel.contact_choice import chooses, contact_choice, contact_said
from gearmesh.systems.spiral_bevel.cutting import Choices, cut_sides
from gearmesh.systems.spiral_bevel.pair import SIDES, CutMember, CutSides, cut_member
from gearmesh.systems.spiral_bevel.settings import basic_blank

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.blank import BevelBlank
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

#: keys on which no tooth depends
ASIDE = ("assembly.", "contact.", "fe.", "mesh.", "material.", "name")
#: the key that geometry itself gives where it is left open
BASE = "sliding_base"
#: designs whose teeth are remembered
REMEMBERED = 8


@dataclass(frozen=True)
class BevelTeeth:
    """What is made of a design: the contact that is asked of the pinion's sides, how they are `cut`, and the members."""

    choices: Choices
    cut: CutSides
    pinion: CutMember
    gear: CutMember


def bevel_teeth(design: FaceMilledDesign) -> BevelTeeth:
    """The teeth of a design in mm, with the contact that is best, or where no teeth with that close, with the plain one.

    Raises DesignError for blanks and teeth that cannot exist, before any contact has been looked for, NoSolutionError where no
    pinion gives the contact asked for.
    """
    return _settled(_Remembered.of(design))


def closing_teeth(design: FaceMilledDesign) -> BevelTeeth:
    """Teeth of a design in mm, with nothing of the contact chosen unless there are none without. Raises as `bevel_teeth` does."""
    key = _Remembered.of(design)
    return _plain(key).teeth or _settled(key)


@dataclass(frozen=True)
class _Remembered:
    """A design by all that its teeth depend on; of designs that are equal one may set what the other leaves to its default."""

    text: str
    design: FaceMilledDesign = field(compare=False)

    @classmethod
    def of(cls, design: FaceMilledDesign) -> _Remembered:
        own = [(key, value) for key, value in design.own() if not key.startswith(ASIDE) and not key.endswith(BASE)]
        bases = [each.sliding_base for each in (design.pinion.concave, design.pinion.convex, design.gear.cutter)]
        return cls(repr((type(design), own, bases, design.contact.delta)), design)

    @property
    def stated(self) -> _Remembered:
        """The design before sliding bases were derived of its geometry, which the search for a contact is to find."""
        design = self.design
        derived = {
            name: design.pinion.side(name).model_copy(update={BASE: DERIVED})
            for name in SIDES
            if not design.sets(f"pinion.{name}.{BASE}")
        }
        opened = design.model_copy(update={"pinion": design.pinion.model_copy(update=derived)})
        return _Remembered.of(opened.filled({}))


@dataclass(frozen=True)
class _Plain:
    """The blank, and the teeth with the contact that the design says; None where no pinion gives that."""

    blank: BevelBlank
    teeth: BevelTeeth | None


@lru_cache(maxsize=REMEMBERED)
def _plain(key: _Remembered) -> _Plain:
    design = key.design
    blank = basic_blank(design)
    with suppress(NoSolutionError):
        return _Plain(blank, _made(design, blank, {name: contact_said(design, blank, name) for name in SIDES}))
    return _Plain(blank, None)


@lru_cache(maxsize=REMEMBERED)
def _sought(key: _Remembered) -> Choices:
    blank = _plain(key).blank
    return {name: contact_choice(key.design, blank, name) for name in SIDES}


@lru_cache(maxsize=REMEMBERED)
def _settled(key: _Remembered) -> BevelTeeth:
    design, first = key.design, _plain(key)
    plain = first.teeth
    if plain is not None and not any(chooses(design, name) for name in SIDES):
        return plain
    try:
        return _made(design, first.blank, _sought(key.stated), None if plain is None else plain.gear)
    except (DesignError, NoSolutionError):
        # a blank that has room for the one contact may have none for the other
        if plain is None:
            raise
        return plain


def _made(design: FaceMilledDesign, blank: BevelBlank, choices: Choices, gear: CutMember | None = None) -> BevelTeeth:
    """The teeth with a contact, on which the gear does not depend; that first: what is wrong with it would show on the pinion."""
    cut = cut_sides(design, blank, choices)
    gear = cut_member(design, cut, "gear") if gear is None else gear
    return BevelTeeth(choices, cut, cut_member(design, cut, "pinion"), gear)
