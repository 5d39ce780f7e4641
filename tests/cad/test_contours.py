"""Contours for machines: arcs, chords and parallels against the exact section, as two readers take them from the file."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from oracles.command_line import refused
from oracles.places import SAMPLES
from oracles.plane_curves import evenly, from_polylines

import gearmesh as gm
from gearmesh.cad.contours.curves import Contour
from gearmesh.cad.contours.parallel import parallels
from gearmesh.cad.contours.redrawn import Curves
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneArc, PlaneLine

#: mm: a keyed pinion, a ring and a rack; what every file is asked to keep
GEARS = {
    "keyed": ("helical", ["pinion.bore=30", "pinion.keyway={width=8, depth=3.3}"], "pinion"),
    "ring": ("internal", [], "gear"),
    "rack": ("rack", [], "rack"),
}
TOLERANCE = 1e-3
#: mm: what chords of the exact section miss of it
CHORD = 5e-5


def arc_points(start: Array, end: Array, bulge: float) -> Array:
    """Points of the arc from start to end (2,) whose quarter angle has the tangent `bulge`."""
    if bulge == 0.0:
        return start + np.linspace(0.0, 1.0, 9)[:, None] * (end - start)
    chord = end - start
    centre = 0.5 * (start + end) + 0.25 * (1.0 / bulge - bulge) * np.array([-chord[1], chord[0]])
    angle = np.linspace(0.0, 4.0 * np.arctan(bulge), 33)
    (x, y), c, s = start - centre, np.cos(angle), np.sin(angle)
    return np.asarray(centre + np.stack((c * x - s * y, s * x + c * y), axis=-1))


def by_group_codes(text: str) -> list[tuple[str, Array]]:
    """Layer and points of LWPOLYLINE and CIRCLE entities, read from the pairs of code and value alone."""
    lines = text.splitlines()
    pairs = [(int(code), value.strip()) for code, value in zip(lines[::2], lines[1::2], strict=True)]
    begins = [k for k, (code, _) in enumerate(pairs) if code == 0]
    found = []
    for begin, end in pairwise([*begins, len(pairs)]):
        entity = pairs[begin + 1 : end]
        layer = next((value for code, value in entity if code == 8), "")
        if pairs[begin][1] == "CIRCLE":
            x, y, radius = (next(float(v) for c, v in entity if c == code) for code in (10, 20, 40))
            turn = np.linspace(0.0, 2.0 * np.pi, 4001)
            found.append((layer, np.array([x, y]) + radius * np.stack((np.cos(turn), np.sin(turn)), axis=-1)))
        if pairs[begin][1] == "LWPOLYLINE":
            assert (70, "1") in entity, "closed"
            corners: list[list[float]] = []
            for code, value in entity:
                if code == 10:
                    corners.append([float(value), 0.0, 0.0])
                elif code in (20, 42):
                    corners[-1][1 if code == 20 else 2] = float(value)
            places = np.array([*corners, corners[0]])
            parts = [arc_points(a[:2], b[:2], a[2]) for a, b in pairwise(places)]
            found.append((layer, np.concatenate(parts)))
    return found


def by_ezdxf(path: Path) -> list[tuple[str, Array]]:
    """The same as ezdxf takes it."""
    from ezdxf.filemanagement import readfile

    document = readfile(path)
    assert not document.audit().errors
    found = []
    for entity in document.modelspace():
        if entity.dxftype() == "CIRCLE":
            points = np.array([tuple(p) for p in entity.flattening(1e-6)])
        else:
            parts = [
                [tuple(p) for p in part.flattening(1e-6)]
                if part.dxftype() == "ARC"
                else [tuple(part.dxf.start), tuple(part.dxf.end)]
                for part in entity.virtual_entities()
            ]
            points = np.concatenate([np.array(part) for part in parts])
        found.append((entity.dxf.layer, points[:, :2]))
    return found


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("case", "kind", "offset"),
    [
        ("keyed", "arcs", 0.0),
        ("keyed", "polyline", -0.135),
        ("ring", "arcs", 0.25),
        ("rack", "arcs", 1.4),
    ],
)
def test_files_are_as_far_from_the_exact_section_as_they_should(
    case: str, kind: str, offset: float, tmp_path: Path
) -> None:
    """The exact one is that of splines within 10 nm, which test_section proves against the surfaces."""
    pytest.importorskip("ezdxf")
    sample, changes, name = GEARS[case]
    gears = gm.build(gm.load(SAMPLES / f"{sample}.toml", changes), alone=True)
    exact = gears.section(name, tolerance=1e-5)
    lines = [evenly(curve) for loop in exact.loops for curve in loop.curves]
    section = gears.section(name, curves=kind, offset=offset, tolerance=TOLERANCE)
    path = section.save(tmp_path / "a.dxf")
    assert section.complaints == []
    assert section.measured.max_deviation <= 1e3 * TOLERANCE
    for read in (by_group_codes(path.read_text()), by_ezdxf(path)):
        # one entity round every contour
        assert [layer for layer, _ in read] == [f"{name}_{loop.name}" for loop in section.loops]
        drawn = np.concatenate([points[:: max(1, len(points) // 4000)] for _, points in read])
        assert np.abs(from_polylines(drawn, lines) - abs(offset)).max() <= TOLERANCE + CHORD
    # and on the side that the sign says: outside of the part, where its bores become narrower
    assert np.sign(section.area - exact.area) == np.sign(offset) or offset == 0.0
    if kind == "arcs" and offset == 0.0:
        assert tangent(section.loops[0].curves, 24)


def tangent(curves: tuple[object, ...], corners: int) -> bool:
    """True if neighbours have the same direction where they meet, but for at most `corners` for every tooth of 24."""
    ends = np.array([curve.slope(np.ones(1))[0] for curve in curves])  # type: ignore[attr-defined]
    starts = np.array([curve.slope(np.zeros(1))[0] for curve in curves])  # type: ignore[attr-defined]
    starts = np.roll(starts, -1, axis=0)
    cross = ends[:, 0] * starts[:, 1] - ends[:, 1] * starts[:, 0]
    turn = np.abs(cross) / (np.linalg.norm(ends, axis=-1) * np.linalg.norm(starts, axis=-1))
    return bool((turn > 1e-3).sum() <= 2 * corners) and bool(np.median(turn) < 1e-9)


@pytest.mark.quick
def test_parallels_of_a_slotted_plate_in_closed_form() -> None:
    """A square of 10 mm with a slot 2 mm wide and 4 mm deep: outside of it arcs of a quarter, in the slot its sharp corners."""
    corners = [(-5, -5), (5, -5), (5, 5), (1, 5), (1, 1), (-1, 1), (-1, 5), (-5, 5)]
    points = [np.array(corner, dtype=float) for corner in corners]
    plate = Contour("plate", tuple(PlaneLine(a, b) for a, b in pairwise([*points, points[0]])), True)
    (made,), missed = parallels(plate, 0.6, Curves.ARCS, 1e-6)
    assert missed == 0.0
    assert made.gap <= 1e-12
    arcs = [curve for curve in made.curves if isinstance(curve, PlaneArc)]
    # four corners of the square and both at the slot's mouth
    assert [round(curve.width / (0.5 * np.pi), 9) for curve in arcs] == [1.0] * 6
    # strips along all sides but inside the slot, which is 0.8 mm wide then, and sectors
    assert made.area == pytest.approx(11.2**2 - (4 - np.pi) * 0.36 - 0.8 * 4.0 - 2 * (0.36 - 0.09 * np.pi), abs=1e-9)
    # wider than half the slot: it is closed, with a notch between the arcs at its mouth
    (closed,), _ = parallels(plate, 1.3, Curves.ARCS, 1e-6)
    notch = [curve for curve in closed.curves if isinstance(curve, PlaneArc) and abs(curve.width) < 0.5 * np.pi - 1e-6]
    assert [curve.width for curve in notch] == pytest.approx([np.arcsin(1.0 / 1.3)] * 2)
    # below the slot, the walls beside it, and what its rounded corners leave between
    (inner,), _ = parallels(plate, -1.9, Curves.ARCS, 1e-6)
    assert inner.area == pytest.approx(6.2 * 2.2 + 2 * 0.2 * 4.0 + 2 * (1.0 - 0.25 * np.pi) * 1.9**2, abs=1e-9)
    assert parallels(plate, -3.1, Curves.ARCS, 1e-6) == ((), 0.0)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("-o a.stl --curves arcs", "--curves = arcs: must be left out for .stl"),
        ("-o a.svg --curves bezier", "--curves = bezier: must be one of splines, arcs, polyline"),
        ("-o a.svg --offset 1um", "--offset = 0.001 mm: must be 0, or at least 0.01 mm either way"),
        ("-o a.svg --offset 30", "--offset = 30 mm: the bore of the pinion has no room for it; allowed is less than"),
        # ended in MemoryError
        (
            "-o a.svg --offset 1e6",
            "--offset = 1000000 mm: the bore of the pinion has no room for it; allowed is less than",
        ),
        ("-o a.svg --offset=-1e6", "--offset = -1000000 mm: between teeth and bore of the pinion are"),
        ("-o a.svg --offset=-30", "--offset = -30 mm: between teeth and bore of the pinion are"),
    ],
)
@pytest.mark.sweep_cases(
    "-o a.svg --offset 30---offset = 30 mm: the bore of the pinion has no room for it; allowed is less than",
    "-o a.svg --offset=-1e6---offset = -1000000 mm: between teeth and bore of the pinion are",
)
def test_refusals(arguments: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert refused("solid", SAMPLES / "helical.toml", "--member", "pinion", *arguments.split(" ")).startswith(words)
    assert not list(tmp_path.iterdir())


def test_holes_become_polylines_within_the_tolerance() -> None:
    """A whole circle ended in a ValueError: its first chord had no length. Reference: the area of the polygon in a circle."""
    cut = gm.build(gm.load(SAMPLES / "cycloidal.toml")).section("disc", tolerance=2e-3, curves="polyline")
    assert cut.measured.max_deviation <= 2.0
    holes = [loop for loop in cut.loops if not loop.material and len(loop.curves) < 300]
    # the bore, and six holes for pins of 8 mm with an eccentricity of 1.5 mm and a clearance of 0.02 mm
    for hole, expected in zip(sorted(holes, key=lambda loop: abs(loop.area)), (*[5.51] * 6, 15.0), strict=True):
        points = np.array([line.start for line in hole.curves])
        radius = np.linalg.norm(points - points.mean(axis=0), axis=1).mean()
        assert radius == pytest.approx(expected, abs=1e-9)
        turn = 2.0 * np.pi / len(points)
        # the sagitta of a chord is what a polygon misses
        assert radius * (1.0 - np.cos(0.5 * turn)) < 2e-3
        assert abs(hole.area) == pytest.approx(0.5 * len(points) * radius**2 * np.sin(turn), rel=1e-3)
