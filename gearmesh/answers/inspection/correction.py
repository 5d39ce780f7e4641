"""Correction of machine settings that removes measured deviations, with the remaining deviations and the contact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.contact.figures import CycleSummary
from gearmesh.answers.inspection.figures import UM_PER_MM
from gearmesh.answers.inspection.machine_settings import (
    GROUND_TABLES,
    INDEX_SETTING,
    CutFlanks,
    MovableSetting,
    movable_settings,
    settings_named,
    usable_settings,
)
from gearmesh.answers.inspection.measured_files import BOTH_FLANKS, flanks_of_files
from gearmesh.answers.questions import SolvedGears
from gearmesh.answers.result import Result, header
from gearmesh.answers.tables import Listing
from gearmesh.design.core import Design
from gearmesh.design.topography_file import TopographyGrid, topography_text
from gearmesh.errors import ArgumentError, DesignError, NoSolutionError
from gearmesh.figures import Content, Figures, Summary, figure
from gearmesh.files.csv_table import csv_text
from gearmesh.formats import CSV_SUFFIX, JSON_SUFFIX, TOML_SUFFIX
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.metrology.correction import SettingChanges, setting_changes
from gearmesh.metrology.evaluation import in_transverse_plane
from gearmesh.metrology.flanks.projection import FlankProjection
from gearmesh.metrology.flanks.smoothing import smooth_deviations
from gearmesh.metrology.second_order import flank_coordinates, second_order
from gearmesh.progress import part, tell
from gearmesh.records import dataclass
from gearmesh.systems import system as systems
from gearmesh.teeth.gear_train import GearTrain
from gearmesh.teeth.micro_geometry.deviations import DeviationGrid, deviating_tooth, lowest_share
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: differences of roll length in a row, and of z in a column, up to which points form a grid for a topography
GRID_TOLERANCE_MM = 1e-6
#: title of the table of exchangeable settings
EXCHANGES_TITLE = "Settings that can stand for one another: root mean square, um"
#: rotation of the teeth for which an exchange is stated
STATED_ROTATION_RAD = 60.0 * ARCSEC
#: tooth thickness for which an exchange is stated
STATED_THICKNESS_MM = 0.01
#: limit of Newton's steps
MAX_NEWTON_STEPS = 10
#: movement of the flank below which the steps end
MIN_STEP_MM = 1e-9


@dataclass(frozen=True)
class CorrectedSettingFigures(Figures):
    """A setting that a correction moves."""

    setting: str = figure("name of the setting")
    before: float = figure("value in the design, which cut the measured flank")
    after: float = figure("value that takes the deviations away")
    change: float = figure("change of the value")
    uncertainty: float | None = figure(
        "standard deviation of the change by the noise of the measurement; none where other settings move the flanks alike"
    )
    unit: str = figure("unit of the values")


@dataclass(frozen=True)
class ExchangeFigures(Figures):
    """Settings that can stand for one another: the flanks hardly tell a change of one from changes of the others."""

    settings: list[str] = figure(
        "names, the one with the largest part first; rotation of the teeth, and thickness, where free"
    )
    changes: list[float] = figure(
        "changes of all that leave the flanks nearly as they are, of the first 0.01 mm, 1 arcmin or 0.0001"
    )
    units: list[str] = figure("units of the changes")
    moves: float = figure("root mean square by which these changes together move the flanks", "um")
    alone: float = figure("the same of the first setting's change alone", "um")
    uncertainty: float | None = figure(
        "standard deviation of the first setting by the noise, exchanged so; none where the flanks do not move at all"
    )
    correlation: float = figure(
        "correlation of the first two settings by the covariance of what is known at least as well"
    )


@dataclass(frozen=True)
class EffectFigures(Figures):
    """Response of a flank to a change of one setting, to second order over the measured grid."""

    setting: str = figure("name of the setting")
    flank: str = figure("flank, right or left")
    by: float = figure("change of the setting: 0.01 mm, 1 arcmin or 0.0001, in its unit")
    thickness: float = figure("displacement along the normal in the middle", "um")
    pressure_angle: float = figure("increase of the pressure angle", "arcsec")
    lengthwise_angle: float = figure("rise of the material to the heel", "arcsec")
    profile_crowning: float = figure("increase of profile crowning", "um")
    length_crowning: float = figure("increase of lengthwise crowning", "um")
    twist: float = figure("increase of the rise to the tip at the heel less that at the toe", "um")


@dataclass(frozen=True)
class ResidualFigures(Figures):
    """Deviations of a flank before and after a correction."""

    rms_before: float = figure("root mean square of the measured deviations", "um")
    max_before: float = figure("largest of them", "um")
    rms_after: float = figure("root mean square of what the correction leaves", "um")
    max_after: float = figure("largest of it", "um")


@dataclass(frozen=True)
class PrognosisFigures(Figures):
    """Contact of the real flank with the other member's nominal one."""

    contact_ratio: float | None = figure("contact ratio without load", symbol="eps")
    mesh_te_peak_to_peak: float | None = figure("transmission error over the mesh cycle", "arcsec")


