"""Links that are mirror images or half-turn images of each other: the mesh of a link is reused for its image.

An image has s reversed, as the two sides of spur teeth and face gears, or s and t reversed, as the two sides of worm wheels.
The reused mesh is put on the surface of the image and measured there.
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

#: largest difference of equal second forms, as a share of their largest value
FORM_TOLERANCE_SHARE = 1e-4
#: largest difference of equal stations
STATION_TOLERANCE = 1e-9


def image(
    tooth: Tooth, mesh: LinkMesh, other: LinkMesh, made: PatchMesh, trimmed: Sections, forms: tuple[Forms, int, int]
) -> PatchMesh | None:
    """Return the mesh of a link made from the finished mesh of its image; None if the links are no images.

    - mesh: mesh of the link, before thinning.
    - other: mesh of the other link, before thinning.
    - made: finished mesh of the other link.
    - trimmed: sections, as `mesh_link` takes them.
    - forms: second forms of all links, and the numbers of both links.

    The `deviation` of the result is measured.
    """
    link = tooth.chain[mesh.patch.region]
    if link.surface is None or breaks(link).size:
        return None
    fixed = tooth.face_breaks
    stations = [*(mesh.stations(s) for s in (0.0, 1.0)), fixed]
    # two kinds of image: mirrored along s, or turned by half a turn (s and t reversed)
    for turned in (False, True):
        ends = [_image_stations(t, turned) for t in (*(other.stations(1.0 - s) for s in (0.0, 1.0)), fixed)]
        if _same_forms(*forms, turned) and all(map(_same_stations, stations, ends)):
            break
    else:
        return None
    s, t = 1.0 - made.nodes.s, 1.0 - made.nodes.t if turned else made.nodes.t.copy()
    # stations on seams and breaks must be equal to the last bit
    for end, seam_stations in zip((0.0, 1.0), stations, strict=False):
        seam = made.nodes.line(1.0 - end)
        t[seam[::-1] if turned else seam] = seam_stations
    for station in fixed:
        t[np.abs(t - station) <= STATION_TOLERANCE] = station
    second = between(forms[0].second[forms[1]], s, t)
    nodes = LinkNodes.of(tooth, mesh.patch.region, s, t, trimmed, second)
    # a mirror image reverses the order of the corners, so that normals stay outward
    triangles = made.triangles if turned else made.triangles[:, ::-1]
    edges, sides = edges_of(triangles, s.size)
    _, peaks, normals = deviations_of(nodes, triangles, edges, sides, np.isin(t, fixed))
    return PatchMesh(nodes, triangles, normals, max(mesh.patch.deviation, float(peaks.max())))


def _image_stations(t: Array, turned: bool) -> Array:
    """Return the stations of the image, in rising order."""
    return 1.0 - t[::-1] if turned else t


def _same_stations(first: Array, second: Array) -> bool:
    """True if two sets of stations are equal within the tolerance."""
    return first.size == second.size and bool((np.abs(first - second) <= STATION_TOLERANCE).all())


def _same_forms(forms: Forms, link: int, other: int, turned: bool) -> bool:
    """True if the second forms of two links are those of images; M changes its sign with s, and again with t."""
    way = -1 if turned else 1
    pairs = [
        (form[link], sign * form[other][::-1, ::way])
        for form, sign in ((forms.length, 1.0), (forms.twist, -way), (forms.face, 1.0))
    ]
    return all(
        np.abs(form - image_form).max() <= FORM_TOLERANCE_SHARE * np.abs(form).max() for form, image_form in pairs
    )
