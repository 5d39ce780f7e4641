"""A member from the sides that its cutters cut: blank, body, root and a tooth that closes from toe to heel."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import KindError, VagueError
from gearmesh.kernel.surface.levels import ConeLevel
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.blank import BevelBlank, MemberBlank
from gearmesh.systems.common.bevel.root import CutSide, bottom, root_cone
from gearmesh.systems.common.bodies.body import bore_radius, recessed_body
from gearmesh.systems.common.bodies.features import UnderTeeth, body_features
from gearmesh.systems.common.tooth_edges import with_end_chamfers, with_tip_edge
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.gear_train import Member, SourceParameters
from gearmesh.teeth.limits import lost_heights
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

if TYPE_CHECKING:
    from gearmesh.systems.common.bevel.design import BevelBody

#: shares of the default edge radius that are tried if it does not fit
EDGE_SHARES = (1.0, 0.75, 0.5, 0.35, 0.2, 0.1, 0.0)
#: depth of the front cone under the root, in mean depths of the teeth
TOE_RIM_DEPTHS = 0.35
#: depth of the back cone under the root, in mean depths of the teeth
HEEL_RIM_DEPTHS = 1.2
#: failures that the edge radii may cause
EDGE_FAILURES = ("flank", "crossing")


@dataclass(frozen=True)
class Remedies:
    """Remedies for teeth that cannot be trimmed, by the kind of failure."""

    #: texts; {name} is the member
    texts: Mapping[str, str]
    #: keys whose values have to be larger (1) or smaller (-1), or either (0)
    keys: Mapping[str, Mapping[str, int]]


@dataclass(frozen=True)
class CutMember:
    """A member and its undercut."""

    #: the member
    member: Member
    #: height (mm) lost to undercut, out of the height that the tool could generate, by undercut flank
    lost: dict[Side, float]

    def undercut_warnings(self, remedies: str) -> tuple[str, ...]:
        """Return the warnings on flanks that are partly undercut, with `remedies`."""
        return tuple(
            f"{self.member.name}: the {side} flank is undercut by up to {lost:.3g} mm of the height that its cutter could "
            f"generate; remedies: {remedies}"
            for side, lost in self.lost.items()
        )


def bevel_member(
    name: str,
    spec: BevelBody,
    blank: BevelBlank,
    own: MemberBlank,
    sides: Mapping[Side, CutSide],
    places: dict[Side, float],
    parameters: SourceParameters,
    remedies: Remedies,
) -> CutMember:
    """Return a member of a pair.

    - `name`: "pinion" or "gear"
    - `spec`: its part of the design, lengths in mm
    - `blank`: blank of the pair
    - `own`: the member's blank
    - `sides`: its sides
    - `places`: index positions of the flanks, rad
    - `parameters`: names of the flanks' parameters
    - `remedies`: remedies for teeth that cannot be closed

    Raises DesignError for teeth that cannot be closed from toe to heel.
    """
    axial, extent = own.stations, own.extent
    try:
        root = root_cone(name, sides, axial, extent)
    except TrimError as failure:
        raise VagueError(name, reason=failure.reason, allowed=remedies.texts["tip"]) from failure
    body = Blank(
        axial,
        extent,
        own.tip,
        root,
        _body(name, spec, blank, own, root),
    )
    fitting = _fitting_tooth(name, own.teeth, body, sides, places, spec.given_sides, remedies)
    tooth = with_tip_edge(name, fitting, spec)
    (toe, _), *_, (heel, _) = body.body.profile
    under = UnderTeeth(name, tooth, body.body, toe, heel, blank.mean_normal_module)
    member = with_end_chamfers(Member(name, tooth, parameters, body_features(spec, under)), spec)
    return CutMember(member, lost_heights(member.tooth))


def _on_cone(member: MemberBlank, root: ConeLevel, cone_distance: float, below: float = 0.0) -> tuple[float, float]:
    """Return (rho, z), mm, on the cone across the pitch cone at a cone distance, `below` mm under the root."""
    c, s = np.cos(member.pitch_angle), np.sin(member.pitch_angle)
    depth = float(member.depth_of(root, np.array(cone_distance))) + below
    return float(s * cone_distance - c * depth), float(c * cone_distance + s * depth - member.pitch_apex)


def _body(name: str, spec: BevelBody, blank: BevelBlank, member: MemberBlank, root: ConeLevel) -> Body:
    """Return the body between front cone and back cone."""
    toe_root = _on_cone(member, root, member.inner_cone_distance)
    toe = _on_cone(member, root, member.inner_cone_distance, TOE_RIM_DEPTHS * blank.mean_depth)
    heel = _on_cone(member, root, member.outer_cone_distance, HEEL_RIM_DEPTHS * blank.mean_depth)
    least, end = min((toe[0], "toe"), (heel[0], "heel"))
    if least <= 0.0:
        raise VagueError(
            name,
            reason=f"the body under the teeth at the {end} ends beyond its axis",
            allowed="more teeth, a smaller spiral angle or a narrower face",
        )
    what = f"the diameter under the teeth at the {end}"
    bore = bore_radius(name, spec.stated_bore, least, what, min(toe[0], toe_root[0]), key=spec.bore_key)
    return recessed_body(name, spec, spec.web, Body.disk(bore, toe, heel), root, blank.mean_depth)


def _fitting_tooth(
    name: str,
    teeth: int,
    body: Blank,
    sides: Mapping[Side, CutSide],
    places: dict[Side, float],
    given_sides: tuple[str, ...],
    remedies: Remedies,
) -> Tooth:
    """Return the tooth with the largest free edge radii that the fillets of neighbouring teeth leave room for.

    The radii are shares in EDGE_SHARES of the default. The edge radii of `given_sides` may also leave no flank: free
    radii are then reduced as well, and a refusal names them.
    """

    def prove(share: float) -> Tooth:
        flanks = {flank_side: side.with_edge(share) for flank_side, side in sides.items()}
        cut = {flank_side: side.side(places[flank_side]) for flank_side, side in flanks.items()}
        tooth = Tooth(teeth, cut[Side.RIGHT], cut[Side.LEFT], body)
        try:
            lower = bottom(flanks, cut, places, tooth.pitch_angle, (body.axial, body.extent))
            tooth = tooth if lower is None else replace(tooth, bottom=lower)
            if share > 0.0:
                tooth.prove_root(np.array([0.0, 0.5, 1.0]))
            tooth.prove()
        except TrimError as failure:
            if share > 0.0 and (failure.what == "root" or (given_sides and failure.what in EDGE_FAILURES)):
                raise
            raise _refusal(name, tooth, failure, given_sides, remedies) from failure
        except (KindError, ValueError) as failure:
            # fillets of which the lowest part folds back have no root, or one elsewhere
            raise VagueError(
                name,
                reason="the fillets do not end in a smooth line along the face",
                allowed=remedies.texts["tip"] + _given_remedy(given_sides),
            ) from failure
        return tooth

    try:
        return prove(EDGE_SHARES[0])
    except TrimError:
        # a tooth without room for sharp edges has no room for any edge radius
        sharp = prove(0.0)
    for share in EDGE_SHARES[1:-1]:
        with suppress(TrimError):
            return prove(share)
    return sharp


def _refusal(
    name: str, tooth: Tooth, failure: TrimError, given_sides: tuple[str, ...], remedies: Remedies
) -> VagueError:
    """Return the refusal of a tooth that cannot be trimmed, with its remedies."""
    return VagueError(
        name,
        reason=f"{failure.reason} at the cone distance {tooth.stations(failure.station):.5g} mm",
        allowed=remedies.texts[failure.what].format(name=name) + _given_remedy(given_sides),
        topic=f"{name}: {failure.what}",
        remedies=remedies.keys.get(failure.what),
    )


def _given_remedy(given_sides: tuple[str, ...]) -> str:
    """Return further remedies for given machine settings of sides: their edge radii, and the thickness that they leave."""
    if not given_sides:
        return ""
    edges, angles = (" and ".join(f"{side}.{key}" for side in given_sides) for key in ("edge_radius", "index_angle"))
    return f"; with these machine settings also a smaller {edges} (such as 0.01), or another {angles}"
