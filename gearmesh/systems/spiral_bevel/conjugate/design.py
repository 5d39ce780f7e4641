"""Design of a conjugate spiral bevel pair: Geometry I and II of [CR3553] chapter 2."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import model_validator

from gearmesh.allowed import Allowed
from gearmesh.design import keys
from gearmesh.design.keys import conflict
from gearmesh.systems.common.bevel.design import BevelBody, edge_radius_key
from gearmesh.systems.kinds import OWN_KINDS
from gearmesh.systems.spiral_bevel.design import BevelContact, HandedDesign, driving_side_key


class ConjugateMember(BevelBody):
    """One member."""

    r_d: float = keys.length(
        "cutter radius at the pitch plane (convex side of the pinion)", above=0, source="[CR3553] Fig. 2.2.4"
    )
    edge_radius: float | None = edge_radius_key()


class ConjugateContact(BevelContact):
    """Contact, by default on the side that [CR3553] takes."""

    side: str = driving_side_key("pinion_convex")


class ConjugateDesign(HandedDesign):
    """A pair of conjugate spiral bevel gears."""

    usual: ClassVar[tuple[str, ...]] = ("psi_c", "beta")
    own_kind: ClassVar[str] = "spiral_bevel_conjugate"
    example: ClassVar[Mapping[str, Any]] = {
        "module": 4,
        "face_width": 24,
        "pinion": {"teeth": 20, "r_d": 74},
        "gear": {"teeth": 40, "r_d": 76},
    }
    about: ClassVar[str] = OWN_KINDS["spiral_bevel_conjugate"].about
    called: ClassVar[str] = "Conjugate spiral bevel gears"

    beta: float = keys.angle("mean spiral angle", 35.0, low=0, high=50, source="[CR3553] 2.2")
    psi_c: float = keys.angle("blade angle", 20.0, low=5, high=40, source="[CR3553] 2.2")
    rho: float | None = keys.length(
        "Geometry II: profile radius of the pinion's cutter; at most 1000 depths of the teeth",
        None,
        above=0,
        high=5e4,
        default="Geometry I: straight blades",
        source="[CR3553] 2.5",
    )
    addendum: float = keys.number("mean addendum of both members, mean normal modules", 0.8, low=0.1, high=2)
    dedendum: float = keys.number("mean dedendum of both members, mean normal modules", 1.0, low=0.1, high=2)
    pinion: ConjugateMember
    gear: ConjugateMember
    contact: ConjugateContact = ConjugateContact()

    @model_validator(mode="after")
    def _touching(self) -> ConjugateDesign:
        first, second = self.pinion.r_d, self.gear.r_d
        if self.rho is not None and first != second:
            raise conflict(
                "gear.r_d",
                second,
                reason=f"with rho (Geometry II) both cutters have one radius, pinion.r_d = {first:g}",
            )
        if self.rho is None and not first < second:
            raise conflict(
                "pinion.r_d",
                first,
                must_be=Allowed.less_than(second, self.units, "gear.r_d", ", for contact in a point (Geometry I)"),
            )
        return self
