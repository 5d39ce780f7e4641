"""Tables of the ease-off that was asked for: what was reached, and the topography that is left."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.systems.spiral_bevel.synthesis.flank_form import form_figures
from gearmesh.systems.system import SheetTable

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign
    from gearmesh.systems.spiral_bevel.synthesis.settings import FlankForm

#: decimals of um
DIGITS = 2


def form_tables(design: FaceMilledDesign, forms: dict[str, FlankForm]) -> Iterator[SheetTable]:
    """Ease-off asked for and reached, and the residual topography of each side, um."""
    if not forms:
        return
    rows: dict[str, list[float | None]] = {}
    for name, form in forms.items():
        target = design.ease_off(name)
        for key, value in form.parameters.items():
            rows.setdefault(key, []).extend((_um(1e3 * getattr(target, key)), _um(1e3 * value)))
        told = form_figures(form)
        rows.setdefault("residual_max", []).extend((None, _um(told.ease_off_residual_max)))
        rows.setdefault("residual_rms", []).extend((None, _um(told.ease_off_residual_rms)))
    heads = tuple(f"{name} {what}" for name in forms for what in ("asked", "reached"))
    yield SheetTable("Ease-off", heads, tuple((key, "um", *values) for key, values in rows.items()))
    for name, form in forms.items():
        # pinion's tip above
        x, y, um = (grid[:, ::-2] for grid in (form.along, form.up, 1e3 * form.residual))
        told_of = np.flatnonzero(np.isfinite(um).any(axis=0))
        yield SheetTable(
            f"Residual topography of pinion {name}, toe (-1) to heel (1), gear's tip (-1) to pinion's tip (1)",
            tuple(f"{value:.4g}" for value in x[:, 0]),
            tuple((f"{y[0, k]:.2f}", "um", *map(_um, um[:, k])) for k in told_of),
        )


def _um(value: float) -> float | None:
    """A value as it is reported."""
    return round(float(value), DIGITS) + 0.0 if np.isfinite(value) else None
