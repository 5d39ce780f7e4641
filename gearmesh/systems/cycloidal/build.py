"""Cycloidal drives: the pins, the lobes as the envelope of a pin in the planetary motion, and both in mesh.

The fixed frame is the disc's: its axis is z, the middle of both faces is at z = 0, and the ring's axis is at x = -e. Seen
from the arm between both axes, disc and ring turn about fixed axes, as an internal pair. phi1 turns the disc clockwise
about +z. The pin of the machine that grinds the lobes may have another size and place than the pins.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.design.core import Holes
from gearmesh.errors import DesignError
from gearmesh.kernel.envelope.motion_envelope import MotionEnvelope
from gearmesh.kernel.motion.chain import Chain, Step
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.grid_spline import PlaneJet
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.kernel.surface.levels import ConeLevel, PlaneLevel
from gearmesh.kernel.surface.offset import Offset
from gearmesh.kernel.surface.stations import TrimError
from gearmesh.kernel.surface.surface import PlacedSurface, Surface
from gearmesh.systems.common.axes import shifts
from gearmesh.systems.common.bodies.body import bore_radius, disc_body
from gearmesh.systems.common.bodies.features import UnderTeeth, body_features, ring_features
from gearmesh.systems.common.tooth_edges import with_end_chamfers
from gearmesh.systems.cycloidal.design import DISC_NAME, LAND_PINS, RIM_PINS, RING_NAME
from gearmesh.systems.cycloidal.geometry import PinCurve
from gearmesh.systems.system import Displacements
from gearmesh.teeth.blank.blank import Blank
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.carried_body import CarriedBody
from gearmesh.teeth.gear_train import GearPair, GearTrain, Member
from gearmesh.teeth.micro_geometry.flank_field import LevelField
from gearmesh.teeth.micro_geometry.index_angles import IndexAngles
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import Region, Side
from gearmesh.teeth.source_parameters import NamedParameters, SourceParameter
from gearmesh.teeth.tooth import Tooth
from gearmesh.teeth.tooth_side import Bottom, Crest, ToothSide
from gearmesh.tools.description import Dimension, ToolDescription
from gearmesh.tools.rack import Arc, RackSurface

if TYPE_CHECKING:
    from gearmesh.systems.cycloidal.design import CycloidalDesign, CycloidalMember

#: rotation (rad) of the pin on either side of the middle of a space that makes the bottom between the fillets
BOTTOM_HALF_ANGLE = 0.02 * np.pi
#: rotation (rad) at which the fillet of a lobe passes into its flank
FORM_ANGLE = 0.04 * np.pi
#: rotation (rad) of the pin on either side of a lobe's tip that makes the land
LAND_HALF_ANGLE = 0.02 * np.pi
#: angle (rad) on either side of the innermost point of a pin that is its land
PIN_LAND_HALF_ANGLE = 0.02
#: part of a pin, from its support, that is no flank, where normals leave room for it
PIN_FOOT_SHARE = 0.1
#: least wall beside output holes, in hole diameters
LEAST_HOLE_WALL = 0.1
#: length of output pins beyond the discs, in face widths of a disc
PIN_OVERHANG_WIDTHS = 0.25
#: largest angle (rad) of the pin's surface beyond its widest place, measured at the support
MAX_NECK_ANGLE = np.radians(60.0)


@dataclass(frozen=True)
class TipRelief:
    """Amount (mm), negative where material is removed, as a parabola over the radius from `start` to `tip`, mm."""

    amount: float
    start: float
    tip: float

    def jet(self, x: Array, y: Array) -> PlaneJet:
        """Return the amount and its partials at stations x and radii y (...,)."""
        height = self.tip - self.start
        share = np.maximum((y - self.start) / height, 0.0)
        zero = np.zeros_like(share)
        bend = np.where(share > 0.0, -2.0 * self.amount / height**2, 0.0)
        return PlaneJet(-self.amount * share**2, zero, -2.0 * self.amount * share / height, zero, zero, bend)


@dataclass(frozen=True)
class Drive:
    """Curve of the pins and of the grinding pin of a design in mm."""

    design: CycloidalDesign

    @cached_property
    def curve(self) -> PinCurve:
        """Curve of the pins."""
        return self._curve(0.0)

    @cached_property
    def ground(self) -> PinCurve:
        """Curve of the grinding pin."""
        return self._curve(self.design.modification.offset)

    def _curve(self, offset: float) -> PinCurve:
        design = self.design
        pins, lobes = design.ring.teeth, design.disc.teeth
        if not design.pins_in_ring:
            pins, lobes = lobes, pins
        return PinCurve(0.5 * design.pin_circle + offset, design.eccentricity, pins, lobes)

    @property
    def pin(self) -> float:
        """Radius of the pins, mm."""
        return 0.5 * self.design.pin_diameter

    @property
    def grinding_pin(self) -> float:
        """Radius of the grinding pin, mm: larger by the equidistant, and by half of the backlash."""
        return self.pin + self.design.modification.equidistant + 0.5 * self.design.backlash

    def gaps(self, phi: Array) -> Array:
        """Return the gaps (...,), mm, to first order, between lobes and pins at rotations phi (...,) of the pins.

        They are those of equidistant, offset and rotation in the middle of the play.
        """
        asked, curve = self.design.modification, self.curve
        turned = np.radians(asked.rotation) * curve.levers(phi) * curve.lobes / curve.pins
        leaning = curve.outside * asked.offset * np.cos(curve.leans(phi))
        return np.asarray(self.grinding_pin - self.pin - leaning + turned)

    @cached_property
    def lost_motion(self) -> float:
        """Rotation (rad) of the ring between both flanks to first order, the eccentric at rest, for any position of the pins.

        The pin that stops first has the smallest ratio of gap and lever; a relief of the tips is not included.
        """
        from scipy.optimize import minimize_scalar

        ends = PIN_LAND_HALF_ANGLE, np.pi - PIN_LAND_HALF_ANGLE
        least = minimize_scalar(
            lambda phi: float(self.gaps(phi) / self.curve.levers(phi)), bounds=ends, method="bounded"
        )
        turned = 2.0 * float(least.fun)
        return turned if self.design.pins_in_ring else turned * self.curve.pins / self.curve.lobes

    def lobe_points(self, phi: Array) -> Array:
        """Return points (..., 3), mm, of the right side of a lobe at rotations phi (...,), rad, of the pins."""
        return np.asarray(self.lobe_side(Side.RIGHT).jet(phi, np.zeros_like(phi)).r)

    def lobe_radii(self, phi: Array) -> Array:
        """Return the distances (...,), mm, of these points from the axis of the lobes."""
        points = self.lobe_points(phi)
        return np.asarray(np.hypot(points[..., 0], points[..., 1]))

    def lobe_radius(self, phi: float) -> float:
        """Return the distance (mm) from the axis of the lobes to their point at a rotation (rad) of the pins."""
        return float(self.lobe_radii(np.array(phi)))

    @cached_property
    def relief(self) -> LevelField | None:
        """Relief of the tips of the lobes; None if there is none. Raises DesignError for a start beside the lobes."""
        amount = self.design.modification.tip_relief
        if not amount:
            return None
        root, tip = (
            float(np.hypot(*self.envelope(Side.RIGHT).jet(np.array(p), np.array(0.0)).r[:2])) for p in (0.0, np.pi)
        )
        given = self.design.modification.tip_relief_start
        start = 0.5 * (root + tip) if given is None else 0.5 * given
        # the amount is that at the new tip
        end = tip - amount * self.ground.outside
        if not (start - root) * (start - end) < 0.0:
            low, high = sorted((root, end))
            raise DesignError(
                "modification.tip_relief_start",
                2.0 * start,
                unit="mm",
                reason="the lobes do not reach it",
                allowed=Allowed.between(2.0 * low, 2.0 * high, "mm"),
            )
        return LevelField((PlaneLevel(0.0), ConeLevel.of(0.0)), (TipRelief(amount, start, end),))

    def lobe_side(self, which: Side) -> Surface:
        """Return one side of the lobe on +x as it is after grinding and relief, with the parameters of the envelope."""
        surface = self.envelope(which)
        return surface if self.relief is None else Offset(surface, self.relief)

    def envelope(self, which: Side) -> MotionEnvelope:
        """Return one side of the lobe on +x; the first parameter is the pin's rotation from the middle of the space."""
        curve, out = self.ground, self.ground.outside
        rate = -out if which is Side.RIGHT else out
        half = np.pi / curve.lobes - np.radians(self.design.modification.rotation)
        motion = Chain(
            (
                Step(rate=-rate * curve.pins / curve.lobes, angle0=-half if which is Side.RIGHT else half),
                Step(rate=rate, offset=(-out * curve.eccentricity, 0.0, 0.0)),
                Step(offset=(curve.circle, 0.0, 0.0)),
            ),
            harmonic=True,
        )
        # the lobes' material is outside of the pin, and their normal points to its axis
        pin = RackSurface(Arc((0.0, 0.0), -self.grinding_pin), 0.0, 0.0)
        return MotionEnvelope(pin, motion, (0.0, np.pi) if out > 0 else (-np.pi, 0.0))


