"""Thread of a hob with another diameter or number of threads than the worm.

At one height over both reference cylinders, hob and worm have the same normal pitch and normal thickness. Both are
racks that roll on one wheel. If that height is the pitch point's, where the worm moves along its thread over the wheel,
the threads of worm and hob are tangent in it. The wheel is then indexed alike by both.

Flanks touch with one normal if they have the same normal base pitch p_n cos(alpha_n). Involute threads have it at every
height. For other forms it changes with the height, more for thin worms than for thick ones. Transmission errors then
grow towards both ends of a contact from the height at which it is equal. It is equal on the reference cylinders, in the
middle of the depth.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

from gearmesh.systems.common.standards.iso10828 import ThreadForm, lead_angle
from gearmesh.systems.worm_drive.thread import WormThread

#: largest number of steps to a thickness
MAX_THICKNESS_STEPS = 30
#: remaining error of a thickness, in modules
THICKNESS_TOLERANCE_MODULES = 1e-13


@lru_cache(maxsize=16)
def hob_thread_of(worm: WormThread, threads: int, radius: float, height: float) -> WormThread:
    """Return the thread of a hob.

    - `worm`: thread of the worm
    - `threads`, `radius`: number of threads, and radius of the reference cylinder (mm), of the hob
    - `height`: height over both reference cylinders at which normal pitch and thickness are equal, mm
    """
    if (radius, threads) == (worm.radius, worm.threads):
        return worm
    worm_radius, hob_radius = worm.radius + height, radius + height
    flat = worm.lead_angle_at(worm_radius)
    steep = lead_angle(worm.module * math.cos(flat), threads, 2.0 * hob_radius)
    narrower = math.cos(flat) / math.cos(steep)
    hob = replace(
        worm, threads=threads, module=worm.module * narrower, radius=radius, thickness=worm.thickness * narrower
    )
    hob = replace(hob, angle=_angle(worm, hob))
    return hob if height == 0.0 else _thicker(hob, hob_radius, narrower * worm.half_thickness(worm_radius))


def _angle(worm: WormThread, hob: WormThread) -> float:
    """Return the angle (rad) of the hob's tool with which its thread has the normal base pitch of the worm's thread."""
    # this form gives exactly the worm's angle for equal pitches
    pitches = worm.module * math.cos(worm.lead_angle) / (hob.module * math.cos(hob.lead_angle))
    more = math.acos(min(1.0, pitches * math.cos(worm.normal_angle))) - math.acos(math.cos(worm.normal_angle))
    if worm.form is not ThreadForm.ZA:
        return worm.angle + more
    return math.atan(math.tan(worm.normal_angle + more) / math.cos(hob.lead_angle))


def _thicker(hob: WormThread, radius: float, half: float) -> WormThread:
    """Return the thread whose axial thickness at a radius (mm) is twice `half` (mm)."""
    for _ in range(MAX_THICKNESS_STEPS):
        missing = 2.0 * (half - hob.half_thickness(radius))
        if not abs(missing) > THICKNESS_TOLERANCE_MODULES * hob.module:
            break
        hob = replace(hob, thickness=hob.thickness + missing)
    return hob
