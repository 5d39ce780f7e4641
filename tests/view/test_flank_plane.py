"""Flanks in their planes: what lies on a flank lies in its outline, ellipses and patterns are as large as they are."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.path import Path as Polygon
from matplotlib.quiver import Quiver

import gearmesh as gm
from gearmesh import Contact
from gearmesh.contact.flanks import solver_pair
from gearmesh.kernel.numeric.algebra import dot, unit
from gearmesh.view.diagrams import flank_diagrams
from gearmesh.view.diagrams.flank_diagrams import ContactPanel, FieldPanel, flank_window, plot_flanks
from gearmesh.view.diagrams.flank_plane import PLANE_GRID, FlankPlane
from gearmesh.view.pictures import flank_rows
from gearmesh.view.scene import contact_on

SAMPLES = Path(__file__).parents[2] / "samples"


@cache
def contact(sample: str) -> Contact:
    return gm.build(gm.load(SAMPLES / f"{sample}.toml")).contact(cycle=False)


def plane(sample: str, k: int) -> FlankPlane:
    pair = contact(sample).pair
    return FlankPlane.of(pair.both[k], pair.flanks[k])


@pytest.mark.parametrize(
    ("sample", "k", "labels"),
    [
        ("beveloid_crossed", 0, ("z (mm)", "radius (mm)")),
        ("internal", 1, ("z (mm)", "radius (mm)")),
        ("face_gear", 1, ("radius (mm)", "height (mm)")),
        ("spiral_bevel_basic", 0, ("cone distance (mm)", "height (mm)")),
    ],
)
@pytest.mark.sweep_cases("face_gear-1-labels2", "internal-1-labels1", "spiral_bevel_basic-0-labels3")
def test_lengths_and_heights_are_named(sample: str, k: int, labels: tuple[str, str]) -> None:
    assert plane(sample, k).labels == labels


@pytest.mark.quick
def test_ellipses_are_seen_along_the_turn_and_end_at_the_edges() -> None:
    """Area of a whole one: that of the ellipse, seen in the direction about the axis."""
    path = contact("beveloid_crossed").path
    here, found = contact_on(0, path, contact("beveloid_crossed").pair.mounts), plane("beveloid_crossed", 0)
    ellipses = found.ellipses(here, here.ellipses, rays=721)
    x, y = np.moveaxis(ellipses, -1, 0)
    area = np.abs((x[:, :-1] * y[:, 1:] - x[:, 1:] * y[:, :-1]).sum(axis=1)) / 2.0
    around = unit(np.cross([0.0, 0.0, 1.0], here.point))
    wanted = np.pi * here.semi_major * here.semi_minor * np.abs(dot(here.normal, around))
    # the flank's curvature over the ellipse
    np.testing.assert_allclose(area, wanted, rtol=0.01)
    # those of a bevel pinion are cut off at tip and root
    bevel, found = contact("spiral_bevel_basic"), plane("spiral_bevel_basic", 0)
    here = contact_on(0, bevel.path, bevel.pair.mounts)
    cut = found.ellipses(here, here.ellipses).reshape(-1, 2)
    outline = Polygon(found.frame.outline)
    assert any(outline.contains_points(cut, radius=way * 1e-3).all() for way in (1.0, -1.0))


@pytest.mark.sweep
def test_the_pattern_is_the_union_of_many_ellipses() -> None:
    """Few positions, between which ellipses are slender and turn, against polygons of many."""
    gears = gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml"))
    pair, found = gears.pairs[0], replace(plane("spiral_bevel_basic", 0), count=(61, 121))
    ends = np.degrees(contact("spiral_bevel_basic").path.phi1[[2, -3]])
    few, many = (contact_on(0, gears.contact(np.linspace(*ends, n), cycle=False).path, pair.mounts) for n in (9, 161))
    places, level = found.pattern(few)
    union = np.zeros(level.shape, dtype=bool)
    for ellipse in found.ellipses(many, many.ellipses):
        union |= Polygon(ellipse).contains_points(places.reshape(-1, 2)).reshape(level.shape)
    assert 0.2 < union.mean() < 0.5
    assert ((level <= 1.0) != union).mean() < 0.02 * union.mean()


@pytest.mark.sweep
@pytest.mark.quick
def test_sliding_grows_with_the_distance_from_the_pitch_point() -> None:
    """Spur gears: (1 + z1/z2) times the way along the line of action, whose end is the roll length; never out of the flank."""
    side = contact("spur").sides[0]
    pair, found, velocity = side.pair, side.ease_off, side.sliding_velocity
    known = np.isfinite(velocity[..., 0])
    assert known.mean() > 0.8
    # z 20, module 3 mm, pressure angle 20 deg
    base = 30.0 * np.cos(np.radians(20.0))
    distance = np.linalg.norm(pair.gear.mount.origin - pair.pinion.mount.origin)
    roll, at_pitch = (
        np.sqrt(radius**2 - base**2)
        for radius in (np.hypot(found.points[..., 0], found.points[..., 1]), distance / (1.0 + 1.0 / abs(pair.ratio)))
    )
    wanted = (1.0 + abs(pair.ratio)) * np.abs(roll - at_pitch)
    np.testing.assert_allclose(np.linalg.norm(velocity, axis=-1)[known], wanted[known], atol=0.02)
    pinion = solver_pair(pair).pinion
    grid = pinion.grid
    assert np.abs(dot(velocity, pinion.surface.jet(grid[..., 0], grid[..., 1]).n))[known].max() < 0.02


def test_arrows_of_sliding_stay_on_the_flank_and_say_what_they_are(monkeypatch: pytest.MonkeyPatch) -> None:
    kept: list[Any] = []
    monkeypatch.setattr(flank_diagrams, "save_figure", lambda figure, file: kept.append(figure))
    rows = flank_rows(contact("spiral_bevel_basic"), ("pinion",), sliding=True)
    plot_flanks("sliding.png", rows, "")
    words = [text.get_text() for text in kept[0].legends[0].get_texts()]
    assert "velocity of the pinion's flank relative to the gear's" in words
    panels = [panel for row in rows for panel in row if isinstance(panel, FieldPanel)]
    drawn = [(axes, arrows) for axes in kept[0].axes for arrows in axes.collections if isinstance(arrows, Quiver)]
    for panel, (_, arrows) in zip(panels, drawn, strict=True):
        half = np.stack((arrows.U, arrows.V), axis=-1).reshape(-1, 2) / arrows.scale / 2.0
        known = np.isfinite(half[:, 0])
        assert np.linalg.norm(half[known], axis=1).max() > 0.2  # mm
        outline = Polygon(panel.plane.frame.outline)
        for way in (1.0, -1.0):
            assert outline.contains_points((arrows.XY + way * half)[known]).all()


@pytest.mark.sweep
@pytest.mark.parametrize("size", [(1280, 960), (480, 360)])
def test_panels_fill_a_picture_and_their_words_stay_apart(
    size: tuple[int, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Matplotlib measures what the layout reckoned: nothing is cut off or meets, and numbers have 8 pixels."""
    kept: list[Any] = []
    monkeypatch.setattr(flank_diagrams, "save_figure", lambda figure, file: kept.append(figure))
    plot_flanks("flank.png", flank_rows(contact("spiral_bevel_basic"), ("pinion", "gear")), "Kegelradpaar", size)
    (figure,) = kept
    figure.draw_without_rendering()
    boxes = [axes.get_tightbbox() for axes in figure.axes]
    boxes += [figure.legends[0].get_window_extent(), figure._suptitle.get_window_extent()]
    assert len(boxes) == 8
    assert min(box.x0 for box in boxes) >= 0.0
    assert min(box.y0 for box in boxes) >= 0.0
    assert max(box.x1 for box in boxes) <= size[0]
    assert max(box.y1 for box in boxes) <= size[1]
    assert not any(box.overlaps(other) for k, box in enumerate(boxes) for other in boxes[:k])
    assert figure.dpi >= 72.0
    filled = sum(axes.get_window_extent().width * axes.get_window_extent().height for axes in figure.axes)
    assert filled > (0.38 if size[0] > 1000 else 0.12) * size[0] * size[1]