def build(design: CycloidalDesign) -> GearTrain:
    """Return the drive of a design (in mm): discs and ring in mesh.

    Raises DesignError naming key, value and limit for pins that undercut the lobes, and for bodies without room.
    """
    drive = Drive(design)
    _check_undercut(drive)
    made = {DISC_NAME: design.disc, RING_NAME: design.ring}
    pins = RING_NAME if design.pins_in_ring else DISC_NAME
    members = {
        name: with_end_chamfers((_pinned if name == pins else _lobed)(name, spec, drive), spec)
        for name, spec in made.items()
    }
    flank = Side(design.contact.flank)
    pairs = []
    ahead = design.assembly.disc_ahead or (0.0,) * design.discs
    for name, arm, along, turned in zip(design.disc_names, design.arm_angles, design.disc_places, ahead, strict=True):
        disc, ring = _mounts(design, arm, along)
        pairs.append(
            GearPair(
                pinion=replace(
                    _turned_holes(members[DISC_NAME], hole_angle(design, arm)),
                    name=name,
                    mount=disc,
                    index=IndexAngles.turned(disc.sign * np.radians(turned), design.disc.teeth),
                ),
                gear=replace(members[RING_NAME], mount=ring),
                flanks=(flank, flank.other),
                drive=flank.sign,
                ratio=design.disc.teeth / design.ring.teeth,
                delta=design.contact.delta,
                arm_turns=True,
            )
        )
    alike = (0,) * len(pairs) if len(pairs) > 1 and not any(ahead) else ()
    return GearTrain(
        design.kind, tuple(pairs), alike=alike, carried=_output_pins(design, pairs[0]), shared=len(pairs) > 1
    )


