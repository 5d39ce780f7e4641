"""One stage of a train: the gears of a design, and the relation between the rotations of its shafts.

A stage has two central members A and B, and the housing or a carrier C in whose frame they turn about fixed axes. With rotations
theta (rad, right-handed about the own z axis of each member), in any frame:

    theta_B - theta_C = f(theta_A - theta_C),        f(u) = slope u + constant + error(u)        [Willis]

The rotation of a rack is its travel over the reference radius of its pinion.
In a pair C is the housing. In a planetary set f is the relation over the planets, of which the most advanced one counts, and one of
A, B and C is fixed. `slope` is a ratio of whole numbers of teeth, f itself is the exact contact.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from fractions import Fraction
from functools import cached_property

import numpy as np

from gearmesh.answers.gearset import GearSet
from gearmesh.contact.engagement.curve import MeshCurve
from gearmesh.contact.engagement.cycle import gears_curve
from gearmesh.contact.engagement.pitch_turns import whole_turns
from gearmesh.contact.engagement.turns import FullTurns
from gearmesh.contact.fit.fit import reversed_pair
from gearmesh.contact.flanks import solver_pair
from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.kernel.motion.joint import REVOLUTE_JOINT, Joint
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair, Member

#: name of the frame in which the axes of planets rest
CARRIER_NAME = "carrier"
#: change of a rotation (rad) that ends the solution of the relation
ROTATION_TOLERANCE_RAD = 1e-14
#: most rounds of this solution; each reduces the error by the slope of the transmission error, about 1e-3
MAX_ROTATION_ROUNDS = 40


@dataclass(frozen=True)
class Port:
    """A central member, or the carrier, as a shaft holds it."""

    #: name in the stage
    name: str
    #: own frame at rotation 0 to the frame of the stage; z is the axis of rotation
    frame: Rigid
    #: direction (3,) to the mating gear, in the own frame and square to z; x for coaxial members
    towards: Array
    #: True if the mating gear is beside the axis
    leads_away: bool
    #: joint of the member; a rack slides
    joint: Joint = REVOLUTE_JOINT

    @property
    def slides(self) -> bool:
        """True for a rack."""
        return math.isinf(self.joint.cycle(1))


@dataclass(frozen=True)
class Mesh:
    """A mesh as a part of the relation: rotations of both members about the axes of their ports."""

    #: pair on the flanks that the train drives
    pair: GearPair
    #: rotations (rad) by which the mounts of the pair are ahead of the ports
    ahead: tuple[float, float]
    #: mesh that is the same but for its place about the carrier, as that of another planet; None for the first of its kind
    like: Mesh | None = None

    @cached_property
    def coast(self) -> Mesh:
        """The mesh on the other flanks."""
        return Mesh(reversed_pair(self.pair), self.ahead, None if self.like is None else self.like.coast)

    @cached_property
    def _turned_from_like(self) -> tuple[float, float]:
        """Rotations (rad) of phi1 and phi2 by which the mounts are ahead of those of the mesh that is `like` this one."""
        assert self.like is not None
        carried = next(
            own.mount.base @ first.mount.base.inverse
            for own, first in zip(self.pair.both, self.like.pair.both, strict=True)
            if own.idler
        )
        ahead = [
            own.mount.sign * _turned((carried @ first.mount.base).inverse @ own.mount.base)
            for own, first in zip(self.pair.both, self.like.pair.both, strict=True)
        ]
        return ahead[0], ahead[1]

    @cached_property
    def curve(self) -> MeshCurve:
        """Transmission advance of the gears over a pitch. Raises NoSolutionError where contact breaks off."""
        if self.like is not None:
            return self.like.curve
        curve = gears_curve(solver_pair(self.pair), self.pair.pitch)
        if curve is None or not curve.whole:
            raise NoSolutionError(self.pair.name, reason="the teeth lose contact within a pitch")
        return curve

    @cached_property
    def errors(self) -> Callable[[Array], Array]:
        """Function from phi1 (N,) to phi2 - ratio phi1 (N,), rad, of the gears. Raises NoSolutionError without contact."""
        if self.like is not None:
            known, (first, second) = self.like.errors, self._turned_from_like
            return lambda phi1: known(phi1 + first) + self.pair.ratio * first - second
        pair, pitch, curve, turns = self.pair, self.pair.pitch, self.curve, self.turns
        if turns is None:
            return lambda phi1: pair.drive * curve.advance(np.mod(phi1, pitch))
        at_zero = pair.drive * float(curve.advance(np.zeros(1))[0])
        whole = turns.pitches * pitch
        phases, errors = np.append(turns.phi1, whole), np.append(turns.te, 0.0)
        return lambda phi1: at_zero + np.interp(np.mod(phi1, whole), phases, errors)

    @cached_property
    def turns(self) -> FullTurns | None:
        """The pair over whole turns, if its members are eccentric or have pitch deviations."""
        return whole_turns(self.pair) if self.pair.eccentric or self.pair.uneven else None

    @property
    def turn_teeth(self) -> tuple[int, int]:
        """Teeth of pinion and gear in a turn; of a rack those on the circle of its pinion that rolls along it."""
        first, second = (round(2.0 * math.pi / member.tooth.pitch_angle) for member in self.pair.both)
        return first, second

    @property
    def slope(self) -> Fraction:
        """Ratio of the rotations about the ports, gear over pinion."""
        first, second = self.turn_teeth
        senses = self.pair.pinion.mount.sign * self.pair.gear.mount.sign * self.pair.ratio
        return Fraction(first, second) * (1 if senses > 0.0 else -1)

    def curve_phi1(self, theta: Array) -> Array:
        """Return the rotation (N,) of the pinion, rad, at which the `curve` knows rotations (N,) about its port."""
        return self.phi1(theta) + (0.0 if self.like is None else self._turned_from_like[0])

    def phi1(self, theta: Array) -> Array:
        """Return phi1 (N,) of the pair at rotations (N,), rad, of the pinion about its port."""
        mount = self.pair.pinion.mount
        return mount.zero + mount.sign * (theta - self.ahead[0])

    def gear(self, theta: Array) -> Array:
        """Return rotations (N,), rad, of the gear about its port from rotations (N,) of the pinion about its port."""
        phi1, mount = self.phi1(theta), self.pair.gear.mount
        phi2 = self.pair.ratio * phi1 + self.errors(phi1)
        turned: Array = self.ahead[1] + mount.sign * (phi2 - mount.zero)
        return turned


@dataclass(frozen=True)
class MeshPath:
    """Meshes from A to B: one, or that of A and a planet and that of the planet and B."""

    meshes: tuple[Mesh, ...]

    def output(self, theta: Array) -> tuple[Array, ...]:
        """Return rotations (N,), rad, of A and of all members that follow it, about their ports."""
        turned = [theta]
        for mesh in self.meshes:
            turned.append(mesh.gear(turned[-1]))
        return tuple(turned)

    @property
    def slope(self) -> Fraction:
        """Nominal slope of the output."""
        slope = Fraction(1)
        for mesh in self.meshes:
            slope *= mesh.slope
        return slope


@dataclass(frozen=True)
class Stage:
    """A stage with its relation."""

    #: name in the file
    name: str
    #: gears of its design
    gears: GearSet
    #: central members
    members: tuple[str, str]
    #: paths from A to B
    paths: tuple[MeshPath, ...]
    #: ports by their names
    ports: Mapping[str, Port]
    #: port that rests: the carrier, with which the housing is meant, in a pair; empty for a differential
    fixed: str

    @staticmethod
    def of(name: str, gears: GearSet) -> Stage:
        """Return the stage of a design. Raises DesignError for gears that are no stage."""
        train = gears.train
        idlers = [member for member in train.members.values() if member.idler]
        central = [member for member in train.members.values() if not member.idler]
        key = f"stages.{name}"
        if len(central) != 2 or train.unpaired or (not idlers and len(train.pairs) != 1):
            raise DesignError(
                key,
                reason=f"{len(central)} members, {len(train.pairs)} of them in mesh",
                allowed="two gears in mesh, or a planetary set",
            )
        for pair in train.pairs:
            if idlers and (pair.eccentric or pair.uneven):
                raise DesignError(
                    key,
                    reason="eccentric members and pitch deviations of planetary sets are not followed over whole turns",
                    allowed="planetary sets without them",
                )
        first, last = (member.name for member in central)
        bases = {member.name: pair.members[member.name].mount.base for member in central for pair in reversed(train.pairs)
                 if member.name in pair.members}  # fmt: skip
        bases |= {member.name: member.mount.base for member in idlers}

        made: list[Mesh] = []
        for number, pair in enumerate(train.pairs):
            ahead = [_turned(bases[member.name].inverse @ member.mount.base) for member in pair.both]
            kind = train.alike[number] if train.alike else number
            made.append(Mesh(pair, (ahead[0], ahead[1]), made[kind] if kind < number else None))
        if idlers:
            paths = tuple(MeshPath(tuple(mesh for mesh in made if idler.name in mesh.pair.members)) for idler in idlers)
        else:
            paths = (MeshPath((made[0],)),)
        ports = {member.name: _port(member, bases[member.name], train.pairs) for member in central}
        if idlers:
            ports[CARRIER_NAME] = Port(CARRIER_NAME, bases[first], np.array([1.0, 0.0, 0.0]), leads_away=False)
        fixed = str(getattr(gears.design, "fixed", CARRIER_NAME)) if idlers else CARRIER_NAME
        return Stage(name, gears, (first, last), paths, ports, fixed)

    @property
    def planetary(self) -> bool:
        """True if there are planets on a carrier."""
        return CARRIER_NAME in self.ports

    @property
    def free(self) -> tuple[str, ...]:
        """Names of the ports that turn."""
        return tuple(name for name in self.ports if name != self.fixed)

    @property
    def slope(self) -> Fraction:
        """Slope of the relation f; all paths have the same."""
        return self.paths[0].slope

    @property
    def meshes(self) -> tuple[Mesh, ...]:
        """All meshes, those of A first."""
        return tuple(path.meshes[k] for k in range(len(self.paths[0].meshes)) for path in self.paths)

    # ---------------------------------------------------------------- nominal motion

    def turns(self, known: Mapping[str, Fraction]) -> dict[str, Fraction]:
        """Return turns of A, B and C, each about its own port, from the turns of two of them [Willis]."""
        first, last = self.members
        turned, slope = dict(known), self.slope
        if CARRIER_NAME not in turned:
            turned[CARRIER_NAME] = (turned[last] - slope * turned[first]) / (1 - slope)
        carrier = turned[CARRIER_NAME]
        if last not in turned:
            turned[last] = carrier + slope * (turned[first] - carrier)
        if first not in turned:
            turned[first] = carrier + (turned[last] - carrier) / slope
        return turned

    def speeds(self, driver: str) -> dict[str, Fraction]:
        """Return turns of A, B and C per turn of the driver, each about its own port; `fixed` is at rest."""
        return self.turns({self.fixed: Fraction(0), driver: Fraction(1)})

    def torques(self, driver: str) -> dict[str, Fraction]:
        """Return torques on A, B and C per torque on the driver without losses, each about its own port.

        Without losses T_A dtheta_A + T_B dtheta_B is 0 in the frame of the carrier, and a set on one axis is in equilibrium.
        """
        first, last = self.members
        own = {first: Fraction(1), last: -1 / self.slope}
        own[CARRIER_NAME] = -sum(own.values(), Fraction(0))
        return {name: torque / own[driver] for name, torque in own.items()}

    def own_sense(self, driver: str) -> int:
        """Return the sense, +1 or -1 about its port, in which a driver loads the flanks that carry in the design."""
        pair = self.paths[0].meshes[0].pair
        torque = self.torques(driver)[self.members[0]]
        return pair.drive * (1 if torque * Fraction(pair.pinion.mount.sign) > 0 else -1)

    def driving(self, driver: str, sense: int) -> Stage:
        """Return the stage on the flanks that carry when a driver turns in a sense, +1 or -1, about its port."""
        if sense == self.own_sense(driver):
            return self
        return replace(self, paths=tuple(MeshPath(tuple(mesh.coast for mesh in path.meshes)) for path in self.paths))

    def gain(self, driven: str) -> float:
        """Return the rotation of a driven port per error of the relation f, both other ports being held.

        It follows from theta_B - theta_C = slope (theta_A - theta_C) + error.
        """
        slope = float(self.slope)
        if driven == self.members[1]:
            return 1.0
        if driven == self.members[0]:
            return -1.0 / slope
        return -1.0 / (1.0 - slope)

    # ---------------------------------------------------------------- exact motion

    def relation(self, theta: Array) -> Array:
        """Return f (N,), rad: the rotation of B from that of A (N,), both in the frame of the carrier."""
        turned = np.stack([path.output(theta)[-1] for path in self.paths])
        last = self.paths[0].meshes[-1].pair
        # paths may count another tooth of B; the path that pushes B farthest carries
        pitch, push = last.gear.tooth.pitch_angle, last.drive * last.gear.mount.sign
        turned = turned - np.round((turned - turned[0]) / pitch) * pitch
        ahead: Array = push * np.max(push * turned, axis=0)
        return ahead

    def follow(self, turned: Mapping[str, Array]) -> dict[str, Array]:
        """Return rotations (N,), rad, of A, B and C about their ports from those of one, or two without a fixed port."""
        first, last = self.members
        known = dict(turned)
        if self.fixed:
            known[self.fixed] = np.zeros_like(next(iter(turned.values())))
        theta = next(iter(known.values()))
        slope = float(self.slope)

        def solve(residual: Callable[[Array], Array], rate: float) -> Array:
            turned = np.zeros_like(theta)
            for _ in range(MAX_ROTATION_ROUNDS):
                step = residual(turned) / rate
                turned = turned - step
                size = max(1.0, float(np.abs(turned).max(initial=0.0)))
                if np.max(np.abs(step), initial=0.0) < ROTATION_TOLERANCE_RAD * size:
                    break
            return turned

        if CARRIER_NAME not in known:
            a, b = known[first], known[last]
            relative = solve(lambda u: u - self.relation(u) - (a - b), 1.0 - slope)
            known[CARRIER_NAME] = a - relative
        carrier = known[CARRIER_NAME]
        if last not in known:
            known[last] = carrier + self.relation(known[first] - carrier)
        if first not in known:
            wanted = known[last] - carrier
            known[first] = carrier + solve(lambda u: self.relation(u) - wanted, slope)
        return known

    def places(self, turned: Mapping[str, float]) -> dict[str, Rigid]:
        """Return transformations from the own frames of all members to the frame of the stage at rotations of the ports (rad)."""
        first = self.members[0]
        carrier = float(turned[CARRIER_NAME])
        axis = self.ports[first].frame
        carried = axis @ Rigid.about_z(carrier) @ axis.inverse
        placed = {name: self.ports[name].frame @ self.ports[name].joint.to(turned[name]) for name in self.members}
        own = np.array([turned[first] - carrier])
        for path in self.paths if self.planetary else ():
            mesh = path.meshes[0]
            idler, angle = mesh.pair.gear, float(path.output(own)[1][0])
            placed[idler.name] = carried @ idler.mount.base @ Rigid.about_z(angle)
        eccentric = {member.name: member.mount.own_to_turning for member in self.gears.train.members.values()}
        return {name: place @ eccentric[name] for name, place in placed.items()}


def _turned(motion: Rigid) -> float:
    """Return the rotation (rad) about z of a motion that is one."""
    return float(np.arctan2(motion.rotation[1, 0], motion.rotation[0, 0]))


def _port(member: Member, frame: Rigid, pairs: tuple[GearPair, ...]) -> Port:
    """Return the port of a central member."""
    pair = next(pair for pair in pairs if member.name in pair.members)
    mate = next(other for other in pair.both if other.name != member.name)
    middle = mate.mount.base.point(np.array([0.0, 0.0, pair.middle(mate)]))
    across = frame.inverse.point(middle) * np.array([1.0, 1.0, 0.0])
    size = float(np.linalg.norm(across))
    beside = not mate.idler and size > 0.0
    towards = across / size if beside else np.array([1.0, 0.0, 0.0])
    return Port(member.name, frame, towards, leads_away=beside, joint=member.tooth.joint)
