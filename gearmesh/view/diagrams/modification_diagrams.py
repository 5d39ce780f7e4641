"""Diagrams of micro-geometry as on measuring sheets: profile and helix diagrams of both flanks, and topography maps.

They show the distance of a flank behind its true involute, or behind a rack's plane, along the line of action in the
transverse plane.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.micro_geometry.plane_flank import PlaneFlank
from gearmesh.teeth.micro_geometry.screw_involute import ScrewInvolute
from gearmesh.teeth.region import Side
from gearmesh.view.diagrams.plots import new_figure, save_figure
from gearmesh.view.palette import CURVE_COLOURS, FAINT_COLOUR, GRID_LINE_COLOUR, INK_COLOUR

#: points of a trace
POINTS_PER_TRACE = 401
#: points of a map in each direction
POINTS_PER_MAP_AXIS = 161
#: shares of the face, or of the profile, at which the traces lie
TRACE_SHARES = (0.1, 0.5, 0.9)
#: classes of flanks whose removed amounts are known
CLOSED_FORM_FLANKS = (ScrewInvolute, PlaneFlank)
#: approximate steps of colour in a map
COLOUR_LEVELS = 14


@dataclass(frozen=True)
class FlankMap:
    """The amount that modifications remove from a flank."""

    #: side of the flank
    side: Side
    #: roll lengths (L,), or heights of a rack, mm
    length: Array
    #: positions (Z,) along the axis, mm
    z: Array
    #: removed amount (L, Z), um
    removed: Array
    #: lengths and positions, mm, at which the amount is not smooth
    breaks: tuple[tuple[float, ...], tuple[float, ...]]
    #: name of the lengths
    measure: str


def flank_map(member: Member, which: Side, count: int = POINTS_PER_MAP_AXIS) -> FlankMap:
    """Return the map of a flank in closed form, from its beginning to its end at mid face, and from toe to heel."""
    tooth = member.tooth
    side = tooth.side(which)
    flank = side.flank
    assert isinstance(flank, CLOSED_FORM_FLANKS)
    begins, ends = tooth.flank_grid(which, [0.0, 1.0], [0.5]).parameters[:, 0, 0]
    toe, heel = tooth.blank.extent
    length, z = np.linspace(begins, ends, count), np.linspace(toe, heel, count)
    grid = np.meshgrid(length, z, indexing="ij")
    removed = np.zeros(grid[0].shape) if flank.amount is None else 1e3 * flank.amount.jet(*grid).a
    measure = "roll length" if isinstance(flank, ScrewInvolute) else "height"
    return FlankMap(which, length, z, removed, (side.flank_breaks, side.face_breaks), measure)


def is_modified(member: Member) -> bool:
    """True if the micro-geometry of a member's flanks can be drawn.

    Both flanks have closed forms, not deviations, and one of them is modified.
    """
    flanks = [member.tooth.side(side).flank for side in Side]
    closed = [flank for flank in flanks if isinstance(flank, CLOSED_FORM_FLANKS)]
    return len(closed) == len(flanks) and any(flank.amount is not None for flank in closed)


def plot_modifications(file: Path | str, member: Member) -> None:
    """Plot profile diagrams, helix diagrams and maps of a member's flanks, left flank at the left; amounts in um.

    Traces lie at a tenth, the middle and nine tenths of face and profile. Raises OutputError if the file cannot be
    written.
    """
    maps = [flank_map(member, side, POINTS_PER_TRACE) for side in (Side.LEFT, Side.RIGHT)]
    figure = new_figure((11.0, 8.5))
    rows = figure.subplots(3, 2, gridspec_kw={"height_ratios": (1.0, 0.8, 1.2)})
    low = min(0.0, *(float(flank_map.removed.min()) for flank_map in maps))
    high = max(float(flank_map.removed.max()) for flank_map in maps)
    # an unmodified flank must not look like a signal
    room = 0.08 * max(high - low, 1.0)
    limits = low - room, max(high, low + 1.0) + room
    for column, own in enumerate(maps):
        _profile(rows[0, column], own, limits)
        _helix(rows[1, column], own, limits)
        drawn = _map(rows[2, column], own, (low, max(high, low + 1.0)))
    figure.colorbar(drawn, ax=list(rows[2]), label="removed (µm)")
    figure.suptitle(f"Modifications of the {member.name}")
    save_figure(figure, file)


def _profile(axes: Any, flank_map: FlankMap, limits: tuple[float, float]) -> None:
    """Draw the removed amount over the roll length, which points upwards as on a measuring sheet."""
    for share, style in zip(TRACE_SHARES, ("--", "-", ":"), strict=True):
        k = round(share * (flank_map.z.size - 1))
        axes.plot(
            flank_map.removed[:, k],
            flank_map.length,
            style,
            color=CURVE_COLOURS[0],
            lw=1.6,
            label=f"z = {flank_map.z[k]:.4g} mm",
        )
    for place in flank_map.breaks[0]:
        axes.axhline(place, color=FAINT_COLOUR, lw=0.8, ls="-.")
    axes.set(
        title=f"{flank_map.side} flank: profile", xlabel="removed (µm)", ylabel=f"{flank_map.measure} (mm)", xlim=limits
    )
    _finish(axes)


def _helix(axes: Any, flank_map: FlankMap, limits: tuple[float, float]) -> None:
    for share, style in zip(TRACE_SHARES, ("--", "-", ":"), strict=True):
        k = round(share * (flank_map.length.size - 1))
        label = f"{flank_map.measure} {flank_map.length[k]:.4g} mm"
        axes.plot(flank_map.z, flank_map.removed[k], style, color=CURVE_COLOURS[0], lw=1.6, label=label)
    for place in flank_map.breaks[1]:
        axes.axvline(place, color=FAINT_COLOUR, lw=0.8, ls="-.")
    axes.set(title=f"{flank_map.side} flank: helix", xlabel="z along the face (mm)", ylabel="removed (µm)", ylim=limits)
    _finish(axes)


def _map(axes: Any, flank_map: FlankMap, limits: tuple[float, float]) -> Any:
    from matplotlib.ticker import MaxNLocator

    levels = MaxNLocator(COLOUR_LEVELS).tick_values(*limits)
    drawn = axes.contourf(flank_map.z, flank_map.length, flank_map.removed, levels=levels, cmap="viridis")
    for place in flank_map.breaks[0]:
        axes.axhline(place, color="white", lw=0.8, ls="-.")
    for place in flank_map.breaks[1]:
        axes.axvline(place, color="white", lw=0.8, ls="-.")
    axes.set(
        title=f"{flank_map.side} flank: topography", xlabel="z along the face (mm)", ylabel=f"{flank_map.measure} (mm)"
    )
    return drawn


def _finish(axes: Any) -> None:
    axes.grid(True, color=GRID_LINE_COLOUR, lw=0.8)
    axes.set_axisbelow(True)
    axes.legend(fontsize="small")
    axes.tick_params(colors=INK_COLOUR)