def _output_pins(design: CycloidalDesign, pair: GearPair) -> tuple[CarriedBody, ...]:
    """Return the output pins: cylinders through the holes of all discs, on the axis of the ring, which turn as the discs do."""
    holes, width = pair.pinion.features.holes, design.disc.face_width
    if design.output is None or holes is None:
        return ()
    beyond = PIN_OVERHANG_WIDTHS * width
    ends = -0.5 * width - beyond, design.disc_places[-1] + 0.5 * width + beyond
    shift = pair.gear.mount.base.translation - pair.pinion.mount.base.translation
    made = []
    for name, (x, y) in zip(design.output_pin_names, holes.centres, strict=True):
        radius = 0.5 * design.output.pin_diameter
        place = Rigid(np.eye(3), np.array([x, y, 0.0]))
        made.append(CarriedBody(name, pair.pinion.name, radius, ends, place, np.array([*shift[:2], 0.0])))
    return tuple(made)


def hole_angle(design: CycloidalDesign, arm: float) -> float:
    """Return the polar angle (rad) of a disc's first output hole from its tooth 0; that of the first disc is 0.

    The eccentric of the disc is `arm` (rad) ahead of the first one. Seen from the ring, tooth 0 of the disc is then at
    i pitches - arm d / z of the disc. Here d is the difference of the tooth numbers, and i the pitches of the ring next to
    the arm. Holes of all discs are in line.
    """
    teeth = design.disc.teeth
    lobe = (2.0 * np.pi * _ring_pitches(design, arm) - arm * design.difference) / teeth
    apart = 2.0 * np.pi / (1 if design.output is None else design.output.pins)
    return float(-lobe - apart * np.round(-lobe / apart))


