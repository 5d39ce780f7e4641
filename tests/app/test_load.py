"""The command `load`, and loaded contact in `tca` and `run`."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterator
from dataclasses import fields, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure
from oracles.command_line import refused, run
from oracles.loaded import few_elements
from oracles.places import PACKAGE, SAMPLES

import gearmesh as gm
from gearmesh import DesignError, LoadedContact
from gearmesh.answers.load.figures import LoadedTotals
from gearmesh.answers.load.loaded import _error_warning
from gearmesh.app.options import positions_in_degrees
from gearmesh.view.load import loaded_diagrams
from gearmesh.view.load.loaded_pictures import LoadedPictures

SPUR = SAMPLES / "spur.toml"


@pytest.fixture(autouse=True, scope="module")
def _few() -> Iterator[None]:
    """Few elements and positions: what is told is looked at here, not how right it is."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("gearmesh.loaded.sharing.flank_compliance", few_elements)
        patch.setattr("gearmesh.answers.load.loaded.POSITIONS_PER_PITCH", 7)
        patch.setattr(LoadedPictures, "save", drawn)
        patch.setattr("gearmesh.answers.check.ROLL_TOLERANCE_MM", 1e-3)
        patch.setattr(Figure, "savefig", lambda _, file, **__: Path(file).write_bytes(b"drawn"))
        yield


def drawn(_: LoadedPictures, folder: Path, before: str = "") -> tuple[Path, ...]:
    """Stands in for pictures, which have tests of their own."""
    (folder / f"{before}drawn.png").write_bytes(b"")
    return (folder / f"{before}drawn.png",)


@cache
def loaded() -> LoadedContact:
    """The answer of the API to what the command is asked below."""
    return gm.build(gm.load(SPUR)).loaded_contact([50.0, 200.0], [0.0, 3.0])


@pytest.mark.sweep
def test_the_command_says_what_the_api_does(tmp_path: Path) -> None:
    """JSON the same text, a folder the same files, the table the same figures; pairs that carry nothing are left empty there."""
    folder = tmp_path / "out"
    status, out, err = run(
        "load", SPUR, "--torque", "50,200", "--phi1", "0:3:2", "--json", "-", "--no-timing", "-o", folder
    )
    assert status == 0
    assert out == loaded().json(timing=False) == (folder / "loaded.json").read_text()
    assert (folder / "loaded.csv").read_text() == loaded().csv()
    assert (folder / "drawn.png").exists()
    lines = err.splitlines()
    assert lines[:2] == [
        "gearmesh: compliance of the pinion and the gear",
        "gearmesh: loaded contact, torques: 2, positions: 2",
    ]
    document = json.loads(out)
    assert [line.removeprefix("gearmesh: warning: ") for line in lines[2:]] == document["warnings"]
    for row, position in zip(csv.DictReader(io.StringIO(loaded().csv())), document["positions"], strict=True):
        assert float(row["te_arcsec"]) == position["te_arcsec"]
        shares = {f"pair_{each['pair']}_load_share": each["load_share"] for each in position["tooth_pairs"]}
        assert {key: float(row[key]) for key in row if key.endswith("load_share") and row[key]} == shares
        assert sum(shares.values()) == pytest.approx(1.0, abs=1e-9)
    assert [line for line in str(loaded()).splitlines() if len(line) > 80] == []


@pytest.mark.quick
def test_positions_are_evenly_spaced() -> None:
    assert positions_in_degrees(None) is None
    assert positions_in_degrees("-1.5") == [-1.5]
    assert positions_in_degrees("-0.3:0.3:7") == pytest.approx([-0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3], abs=1e-15)
    assert positions_in_degrees("1:2:2") == [1.0, 2.0]
    for wrong in ("", "x", "nan", "1:2", "2:1:3", "1:1:2", "0:1:1", "0:1:2.5", "0:1:2:3", "0:inf:3", "0:1:1000000"):
        with pytest.raises(DesignError, match=f"^phi1 = {wrong}: must be a finite number of degrees, or START:STOP:"):
            positions_in_degrees(wrong)


TORQUE = "must be finite numbers of Nm above 0, one or, with commas, several"


