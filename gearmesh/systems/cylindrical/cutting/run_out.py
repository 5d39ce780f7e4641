"""Run-outs of the teeth of cylindrical gears into thicker shafts: where they are, and the tool that makes them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.motion.rolling import RackRoll
from gearmesh.systems.common.racks.rack_tooth import RackTooth
from gearmesh.systems.common.racks.way_out import WayOut
from gearmesh.systems.common.tooth_edges import end_widths
from gearmesh.tools.rack import RackSurface

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.geometry.proportions import GearProportions

#: default radius (mm) of the tool at a module of 1 mm; it grows with the root of the module, as radii of catalogue hobs do
DEFAULT_TOOL_RADIUS_MM = 24.0


def _thick_shafts(gear: GearProportions) -> dict[str, float]:
    """Return the diameters, mm, of shafts that begin on an end face and are thicker than the roots, by their keys."""
    spec = gear.spec
    return {
        key: shaft.diameters[0]
        for key, shaft, hub in (
            ("toe_shaft", spec.toe_shaft, spec.toe_hub),
            ("heel_shaft", spec.heel_shaft, spec.hub),
        )
        if shaft is not None and hub is None and shaft.diameters[0] >= 2.0 * gear.root
    }


def tool_radius(gear: GearProportions) -> float:
    """Return the radius, mm, at the tip of the hob or milling cutter that leaves the teeth at a shaft."""
    given = gear.spec.run_out_radius
    return DEFAULT_TOOL_RADIUS_MM * math.sqrt(gear.own.module) if given is None else given


def runs_out(gear: GearProportions) -> bool:
    """Return True if teeth run out into a shaft."""
    return bool(_thick_shafts(gear))


def run_outs(gear: GearProportions, racks: tuple[RackTooth, RackTooth]) -> WayOut | None:
    """Return the run-outs at ends whose shaft begins thicker than the root; None if there is none.

    `racks`: both sides of the tool's tooth. Raises DesignError for a radius without such a shaft, for teeth that have
    another last cut, and for a tool that leaves no full depth.
    """
    name, spec, own = gear.name, gear.spec, gear.own
    shafts = _thick_shafts(gear)
    if not shafts:
        if spec.run_out_radius is not None:
            reason = "no shaft begins on an end face thicker than the roots, so that no teeth run out"
            raise DesignError(f"{name}.run_out_radius", spec.run_out_radius, unit="mm", reason=reason)
        return None
    key, diameter = next(iter(shafts.items()))
    if spec.modified or spec.tip_cone_angle or spec.tip_throat_radius or any(end_widths(spec)):
        raise DesignError(
            f"{name}.{key}.diameters",
            diameter,
            unit="mm",
            reason="teeth with modifications, turned tips or broken end edges cannot run out into a thicker shaft",
            allowed=Allowed.less_than(2.0 * gear.root, "mm", "the root diameter"),
        )
    tools = [Envelope(RackSurface(rack.flank, own.beta, 0.0), RackRoll(own.radius)) for rack in racks]
    forms = [tool.jet(np.array(rack.form_point[0]), np.array(0.0)).r for tool, rack in zip(tools, racks, strict=True)]
    radius = tool_radius(gear)
    half = 0.5 * spec.face_width
    way_out = WayOut(
        tool_radius=radius,
        radius=own.radius,
        helix=own.beta,
        alpha=min(side.alpha for side in own.sides),
        root=gear.root,
        form=max(float(np.hypot(form[0], form[1])) for form in forms),
        tip=gear.tip,
        module=own.module,
        faces=(-half, half),
        ends=("toe_shaft" in shafts, "heel_shaft" in shafts),
    )
    if way_out.rise <= 0.0:
        raise DesignError(f"{name}.{key}.diameters", diameter, unit="mm", reason="the flanks are too low to run out")
    way_out = way_out.within((RackSurface(rack.flank, own.beta, 0.0), rack.form_point[0]) for rack in racks)
    if way_out.fault:
        allowed = Allowed.more_than(gear.tip - gear.root, "mm", note=", and a run-out shorter than the face width")
        raise DesignError(f"{name}.run_out_radius", radius, unit="mm", reason=way_out.fault, allowed=allowed)
    return way_out