@dataclass(frozen=True)
class CorrectionFigures(Figures):
    """A correction of machine settings."""

    member: str = figure("name of the member")
    settings: list[CorrectedSettingFigures] = figure("settings that are moved")
    rotation: float | None = figure("rotation of the measured teeth against the design's", "arcsec", optional=True)
    thickness: float | None = figure("normal tooth thickness more than nominal", "um", optional=True)
    noise: float = figure("standard deviation of a measured deviation, as given or by what no setting takes away", "um")
    directions: int = figure("combinations of settings that the deviations show", whole=True)
    exchanges: list[ExchangeFigures] = figure("settings that can stand for one another")
    singular_values: list[float] = figure("singular values of the sensitivity, each setting over its root mean square")
    effects: list[EffectFigures] = figure("sensitivity of the flanks to each setting")
    residuals: Mapping[str, ResidualFigures] = figure("deviations of right and left flanks")
    contact_nominal: PrognosisFigures = figure("contact of the design")
    contact_before: PrognosisFigures = figure("contact of the measured flanks")
    contact_after: PrognosisFigures = figure("contact of the corrected flanks")


@dataclass(frozen=True, repr=False)
class Correction(Result):
    """Changes of settings (M,) of a member; `new_design` is the design with the settings for the machine.

    A ".toml" file is the design with the new settings. A ".csv" file has the remaining deviations, as `[measured]`
    reads them.
    """

    #: the nominal design
    design: Design
    #: its gear set
    train: GearTrain
    #: name of the member
    member: str
    #: settings that are changed
    settings: tuple[MovableSetting, ...]
    #: flanks for any settings, with the measured deviations
    _flanks: CutFlanks
    #: displacements (N, M), mm per unit of each setting
    sensitivity: Array
    #: changes of the settings, in the design's units
    solution: SettingChanges
    #: rotation of the measured teeth, rad, if it is free
    rotation: float | None
    #: remaining deviations on the measured points, by side
    residual: Mapping[Side, DeviationGrid]
    #: notes of the files, one line each
    notes: tuple[str, ...] = ()
    #: normal tooth thickness above nominal, mm, if it is free
    thickness: float | None = None

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (JSON_SUFFIX, TOML_SUFFIX, CSV_SUFFIX)

    def topography(self, side: Side) -> str:
        """The deviations that remain on a flank as a file of modifications: amounts that a dressed wheel has to remove.

        Parameters
        ----------
        side : Side
            "right" or "left".

        Returns
        -------
        str
            Text of a topography in the format of the key `topography`, with amounts in the transverse plane.

        Raises
        ------
        DesignError
            For a flank that was not measured or is no involute, and for points that form no grid over roll length and face.

        Examples
        --------
        >>> from pathlib import Path
        >>> grid = gears.measuring_grid("pinion").grids[0]
        >>> rows = [f"{grid.side},{s},{t},{5.0 * t}" for s in grid.s for t in grid.t]
        >>> Path("slope.csv").write_text("flank,s,t,deviation_um\\n" + "\\n".join(rows)) > 0
        True
        >>> correction = gears.correct("pinion", "slope.csv", settings=["helix_slope"])
        >>> len(correction.topography(grid.side).splitlines()) > 10
        True
        """
        inspection = systems.system_of(self.design).inspection
        basis = None if inspection is None else inspection(self.design, self.train, self.member)
        involute = None if basis is None else basis.involute_of(side)
        if involute is None or side not in self.residual:
            raise ArgumentError(
                "topography", str(side), reason="no involute flank was measured there", allowed="cylindrical gears"
            )
        grid = self.residual[side]
        rolls = involute.roll_length(np.hypot(grid.points[..., 0], grid.points[..., 1]))
        z = grid.points[..., 2]
        across, along = rolls.mean(axis=1), z.mean(axis=0)
        if max(np.ptp(rolls, axis=1).max(), np.ptp(z, axis=0).max()) > GRID_TOLERANCE_MM:
            raise ArgumentError(
                "topography", str(side), reason="its points are on no grid over roll length and face", allowed="a grid"
            )
        amounts = in_transverse_plane(grid.values, involute.base_helix)
        i, j = np.argsort(across), np.argsort(along)
        return topography_text(
            TopographyGrid(
                tuple(across[i].tolist()), tuple(along[j].tolist()), tuple(map(tuple, amounts[np.ix_(i, j)].tolist()))
            )
        )

    @cached_property
    def new_design(self) -> Design:
        """Design with the corrected settings and all other settings.

        Its nominal flanks have the opposite of the deviations.
        """
        return self._flanks.design.with_values(self._flanks.values(self.settings, self.solution.changes.tolist()))

    @property
    def warnings(self) -> list[str]:
        """Notes of the files and warnings of the result, one line each."""
        alike = [self.settings[k].name for k in self.solution.alike if k < len(self.settings)]
        notes = [*self.notes, *(_tilt_note(self._flanks, setting) for setting in self.settings if setting.tilts)]
        if not alike:
            return notes
        names, as_rotation = ", ".join(alike), "" if self.rotation is None else " or a rotation of the gear"
        return [
            *notes,
            f"{names}: some move the flanks as others{as_rotation} would; the changes are the smallest that do; "
            "name fewer settings to choose",
        ]

    @cached_property
    def figures(self) -> CorrectionFigures:
        """All figures; they include the solved contact."""
        flanks = {side: self._flanks.grids[side] for side in self.residual}
        return CorrectionFigures(
            member=self.member,
            settings=self._settings,
            rotation=None if self.rotation is None else self.rotation / ARCSEC,
            thickness=None if self.thickness is None else UM_PER_MM * self.thickness,
            noise=UM_PER_MM * self.solution.noise,
            directions=self.solution.directions,
            exchanges=self._exchanges,
            singular_values=self.solution.singular_values.tolist(),
            effects=self._effects,
            residuals={str(side): _residual(flanks[side].values, grid.values) for side, grid in self.residual.items()},
            contact_nominal=self._prognosis({}),
            contact_before=self._prognosis(flanks),
            contact_after=self._prognosis(self.residual),
        )

    @property
    def headline(self) -> str:
        parts = [
            f"{side} {UM_PER_MM * _rms(self._flanks.grids[side].values):.3g} -> {UM_PER_MM * _rms(grid.values):.3g} um"
            for side, grid in self.residual.items()
        ]
        return f"{self.member}: {len(self.settings)} settings; root mean square {', '.join(parts)}"

    @property
    def listings(self) -> list[Listing]:
        all_figures = self.figures
        settings = [[s.setting, s.before, s.after, s.change, s.uncertainty, s.unit] for s in all_figures.settings]
        effects = [
            [f"{e.setting}, {e.flank}", *(round(value, 4) + 0.0 for value in list(e.row.values())[2:])]
            for e in all_figures.effects
        ]
        exchanged = [
            [
                ", ".join(
                    f"{name} {change:+.4g} {unit}".rstrip()
                    for name, change, unit in zip(e.settings, e.changes, e.units, strict=True)
                ),
                e.moves,
                e.alone,
                e.correlation,
            ]
            for e in all_figures.exchanges
        ]
        left = [[side, *r.row.values()] for side, r in all_figures.residuals.items()]
        contact = [
            [name, c.contact_ratio, c.mesh_te_peak_to_peak]
            for name, c in (
                ("design", all_figures.contact_nominal),
                ("as measured", all_figures.contact_before),
                ("corrected", all_figures.contact_after),
            )
        ]
        of_fit = [("noise, um", all_figures.noise), ("combinations that show", all_figures.directions)]
        if all_figures.rotation is not None:
            of_fit.append(("rotation, arcsec", all_figures.rotation))
        if all_figures.thickness is not None:
            of_fit.append(("thickness, um", all_figures.thickness))
        return [
            Listing(
                f"Corrected settings of the {self.member}",
                ("setting", "before", "after", "change", "uncertainty", "unit"),
                settings,
            ),
            Listing("Fit", ("", ""), of_fit),
            *(
                [Listing(EXCHANGES_TITLE, ("changes together", "moves", "first alone", "correlation"), exchanged)]
                if exchanged
                else []
            ),
            Listing(
                "Sensitivity, to second order: um, angles in arcsec",
                ("setting, flank", "by", "thickness", "pressure", "to heel", "profile cr.", "length cr.", "twist"),
                effects,
            ),
            Listing("Singular values", ("", ""), list(enumerate(all_figures.singular_values, 1))),
            Listing("Deviations, um", ("flank", "rms before", "max before", "rms after", "max after"), left),
            Listing("Contact", ("flanks", "contact ratio", "TE of the mesh, arcsec"), contact),
        ]

    def to_dict(self) -> dict[str, list[Any]]:
        rows = [setting.row for setting in self._settings]
        return {key: [row[key] for row in rows] for key in CorrectedSettingFigures.__dataclass_fields__}

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), **Summary(self.figures)}

    @property
    def _settings(self) -> list[CorrectedSettingFigures]:
        rows = zip(self.settings, self.solution.changes.tolist(), self.solution.uncertainties.tolist(), strict=False)
        values = [(s, self._flanks.value(s), change, _finite(spread)) for s, change, spread in rows]
        return [
            CorrectedSettingFigures(s.name, v, v + c, c, spread, self._flanks.unit(s)) for s, v, c, spread in values
        ]

    @property
    def _exchanges(self) -> list[ExchangeFigures]:
        made = []
        for exchange in self.solution.exchanges:
            names, stated, shown, units = zip(*(self._stated_change(k) for k in exchange.settings), strict=True)
            by = stated[0]
            made.append(
                ExchangeFigures(
                    list(names),
                    (by * exchange.changes * np.array(shown)).tolist(),
                    list(units),
                    UM_PER_MM * abs(by) * exchange.moves,
                    UM_PER_MM * abs(by) * exchange.alone,
                    _finite(exchange.spread * shown[0]),
                    exchange.correlation,
                )
            )
        return made

    def _stated_change(self, number: int) -> tuple[str, float, float, str]:
        """Return name, stated change, factor for display and unit of a setting by its number.

        Numbers above those of the settings are the free quantities: rotation (rad, shown in arc seconds) and thickness
        (mm).
        """
        if number < len(self.settings):
            setting = self.settings[number]
            return setting.name, self._flanks.stated_change(setting), 1.0, self._flanks.unit(setting)
        free = [] if self.rotation is None else [("rotation", STATED_ROTATION_RAD, 1.0 / ARCSEC, "arcsec")]
        return [*free, ("thickness", STATED_THICKNESS_MM, 1.0, "mm")][number - len(self.settings)]

    @property
    def _effects(self) -> list[EffectFigures]:
        made = []
        for setting, column in zip(self.settings, self.sensitivity.T, strict=True):
            by = self._flanks.stated_change(setting)
            for side, moves in _by_side(self._flanks.grids, by * column).items():
                if not moves.values.any():
                    continue
                order = second_order(*flank_coordinates(moves.points), moves.values)
                made.append(
                    EffectFigures(
                        setting.name,
                        str(side),
                        by,
                        UM_PER_MM * order.thickness,
                        order.profile_angle / ARCSEC,
                        order.lengthwise_angle / ARCSEC,
                        UM_PER_MM * order.profile_crowning,
                        UM_PER_MM * order.length_crowning,
                        UM_PER_MM * order.twist,
                    )
                )
        return made

    def _prognosis(self, grids: Mapping[Side, DeviationGrid]) -> PrognosisFigures:
        """Return the contact of the gear set with smoothed deviations of the member's flanks.

        There are no figures if the flanks do not meet.
        """
        nominal = self.train.members[self.member]
        try:
            smooth = {side: _smooth(nominal.one_tooth, side, grid) for side, grid in grids.items()}
            made = replace(nominal, tooth=deviating_tooth(nominal.one_tooth, smooth)) if grids else nominal
            cycle = SolvedGears(self.design, self.train.with_member(made)).contact().cycle
        except (DesignError, NoSolutionError):
            cycle = None
        if cycle is None:
            return PrognosisFigures(None, None)
        own_cycle = CycleSummary.of(cycle)
        return PrognosisFigures(own_cycle.contact_ratio, own_cycle.mesh_te_peak_to_peak)

    def _write(self, target: Path) -> None:
        from gearmesh.design.files import design_text
        from gearmesh.io.atomic import whole_text

        toml = target.suffix.lower() == TOML_SUFFIX
        whole_text(target, design_text(self.new_design, target.parent) if toml else residual_text(self.residual))