@pytest.mark.quick
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ("SPUR", "Missing option '--torque'"),
        ("SPUR --torque 0", f"--torque = 0: {TORQUE}"),
        ("SPUR --torque 50,-1", f"--torque = 50,-1: {TORQUE}"),
        ("SPUR --torque 50,", f"--torque = 50,: {TORQUE}"),
        ("SPUR --torque much", f"--torque = much: {TORQUE}"),
        ("SPUR --torque nan", f"--torque = nan: {TORQUE}"),
        (
            "SPUR --torque 50 --phi1 3:-3:5",
            "--phi1 = 3:-3:5: must be a finite number of degrees, or START:STOP:COUNT with",
        ),
        ("SPUR --torque 50 --pair sun-ring", "--pair = sun-ring: must be "),
        ("SPUR --torque 50 --csv - --json -", "--csv = -: --json already uses standard output"),
        ("SPUR --torque 50 --json nowhere/a.json", "cannot write nowhere/a.json: the folder nowhere does not exist"),
    ],
)
def test_what_load_refuses(arguments: str, message: str) -> None:
    assert refused("load", *arguments.replace("SPUR", str(SPUR)).split()).startswith(message)


# ---------------------------------------------------------------- what is said


@pytest.mark.sweep
def test_documented_keys_are_there() -> None:
    page = (PACKAGE / "loaded" / "README.md").read_text(encoding="utf-8").partition("## Keys")[2].partition("\n## ")[0]
    document = loaded().document()
    found = {*document, *document["totals"][0], *document["positions"][0], *document["positions"][0]["tooth_pairs"][0]}
    named = {each.replace("MEMBER", "pinion") for each in re.findall(r"`(\w+)`", page)}
    assert len(named) > 20
    # one position is no whole cycle, over which alone the face load factors are known, and there are no pitch deviations
    assert named - found == {"k_h_beta", "k_f_beta", "k_h_alpha"}
    assert named - found < {LoadedTotals.key_of(each.name) for each in fields(LoadedTotals)}


@pytest.mark.sweep
def test_edges_are_named_with_their_loads() -> None:
    """A spur pair, alike on both sides of its middle, has the same load at toe and heel, a little more than its cells' part of an
    even one; misaligned it has most at the end where pressures are."""
    even = loaded().totals[0].edge_load_share
    assert even["gear_toe"] == pytest.approx(even["gear_heel"], rel=1e-4)
    assert 1 / 40 < even["gear_toe"] < 2 / 40
    tilted = gm.build(gm.load(SPUR, ["assembly.gamma_v=0.05"])).loaded_contact(50.0, [0.0])
    (load,) = tilted.mesh.loads
    force = load.pressure.sum(axis=2)
    (gear,) = (member for member in tilted.pair.both if member.name == "gear")
    z = gear.mount.at(0.0).inverse.point(load.separation.middle)[..., 2]
    end = "heel" if (force * z).sum() > 0.0 else "toe"
    (total,) = tilted.totals
    shares = total.edge_load_share
    assert next(iter(shares)).endswith(end)
    assert not any(name.endswith({"toe": "heel", "heel": "toe"}[end]) for name in shares)
    assert max(shares.values()) > 1.5 * even["gear_toe"]
    (told,) = (line for line in tilted.warnings if "edge contact" in line)
    assert told.startswith("edge contact: the peak pressure is singular at the edge and is not reported; at 50 Nm ")
    edge = next(iter(shares)).replace("_", " ")
    assert f"up to {100.0 * max(shares.values()):.2g} % at {edge} (phi1 = 0 deg, " in told
    assert told.endswith("; crowning or end relief would reduce it")
    # grids are as long as contact may be, and where they are not it is said
    far = load.pressure[0, -1].sum() > 0.0
    assert any("the contact is longer than its grid" in line for line in tilted.warnings) == far
    # next to a tip that some cells reach and others, the middle among them, do not, nothing is beyond a grid
    gears = gm.build(gm.load(SPUR))
    near_tip = gears.loaded_contact(100.0, [gears.contact().summary["engagement_phi1_deg"][1] - 0.15])
    assert next(iter(near_tip.totals[0].edge_load_share)) == "pinion_tip"
    assert not any("longer than its grid" in line for line in near_tip.warnings)


