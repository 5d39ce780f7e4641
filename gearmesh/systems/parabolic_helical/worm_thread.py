r"""The grinding worm as a part that people make: thread flanks, crests that grind fillets, root [LF04 17.7].

The rack's surface has the gear on one side and the worm on the other: the worm's thread fills the cutter's tooth. Seen
from the worm, the cutter is turned by 180 deg in the normal section, about the middle of its tooth. It is then again
the space of a rack. This rack generates the worm as a helical gear of `threads` teeth, pitch radius r_w and helix angle
90 deg - lambda:

          gear's S_n                                     worm's S_n'
    x ^  \\ gear's tip                          x' ^   ____  crest, from the rounding: grinds the gear's fillet
      |   \\ flank          x' = -x                |  /    flank, outward normal n' = n in components
      |    \\___  rounding  y' = -(y + pi m / 2)   |_/  fillet of the worm, beyond the gear's tip: clearance
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.figures import Figures, Summary, figure
from gearmesh.kernel.envelope.envelope import Envelope
from gearmesh.kernel.envelope.feed_envelope import FeedEnvelope
from gearmesh.kernel.envelope.limiting_line import limiting_line
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.motion.rolling import RackRoll
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import last_true
from gearmesh.kernel.surface.levels import ConeLevel, PlaneLevel
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.records import dataclass
from gearmesh.systems.common.bodies.body import bore_radius
from gearmesh.systems.common.racks.rack_member import ROOT_PARAMETER, rack_parameters
from gearmesh.systems.common.racks.rack_tooth import RackTooth
from gearmesh.systems.system import ToolPart
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import TipCorner, ToothSide
from gearmesh.tools.profile import Profile
from gearmesh.tools.rack import Arc, RackSurface
from gearmesh.tools.worm import Worm

#: clearance of the worm's root from the gear's tips, normal modules
CLEARANCE_MODULES = 0.25
#: part of the space that the worm's fillets may take
MAX_FILLET_SHARE = 0.95
#: points across each profile and along the gear's face at which the worm's contact is computed
CONTACT_SAMPLES = (17, 9)
#: halvings to the smallest pitch radius whose thread is sound
BISECTION_STEPS = 40


@dataclass(frozen=True)
class Opposite:
    """A rack's profile seen from the other side of its surface: x' = -x, y' = -(y + half_pitch).

    `half_pitch` is in mm.
    """

    profile: Profile
    half_pitch: float

    def section(self, p: Array) -> tuple[Array, Array, Array, Array]:
        points, tangents, normals, turned = self.profile.section(p)
        # turned by 180 deg the normal is -n, and n again since the material is on its other side
        return -(points + np.array([0.0, self.half_pitch])), -tangents, normals, turned


@dataclass(frozen=True)
class WormFigures(Figures):
    """The worm that grinds a crowned pinion."""

    length: float = figure("length of the thread", "mm")
    needed_length: float = figure("length of thread needed to grind the whole tooth", "mm")
    least_pitch_radius: float = figure("least pitch radius of a worm without singular points", "mm")


def grinding_worm(
    worm: Worm,
    racks: tuple[RackTooth, RackTooth],
    touching: tuple[float, float],
    length: float | None = None,
    bore: float | None = None,
) -> ToolPart:
    """Return the worm whose thread touches between the z (mm) of `touching`, see `touching_range`.

    The thread is centred at z = 0. The default `length` (mm), in whole mm, grinds the whole tooth and is an axial pitch
    longer. At the ends of a thread one flank ends half a pitch before the other. For `bore` and errors see
    `worm_member`.
    """
    needed = 2.0 * max(abs(z) for z in touching)
    pitch = np.pi * worm.module / np.cos(worm.lead_angle)
    thread_length = float(math.ceil(needed + pitch)) if length is None else length
    figures = Summary(WormFigures(thread_length, needed, _least_radius(worm, racks)))
    warning = f"worm.length = {thread_length:g} mm: grinding the whole tooth needs {needed:.6g} mm"
    part = worm_member(worm, racks, thread_length, bore)
    return ToolPart(part, figures, (warning,) if thread_length < needed else (), _own_to_thread(worm))


def _own_to_thread(worm: Worm) -> Rigid:
    """Return the transformation from the part's frame to the frame of `Worm.thread`.

    The frame is turned end for end; a thread of the part is where the other frame has a space on +x.
    """
    return Rigid(np.diag([1.0, -1.0, -1.0]), np.zeros(3)) @ Rigid.about_z(np.pi / worm.threads)


def worm_member(
    worm: Worm, racks: tuple[RackTooth, RackTooth], length: float, bore: float | None = None, name: str = "worm"
) -> Member:
    """Return the worm as a member of `length` mm between planes across its axis, with a bore of diameter `bore` mm.

    `racks`: right and left side of the space of the gear's rack cutter. The frame is the worm's, its thread centred on
    +x. `worm.thread` of the right rack is the left side of the thread, turned by -pi / threads.

    Raises DesignError naming key, value and limit: singular points of the thread between root and tip, a bore not below
    the root, or a thread that cannot be closed.
    """
    clearance = min(CLEARANCE_MODULES * worm.module, *(_room(rack) for rack in racks))
    right, left = (_side(worm, rack, clearance, side) for rack, side in zip(racks[::-1], (1, -1), strict=True))
    _refuse_singular(worm, racks)
    root = worm.radius - racks[0].tip_height - clearance
    hole = bore_radius("worm", bore, root, "the root diameter")
    tip = ConeLevel.of(worm.radius - racks[0].root_height)
    half = 0.5 * length
    blank = Blank(PlaneLevel(0.0), (-half, half), tip, ConeLevel.of(root), Body.tube(hole, -half, half))
    tooth = Tooth(worm.threads, right, left, blank)
    try:
        tooth.prove()
    except TrimError as failure:
        raise DesignError(
            "worm.pitch_radius", worm.radius, unit="mm", reason=f"{failure} (of the worm's thread)", allowed="more"
        ) from failure
    return Member(name, tooth, rack_parameters("u_c", "theta_c"))


def touching_range(
    generate: Callable[[RackSurface], FeedEnvelope],
    worm: Worm,
    racks: tuple[RackTooth, RackTooth],
    extent: tuple[float, float],
) -> tuple[float, float]:
    """Return lowest and highest z (mm), in the worm's frame, of the thread's points that grind a gear.

    `extent`: z of the gear's face; `generate` makes the tooth surface of a rack surface, as `worm.tooth` with its
    crowning. Only the flanks from the cutter's rounding to the tip count. The normal passes through the pitch point,
    and the steeper normal of a rounding meets the rack nearer to it. A worm that ends between the two z does not grind
    the whole tooth.
    """
    feed = np.linspace(*extent, CONTACT_SAMPLES[1])
    places = []
    for rack, side in zip(racks, (1, -1), strict=True):
        p = np.linspace(rack.form_point[0], rack.tip, CONTACT_SAMPLES[0])[:, None]
        places.append(generate(RackSurface(rack.flank, worm.helix, 0.0, side)).generation(p, feed).tool.r[..., 2])
    return float(np.min(places)), float(np.max(places))


def thread_surface(worm: Worm, profile: Profile, side: int) -> Envelope:
    """Return the thread's surface, its normal out of the worm, for a profile of the gear's rack.

    `side`: side of the thread.
    """
    return Envelope(thread_rack(worm, profile, side), RackRoll(worm.radius))


def thread_rack(worm: Worm, profile: Profile, side: int) -> RackSurface:
    """Return the gear's rack cutter, seen from the thread: a rack that generates the thread."""
    helix = worm.hand * (0.5 * np.pi - worm.lead_angle)
    return RackSurface(Opposite(profile, 0.5 * np.pi * worm.module), helix, 0.0, side)


