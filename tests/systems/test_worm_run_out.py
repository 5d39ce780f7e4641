"""Threads of worms that run out: the square thread, moved away from the axis at every height by as much as its root rises."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.examples import some
from oracles.worm_drives import FORMS, drive

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.kinds import Region

#: mm: of the thread, and of its run-outs
LENGTH, RUN_OUT = 40.0, 14.0


def worm(form: str = "ZI", **keys: float) -> gm.Gears:
    return drive(form, worm={"length": LENGTH, "run_out": RUN_OUT, **keys})


@pytest.mark.parametrize("form", some(FORMS, 2))
@pytest.mark.sweep_cases("ZC")
def test_all_of_the_thread_moves_away_from_the_axis(form: str) -> None:
    """Against the thread without run-out by its polar angles: at every height rho differs by the rise of the root, which is smooth
    and leaves next to no flank at the end; jets by differences."""
    gears = worm(form)
    square, own = (of.members["worm"].tooth for of in (drive(form, worm={"length": LENGTH + 2.0 * RUN_OUT}), gears))
    sections = own.sections(np.linspace(0.0, 1.0, 41))
    root = own.grid(Region.ROOT, np.array([0.5]), sections).points[0]
    rise = np.hypot(root[:, 0], root[:, 1]) - 24.0
    outside = np.maximum(np.abs(root[:, 2]) - 0.5 * LENGTH, 0.0) / RUN_OUT
    np.testing.assert_allclose(rise, rise[0] * outside**3, rtol=0, atol=1e-12)
    for mine, theirs in ((own.right, square.right), (own.left, square.left)):
        for surface, plain, ends in (
            (mine.flank, theirs.flank, (mine.form_point[0], mine.tip)),
            (mine.fillet, theirs.fillet, (mine.form_point[1], mine.root)),
        ):
            p, v = np.meshgrid(np.linspace(*ends, 4), np.linspace(-6.5, 6.5, 31))
            jet, before, step = surface.jet(p, v), plain.jet(p, v), 1e-5
            outside = np.maximum(np.abs(before.r[..., 2]) - 0.5 * LENGTH, 0.0) / RUN_OUT
            moved = np.hypot(jet.r[..., 0], jet.r[..., 1]) - np.hypot(before.r[..., 0], before.r[..., 1])
            np.testing.assert_allclose(moved, rise[0] * outside**3, rtol=0, atol=1e-12)
            np.testing.assert_allclose(jet.r[..., 2], before.r[..., 2], rtol=0, atol=1e-12)
            for name, ahead, back in (
                ("u", surface.jet(p + step, v), surface.jet(p - step, v)),
                ("v", surface.jet(p, v + step), surface.jet(p, v - step)),
            ):
                for of in ("r", "n"):
                    exact = getattr(jet, f"{of}_{name}")
                    difference = (getattr(ahead, of) - getattr(back, of)) / (2.0 * step)
                    np.testing.assert_allclose(difference, exact, rtol=0, atol=1e-7 * (1.0 + np.abs(exact).max()))
    flank = own.grid(Region.FLANK_RIGHT, np.array([0.0, 1.0]), sections).points
    height = np.diff(np.hypot(flank[..., 0], flank[..., 1]), axis=0)[0]
    assert height[[0, -1]] == pytest.approx(0.05 * 5.0, rel=0.05)


@pytest.mark.sweep
@pytest.mark.parametrize(
    "changes", some([{"threads": 1}, {}, {"tip_chamfer": 0.3, "threads": 3, "end_chamfer": 0.3}], 1)
)
def test_solids_with_run_outs_are_closed_and_within_tolerance(changes: dict[str, float]) -> None:
    """Mesh, CAD and quadrature agree; the land is on the tip cylinder from end to end."""
    gears = worm(**changes)
    solid = gears.solid("worm", 0.05)
    assert solid.figures["watertight"]
    assert solid.figures["max_deviation_um"] <= 50.0
    (figures,) = gears.cad("worm").figures.values()
    assert abs(figures["volume_error"]) < 1e-6
    rho = np.hypot(solid.mesh.vertices[:, 0], solid.mesh.vertices[:, 1])
    assert rho.max() == pytest.approx(35.0, abs=1e-9)
    assert np.abs(solid.mesh.vertices[:, 2]).max() == pytest.approx(0.5 * LENGTH + RUN_OUT, abs=1e-9)


def test_run_outs_that_are_too_short_are_refused() -> None:
    with pytest.raises(
        DesignError, match=r"worm.run_out = 5 mm: the root would rise by more than 70 deg; .* at least 11.0074 mm"
    ):
        worm(run_out=5.0)
