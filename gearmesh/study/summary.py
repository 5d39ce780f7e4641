"""Summary of a study: figures of all its rows together, as tables and in JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

from gearmesh.answers.tables import Listing, round_to
from gearmesh.figures import Figures, Summary, at_resolution, figure
from gearmesh.records import dataclass
from gearmesh.study.statistics import REPORTED_PERCENTILES, Effect
from gearmesh.study.variance import VarianceShare

#: figures of a row, or an effect of keys on them
Row = TypeVar("Row", bound=Figures)
#: limit of the reasons that are reported
MAX_REPORTED_REASONS = 10


@dataclass(frozen=True)
class StudySummary(Figures):
    """Summary of all rows of a study."""

    headline: str = figure("the study in one line")
    plan: Mapping[str, Any] = figure("how the rows were made")
    torque: Sequence[float] | None = figure("torques on the pinion", "Nm", "T_1", optional=True)
    nominal: Mapping[str, Any] = figure("figures of the design as it is")
    percentiles: Mapping[str, Mapping[str, float]] = figure("percentiles of the figures over all rows")
    sensitivities: Sequence[Effect] = figure("what each key does to a figure, by straight lines")
    variance: Sequence[VarianceShare] = figure("shares of a figure's variance that are a key's")
    warnings: Sequence[str] = figure("figures by which straight lines do not rank the keys")
    limits: Mapping[str, float] = figure("share of the rows that keep a limit")
    good: float | None = figure("yield: share of the rows that keep all limits", key="yield")
    failures: Mapping[str, int] = figure("reasons why rows have no figures, and of how many", whole=True)

    @staticmethod
    def read(document: Mapping[str, Any]) -> StudySummary:
        """Return the summary in the JSON document of a study.

        Parameters
        ----------
        document : mapping
            Content of study.json.

        Returns
        -------
        StudySummary
            Summary of all rows.

        Raises
        ------
        LookupError, TypeError, AttributeError
            For another document.

        Examples
        --------
        >>> study = gears.study({"assembly.dx": "0:0.1:2"}, record="cycle", workers=1)
        >>> gm.StudySummary.read(json.loads(study.json())).headline
        '2 rows over assembly.dx, 2 with contact'
        """
        return StudySummary(
            headline=str(document["headline"]),
            plan=document.get("plan", {}),
            torque=document.get("torque_nm"),
            nominal=document["nominal"],
            percentiles=document["percentiles"],
            sensitivities=[_read(Effect, row) for row in document["sensitivities"]],
            variance=[_read(VarianceShare, row) for row in document.get("variance", ())],
            warnings=[str(line) for line in document.get("warnings", ())],
            limits=document["limits"],
            good=document["yield"],
            failures=document["failures"],
        )

    @property
    def tables(self) -> list[Listing]:
        """Tables of percentiles, sensitivities, yield, and reasons for rows without figures."""
        rows = [
            [name, *at_resolution([self.nominal.get(name), *values.values()], self._resolution(name))]
            for name, values in self.percentiles.items()
        ]
        heads = ["figure", "design", *(f"{p} %" for p in REPORTED_PERCENTILES)]
        reasons = list(self.failures.items())[:MAX_REPORTED_REASONS]
        return [
            Listing(f"Study: {self.headline}", heads, rows),
            *self._rankings,
            *([self._yield] if self.limits else []),
            *([Listing("Rows without figures", ["reason", "rows"], reasons)] if reasons else []),
        ]

    def _resolution(self, name: str) -> float:
        """Return the size below which a figure is shown as 0; 0 for a study read from a file, which has no units."""
        entry = self.nominal.entry(name) if isinstance(self.nominal, Summary) else None
        return 0.0 if entry is None else entry.figure.resolution

    @property
    def _rankings(self) -> list[Listing]:
        """Tables of slopes and of shares of the variance."""
        slopes = []
        for effect in self.sensitivities:
            swing = at_resolution(effect.swing, self._resolution(effect.figure))
            slopes.append([effect.key, effect.figure, effect.slope if swing else 0.0, swing, effect.explained])
        shares = [
            [
                share.key,
                share.figure,
                *(None if v is None else round_to(v, 4) for v in (share.first, share.first_error)),
                *(None if v is None else round_to(v, 4) for v in (share.total, share.total_error)),
            ]
            for share in self.variance
        ]
        linear = "Sensitivities (straight lines by least squares; they rank where R^2 is near 1)"
        tables = [
            Listing(linear, ["key", "figure", "slope", "5 % to 95 %", "R^2"], slopes),
            Listing(
                "Shares of the variance (Sobol indices and standard errors)",
                ["key", "figure", "first order", "+-", "total", "+-"],
                shares,
            ),
        ]
        return [table for table in tables if table.rows]

    @property
    def _yield(self) -> Listing:
        """Table of the rows that keep the limits."""
        rows = [[text, 100.0 * share] for text, share in self.limits.items()]
        return Listing("Yield, % of all rows", ["limit", "%"], [*rows, ["all", 100.0 * (self.good or 0.0)]])


def _read(kind: type[Row], row: Mapping[str, Any]) -> Row:
    """Return the figures of a row of JSON."""
    return kind(*(row[declared_figure.key] for declared_figure in kind.declared_figures()))
