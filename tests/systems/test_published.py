"""The published tables, row by row: Liu & Tsay 2002 [LT02] Tables 2-4, Litvin & Tsay 1985 [LT85] Examples 1 and 2."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.built import built_sample
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Contact, NoSolutionError, load
from gearmesh.kernel.numeric.algebra import ARCSEC, Array

OFFSET = ["assembly.dx=0.3", "assembly.dy=0.3", "assembly.dz=0.3"]
TILT = ["assembly.gamma_h=0.5", "assembly.gamma_v=-0.5"]
HALF = [s.replace("0.3", "0.5") for s in OFFSET]

# columns phi1', l_F, u_F, phi2', l_G, u_G, TE (deg, mm, arc seconds), rows phi1' = 6 to -6
POINT_CASES = {
    1: (
        "beveloid_intersected",
        [],
        """6.0 8.813 0.000 189.000 1.829 0.000 0.000
           3.0 7.738 0.000 187.000 2.903 0.000 0.000
           0.0 6.664 0.000 185.000 3.978 0.000 0.000
          -3.0 5.590 0.000 183.000 5.052 0.000 0.000
          -6.0 4.515 0.000 181.000 6.127 0.000 0.000""",
    ),
    2: (
        "beveloid_intersected",
        OFFSET,
        """6.0 9.027 -0.395 189.096 2.051 -0.504 0.000
           3.0 7.953 -0.395 187.096 3.125 -0.504 0.000
           0.0 6.878 -0.395 185.096 4.200 -0.504 0.000
          -3.0 5.804 -0.395 183.096 5.274 -0.504 0.000
          -6.0 4.729 -0.395 181.096 6.349 -0.504 0.000""",
    ),
    3: (
        "beveloid_intersected",
        OFFSET + TILT,
        """6.0 9.033 0.099 189.185 1.620 0.669 0.000
           3.0 7.958 0.099 187.185 2.695 0.669 0.000
           0.0 6.884 0.099 185.185 3.769 0.669 0.000
          -3.0 5.809 0.099 183.185 4.844 0.669 0.000
          -6.0 4.735 0.099 181.185 5.918 0.669 0.000""",
    ),
    4: (
        "beveloid_crossed",
        [],
        """6.0 8.813 1.684 189.000 1.829 -3.788 0.000
           3.0 7.738 0.842 187.000 2.903 -2.946 0.000
           0.0 6.664 0.000 185.000 3.978 -2.104 0.000
          -3.0 5.590 -0.842 183.000 5.052 -1.263 0.000
          -6.0 4.515 -1.684 181.000 6.127 -0.421 0.000""",
    ),
    5: (
        "beveloid_crossed",
        OFFSET,
        """6.0 9.030 1.197 189.125 2.021 -4.423 0.000
           3.0 7.955 0.355 187.125 3.096 -3.581 0.000
           0.0 6.881 -0.487 185.125 4.170 -2.739 0.000
          -3.0 5.806 -1.328 183.125 5.245 -1.897 0.000
          -6.0 4.732 -2.170 181.125 6.319 -1.056 0.000""",
    ),
    6: (
        "beveloid_crossed",
        OFFSET + TILT,
        """6.0 9.034 2.158 189.063 1.710 -2.698 0.000
           3.0 7.960 1.316 187.063 2.784 -1.856 0.000
           0.0 6.885 0.474 185.063 3.859 -1.014 0.000
          -3.0 5.811 -0.368 183.063 4.933 -0.172 0.000
          -6.0 4.736 -1.209 181.063 6.008 0.669 0.000""",
    ),
    9: (
        "beveloid_parallel",
        [*HALF, "assembly.gamma_h=0.5"],
        """6.0 4.852 7.828 189.320 5.932 7.064 20.213
           3.0 4.021 7.378 187.317 6.775 6.636 10.107
           0.0 3.190 6.927 185.314 7.618 6.207 0.000
          -3.0 2.360 6.476 183.311 8.460 5.779 -10.107
          -6.0 1.529 6.026 181.308 9.303 5.350 -20.213""",
    ),
}
# phi1', phi2' and TE of the cases that the paper gives as "line contact"
LINE_CASES = {7: ([], 185.000), 8: (HALF, 185.273)}


def solve(sample: str, *overrides: str) -> Contact:
    """The path of one tooth pair alone."""
    return built_sample(sample, *overrides).contact(cycle=False)


def column(result: Contact, member: str, name: str) -> Array:
    return np.array([row[name] for row in result.params[member]])


@pytest.mark.parametrize("case", POINT_CASES)
@pytest.mark.sweep_cases("1", "2", "3", "4", "5", "9")
def test_lt02_tables(case: int) -> None:
    sample, errors, text = POINT_CASES[case]
    result = solve(sample, *errors)
    path = result.path
    computed = np.column_stack(
        (
            np.degrees(path.phi1),
            column(result, "pinion", "l_F"),
            column(result, "pinion", "u_F"),
            np.degrees(path.phi2),
            column(result, "gear", "l_G"),
            column(result, "gear", "u_G"),
            path.te / ARCSEC,
        )
    )
    printed = np.array(text.split(), dtype=float).reshape(5, 7)
    # half a unit of the last printed digit, and a little for what the authors' own iteration left over
    np.testing.assert_allclose(computed, printed, rtol=0, atol=0.0006)
    assert set(path.kind) == ({"edge"} if case == 9 else {"point"})
    assert set(path.edge) == ({"pinion_heel"} if case == 9 else {""})
    assert path.residual.max() <= 1e-11


@pytest.mark.parametrize("case", LINE_CASES)
@pytest.mark.sweep_cases("7")
def test_lt02_line_contact(case: int) -> None:
    errors, phi2 = LINE_CASES[case]
    path = solve("beveloid_parallel", *errors).path
    np.testing.assert_allclose(np.degrees(path.phi2), phi2 + np.array([4, 2, 0, -2, -4.0]), rtol=0, atol=0.0006)
    np.testing.assert_allclose(path.te / ARCSEC, 0.0, rtol=0, atol=0.0006)
    assert set(path.kind) == {"line"}
    for line in path.lines:
        assert line is not None
        # the flanks are developable and touch along a common generator: the points lie on one straight line
        centred = line - line.mean(axis=0)
        assert np.linalg.svd(centred, compute_uv=False)[1] < 1e-9 * np.linalg.norm(centred)
        assert np.ptp(line[:, 2]) > 5.0


@pytest.mark.sweep
def test_lt02_shaft_angle() -> None:
    assert abs(solve("beveloid_crossed").summary["shaft_angle_deg"] - 49.6284) < 5e-5
    # Example 1 is mounted at 60 deg, Example 3 on parallel axes
    assert abs(solve("beveloid_intersected").summary["shaft_angle_deg"] - 60.0) < 1e-9
    assert abs(solve("beveloid_parallel").summary["shaft_angle_deg"]) < 1e-9


@pytest.mark.quick
def test_lt85_example_1() -> None:
    result = solve("circular_arc", "assembly.dC=0.021")
    # with the printed centre distance; the paper prints 12.81412
    np.testing.assert_allclose(column(result, "pinion", "theta_F"), 12.81413, rtol=0, atol=5e-6)
    np.testing.assert_allclose(column(result, "gear", "theta_P"), 12.81413, rtol=0, atol=5e-6)
    # the approximate solution (31): sin(theta) = (dC + b_F - b_P) / (rho_F - rho_P)
    design = load(SAMPLES / "circular_arc.toml")
    pinion, gear = design.pinion, design.gear
    sine = (0.021 + pinion.b - gear.b) / (pinion.profile_radius - gear.profile_radius)  # type: ignore[attr-defined]
    assert abs(np.degrees(np.arcsin(sine)) - 12.70903) < 5e-6


@pytest.mark.parametrize(
    ("lead", "table"),
    [
        (
            75.0,
            """32.2520 31.6521 59.88
               32.2527 31.6528 29.94
               32.2531 31.6531 0.00
               32.2530 31.6530 -29.94
               32.2526 31.6526 -59.89""",
        ),
        (
            75.093,
            """30.1892 30.1440 0.23
               30.1900 30.1449 0.12
               30.1905 30.1452 0.00
               30.1904 30.1452 -0.12
               30.1900 30.1447 -0.24""",
        ),
    ],
    ids=["Table 1", "Table 2"],
)
@pytest.mark.sweep_cases("Table 2")
def test_lt85_tables(lead: float, table: str) -> None:
    result = solve("circular_arc", "assembly.dgamma=0.1", f"pinion.lead_angle={lead}")
    printed = np.array(table.split(), dtype=float).reshape(5, 3)
    angles = np.column_stack((column(result, "pinion", "theta_F"), column(result, "gear", "theta_P")))
    np.testing.assert_allclose(angles, printed[:, :2], rtol=0, atol=1.1e-4)
    np.testing.assert_allclose(result.path.te / ARCSEC, printed[:, 2], rtol=0, atol=0.011)
    # phi1 counts the generation angle, as the table does
    np.testing.assert_allclose(column(result, "pinion", "phi_1"), [-20, -10, 0, 10, 20], rtol=0, atol=1e-9)


def compensations(*keys: str, refinish: str | None = None) -> dict[str, dict[str, Any]]:
    """Settings of the sample with some keys changed, by their keys."""
    found = gm.build(load(SAMPLES / "circular_arc.toml", list(keys))).compensate(refinish)
    return {each.key: each.row for each in found.rows}


@pytest.mark.sweep
def test_settings_restore_the_contact() -> None:
    rows = compensations("assembly.dgamma=0.1")
    assert abs(rows["pinion.lead_angle"]["value_after"] - 75.093) < 5e-4
    rows = compensations("assembly.dC=0.021")
    # (34) b_F = b_F0 - dC is the first approximation
    assert abs(rows["pinion.b"]["value_after"] - (0.12195 - 0.021)) < 5e-5
    cured = solve("circular_arc", "assembly.dC=0.021", f"pinion.b={rows['pinion.b']['value_after']!r}")
    np.testing.assert_allclose(column(cured, "pinion", "theta_F"), 30.0, rtol=0, atol=1e-8)


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("refinish", "key", "keys", "asked"),
    [
        (None, "pinion.b", ("gear.b=0.17",), 30.0),
        ("gear", "gear.b", ("pinion.b=0.11",), 30.0),
        (None, "pinion.b", ("pressure_angle=26",), 26.0),
        ("gear", "gear.lead_angle", ("assembly.dgamma=0.1",), None),
    ],
)
def test_either_member_is_refinished_for_the_theta_asked_for(
    refinish: str | None, key: str, keys: tuple[str, ...], asked: float | None
) -> None:
    """[LT85 36] is exact where the axes are where they should be: the racks are tangent again."""
    rows = compensations(*keys, refinish=refinish)
    changed = [row for row in rows.values() if row["value_after"] != row["value_before"]]
    assert [row["key"] for row in changed] == [key]
    cured = solve("circular_arc", *keys, f"{key}={changed[0]['value_after']!r}")
    if asked is None:
        slope = np.polyfit(cured.path.phi1, cured.path.te, 1)[0]
        assert abs(slope) < 1e-5 < abs(np.polyfit(*solve_te(*keys), 1)[0])
        return
    np.testing.assert_allclose(column(cured, "pinion", "theta_F"), asked, rtol=0, atol=1e-7)
    given = load(SAMPLES / "circular_arc.toml", list(keys))
    first, second = given.pinion.b, given.gear.b  # type: ignore[attr-defined]
    by_36 = {"pinion.b": second, "gear.b": first}[key] - {"pinion.b": 1, "gear.b": -1}[key] * 0.075 * np.sin(
        np.radians(asked)
    )
    assert abs(changed[0]["value_after"] - by_36) < 1e-9


def solve_te(*keys: str) -> tuple[Array, Array]:
    """phi1 and transmission error (rad) of the sample with some keys changed."""
    path = solve("circular_arc", *keys).path
    return path.phi1, path.te


def test_the_sheet_has_theta_by_31_beside_the_exact_one() -> None:
    sheet = gm.build(load(SAMPLES / "circular_arc.toml", ["assembly.dC=0.021"])).sheet()
    (table,) = [each for each in sheet.tables if each.title.startswith("Point of contact")]
    theta = [row[-1] for row, symbol in zip(table.rows, table.symbols, strict=True) if symbol.startswith("theta")]
    np.testing.assert_allclose(theta[1:], [30.0, 12.70903, 12.81413], rtol=0, atol=1e-5)


def test_settings_that_cannot_help_say_so() -> None:
    with pytest.raises(NoSolutionError, match="reduce the assembly errors"):
        compensations("assembly.dC=0.5")
