"""Forces of a torque on worm and wheel, with friction if the design gives its coefficient [ISO/TS 14521].

The forces act where the flanks touch on the worm's reference cylinder, in the plane of its axis and the common
perpendicular. With x2 = 0 this is the pitch point. Friction is along the sliding velocity at this point.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, cross, dot, unit
from gearmesh.records import dataclass
from gearmesh.systems.common.symbol_table import Row, running_rows, table
from gearmesh.systems.system import SheetTable, complete_design
from gearmesh.systems.worm_drive.build import worm_thread
from gearmesh.systems.worm_drive.contact.conjugate import ThreadMesh
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.worm_drive.design import WormDriveDesign

#: names of the members in order
MEMBER_NAMES = ("worm", "wheel")


def thread_mesh(design: WormDriveDesign) -> ThreadMesh:
    """Return the mesh of the working flanks of a complete design in mm."""
    return ThreadMesh(
        worm_thread(design),
        Side(design.contact.flank).sign,
        design.wheel.teeth,
        design.center_distance,
        math.radians(design.shaft_angle - 90.0),
    )


@dataclass(frozen=True)
class PitchForces:
    """Forces between worm and wheel at one point of contact, per N of normal force."""

    #: thread in mesh with the wheel
    mesh: ThreadMesh
    #: point of contact (3,), mm
    r: Array
    #: force (3,) on the wheel, N per N
    on_wheel: Array

    @property
    def torques(self) -> tuple[float, float]:
        """Moments (N mm per N) about the members' axes.

        They are the driving moment on the worm, and the moment of the force on the wheel.

        Their signs are along the speeds of both.
        """
        (w1, w2), centre = self.mesh.speeds, np.array([self.mesh.distance, 0.0, 0.0])
        # with its left flanks the worm drives in the opposite sense
        on_worm = self.mesh.side * float(dot(cross(self.r, -self.on_wheel), unit(w1)))
        return -on_worm, self.mesh.side * float(dot(cross(self.r - centre, self.on_wheel), unit(w2)))

    @property
    def parts(self) -> dict[str, tuple[float, float]]:
        """Components of the force on worm and wheel.

        They are tangential, radial towards the member's axis, and axial along z or the wheel's axis.
        """
        across = np.cross(self.mesh.wheel_axis, [1.0, 0.0, 0.0])
        force, x = self.on_wheel, float(self.on_wheel[0])
        return {
            "F_t": (abs(float(force[1])), abs(float(force @ across))),
            "F_r": (x, x),
            "F_a": (-float(force @ Z_AXIS), float(force @ self.mesh.wheel_axis)),
        }


def pitch_forces(mesh: ThreadMesh, friction: float, driver: int) -> PitchForces:
    """Return the forces per N of normal force with a coefficient of friction; `driver`: +1 worm, -1 wheel."""
    contact = mesh.at_reference()
    # friction drags the wheel's flank along with the sliding worm; with the wheel driving, all speeds are reversed
    return PitchForces(mesh, contact.r, contact.n + driver * mesh.side * friction * unit(contact.v12))


def efficiencies(mesh: ThreadMesh, friction: float) -> tuple[float, float | None]:
    """Return the efficiencies at the reference point with the worm driving, and with the wheel driving.

    The latter is None for a self-locking drive.
    """
    ratio = mesh.teeth / mesh.thread.threads
    worm_torque, wheel_torque = pitch_forces(mesh, friction, 1).torques
    worm_torque_back, wheel_torque_back = pitch_forces(mesh, friction, -1).torques
    driven = worm_torque_back * ratio / wheel_torque_back
    return wheel_torque / (ratio * worm_torque), driven if driven > 0.0 else None


def pair_forces(design: WormDriveDesign, torque: float, speed: float | None) -> tuple[SheetTable, ...]:
    """Return the forces on worm and wheel for a torque (Nm) on the worm, which drives at a speed (1/min)."""
    design_mm = complete_design(design).in_mm()
    mesh, flank = thread_mesh(design_mm), Side(design_mm.contact.flank)
    friction, ratio = design_mm.friction or 0.0, design_mm.wheel.teeth / design_mm.worm.threads
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
        (symbol, names[symbol], "N", tuple(normal * part for part in values)) for symbol, values in forces.parts.items()
    ]
    drag: Row = ("F_n", "normal to the flanks", "N", (normal, normal))
    title = f"Forces for {torque:g} Nm on the worm, its {flank.value} flanks driving"
    return (table(f"{title}, coefficient of friction {friction:g}", MEMBER_NAMES, [*rows, drag]),)
