"""Flanks as open surfaces for metrology: vertices on the exact surface, with its normals and parameters there."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gearmesh.mesh.patch import LinkNodes
from gearmesh.mesh.tessellate import ToothMesh, tessellate
from gearmesh.mesh.triangles import SurfaceMesh
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import FLANK_REGIONS, Side


def flank_meshes(member: Member, flanks: Sequence[Side], tolerance: float) -> list[ToothMesh]:
    """Return the meshes of flanks within `tolerance`, mm, of all different teeth, tooth by tooth."""
    return [tessellate(tooth, tolerance, (FLANK_REGIONS[side],)) for tooth in member.different_teeth for side in flanks]


def join_flanks(member: Member, meshes: Sequence[ToothMesh], teeth: int | None = None) -> SurfaceMesh:
    """Return the flanks of the first `teeth` teeth, or of all, in all rows; `meshes` are those of `flank_meshes`."""
    places = member.tooth.joint.places(member.tooth.teeth)[:teeth]
    kinds, tooth = member.order[: len(places)], list(member.different_teeth)
    names = tuple(dict.fromkeys(mesh.patches[0].region for mesh in meshes))
    every = []
    for mesh in meshes:
        (patch,) = mesh.patches
        kind_places = places[kinds == next(k for k, kind in enumerate(tooth) if kind is mesh.tooth)]
        motion = member.tooth.joint.to(kind_places * member.tooth.pitch_angle)
        for half in member.halves:
            points, normals, facets = (
                half.points(patch.points),
                half.vectors(patch.nodes.normals),
                half.vectors(patch.normals),
            )
            turned = [np.einsum("kij,nj->kni", motion.rotation, vectors) for vectors in (points, normals, facets)]
            turned[0] += motion.translation[..., None, :]
            count = len(kind_places)
            every.append(
                SurfaceMesh(
                    turned[0].reshape(-1, 3),
                    (patch.triangles[:, :: half.hand_sign] + np.arange(count)[:, None, None] * len(points)).reshape(
                        -1, 3
                    ),
                    np.full(count * len(patch.triangles), names.index(patch.region), dtype=np.int32),
                    names,
                    turned[2].reshape(-1, 3),
                    member.name,
                    vertex_normals=turned[1].reshape(-1, 3),
                    parameters=np.tile(_parameters(patch.nodes), (count, 1)),
                )
            )
    return SurfaceMesh.join(every)


def _parameters(nodes: LinkNodes) -> np.ndarray:
    """Return p, v, s and t (N, 4) of nodes on a surface."""
    assert nodes.parameters is not None
    return np.column_stack((nodes.parameters, nodes.s, nodes.t))
