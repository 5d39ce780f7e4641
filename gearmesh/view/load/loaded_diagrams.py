"""Figures of gears under torque: pressure on the flanks, transmission error, load share, bending stress."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.lattice import bilinear
from gearmesh.loaded.sharing import LoadedMesh, whole_cycle
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair
from gearmesh.view.diagrams.flank_diagrams import draw_outline, flank_window, is_long, name_edges
from gearmesh.view.diagrams.flank_plane import FlankPlane
from gearmesh.view.diagrams.plots import new_figure, save_figure, sheet
from gearmesh.view.load.footprints import Footprints, largest_pressure, scale_limit
from gearmesh.view.palette import COLOUR_MAP, CURVE_COLOURS, EDGE_COLOUR, FAINT_COLOUR, GRID_LINE_COLOUR, INK_COLOUR

#: label of the colours on flanks
PRESSURE_LABEL = "largest pressure (MPa)"
#: label of curves of root stress
BENDING_LABEL = "bending stress (MPa)"
#: rows and columns of the raster of pressures
RASTER_SIZE = (181, 361)
#: margin of the raster around the pressed area, as a share of the flank
RASTER_MARGIN = 0.03
#: smallest pressure that is drawn, as a share of the scale
MIN_DRAWN_SHARE = 0.004
#: width of all panels side by side
ALL_PANELS_INCHES = 14.0
#: smallest width of a panel
MIN_PANEL_INCHES = 4.2
#: width that a panel needs beside its content
BESIDE_CONTENT_INCHES = 0.75
#: height that a panel needs above and below its content
ABOVE_CONTENT_INCHES = 0.8
#: smallest range (arcsec, um) of transmission errors that is shown
MIN_ERROR_RANGE = 0.02
#: number of torques from which the peak to peak is drawn over the torque
MIN_CURVE_TORQUES = 3
#: smallest difference of the load shares of halves that are drawn separately
MIN_SHARE_DIFFERENCE = 1e-3
#: ratio up to which pressures have the same text
SAME_PRESSURE_RATIO = 1.005
#: labels of the halves of double helical gears
HALF_LABELS = ("", ", other half")
#: number of positions below which each is marked
MAX_MARKED_POSITIONS = 12


@dataclass(frozen=True)
class LoadedPanel:
    """The flank of a member under one torque."""

    #: title of the panel
    name: str
    #: the flank and its plane
    plane: FlankPlane
    #: smallest and largest length and height (2, 2) of the raster, mm
    bounds: Array
    #: largest pressure (RASTER_SIZE) at each place, MPa, 0 without pressure
    pressure: Array
    #: places (N, 2) of edge contact, mm
    edges: Array

    @property
    def extent(self) -> tuple[float, float]:
        """Smallest and largest length with pressure."""
        return float(self.bounds[0, 0]), float(self.bounds[1, 0])

    def at(self, places: Array) -> Array:
        """Largest pressure (...,), MPa, at places (..., 2), mm."""
        low, high = self.bounds
        index = ((places - low) / (high - low) * self.pressure.shape[::-1] - 0.5)[..., ::-1].reshape(-1, 2)
        inside = ((index >= 0.0) & (index <= np.array(self.pressure.shape) - 1.0)).all(axis=1)
        interpolated = np.zeros(len(index))
        interpolated[inside] = bilinear(self.pressure[..., None], index[inside])[:, 0]
        return interpolated.reshape(places.shape[:-1])


def loaded_panel(plane: FlankPlane, prints: Footprints, member: int, name: str) -> LoadedPanel:
    """Return the panel of the flank of pinion (0) or gear (1), with the pressures of `prints`."""
    places = plane.frame.places(prints.own(member, prints.cells))
    edges = plane.frame.places(prints.own(member, prints.on_edges)).reshape(-1, 2)
    pressed, (low, high) = places[prints.pressure > 0.0], plane.frame.extent
    room = RASTER_MARGIN * (high - low)
    bounds = np.stack((np.maximum(pressed.min(axis=0) - room, low), np.minimum(pressed.max(axis=0) + room, high)))
    raster = largest_pressure(places, prints, bounds, RASTER_SIZE)
    return LoadedPanel(name, plane, bounds, raster, edges[np.isfinite(edges).all(axis=1)])


@dataclass(frozen=True)
class LoadedPattern:
    """Pressures of a mesh under torques on the flanks of both members."""

    gears: GearPair
    mesh: LoadedMesh

    @cached_property
    def prints(self) -> list[tuple[Footprints, ...]]:
        """Footprints for each torque, one for each half of double helical gears."""
        return [footprints(self.gears, self.mesh, k) for k in range(len(self.mesh.torque))]

    @cached_property
    def panels(self) -> dict[str, list[tuple[LoadedPanel, ...]]]:
        """Panels by member, for each torque; one for each half of double helical gears if the halves differ."""
        by_member = {}
        for k, (name, side) in enumerate(zip(self.gears.members, self.gears.flanks, strict=True)):
            plane = FlankPlane.of(self.gears.members[name], side)
            by_member[name] = [
                tuple(
                    loaded_panel(plane, part, k, f"{name}, {side} flank: {newton_metres(torque)}{HALF_LABELS[half]}")
                    for half, part in enumerate(_different(of_halves))
                )
                for of_halves, torque in zip(self.prints, self.mesh.torque, strict=True)
            ]
        return by_member

    def rows(self, names: Sequence[str]) -> list[list[LoadedPanel]]:
        """Return rows of panels: a row for each member, a panel for each torque and half."""
        return [[panel for of_torque in self.panels[name] for panel in of_torque] for name in names]

    @cached_property
    def limit(self) -> float:
        """Pressure, MPa, at which the scale of all panels ends."""
        return scale_limit(self.mesh, [panel.pressure for row in self.rows(tuple(self.panels)) for panel in row])

    @property
    def above(self) -> bool:
        """True if a pressure exceeds the end of the scale."""
        peaks = np.concatenate([load.peak for load in self.mesh.loads])
        return bool(np.nanmax(peaks, initial=0.0) > SAME_PRESSURE_RATIO * self.limit)


def footprints(gears: GearPair, mesh: LoadedMesh, torque: int) -> tuple[Footprints, ...]:
    """Return the footprints under a torque, one for each half of double helical gears."""
    return tuple(Footprints.of(gears, mesh, torque, half) for half in np.unique(mesh.loads[torque].half))


def _different(parts: tuple[Footprints, ...]) -> tuple[Footprints, ...]:
    """Return the footprints of both halves if they differ, otherwise of the first alone."""
    first, *others = parts
    alike = [
        len(other.phase) == len(first.phase) and np.allclose(other.share, first.share, atol=MIN_SHARE_DIFFERENCE)
        for other in others
    ]
    return parts[:1] if all(alike) else parts


def newton_metres(torque: float) -> str:
    """Text of a torque given in N mm."""
    return f"{1e-3 * torque:.4g} Nm"


def plot_loaded_flanks(
    file: Path | str,
    rows: Sequence[Sequence[LoadedPanel]],
    limit: float,
    title: str,
    size: tuple[int, int] | None = None,
    dpi: int = 150,
) -> None:
    """Plot rows of panels with one scale that ends at `limit`, MPa; `size` in pixels.

    Long flanks of several torques are above each other. Raises OutputError if the file cannot be written.
    """
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    if is_long([row[0].plane for row in rows]) and len(rows) < len(rows[0]):
        rows = [list(column) for column in zip(*rows, strict=True)]
    columns = max(map(len, rows))
    width = max(ALL_PANELS_INCHES / max(columns, 2), MIN_PANEL_INCHES)
    windows = [
        [flank_window(panel.plane.frame.extent, panel.extent, width - BESIDE_CONTENT_INCHES) for panel in row]
        for row in rows
    ]
    heights = [
        max(
            (width - BESIDE_CONTENT_INCHES) * (high - low) * tall / (right - left)
            for (left, right), (low, high), tall in row
        )
        + ABOVE_CONTENT_INCHES
        for row in windows
    ]
    inches, dots = sheet((width * columns + 1.0, sum(heights) + 0.8), size, dpi)
    figure = new_figure(inches, dots)
    grid = figure.subplots(len(rows), columns, squeeze=False, gridspec_kw={"height_ratios": heights})
    scale = ScalarMappable(Normalize(0.0, limit), COLOUR_MAP)
    for row, windows_of, places in zip(rows, windows, grid, strict=True):
        for panel, window, axes in zip(row, windows_of, places, strict=True):
            _draw_panel(axes, panel, window, scale)
    above = any((panel.pressure > limit).any() for row in rows for panel in row)
    bar = figure.colorbar(scale, ax=grid, extend="max" if above else "neither", shrink=0.9, fraction=0.03, pad=0.01)
    bar.set_label(PRESSURE_LABEL, fontsize=9, color=INK_COLOUR)
    bar.ax.tick_params(labelsize=8)
    if any(len(panel.edges) for row in rows for panel in row):
        handles, labels = next(legend for axes in grid.flat if (legend := axes.get_legend_handles_labels())[0])
        figure.legend(handles, labels, loc="outside lower center", frameon=False, fontsize=9, markerscale=3.0)
    figure.suptitle(title, color=INK_COLOUR)
    save_figure(figure, file)


def _draw_panel(axes: Any, panel: LoadedPanel, window: Any, scale: Any) -> None:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    plane = panel.plane
    (left, low), (right, high) = panel.bounds
    seen = np.ma.masked_less(panel.pressure, MIN_DRAWN_SHARE * scale.norm.vmax)
    drawn = axes.imshow(
        seen, cmap=scale.cmap, norm=scale.norm, extent=(left, right, low, high), origin="lower", zorder=1
    )
    border = PathPatch(Outline(plane.frame.outline), transform=axes.transData)
    draw_outline(axes, plane, window)
    drawn.set_clip_path(border)
    if len(panel.edges):
        axes.plot(
            *panel.edges.T, ls="", marker="o", ms=1.8, mew=0.0, color=EDGE_COLOUR, zorder=7,
            label="edge contact, whose pressure is singular, or contact longer than its grid",
        )  # fmt: skip
    (first, last), _, magnified = window
    left, right = plane.frame.extent[:, 0]
    notes = [f"{magnified:g} times as high"] if magnified > 1.0 else []
    if first > left or last < right:
        notes.append(f"cut off: flank from {left:.4g} to {right:.4g} mm")
    axes.set_title(panel.name + (f"  ({', '.join(notes)})" if notes else ""), fontsize=9.5, color=INK_COLOUR)
    axes.set_xlabel(plane.labels[0], fontsize=9)
    axes.set_ylabel(plane.labels[1], fontsize=9)
    axes.tick_params(labelsize=8)
    name_edges(axes, plane.frame, (first, last), 8.0)


# --- over the rotation ---


def plot_loaded_errors(
    file: Path | str,
    gears: GearPair,
    mesh: LoadedMesh,
    title: str,
    size: tuple[int, int] | None = None,
    dpi: int = 150,
    *,
    unloaded: float,
) -> None:
    """Plot the transmission errors of all torques and without load over phi1, absolute and minus their means.

    From `MIN_CURVE_TORQUES` torques on, the peak to peak is plotted over the torque. `unloaded` is its value without
    load over the whole mesh cycle, rad (NaN: unknown). Raises OutputError if the file cannot be written.
    """
    rad, unit = gears.output.reading.error
    word = unit.replace("um", "µm")
    turn = cycle_curves(gears, mesh.phi1)
    curves = [(mesh.unloaded, INK_COLOUR, "no load"), *_colours(mesh, mesh.te)]
    wide = 2 + (len(mesh.torque) >= MIN_CURVE_TORQUES)
    figure, places = _figure(wide, size, dpi)
    span = MIN_ERROR_RANGE
    for values, colour, label in curves:
        own = (values - mesh.unloaded[0]) / rad
        for axes, shown in ((places[0], own), (places[1], own - own.mean())):
            axes.plot(turn.degrees, turn.close(shown), color=colour, marker=turn.marker, ms=3, lw=1.6, label=label)
        span = max(span, float(np.ptp(own)))
    places[1].set_ylim(-0.75 * span, 0.75 * span)
    for axes, what in zip(places, ("transmission error", "transmission error less its mean"), strict=False):
        axes.set(xlabel="pinion rotation φ₁ (deg)", ylabel=f"{what} ({word})")
    if wide > 2:
        order = np.argsort(mesh.torque)
        peaks = mesh.te_peak_to_peak[order] / rad
        axes = places[2]
        axes.plot(np.r_[0.0, 1e-3 * mesh.torque[order]], np.r_[unloaded / rad, peaks], "o-", color=INK_COLOUR)
        axes.set(xlabel="torque on the pinion (Nm)", ylabel=f"peak to peak ({word})")
        axes.set_ylim(0.0, max(1.1 * float(np.nanmax([*peaks, unloaded / rad])), MIN_ERROR_RANGE))
        axes.set_xlim(left=0.0)
    _finish(figure, places, title, file, len(curves))


def plot_load_share(
    file: Path | str, gears: GearPair, mesh: LoadedMesh, title: str, size: tuple[int, int] | None = None, dpi: int = 150
) -> None:
    """Plot the load share of one tooth pair over its whole engagement, for all torques, and of its neighbours."""
    figure, (axes,) = _figure(1, size, dpi)
    low, high = np.inf, -np.inf
    for k, (_, colour, label) in enumerate(_colours(mesh, mesh.te)):
        for half, prints in enumerate(_different(footprints(gears, mesh, k))):
            carries = np.flatnonzero(prints.share > 0.0)
            if not carries.size:
                continue
            shown = slice(max(carries[0] - 1, 0), carries[-1] + 2)
            phase, share = _with_breaks(prints.phase[shown], 100.0 * prints.share[shown], gears.pitch)
            for n in (-1, 1):
                axes.plot(phase + n * np.degrees(gears.pitch), share, color=colour, lw=0.8, alpha=0.4)
            # curves of torques with equal shares coincide: the first is the widest
            width, few = 1.6 + 1.2 * (len(mesh.torque) - 1 - k), len(mesh.phi1) < MAX_MARKED_POSITIONS
            axes.plot(
                phase, share, label=label + HALF_LABELS[half], color=colour, ls=("-", ":")[half], lw=width,
                marker="o" if few else "", ms=3.0,
            )  # fmt: skip
            low, high = min(low, float(phase[0])), max(high, float(phase[-1]))
    axes.plot([], [], color=FAINT_COLOUR, lw=0.8, label="neighbouring tooth pairs")
    room = 0.1 * max(high - low, np.degrees(gears.pitch))
    axes.set_xlim(low - room, high + room)
    axes.set_ylim(0.0, 105.0)
    axes.set(xlabel="pinion rotation φ₁ (deg), in the mesh cycle of this tooth pair", ylabel="load share (%)")
    _finish(figure, [axes], title, file, len(mesh.torque) + 1)


def plot_root_stress(
    file: Path | str, gears: GearPair, mesh: LoadedMesh, title: str, size: tuple[int, int] | None = None, dpi: int = 150
) -> None:
    """Plot the bending stress in the fillets of both members over phi1, for all torques."""
    figure, places = _figure(2, size, dpi)
    turn = cycle_curves(gears, mesh.phi1)
    for n, (axes, name) in enumerate(zip(places, gears.members, strict=True)):
        for values, colour, label in _colours(mesh, mesh.bending[..., n]):
            axes.plot(turn.degrees, turn.close(values), color=colour, marker=turn.marker, ms=3, lw=1.6, label=label)
        axes.set(xlabel="pinion rotation φ₁ (deg)", ylabel=BENDING_LABEL)
        axes.set_title(f"fillets of the {name}", fontsize=10, color=INK_COLOUR)
    top = 1.08 * float(np.nanmax(mesh.bending))
    for axes in places:
        axes.set_ylim(0.0, top)
    _finish(figure, places, title, file, len(mesh.torque))


def plot_tooth_pair(
    file: Path | str, gears: GearPair, mesh: LoadedMesh, title: str, size: tuple[int, int] | None = None, dpi: int = 150
) -> None:
    """Plot the peak pressure and bending stresses of one tooth pair, for all torques [LF04 17.10.5, 17.10.6].

    Edge contact is marked; its pressure is not reported.
    """
    figure, places = _figure(3, size, dpi)
    curves, room = _colours(mesh, mesh.te), 0.1 * np.degrees(gears.pitch)
    for (_, colour, label), load in zip(curves, mesh.loads, strict=True):
        phase = mesh.phi1[load.position] - gears.pitch * load.number
        for half in np.unique(load.half):
            own = np.flatnonzero((load.half == half) & (load.force > 0.0))
            own = own[np.argsort(phase[own], kind="stable")]
            for axes, values in zip(places, (load.peak, *load.roots.nominal.T), strict=True):
                x, y = _with_breaks(phase[own], values[own], gears.pitch)
                axes.plot(
                    x, y, label=label + HALF_LABELS[half], color=colour, ls=("-", ":")[half], lw=1.6, marker="o", ms=2.5
                )
            edge = np.degrees(phase[own[load.edge_contact[own]]])
            places[0].plot(
                edge, np.zeros_like(edge), ls="", marker="|", ms=9, mew=1.5, color=EDGE_COLOUR, clip_on=False
            )
    if any(load.edge_contact.any() for load in mesh.loads):
        places[0].plot(
            [], [], ls="", marker="|", ms=9, mew=1.5, color=EDGE_COLOUR, label="edge contact: no peak is reported"
        )
    for axes, what in zip(places, ("contact", *(f"fillets of the {name}" for name in gears.members)), strict=True):
        axes.set_title(what, fontsize=10, color=INK_COLOUR)
        axes.set(xlabel="pinion rotation φ₁ of this pair (deg)", ylabel=BENDING_LABEL)
        axes.set_xlim(axes.dataLim.x0 - room, axes.dataLim.x1 + room)
        axes.set_ylim(bottom=0.0)
    places[0].set_ylabel("peak pressure (MPa)")
    _finish(figure, places, title, file, 2 * len(curves) + 1)


@dataclass(frozen=True)
class CycleCurves:
    """Abscissae of curves over phi1, deg, and the order of their values; a whole cycle ends with its first value."""

    degrees: Array
    order: NDArray[np.intp]

    def close(self, values: Array) -> Array:
        ordered: Array = values[self.order]
        return ordered

    @property
    def marker(self) -> str:
        return "o" if len(self.degrees) < MAX_MARKED_POSITIONS else ""


def cycle_curves(gears: GearPair, phi1: Array) -> CycleCurves:
    """Return the abscissae of curves over rotations (P,) of the pinion."""
    order = np.argsort(phi1, kind="stable")
    degrees = np.degrees(phi1[order])
    if not whole_cycle(gears, phi1):
        return CycleCurves(degrees, order)
    return CycleCurves(np.r_[degrees, degrees[0] + np.degrees(gears.pitch)], np.r_[order, order[0]])


def _with_breaks(phase: Array, values: Array, pitch: float) -> tuple[Array, Array]:
    """Return phases, deg, and values with NaN between phases that are far apart."""
    gaps = np.flatnonzero(np.diff(phase) > 0.5 * pitch) + 1
    return np.insert(np.degrees(phase), gaps, np.nan), np.insert(values, gaps, np.nan)


def _colours(mesh: LoadedMesh, values: Array) -> list[tuple[Array, str, str]]:
    """Values (T, ...) of the torques, each with its colour and name."""
    return [
        (value, CURVE_COLOURS[k % len(CURVE_COLOURS)], newton_metres(torque))
        for k, (value, torque) in enumerate(zip(values, mesh.torque, strict=True))
    ]


def _figure(count: int, size: tuple[int, int] | None, dpi: int) -> tuple[Any, list[Any]]:
    """Return a figure of plots side by side."""
    inches, dots = sheet(((8.0, 5.4, 5.0)[count - 1] * count, 5.0), size, dpi)
    figure = new_figure(inches, dots)
    return figure, list(figure.subplots(1, count, squeeze=False)[0])


def _finish(figure: Any, places: Sequence[Any], title: str, file: Path | str, curves: int) -> None:
    for axes in places:
        axes.grid(True, color=GRID_LINE_COLOUR, lw=0.8)
        axes.set_axisbelow(True)
    handles, labels = places[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=min(curves, 8), frameon=False, fontsize=9)
    figure.suptitle(title, color=INK_COLOUR)
    save_figure(figure, file)