@pytest.mark.sweep
def test_fields_that_are_uniform_have_no_scale(monkeypatch: pytest.MonkeyPatch) -> None:
    """Nor teeth where the flanks of pinion and gear end together, at toe and heel, but for rounding."""
    kept: list[Any] = []
    monkeypatch.setattr(flank_diagrams, "save_figure", lambda figure, file: kept.append(figure))
    rows = flank_rows(contact("double_helical"), ("pinion",))
    plot_flanks("flank.png", rows, "")
    assert len(kept[0].axes) == 4
    assert sum("uniform within 1 µm" in axes.get_title() for axes in kept[0].axes) == 2
    (panel, *_) = (panel for row in rows for panel in row if isinstance(panel, FieldPanel))
    assert panel.beyond is not None
    past = flank_diagrams._past_edges(panel.beyond)
    # one line along the root
    assert (np.ptp((past > 0.0).sum(axis=0)), (past[0] > 0.0).all(), (past[1:] > 0.0).any()) == (0, True, False)


@pytest.mark.quick
def test_field_with_one_node_off_is_uniform_within_what_it_says() -> None:
    """Tables of flanks are less accurate at a node here and there; of many nodes, or of one far off, there is a scale."""

    def field(values: np.ndarray) -> FieldPanel:
        return FieldPanel("", plane("spiral_bevel_basic", 0), np.zeros((*values.shape, 2)), values, 1.0)

    values = np.full((12, 25), 1.15)
    values[0, 0] = 0.0
    assert field(values).is_flat
    assert field(values).range == 1.15
    assert not field(np.where(values > 0.0, 3.0, 0.0)).is_flat
    values[0] = 0.0
    assert not field(values).is_flat


