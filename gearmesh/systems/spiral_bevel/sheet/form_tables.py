"""Tables of a requested ease-off: the reached ease-off, and the residual topography."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.systems.spiral_bevel.synthesis.flank_form import form_figures
from gearmesh.systems.system import SheetTable

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign
    from gearmesh.systems.spiral_bevel.synthesis.settings import FlankForm

#: decimals of values in um
UM_DECIMALS = 2


def form_tables(design: FaceMilledDesign, forms: dict[str, FlankForm]) -> Iterator[SheetTable]:
    """Return the requested and reached ease-off, and the residual topography of each side, um."""
    if not forms:
        return
    rows: dict[str, list[float | None]] = {}
    for name, form in forms.items():
        target = design.ease_off(name)
        for key, value in form.parameters.items():
            rows.setdefault(key, []).extend((_um(1e3 * getattr(target, key)), _um(1e3 * value)))
        figures = form_figures(form)
        rows.setdefault("residual_max", []).extend((None, _um(figures.ease_off_residual_max)))
        rows.setdefault("residual_rms", []).extend((None, _um(figures.ease_off_residual_rms)))
    heads = tuple(f"{name} {what}" for name in forms for what in ("asked", "reached"))
    yield SheetTable("Ease-off", heads, tuple((key, "um", *values) for key, values in rows.items()))
    for name, form in forms.items():
        # rows from the pinion's tip downwards
        x, y, um = (grid[:, ::-2] for grid in (form.along, form.up, 1e3 * form.residual))
        row_numbers = np.flatnonzero(np.isfinite(um).any(axis=0))
        yield SheetTable(
            f"Residual topography of pinion {name}, toe (-1) to heel (1), gear's tip (-1) to pinion's tip (1)",
            tuple(f"{value:.4g}" for value in x[:, 0]),
            tuple((f"{y[0, k]:.2f}", "um", *map(_um, um[:, k])) for k in row_numbers),
        )


def _um(value: float) -> float | None:
    """Return a value (um) as it is reported, or None."""
    return round(float(value), UM_DECIMALS) + 0.0 if np.isfinite(value) else None