def _ring_pitches(design: CycloidalDesign, arm: float) -> int:
    """Return the whole pitches of the ring that are next to an angle (rad)."""
    return round(arm * design.ring.teeth / (2.0 * np.pi))


def _turned_holes(disc: Member, angle: float) -> Member:
    """Return a disc whose output holes begin at a polar angle (rad)."""
    holes = disc.features.holes
    if holes is None or angle == 0.0:
        return disc
    return replace(disc, features=replace(disc.features, holes=replace(holes, start=angle)))


def _mounts(design: CycloidalDesign, arm: float, along: float) -> tuple[Mount, Mount]:
    """Return the positions of a disc and of the ring; errors move the disc.

    The disc is `along` (mm) from the first one, and its eccentric is `arm` (rad) ahead. The ring is turned by whole pitches
    towards it. The middle of all discs is the middle of the ring.
    """
    errors, axis = design.assembly, np.array([-design.eccentricity, 0.0, 0.0])
    about_ring = Rigid(np.eye(3), axis)
    moved = np.array([design.eccentricity + errors.dx, errors.dy, errors.dz])
    middle = Rigid(np.eye(3), axis + np.array([0.0, 0.0, 0.5 * design.disc_places[-1]]))
    facing = Rigid.about_z(_ring_pitches(design, arm) * 2.0 * np.pi / design.ring.teeth)
    lifted = Rigid(np.eye(3), moved + np.array([0.0, 0.0, along]))
    return (
        Mount(about_ring @ Rigid.about_z(arm) @ lifted, sign=-1.0),
        Mount(middle @ facing, sign=-1.0),
    )


def _displaced_bases(design: CycloidalDesign, train: GearTrain, errors: Mapping[str, Array]) -> tuple[Rigid, Rigid]:
    """Return the positions of both members with assembly errors."""
    disc, ring = (mount.base for mount in train.pairs[0].mounts)
    return Rigid(disc.rotation, disc.translation + shifts(errors["dx"], errors["dy"], errors["dz"])), ring


#: keys of the assembly errors, and the positions of the members with them
ASSEMBLY_DISPLACEMENTS = Displacements(("dx", "dy", "dz"), _displaced_bases)


def pinned_values(design: CycloidalDesign, train: GearTrain) -> dict[str, float]:
    """Return the lengths (mm) that a complete design leaves to the build: rim, cut lobes, relief, circle of output holes."""
    drive, values = Drive(design), {"ring.rim": _rim(design)}
    tip, whole = _lobe_tip(drive)
    if not whole:
        values["lobe_diameter"] = 2.0 * drive.lobe_radius(tip)
    if drive.relief is not None:
        (relief,) = drive.relief.factors
        assert isinstance(relief, TipRelief)
        values["modification.tip_relief_start"] = 2.0 * relief.start
    if design.discs > 1:
        values["disc_gap"] = design.disc_places[1] - design.disc.face_width
    holes = train.members[design.disc_names[0]].holes
    if design.output is not None and holes is not None:
        values["output.circle"] = holes.circle
    return values


def _check_undercut(drive: Drive) -> None:
    """Refuse a pin that undercuts the lobes."""
    most, used = drive.ground.largest_pin_radius, drive.grinding_pin
    if used < most:
        return
    design = drive.design
    if drive.pin < most:
        key, value, bound = "modification.equidistant", used - drive.pin, most - drive.pin
    else:
        key, value, bound = "pin_diameter", design.pin_diameter, 2.0 * (most - used + drive.pin)
    raise DesignError(
        key,
        value,
        unit="mm",
        reason="the pins undercut the lobes",
        allowed=Allowed.less_than(bound, "mm") if bound > 0.0 else "a smaller eccentricity, or a larger pin_circle",
    )


