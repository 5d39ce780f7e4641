"""Links that are each other's image: s turned round, as on both sides of spur teeth and face gears, or s and t, as on worm wheels.

What was made of one of them, at some expense, is then that of the other one, too, on whose surface it is put and measured.
"""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.links.collapse import edges_of
from gearmesh.mesh.links.forms import Forms
from gearmesh.mesh.links.lines import between
from gearmesh.mesh.links.link_mesh import LinkMesh
from gearmesh.mesh.links.measure import deviations_of
from gearmesh.mesh.patch import LinkNodes, PatchMesh
from gearmesh.teeth.section import Sections, breaks
from gearmesh.teeth.tooth import Tooth

#: second forms that differ by no more than this share of the largest are the same, and stations that differ by no more than that
SAME_FORM, SAME_STATION = 1e-4, 1e-9


def image(
    tooth: Tooth, mesh: LinkMesh, other: LinkMesh, made: PatchMesh, trimmed: Sections, forms: tuple[Forms, int, int]
) -> PatchMesh | None:
    """What was `made` of the mesh of an `other` link, as that of a link whose image it is; None of links that are none.

    `trimmed`: as of `mesh_link`; `forms`: those of all links, and which of them both are. Its `deviation` is what was measured.
    """
    link = tooth.chain[mesh.patch.region]
    if link.surface is None or breaks(link).size:
        return None
    fixed = tooth.face_breaks
    own = [*(mesh.stations(s) for s in (0.0, 1.0)), fixed]
    for turned in (False, True):
        ends = [_image_stations(t, turned) for t in (*(other.stations(1.0 - s) for s in (0.0, 1.0)), fixed)]
        if _same_forms(*forms, turned) and all(map(_same_stations, own, ends)):
            break
    else:
        return None
    s, t = 1.0 - made.nodes.s, 1.0 - made.nodes.t if turned else made.nodes.t.copy()
    # to the last bit those of the seams and breaks
    for end, stations in zip((0.0, 1.0), own, strict=False):
        seam = made.nodes.line(1.0 - end)
        t[seam[::-1] if turned else seam] = stations
    for station in fixed:
        t[np.abs(t - station) <= SAME_STATION] = station
    second = between(forms[0].second[forms[1]], s, t)
    nodes = LinkNodes.of(tooth, mesh.patch.region, s, t, trimmed, second)
    triangles = made.triangles if turned else made.triangles[:, ::-1]
    edges, sides = edges_of(triangles, s.size)
    _, peaks, normals = deviations_of(nodes, triangles, edges, sides, np.isin(t, fixed))
    return PatchMesh(nodes, triangles, normals, max(mesh.patch.deviation, float(peaks.max())))


def _image_stations(t: Array, turned: bool) -> Array:
    """Stations in order as the image has them."""
    return 1.0 - t[::-1] if turned else t


def _same_stations(own: Array, other: Array) -> bool:
    return own.size == other.size and bool((np.abs(own - other) <= SAME_STATION).all())


def _same_forms(forms: Forms, own: int, other: int, turned: bool) -> bool:
    """Whether the second forms of two links are those of images; M changes its sign with s, and again with t."""
    way = -1 if turned else 1
    pairs = [
        (form[own], sign * form[other][::-1, ::way])
        for form, sign in ((forms.length, 1.0), (forms.twist, -way), (forms.face, 1.0))
    ]
    # each where the others are of the same size
    return all(np.abs(one - two).max() <= SAME_FORM * np.abs(one).max() for one, two in pairs)
