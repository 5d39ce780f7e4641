"""The reference of figures: complete, current, and printed by a command."""

from __future__ import annotations

import json

import pytest
from answers.test_figures import kinds
from oracles.command_line import refused, run
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.api.reference import declaring, figure_groups
from gearmesh.figures import MEMBER_PLACE


def test_the_reference_has_every_kind_of_figures_once() -> None:
    assert set(declaring()) == set(kinds())
    titles = [each.of for each in figure_groups()]
    assert len(set(titles)) == len(titles)


def test_describe_prints_what_figures_mean() -> None:
    status, out, _ = run("describe", "--figures", "c_gamma")
    assert status == 0
    assert "c_gamma_n_per_mm_um" in out
    assert "te_arcsec" not in out
    found = json.loads(run("describe", "--figures", "--json", "-")[1])["figures"]
    assert {"key": "p0_mpa", "unit": "MPa", "symbol": "p_0", "meaning": "largest pressure"} in found[
        "The Hertz contact under a torque"
    ]
    assert refused("describe", "--figures", "furlong").startswith(
        "--figures furlong: must be part of the key of a figure"
    )


def test_what_contact_and_solids_tell_stands_in_the_reference() -> None:
    """Every key of a document's summary and meshes is a declared one, with the name of a member in the place of {member}."""
    gears = gm.build(gm.load(SAMPLES / "spur.toml"))
    known = {each.key for group in figure_groups() for each in group.figures}
    known |= {key.replace(MEMBER_PLACE, name) for key in known for name in gears.members}
    for figures in (gears.contact().document()["summary"], gears.solid("pinion", 0.05).figures):
        assert len(figures) > 5
        assert set(figures) <= known


@pytest.mark.quick
@pytest.mark.parametrize(
    ("column", "key"),
    [
        ("ellipse_a_mm", "a_mm"),
        ("curvature_gear_k1_per_mm", "k1_per_mm"),
        ("ellipse_major_axis_x", "major_axis"),
        ("tip_clearance_rack_mm", f"tip_clearance_{MEMBER_PLACE}_mm"),
        ("te_peak_to_peak_um", "te_peak_to_peak_arcsec"),
    ],
)
def test_columns_of_tables_are_found_as_the_figures_that_they_are(column: str, key: str) -> None:
    assert [figure.key for group in figure_groups(column) for figure in group.figures].count(key) >= 1
    assert len([figure for group in figure_groups(column) for figure in group.figures]) < 8
