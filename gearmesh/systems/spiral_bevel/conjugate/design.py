"""Design of a conjugate spiral bevel pair: Geometry I and II of [CR3553] chapter 2."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import model_validator

from gearmesh.design.keys import Key, conflict
from gearmesh.systems.kinds import OWN_KINDS
from gearmesh.systems.spiral_bevel.design import BevelBody, BevelContact, BevelDesign, DrivingSide, EdgeRadius


class ConjugateMember(BevelBody):
    """One member."""

    r_d: Annotated[
        float,
        Key(
            "length",
            "cutter radius at the pitch plane (convex side of the pinion)",
            low=0,
            above=True,
            source="[CR3553] Fig. 2.2.4",
        ),
    ]
    edge_radius: EdgeRadius = None


class ConjugateContact(BevelContact):
    """Contact, by default on the side that [CR3553] takes."""

    side: DrivingSide = "pinion_convex"


class ConjugateDesign(BevelDesign):
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

    beta: Annotated[float, Key("angle", "mean spiral angle", low=0, high=50, source="[CR3553] 2.2")] = 35.0
    psi_c: Annotated[float, Key("angle", "blade angle", low=5, high=40, source="[CR3553] 2.2")] = 20.0
    rho: Annotated[
        float | None,
        Key(
            "length",
            "Geometry II: profile radius of the pinion's cutter; at most 1000 depths of the teeth",
            low=0,
            high=5e4,
            above=True,
            default="Geometry I: straight blades",
            source="[CR3553] 2.5",
        ),
    ] = None
    addendum: Annotated[float, Key("number", "mean addendum of both members, mean normal modules", low=0.1, high=2)] = (
        0.8
    )
    dedendum: Annotated[float, Key("number", "mean dedendum of both members, mean normal modules", low=0.1, high=2)] = (
        1.0
    )
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
                must_be=f"less than gear.r_d, {second:g} {self.units}, for contact in a point (Geometry I)",
            )
        return self
