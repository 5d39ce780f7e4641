"""Novikov and modified involute pinions whose racks bend far and whose tools plunge deep: built, or refused for what is set."""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest
from oracles.examples import some
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.kinds import Side

CORPUS = sorted((Path(__file__).parents[1] / "corpus").glob("ground_*.toml"))


@lru_cache
def built_from(file: Path) -> gm.Gears:
    return gm.build(gm.load(file))


@pytest.mark.sweep
@pytest.mark.parametrize("file", some(CORPUS, 3), ids=lambda file: file.stem)
def test_a_deeply_ground_pinion_is_built(file: Path) -> None:
    """Designs that were refused, after minutes, for an addendum that they leave out: tip to tip on the whole face there is land."""
    built = built_from(file)
    tooth = built.members["pinion"].tooth
    sections = tooth.sections(np.linspace(0.0, 1.0, 41))
    land = (sections.left.tip_angle - sections.right.tip_angle) * tooth.blank.tip.radius
    assert land.min() > 0.0
    assert any(line.startswith("pinion.addendum = ") for line in built.warnings)
    for side in Side:
        grid = tooth.flank_grid(side, np.linspace(0.0, 1.0, 17), np.linspace(0.0, 1.0, 9))
        height = np.hypot(grid.points[..., 0], grid.points[..., 1])
        up = np.diff(height, axis=0) * side.sign
        assert (up > 0.0).all() or (up < 0.0).all()


@pytest.mark.sweep_cases("disk", "worm_plunge")
@pytest.mark.parametrize("crowning", ["none", "worm_plunge", "disk"])
def test_a_rack_that_turns_past_square_is_undercut(crowning: str) -> None:
    """Its line of action comes back from infinity, so that the flank at the form point is not turned inside out again."""
    given = [f"pinion.crowning={crowning}", "pinion.addendum=0.5", "pinion.plunge_coefficient=1e-4"]
    tooth = gm.build(gm.load(CORPUS[-1], given)).members["pinion"].tooth
    assert min(tooth.right.form_point[1], tooth.left.form_point[1]) > 0.01
    ends = tooth.sections(np.linspace(0.0, 1.0, 5))
    for side in Side:
        flank, fillet = tooth.side(side), ends.of(side)
        assert (fillet.form_point_flank > flank.form_point[0]).all()
        assert (fillet.form_point_fillet > flank.form_point[1]).all()


@pytest.mark.sweep
@pytest.mark.parametrize("scale", some([8.0, 0.1], 1))
def test_gears_many_times_as_large_are_the_same(scale: float) -> None:
    """Residuals of meshing, trimming and contact are rounded to the size of the gears: those of a large one are no failures."""
    file = CORPUS[0].with_name("ground_modified_involute_edge_2018.toml")
    design = gm.load(file)
    scaled = ["module", "pinion.face_width", "gear.face_width", "assembly.dE"]
    inverse = ["pinion.parabola", "gear.parabola", "pinion.plunge_coefficient"]
    own = {key: value for key, value in design.own() if key in scaled + inverse}
    changed = {key: value * scale if key in scaled else value / scale for key, value in own.items()}
    like = gm.load(file, [f"{key}={value!r}" for key, value in changed.items()])
    (first,), (second,) = built_from(file).pairs, gm.build(like).pairs
    for one, two in zip(first.both, second.both, strict=True):
        sections = [member.tooth.sections(np.linspace(0.0, 1.0, 41)) for member in (one, two)]
        for side in Side:
            ends = [each.of(side) for each in sections]
            np.testing.assert_allclose(ends[1].tip_angle, ends[0].tip_angle, rtol=0.0, atol=1e-11)
            np.testing.assert_allclose(ends[1].root_angle, ends[0].root_angle, rtol=0.0, atol=1e-11)
    phi1 = np.linspace(-0.9, 0.9, 13) * first.pitch
    paths = [contact_path(solver_pair(pair).parts[0], phi1) for pair in (first, second)]
    assert paths[0].touching.all()
    np.testing.assert_allclose(paths[1].phi2, paths[0].phi2, rtol=0.0, atol=1e-11)


@pytest.mark.sweep
def test_a_bound_of_the_tip_is_one() -> None:
    """A pointed pinion: the addendum allowed can be built, a little more cannot."""
    keys = ["pinion.crowning=worm_plunge", "pinion.addendum=1.7"]
    with pytest.raises(
        DesignError, match=r"^pinion.addendum = 1\.7: allowed is at most ([\d.]+), .*pointed"
    ) as refused:
        gm.build(gm.load(SAMPLES / "novikov.toml", keys))
    found = re.search(r"at most ([\d.]+),", str(refused.value))
    assert found is not None
    addendum = float(found[1])
    gm.build(gm.load(SAMPLES / "novikov.toml", [*keys, f"pinion.addendum={addendum}"]))
    with pytest.raises(DesignError, match="pointed"):
        gm.build(gm.load(SAMPLES / "novikov.toml", [*keys, f"pinion.addendum={addendum + 0.002}"]))


@pytest.mark.sweep
def test_a_disk_ground_pinion_is_within_its_tolerance() -> None:
    """Its root passes from one fillet's end to the other's, which a surface of revolution missed by 3.9 um."""
    built = gm.build(gm.load(CORPUS[0].parent / "solid_novikov_sensible_1.toml"))
    solid = built.solid("pinion", 1e-3, file="x.stl")
    assert solid.complaints == []
    assert solid.mesh.volume() == pytest.approx(built.members["pinion"].tooth.volume(), rel=3e-5)


@pytest.mark.sweep
def test_a_flank_that_would_go_to_infinity_is_refused() -> None:
    with pytest.raises(DesignError) as failure:
        gm.build(gm.load(CORPUS[0].with_name("refused_novikov_edge_2121.toml")))
    line = str(failure.value)
    assert line.startswith("gear.parabola = 0.10583 1/mm: allowed is at most ")
    bound = float(line.split("at most ")[1].split()[0])
    # at the bound the profile's normal lies along the pitch plane at the tip: 2 a (p - p_0) = tan(alpha)
    assert 0.05 < bound < 0.0525
