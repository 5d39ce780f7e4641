"""Design of a planetary gear set: a sun, planets around it, and an internal gear around them [ISO 21771]."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any, ClassVar, Self

from pydantic import model_validator

from gearmesh.design import keys
from gearmesh.design.core import FlankContact, RexsSource
from gearmesh.design.keys import conflict
from gearmesh.design.measured import PlanetaryMeasured
from gearmesh.design.runout import eccentricity, phase
from gearmesh.member_names import MemberNames
from gearmesh.numerals import parse_numbers
from gearmesh.systems.cylindrical.allowance_keys import CenterDistanceAllowance
from gearmesh.systems.cylindrical.design import CylindricalKeys, CylindricalMember, HalvesKeys
from gearmesh.systems.kinds import OWN_KINDS

#: difference below which the angle of a planet is moved to the angle at which it can be assembled
SNAP_ANGLE_DEG = 1e-3
#: difference of angles that is rounding
ANGLE_ROUNDING_DEG = 1e-9
#: name of the sun's table in a design
SUN_NAME = "sun"
#: name of the planet's table in a design
PLANET_NAME = "planet"
#: name of the ring's table in a design
RING_NAME = "ring"


class RingMember(CylindricalMember):
    """The internal gear of a planetary set; its tooth number may be written with either sign."""

    @model_validator(mode="before")
    @classmethod
    def _always_internal(cls, keys: Any) -> Any:
        if isinstance(keys, Mapping) and "internal" not in keys:
            return {**keys, "internal": True}
        return keys


class PlanetaryAssembly(CenterDistanceAllowance):
    """Mounting of sun, planets and ring."""

    center_distance: float | None = keys.length(
        "distance of the planets' axes from the sun's", None, above=0, default="sun and planet without backlash"
    )
    planet_angles: str | None = keys.text(
        'angles of the planets about the sun, deg, as "0, 118.6, 240"', None, default="equally spaced"
    )
    sun_eccentricity: float = eccentricity("sun")
    sun_phase: float = phase("sun")
    planet_eccentricity: float = eccentricity("planet")
    planet_phase: float = phase("planet")
    ring_eccentricity: float = eccentricity("ring")
    ring_phase: float = phase("ring")


class PlanetaryDesign(HalvesKeys, CylindricalKeys):
    """A planetary gear set on coaxial sun and ring."""

    usual: ClassVar[tuple[str, ...]] = ("planets", "fixed")
    own_kind: ClassVar[str] = "planetary"
    toothed: ClassVar[tuple[str, ...]] = (SUN_NAME, PLANET_NAME, RING_NAME)
    example: ClassVar[Mapping[str, Any]] = {
        "module": 2,
        "sun": {"teeth": 18, "face_width": 20},
        "planet": {"teeth": 27, "face_width": 20},
        "ring": {"teeth": 72, "face_width": 20},
    }
    about: ClassVar[str] = OWN_KINDS["planetary"].about
    called: ClassVar[str] = "Planetary gear set"

    sun: CylindricalMember
    planet: CylindricalMember
    ring: RingMember
    planets: int = keys.count("number of planets", 3, low=1, high=24)
    fixed: str = keys.choice("the fixed member, for speeds and ratio", ("ring", "carrier", "sun"), "ring")
    assembly: PlanetaryAssembly = PlanetaryAssembly()
    measured: PlanetaryMeasured | None = None
    rexs: RexsSource | None = None
    contact: FlankContact = FlankContact()

    @model_validator(mode="after")
    def _sound_set(self) -> Self:
        self.with_allowances()
        for name in (SUN_NAME, PLANET_NAME):
            if getattr(self, name).internal:
                raise conflict(f"{name}.internal", True, reason="only the ring of a planetary set is internal")
        if not self.ring.internal:
            raise conflict("ring.internal", False, reason="the ring of a planetary set is internal")
        least = self.planet.teeth + 1
        if self.ring.teeth < least:
            raise conflict(
                "ring.teeth",
                self.ring.teeth,
                must_be=f"at least {least}, more than the planet has",
                other=("planet.teeth", self.planet.teeth, f"at most {self.ring.teeth - 1}, fewer than the ring has"),
            )
        if self.assembly.planet_angles is not None:
            count = len(self._angles_given)
            if count != self.planets and "planets" in self.model_fields_set:
                raise conflict("planets", self.planets, must_be=f"{count}, as many as assembly.planet_angles")
        for name in (SUN_NAME, RING_NAME):
            if (mount := getattr(self, name).mount) is not None and not self._evenly_spaced:
                mount.refuse_stiffness(
                    f"{name}.mount",
                    "must be left out for planets at uneven angles: equal loads on them would not balance on the member",
                )
        return self

    @property
    def _angles_given(self) -> list[float]:
        text = self.assembly.planet_angles or ""
        try:
            angles = parse_numbers(text.replace(",", " ").split())
        except ValueError:
            angles = []
        if not angles or not all(map(math.isfinite, angles)):
            raise conflict("assembly.planet_angles", text, must_be='numbers of deg, as "0, 118.6, 240"')
        return angles

    @property
    def angles(self) -> list[float]:
        """Angles of the planets about the sun, deg.

        Given angles within SNAP_ANGLE_DEG of an angle at which a planet can be assembled are moved there.
        """
        if self.assembly.planet_angles is not None:
            return [taken for _, taken in self.angles_taken]
        return [360.0 * k / self.planets for k in range(self.planets)]

    @property
    def _evenly_spaced(self) -> bool:
        """True if the planets are at equal angles."""
        around = sorted(angle % 360.0 for angle in self.angles)
        steps = [(after - before) % 360.0 for before, after in zip(around, [*around[1:], around[0]], strict=True)]
        return len(around) == 1 or max(steps) - min(steps) < ANGLE_ROUNDING_DEG

    @property
    def angles_taken(self) -> list[tuple[float, float]]:
        """Given and used angle (deg) of each planet.

        Angles within SNAP_ANGLE_DEG of a whole number of steps from the first planet are moved there. A step is a turn
        over the teeth of sun and ring together.
        """
        given = self._angles_given
        step = 360.0 / (self.sun.teeth + self.ring.teeth)
        places = [given[0] + step * round((angle - given[0]) / step) for angle in given]
        return [
            (angle, place if ANGLE_ROUNDING_DEG < abs(angle - place) <= SNAP_ANGLE_DEG else angle)
            for angle, place in zip(given, places, strict=True)
        ]

    @property
    def member_names(self) -> MemberNames:
        """Sun and planets, planets and ring, which mesh."""
        planets = [f"{PLANET_NAME}_{k + 1}" for k in range(len(self.angles))]
        return MemberNames((*((SUN_NAME, planet) for planet in planets), *((planet, RING_NAME) for planet in planets)))

    @property
    def counted_teeth(self) -> int:
        return self.sun.teeth
