"""Undercut that takes a little of a flank, from where it begins: proved solids, and a warning with the figure."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.bevel import standard_factors
from oracles.examples import some

import gearmesh as gm
from gearmesh import SpiralBevelDesign
from gearmesh.design import files
from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kinds import Region, Side, Tooth, ToothSide, along
from gearmesh.mesh.solid import prove
from gearmesh.teeth import undercut
from gearmesh.teeth.section import Ends

CORPUS = Path(__file__).parents[1] / "corpus"


def pinion(face_width: float, hand: str) -> gm.Gears:
    """The pair 15/50, whose pinion is undercut from a place in the middle of its face on."""
    angles = {"spiral_angle": 10, "pressure_angle": 17.5, "shaft_angle": 60}
    teeth = {"pinion": {"teeth": 15}, "gear": {"teeth": 50}, **standard_factors(15, 50, 60.0)}
    return gm.build(SpiralBevelDesign(module=2, face_width=face_width, hand=hand, **angles, **teeth))


@pytest.mark.sweep
@pytest.mark.sweep_cases("23.35-right")
@pytest.mark.parametrize(("face_width", "hand"), some([(23.35, "right"), (24.0, "right"), (20.0, "left")], 2))
def test_a_little_undercut_is_a_warning(face_width: float, hand: str) -> None:
    gears = pinion(face_width, hand)
    (line,) = (line for line in gears.warnings if "undercut" in line)
    assert line.startswith("pinion: the ")
    lost = float(line.split(" mm ")[0].split()[-1])
    limits = gears.limits().limits["pinion"]
    assert lost == pytest.approx(max(side.lost.max() for side in limits.sides.values()), rel=0.1)
    assert 0.02 < lost < 0.1
    assert prove(gears.solid("pinion", 0.02).mesh, 1).ok


@pytest.mark.parametrize("face_width", [20.0, 23.35])
@pytest.mark.sweep_cases("23.35")
def test_the_form_point_moves_steadily_from_where_undercut_begins(face_width: float) -> None:
    """Close to the first cusp flank and fillet cross where their expansion says, half as far beyond it as the form point is
    before."""
    tooth = pinion(face_width, "right").members["pinion"].tooth
    (begins,) = tooth.breaks
    beside = begins + np.geomspace(1e-7, 3e-2, 41)
    sides = [
        (side, ends.form_point_flank)
        for side, ends in _ends(tooth, beside)
        if (ends.form_point_flank != side.form_point[0]).any()
    ]
    ((side, form_point),) = sides
    lost = form_point - side.form_point[0]
    whole = lost == 0.0
    assert np.flatnonzero(whole).max(initial=-1) < np.flatnonzero(~whole).min()
    # what is lost of the parameter is (e + e / 2), and e grows evenly
    rate = lost[~whole] / (beside[~whole] - begins)
    steady = rate[beside[~whole] - begins > 4e-3]
    np.testing.assert_allclose(steady, steady[0], rtol=0.1)


@pytest.mark.parametrize("face_width", [23.35, 24.0])
@pytest.mark.sweep_cases("24.0")
def test_undercut_is_looked_for_once(face_width: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """A tooth that was trimmed from toe to heel starts from there, and finds what one finds that starts anew."""
    tooth = pinion(face_width, "right").members["pinion"].tooth
    fresh = replace(tooth)
    tooth.prove()
    (begins,) = tooth.breaks
    at = np.sort(np.concatenate((np.linspace(0.03, 0.97, 12), begins + np.array([-0.01, 0.02, 0.05]))))
    anew = _ends(fresh, at)
    looked: list[int] = []
    start = undercut._start

    def counted(side: ToothSide, tip: Array, *rest: Any) -> Array:
        looked.append(tip.size)
        return start(side, tip, *rest)

    monkeypatch.setattr(undercut, "_start", counted)
    again = _ends(tooth, at)
    assert sum(looked) <= 2
    assert any((ends.form_point_flank != side.form_point[0]).sum() > 3 for side, ends in anew)
    for (side, ends), (_, others) in zip(again, anew, strict=True):
        known = _known_within(tooth, side, at, ends)
        np.testing.assert_array_less(np.abs(ends.form_point_flank - others.form_point_flank), known)
        np.testing.assert_allclose(ends.form_point_fillet, others.form_point_fillet, rtol=0.0, atol=1e-8)


#: rounding of a point that a polished solve leaves, over its distance from the origin: some operations' worth
ROUNDING = 16.0 * np.finfo(np.float64).eps


def _known_within(tooth: Tooth, side: ToothSide, at: Array, ends: Ends) -> Array:
    """Return distances (T,) at which two solves may find the flank's parameter at the form point: rounding of its points, across
    the fillet's section, over how fast the flank leaves that.

    With e from the cusp to the tool's form point they cross e / 2 beyond the cusp, where the flank moves as e and at an angle
    as e: the form point is a multiple root as undercut begins, known to rounding / e^2. That is 2e-7 here nearest to it, 2e-9 in
    its middle.
    """
    axial, ways = tooth.blank.axial, []
    for surface, p in ((side.flank, ends.form_point_flank), (side.fillet, ends.form_point_fillet)):
        jet = along(surface, p, tooth.stations(at), axial)[1]
        gradient = axial.gradient(jet.r)
        ways.append(jet.r_u - (dot(gradient, jet.r_u) / dot(gradient, jet.r_v))[:, None] * jet.r_v)
    flank, fillet = ways
    across = cross(flank, fillet)
    return np.asarray(ROUNDING * np.sqrt(dot(jet.r, jet.r) * dot(fillet, fillet) / dot(across, across)))


def _ends(tooth: Tooth, at: Array) -> list[tuple[ToothSide, Ends]]:
    sections = tooth.sections(at)
    return [(tooth.right, sections.right), (tooth.left, sections.left)]


@pytest.mark.sweep
def test_a_loop_narrower_than_rounding_is_no_removed_flank() -> None:
    """Close to where undercut begins flank and fillet cross in a loop that no residual tells from their form point."""
    tooth = gm.build(gm.load(CORPUS / "undercut_modified_involute_sensible_2066.toml")).members["pinion"].tooth
    (begins,) = tooth.breaks_of(Side.RIGHT)
    assert 0.02 < begins < 0.03
    t = begins * (1.0 - np.logspace(-6.0, 0.0, 25))
    sections = tooth.sections(t)
    flank, fillet = (
        tooth.grid(region, [end], sections).points[0]
        for region, end in ((Region.FLANK_RIGHT, 0.0), (Region.FILLET_RIGHT, 1.0))
    )
    assert np.abs(flank - fillet).max() < 1e-8
    lost = sections.right.form_point_flank - tooth.right.form_point[0]
    # the flank ends half as far beyond the cusp as that is from the form point, which grows in proportion
    assert lost[12:] / (begins - t[12:]) == pytest.approx(lost[-1] / begins, rel=0.15)


@pytest.mark.sweep
def test_fillet_cuts_a_flank_that_folds_before_its_form_point() -> None:
    """Flank that turns back twice where undercut deepens towards one end. The form point itself is on a branch that is right
    side out."""
    tooth = gm.build(gm.load(CORPUS / "fold_modified_involute_edge_2085.toml")).members["pinion"].tooth
    t = np.linspace(0.0, 1.0, 33)
    sections = tooth.sections(t)
    lost = sections.right.form_point_flank - tooth.right.form_point[0]
    # undercut goes on without a jump where the form point's branch turns right side out, at the middle of the face
    assert lost.min() > 3.0
    assert np.abs(np.diff(lost, 2)).max() < 0.02
    flank, fillet = (
        tooth.grid(region, [end], sections).points[0]
        for region, end in ((Region.FLANK_RIGHT, 0.0), (Region.FILLET_RIGHT, 1.0))
    )
    assert np.abs(flank - fillet).max() < 1e-9


@pytest.mark.sweep
def test_fold_that_ends_in_the_flank_names_a_given_key() -> None:
    """The refusal names a key that would mend the tooth: the design's own angle, or the depth if an override set it."""
    file = CORPUS / "fold_spiral_bevel_edge_2080.toml"
    folded = [f"{key}={value}" for key, value in standard_factors(12, 15).items()]
    design = files.override(files.read(file), folded)
    with pytest.raises(
        gm.DesignError, match=r"^pressure_angle = 13\.264 deg: allowed is at least [\d.]+ deg,.*cusp"
    ) as refused:
        gm.build(gm.parse(design))
    bound = float(str(refused.value).split(" deg,")[0].split()[-1])
    # the true one, by halving until it stands still, is 13.4688
    assert 0.0 <= bound - 13.4688 < 5e-3 * bound
    with pytest.raises(gm.DesignError, match=r"^depth_factor = 2: allowed is at most 1\.9[56]\d*,.*cusp"):
        gm.build(gm.load(file, folded))
