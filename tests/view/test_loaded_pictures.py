"""Pictures of gears under torque: the largest pressures against a closed form, cells on the exact flanks, files and refusals."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from oracles.command_line import refused, run
from oracles.loaded import loaded_contact
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError, LoadedContact, Rigid
from gearmesh.mesh.tessellate import tessellate
from gearmesh.progress import Progress
from gearmesh.view.load import loaded_diagrams
from gearmesh.view.load.footprints import Footprints, largest_pressure, scale_limit
from gearmesh.view.load.loaded_pictures import LoadedPictures
from gearmesh.view.projection import flank_projection

CROSSED = SAMPLES / "beveloid_crossed.toml"


@pytest.fixture(scope="module")
def loaded() -> LoadedContact:
    """Point contact on crossed axes."""
    return loaded_contact("beveloid_crossed", (2.0, 10.0, 30.0), 9)


@pytest.mark.quick
@pytest.mark.parametrize("slant", [0.0, 0.5])
def test_largest_pressure_is_that_of_the_ellipse_on_its_way(slant: float) -> None:
    """An ellipse (a, b) with the pressure p0 that moves by 3 b from phase to phase: every place on its way sees p0 sqrt(1 - t^2),
    with t its distance from the way over half the width of the ellipse across it; and none beyond."""
    a, b, peak = 4.0, 0.3, 900.0
    x, y = np.meshgrid((np.arange(80) + 0.5) * 0.2 / 2.0 - 4.0, (np.arange(24) + 0.5) / 24.0 * 0.8 - 0.4, indexing="ij")
    pressure = peak * np.sqrt(np.maximum(1.0 - (x / a) ** 2 - (y / b) ** 2, 0.0))
    turn = np.array([[np.cos(slant), -np.sin(slant)], [np.sin(slant), np.cos(slant)]])
    way = 3.0 * b * np.arange(9)
    places = np.stack((x, y), axis=-1) @ turn.T + way[:, None, None, None] * [0.0, 1.0]
    count = len(way)
    prints = Footprints(
        way, np.zeros((count, 80, 3)), np.zeros((count, 3)), np.zeros((count, 3)), np.zeros((count, 24)),
        (Rigid.identity(), Rigid.identity()), np.repeat(pressure[None], count, axis=0), np.zeros((count, 80, 24), dtype=bool),
        np.ones(count), np.ones(count - 1, dtype=bool),
    )  # fmt: skip
    extent = np.array([[-6.0, -2.0], [6.0, 9.0]])
    found = largest_pressure(places, prints, extent, (220, 240))
    columns = -6.0 + 12.0 * (np.arange(240) + 0.5) / 240
    half = np.hypot(a * np.cos(slant), b * np.sin(slant))
    wanted = peak * np.sqrt(np.maximum(1.0 - (columns / half) ** 2, 0.0))
    # heights that the ellipse passes over from side to side
    passed = found[80:140]
    inner = np.abs(columns) < 0.8 * half
    np.testing.assert_allclose(passed[:, inner], np.broadcast_to(wanted[inner], (60, inner.sum())), rtol=0.02)
    assert not passed[:, np.abs(columns) > half + 0.2].any()


@pytest.mark.sweep
def test_footprints_lie_on_the_flanks(loaded: LoadedContact) -> None:
    """Cells in the frames of both members, on the exact flanks within what the tangent plane is away; phases ascend, and all pairs
    that stand a pitch apart carry the torque together."""
    pair = loaded.pair
    prints = Footprints.of(pair, loaded.mesh, 2)
    pressed = prints.pressure > 0.0
    assert pressed.any()
    for k, name in enumerate(pair.members):
        own = prints.own(k, prints.cells)[pressed]
        there = flank_projection(pair.members[name], pair.flanks[k])(own)
        assert (
            np.nanmax(np.linalg.norm(there - own, axis=1)) < 0.01
        )  # mm; flanks are round, the widest cells 0.2 mm off
        assert np.isfinite(there[:, 0]).mean() > 0.95
    assert (np.diff(prints.phase) > 0.0).all()
    assert prints.joined.all()
    steps = np.rint(prints.phase / pair.pitch * 9.0).astype(int) % 9
    np.testing.assert_allclose(np.bincount(steps, prints.share), 1.0, rtol=1e-9)
    # neighbours are counted the same way along
    along = prints.middle[:, -1] - prints.middle[:, 0]
    assert (np.einsum("fi,fi->f", along[1:], along[:-1]) > 0.0).all()


@pytest.mark.sweep
@pytest.mark.quick
def test_halves_are_told_apart(loaded: LoadedContact) -> None:
    """Tooth pairs of double helical gears are divided by half, in order; together the halves have all pairs and shares."""
    load = loaded.mesh.loads[0]
    halves = loaded_diagrams.footprints(loaded.pair, loaded.mesh, 0)
    assert len(halves) == 1
    mesh = replace(loaded.mesh, loads=(replace(load, half=load.position % 2),))
    parts = loaded_diagrams.footprints(loaded.pair, mesh, 0)
    assert [len(part.phase) for part in parts] == np.bincount(load.position % 2).tolist()
    np.testing.assert_array_equal(np.sort(np.concatenate([part.phase for part in parts])), halves[0].phase)
    assert sum(part.share.sum() for part in parts) == pytest.approx(halves[0].share.sum())


@pytest.mark.quick
def test_panels_hold_all_pressure_on_one_scale(loaded: LoadedContact) -> None:
    pattern = LoadedPictures(loaded).pattern
    for k, (load, *rows) in enumerate(zip(loaded.mesh.loads, *pattern.panels.values(), strict=True)):
        panels = [panel for (panel,) in rows]
        for panel in panels:
            assert 0.9 * load.pressure.max() < panel.pressure.max() <= load.pressure.max()
            # places are taken back from the raster
            rows, columns = np.indices(panel.pressure.shape)
            low, high = panel.bounds
            places = low + (np.stack((columns, rows), axis=-1) + 0.5) / panel.pressure.shape[::-1] * (high - low)
            np.testing.assert_allclose(panel.at(places), panel.pressure, atol=1e-9)
        assert f"{(2, 10, 30)[k]} Nm" in panels[0].name
    rasters = [panel.pressure for row in pattern.rows(("pinion", "gear")) for panel in row]
    assert pattern.limit == scale_limit(loaded.mesh, rasters)
    assert pattern.limit < loaded.mesh.loads[-1].pressure.max() * 1.25


@pytest.mark.quick
def test_figures_show_the_figures(loaded: LoadedContact, monkeypatch: pytest.MonkeyPatch) -> None:
    """Curves: one for each torque, closed at the end of a whole cycle; shares over the phases of a pair."""
    kept: list[Any] = []
    monkeypatch.setattr(loaded_diagrams, "save_figure", lambda figure, file: kept.append(figure))
    for view in ("loaded_te", "loaded_share", "loaded_stress", "loaded_pair"):
        LoadedPictures(loaded).picture(view).save("a.svg")
    errors, shares, stresses, of_pair = kept
    mesh, degrees = loaded.mesh, np.degrees(loaded.pair.pitch)
    lines = {line.get_label(): line.get_xydata().T for line in errors.axes[0].lines}
    assert list(lines) == ["no load", "2 Nm", "10 Nm", "30 Nm"]
    x, y = lines["10 Nm"]
    assert x[-1] - x[0] == pytest.approx(degrees)
    np.testing.assert_allclose(y[:-1], [each.te for each in loaded.rows if each.torque == 10.0])
    assert y[-1] == y[0]
    peaks = errors.axes[2].lines[0].get_xydata()
    np.testing.assert_allclose(peaks[1:, 1], [each.te_peak_to_peak for each in loaded.totals])
    share = next(line.get_ydata() for line in shares.axes[0].lines if line.get_label() == "30 Nm")
    assert np.nansum(share) == pytest.approx(900.0)
    for n, axes in enumerate(stresses.axes):
        np.testing.assert_array_equal(axes.lines[2].get_ydata()[:-1], mesh.bending[2, :, n])
    rows = [each.row for each in loaded.tooth_pair]
    for axes, key in zip(of_pair.axes, ("peak_pressure", "pinion_bending_stress", "gear_bending_stress"), strict=True):
        drawn = next(line.get_xydata() for line in axes.lines if line.get_label() == "30 Nm")
        wanted = [(each["phi1_deg"], each[f"{key}_mpa"]) for each in rows if each["torque_nm"] == 30.0]
        np.testing.assert_allclose(drawn, wanted)


@pytest.mark.quick
def test_what_is_no_picture_is_said(loaded: LoadedContact) -> None:
    with pytest.raises(DesignError, match="view = te: must be one of loaded, loaded_flank, loaded_te"):
        LoadedPictures(loaded).picture("te")
    with pytest.raises(DesignError, match="member = hub: must be one of pinion, gear"):
        LoadedPictures(loaded).picture(member="hub")
    with pytest.raises(DesignError, match="torque = 3 Nm: must be one of 2, 10, 30"):
        LoadedPictures(loaded).picture("loaded", torque=3.0)
    with pytest.raises(DesignError, match="torque = 2 Nm: loaded_te shows all torques"):
        LoadedPictures(loaded).picture("loaded_te", torque=2.0)


@pytest.mark.quick
def test_render_draws_loaded_contact(loaded: LoadedContact, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    asked: list[Any] = []

    def solve(gears: gm.Gears, *args: Any, progress: Progress, **more: Any) -> LoadedContact:
        progress(0.0, "bending of teeth")
        asked.append((args, more))
        return loaded

    monkeypatch.setattr(gm.Gears, "loaded_contact", solve)
    done, _, said = run("render", CROSSED, "-o", "a.svg", "--view", "loaded_te", "--torque", "2,10")
    assert done == 0
    # the solver was silent for minutes
    assert [line for line in said.splitlines() if "warning" not in line] == [
        "gearmesh: bending of teeth",
        "gearmesh: picture",
    ]
    assert (tmp_path / "a.svg").read_text().startswith("<?xml")
    # once of gears that are not built, for refusals, and once of those that are
    assert asked == [(([2.0, 10.0], None), {"pair": "pinion-gear"})] * 2
    to = ("render", CROSSED, "-o", "a.png")
    assert refused(*to, "--view", "loaded_te").startswith("--torque: missing; the view loaded_te needs NM[,NM...]")
    assert refused(*to, "--torque", "3").startswith("--torque = 3: is for the views loaded, loaded_flank")
    assert refused(*to, "--view", "loaded", "--torque", "3,4").startswith("--torque = 3,4: must be one torque for")
    assert refused(*to, "--view", "loaded", "--torque", "0").startswith("--torque = 0: must be finite numbers of Nm")
    assert refused(*to, "--view", "loaded", "--torque", "3", "--animate", "a.gif").startswith(
        "--animate = a.gif: is not"
    )


@pytest.mark.sweep
def test_all_pictures_go_into_a_folder(loaded: LoadedContact, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """On teeth what is pressed lies on the tooth, not below and not far above it."""
    scenes: list[Any] = []
    monkeypatch.setattr("gearmesh.view.opengl.missing_opengl_message", lambda: None)
    monkeypatch.setattr(
        "gearmesh.view.render.render", lambda scene, file: (scenes.append(scene), file.write_bytes(b"drawn"))
    )
    files = LoadedPictures(loaded).save(tmp_path, "a_")
    names = [
        "loaded_flank",
        "loaded_te",
        "loaded_share",
        "loaded_stress",
        "loaded_pair",
        "pinion_loaded",
        "gear_loaded",
    ]
    assert [file.name for file in files] == [f"a_{name}.png" for name in names]
    assert all(file.stat().st_size for file in files)
    for k, (name, scene) in enumerate(zip(loaded.pair.members, scenes, strict=True)):
        assert f"{name}, largest pressure over a mesh cycle, 30 Nm" in scene.title
        (drawn,) = scene.maps
        shown = drawn.points[np.isfinite(drawn.values)]
        foot = flank_projection(loaded.pair.members[name], loaded.pair.flanks[k])(shown)
        assert 0.0 < np.nanmax(np.linalg.norm(shown - foot, axis=-1)) < 0.1
        assert 0.5 * drawn.limit < np.nanmax(drawn.values) < drawn.limit


@pytest.mark.sweep
def test_a_run_meshes_the_teeth_of_its_pictures_once(
    loaded: LoadedContact, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pictures of contact and of loaded contact show the same teeth: each of both once more finely than its coarse solid, and once
    as a part of its gear."""
    gears = gm.build(gm.load(CROSSED, ["contact.phi1.count=3"]))
    meshed: list[float] = []
    monkeypatch.setattr(
        "gearmesh.view.pictures.tessellate",
        lambda tooth, tolerance, **keys: meshed.append(tolerance) or tessellate(tooth, tolerance, **keys),
    )
    monkeypatch.setattr("gearmesh.reports.run._solve", lambda *_: ({0: gears.contact()}, {0: loaded}))
    monkeypatch.setattr("gearmesh.answers.check.ROLL_TOLERANCE_MM", 1e-3)
    monkeypatch.setattr("gearmesh.view.opengl.missing_opengl_message", lambda: None)
    for module in ("reports.run", "view.render"):
        monkeypatch.setattr(f"gearmesh.{module}.render", lambda scene, file: file.write_bytes(b"drawn"))
    # no plots
    monkeypatch.setattr("gearmesh.view.pictures.plots", lambda *_: [])
    monkeypatch.setattr(LoadedPictures, "_figure", lambda self, *_: SimpleNamespace(save=lambda file: file))
    report = gears.run(tmp_path, "50um", page=False, torque=[2.0])
    assert {"pinion_loaded.png", "pinion_contact.png"} <= {file.name for file in report.files}
    assert len(set(meshed)) == len(meshed) == 4