@pytest.mark.quick
def test_fields_are_cut_at_two_edges_in_a_corner() -> None:
    """A table that ends before the corner goes on by straight lines. Far from all edges, what is not known stays unknown."""
    x, y = np.meshgrid(np.arange(7.0), np.arange(6.0))
    value, beyond = 3.0 + 2.0 * x - y, np.maximum(0.6 - 0.4 * x, 1.3 - y)
    table = (x + y > 2.0) & ((x < 5.0) | (y < 3.0))
    panel = FieldPanel(
        "", plane("spiral_bevel_basic", 0), np.stack((x, y), axis=-1), np.where(table & (beyond <= 0.0), value, np.nan), 0.0,
        continued=np.where(table, value, np.nan), beyond=np.where(table, beyond, np.nan),
    )  # fmt: skip
    drawn = flank_diagrams._with_corners(panel)
    assert drawn.continued is not None
    assert drawn.beyond is not None
    # beside (2, 2), which has a value
    corner = (np.abs(x - 2.0) < 1.5) & (np.abs(y - 2.0) < 1.5)
    assert (corner & ~table).any()
    np.testing.assert_allclose(drawn.continued[corner], value[corner], rtol=1e-12)
    np.testing.assert_allclose(drawn.beyond[corner], beyond[corner], rtol=1e-12, atol=1e-12)
    assert np.isnan(drawn.beyond[3:, 5:]).all()
    # cells without a value are not drawn
    assert np.isnan(drawn.continued[0, 3:]).all()


def test_an_end_that_is_nearly_seen_stands_whole() -> None:
    """And has room for its name; what is far from the contact is cut off."""
    flank = np.array([[-45.0, 43.6], [45.0, 51.0]])
    (left, right), *_ = flank_window(flank, (-35.0, 45.0), 6.7)
    room = (right - left) * flank_diagrams.WORD_ROOM_INCHES[0] / 6.7
    assert (left, right) == pytest.approx((-45.0 - room, 45.0 + room))
    assert flank_window(flank, (30.0, 45.0), 6.7)[0][0] > 0.0


