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
from gearmesh.trains.stage import CARRIER_NAME, Port, Stage

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

    #: name in the file
    name: str
    #: frame of the shaft to that of the train; z is the axis
    frame: Rigid
    #: members in the order of the file
    members: tuple[Seated, ...]
    #: True if its gears are one body
    joined: bool = False


@dataclass(frozen=True)
class TrainStep:
    """A stage on the way of the motion: which of its members drive, and which follows."""

    #: stage with its numbers of teeth and its ports
    stage: Stage
    #: frame of the stage to that of the train
    place: Rigid
    #: shafts and members that drive: one, or two of a differential; the first carries the power
    drivers: tuple[tuple[str, Seated], ...]
    #: shaft and member that follow
    driven: tuple[str, Seated]
    #: turns of the ports per turn of the input, each about its own axis
    speeds: Mapping[str, Fraction]
    #: True if another stage drives the same shaft, so that the stage closes a loop
    closes_loop: bool = False

    @property
    def driver(self) -> tuple[str, Seated]:
        """The driving shaft and member; the first of a differential."""
        return self.drivers[0]

    @property
    def ends(self) -> tuple[tuple[str, Seated], ...]:
        """Shafts and members that drive, and the shaft and the member that follow."""
        return (*self.drivers, self.driven)

    @property
    def relative_speed(self) -> Fraction:
        """Turns of A in the frame of the carrier per turn of the input."""
        return self.speeds[self.stage.members[0]] - self.speeds[CARRIER_NAME]

    def rate(self, driver: Seated) -> float:
        """Return the turns of the driven shaft per turn of the shaft of a driver, the other driver being held."""
        (_, driven), held = self.driven, [other.port for _, other in self.drivers if other is not driver]
        stage = replace(self.stage, fixed=held[0]) if held else self.stage
        return driver.sense * float(stage.speeds(driver.port)[driven.port]) * driven.sense