@pytest.mark.sweep
def test_the_mean_of_tooth_pairs_that_carry() -> None:
    """Mean number of tooth pairs that carry. For spur gears that deflect little it is the contact ratio, to within one position
    of 7."""
    gears = gm.build(gm.load(SPUR))
    phi1 = np.degrees(gears.pairs[0].pitch) * np.arange(7) / 7
    found = gears.loaded_contact(1.0, phi1)
    (total,) = found.totals
    assert total.tooth_pairs == [1, 2]
    assert total.mean_tooth_pairs == pytest.approx(gears.contact().summary["contact_ratio"], abs=1 / 7)
    assert total.unloaded_te_peak_to_peak < 1e-6 < total.te_peak_to_peak
    (told,) = (line for line in found.warnings if "peak to peak" in line)
    assert told.startswith("at 1 Nm the transmission error is ")
    # a fifth of this swing is little of what the teeth give way by
    mean = found.mesh.te.mean()
    calm = replace(found.mesh, te=mean + 0.2 * (found.mesh.te - mean))
    assert _error_warning(found.pair, calm, found.unloaded_peak_to_peak) == []
    # nor is anything said against an error that is not known
    assert _error_warning(found.pair, found.mesh, np.nan) == []
    assert "Over the mesh cycle" in str(found)
    assert "Over positions: 2" in str(loaded())
    # a range that is no whole pitch says nothing of the swing
    assert not any("swings" in line for line in loaded().warnings)


# ---------------------------------------------------------------- tca and run


@pytest.mark.sweep
@pytest.mark.parametrize(("sample", "kind", "power"), [("spur", "line", 1 / 2), ("beveloid_crossed", "point", 1 / 3)])
def test_pressures_go_with_the_share_of_the_load(sample: str, kind: str, power: float) -> None:
    """Pressure is proportional to the square root of the load share on lines, to its cube root on points [Johnson 4.25, 4.45].
    Shares of all tooth pairs sum to 1 at every position. At positions that loaded contact solved, they equal its shares."""
    gears = gm.build(gm.load(SAMPLES / f"{sample}.toml"))
    pitch = np.degrees(gears.pairs[0].pitch)
    rotation = (pitch * np.array([0.0, 2 / 7, 0.53])[:, None] + pitch * np.arange(-3, 4)).ravel()
    alone, shared = (
        gears.contact(rotation, torque=20.0, load_sharing=sharing, cycle=False) for sharing in (False, True)
    )
    assert alone.summary["load_sharing"] == "all of the torque on one tooth pair"
    assert shared.summary["load_sharing"] == "load sharing by loaded contact"
    shares = np.array([row.load_share for row in shared.positions()])
    np.testing.assert_allclose(np.nansum(shares.reshape(3, 7), axis=1), 1.0, atol=1e-9)
    row = gears.loaded_contact(20.0, [2 / 7 * pitch]).rows[0]
    for each in row.tooth_pairs:
        assert shares.reshape(3, 7)[1, 3 - each.pair] == pytest.approx(each.load_share, abs=1e-6)
    touching = alone.path.kind == kind
    assert touching.sum() >= 4
    assert alone.hertz is not None
    assert shared.hertz is not None
    np.testing.assert_allclose(
        shared.hertz.peak_pressure[touching], alone.hertz.peak_pressure[touching] * shares[touching] ** power, rtol=1e-9
    )
    assert {row.load_share for row, there in zip(alone.positions(), alone.path.touching, strict=True) if there} == {1.0}
    assert any(line for line in shared.warnings if line not in alone.warnings)


@pytest.mark.sweep
def test_tca_says_how_the_load_is_shared() -> None:
    status, out, _ = run("tca", SPUR, "--torque", "20", "--load-sharing", "--set", "contact.phi1.count=3")
    assert status == 0
    assert "Hertz contact, 20 Nm on the pinion, shared\n" in out
    assert " ".join(out.partition("load_sharing")[2].splitlines()[0].split()) == "load sharing by loaded contact"
    _, out, _ = run("tca", SPUR, "--torque", "20", "--json", "-", "--set", "contact.phi1.count=3")
    assert json.loads(out)["summary"]["load_sharing"] == "all of the torque on one tooth pair"
    assert (
        refused("tca", SPUR, "--load-sharing") == "--load-sharing: must be left out without --torque, which is shared"
    )
    with pytest.raises(DesignError, match=r"^load_sharing = true: must be left out without a torque that is shared$"):
        gm.build(gm.load(SPUR)).contact(load_sharing=True)


