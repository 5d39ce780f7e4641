"""Layout of a train: shafts and stages in one frame, and the way of the motion from the input shaft to all others.

The frame of the train is that of the first stage that the input drives. The member through which a shaft is reached gives the shaft
its frame: z is the member's axis. At a rotation psi of its shaft a member has the rotation theta = sense (psi + phase - turn) about
its own axis. The sense is -1 for a reversed member, whose z axis is against the z axis of the shaft.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction

import numpy as np

from gearmesh.design.shown import value_text
from gearmesh.errors import DesignError
from gearmesh.kernel.motion.rigid import MAX_SINE_OF_PARALLEL, Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.trains.file import Seat, ShaftTable, TrainFile, naming_stage
from gearmesh.trains.stage import Port, Stage

#: largest distance, mm, of axes that count as one
MAX_AXIS_DISTANCE_MM = 1e-6
#: half a turn about x: reverses the z axis
HALF_TURN = Rigid(np.diag([1.0, -1.0, -1.0]), np.zeros(3))


@dataclass(frozen=True)
class Seated:
    """A member on its shaft."""

    #: keys of the file
    seat: Seat
    #: rotation (rad) about the shaft of the port's frame
    turn: float = 0.0

    @property
    def name(self) -> str:
        """Stage and member, as in the file."""
        return self.seat.member

    @property
    def stage(self) -> str:
        """Name of the stage."""
        return self.name.partition(".")[0]

    @property
    def port(self) -> str:
        """Name of the port."""
        return self.name.partition(".")[2]

    @property
    def sense(self) -> int:
        """+1 if the z axis of the member is that of the shaft, -1 if it is against it."""
        return -1 if self.seat.reversed else 1

    @property
    def port_to_shaft(self) -> Rigid:
        """Transformation from the frame of the port to that of the shaft."""
        along = Rigid(np.eye(3), np.array([0.0, 0.0, self.seat.position or 0.0]))
        return along @ Rigid.about_z(self.turn) @ (HALF_TURN if self.seat.reversed else Rigid.identity())

    def theta(self, psi: Array) -> Array:
        """Return rotations (N,), rad, of the member about its own axis at rotations (N,) of the shaft."""
        return np.asarray(self.sense * (psi + np.radians(self.seat.phase) - self.turn))

    def psi(self, theta: Array) -> Array:
        """Return rotations (N,), rad, of the shaft at rotations (N,) of the member about its own axis."""
        return np.asarray(self.sense * theta + self.turn - np.radians(self.seat.phase))


@dataclass(frozen=True)
class Shaft:
    """A shaft in the frame of the train."""

    name: str
    #: frame of the shaft to that of the train; z is the axis
    frame: Rigid
    #: members in the order of the file
    members: tuple[Seated, ...]
    #: True if its gears are one body
    joined: bool = False


@dataclass(frozen=True)
class TrainStep:
    """A stage on the way of the motion: which of its members drives, and which follows."""

    stage: Stage
    #: frame of the stage to that of the train
    place: Rigid
    #: shaft and member that drive
    driver: tuple[str, Seated]
    #: shaft and member that follow
    driven: tuple[str, Seated]


@dataclass(frozen=True)
class Layout:
    """Stages and shafts of a train in one frame."""

    file: TrainFile
    #: stages in the order of the motion
    steps: tuple[TrainStep, ...]
    #: shafts by their names, in the order of the file
    shafts: Mapping[str, Shaft]
    #: sense, +1 or -1, in which the input turns about its z axis
    sense: int
    #: turns of all shafts per turn of the input, each right-handed about its own z axis
    speeds: Mapping[str, Fraction]

    @property
    def stages(self) -> dict[str, Stage]:
        """Stages by their names, in the order of the motion."""
        return {step.stage.name: step.stage for step in self.steps}

    def turns(self, psi: Array) -> dict[str, Array]:
        """Return rotations (N,), rad, of all shafts in contact at rotations (N,) of the input shaft."""
        return self.follow(psi)[0]

    def follow(self, psi: Array) -> tuple[dict[str, Array], dict[str, dict[str, Array]]]:
        """Return rotations (N,), rad, in contact at rotations (N,) of the input shaft.

        They are those of all shafts, and of the ports of every stage about their own axes, by its name.
        """
        shafts, ports = {self.file.input: psi}, {}
        for step in self.steps:
            (source, driver), (target, driven) = step.driver, step.driven
            with naming_stage(step.stage.name):
                turned = step.stage.follow(driver.port, driver.theta(shafts[source]))
            shafts[target], ports[step.stage.name] = driven.psi(turned[driven.port]), turned
        return shafts, ports

    def places(self, psi: float) -> dict[str, Rigid]:
        """Return transformations from the own frames of all members, by "stage.member", to the frame of the train.

        The train is in contact at a rotation `psi` (rad) of the input shaft.
        """
        ports = self.follow(np.array([psi]))[1]
        placed: dict[str, Rigid] = {}
        for step in self.steps:
            turned = ports[step.stage.name]
            members = step.stage.places({name: float(theta[0]) for name, theta in turned.items()})
            placed.update((f"{step.stage.name}.{name}", step.place @ own) for name, own in members.items())
        return placed


def layout_of(file: TrainFile, stages: Mapping[str, Stage]) -> Layout:
    """Return the layout of a train.

    Raises DesignError for shafts that name no member, members without a shaft, loops, and shafts that do not coincide.
    """
    owners = _owners(file, stages)
    start = file.input
    frames: dict[str, Shaft] = {}
    steps: list[TrainStep] = []
    # the stage of the first member of the input is the frame of the train
    frames[start] = _shaft(file.shafts[start], stages, Seated(file.shafts[start].seats[0]), Rigid.identity())
    waiting, sense, speeds = [start], 0, {start: Fraction(1)}
    while waiting:
        source = waiting.pop(0)
        for driver in frames[source].members:
            if any(step.stage.name == driver.stage for step in steps):
                continue
            stage = stages[driver.stage]
            place = frames[source].frame @ driver.port_to_shaft @ stage.ports[driver.port].frame.inverse
            other = next(name for name in stage.free if name != driver.port)
            target = owners[f"{stage.name}.{other}"]
            own = next(seat for seat in file.shafts[target].seats if seat.member == f"{stage.name}.{other}")
            if target in frames:
                raise _loop(stage, other, target, place, frames[target])
            frames[target] = _shaft(file.shafts[target], stages, Seated(own), place)
            driven = next(member for member in frames[target].members if member.name == own.member)
            # the input turns as the flanks of its first stage ask for
            if not sense:
                sense = stage.own_sense(driver.port) * driver.sense * (-1 if file.keys.reverse else 1)
            turning = 1 if sense * speeds[source] > 0 else -1
            speeds[target] = speeds[source] * driver.sense * stage.speeds(driver.port)[other] * driven.sense
            steps.append(
                TrainStep(stage.driving(driver.port, turning * driver.sense), place, (source, driver), (target, driven))
            )
            waiting.append(target)
    for name in file.shafts:
        if name not in frames:
            raise DesignError(f"shafts.{name}", reason=f"no stage connects it to the shaft {start}, which drives")
    shafts = {name: frames[name] for name in file.shafts}
    _check_coaxial(file, shafts)
    return Layout(file, tuple(steps), shafts, sense, speeds)


def _owners(file: TrainFile, stages: Mapping[str, Stage]) -> dict[str, str]:
    """Return the shaft of every turning member. Raises DesignError for members that are on no shaft, or on two, or not there."""
    known = [f"{stage.name}.{port}" for stage in stages.values() for port in stage.free]
    owners: dict[str, str] = {}
    for shaft in file.shafts.values():
        key = f"shafts.{shaft.name}.members"
        for number, seat in enumerate(shaft.seats):
            word = seat.member
            stage = stages.get(word.partition(".")[0])
            if word not in known:
                rests = stage is not None and word == f"{stage.name}.{stage.fixed}"
                reason = "it is fixed, and turns with no shaft" if rests else "no member of a stage that turns"
                raise DesignError(
                    key, word, shown=value_text(word), reason=reason, allowed=f"one of {', '.join(known)}"
                )
            if word in owners:
                raise DesignError(
                    key, word, shown=value_text(word), reason=f"it is on the shaft {owners[word]} already"
                )
            if number and seat.position is None:
                where = "its place along the shaft, beside that of the first member"
                raise DesignError(f"{key}.{word}.position", reason="missing", allowed=where)
            owners[word] = shaft.name
    for word in known:
        if word not in owners:
            raise DesignError(f"stages.{word}", reason="it is on no shaft: a shaft of its own is a table, as "
                              f'[shafts.output] with members = ["{word}"]')  # fmt: skip
    return owners


def _shaft(table: ShaftTable, stages: Mapping[str, Stage], reached: Seated, place: Rigid) -> Shaft:
    """Return a shaft that was reached through a member of a stage at its place in the frame of the train."""
    own_port = stages[reached.stage].ports[reached.port]
    frame = place @ own_port.frame @ reached.port_to_shaft.inverse
    # a stage at turn 0 leads straight on, away from the mating gear of the member through which the shaft was reached
    away = reached.sense * _direction(own_port) + np.pi if own_port.leads_away else 0.0
    members = []
    for seat in table.seats:
        if seat.member == reached.name:
            members.append(reached)
            continue
        bare = Seated(seat)
        turn = away + np.radians(seat.turn) - bare.sense * _direction(stages[bare.stage].ports[bare.port])
        members.append(replace(bare, turn=float(turn)))
    return Shaft(table.name, frame, tuple(members), table.keys.joined)


def _direction(port: Port) -> float:
    """Return the angle (rad) of the direction to the mating gear in the frame of the port."""
    return float(np.arctan2(port.towards[1], port.towards[0]))


def _loop(stage: Stage, port: str, target: str, place: Rigid, shaft: Shaft) -> DesignError:
    """Return the refusal of a stage whose both members are on shafts that other stages have placed."""
    where = place @ stage.ports[port].frame
    apart, angle = _misfit(where, shaft.frame)
    if apart > MAX_AXIS_DISTANCE_MM or angle > MAX_SINE_OF_PARALLEL:
        by = f"{apart:.6g} mm and {np.degrees(angle):.6g} deg apart"
        reason = f"its axis does not coincide with that of {stage.name}.{port}: {by}"
    else:
        reason = f"{stage.name}.{port} closes a loop: the shaft is driven by two stages"
    return DesignError(f"shafts.{target}", reason=reason, allowed="every shaft but the input driven by one stage")


def _misfit(first: Rigid, second: Rigid) -> tuple[float, float]:
    """Return distance, mm, and acute angle, rad, of the z axes of two frames; that of parallel axes, else of the first origin."""
    a, b = first.rotation[:, 2], second.rotation[:, 2]
    between = second.translation - first.translation
    angle = float(np.arctan2(np.linalg.norm(np.cross(a, b)), abs(float(a @ b))))
    return float(np.linalg.norm(between - (between @ b) * b)), angle


def _check_coaxial(file: TrainFile, shafts: Mapping[str, Shaft]) -> None:
    """Refuse shafts that are not on the axes that the file asks for."""
    for name, shaft in shafts.items():
        other = file.shafts[name].keys.coaxial
        if other is None:
            continue
        key = f"shafts.{name}.coaxial"
        if other not in shafts or other == name:
            allowed = ", ".join(known for known in shafts if known != name)
            raise DesignError(key, other, shown=value_text(other), must_be=f"one of {allowed}")
        apart, angle = _misfit(shafts[other].frame, shaft.frame)
        if apart > MAX_AXIS_DISTANCE_MM or angle > MAX_SINE_OF_PARALLEL:
            raise DesignError(
                key,
                other,
                shown=value_text(other),
                reason=f"the shafts do not coincide: their axes are {apart:.6g} mm and {np.degrees(angle):.6g} deg apart",
                allowed="another turn of a stage, or other centre distances",
            )


def stages_of(file: TrainFile) -> dict[str, Stage]:
    """Build the stages of a train. Refusals begin with the name of the stage."""
    from gearmesh.answers.bodies.questions import ModelledGears

    made = {}
    for name, design in file.stages.items():
        with naming_stage(name):
            made[name] = Stage.of(name, ModelledGears(design))
    return made
