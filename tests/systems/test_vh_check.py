"""The V-H check: with V and H applied the contact, solved for anew, lies where it was asked."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.command_line import refused, run
from oracles.examples import some
from oracles.places import SAMPLES
from scipy.optimize import brentq

import gearmesh as gm
from gearmesh import load, parse
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.systems.spiral_bevel.conjugate.build import conjugate_blank
from gearmesh.systems.spiral_bevel.synthesis.settings import basic_blank

CORPUS = Path(__file__).parents[1] / "corpus"
#: places along the face
SHARES = {"toe": 0.25, "middle": 0.5, "heel": 0.75}


def vertices(pair: Any) -> list[Any]:
    """The contacts at which the gears turn at the ratio of their teeth, by the solver alone: where n . v12 changes its sign."""
    flanks = solver_pair(pair)

    def path_at(phi1: float) -> Any:
        return contact_path(flanks, np.array([phi1]), edges=False)

    def sliding(phi1: float) -> float:
        path = path_at(phi1)
        one, other = pair.pinion.mount, pair.gear.mount
        r, n = path.point[0], path.normal[0]
        relative = np.cross(one.spin, r - one.origin) - pair.ratio * np.cross(other.spin, r - other.origin)
        return float(n @ relative)

    phi1 = np.linspace(-1.2, 1.2, 25) * pair.pitch
    values = np.array([sliding(each) for each in phi1])
    good = np.flatnonzero(values[:-1] * values[1:] <= 0.0)
    assert good.size, values
    return [path_at(brentq(sliding, phi1[k], phi1[k + 1], xtol=1e-14)) for k in good]


def along(blank: Any, path: Any) -> float:
    """Cone distance of the gear's point."""
    return float(blank.gear.stations.value(path.point2[0]))


LEANING = {"units": "inch", "diametral_pitch": 6, "spiral_angle": 30, "shaft_angle": 75}


TEETH = {"pinion": {"teeth": 17}, "gear": {"teeth": 31}}
#: loaded by the test that wants one: whoever collects tests need not wait for it
DESIGNS: dict[str, Callable[[], Any]] = {
    "basic": lambda: load(SAMPLES / "spiral_bevel_basic.toml"),
    "formate": lambda: load(SAMPLES / "spiral_bevel_formate.toml"),
    "hypoid": lambda: load(SAMPLES / "hypoid.toml"),
    "conjugate": lambda: load(SAMPLES / "spiral_bevel_geometry1.toml"),
    "right hand, given settings": lambda: load(SAMPLES / "spiral_bevel_abdullah_straight.toml"),
    "inch, J and alpha": lambda: parse(
        {"kind": "spiral_bevel", **LEANING, **TEETH, "assembly": {"dG": 0.002, "d_delta": 0.03, "dV": 0.001}}
    ),
}


@pytest.mark.sweep
@pytest.mark.parametrize("side", ["pinion_concave", "pinion_convex"])
@pytest.mark.parametrize("name", some(DESIGNS, 2))
def test_the_contact_goes_where_v_and_h_put_it(name: str, side: str) -> None:
    """Cone distance and middle of the working depth of the gear's point within 1e-6 mm."""
    design = DESIGNS[name]()
    own, unit = design.in_mm(), design.mm_per_unit
    blank = conjugate_blank(own) if name == "conjugate" else basic_blank(own)
    rows = [row.row for row in gm.build(design).vh().rows if row.side == side]
    assert [row["place"] for row in rows] == list(SHARES)
    for row in rows if name == "basic" else rows[::2]:
        values = {"contact.side": side, "assembly.dV": row["v_mm"] / unit, "assembly.dA": row["h_mm"] / unit}
        pair = pair_of(design.with_values(values))
        wanted = blank.gear.inner_cone_distance + SHARES[row["place"]] * blank.gear.face_width
        # the error of the Formate pair has three vertices at its heel, two of them next to each other
        path = min(vertices(pair), key=lambda each: abs(along(blank, each) - wanted))
        assert path.residual[0] < 1e-9
        _, _, z = path.point2[0]
        rho = np.hypot(*path.point2[0][:2])
        assert along(blank, path) == pytest.approx(wanted, abs=1e-6)
        # across the working depth: between its own tip and, a clearance over its root, the mating gear's
        tip = blank.gear.face_angle
        under_tip = np.cos(tip) * (blank.gear.tip_radius + np.tan(tip) * z - rho)
        over_root = float(pair.gear.tooth.blank.root.value(path.point2[0])) - blank.clearance
        assert under_tip == pytest.approx(over_root, abs=2e-6)
        assert row["j_mm"] == pytest.approx(design.in_mm().assembly.dG)
        assert row["alpha_deg"] == design.assembly.d_delta


