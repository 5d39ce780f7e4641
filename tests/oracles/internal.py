"""An internal gear pair built on the core alone: a ring that a shaper generates, its body around the teeth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import gearmesh as gm
from gearmesh import GearPair, GearTrain, Member, Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import (
    Blank,
    Body,
    Chain,
    ConeLevel,
    Envelope,
    Mount,
    PlaneLevel,
    RackSurface,
    Region,
    Side,
    Step,
    Tooth,
    ToothSide,
)
from gearmesh.tools.shaper import Shaper

#: teeth of pinion, shaper and ring, module (mm), pressure angle (deg), face width and outer diameter of the ring (mm)
PINION, SHAPER, RING, MODULE, ALPHA, WIDTH, OUTSIDE = 20, 25, 60, 2.0, 20.0, 12.0, 140.0


def ring(teeth: int = RING) -> Member:
    """The ring in its own frame: tips towards the axis, so that stations and levels count the other way."""
    alpha = float(np.radians(ALPHA))
    shaper = Shaper(SHAPER, MODULE, alpha, addendum=1.25 * MODULE, tip_radius=0.2 * MODULE)
    radius = 0.5 * teeth * MODULE
    apart = radius - shaper.pitch_radius
    motion = Chain(
        (
            Step(rate=-SHAPER / teeth),
            Step(rate=1.0, angle0=np.pi, offset=(apart, 0.0, 0.0)),
            Step(offset=(-shaper.pitch_radius, 0.0, 0.0)),
        ),
        harmonic=True,
    )

    def side(which: Side) -> ToothSide:
        # turned by 180 deg the shaper's right side is the left one of the ring's tooth
        flank, fillet = (
            Envelope(RackSurface(profile, 0.0, 0.0, -which.sign), motion, branch=1)
            for profile in (shaper.involute, shaper.rounding)
        )
        tip = 0.15
        return ToothSide(flank, fillet, shaper.form_point, root=shaper.root, tip=tip, tool=shaper.description)

    half = 0.5 * WIDTH
    blank = Blank(
        axial=PlaneLevel(0.0, -1.0),
        extent=(-half, half),
        tip=ConeLevel(-0.5 * np.pi, -(radius - 0.8 * MODULE)),
        root=ConeLevel(-0.5 * np.pi, -(apart + shaper.top_radius)),
        body=Body.tube(0.5 * OUTSIDE, half, -half, Region.RIM),
    )
    return Member("ring", Tooth(teeth, side(Side.RIGHT), side(Side.LEFT), blank), _named)


def internal_gears(**changes: float) -> gm.Gears:
    """A spur pinion inside the ring, meshing with it; `changes` to the pinion's keys."""
    keys = {"teeth": PINION, "face_width": WIDTH, "addendum": 0.8, **changes}
    design = gm.BeveloidDesign(module=MODULE, pinion=keys, gear={"teeth": RING, "face_width": WIDTH})
    pinion = gm.build(design).members["pinion"]
    own = ring()
    apart = 0.5 * MODULE * (RING - PINION)
    mount = Mount(Rigid(np.eye(3), np.array([-apart, 0.0, 0.0])), sign=-1.0, zero=np.pi / RING)
    pair = GearPair(
        pinion=pinion,
        gear=replace(own, mount=mount),
        flanks=(Side.RIGHT, Side.LEFT),
        drive=1,
        ratio=PINION / RING,
        delta=design.contact.delta,
    )
    return gm.Gears(design, GearTrain("internal", (pair,)))


def _named(p: Array, v: Array) -> dict[str, Array]:
    return {"theta_s": p, "u_s": v}
