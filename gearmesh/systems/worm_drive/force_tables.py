"""Forces that a torque puts on worm and wheel, with friction where the design gives its coefficient [ISO/TS 14521].

They act where the flanks touch on the worm's reference cylinder, in the plane of its axis and the common perpendicular; with
x2 = 0 that is the pitch point. Friction is along the sliding velocity there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.kernel.numeric.algebra import AXIS, Array, cross, dot, unit
from gearmesh.systems.common.running import running_rows
from gearmesh.systems.common.symbol_table import Row, table
from gearmesh.systems.system import SheetTable, complete_design
from gearmesh.systems.worm_drive.build import worm_thread
from gearmesh.systems.worm_drive.contact.conjugate import ThreadMesh
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.worm_drive.design import WormDriveDesign

#: names of the members
MEMBERS = ("worm", "wheel")


def thread_mesh(design: WormDriveDesign) -> ThreadMesh:
    """The contact of the working flanks of a complete design in mm."""
    return ThreadMesh(
        worm_thread(design),
        Side(design.contact.flank).sign,
        design.wheel.teeth,
        design.center_distance,
        math.radians(design.shaft_angle - 90.0),
    )


@dataclass(frozen=True)
class PitchForces:
    """What worm and wheel do to each other at one point `r` of contact per N of normal force: the force (3,) on the `wheel`."""

    mesh: ThreadMesh
    r: Array
    on_wheel: Array

    @property
    def torques(self) -> tuple[float, float]:
        """Moments (N mm per N) about the own axis: that which drives the worm, and that of the force on the wheel, along with the
        speeds of both."""
        (w1, w2), centre = self.mesh.speeds, np.array([self.mesh.distance, 0.0, 0.0])
        # on its left flanks the worm drives the other way
        on_worm = self.mesh.side * float(dot(cross(self.r, -self.on_wheel), unit(w1)))
        return -on_worm, self.mesh.side * float(dot(cross(self.r - centre, self.on_wheel), unit(w2)))

    @property
    def parts(self) -> dict[str, tuple[float, float]]:
        """Tangential part, radial part towards the own axis, axial part along z or the wheel's axis: on worm and wheel."""
        across = np.cross(self.mesh.wheel_axis, [1.0, 0.0, 0.0])
        force, x = self.on_wheel, float(self.on_wheel[0])
        return {
            "F_t": (abs(float(force[1])), abs(float(force @ across))),
            "F_r": (x, x),
            "F_a": (-float(force @ AXIS), float(force @ self.mesh.wheel_axis)),
        }


def pitch_forces(mesh: ThreadMesh, friction: float, driver: int) -> PitchForces:
    """Forces per N of normal force with a coefficient of friction, the worm (+1) or the wheel (-1) driving."""
    at = mesh.at_reference()
    # what slides over the wheel's flank drags it along; with the wheel driving, all turns the other way
    return PitchForces(mesh, at.r, at.n + driver * mesh.side * friction * unit(at.v12))


def efficiencies(mesh: ThreadMesh, friction: float) -> tuple[float, float | None]:
    """Efficiency at the reference point, the worm driving, and the wheel driving: None where that is self-locking."""
    ratio = mesh.teeth / mesh.thread.threads
    first, second = pitch_forces(mesh, friction, 1).torques
    back_first, back_second = pitch_forces(mesh, friction, -1).torques
    driven = back_first * ratio / back_second
    return second / (ratio * first), driven if driven > 0.0 else None


def pair_forces(design: WormDriveDesign, torque: float, speed: float | None) -> tuple[SheetTable, ...]:
    """Forces on worm and wheel for a torque (Nm) on the worm, which drives at a speed (1/min)."""
    own = complete_design(design).in_mm()
    mesh, flank = thread_mesh(own), Side(own.contact.flank)
    friction, ratio = own.friction or 0.0, own.wheel.teeth / own.worm.threads
    forces = pitch_forces(mesh, friction, 1)
    driving, driven = forces.torques
    normal = 1e3 * torque / driving
    rows = running_rows((torque, 1e-3 * normal * driven), None if speed is None else (speed, speed / ratio))
    if speed is not None:
        turning = speed * math.pi / 30.0
        sliding = float(np.linalg.norm(mesh.at_reference().v12)) * 1e-3 * turning
        rows.append(("v_g", "sliding speed", "m/s", (sliding,) * 2))
        if friction:
            words = "power, with the losses of this contact"
            at = (driving * turning, driven * turning / ratio)
            rows[-2] = ("P", words, "kW", tuple(1e-6 * normal * power for power in at))
    names = {
        "F_t": "tangential",
        "F_r": "radial, > 0 towards the own axis",
        "F_a": "axial, > 0 along the own z",
    }
    rows += [
        (symbol, names[symbol], "N", tuple(normal * part for part in both)) for symbol, both in forces.parts.items()
    ]
    drag: Row = ("F_n", "normal to the flanks", "N", (normal, normal))
    title = f"Forces for {torque:g} Nm on the worm, its {flank.value} flanks driving"
    return (table(f"{title}, coefficient of friction {friction:g}", MEMBERS, [*rows, drag]),)
