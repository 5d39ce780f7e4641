"""Keys that designs of all bevel gears have in common."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from gearmesh.design import keys
from gearmesh.design.core import GearBody, Holes, PairDesign, Web
from gearmesh.design.keys import DERIVED_VALUE
from gearmesh.design.runout import PairRunout
from gearmesh.systems.common.bevel.iso23509.taper_names import TAPER_NAMES

#: keys from which the backlash is derived
BACKLASH_KEYS = {"module", "diametral_pitch", "accuracy_grade", "units"}


def edge_radius_key() -> Any:
    """Return the key of the rounding of the blade tip of any head cutter."""
    about = "rounding of the blade tip: generates the fillet"
    return keys.length(about, None, low=0, default="0.2 mean normal modules or what fits")


class BevelBody(GearBody):
    """Body of a bevel gear: between front and back cone, with a plane face at either end."""

    web: Web | None = None
    holes: Holes | None = None

    @property
    def given_sides(self) -> tuple[str, ...]:
        """Tables of the sides of the teeth whose flanks are moved by given machine settings."""
        return ()


class BevelMember(BevelBody):
    """Keys of both members."""

    root_angle: float | None = keys.angle(
        "root angle: root cone through the root at the mean point; through the pitch apex where that leaves the "
        "whole depth (standard taper)",
        None,
        above=0,
        high=90,
        default="by the taper",
        source="ISO 23509",
    )
    face_angle: float | None = keys.angle(
        "face angle: tip cone through the tip at the mean point",
        None,
        above=0,
        high=89.5,
        default="parallel to the mating gear's root",
    )


class BevelAssembly(PairRunout):
    """Assembly errors: displacements of the members from their nominal positions."""

    dA: float = keys.length("pinion moved along its axis, away from the apex", 0.0, source="[AB]; [CR3553] 3.5")
    dG: float = keys.length("gear moved along its axis, away from the apex", 0.0, source="[CR3553] 3.5")
    dV: float = keys.length("pinion axis offset (dE), along y", 0.0, source="[AB]; [CR3553] 3.5")
    d_delta: float = keys.angle("increase of the shaft angle", 0.0, low=-5, high=5, source="[CR3553] 3.5")


class BevelDesign(PairDesign):
    """Keys of all pairs of bevel gears."""

    usual: ClassVar[tuple[str, ...]] = ("shaft_angle", "pressure_angle", "face_width")

    pinion: BevelBody
    gear: BevelBody

    module: float | None = keys.length("outer transverse module", None, above=0, default="given by diametral_pitch")
    diametral_pitch: float | None = keys.pitch(
        "outer transverse diametral pitch, per inch in any units", None, above=0, default="given by module"
    )
    shaft_angle: float = keys.angle("shaft angle", 90.0, low=10, high=170, source="ISO 23509")
    face_width: float | None = keys.length(
        "face width, along the pitch cone", None, above=0, default="0.3 outer cone distance, at most 10 m"
    )
    assembly: BevelAssembly = BevelAssembly()

    @property
    def _size_symbols(self) -> Mapping[str, str]:
        return {"module": "m_et", "diametral_pitch": "P_et"}


class ProportionedDesign(BevelDesign):
    """Keys of pairs whose blanks follow from proportions and a taper [ISO 23509]."""

    pinion: BevelMember
    gear: BevelMember

    backlash: float = keys.length(
        "normal backlash of the pair at the mean point; each member is thinned for half of it",
        DERIVED_VALUE,
        low=0,
        default="by module and accuracy_grade",
        source="AGMA 2005; ISO 23509 (202)-(211)",
    )
    accuracy_grade: int = keys.count(
        "grade of accuracy, for tolerances and the default backlash", 7, low=2, high=11, source="ISO 17485"
    )
    clearance: float | None = keys.length(
        "clearance between tip and the mating gear's root", None, above=0, default="0.25 mean normal module"
    )
    depth_factor: float | None = keys.number(
        "mean working depth, mean normal modules",
        None,
        low=0.5,
        high=3,
        default="k_d by pinion teeth, less against undercut",
        source="ISO 23509",
    )
    addendum_factor: float | None = keys.number(
        "gear's mean addendum over working depth",
        None,
        low=0,
        high=1,
        default="c_ham by ratio, less against undercut",
        source="ISO 23509",
    )
    thickness_factor: float | None = keys.number(
        "tooth thickness modification: pinion thicker by this, mean normal modules",
        None,
        low=-1,
        high=1,
        default="k_t by teeth",
        source="ISO 23509",
    )
    taper: str = keys.choice(
        "how the depth changes from toe to heel", TAPER_NAMES, "standard", source="ISO 23509 annex C"
    )

    @property
    def suggested_backlash(self) -> float:
        """Default normal backlash by module and grade of accuracy, in the design's units."""
        from gearmesh.systems.common.bevel.iso23509.tooth_factors import suggested_backlash

        mm = self.mm_per_unit
        return suggested_backlash(self.given_module * mm, self.accuracy_grade) / mm