@pytest.mark.sweep
def test_a_run_under_torque_has_loaded_contact(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gearmesh.view.opengl.missing_opengl_message", lambda: "no pictures")
    folder = tmp_path / "out"
    asked = ("run", SPUR, "-o", folder, "--tol", "100um", "--no-report", "--set", "contact.phi1.count=3")
    assert refused(*asked, "--torque", "20,x") == f"--torque = 20,x: {TORQUE}"
    assert not folder.exists()
    status, out, err = run(*asked, "--torque", "20")
    assert status == 0
    loaded_file, report = (json.loads((folder / f"{name}.json").read_text()) for name in ("loaded", "report"))
    assert report["loaded"] == {key: loaded_file[key] for key in ("totals", "positions", "tooth_pair")}
    assert len(report["loaded"]["positions"]) == 7
    (total,) = report["loaded"]["totals"]
    assert total["unloaded_te_peak_to_peak_arcsec"] == report["contact"]["mesh_te_peak_to_peak_arcsec"]
    assert {"loaded.json", "drawn.png"} <= set(report["files"])
    assert set(loaded_file["warnings"]) <= set(report["warnings"])
    assert "Over the mesh cycle" in out
    assert "gearmesh: loaded contact, torques: 1, positions: 7" in err.splitlines()


@pytest.mark.sweep
def test_there_is_one_transmission_error_without_load(monkeypatch: pytest.MonkeyPatch) -> None:
    """That of the exact mesh cycle, peak to peak, which few positions of a pitch fall short of: in the contact's figures, of every
    torque, and in the curve over the torque."""
    monkeypatch.setattr("gearmesh.answers.load.loaded.POSITIONS_PER_PITCH", 3)
    kept: list[Any] = []
    monkeypatch.setattr(loaded_diagrams, "save_figure", lambda figure, file: kept.append(figure))
    gears = gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml", ["contact.phi1.count=3"]))
    exact = gears.contact().summary["mesh_te_peak_to_peak_arcsec"]
    found = gears.loaded_contact([10.0, 20.0, 30.0])
    gears.picture("loaded_te", of=found).save("a.svg")
    assert np.ptp([row.unloaded_te for row in found.rows]) < 0.99 * exact
    told = [each.unloaded_te_peak_to_peak for each in found.totals]
    curve = kept[0].axes[2].lines[0].get_xydata()
    assert curve[0, 0] == 0.0
    np.testing.assert_allclose([*told, curve[0, 1]], exact, rtol=1e-9)


@pytest.mark.sweep
def test_run_of_a_gear_set_loads_every_mesh_with_its_torque(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The planet keeps nothing of the torque: what the sun's mesh leaves on it, to a few per mille of friction-free slope of the
    transmission error, is what it has in the ring's."""
    monkeypatch.setattr("gearmesh.view.opengl.missing_opengl_message", lambda: "no pictures")
    monkeypatch.setattr("gearmesh.answers.load.loaded.POSITIONS_PER_PITCH", 3)
    folder, planetary = tmp_path / "out", SAMPLES / "planetary.toml"
    options = ("--tol", "100um", "--no-report", "--set", "contact.phi1.count=3", "--set", "planets=1")
    status, out, err = run("run", planetary, "-o", folder, *options, "--torque", "4,8")
    assert status == 0
    report = json.loads((folder / "report.json").read_text())
    assert list(report["loaded_meshes"]) == ["sun-planet_1", "planet_1-ring"]
    assert report["loaded"] == report["loaded_meshes"]["sun-planet_1"]
    for name, figures in report["loaded_meshes"].items():
        before = name.replace("-", "_")
        assert {f"{before}_loaded.json", f"{before}_drawn.png"} <= set(report["files"])
        assert json.loads((folder / f"{before}_loaded.json").read_text())["totals"] == figures["totals"]
        assert f"Over the mesh cycle of {name}" in out
    first, second = report["loaded_meshes"].values()
    assert [each["torque_nm"] for each in first["totals"]] == [4.0, 8.0]
    for left, had in zip(first["positions"], second["positions"], strict=True):
        assert left["gear_torque_nm"] == pytest.approx(had["torque_nm"], rel=0.01)
    teeth = gm.load(planetary).plain()
    handed = 8.0 * teeth["planet"]["teeth"] / teeth["sun"]["teeth"]
    assert (
        f"planet_1-ring: its torque is transmitted by sun-planet_1, {handed:.6g} Nm on the planet_1 with 8 Nm on the sun"
        in err
    )