@pytest.mark.sweep_cases("beveloid_crossed")
@pytest.mark.parametrize("sample", ["spiral_bevel_basic", "beveloid_crossed"])
def test_lines_of_equal_values_are_labelled_where_there_is_room(sample: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Labels stay inside of the flank, where it has values, and off each other."""
    kept: list[Any] = []
    monkeypatch.setattr(flank_diagrams, "save_figure", lambda figure, file: kept.append(figure))
    plot_flanks("flank.png", flank_rows(contact(sample), ("pinion",)), "")
    figure, count = kept[0], 0
    figure.draw_without_rendering()
    for axes in figure.axes:
        boxes = [label.get_window_extent() for label in axes.texts if label.get_text().isdigit()]
        count += len(boxes)
        outline = Polygon(np.column_stack(axes.lines[0].get_data()))
        covers = [drawn for drawn in axes.collections if drawn.get_gid() == flank_diagrams.COVER_ID]
        for k, box in enumerate(boxes):
            corners = axes.transData.inverted().transform(box.corners())
            assert not any(path.contains_points(corners).any() for cover in covers for path in cover.get_paths())
            assert outline.contains_points(axes.transData.inverted().transform(box.corners())).all()
            assert not any(box.overlaps(other) for other in boxes[:k])
    assert count > 6


@pytest.mark.sweep
@pytest.mark.parametrize("sample", ["beveloid_crossed", "helical"])
def test_figures_of_flanks_have_words_and_are_the_same_twice(sample: str, tmp_path: Path) -> None:
    found = contact(sample)
    rows = flank_rows(found)
    # both sides, two members and a map each; sides beside each other where flanks are long
    assert [len(row) for row in rows] == ([2, 2, 2] if sample == "helical" else [3, 3])
    panels = [panel for row in rows for panel in row if isinstance(panel, ContactPanel)]
    assert all(len(panel.strips) > 10 if sample == "helical" else panel.pattern is not None for panel in panels)
    written = []
    for name in ("a.svg", "b.svg"):
        plot_flanks(tmp_path / name, rows, "Paare")
        written.append((tmp_path / name).read_bytes())
    assert written[0] == written[1]
    for word in ("toe", "heel", "tip", "root", "Paare"):
        assert f"<!-- {word} -->".encode() in written[0]
    with pytest.raises(gm.OutputError, match=r"its suffix must be \.png or \.svg or \.pdf"):
        plot_flanks(tmp_path / "a.xls", rows, "")


@pytest.mark.sweep
def test_pictures_of_sliding_have_the_velocity_for_either_member() -> None:
    """It is that of the pinion's flank over the gear's; the ease-off is a field of the pinion's flank alone."""
    found = contact("spur")
    shown = {
        (name, sliding): [isinstance(panel, FieldPanel) for row in flank_rows(found, (name,), sliding) for panel in row]
        for name in ("pinion", "gear")
        for sliding in (False, True)
    }
    assert {key: sum(fields) for key, fields in shown.items()} == {
        ("pinion", False): 2,
        ("pinion", True): 2,
        ("gear", False): 0,
        ("gear", True): 2,
    }


@pytest.mark.quick
def test_points_of_a_plane_are_those_of_the_flank() -> None:
    """Splines through a quarter of them are off by less than a ten-thousandth of a pixel."""
    pair = contact("spiral_bevel_basic").pair
    plane = FlankPlane.of(pair.pinion, pair.flanks[0])
    exact = pair.pinion.tooth.flank_grid(pair.flanks[0], *(np.linspace(0.0, 1.0, n) for n in PLANE_GRID)).points
    assert plane.grid.shape == (*PLANE_GRID, 3)
    np.testing.assert_allclose(plane.grid, exact, atol=1e-6)