def correct_settings(
    design: Design,
    name: str,
    file: Path | None = None,
    flank: str = BOTH_FLANKS,
    settings: Sequence[str] = (),
    noise: float | None = None,
) -> Correction:
    """Return the settings of the machine that cuts or grinds a member with which its measured deviations would vanish.

    - `file`, `flank`: as for `inspect_files`.
    - `settings`: names of the settings that may change ("radial", "concave.radial" for one side, "helical_motion.2");
      by default the usual settings of the machine.
    - `noise`: standard deviation (um) of a measured deviation.

    The rotation of the measured teeth is free, unless the blank's index is a setting. If the settings are
    modifications, the thickness is free, too. Raises an error for kinds without machine settings or modifications, for
    unknown settings, and without a measurement; FileError for an unreadable file.
    """
    if noise is not None and not (np.isfinite(noise) and noise > 0.0):
        raise ArgumentError("noise", noise, must_be="above 0, um")
    names = design.member_names
    if settings and names is not None and name in names.members:
        # unknown names are refused before anything is built
        known = movable_settings(design, name)
        for setting in settings:
            settings_named(known, setting)
    nominal, train, flanks_by_side = flanks_of_files(design, name, file, flank)
    movable_settings(nominal, name)
    grids, joint = (
        {side: flank_data.grid for side, flank_data in flanks_by_side.items()},
        train.members[name].tooth.joint,
    )
    flanks = CutFlanks(systems.pin(nominal, train), name, grids, joint)
    with part(0.1, 0.5):
        moving = usable_settings(flanks, settings)
    if not moving:
        raise ArgumentError(
            "settings", reason="none moves the flanks that were measured", allowed="settings of their machine"
        )
    # quantities that are free besides: rotation of the measured teeth, and thickness if both flanks are ground
    free = {} if any(INDEX_SETTING in setting.name for setting in moving) else {"rotation": flanks.rotation}
    ground = any(key.rpartition(".")[0].endswith(tuple(GROUND_TABLES)) for setting in moving for key in setting.keys)
    if ground and len(flanks.grids) == len(Side):
        free["thickness"] = flanks.thickness
    sensitivity = np.stack([*moving.values(), *free.values()], axis=-1)
    solution, left = _solve(flanks, tuple(moving), sensitivity, None if noise is None else noise / UM_PER_MM, ground)
    tell(0.7)
    residual = _by_side(flanks.grids, left)
    notes = tuple(f"{side} flank: {note}" for side in flanks_by_side for note in flanks_by_side[side].notes)
    count = len(moving)
    left_free = dict(zip(free, solution.changes[count:].tolist(), strict=True))
    return Correction(
        nominal,
        train,
        name,
        tuple(moving),
        flanks,
        sensitivity[:, :count],
        replace(solution, changes=solution.changes[:count], uncertainties=solution.uncertainties[:count]),
        left_free.get("rotation"),
        residual,
        notes,
        -left_free["thickness"] if "thickness" in left_free else None,
    )


