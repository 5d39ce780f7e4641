"""A train of several stages: kinematics, positions, bodies, pictures and transmission error of the output."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from functools import cached_property
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmesh.answers.gearset import refuse_rotation
from gearmesh.answers.result import Result, columns, header
from gearmesh.answers.tables import Listing, csv_text, round_to
from gearmesh.arguments import checks_arguments, checks_methods
from gearmesh.design.files import override
from gearmesh.figures import ZERO_SIZES, Content, Figures, figure
from gearmesh.formats import CSV_SUFFIX, JSON_SUFFIX
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.lengths import Length, tolerance_in_mm
from gearmesh.records import dataclass
from gearmesh.trains.file import TrainFile, read_train, train_of
from gearmesh.trains.layout import Layout, TrainStep, layout_of, stages_of
from gearmesh.trains.stage import CARRIER_NAME, Mesh, Stage
from gearmesh.trains.transmission import ShaftError, mesh_motions, output_error

if TYPE_CHECKING:
    from gearmesh.answers.bodies.cad import Cad
    from gearmesh.answers.bodies.solid import Solids
    from gearmesh.kernel.motion.rigid import Rigid
    from gearmesh.progress import Progress
    from gearmesh.reports.report import ReportPage
    from gearmesh.study.study import Study
    from gearmesh.view.picture import Diagram, Picture
    from gearmesh.view.report.card import CardFigure
    from gearmesh.view.scene import Scene

#: width and height of a picture, pixels
PICTURE_SIZE = (1600, 1200)
#: coordinates of an axis that differ from 0 by less are 0
AXIS_ROUNDING = 1e-12
#: phase (pitches) below which a mesh is at the beginning of a pitch
SAME_PHASE_PITCHES = 1e-9


@dataclass(frozen=True)
class ShaftFigures(Figures):
    """A shaft of a train: speed and torque per those of the input, and its axis."""

    shaft: str = figure("name of the shaft")
    members: str = figure("members on it")
    speed: float = figure(
        "turns per turn of the input, positive right-handed about the axis; of a rack those of its pinion's circle",
        "",
        "n",
    )
    speed_fraction: str = figure("the same as a ratio of whole numbers")
    torque: float = figure("torque on its driven side per torque on the input, without losses", "", "T")
    travel: float | None = figure(
        "travel of a rack along the y axis of its shaft per turn of the input", "mm", "s", optional=True
    )
    force: float | None = figure("force of a rack per Nm on the input, without losses", "N", "F", optional=True)
    axis: list[float] = figure("direction of its z axis, frame of the train", vector=True)
    origin: list[float] = figure("a point of its axis, frame of the train", "mm", vector=True)


@dataclass(frozen=True)
class TrainMeshFigures(Figures):
    """A mesh of a train: teeth, hunting, and phase."""

    stage: str = figure("name of the stage")
    mesh: str = figure("members")
    teeth: list[int] = figure("teeth of both members", whole=True, singular="teeth", symbol="z")
    common_factor: int = figure("greatest common divisor of the tooth numbers", whole=True)
    hunting: bool = figure("whether every tooth of one member meets every tooth of the other")
    turns_until_repeat: float | None = figure("turns of the input until the same two teeth meet again; none of a rack")
    teeth_per_turn: float = figure("tooth pairs that pass per turn of the input: the order of the mesh")
    phase: float = figure("part of a pitch since the contact of a tooth pair began, input at 0", "")


@dataclass(frozen=True)
class TrainFigures(Figures):
    """A train as a whole."""

    input: str = figure("name of the driving shaft")
    output: str = figure("name of the driven shaft")
    ratio: float | None = figure(
        "speed of the input over that of the output, negative if their senses differ; none if the output rests or slides",
        "",
        "i",
    )
    ratio_fraction: str = figure("the same as a ratio of whole numbers")
    input_sense: int = figure("sense in which the input turns about its z axis, 1 right-handed", whole=True)
    turns_until_repeat: float = figure("turns of the input until all teeth of gears that turn are where they were")
    travel: float | None = figure("travel of a rack on the output per turn of the input", "mm", "s", optional=True)


@dataclass(frozen=True)
class TrainErrorFigures(Figures):
    """Transmission error of the output of a train."""

    output: str = figure("name of the shaft")
    turns: float = figure("turns of the input")
    te_peak_to_peak: float = figure("transmission error of the shaft, peak to peak", "arcsec")
    way_te_peak_to_peak: float | None = figure(
        "transmission error of a rack along its travel, peak to peak", "um", key="te_peak_to_peak_um", optional=True
    )
    stage_te_peak_to_peak: Mapping[str, float] = figure(
        "share of a stage, peak to peak, at the shaft", "arcsec", key="te_peak_to_peak_{member}_arcsec"
    )


@dataclass(frozen=True, repr=False)
class TrainError(Result):
    """Transmission error of a shaft of a train: the sum of the errors of the stages before it, with their phases."""

    #: the train
    train: MultistageTrain
    #: name of the shaft
    shaft: str
    #: errors over rotations of the input
    solved: ShaftError

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX, CSV_SUFFIX)

    @cached_property
    def figures(self) -> TrainErrorFigures:
        """Sizes of the error."""
        return TrainErrorFigures(
            self.shaft,
            float(self.solved.psi[-1]) / (2.0 * math.pi),
            float(np.ptp(self.solved.te)) / ARCSEC,
            self.train.layout.port(self.shaft).joint.way(1e3 * float(np.ptp(self.solved.te))),
            {stage: float(np.ptp(part)) / ARCSEC for stage, part in self.solved.parts.items()},
        )

    @property
    def reading(self) -> tuple[float, str]:
        """Rad in the unit in which the error is shown, and the unit: "um" of a rack, otherwise "arcsec"."""
        return self.train.layout.port(self.shaft).joint.reading.error

    def _in_unit(self, error: Array) -> Array:
        """Return errors (P,), rad, in the unit in which they are shown."""
        return np.asarray(error / self.reading[0])

    @property
    def _size(self) -> str:
        """Peak to peak with its unit, in words; 0 for rounding."""
        size, unit = float(np.ptp(self._in_unit(self.solved.te))), self.reading[1]
        return f"{size if size >= ZERO_SIZES[unit] else 0.0:.4g} {unit} peak to peak"

    @property
    def headline(self) -> str:
        return f"{self.shaft}: TE {self._size} over {self.figures.turns:.4g} turns of the input"

    @property
    def listings(self) -> list[Listing]:
        errors = {**self.solved.parts, "all stages": self.solved.te}
        rows = [[stage, round_to(float(np.ptp(self._in_unit(error))), 4)] for stage, error in errors.items()]
        return [
            Listing(
                f"Transmission error of the shaft {self.shaft}",
                ("stage", f"peak to peak {self.reading[1]}"),
                rows,
                notes=[f"over {self.figures.turns:.6g} turns of the input"],
            )
        ]

    def to_dict(self) -> dict[str, list[Any]]:
        parts = {f"te_{stage}_arcsec": (part / ARCSEC).tolist() for stage, part in self.solved.parts.items()}
        degrees = np.degrees(self.solved.psi).round(10).tolist()
        slid = {"te_um": self._in_unit(self.solved.te).tolist()} if self.train.layout.port(self.shaft).slides else {}
        return {"input_deg": degrees, "te_arcsec": (self.solved.te / ARCSEC).tolist(), **slid, **parts}

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**self.train.sections, "transmission_error": self.figures, "positions": self.to_dict()}

    def csv(self) -> str:
        """The errors at all positions as CSV text.

        Returns
        -------
        str
            One row per position.

        Examples
        --------
        >>> error = gm.load_train("samples/trains/train_two_stage.toml").transmission_error(turns=0.1)
        >>> error.csv().splitlines()[0]
        'input_deg,te_arcsec,te_first_arcsec,te_second_arcsec'
        """
        table = self.to_dict()
        return csv_text([dict(zip(table, row, strict=True)) for row in zip(*table.values(), strict=True)])

    def _write(self, target: Path) -> None:
        from gearmesh.io import whole_text

        whole_text(target, self.csv())


@checks_methods
class MultistageTrain(Result):
    """A train of several stages on common shafts, as `load_train` reads it.

    Everything is computed at its first use. Rotations of the input are in deg, from the position at which the members of the input
    shaft have their `phase`.
    """

    def __init__(self, file: TrainFile, notes: tuple[str, ...] = (), stages: Mapping[str, Stage] | None = None) -> None:
        """Keep the train as its file states it, with notes of its reader, and its stages if they are known."""
        self.file, self.notes, self._stages = file, notes, stages

    @cached_property
    def layout(self) -> Layout:
        """Stages and shafts in one frame. Raises DesignError for shafts and stages that make no train."""
        return layout_of(self.file, stages_of(self.file) if self._stages is None else self._stages)

    @property
    def title(self) -> str:
        """Title for pages and pictures."""
        return self.file.title

    @property
    def warnings(self) -> tuple[str, ...]:
        """Notes on the file, and warnings about the gears of all stages, one line each."""
        stages = self.layout.stages
        return (*self.notes, *(f"{name}: {line}" for name, stage in stages.items() for line in stage.gears.warnings))

    # ---------------------------------------------------------------- kinematics

    @cached_property
    def figures(self) -> TrainFigures:
        """Figures of the whole train."""
        speeds, output = self.layout.speeds, self.file.output
        port = self.layout.port(output)
        ratio = 1 / speeds[output] if speeds[output] and not port.slides else None
        within = (motion.pinion_turns for step in self.layout.steps for motion in mesh_motions(step))
        whole = math.lcm(*(speed.denominator for speed in (*speeds.values(), *within)))
        return TrainFigures(
            self.file.input,
            output,
            None if ratio is None else float(ratio),
            _words(ratio) if ratio is not None else "none" if port.slides else "infinite",
            self.layout.sense,
            float(whole),
            port.joint.way(2.0 * math.pi * float(speeds[output])),
        )

    @cached_property
    def shafts(self) -> tuple[ShaftFigures, ...]:
        """Speed, torque and axis of every shaft."""
        torques = self._torques()
        return tuple(
            ShaftFigures(
                name,
                ", ".join(member.name for member in shaft.members),
                float(self.layout.speeds[name]),
                _words(self.layout.speeds[name]),
                float(torques[name]),
                self.layout.port(name).joint.way(2.0 * math.pi * float(self.layout.speeds[name])),
                self.layout.port(name).joint.force(1e3 * float(torques[name])),
                _coordinates(shaft.frame.rotation[:, 2]),
                _coordinates(shaft.frame.translation),
            )
            for name, shaft in self.layout.shafts.items()
        )

    def _torques(self) -> dict[str, Fraction]:
        """Return the torque with which each shaft is driven per torque on the input.

        Where equilibrium does not tell how ways share the torque, it is that of the first way, all others being idle.
        """
        return self._torques_in_equilibrium() or self._torques_of_first_ways()

    def _torques_in_equilibrium(self) -> dict[str, Fraction] | None:
        """Return the torques of `_torques` if the equilibrium of all shafts alone gives them; None otherwise.

        Unknown is one torque for each stage, whose ports have torques in fixed ratios. The torques of a stage about the z
        axes of its shafts, on the stage, add up to 0 on a shaft between stages, and to 1 on the input.
        """
        from gearmesh.kernel.numeric.fractions import solve_fractions

        steps = self.layout.steps
        # torques (stage, shaft) per unknown of the stage
        loads: dict[str, dict[int, Fraction]] = {name: {} for name in self.layout.shafts}
        for number, step in enumerate(steps):
            torques = step.stage.torques(step.driver[1].port)
            for shaft, seated in step.ends:
                loads[shaft][number] = torques[seated.port] * seated.sense
        given = {name for name, shaft in self.file.shafts.items() if shaft.keys.speed is not None}
        balanced = [name for name, on in loads.items() if len(on) > 1 and name not in given | {self.file.output}]
        rows = [name for name in balanced if name != self.file.input]
        matrix = [[loads[name].get(k, Fraction(0)) for k in range(len(steps))] for name in (self.file.input, *rows)]
        scale = solve_fractions(matrix, [Fraction(1), *[Fraction(0)] * len(rows)])
        if scale is None:
            return None
        found = {}
        for name, on in loads.items():
            driving = [k for k, step in enumerate(steps) if step.driven[0] == name]
            sums = sum((on[k] * scale[k] for k in driving or on), Fraction(0))
            found[name] = -sums if driving else sums
        return found

    def _torques_of_first_ways(self) -> dict[str, Fraction]:
        """Return the torques of `_torques` where all but the first way to a shaft are idle."""
        known = {self.file.input: Fraction(1)}
        waiting = [step for step in self.layout.steps if not step.closes_loop]
        while waiting:
            step = next(step for step in waiting if any(shaft in known for shaft, _ in step.ends))
            waiting.remove(step)
            # torques on the ports of a stage have fixed ratios; what drives the driven shaft is against the torque on its port
            shaft, seated = next(end for end in step.ends if end[0] in known)
            sense = {shaft: -1 if (shaft, seated) == step.driven else 1 for shaft, seated in step.ends}
            own = known[shaft] * sense[shaft] * seated.sense
            torques = step.stage.torques(seated.port)
            for name, other in step.ends:
                known.setdefault(name, own * torques[other.port] * sense[name] * other.sense)
        return known

    @cached_property
    def meshes(self) -> tuple[TrainMeshFigures, ...]:
        """Hunting and phase of every mesh, with the input at 0."""
        start = self.layout.follow(np.zeros(1))[1]
        found = []
        for step in self.layout.steps:
            turned = start[step.stage.name]
            phases = self._phases(step, turned[step.stage.members[0]] - turned[CARRIER_NAME])
            for mesh, motion, phase in zip(step.stage.meshes, mesh_motions(step), phases, strict=True):
                teeth = [member.tooth.teeth for member in mesh.pair.both]
                # a tooth of a rack always meets the same tooth of its pinion
                common = math.gcd(*mesh.turn_teeth)
                until = Fraction(teeth[1], common) / motion.pinion_turns if motion.pinion_turns else math.inf
                again = None if math.isinf(mesh.pair.gear.tooth.joint.cycle(1)) else float(until)
                found.append(TrainMeshFigures(step.stage.name, mesh.pair.name, teeth, common, common == 1,
                                              again, float(motion.teeth), phase))  # fmt: skip
        return tuple(found)

    def _phases(self, step: TrainStep, relative: Array) -> list[float]:
        """Return the phases of all meshes of a stage at a rotation (1,), rad, of A in the frame of the carrier."""
        own = [path.output(relative) for path in step.stage.paths]
        turning = self.layout.sense * step.relative_speed
        sense = step.stage.meshes[0].pair.pinion.mount.sign * (1 if turning > 0 else -1)
        return [
            _phase(path.meshes[k], float(turned[k][0]), sense)
            for k in range(len(step.stage.paths[0].meshes))
            for path, turned in zip(step.stage.paths, own, strict=True)
        ]

    # ---------------------------------------------------------------- as a result

    @property
    def headline(self) -> str:
        return f"{self.title}: {self._summary}"

    @property
    def _summary(self) -> str:
        """Number of stages, and ratio."""
        values = self.figures
        return f"{len(self.file.stages)} stages, {_ratio_text(values, 6)}"

    @property
    def listings(self) -> list[Listing]:
        values = self.figures
        sense = "right-handed" if values.input_sense > 0 else "left-handed"
        shafts, slid = [], any(self.layout.port(own.shaft).slides for own in self.shafts)
        for own in self.shafts:
            turning = [round_to(own.speed, 6), own.speed_fraction, round_to(own.torque, 4)]
            sliding = (
                [f"{own.travel:.6g} mm", "slides", f"{own.force:.4g} N"] if self.layout.port(own.shaft).slides else []
            )
            shafts.append([own.shaft, own.members, *(sliding or turning), _vector(own.axis)])
        slides = (
            ["a rack: mm of travel along y of its shaft per turn of the input, N per Nm on the input"] if slid else []
        )
        meshes = [
            [
                f"{own.stage}: {own.mesh}",
                "/".join(map(str, own.teeth)),
                own.common_factor,
                None if own.turns_until_repeat is None else round_to(own.turns_until_repeat, 4),
                round_to(own.teeth_per_turn, 4),
                round_to(own.phase, 4),
            ]
            for own in self.meshes
        ]
        return [
            Listing(
                self.title,
                ("shaft", "members", "speed", "= n/n_in", "torque", "axis"),
                shafts,
                notes=[
                    f"ratio {values.input} to {values.output}: {_ratio_text(values, 7)}".replace(": ratio ", ": "),
                    f"the input turns {sense} about its axis; speeds and torques are per those of the input, without losses",
                    f"all teeth{' of gears that turn' if slid else ''} are where they were after "
                    f"{values.turns_until_repeat:.10g} turns of the input",
                    *slides,
                ],
            ),
            Listing(
                "Meshes",
                ("mesh", "teeth", "common factor", "turns", "order", "phase"),
                meshes,
                notes=[
                    "turns: of the input until the same two teeth meet again; order: tooth pairs per turn of the input",
                    "phase: part of a pitch since the contact of a tooth pair began, with the input at 0",
                ],
            ),
        ]

    def to_dict(self) -> dict[str, list[Any]]:
        return columns([shaft.flat for shaft in self.shafts])

    @property
    def sections(self) -> Mapping[str, Content]:
        return {
            **header(self.file),
            "train": self.figures,
            "shafts": self.shafts,
            "meshes": self.meshes,
            "warnings": self.warnings,
        }

    # ---------------------------------------------------------------- answers

    def places(self, phi: float = 0.0) -> dict[str, Rigid]:
        """Positions of all gears in contact.

        Parameters
        ----------
        phi : float
            Rotation of the input shaft about its z axis, deg.

        Returns
        -------
        dict of str to Rigid
            Transformations from the own frames of the gears, by "stage.member", to the frame of the train.

        Examples
        --------
        >>> list(gm.load_train("samples/trains/train_two_stage.toml").places(5.0))
        ['first.pinion', 'first.gear', 'second.pinion', 'second.gear']
        """
        refuse_rotation(phi)
        return self.layout.places(math.radians(phi))

    def turns(self, phi: float = 0.0) -> dict[str, float]:
        """Rotations of all shafts in contact; of a rack that of the circle which rolls along it.

        Parameters
        ----------
        phi : float
            Rotation of the input shaft about its z axis, deg.

        Returns
        -------
        dict of str to float
            Rotations about the z axes of the shafts, deg, by their names.

        Examples
        --------
        >>> list(gm.load_train("samples/trains/train_two_stage.toml").turns(5.0))
        ['input', 'middle', 'output']
        """
        refuse_rotation(phi)
        turned = self.layout.turns(np.radians([phi]))
        return {name: float(np.degrees(psi[0])) for name, psi in turned.items()}

    def solids(
        self, tolerance: Length | None = None, *, file: str | PathLike[str] | None = None, phi: float = 0.0
    ) -> Solids:
        """All gears as watertight meshes, in mesh; the gears of a joined shaft are one body.

        Parameters
        ----------
        tolerance : float or str, optional
            Largest distance from the exact surfaces, mm, or with a unit; by default those of the stages.
        file : str or os.PathLike, optional
            File for which the meshes are proved: some formats round coordinates.
        phi : float
            Rotation of the input shaft about its z axis, deg.

        Returns
        -------
        Solids
            The solids by "stage.member", or by the name of a joined shaft.

        Raises
        ------
        DesignError
            For gears of a joined shaft that do not touch.

        Examples
        --------
        >>> list(gm.load_train("samples/trains/train_two_stage.toml").solids(0.1).parts)
        ['first.pinion', 'middle', 'second.gear']
        """
        from gearmesh.trains.bodies import solids_of_train

        refuse_rotation(phi)
        within = None if tolerance is None else tolerance_in_mm("tolerance", tolerance)
        return solids_of_train(self.layout, within, file, math.radians(phi), self.warnings)

    def cad(self, tolerance: Length | None = None, *, phi: float = 0.0) -> Cad:
        """All gears as a CAD assembly, in mesh; the gears of a joined shaft are one solid.

        Parameters
        ----------
        tolerance : float or str, optional
            Largest distance of the faces from the exact surfaces, mm, or with a unit; by default 0.0001 mm.
        phi : float
            Rotation of the input shaft about its z axis, deg.

        Returns
        -------
        Cad
            `save("train.step")` writes it; every occurrence is a part with its own name and colour.

        Raises
        ------
        OutputError
            If OpenCASCADE is missing.
        DesignError
            For gears of a joined shaft that do not touch.

        Examples
        --------
        >>> train = gm.load_train("samples/trains/train_two_stage.toml")
        >>> train.cad("10um").save("train.step").name
        'train.step'
        """
        from gearmesh.cad.brep import DEFAULT_TOLERANCE_MM
        from gearmesh.trains.bodies import cad_of_train

        refuse_rotation(phi)
        within = DEFAULT_TOLERANCE_MM if tolerance is None else tolerance_in_mm("tolerance", tolerance)
        return cad_of_train(self.layout, within, math.radians(phi), self.warnings)

    def transmission_error(self, turns: float | None = None) -> TrainError:
        """Transmission error of the output shaft: the sum of those of the stages, with their phases.

        Parameters
        ----------
        turns : float, optional
            Turns of the input; by default those of one turn of the output.

        Returns
        -------
        TrainError
            Errors of the output by stage, over rotations of the input.

        Raises
        ------
        DesignError
            For turns with too many positions.
        NoSolutionError
            If the teeth of a stage lose contact.

        Examples
        --------
        >>> gm.load_train("samples/trains/train_two_stage.toml").transmission_error(turns=0.1).save("te.csv").name
        'te.csv'
        """
        return TrainError(self, self.file.output, output_error(self.layout, self.file.output, turns))

    def study(
        self,
        vary: Mapping[str, str | Sequence[float | int | str | bool]] | None = None,
        *,
        tolerance: Mapping[str, str] | str | PathLike[str] | None = None,
        sample: int | None = None,
        method: str = "lhs",
        seed: int = 0,
        record: str | Sequence[str] = "all",
        limits: Sequence[str] = (),
        folder: str | PathLike[str] | None = None,
        workers: int | None = None,
        turns: float | None = None,
        progress: Progress | None = None,
    ) -> Study:
        """Study many variants of the train: compute kinematics and transmission error of the output for every row.

        Parameters
        ----------
        vary : mapping of str to list or str, optional
            Values of keys of stages, as {"stages.first.assembly.dx": "-0.1:0.1:5"}. All combinations are rows; with `sample`
            each is "low:high", sampled evenly.
        tolerance : mapping of str to str, or str or os.PathLike, optional
            Distributions of keys of stages, as "normal:0:20um", or a TOML file of them.
        sample : int, optional
            Number of sampled rows.
        method : str
            "lhs", "sobol", "random", or "saltelli".
        seed : int
            Seed of the sample.
        record : str or sequence of str
            Names of figures, or "all".
        limits : sequence of str
            Criteria of a good row, as "te_peak_to_peak_arcsec<10".
        folder : str or os.PathLike, optional
            Folder for finished rows; after a stop, the same call continues.
        workers : int, optional
            Number of processes on this machine; None for a number that fits the work.
        turns : float, optional
            Turns of the input for the transmission error; by default those of one turn of the output.
        progress : callable, optional
            Function of the progress (0 to 1) and the name of the stage.

        Returns
        -------
        Study
            Rows, statistics and sensitivities.

        Raises
        ------
        DesignError
            For keys that cannot be varied.
        NoSolutionError
            If the train itself loses contact.
        OutputError
            For a folder with another study.

        Examples
        --------
        >>> train = gm.load_train("samples/trains/train_two_stage.toml")
        >>> study = train.study({"stages.second.gear.teeth": [53, 54]}, turns=0.1, workers=1)
        >>> [round(float(ratio), 3) for ratio in study.numbers("ratio")]
        [6.235, 6.353]
        """
        from gearmesh.study.study import refuse_workers, run_study
        from gearmesh.trains.study import train_plan, train_work

        refuse_workers(workers)
        plan = train_plan(self.file, vary or {}, tolerance, sample, method, seed)
        wanted = record.split(",") if isinstance(record, str) else record
        work, nominal = train_work(self.file, plan, [name.strip() for name in wanted], turns)
        return run_study(self.file, plan, work, nominal, limits, folder, workers, None, progress)

    # ---------------------------------------------------------------- pictures and the page

    def picture(self, phi: float = 0.0, *, size: tuple[int, int] = PICTURE_SIZE) -> Picture:
        """Picture of all gears in mesh.

        Parameters
        ----------
        phi : float
            Rotation of the input shaft about its z axis, deg.
        size : tuple of int
            Width and height, pixels.

        Returns
        -------
        Picture
            `save("train.png")` draws it, which needs off-screen OpenGL.

        Examples
        --------
        >>> gm.load_train("samples/trains/train_two_stage.toml").picture(30.0)
        <Picture: Two-stage helical gearbox: gears in mesh, 1600 x 1200>
        """
        from gearmesh.view.picture import Picture

        refuse_rotation(phi)
        return Picture(self.scene(math.radians(phi), size))

    def scene(self, psi: float, size: tuple[int, int]) -> Scene:
        """Scene of all gears in mesh, seen along the axis of the input.

        Parameters
        ----------
        psi : float
            Rotation of the input shaft about its z axis, rad.
        size : tuple of int
            Width and height, pixels.

        Returns
        -------
        Scene
            Bodies with colours, and a camera.

        Examples
        --------
        >>> len(gm.load_train("samples/trains/train_two_stage.toml").scene(0.0, (80, 60)).bodies)
        3
        """
        from gearmesh.trains.bodies import solids_of_train
        from gearmesh.view.pictures import WHOLE_TOLERANCE_MM
        from gearmesh.view.views import set_scene

        solids = solids_of_train(self.layout, WHOLE_TOLERANCE_MM, None, psi, ())
        meshes = {name: solid.mesh for name, solid in solids.parts.items()}
        axis = self.layout.shafts[self.file.input].frame.rotation[:, 2]
        return set_scene(meshes, axis, f"{self.title}: gears in mesh", size)

    def chart(self, error: TrainError) -> Diagram:
        """Return the chart of a transmission error: the output and the shares of its stages over turns of the input.

        Parameters
        ----------
        error : TrainError
            Result of `transmission_error`.

        Returns
        -------
        Diagram
            `save("te.svg")` draws it.

        Examples
        --------
        >>> train = gm.load_train("samples/trains/train_two_stage.toml")
        >>> train.chart(train.transmission_error(turns=0.5)).save("te.svg").name
        'te.svg'
        """
        from gearmesh.view.diagrams.train_plot import plot_train_error
        from gearmesh.view.picture import Diagram

        solved = error.solved
        parts = {stage: error._in_unit(part) for stage, part in solved.parts.items()}
        slowest = min((mesh.teeth_per_turn for mesh in self.meshes if mesh.stage in parts), default=1.0)
        turns, te, unit = solved.psi / (2.0 * math.pi), error._in_unit(solved.te), error.reading[1]
        title = f"{self.title}: shaft {error.shaft}, {error._size.replace(' um ', ' µm ')}"
        return Diagram(title, lambda file: plot_train_error(file, turns, te, parts, title, 1.0 / slowest, unit=unit))

    def _card_figures(self, error: TrainError) -> Iterator[CardFigure]:
        """Yield the main figures, in words."""
        from gearmesh.view.report.card import CardFigure

        own, unit = self.figures, error.reading[1].replace("um", "µm")
        output = next(shaft for shaft in self.shafts if shaft.shaft == own.output)
        yield CardFigure(f"Ratio {own.input} to {own.output}", _ratio_text(own, 4).removeprefix("ratio "))
        if self.layout.port(own.output).slides:
            yield CardFigure("Travel of the output", f"{output.travel:.4g} mm", "per turn of the input")
            yield CardFigure("Force of the output", f"{output.force:.4g} N", "per Nm on the input")
        else:
            yield CardFigure(
                "Speed of the output",
                f"{output.speed:.4g}",
                f"= {output.speed_fraction} of the input, about its axis {_vector(output.axis)}",
            )
            yield CardFigure("Torque on the output", f"{output.torque:.4g}", "of the input's")
        yield CardFigure(
            "Transmission error",
            error._size.replace(" um ", " µm ").removesuffix(" peak to peak"),
            f"peak to peak, turns of the input: {error.figures.turns:.4g}",
        )
        sizes = {stage: float(np.ptp(error._in_unit(part))) for stage, part in error.solved.parts.items()}
        if sizes:
            stage = max(sizes, key=lambda name: sizes[name])
            size = sizes[stage] if sizes[stage] >= ZERO_SIZES[error.reading[1]] else 0.0
            yield CardFigure("Largest share of a stage", f"{size:.4g} {unit}", f"stage {stage}")
        orders = {f"{mesh.stage}: {mesh.mesh}": mesh.teeth_per_turn for mesh in self.meshes}
        if orders:
            fastest, slowest = (choose(orders, key=lambda name: orders[name]) for choose in (max, min))
            yield CardFigure(
                "Tooth pairs per turn of the input",
                f"{orders[slowest]:.4g} to {orders[fastest]:.4g}",
                "slowest and fastest mesh",
            )
        yield CardFigure("All teeth are where they were", f"after {own.turns_until_repeat:.4g} turns", "of the input")
        yield CardFigure("Stages and meshes", f"{len(self.layout.stages)} and {len(self.meshes)}")

    def page(self, turns: float | None = None) -> ReportPage:
        """Return the report page: picture, figures, transmission error of the output, data sheets of the stages.

        Parameters
        ----------
        turns : float, optional
            Turns of the input for the transmission error; by default those of one turn of the output.

        Returns
        -------
        ReportPage
            `save("train.html")` writes it.

        Examples
        --------
        >>> page = gm.load_train("samples/trains/train_two_stage.toml").page(turns=0.5)
        >>> page.save("train.html").name
        'train.html'
        """
        from gearmesh.reports.report import PICTURE_SIZE as PAGE_PICTURE_SIZE
        from gearmesh.trains.page import train_page

        error = self.transmission_error(turns)
        return train_page(
            self.title,
            self._summary,
            list(self._card_figures(error)),
            [*self.listings, *error.listings],
            self.chart(error),
            lambda: self.scene(0.0, PAGE_PICTURE_SIZE),
            {name: stage.gears for name, stage in self.layout.stages.items()},
            self.warnings,
        )


@checks_arguments
def load_train(source: str | PathLike[str] | Mapping[str, Any], overrides: Sequence[str] = ()) -> MultistageTrain:
    """Return the train in a TOML, JSON or REXS file, or in plain tables: stages, and the shafts on which their members are.

    Parameters
    ----------
    source : str or os.PathLike or mapping
        The file, or its tables; names of design files are relative to its folder, or to the working folder. A REXS file is the
        train of all its stages.
    overrides : sequence of str
        Keys that are put in before validation, as "stages.second.gear.teeth=41".

    Returns
    -------
    MultistageTrain
        Its stages are built on first use.

    Raises
    ------
    DesignError
        One line naming file or key, value and what is allowed.

    Examples
    --------
    >>> train = gm.load_train("samples/trains/train_two_stage.toml")
    >>> train.figures.ratio_fraction
    '106/17'
    """
    from gearmesh.exchange.rexs_file import is_rexs

    if not isinstance(source, Mapping):
        if not is_rexs(Path(source)):
            return MultistageTrain(read_train(source, overrides))
        from gearmesh.trains.rexs import train_tables

        source, notes = train_tables(Path(source))
    else:
        notes = ()
    return MultistageTrain(train_of(override(source, overrides), Path()), notes)


def _ratio_text(values: TrainFigures, digits: int) -> str:
    """Return the ratio as a fraction and a number of `digits` digits."""
    if values.ratio is None and values.ratio_fraction == "none":
        return f"travel {values.travel:.{digits}g} mm per turn of the input"
    if values.ratio is None:
        return "ratio infinite, the output rests"
    return f"ratio {values.ratio_fraction} = {values.ratio:.{digits}g}"


def _words(ratio: Fraction) -> str:
    """Return a ratio as text."""
    return f"{ratio.numerator}/{ratio.denominator}" if ratio.denominator != 1 else str(ratio.numerator)


def _coordinates(vector: Any) -> list[float]:
    """Return coordinates without the rounding of zeros."""
    return [0.0 if abs(value) < AXIS_ROUNDING else value for value in map(float, vector)]


def _vector(values: Sequence[float]) -> str:
    """Return a direction in short: the name of a coordinate axis, or three numbers."""
    for k, name in enumerate("xyz"):
        if abs(abs(values[k]) - 1.0) < AXIS_ROUNDING:
            return f"{'+' if values[k] > 0.0 else '-'}{name}"
    return " ".join(f"{value:.3g}" for value in values)


def _phase(mesh: Mesh, theta: float, sense: float) -> float:
    """Return the part of a pitch since the surface contact of a tooth pair began, at a rotation (rad) of the pinion.

    `sense`: +1 or -1, in which phi1 of the mesh changes. Without surface contact the phase is counted from phi1 = 0.
    """
    surface, pitch = mesh.curve.surface, mesh.pair.pitch
    phi1 = float(mesh.curve_phi1(np.array([theta]))[0])
    begin = surface.begin if sense > 0.0 else surface.end
    phase = sense * (phi1 - (begin if math.isfinite(begin) else 0.0)) / pitch % 1.0
    return 0.0 if 1.0 - phase < SAME_PHASE_PITCHES else phase
