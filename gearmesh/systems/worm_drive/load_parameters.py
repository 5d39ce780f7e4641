"""Mean values of the contact lines by ISO/TS 14521, for a wheel cut by a hob of the worm's size.

They are sums over the contact field with the weight dA P |b| / |b . v_r| of an element of the flank of a sliding
thread. Such a sum is the integral of a quantity along all contact lines and over the travel of the thread. The load is
even along all lines at once, w = F / l. With E_red = 2 E / (1 - nu^2) of two equal materials and Hertz's p_0^2 = w
E_red / (2 pi rho), 2 b_H = 8 p_0 rho / E_red:

    mean(p_0^2) = (16 / pi^2) p_m* T2 E_red / a^3        p_m* = pi / 32 mean(w / rho) a^3 / T2
    h = 21 h* ...,  h ~ v_n^0.7 rho^0.43 / w^0.13
                                     h* = 1.6 10^2.01 / 21 mean((v_n / (n1 a))^0.7 (rho / a)^0.43 / (w a^2 / T2)^0.13)
    s = s* p_0 a / E_red = 2 b_H v_g / v_2               s* = 8 mean(rho v_g / v_2) / a

rho is the radius of the gap across the line, v_n the mean velocity of both surfaces across it, v_2 the velocity of the
line over the wheel.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.numeric.polylines import share_inside
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.records import dataclass
from gearmesh.systems.common.symbol_table import Row
from gearmesh.systems.worm_drive.build import wheel_hob
from gearmesh.systems.worm_drive.contact.conjugate import ContactField
from gearmesh.systems.worm_drive.force_tables import thread_mesh
from gearmesh.systems.worm_drive.wires import flank_radius

if TYPE_CHECKING:
    from gearmesh.kernel.surface.levels import LandLevel
    from gearmesh.systems.worm_drive.contact.conjugate import ThreadMesh
    from gearmesh.systems.worm_drive.design import WormDriveDesign

#: numbers of points of the field from root to tip and across the face
FIELD_GRID_SHAPE = (81, 161)
#: factor of h*: 1.6 of Dowson and Higginson, powers of ten of the units m^2/N, N s/m^2, 1/min, mm, N/mm^2, Nm, um, and
#: 21 [ISO/TS 14521]
FILM_FACTOR = 1.6 * 10.0**2.01 / 21.0


@dataclass(frozen=True)
class LoadParameters:
    """Mean values of the contact lines."""

    #: mean length of all contact lines together, mm
    length: float
    #: mean radius of equivalent curvature, mm
    radius: float
    #: p_m*, parameter of the mean Hertzian stress
    pressure: float
    #: h*, parameter of the mean lubricant film thickness
    film: float
    #: s*, parameter of the mean sliding path
    path: float
    #: True if all of the field touches; False where the worm's flank cuts the wheel's away
    used: bool


def field(
    design: WormDriveDesign, tip: LandLevel, grid: tuple[int, int] = FIELD_GRID_SHAPE
) -> tuple[ContactField, Array]:
    """Return the contact over the teeth, and the weights (n, m) of its points in mm^2.

    A weight is a length of contact line times an axial travel of the thread.
    """
    mesh = thread_mesh(design)
    # grid of the flank between the radii of possible contact, and across the face
    limits = _radii(design, mesh)
    p_ends = mesh.thread.at_radius(limits[0]), mesh.thread.at_radius(limits[1])
    p = np.linspace(p_ends[0], p_ends[1], grid[0])[:, None] + np.zeros(grid[1])
    at_start = mesh.thread.section.curve.at(p[:, :1]).c
    rho = np.hypot(at_start[..., 0], at_start[..., 1])
    half = 0.5 * design.wheel.face_width
    across = np.linspace(-1.0, 1.0, grid[1]) * np.minimum(0.999 * rho, (1.0 if mesh.tilt == 0.0 else 1.4) * half)
    contact = mesh.at(p, np.arcsin(across / rho))
    axial = dot(contact.r - np.array([mesh.distance, 0.0, 0.0]), mesh.wheel_axis)
    out = tip.at(np.clip(axial, -half, half)) - _wheel_radius(mesh, contact.r)
    # towards one end of the face the flank turns away from the wheel; its points there touch only after an endless
    # travel, and beyond it they would touch from inside the wheel
    length = np.maximum(0.5 * design.worm.length - np.abs(contact.r[..., 2]), -0.5 * mesh.thread.axial_pitch)
    inside = share_inside(out) * share_inside(length) * (contact.over_thread * mesh.at_reference().over_thread > 0.0)
    if mesh.tilt:
        inside = inside * share_inside(half - np.abs(axial))
    # dp and d(angle) of the trapezoidal rule
    step = abs(p_ends[1] - p_ends[0]) / (grid[0] - 1) * (across[:, 1:2] - across[:, :1]) / np.sqrt(rho**2 - across**2)
    ends = [np.where(np.arange(n) % (n - 1) == 0, 0.5, 1.0) for n in grid]
    rate = mesh.thread.screw * np.linalg.norm(contact.b, axis=-1) / np.abs(contact.over_thread)
    return contact, inside * step * ends[0][:, None] * ends[1] * rate * contact.area


def _radii(design: WormDriveDesign, mesh: ThreadMesh) -> tuple[float, float]:
    """Return the radii between which the worm's flank can touch the wheel's flank.

    They are the form radius, and the tip radius or the end of the hob's flank.
    """
    thread, hob = mesh.thread, wheel_hob(design)
    tip = thread.radius + design.worm.addendum * design.axial_module
    deep = hob.form_radius - (hob.distance - design.center_distance)
    return flank_radius(design, thread), min(tip, deep)


def _wheel_radius(mesh: ThreadMesh, r: Array) -> Array:
    """Return the distances (...,) of points (..., 3) from the wheel's axis."""
    arm = cross(r - np.array([mesh.distance, 0.0, 0.0]), mesh.wheel_axis)
    return np.asarray(np.sqrt(dot(arm, arm)))