def _solve(
    flanks: CutFlanks, settings: tuple[MovableSetting, ...], sensitivity: Array, noise: float | None, ground: bool
) -> tuple[SettingChanges, Array]:
    """Return all changes (settings, then the free rotation and thickness), and the remaining deviations (N,), mm,
    exactly.

    Slopes that are `ground` remove material at one end or the other, depending on their sign. This adds a constant
    amount, which rotation and thickness absorb after each step.
    """
    count = len(settings)
    deviations = np.concatenate([grid.values.ravel() for grid in flanks.grids.values()])
    start, total, left = flanks.displacements({}), np.zeros(sensitivity.shape[1]), deviations
    # linear least squares with the sensitivities at the present settings; each step is checked on the exact flanks
    first = solution = setting_changes(left, sensitivity, noise)
    for _ in range(MAX_NEWTON_STEPS):
        if not solution.directions:
            break
        trial = total + solution.changes
        cut = flanks.displacements(flanks.values(settings, trial[:count].tolist())) - start
        if ground:
            trial[count:] = np.linalg.lstsq(sensitivity[:, count:], -(deviations + cut), rcond=None)[0]
        after = deviations + cut + sensitivity[:, count:] @ trial[count:]
        # a step that does not reduce the exact deviations ends the iteration; the state before it is kept
        if not _rms(after) < _rms(left):
            break
        total, left = trial, after
        if np.abs(sensitivity @ solution.changes).max() < MIN_STEP_MM:
            break
        solution = setting_changes(left, sensitivity, noise)
    return replace(solution, changes=total, directions=first.directions), left