def _side(worm: Worm, rack: RackTooth, clearance: float, side: int) -> ToothSide:
    """Return one side of the thread."""
    point, angle = _at_tip(rack)
    radius = clearance / (1.0 - np.sin(angle))
    fillet = Arc((float(point[0] - radius * np.sin(angle)), float(point[1] + radius * np.cos(angle))), radius)
    cutter = thread_rack(worm, rack.flank, side)
    tip_corner = None
    if rack.rounding.radius != 0.0:
        tip_corner = TipCorner(thread_surface(worm, rack.rounding, side), rack.form_point, ROOT_PARAMETER)
    thread, root = (thread_surface(worm, profile, side) for profile in (rack.flank, fillet))
    return ToothSide(
        thread,
        root,
        form_point=(rack.tip, angle),
        root=ROOT_PARAMETER,
        tip=rack.form_point[0],
        tip_corner=tip_corner,
        tool=cutter.cutter(Opposite(fillet, 0.5 * np.pi * worm.module), radius, worm.radius),
        generation=(thread, root),
    )


def _room(rack: RackTooth) -> float:
    """Return the clearance (mm) at which the worm's fillet takes MAX_FILLET_SHARE of its half of the space.

    The space is the cutter's at the gear's tip.
    """
    point, angle = _at_tip(rack)
    return float(-MAX_FILLET_SHARE * point[1] / np.cos(angle) * (1.0 - np.sin(angle)))


