"""Straight bevel gears (octoid): a crown rack with plane flanks rolls on the pitch cones."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar

import numpy as np

import gearmesh as gm
from gearmesh.kinds import (
    Arc,
    Blank,
    Body,
    ConeLevel,
    CradleRoll,
    Envelope,
    FlankContact,
    GearPair,
    GearTrain,
    Jet,
    Key,
    Member,
    MemberTable,
    Mount,
    PairDesign,
    Profile,
    RackLine,
    Rigid,
    Side,
    ToolDescription,
    Tooth,
    ToothSide,
    UnderTeeth,
    body_features,
    gear_base,
)

ROOT = 0.5 * np.pi


@dataclass(frozen=True)
class CrownRack:
    """Cone from the apex over a profile at cone distance 1: r = (middle + v) (1, side y, -x), mm; v = 0 is mid face."""

    profile: Profile
    side: int
    middle: float

    def jet(self, u: Any, v: Any) -> Jet:
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        (x, y), (tx, ty), (nx, ny), (ax, ay) = (np.moveaxis(a, -1, 0) for a in self.profile.section(u))
        one, s, w = np.ones_like(x), self.side, (self.middle + v)[..., None]
        ray, tangent = np.stack((one, s * y, -x), axis=-1), np.stack((0.0 * one, s * ty, -tx), axis=-1)
        # at right angles to ray and tangent
        normal = np.stack((-(x * nx + y * ny), s * ny, -nx), axis=-1)
        change = np.stack((-(x * ax + y * ay), s * ay, -ax), axis=-1)
        length = np.linalg.norm(normal, axis=-1, keepdims=True)
        n = normal / length
        n_u = (change - n * (n * change).sum(axis=-1, keepdims=True)) / length
        return Jet(w * ray, n, w * tangent, ray, n_u, np.zeros_like(n))


class OctoidDesign(PairDesign):
    """A pair of straight bevel gears."""

    own_kind: ClassVar[str] = "octoid"
    about: ClassVar[str] = "straight bevel gears of a crown rack with plane flanks"
    example: ClassVar[Mapping[str, Any]] = {
        "module": 3,
        "pinion": {"teeth": 18, "face_width": 14, "bore": 14},
        "gear": {"teeth": 36, "face_width": 14, "bore": 20},
    }
    pinion: MemberTable
    gear: MemberTable
    shaft_angle: Annotated[float, Key("angle", "angle between the axes", low=30, high=150)] = 90.0
    pressure_angle: Annotated[float, Key("angle", "pressure angle", low=10, high=35)] = 20.0
    addendum: Annotated[float, Key("coefficient", "addendum at the heel", low=0.3, high=1.5)] = 1.0
    thinning: Annotated[float, Key("angle", "turn of each flank of the crown rack", low=0, high=1)] = 0.0
    contact: FlankContact = FlankContact()


def member(
    name: str, design: OctoidDesign, spec: MemberTable, angle: float, outer: float, crown_teeth: float
) -> Member:
    """One member with the pitch angle `angle`, rad, and the outer cone distance `outer`, mm."""
    module, half = design.given_module / outer, np.pi / (2.0 * crown_teeth) - np.radians(design.thinning)
    # the section at x = 1 of a plane through the apex, whose trace in the pitch plane is at the azimuth `half`
    slope = np.arctan(np.tan(np.radians(design.pressure_angle)) / np.cos(half))
    line, depth, radius = RackLine(slope, module, np.tan(half)), -1.2 * module, 0.2 * module
    begin = line.at_height(depth + radius * (1.0 - np.sin(slope)))
    point, _, normal, _ = (a for a in line.section(np.array(begin)))
    rounding = Arc(tuple(point + radius * normal), -radius)
    joined = (begin, float(np.arctan2(normal[0], -normal[1])))
    sine, cosine = np.sin(angle), np.cos(angle)
    base = Rigid(np.array([[sine, 0.0, -cosine], [0.0, 1.0, 0.0], [cosine, 0.0, sine]]), np.zeros(3))
    roll = CradleRoll((0.0, 0.0, 0.0), base, (0.0, -1.0 / sine))

    def side(sign: int) -> ToothSide:
        flank, fillet = (
            Envelope(CrownRack(profile, sign, outer - 0.5 * spec.face_width), roll) for profile in (line, rounding)
        )
        tool = ToolDescription("crown rack", profile=line, tip=rounding)
        tip = line.at_height(design.addendum * module)
        return ToothSide(flank, fillet, joined, ROOT, tip, tool=tool, generation=(flank, fillet))

    right = side(1)
    end = right.fillet.jet(np.array(ROOT), np.array(0.0)).r
    root = ConeLevel.of(0.0, float(np.hypot(end[0], end[1]) / end[2]))
    tip = ConeLevel.of(0.0, float(np.tan(angle + np.arctan(design.addendum * module))))
    toe, heel = outer - spec.face_width, outer

    def under(distance: float) -> tuple[float, float]:
        below = distance * np.tan(angle - np.arctan(root.slope)) + design.given_module
        return float(distance * sine - below * cosine), float(distance * cosine + below * sine)

    body = Body.disk(0.5 * (spec.stated_bore or 0.0), under(toe), under(heel))
    tooth = Tooth(spec.teeth, right, side(-1), Blank(ConeLevel(angle), (toe, heel), tip, root, body))
    tooth.prove()
    room = UnderTeeth(name, tooth, body, under(toe)[0], under(heel)[0], design.given_module)
    return Member(name, tooth, lambda p, v: {"height": p, "distance": v}, body_features(spec, room))


def build(design: OctoidDesign) -> GearTrain:
    """The pair: both members cut by one crown rack."""
    teeth, shaft = (design.pinion.teeth, design.gear.teeth), np.radians(design.shaft_angle)
    first = np.arctan2(np.sin(shaft), teeth[1] / teeth[0] + np.cos(shaft))
    crown_teeth = teeth[0] / np.sin(first)
    outer = 0.5 * design.given_module * crown_teeth
    pinion, gear = (
        member(name, design, spec, angle, outer, crown_teeth)
        for name, spec, angle in (("pinion", design.pinion, first), ("gear", design.gear, shaft - first))
    )
    side, ratio = Side(design.contact.flank), teeth[0] / teeth[1]
    space = gear_base(shaft) @ Rigid.about_z(np.pi / teeth[1])
    pinion, gear = replace(pinion, mount=Mount(Rigid.identity(), sign=-1.0)), replace(gear, mount=Mount(space))
    return GearTrain(design.kind, (GearPair(pinion, gear, (side, side), side.sign, ratio, design.contact.delta),))


SYSTEM = gm.System("octoid", OctoidDesign, build)