def _lobed(name: str, spec: CycloidalMember, drive: Drive) -> Member:
    """Return the member with lobes."""
    design = drive.design
    tip, whole = _lobe_tip(drive)
    right, left = (_lobe_side(drive, which, tip) for which in Side)
    # two passes of the grinding pin leave a root as wide as their distance, which a cylinder joins
    bottom = Bottom(right.flank, (-BOTTOM_HALF_ANGLE, BOTTOM_HALF_ANGLE))
    crest = None
    if whole:
        ends = (tip, 2.0 * np.pi - tip)
        crest = Crest(right.flank, ends, Crest(drive.envelope(Side.RIGHT), ends))
    tooth = Tooth(
        spec.teeth,
        right,
        left,
        _blank(name, spec, design, (drive.lobe_radius(np.pi if whole else tip), drive.lobe_radius(0.0))),
        bottom=None if design.modification.rotation else bottom,
        crest=crest,
    )
    parameters = NamedParameters(
        (
            SourceParameter("phi_p", "deg", "rotation of the pins from the middle of the space to the point"),
            SourceParameter("z", "mm", "distance along the axis, from mid face"),
        ),
        lambda p, v: (np.degrees(p), v),
    )
    return _member(name, spec, tooth, parameters, design)


def _lobe_side(drive: Drive, which: Side, tip: float) -> ToothSide:
    """Return one side of the lobes, whose flank ends at a rotation (rad) of the pins."""
    surface = drive.envelope(which)
    side = ToothSide(
        flank=surface,
        fillet=surface,
        form_point=(FORM_ANGLE, FORM_ANGLE),
        root=0.0 if drive.design.modification.rotation else BOTTOM_HALF_ANGLE,
        tip=tip,
        tool=ToolDescription(
            "pin",
            dimensions=(
                Dimension("radius", drive.grinding_pin, "mm", "r_p0"),
                Dimension("radius of its circle", drive.ground.circle, "mm", "R_0"),
            ),
        ),
        generation=(surface, surface),
    )
    if drive.relief is None:
        return side
    relieved = drive.lobe_side(which)
    breaks = _relief_begins(drive, tip)
    return replace(side, flank=relieved, fillet=relieved, flank_breaks=breaks, generated=side, generation=None)


def _relief_begins(drive: Drive, tip: float) -> tuple[float, ...]:
    """Return the rotation (rad) of the pins at which the relief of a flank begins, whose curvature jumps there."""
    relief = drive.design.modification.tip_relief
    if not relief or drive.relief is None:
        return ()
    (field,) = drive.relief.factors
    assert isinstance(field, TipRelief)

    def beyond(phi: Array) -> Array:
        return drive.lobe_radii(phi) - field.start

    begins = _root(beyond, FORM_ANGLE, tip)
    return () if np.isnan(begins) else (begins,)


def _root(function: Callable[[Array], Array], low: float, high: float) -> float:
    """Return the root of a function between two rotations (rad) of the pins; NaN if it has the same sign at both."""
    ends = np.array([low]), np.array([high])
    root = bracketed_root(lambda phi, _: function(phi), *ends)
    return float(root.values[0]) if root.converged[0] else np.nan


