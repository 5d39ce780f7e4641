"""Names of the members of a gear set and of the pairs that mesh, known before anything is built of a design."""

from __future__ import annotations

from gearmesh.errors import ArgumentError, DesignError
from gearmesh.records import dataclass


@dataclass(frozen=True)
class MemberNames:
    """Names of the members of a gear set."""

    #: names of the members that mesh; the first of each pair is the one whose rotation phi1 counts
    pairs: tuple[tuple[str, str], ...] = ()
    #: members that mesh with none
    unpaired: tuple[str, ...] = ()
    #: name in the design of the member with which these would mesh
    lacking: str = ""
    #: bodies without teeth that turn with a member
    carried: tuple[str, ...] = ()

    @property
    def members(self) -> tuple[str, ...]:
        """Every name once, in the order of the pairs, and after them those without one."""
        return tuple(dict.fromkeys((*(name for pair in self.pairs for name in pair), *self.unpaired)))

    @property
    def pair_names(self) -> tuple[str, ...]:
        """Names of the pairs, as "sun-planet_1"."""
        return tuple("-".join(pair) for pair in self.pairs)

    def pair_number(self, which: int | str) -> int:
        """The number of a pair.

        `which`: the number itself, or the members' names in either order, as "sun-planet_1". Raises DesignError for
        another, and where no members mesh.
        """
        if not self.pairs:
            raise self._without_pair()
        if not isinstance(which, str):
            if not 0 <= which < len(self.pairs):
                numbers = "0" if len(self.pairs) == 1 else f"0 to {len(self.pairs) - 1}"
                raise ArgumentError("pair", which, must_be=f"{numbers}, or one of {', '.join(self.pair_names)}")
            return which
        for number, (first, second) in enumerate(self.pairs):
            if which in (f"{first}-{second}", f"{second}-{first}"):
                return number
        raise ArgumentError("pair", which, must_be=f"one of {', '.join(self.pair_names)}")

    def refuse_other_member(self, name: str) -> None:
        """Refuse the name of a member that there is not.

        Raises ArgumentError with the names that there are.
        """
        if name not in self.members:
            raise ArgumentError("member", name, must_be=f"one of {', '.join(self.members)}")

    def needs_pair(self, argument: str, value: object) -> DesignError:
        """The refusal of an argument that needs members that mesh.

        `value`: what was given.
        """
        return ArgumentError(argument, value, reason="needs a mating gear", remedy=f"add the table [{self.lacking}]")

    def _without_pair(self) -> DesignError:
        """The refusal of what needs members that mesh."""
        return DesignError(
            self.lacking,
            reason=f"the {', '.join(self.members)} has no mating gear, which contact, load and all figures of a mesh need",
            remedy=f"add the table [{self.lacking}]",
        )