def load_parameters(
    design: WormDriveDesign, tip: LandLevel, grid: tuple[int, int] = FIELD_GRID_SHAPE
) -> LoadParameters:
    """Return the mean values of a complete design in mm; `tip`: tip of the wheel."""
    mesh = thread_mesh(design)
    contact, weight = field(design, tip, grid)
    bent = contact.curvature > 0.0
    used = bool(bent[weight > 0.0].all())
    weight = np.where(bent, weight, 0.0)
    weight_sum, a = float(weight.sum()), mesh.distance

    def mean(figure: Array) -> float:
        """Return the weighted mean of a quantity over the field."""
        return float((weight * np.where(weight > 0.0, figure, 0.0)).sum()) / weight_sum

    pitch = mesh.thread.axial_pitch
    arm = dot(cross(contact.r - np.array([a, 0.0, 0.0]), contact.n), mesh.wheel_axis)
    load = pitch / float((weight * np.abs(arm)).sum())  # N/mm per N mm of the wheel's torque
    size = np.linalg.norm(contact.b, axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        radius, over_wheel = 1.0 / contact.curvature, np.abs(contact.over_wheel) / size
        rolling = 0.5 * np.abs(contact.over_worm + contact.over_wheel) / size
        sliding = np.linalg.norm(contact.v12, axis=-1)
        speed = rolling * math.pi / 30.0 / a
        film = FILM_FACTOR * speed**0.7 * (radius / a) ** 0.43 / (load * a**2) ** 0.13
        return LoadParameters(
            length=weight_sum / pitch,
            radius=1.0 / mean(contact.curvature),
            pressure=math.pi / 32.0 * load * a**3 * mean(contact.curvature),
            film=mean(film),
            path=8.0 / a * mean(radius * sliding / over_wheel),
            used=used,
        )


def middle_contact_ratio(design: WormDriveDesign, tip: LandLevel) -> float:
    """Return the contact ratio in the plane of the worm's axis and the common perpendicular.

    It is the axial travel of the thread over its pitch, from the worm's tip to the wheel's tip or the end of the worm's
    flank.
    """
    mesh = thread_mesh(design)
    low, high = _radii(design, mesh)
    ends = np.array([mesh.thread.at_radius(radius) for radius in (low, high)])

    def out(p: Array, _: NDArray[np.intp]) -> Array:
        """Return the distance (mm) of contact points inside the wheel's tip."""
        r = mesh.at(p, np.zeros_like(p)).r
        axial = dot(r - np.array([mesh.distance, 0.0, 0.0]), mesh.wheel_axis)
        return tip.at(axial) - _wheel_radius(mesh, r)

    root = bracketed_root(out, ends[:1], ends[1:])
    start = root.values if root.converged.all() else ends[:1]
    shift = mesh.at(np.concatenate((start, ends[1:])), np.zeros(2)).shift
    return float(abs(shift[1] - shift[0])) / mesh.thread.axial_pitch


def contact_rows(design: WormDriveDesign, tip: LandLevel) -> list[Row]:
    """Return the rows of the mean values; those of the field are empty if the worm's flank would cut the wheel's away."""
    means = load_parameters(design, tip)
    values = (means.length, means.radius, means.pressure, means.film, means.path)
    shown = values if means.used else (None,) * len(values)
    rows = (
        ("l_m", "mean length of all contact lines together", "mm"),
        ("rho_m", "mean radius of equivalent curvature", "mm"),
        ("p_m*", "parameter of the mean Hertzian stress", "-"),
        ("h*", "parameter of the mean lubricant film thickness", "-"),
        ("s*", "parameter of the mean sliding path", "-"),
    )
    ratio: Row = ("eps_alpha", "contact ratio in the middle plane", "-", (middle_contact_ratio(design, tip),))
    return [ratio, *((*row, (value,)) for row, value in zip(rows, shown, strict=True))]