def _lobe_tip(drive: Drive) -> tuple[float, bool]:
    """Return the rotation (rad) of the pins at which the flank ends, and whether the lobe is whole.

    Raises DesignError for a diameter at which there is no lobe.
    """
    design, curve = drive.design, drive.ground
    given = None if design.lobe_diameter is None else 0.5 * design.lobe_diameter
    whole = curve.difference == 1 and not design.modification.rotation
    if given is None and whole:
        return np.pi - LAND_HALF_ANGLE, True
    # branches of neighbouring spaces, or two passes, cross in the middle of the lobe
    end = np.pi if whole else _root(lambda phi: drive.lobe_points(phi)[..., 1], FORM_ANGLE, np.pi)
    if given is None:
        land = LAND_PINS * design.pin_diameter
        given = drive.lobe_radius(
            _root(lambda phi: 2.0 * np.abs(drive.lobe_points(phi)[..., 1]) - land, FORM_ANGLE, end)
        )
    begins, ends = (drive.lobe_radius(phi) for phi in (FORM_ANGLE, end))
    if not (begins - given) * (ends - given) < 0.0:
        low, high = sorted((begins, ends))
        raise DesignError(
            "lobe_diameter",
            2.0 * given,
            unit="mm",
            reason="the lobes do not reach it",
            allowed=Allowed.between(2.0 * low, 2.0 * high, "mm"),
        )
    # the given radius is between the radii at both ends, which therefore bracket the root
    cut = given
    return _root(lambda phi: drive.lobe_radii(phi) - cut, FORM_ANGLE, end), False


def _pinned(name: str, spec: CycloidalMember, drive: Drive) -> Member:
    """Return the member with pins, each held by its support."""
    design, inwards = drive.design, name == RING_NAME
    circle, pin, support = drive.curve.circle, drive.pin, 0.5 * design.support_diameter
    # angles on the profile of a pin: the tip faces the lobes, and the pin enters its support at the root
    tip = -0.5 * np.pi if inwards else 0.5 * np.pi
    root = _support_angle(drive, support, inwards)
    touching = tip - np.sign(tip) * drive.curve.largest_lean
    # lobes touch the pin up to the largest lean of their normals; the form point lies between this place and the root
    form = root + PIN_FOOT_SHARE * (tip - root)
    if (touching - form) * np.sign(tip) <= 0.0:
        form = 0.5 * (touching + root)
    sides = []
    for which in Side:
        surface = PlacedSurface(
            RackSurface(Arc((circle, 0.0), pin), 0.0, 0.0, 1 if which is Side.RIGHT else -1), Rigid.identity()
        )
        tool = ToolDescription("pin", dimensions=(Dimension("radius", pin, "mm", "r_p"),))
        sides.append(
            ToothSide(
                flank=surface,
                fillet=surface,
                form_point=(form, form),
                root=root,
                tip=tip - np.sign(tip) * PIN_LAND_HALF_ANGLE,
                tool=tool,
                generation=(surface, surface),
            )
        )
    right, left = sides
    tooth = Tooth(
        spec.teeth,
        right,
        left,
        _blank(name, spec, design, (circle - pin if inwards else circle + pin, support)),
        crest=Crest(right.flank, (right.tip, 2.0 * tip - right.tip)),
    )
    parameters = NamedParameters(
        (
            SourceParameter("beta_p", "deg", "angle on the pin, from its point nearest to the lobes' axis"),
            SourceParameter("z", "mm", "distance along the axis, from mid face"),
        ),
        lambda p, v: (np.degrees(np.abs(p - tip)), v),
    )
    return _member(name, spec, tooth, parameters, design)


def _support_angle(drive: Drive, support: float, inwards: bool) -> float:
    """Return the angle (rad) on the profile of a pin at which it meets its support.

    Raises DesignError for a support that does not hold the pins, or that the lobes touch.
    """
    design, (circle, pin) = drive.design, (drive.curve.circle, drive.pin)
    lobes = (
        drive.lobe_radius(np.pi) + design.eccentricity if inwards else drive.lobe_radius(np.pi) - design.eccentricity
    )
    # law of cosines: the point of the pin's profile at the radius of the support
    sine = (support**2 - circle**2 - pin**2) / (2.0 * circle * pin)
    lean, neck = drive.curve.largest_lean, np.sin(MAX_NECK_ANGLE)
    # a pin is held behind the place where its normals lean most; it may be held farther back, by a neck
    sines = (-np.cos(lean), neck) if inwards else (-neck, np.cos(lean))
    low, high = (float(np.sqrt(circle**2 + pin**2 + 2.0 * circle * pin * end)) for end in sines)
    low, high = (max(low, lobes), high) if inwards else (low, min(high, lobes))
    if not low < support < high:
        fits = low < high
        reason = "the lobes touch it, or it does not hold the pins"
        if not fits or not design.sets("support_diameter"):
            raise DesignError(
                "eccentricity",
                design.eccentricity,
                unit="mm",
                reason="no surface between the pins holds them and clears the lobes",
                allowed="less, or larger pins",
            )
        raise DesignError(
            "support_diameter",
            2.0 * support,
            unit="mm",
            reason=reason,
            allowed=Allowed.between(2.0 * low, 2.0 * high, "mm"),
        )
    return float(np.arcsin(sine))