@pytest.mark.sweep
def test_hidden_place_is_refused_with_the_nearest_free_place() -> None:
    """21/45: what brought the vertex to the toe left the contact on edges; the place that is offered is where teeth touch first."""
    design = load(CORPUS / "vh_spiral_bevel_21_45.toml")
    found = gm.build(design).vh()
    toe, middle, heel = (each.row for each in found.rows[:3])
    assert (toe["reached"], middle["reached"], heel["reached"]) == (False, True, True)
    assert toe["v_mm"] is toe["h_mm"] is None
    nearest, blank = toe["nearest"], basic_blank(design)
    assert 0.25 < nearest["face_share"] < 0.5
    (line, *_) = found.complaints
    assert line.startswith("pinion_concave: the contact cannot be brought to the toe")
    asked = {"contact.side": "pinion_concave", "assembly.dV": nearest["v_mm"], "assembly.dA": nearest["h_mm"]}
    pair = pair_of(design.with_values(asked))
    wanted = blank.gear.inner_cone_distance + nearest["face_share"] * blank.gear.face_width
    vertex = min(vertices(pair), key=lambda each: abs(along(blank, each) - wanted))
    assert along(blank, vertex) == pytest.approx(wanted, abs=1e-6)
    # over tips, edges and fillets too
    first = contact_path(solver_pair(pair), vertex.phi1)
    assert first.kind[0] == "point"
    np.testing.assert_allclose(first.point[0], vertex.point[0], atol=1e-6)
    # where the vertex was brought to the toe edges carry
    hidden = pair_of(design.with_values({**asked, "assembly.dV": -1.26633, "assembly.dA": -1.64641}))
    path = contact_path(solver_pair(hidden), np.linspace(-1.5, 1.5, 31) * hidden.pitch)
    toe_place = blank.gear.inner_cone_distance + 0.25 * blank.gear.face_width
    places = hidden.gear.tooth.blank.axial.value(path.point2)
    assert not ((path.kind == "point") & (np.abs(places - toe_place) < 0.05 * blank.gear.face_width)).any()
    assert ((path.kind == "edge") & (np.abs(places - toe_place) < 0.25 * blank.gear.face_width)).any()


@pytest.mark.sweep
def test_other_displacements_bring_the_contact_there_as_well() -> None:
    """J and alpha, of the convex side, whose toe they reach; V and H stay what the design says."""
    design = load(SAMPLES / "spiral_bevel_basic.toml", ["assembly.dV=0.02"])
    blank = basic_blank(design)
    toe = next(
        each.row
        for each in gm.build(design).vh(("J", "alpha")).rows
        if (each.side, each.place) == ("pinion_convex", "toe")
    )
    assert (toe["v_mm"], toe["h_mm"]) == (0.02, 0.0)
    values = {"contact.side": "pinion_convex", "assembly.dG": toe["j_mm"], "assembly.d_delta": toe["alpha_deg"]}
    places = [along(blank, each) for each in vertices(pair_of(design.with_values(values)))]
    wanted = blank.gear.inner_cone_distance + 0.25 * blank.gear.face_width
    assert min(abs(place - wanted) for place in places) < 1e-6
    assert "must be two of V, H, J, alpha" in refused("vh", str(SAMPLES / "spiral_bevel_basic.toml"), "--move", "V,V")


@pytest.mark.sweep
def test_a_pair_that_is_at_its_middle_is_not_moved() -> None:
    """V-H check finds no displacement for the middle of a pair whose mean point lies there."""
    centred = {f"{key}": 0.0 for side in ("concave", "convex") for key in
               (f"pinion.{side}.mean_offset", f"pinion.{side}.mean_shift")}  # fmt: skip
    design = parse({"kind": "spiral_bevel", "module": 4, "pinion": {"teeth": 15}, "gear": {"teeth": 38}})
    blank = basic_blank(design)
    for row in (each.row for each in gm.build(design.with_values(centred)).vh().rows):
        if row["place"] == "middle":
            # the mean point's depth is counted from the machine plane
            assert max(abs(row["v_mm"]), abs(row["h_mm"])) < 2e-3 * blank.mean_normal_module


def test_vh_on_the_command_line(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    status, out, _ = run("vh", str(SAMPLES / "spiral_bevel_basic.toml"), "--json", "-")
    assert status == 0
    found = json.loads(out)
    total, (toe, _, heel) = found["totals"][0], found["vh"][:3]
    assert total["v_mm"] == pytest.approx(heel["v_mm"] - toe["v_mm"])
    assert total["v_over_h"] == pytest.approx(total["v_mm"] / total["h_mm"])
    assert "pinion_convex" in run("vh", str(SAMPLES / "spiral_bevel_basic.toml"))[1]
    assert refused("vh", str(SAMPLES / "helical.toml")).startswith("kind = cylindrical: has no V-H check; allowed is")