@dataclass(frozen=True)
class Layout:
    """Stages and shafts of a train in one frame."""

    #: the file of the train
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

    def port(self, shaft: str) -> Port:
        """Return the port of the first member of a shaft."""
        seated = self.shafts[shaft].members[0]
        return self.stages[seated.stage].ports[seated.port]

    def turns(self, psi: Array) -> dict[str, Array]:
        """Return rotations (N,), rad, of all shafts in contact at rotations (N,) of the input shaft."""
        return self.follow(psi)[0]

    def follow(self, psi: Array) -> tuple[dict[str, Array], dict[str, dict[str, Array]]]:
        """Return rotations (N,), rad, in contact at rotations (N,) of the input shaft.

        They are those of all shafts, and of the ports of every stage about their own axes, by its name.
        """
        given = {name: float(speed) for name, speed in _given_speeds(self.file).items()}
        shafts, ports = {name: speed * psi for name, speed in given.items()}, {}
        for step in self.steps:
            known = {driver.port: driver.theta(shafts[source]) for source, driver in step.drivers}
            with naming_stage(step.stage.name):
                turned = step.stage.follow(known)
            target, driven = step.driven
            shafts.setdefault(target, driven.psi(turned[driven.port]))
            ports[step.stage.name] = turned
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

    Raises DesignError for shafts that name no member, members without a shaft, shafts that do not coincide, and speeds that
    contradict each other or do not follow.
    """
    stages = {name: _unfixed(stage, file) for name, stage in stages.items()}
    owners = _owners(file, stages)
    _check_racks(file, stages, owners)
    shafts, places = _placed(file, stages, owners)
    for name in file.shafts:
        if name not in shafts:
            raise DesignError(f"shafts.{name}", reason=f"no stage connects it to the shaft {file.input}, which drives")
    shafts = {name: shafts[name] for name in file.shafts}
    _check_coaxial(file, shafts)
    steps, speeds, sense = _in_motion(file, {name: stages[name] for name in places}, places, owners, shafts)
    layout = Layout(file, steps, shafts, sense, speeds)
    return _timed(layout) if any(step.closes_loop for step in steps) else layout


def _unfixed(stage: Stage, file: TrainFile) -> Stage:
    """Return a stage without a fixed member if all its members are on shafts: a differential."""
    seated = {seat.member for shaft in file.shafts.values() for seat in shaft.seats}
    all_on_shafts = stage.planetary and all(f"{stage.name}.{port}" in seated for port in stage.ports)
    return replace(stage, fixed="") if all_on_shafts else stage


def _placed(
    file: TrainFile, stages: Mapping[str, Stage], owners: Mapping[str, str]
) -> tuple[dict[str, Shaft], dict[str, Rigid]]:
    """Return the shafts that stages connect to the input, and the frames of these stages, from the input on."""
    start = file.input
    # the stage of the first member of the input is the frame of the train
    first = Seated(file.shafts[start].seats[0])
    shafts = {start: _shaft(file.shafts[start], stages, first, Rigid.identity())}
    waiting, places = [start], dict[str, Rigid]()
    while waiting:
        source = waiting.pop(0)
        for driver in shafts[source].members:
            stage = stages[driver.stage]
            if stage.name in places:
                continue
            place = shafts[source].frame @ driver.port_to_shaft @ stage.ports[driver.port].frame.inverse
            places[stage.name] = place
            for other in stage.free:
                target = owners[f"{stage.name}.{other}"]
                if other == driver.port:
                    continue
                if target in shafts:
                    shafts[target] = _met_again(stage, other, target, place, shafts[target])
                    continue
                own = next(seat for seat in file.shafts[target].seats if seat.member == f"{stage.name}.{other}")
                shafts[target] = _shaft(file.shafts[target], stages, Seated(own), place)
                waiting.append(target)
    return shafts, places


def _given_speeds(file: TrainFile) -> dict[str, Fraction]:
    """Return the turns of the shafts that the file drives, per turn of the input."""
    given = {
        name: Fraction(str(shaft.keys.speed)) for name, shaft in file.shafts.items() if shaft.keys.speed is not None
    }
    if file.input in given:
        raise DesignError(
            f"shafts.{file.input}.speed",
            float(given[file.input]),
            reason="the speeds of other shafts are per turn of it",
        )
    return {file.input: Fraction(1), **given}


def _in_motion(
    file: TrainFile,
    stages: Mapping[str, Stage],
    places: Mapping[str, Rigid],
    owners: Mapping[str, str],
    shafts: Mapping[str, Shaft],
) -> tuple[tuple[TrainStep, ...], dict[str, Fraction], int]:
    """Return the stages in the order of the motion, the turns of all shafts per turn of the input, and its sense.

    A stage follows when one of its shafts moves, a differential when two do. Raises DesignError for speeds that contradict each
    other, and for shafts that no speed reaches.
    """
    given = _given_speeds(file)
    speeds, sense, steps, pending = dict(given), 0, list[TrainStep](), dict(stages)
    while pending:
        stage, known = _next_stage(pending, owners, speeds)
        del pending[stage.name]
        seated = {
            port: (owners[f"{stage.name}.{port}"], _seated(shafts, owners, f"{stage.name}.{port}"))
            for port in stage.free
        }
        moving = known[: len(stage.free) - 1]
        # power enters where a shaft turns, not where it is held
        moving.sort(key=lambda port: speeds[seated[port][0]] == 0)
        turns = {port: seated[port][1].sense * speeds[seated[port][0]] for port in moving}
        turns = stage.turns({**turns, **({stage.fixed: Fraction(0)} if stage.fixed else {})})
        (driven,) = (port for port in stage.free if port not in moving)
        target, follower = seated[driven]
        speed, own = turns[driven] * follower.sense, moving[0]
        source, driver = seated[own]
        if not sense:
            # the input turns as the flanks of its first stage ask for
            sense = stage.own_sense(own) * driver.sense * (-1 if file.keys.reverse else 1)
        if driven in known and target in given:
            reason = f"{stage.name}.{driven} gives the shaft a speed of {speed}"
            raise DesignError(f"shafts.{target}.speed", float(speeds[target]), reason=reason, allowed="left out")
        if speeds.setdefault(target, speed) != speed:
            raise _contradiction(file, stage, driven, target, speed, speeds[target])
        turning = 1 if sense * speeds[source] > 0 else -1
        steps.append(
            TrainStep(
                stage.driving(own, turning * driver.sense),
                places[stage.name],
                tuple(seated[port] for port in moving),
                seated[driven],
                turns,
                closes_loop=driven in known,
            )
        )
    return tuple(steps), speeds, sense


def _next_stage(
    pending: Mapping[str, Stage], owners: Mapping[str, str], speeds: Mapping[str, Fraction]
) -> tuple[Stage, list[str]]:
    """Return the first stage that moves, and its ports whose shafts have a speed, in the order of these shafts.

    Raises DesignError where none moves.
    """
    order, lacking = list(speeds), ""
    for stage in pending.values():
        shafts = {port: owners[f"{stage.name}.{port}"] for port in stage.free}
        known = sorted((port for port in shafts if shafts[port] in speeds), key=lambda port: order.index(shafts[port]))
        if len(known) >= len(stage.free) - 1:
            return stage, known
        if known and not lacking:
            lacking = next(shafts[port] for port in shafts if port not in known)
    raise DesignError(
        f"shafts.{lacking}.speed",
        reason="missing: a differential, all members of which turn, needs the speeds of two shafts",
        allowed="turns per turn of the input, 0 for a shaft that is held",
    )


def _seated(shafts: Mapping[str, Shaft], owners: Mapping[str, str], word: str) -> Seated:
    """Return a member on its shaft."""
    return next(member for member in shafts[owners[word]].members if member.name == word)


def _contradiction(
    file: TrainFile, stage: Stage, port: str, target: str, speed: Fraction, known: Fraction
) -> DesignError:
    """Return the refusal of a stage that would turn a shaft at another speed than the shaft has."""
    reason = f"{stage.name}.{port} would turn it {speed} times per turn of {file.input}, another stage or its speed {known} times"
    return DesignError(f"shafts.{target}", reason=reason, allowed="tooth numbers with which both ways have one ratio")


def _timed(layout: Layout) -> Layout:
    """Return a layout in which the members that close loops have the phases on their shafts with which their teeth mesh.

    Of all such phases, a pitch apart, it is the one next to the `phase` of the file.
    """
    turned, ports = layout.follow(np.zeros(1))
    shafts, steps = dict(layout.shafts), list(layout.steps)
    for number, step in enumerate(layout.steps):
        if not step.closes_loop:
            continue
        target, seated = step.driven
        apart = float((seated.psi(ports[step.stage.name][seated.port]) - turned[target])[0])
        teeth = step.stage.gears.train.members.get(seated.port)
        pitch = 2.0 * np.pi / (1 if teeth is None else teeth.tooth.teeth)
        phase = seated.seat.phase + float(np.degrees(apart - np.round(apart / pitch) * pitch))
        moved = replace(seated, seat=seated.seat.model_copy(update={"phase": phase}))
        members = tuple(moved if member is seated else member for member in shafts[target].members)
        shafts[target] = replace(shafts[target], members=members)
        steps[number] = replace(step, driven=(target, moved))
    return replace(layout, steps=tuple(steps), shafts=shafts)


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


def _check_racks(file: TrainFile, stages: Mapping[str, Stage], owners: Mapping[str, str]) -> None:
    """Refuse racks that drive, and keys and members of their shafts that are for shafts that turn."""
    for word, name in owners.items():
        stage, _, port = word.partition(".")
        if not stages[stage].ports[port].slides:
            continue
        shaft, key = file.shafts[name], f"shafts.{name}"
        if name == file.input:
            turning = [other for other in file.shafts if other != name]
            reason = f"the rack of {stage} slides, and drives no train"
            raise DesignError("input", name, reason=reason, allowed=f"one of {', '.join(turning)}")
        if len(shaft.seats) > 1:
            others = ", ".join(seat.member for seat in shaft.seats if seat.member != word)
            reason = f"the rack of {stage} slides, and {others} would turn"
            raise DesignError(f"{key}.members", reason=reason, allowed=f'["{word}"]')
        if shaft.seats[0].phase:
            raise DesignError(f"{key}.members.{word}.phase", shaft.seats[0].phase, must_be="0 for a rack, which slides")
        if shaft.keys.speed is not None:
            raise DesignError(f"{key}.speed", shaft.keys.speed, must_be="left out for a rack, which slides")


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


def _met_again(stage: Stage, port: str, target: str, place: Rigid, shaft: Shaft) -> Shaft:
    """Return a shaft that another stage has placed, with the member of this stage turned as the stage stands.

    Raises DesignError for a member that is not on the axis of the shaft, or elsewhere along it than the file says.
    """
    apart, angle = _misfit(place @ stage.ports[port].frame, shaft.frame)
    if apart > MAX_AXIS_DISTANCE_MM or angle > MAX_SINE_OF_PARALLEL:
        by = f"{apart:.6g} mm and {np.degrees(angle):.6g} deg apart"
        reason = f"its axis does not coincide with that of {stage.name}.{port}: {by}"
        raise DesignError(
            f"shafts.{target}", reason=reason, allowed="stages that meet on one axis, by turn or centre distance"
        )
    (seated,) = (member for member in shaft.members if member.name == f"{stage.name}.{port}")
    there = shaft.frame.inverse @ place @ stage.ports[port].frame
    key, position = f"shafts.{target}.members.{seated.name}", seated.seat.position or 0.0
    if (there.rotation[2, 2] < 0.0) != seated.seat.reversed:
        raise DesignError(f"{key}.reversed", seated.seat.reversed, allowed=str(not seated.seat.reversed).lower())
    if abs(there.translation[2] - position) > MAX_AXIS_DISTANCE_MM:
        where = f"{there.translation[2]:.10g} mm, where its stage is"
        raise DesignError(f"{key}.position", position, unit="mm", allowed=where)
    turned = replace(seated, turn=float(np.arctan2(there.rotation[1, 0], there.rotation[0, 0])))
    return replace(shaft, members=tuple(turned if member is seated else member for member in shaft.members))


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
