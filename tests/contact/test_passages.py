"""The transmission advance of a tooth pair where its contact passes from the flanks to an edge: between nodes, against first touch
of whole members."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.contact.engagement.curve import MeshCurve
from gearmesh.contact.engagement.cycle import engagement_range
from gearmesh.contact.engagement.engagement import whole_engagement
from gearmesh.contact.engagement.transmission_advance import TransmissionAdvance
from gearmesh.contact.first_touch.first_touch import first_touch
from gearmesh.contact.flanks import solver_pair


@pytest.mark.sweep
@pytest.mark.parametrize(
    "sample",
    [
        "worm_drive_zk_oversize",
        *(
            pytest.param(name, marks=pytest.mark.sweep)
            for name in ("spiral_bevel_basic", "face_gear", "hypoid", "novikov")
        ),
    ],
)
def test_the_advance_is_known_on_either_side_of_a_passage(sample: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Polynomials of both kinds of contact meet where it passes, and nothing is solved for beside it; both are what first touch of
    whole members is."""
    pair = gm.build(gm.load(SAMPLES / f"{sample}.toml")).train.pairs[0]
    engagement = whole_engagement(solver_pair(pair), pair.pitch)
    assert engagement is not None
    curve = MeshCurve(engagement, pair.pitch)
    ends = np.array([curve.surface.begin, curve.surface.end])
    step = pair.pitch / 12.0
    phi1 = (ends[:, None] + step * np.array([-0.02, -1e-4, -1e-8, 0.0, 1e-8, 1e-4, 0.02])).ravel()
    of_pair = curve.of_pair
    monkeypatch.setattr(TransmissionAdvance, "exactly", lambda *given: pytest.fail("solved for"))
    advance, slope = of_pair.at(phi1)
    touch = first_touch(engagement.pair, phi1)
    assert np.abs(advance - touch.advance).max() < 2e-11
    # the kind changes where it should: by the search itself
    inside = (touch.edges[:, 0] < 0).reshape(2, -1)
    assert inside[0].tolist()[:2] == [False, False]
    assert inside[0, -2:].all()
    assert inside[1, :2].all()
    assert inside[1].tolist()[-2:] == [False, False]
    # slopes do not jump, what bends is their own slope
    assert np.abs(np.diff(slope.reshape(2, -1)[:, 2:5], axis=1)).max() < 1e-6


@pytest.mark.sweep
@pytest.mark.parametrize(
    "sample",
    ["helical", *(pytest.param(name, marks=pytest.mark.sweep) for name in ("asymmetric", "cycloidal", "internal"))],
)
def test_beside_the_ends_of_lines_the_contact_is_that_of_a_whole_search(sample: str) -> None:
    """Between a node with a line of contact and one without, the line is followed while it lies on both flanks, then the edge."""
    pair = gm.build(gm.load(SAMPLES / f"{sample}.toml")).train.pairs[0]
    engagement = whole_engagement(solver_pair(pair), pair.pitch)
    assert engagement is not None
    surface = MeshCurve(engagement, pair.pitch).surface
    phi1 = (np.array([[surface.begin], [surface.end]]) + engagement.step * np.linspace(-0.9, 0.9, 8)).ravel()
    followed, found = engagement.near(phi1), first_touch(engagement.pair, phi1)
    assert found.line.any()
    assert not found.line.all()
    assert followed.line.tolist() == found.line.tolist()
    assert followed.advance == pytest.approx(found.advance, abs=1e-12)


@pytest.mark.parametrize(("sample", "by_nodes"), [("spiral_bevel_basic", True), ("helical", False)])
@pytest.mark.sweep_cases("helical-False")
def test_the_range_of_a_pair_needs_no_overtaking_within_surface_contact(
    sample: str, by_nodes: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where the nodes decide, the range is that by all phases at which pairs change over, none of which is solved for."""
    pair = gm.build(gm.load(SAMPLES / f"{sample}.toml")).train.pairs[0]
    engagement = whole_engagement(solver_pair(pair), pair.pitch)
    assert engagement is not None
    curve = MeshCurve(engagement, pair.pitch)
    assert curve.within_surface == by_nodes
    ends = [curve.surface.begin, curve.surface.end, *(end for arc in curve.arcs for end in (arc.first, arc.last))]
    if by_nodes:
        monkeypatch.setattr(MeshCurve, "_overtaking", lambda *given: pytest.fail("solved for"))
    assert engagement_range(engagement, pair.pitch) == (min(ends), max(ends))
