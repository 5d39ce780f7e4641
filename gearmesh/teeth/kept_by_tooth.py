"""Cache of things made of one side of a tooth: designs that differ in their mounting alone have the same tooth."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable
from typing import Generic, TypeVar

from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

Thing = TypeVar("Thing")

#: largest number of sides of teeth in a cache; the last used are kept
MAX_KEPT_SIDES = 12


class KeptByTooth(Generic[Thing]):
    """Cache by identity of the tooth, and by side; the tooth is kept too, so that its identity is not used again."""

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
    """Use the things kept of a `known` tooth for another tooth with the same bytes."""
    _equals[id(tooth)] = (tooth, _equals.get(id(known), (known, known))[1])
    while len(_equals) > MAX_KEPT_SIDES:
        _equals.popitem(last=False)