def _member(
    name: str, spec: CycloidalMember, tooth: Tooth, parameters: NamedParameters, design: CycloidalDesign
) -> Member:
    """Return a member of a proved tooth, with the features of its body."""
    try:
        tooth.prove()
    except TrimError as failure:
        raise DesignError(name, reason=failure.reason) from failure
    root = float(tooth.blank.root.at(0.0))
    inwards = name == RING_NAME
    module = tooth.height
    if not inwards and design.output is not None:
        spec = spec.model_copy(update={"holes": _output_holes(design, tooth.blank.body.bore_radius, root)})
    under = UnderTeeth(name, tooth, tooth.blank.body, root, root, module)
    return Member(name, tooth, parameters, (ring_features if inwards else body_features)(spec, under))


def _output_holes(design: CycloidalDesign, bore: float, root: float) -> Holes:
    """Return the holes for the output pins between the radii (mm) of bore and root.

    Raises DesignError for holes without room.
    """
    output = design.output
    assert output is not None
    hole = output.pin_diameter + 2.0 * design.eccentricity + output.clearance
    wall = LEAST_HOLE_WALL * hole
    low, high = 2.0 * (bore + wall) + hole, 2.0 * (root - wall) - hole
    # neighbouring holes must leave a wall, too
    low = max(low, (hole + wall) / np.sin(np.pi / output.pins))
    circle = 0.5 * (low + high) if output.circle is None else output.circle
    if not low <= high:
        raise DesignError(
            "output.pin_diameter",
            output.pin_diameter,
            unit="mm",
            reason=f"{output.pins} holes of {hole:.6g} mm have no room between bore and root",
            allowed="smaller or fewer pins",
        )
    if not low <= circle <= high:
        raise DesignError(
            "output.circle",
            circle,
            unit="mm",
            reason=f"holes of {hole:.6g} mm leave no wall to bore, root or each other",
            allowed=Allowed.from_to(low, high, "mm"),
        )
    return Holes(count=output.pins, diameter=hole, circle=circle)


def _blank(name: str, spec: CycloidalMember, design: CycloidalDesign, radii: tuple[float, float]) -> Blank:
    """Return the blank between the radii (mm) of tip and root."""
    half, (tip, root) = 0.5 * spec.face_width, radii
    if name == DISC_NAME:
        bore = bore_radius(name, spec.stated_bore, root, "the root diameter")
        body = disc_body(name, spec, bore, root, tip - root)
        return Blank(PlaneLevel(0.0), (-half, half), ConeLevel.of(tip), ConeLevel.of(root), body)
    behind = max(0.5 * design.pin_circle, root) if design.pins_in_ring else root
    rim = _rim(design)
    least = max(0.5 * design.pin_diameter, root - behind) if design.pins_in_ring else 0.0
    if not rim > least:
        raise DesignError(
            "ring.rim",
            rim,
            unit="mm",
            reason="the pins stand out of the ring",
            allowed=Allowed.more_than(least, "mm"),
        )
    return Blank(
        # the direction is -z, as for every internal gear
        axial=PlaneLevel(0.0, -1.0),
        extent=(-half, half),
        tip=ConeLevel(-0.5 * np.pi, -tip),
        root=ConeLevel(-0.5 * np.pi, -root),
        body=Body.tube(behind + rim, half, -half, Region.RIM),
    )


def _rim(design: CycloidalDesign) -> float:
    """Return the rim of the ring, mm."""
    if design.ring.rim is not None:
        return design.ring.rim
    return (RIM_PINS + (0.5 if design.pins_in_ring else 0.0)) * design.pin_diameter
