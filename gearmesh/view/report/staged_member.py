"""Data of members for the three-dimensional view: their meshes, their mounting, and the camera that sees them.

A member has one tooth, drawn as often as there are teeth, and the body under them. `stage` adds the contact of their pairs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from gearmesh.kernel.numeric.algebra import cross, unit
from gearmesh.mesh.solid import gear_solid
from gearmesh.mesh.tessellate import ToothMesh, tessellate
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.gear_train import Member
from gearmesh.view.report.packing import packed_mesh
from gearmesh.view.scene import BLUE_STEEL_PAINT, BRASS_PAINT, BRONZE_PAINT, Camera, Scene

#: upright angle of view for which the view places its camera
VIEW_ANGLE_DEG = 20.0
#: ratio of width to height for which the view places its camera
VIEW_ASPECT = 4.0 / 3.0
#: height of the camera of all gears over the gears; the view takes 0.9 of it
VIEW_MARGIN = 1.08 / 0.9
#: colours of members, by their shape
MEMBER_PAINTS = (BLUE_STEEL_PAINT, BRASS_PAINT, BRONZE_PAINT)


@dataclass(frozen=True)
class StagedMember:
    """A member for the view."""

    #: the member
    member: Member
    #: mesh of the whole member, own frame
    whole: TriangleMesh
    #: mesh of its first tooth
    tooth: TriangleMesh
    #: mesh of everything that is not repeated with the teeth
    rest: TriangleMesh
    #: the tooth as it was meshed
    teeth: tuple[ToothMesh]

    @property
    def reach(self) -> float:
        """Largest distance (mm) of the mesh from the origin of its own frame."""
        return float(np.linalg.norm(self.whole.vertices, axis=1).max())

    @staticmethod
    def of(member: Member, tolerance: float, *, lean: bool = True) -> StagedMember:
        """Mesh a member within `tolerance`, mm; `lean` as for `tessellate`."""
        tooth = tessellate(member.tooth, tolerance, lean=lean)
        return StagedMember.of_mesh(member, gear_solid(member, tolerance, tooth), tooth)

    @staticmethod
    def of_mesh(member: Member, whole: TriangleMesh, tooth: ToothMesh) -> StagedMember:
        """Return the member from its mesh `whole` and the mesh of the `tooth` that is repeated in it."""
        plain = whole
        if member.features.is_cut:
            plain = gear_solid(replace(member, features=member.features.uncut), tooth.tolerance, tooth)
        regions = member.repeated_regions
        repeated = np.isin(plain.regions, [plain.region_names.index(name) for name in regions])
        first = np.flatnonzero(repeated)[: int(repeated.sum()) // member.tooth.teeth]
        rest = whole.only(*(set(whole.region_names) - set(map(str, regions))))
        return StagedMember(member, whole, _part(plain, first), rest, (tooth,))


def camera_data(camera: Camera) -> dict[str, Any]:
    """Return the data of the camera with which the view begins."""
    return {
        "back": (camera.position - camera.focus).tolist(),
        "focus": camera.focus.tolist(),
        "up": np.asarray(camera.up).tolist(),
        "height": camera.height,
    }


def fitted(scene: Scene) -> Camera:
    """Return the camera of a scene with the height at which the view, a perspective, shows all of its bodies."""
    camera = scene.camera
    points = np.concatenate([body.own_to_scene.point(body.mesh.vertices) for body in scene.bodies])
    back = unit(camera.position - camera.focus)
    aside = unit(cross(np.asarray(camera.up, dtype=float), back))
    away = points - camera.focus
    x, y, z = (away @ axis for axis in (aside, cross(back, aside), back))
    slope = np.tan(np.radians(VIEW_ANGLE_DEG) / 2.0)
    distance = (z + np.maximum(np.abs(y), np.abs(x) / VIEW_ASPECT) / slope).max()
    return replace(camera, height=VIEW_MARGIN * 2.0 * float(slope * distance))


def shape_data(staged: StagedMember) -> dict[str, Any]:
    """Return the data of the shape of a member: its tooth, and everything that is not repeated."""
    return {"tooth": packed_mesh(staged.tooth), "rest": packed_mesh(staged.rest)}


def _part(mesh: TriangleMesh, chosen: Any) -> TriangleMesh:
    return replace(mesh, triangles=mesh.triangles[chosen], regions=mesh.regions[chosen], normals=mesh.normals[chosen])


def member_data(member: Member, shape: int, reach: float) -> dict[str, Any]:
    """Return the data of a member: its mounting and teeth, the number of its shape, and its `reach` (mm) from its origin."""
    joint, mount = member.tooth.joint, member.mount
    places = joint.places(member.tooth.teeth)
    paint = MEMBER_PAINTS[shape % len(MEMBER_PAINTS)]
    return {
        "name": member.name,
        "shape": shape,
        "teeth": member.tooth.teeth,
        "reach": reach,
        "pitch": member.tooth.pitch_angle,
        # relative to the tooth that is drawn
        "places": (places - places[0]).tolist(),
        "colours": [paint.of("flank"), paint.of("fillet"), paint.of("body")],
        "rotation": mount.base.rotation.tolist(),
        "translation": mount.base.translation.tolist(),
        "sign": mount.sign,
        "zero": mount.zero,
        "travel": mount.joint.travel,
        "eccentricity": list(mount.eccentricity),
    }
