"""Things that are made of one side of a tooth, the last used of which are kept: other mountings leave the tooth as it is."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from typing import Generic, TypeVar

from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

Thing = TypeVar("Thing")

#: limit of the sides of teeth of which things are kept, as those of gears of which only the mounting changes
MAX_KEPT_SIDES = 12


class KeptByTooth(Generic[Thing]):
    """Things by the identity of their tooth, which is kept with them, and its side."""

    def __init__(self) -> None:
        self._things: OrderedDict[tuple[int, Side], tuple[Tooth, Thing]] = OrderedDict()

    def get(self, tooth: Tooth, side: Side, make: Callable[[], Thing]) -> Thing:
        """Return the thing of one side of a tooth; what is not kept is made."""
        tooth = _equals.get(id(tooth), (tooth, tooth))[1]
        known = self._things.pop((id(tooth), side), None) or (tooth, make())
        self._things[id(tooth), side] = known
        while len(self._things) > MAX_KEPT_SIDES:
            self._things.popitem(last=False)
        return known[1]


#: teeth that stand for others with the same bytes, by the identity of the other, which is kept with them
_equals: OrderedDict[int, tuple[Tooth, Tooth]] = OrderedDict()


def stand_for(known: Tooth, tooth: Tooth) -> None:
    """Let what is kept of a `known` tooth serve another with the same bytes."""
    _equals[id(tooth)] = (tooth, _equals.get(id(known), (known, known))[1])
    while len(_equals) > MAX_KEPT_SIDES:
        _equals.popitem(last=False)
