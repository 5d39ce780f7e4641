"""The thread of a hob of another diameter or number of threads than the worm: what it has of the worm's.

At one height over both reference cylinders hob and worm have the same normal pitch and normal thickness. Both are racks that
roll on one wheel: where that height is the pitch point's, in which the worm moves along its own thread over the wheel, threads of
worm and hob are tangent in it and the wheel is indexed alike by both.

Flanks touch with one normal where they have the same normal base pitch p_n cos(alpha_n). Involute threads have it at every height.
That of other forms changes with the height, of thin worms more than of thick ones, by which transmission errors grow from where it
is the same towards both ends of a contact; it is the same on the reference cylinders, in the middle of the depth.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache

from gearmesh.systems.common.standards.iso10828 import ThreadForm, lead_angle
from gearmesh.systems.worm_drive.thread import WormThread

#: steps to a thickness, and what is left of it that counts as none, in modules
STEPS, ARRIVED = 30, 1e-13


@lru_cache(maxsize=16)
def hob_thread_of(worm: WormThread, threads: int, radius: float, height: float) -> WormThread:
    """The thread of a hob of `threads` threads on a reference cylinder of `radius` (mm), with the normal pitch and thickness of the
    worm's where both are `height` (mm) over their reference cylinders."""
    if (radius, threads) == (worm.radius, worm.threads):
        return worm
    here, there = worm.radius + height, radius + height
    flat = worm.lead_angle_at(here)
    steep = lead_angle(worm.module * math.cos(flat), threads, 2.0 * there)
    narrower = math.cos(flat) / math.cos(steep)
    hob = replace(
        worm, threads=threads, module=worm.module * narrower, radius=radius, thickness=worm.thickness * narrower
    )
    hob = replace(hob, angle=_angle(worm, hob))
    return hob if height == 0.0 else _thicker(hob, there, narrower * worm.half_thickness(here))


def _angle(worm: WormThread, hob: WormThread) -> float:
    """The angle (rad) of a hob's tool that leaves the normal base pitch of the worm's thread."""
    # the same to the bit where pitches are
    pitches = worm.module * math.cos(worm.lead_angle) / (hob.module * math.cos(hob.lead_angle))
    more = math.acos(min(1.0, pitches * math.cos(worm.normal_angle))) - math.acos(math.cos(worm.normal_angle))
    if worm.form is not ThreadForm.ZA:
        return worm.angle + more
    return math.atan(math.tan(worm.normal_angle + more) / math.cos(hob.lead_angle))


def _thicker(hob: WormThread, radius: float, half: float) -> WormThread:
    """The thread whose axial thickness at a radius (mm) is twice `half` (mm)."""
    for _ in range(STEPS):
        missing = 2.0 * (half - hob.half_thickness(radius))
        if not abs(missing) > ARRIVED * hob.module:
            break
        hob = replace(hob, thickness=hob.thickness + missing)
    return hob
