"""The command `load`, and loaded contact in `tca` and `run`."""

from __future__ import annotations

import csv
import io
import json
from functools import lru_cache
from pathlib import Path

import pytest
from oracles.command_line import refused, run
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.api.loaded import LoadedContact
from gearmesh.app.options import positions_in_degrees
from gearmesh.errors import DesignError

SPUR = SAMPLES / "spur.toml"


@lru_cache
def loaded() -> LoadedContact:
    """The answer of the API to what the command is asked below."""
    return gm.build(gm.load(SPUR)).loaded([50.0, 200.0], [0.0, 3.0])


def test_the_command_says_what_the_api_does(tmp_path: Path) -> None:
    """JSON the same text, a folder the same files, the table the same figures; pairs that carry nothing are left empty there."""
    folder = tmp_path / "out"
    status, out, err = run(
        "load", SPUR, "--torque", "50,200", "--phi1", "0:3:2", "--json", "-", "--no-timing", "-o", folder
    )
    assert status == 0
    assert out == loaded().json(timing=False) == (folder / "loaded.json").read_text()
    assert (folder / "loaded.csv").read_text() == loaded().csv()
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


def test_positions_are_evenly_spaced() -> None:
    assert positions_in_degrees(None) is None
    assert positions_in_degrees("-1.5") == [-1.5]
    assert positions_in_degrees("-0.3:0.3:7") == pytest.approx([-0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3], abs=1e-15)
    assert positions_in_degrees("1:2:2") == [1.0, 2.0]
    for wrong in ("", "x", "nan", "1:2", "2:1:3", "1:1:2", "0:1:1", "0:1:2.5", "0:1:2:3", "0:inf:3", "0:1:1000000"):
        with pytest.raises(DesignError, match=f"^--phi1 = {wrong}: must be a finite number of degrees, or START:STOP:"):
            positions_in_degrees(wrong)


TORQUE = "must be finite numbers of Nm above 0, one or, with commas, several"


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
        ("SPUR --torque 50 --csv - --json -", "--csv = -: standard output is taken by --json"),
        ("SPUR --torque 50 --json nowhere/a.json", "cannot write nowhere/a.json: the folder nowhere does not exist"),
    ],
)
def test_what_load_refuses(arguments: str, message: str) -> None:
    assert refused("load", *arguments.replace("SPUR", str(SPUR)).split()).startswith(message)