def _at_tip(rack: RackTooth) -> tuple[Array, float]:
    """Return the point (2,) of the rack's flank at the gear's tip, and the angle of its normal, n = (sin, -cos)."""
    point, _, normal, _ = rack.flank.section(np.array(rack.tip))
    return point, float(np.arctan2(normal[0], -normal[1]))


def _refuse_singular(worm: Worm, racks: tuple[RackTooth, RackTooth]) -> None:
    """Raise DesignError if flank or crest of the thread has singular points, which lie on helices."""
    radii = _singular(worm, racks)
    if not radii.size:
        return
    raise DesignError(
        "worm.pitch_radius",
        worm.radius,
        unit="mm",
        reason=f"the thread has singular points at the radius {radii.max():.4g} mm, between root and tip",
        allowed=Allowed.at_least(np.ceil(1000.0 * _least_radius(worm, racks)) / 1000.0, "mm"),
    )


def _least_radius(worm: Worm, racks: tuple[RackTooth, RackTooth]) -> float:
    """Return the smallest pitch radius (mm) whose thread has no singular points.

    It is at least the radius that leaves a lead angle and a root.
    """
    least = max(0.5 * worm.threads * worm.module, racks[0].tip_height)
    low, high = least, max(worm.radius, 2.0 * least)
    while _singular(replace(worm, radius=high), racks).size:
        low, high = high, 2.0 * high

    def singular(radius: Array, _: NDArray[np.intp]) -> NDArray[np.bool_]:
        return np.array([_singular(replace(worm, radius=float(r)), racks).size > 0 for r in radius])

    _, sound = last_true(singular, np.array([low]), np.array([high]), rounds=BISECTION_STEPS)
    return float(sound[0])


def _singular(worm: Worm, racks: tuple[RackTooth, RackTooth]) -> Array:
    """Return the radii (K,) of the helices of singular points on flanks and crests."""
    radii = [np.zeros(0)]
    for rack in racks:
        for profile, span in (
            (rack.flank, (rack.form_point[0], rack.tip)),
            (rack.rounding, (*rack.form_point[1:], ROOT_PARAMETER)),
        ):
            points = limiting_line(thread_surface(worm, profile, 1), span, np.zeros(1)).on_surface
            radii.append(np.hypot(points[:, 0], points[:, 1]))
    return np.concatenate(radii)
