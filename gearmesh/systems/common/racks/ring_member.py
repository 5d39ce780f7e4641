"""Internal members whose spaces a form tool leaves: the profile of a shaper cutter with as many teeth on the same axis.

The transverse section is the involute of the member's base circle, a root fillet that is an arc of a circle, and the
root circle. A helical member is this section, twisted.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from gearmesh.errors import VagueError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.surface.levels import ConeLevel, PlaneLevel
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.kernel.surface.surface import PlacedSurface, Surface
from gearmesh.kernel.surface.twisted import Twisted
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.region import Region, Side
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import ToothSide
from gearmesh.tools.profile import Profile
from gearmesh.tools.rack import RackSurface
from gearmesh.tools.shaper import Shaper


def tool_surface(shaper: Shaper, profile: Profile, side: int, twist: float) -> Surface:
    """Return the surface of one side of a tool for a profile, in the tool's frame (see `tools.shaper`).

    `twist`: twist (rad/mm) of the section about the tool's axis.
    """
    section = RackSurface(profile, 0.0, 0.0, side)
    if twist == 0.0:
        return section
    to_axis = Rigid(np.eye(3), np.array([-shaper.pitch_radius, 0.0, 0.0]))
    return PlacedSurface(Twisted(PlacedSurface(section, to_axis), twist), to_axis.inverse)


def formed_surface(shaper: Shaper, profile: Profile, which: Side, twist: float = 0.0) -> PlacedSurface:
    """Return the surface that a profile of a form tool leaves on one side of the tooth.

    `twist`: twist (rad/mm) of the tool for helical teeth; 0 gives the transverse section of spur teeth.
    """
    # the tool's space is towards -x of its axis, the member's tooth on +x
    place = Rigid.about_z(math.pi) @ Rigid(np.eye(3), np.array([-shaper.pitch_radius, 0.0, 0.0]))
    return PlacedSurface(tool_surface(shaper, profile, -which.sign, twist), place)


def formed_side(shaper: Shaper, which: Side, twist: float, tip: float) -> ToothSide:
    """Return one side of an internal tooth: flank and fillet, twisted (rad/mm) on helical teeth; `tip`: tip radius, mm."""
    profiles = shaper.involute, shaper.rounding
    flank, fillet = (formed_surface(shaper, profile, which) for profile in profiles)
    by_flank, by_fillet = (formed_surface(shaper, profile, which, twist) for profile in profiles)
    return ToothSide(
        flank=flank if twist == 0.0 else Twisted(flank, twist),
        fillet=fillet if twist == 0.0 else Twisted(fillet, twist),
        form_point=shaper.form_point,
        root=shaper.root,
        tip=shaper.theta_at(tip),
        tool=replace(shaper.description, name="form tool"),
        generation=(by_flank, by_fillet),
    )


def ring_blank(half: float, tip: float, root: float, rim: float) -> Blank:
    """Return the blank of an internal member: half its face width, tip and root radius, and the rim outside the root, mm."""
    # the direction is -z, so that the frame along the chain points out of the material as on an external gear with +z
    return Blank(
        axial=PlaneLevel(0.0, -1.0),
        extent=(-half, half),
        tip=ConeLevel(-0.5 * np.pi, -tip),
        root=ConeLevel(-0.5 * np.pi, -root),
        body=Body.tube(root + rim, half, -half, Region.RIM),
    )


def prove_internal(name: str, tooth: Tooth, others: str) -> None:
    """Trim an internal tooth from end to end; raise a DesignError if this fails: the key at fault is not known.

    `others`: further keys that may help.
    """
    try:
        tooth.prove()
    except TrimError as failure:
        raise VagueError(
            name,
            reason=failure.reason,
            allowed=f"a smaller addendum or tip edge, or {others}",
            topic=f"{name}: {failure.what}",
        ) from failure