def residual_text(grids: Mapping[Side, DeviationGrid]) -> str:
    """Return a file of deviations on nominal points in the format of the table `measured`."""
    head = ["flank", "row", "column", "x_mm", "y_mm", "z_mm", "nx", "ny", "nz", "deviation_um"]
    rows = [
        [str(side), i + 1, j + 1, *grid.points[i, j].tolist(), *grid.normals[i, j].tolist(), UM_PER_MM * float(value)]
        for side, grid in grids.items()
        for (i, j), value in np.ndenumerate(grid.values)
    ]
    return csv_text(head, rows)


def _by_side(grids: Mapping[Side, DeviationGrid], values: Array) -> dict[Side, DeviationGrid]:
    """Return values (N,) of all flanks on the grid of each flank."""
    ends = np.cumsum([grid.values.size for grid in grids.values()])[:-1]
    parts = np.split(values, ends)
    return {
        side: replace(grid, values=part.reshape(grid.values.shape))
        for (side, grid), part in zip(grids.items(), parts, strict=True)
    }


def _smooth(tooth: Tooth, side: Side, grid: DeviationGrid) -> DeviationGrid:
    """Return deviations smoothed by cross-validation: noise bends a flank more than a correction does."""
    feet = FlankProjection(tooth, side).foot_points(grid.points.reshape(-1, 3))
    smooth = smooth_deviations(feet.s, feet.t, grid.values.ravel(), None)
    s, t = smooth.inside(lowest_share(tooth, side))
    nominal = tooth.flank_grid(side, s, t)
    return DeviationGrid(nominal.points, nominal.normals, smooth.at(s, t))


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def _tilt_note(flanks: CutFlanks, setting: MovableSetting) -> str:
    """Return a note on the sign and zero of a tilt that a correction changes."""
    swivel = flanks.swivel_of(setting)
    return (
        f"{setting.name}: 0 is the cutter's axis parallel to the cradle's; > 0 leans its end in the blank, at the swivel of "
        f"{swivel:.6g} deg that this side has, by that angle from growing cradle angle towards the machine centre"
    )


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _residual(before: Array, after: Array) -> ResidualFigures:
    return ResidualFigures(
        UM_PER_MM * _rms(before),
        UM_PER_MM * float(np.abs(before).max()),
        UM_PER_MM * _rms(after),
        UM_PER_MM * float(np.abs(after).max()),
    )
