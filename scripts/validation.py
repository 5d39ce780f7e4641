"""Compute the table of scripts/site/pages/validation.md: references to which gearmesh is compared, and the differences.

Usage: python scripts/validation.py [NAME ...] [--write]

Each function whose name begins with `of_` computes one line or several. References are published tables, samples of standards,
closed forms, and second routes that share no equation with the solver. Lines on CalculiX and on random designs come from the
tables that other scripts wrote into scripts/measured. The printed figures are in the tests, which hold every line within a stated
tolerance (`pip install ".[test]"`). NAME is the name of a function without `of_`. All functions take two CPU minutes.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, replace
from importlib import import_module
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from tables import kept, rewrite, table

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "scripts" / "site" / "pages" / "validation.md"
#: the tests have the printed figures, and routes of their own
for folder in ("", "systems", "contact", "check", "metrology", "study", "loaded"):
    sys.path.append(str(ROOT / "tests" / folder))
TITLES = {
    "claim": "claim",
    "reference": "reference",
    "stated": "stated there",
    "computed": "gearmesh",
    "difference": "largest difference",
    "script": "computed by",
}


@dataclass(frozen=True)
class Line:
    """A line of the table: claim, reference, both figures, their difference, and the script or test that reproduces it."""

    claim: str
    reference: str
    stated: str
    computed: str
    difference: str
    script: str = ""


def of_lt02() -> Iterator[Line]:
    """All rows of Tables 2 to 4 with points and edges."""
    published = import_module("test_published")
    length = angle = error = 0.0
    for sample, errors, text in published.POINT_CASES.values():
        solved = published.solve(sample, *errors)
        path = solved.path
        printed = np.array(text.split(), dtype=float).reshape(5, 7)
        own = [published.column(solved, member, name) for member, name in MEMBERS_LT02]
        length = max(length, *(np.abs(a - printed[:, k]).max() for a, k in zip(own, (1, 2, 4, 5), strict=True)))
        angle = max(angle, np.abs(np.degrees(path.phi2) - printed[:, 3]).max())
        error = max(error, np.abs(path.te / ARCSEC - printed[:, 6]).max())
    rows = 5 * len(published.POINT_CASES)
    difference = f"{length:.2g} mm, {angle:.2g} deg, {error:.2g} arcsec"
    yield Line(
        "point and edge contact of beveloid gears", "[LT02] Tables 2 to 4", f"{rows} rows of 6 figures", "", difference
    )
    crossed = published.solve("beveloid_crossed").summary["shaft_angle_deg"]
    yield Line(
        "shaft angle of crossed beveloid gears",
        "[LT02] example 2",
        "49.6284 deg",
        f"{crossed:.6f} deg",
        f"{abs(crossed - 49.6284):.1g} deg",
    )


MEMBERS_LT02 = (("pinion", "l_F"), ("pinion", "u_F"), ("gear", "l_G"), ("gear", "u_G"))
ARCSEC = float(np.radians(1.0 / 3600.0))


def of_lt85() -> Iterator[Line]:
    """Example 1, and both tables of example 2."""
    published = import_module("test_published")
    theta = float(published.column(published.solve("circular_arc", "assembly.dC=0.021"), "pinion", "theta_F")[0])
    yield Line(
        "pressure angle at a changed centre distance",
        "[LT85] example 1",
        "12.81412 deg",
        f"{theta:.5f} deg",
        f"{abs(theta - 12.81412):.1g} deg",
    )
    (cases,) = (mark for mark in published.test_lt85_tables.pytestmark if mark.name == "parametrize")
    angle = error = 0.0
    for lead, text in cases.args[1]:
        solved = published.solve("circular_arc", "assembly.dgamma=0.1", f"pinion.lead_angle={lead}")
        printed = np.array(text.split(), dtype=float).reshape(5, 3)
        own = [published.column(solved, "pinion", "theta_F"), published.column(solved, "gear", "theta_P")]
        angle = max(angle, np.abs(np.column_stack(own) - printed[:, :2]).max())
        error = max(error, np.abs(solved.path.te / ARCSEC - printed[:, 2]).max())
    yield Line(
        "transmission error of circular-arc gears, misaligned and compensated",
        "[LT85] Tables 1, 2",
        "30 figures, 59.88 to -59.89 arcsec",
        "",
        f"{angle:.2g} deg, {error:.2g} arcsec",
    )


def of_ab() -> Iterator[Line]:
    """Table 3: settings by local synthesis; the misaligned pair against cones swept by matrices."""
    bevel = import_module("test_spiral_bevel")
    worst = 0.0
    for name, (printed, asked) in bevel.TABLE_3.items():
        mapping = bevel.load(bevel.STRAIGHT).resolve()
        side = mapping["pinion"][name]
        for key in bevel.GIVEN:
            del side[key]
        side |= dict(zip(("ratio_derivative", "path_angle", "semi_major_axis"), asked, strict=True))
        side["ratio_derivative"] *= 4.1
        pinion = bevel.sides(bevel.parse(mapping), name)[1]
        machine, blade = pinion.settings, pinion.blade
        own = (np.degrees(blade.blade_angle), blade.tip_radius, machine.radial, np.degrees(machine.cradle_angle))
        own = (*own, machine.ratio_of_roll, machine.machining_offset, machine.machine_centre_to_back)
        places = [d if isinstance(d, int) else d[name == "convex"] for d in bevel.DIGITS]
        worst = max(worst, *(abs(a - b) * 10.0**d for a, b, d in zip(own, printed, places, strict=True)))
    yield Line(
        "machine settings by local synthesis", "[AB] Table 3", "14 settings", "", f"{worst:.2g} of the last digit"
    )
    from oracles.swept_cones import transmission_error

    apart = 0.0
    for side, last in (("concave", -18.0), ("convex", 18.0)):
        design = bevel.load(bevel.STRAIGHT, [f"contact.side=pinion_{side}", "assembly.dA=-0.05"])
        phi1 = np.radians([0.0, 0.5 * last, last])
        own_error = bevel.contact_path(bevel.solver_pair(bevel.pair_of(design)), phi1, edges=False).te
        apart = max(apart, np.abs(own_error - transmission_error(side, phi1, axial=-0.05)).max() / ARCSEC)
    yield Line(
        "transmission error of a misaligned spiral bevel pair",
        "cones moved by matrices, solved by scipy, from the printed settings",
        "both sides, up to 18 deg",
        "",
        f"{apart:.2g} arcsec",
    )


def of_cr3553() -> Iterator[Line]:
    """Sample problem 1.7.1, its misprint mended."""
    from oracles.curvature import from_principal

    from gearmesh.kernel.surface.curvature import contact_ellipse

    first = from_principal(*map(np.asarray, (0.01047, -0.00744, 0.0)))
    second = from_principal(*map(np.asarray, (-0.03845, -0.00711, np.radians(12.47))))
    ellipse = contact_ellipse(first - second, *np.eye(3)[:2], 0.02)
    minor, printed = float(ellipse.semi_minor), 0.035826771 * 25.4
    yield Line(
        "minor axis of the contact ellipse",
        "[CR3553] sample problem 1.7.1",
        f"{printed:.4f} mm",
        f"{minor:.4f} mm",
        f"{abs(minor - printed):.1g} mm",
    )


def of_lf04() -> Iterator[Line]:
    """The transmission error of Table 17.8.1, half a pitch either way."""
    helical = import_module("test_parabolic_helical")
    for kind, why in (
        ("modified_involute", ""),
        ("novikov", " (the worm plunges less than the rack: [misprints](theory/misprints.md))"),
    ):
        lag = -helical.over_a_pitch(helical.gears(kind)).te[[0, -1]] / ARCSEC
        own = f"{lag[0]:.2f} and {lag[1]:.2f} arcsec{why}"
        yield Line(
            f"transmission error of a crowned pair, `{kind}`",
            "[LF04] Table 17.8.1",
            "8 arcsec",
            own,
            f"{np.abs(lag - 8.0).max():.2g} arcsec",
        )


def of_iso23509() -> Iterator[Line]:
    """Samples 1, 2 and 4 of annex F: figures that agree, by the measure of the tests."""
    iso = import_module("test_iso23509")
    given = iso.SAMPLES["sample1"]["inputs"]
    cones = iso.without_offset((14, 39), iso.RIGHT, given["de2"], given["b2"], float(np.radians(given["beta_m2"])))
    rounded = replace(iso.factors(given), profile_shift=0.505, thickness=0.046)
    cases = (
        ("sample1", "method 0", iso.sampled("sample1", cones, rounded), 0.0, 1.0, "one unit of the last digit"),
        ("sample2", "method 1, hypoid", iso.sampled("sample2", iso.with_offset(iso.SAMPLE_2)), 1e-3, 0.5, "0.1 %"),
        ("sample4", "method 3, hypoid", iso.sampled("sample4", iso.with_offset(iso.SAMPLE_4)), 1e-3, 0.5, "0.1 %"),
    )
    for name, what, own, share, digits, within in cases:
        count, wrong = len(iso.SAMPLES[name]["expected"]), iso.misses(name, own, share, digits)
        beyond = f"; beyond: {', '.join(wrong)} ([misprints](theory/misprints.md))" if wrong else ""
        yield Line(
            f"bevel gear blanks, {what}",
            f"ISO 23509 annex F, {name[:-1]} {name[-1]}",
            f"{count} figures",
            f"{count - len(wrong)} of {count}",
            f"{within}{beyond}",
        )


def of_iso21771() -> Iterator[Line]:
    """Contact ratio of conjugate pairs in closed form."""
    rolling = import_module("test_rolling")
    for name in ("spur", "helical"):
        gears = rolling.pair_of(rolling.load(rolling.SAMPLES / f"{name}.toml"))
        cycle, stated = rolling.mesh_cycle(rolling.solver_pair(gears), gears.pitch), rolling.iso_contact_ratio(name)
        yield Line(
            f"contact ratio, `{name}`",
            "ISO 21771, closed form",
            f"{stated:.5f}",
            f"{cycle.contact_ratio:.5f}",
            f"{abs(cycle.contact_ratio - stated):.1g}",
        )
        yield Line(
            f"transmission error of the conjugate pair, `{name}`",
            "closed form",
            "0",
            f"{cycle.peak_to_peak / ARCSEC:.1g} arcsec",
            f"{cycle.peak_to_peak / ARCSEC:.1g} arcsec",
        )


def of_crowning() -> Iterator[Line]:
    """Transmission error of a profile-crowned spur pair, over the mesh cycle."""
    modified = import_module("test_modified")
    amount, (spurs, path, pitch) = 0.002, modified.spur()
    pair = modified.built({"profile_crowning": f"{1e3 * amount:g}um"})
    field = modified.involute(pair).amount
    length = np.linspace(path[0] + 1.0, path[1], 60_001)
    jet = field.jet(length, 0.0 * length)
    angle, gear = spurs.standing(length, jet.a, jet.a_l)
    order = np.argsort(angle)
    stated = modified.peak_to_peak(angle[order], spurs.advance(angle, gear)[order], pitch) * spurs.gear
    own = modified.mesh_peak_to_peak(pair) * spurs.gear
    yield Line(
        "transmission error of profile crowning 2 um",
        "involutes in closed form",
        f"{1e3 * stated:.6f} um",
        f"{1e3 * own:.6f} um",
        f"{1e3 * abs(own - stated):.1g} um",
    )


def of_hertz() -> Iterator[Line]:
    """Point contact against a published table of its axes and approach."""
    hertz = import_module("test_hertz")
    shape = hertz.HARRIS[:, 0]
    solved = hertz.point_contact(0.5 * (1.0 - shape), 0.5 * (1.0 + shape), 2.0 / 3.0, 1.0)
    own = np.stack((solved.semi_major, solved.semi_minor, 2.0 * solved.approach), axis=-1)
    off = np.abs(own / hertz.HARRIS[:, 1:] - 1.0).max()
    yield Line(
        "Hertz contact: axes and approach",
        "Harris, Rolling Bearing Analysis, table",
        f"{own.size} figures to 4 digits",
        "",
        f"{off:.1g} relative",
    )


def of_roll() -> Iterator[Line]:
    """First touch against exact grids that are turned until nothing overlaps."""
    rolling = import_module("test_rolling")
    gears, path = rolling.case(6)
    share = np.linspace(0.0, 1.0, 81)
    grids = [
        member.tooth.flank_grid(side, share, share).points
        for member, side in zip((gears.pinion, gears.gear), gears.flanks, strict=True)
    ]
    rolled = rolling.roll(*grids, gears.mounts, gears.ratio, path.rotation, gears.drive, 0.00635, path.phi2)
    off = max(abs(one.phi2 - exact) for one, exact in zip(rolled, path.phi2, strict=True)) / ARCSEC
    yield Line(
        "first touch, crossed beveloid pair",
        "exact grids of 81 x 81 points, turned until nothing overlaps",
        f"{len(rolled)} positions",
        "",
        f"{off:.1g} arcsec",
    )


def of_worm() -> Iterator[Line]:
    """A wheel cut by a hob of the worm's size: no transmission error."""
    worm = import_module("test_worm_drive_truth")
    hands = [(form, hand) for form in ("ZA", "ZN", "ZI", "ZK") for hand in ("true", "false")]
    worst = max(np.abs(worm.path(f"worm.form={form}", f"worm.right_hand={hand}").te).max() for form, hand in hands)
    yield Line(
        "transmission error of worm drives ZA, ZN, ZI, ZK, equal hob",
        "conjugate by generation",
        "0",
        "",
        f"{worst:.1g} rad",
    )


def of_vh() -> Iterator[Line]:
    """V and H, applied: where the gears then turn at the ratio of their teeth, by the solver of contact."""
    vh = import_module("test_vh_check")
    design = vh.DESIGNS["basic"]()
    blank, worst, places = vh.basic_blank(design.in_mm()), 0.0, 0
    for row in (row.row for row in vh.gm.build(design).vh().rows):
        moved = {"contact.side": row["side"], "assembly.dV": row["v_mm"], "assembly.dA": row["h_mm"]}
        wanted = blank.gear.inner_cone_distance + vh.SHARES[row["place"]] * blank.gear.face_width
        vertices = vh.vertices(vh.pair_of(design.with_values(moved)))
        worst = max(worst, min(abs(vh.along(blank, path) - wanted) for path in vertices))
        places += 1
    yield Line(
        "V-H check, `spiral_bevel_basic`: V and H bring the contact to toe, middle and heel",
        "contact of the pair so displaced, where n . v12 = 0",
        f"{places} places of both sides",
        "",
        f"{worst:.1g} mm along the cone distance",
    )


def of_measured() -> Iterator[Line]:
    """Measured flanks, settings corrected from them, pitch deviations."""
    flanks, corrections = import_module("test_measured_flanks"), import_module("test_corrections")
    composite = import_module("test_composite")
    with TemporaryDirectory() as scratch:
        folder = Path(scratch)
        for sample, name in (("beveloid_crossed", "gear"), ("hypoid", "pinion")):
            design = flanks.gm.load(ROOT / "samples" / f"{sample}.toml")
            distances = flanks.through_points(design, flanks.gm.build(design).members[name], folder / f"{name}.csv")[1]
            yield Line(
                f"measured flank, {name} of `{sample}`",
                "its measured points, by projection",
                f"{distances.size} points",
                "",
                f"{np.abs(distances).max():.1g} mm",
            )
        keys, points = flanks.crowned_and_measured(folder)
        error = np.abs(points.path.te - keys.path.te).max() / ARCSEC
        backlash = abs(points.summary["backlash_min_deg"] - keys.summary["backlash_min_deg"])
        yield Line(
            "contact of a measured gear with crownings and slopes",
            "the design that has these by its keys",
            f"TE of {np.ptp(keys.path.te) / ARCSEC:.2f} arcsec",
            f"{np.ptp(points.path.te) / ARCSEC:.2f} arcsec",
            f"{error:.1g} arcsec, backlash {backlash:.1g} deg",
        )
        plain = flanks.gm.load(ROOT / "samples" / "hypoid.toml")
        hypoid = corrections.systems.pin(plain, corrections.systems.build(plain))
        off = corrections.CHANGES["radial"]
        corrections.measured(folder / "pinion.csv", hypoid, {"radial": off})
        made = corrections.correct_settings(hypoid, "pinion", folder / "pinion.csv")
        changes = {s.name: c for s, c in zip(made.settings, made.solution.changes, strict=True)}
        left = max(np.abs(residual.values).max() for residual in made.residual.values())
        yield Line(
            "corrected settings of a hypoid pinion, cut with one setting off, 12 free",
            "what it was cut with; deviations by intersections along normals",
            f"radial {1e3 * off:.4f} um",
            f"{-1e3 * changes['concave.radial']:.4f} um",
            f"{1e3 * abs(changes['concave.radial'] + off):.1g} um; residual {1e3 * left:.1g} um",
        )
    lead, turns = composite.lead_of_involute_teeth()
    stated, own = np.ptp(lead) / ARCSEC, turns.peak_to_peak / ARCSEC
    yield Line(
        "total single-flank deviation of gears with random pitch deviations, 16/32",
        "involute teeth in closed form",
        f"{stated:.4f} arcsec",
        f"{own:.4f} arcsec",
        f"{abs(own - stated):.1g} arcsec",
    )


def of_studies() -> Iterator[Line]:
    """Rows against designs alone; shares of the variance in closed form and by scipy."""
    rows, variance = import_module("test_study_rows"), import_module("test_variance")
    worst = max(
        abs(study.columns[name][row] / alone[name] - 1.0)
        for study, row, alone in rows.rows_and_designs()
        for name in rows.ALIKE
    )
    yield Line(
        "row of a study: errors of assembly and a rebuilt key together",
        "the design with these keys, alone",
        f"{len(rows.ALIKE)} figures of 2 rows",
        "",
        f"{worst:.1g} relative",
    )
    plan = variance.sample_plan(variance.CUBE, 2048, "saltelli", 1)
    keys, values = variance.ishigami(plan)
    shares = variance.variance_shares(plan, keys, "y", values)
    off = max(max(abs(s.first - variance.FIRST[s.key]), abs(s.total - variance.TOTAL[s.key])) for s in shares)
    yield Line(
        "shares of the variance, first and total order, 10,240 rows",
        "Ishigami's function in closed form",
        "6 figures",
        "",
        f"{off:.1g} of 1",
    )
    table = values.reshape(-1, 1, 2048)
    by_scipy = variance.sobol_indices(func={"f_A": table[0], "f_B": table[1], "f_AB": table[2:]}, n=2048)
    own = np.array([[s.first, s.total] for s in shares])
    yield Line(
        "the same rows",
        "scipy.stats.sobol_indices",
        "6 figures",
        "",
        f"{np.abs(own - np.column_stack((by_scipy.first_order, by_scipy.total_order))).max():.1g} of 1",
    )


def of_worm_load() -> Iterator[Line]:
    """A worm drive under torque: equilibrium, Hertz, its mirror image."""
    worm = import_module("test_worm_load")
    torque = np.array([2e4])
    right = worm.loaded(worm.PHI1, torque)
    yield Line(
        "worm drive under 20 Nm: torque of the wheel, without friction",
        "i T1",
        "400 Nm",
        f"{1e-3 * right.gear_torque.mean():.2f} Nm",
        f"{np.abs(right.gear_torque / (20.0 * torque) - 1.0).max():.1g} relative",
    )
    moments = np.bincount(right.loads[0].position, right.loads[0].moment)
    yield Line(
        "moments of all its lines of contact together",
        "T1",
        "20 Nm",
        "",
        f"{np.abs(moments / torque - 1.0).max():.1g} relative",
    )
    peaks, hertz = worm.peaks_and_hertz()
    yield Line(
        "pressure across lines of contact of a worm drive",
        "Hertz, curvature of the conjugate flanks in closed form",
        f"{peaks.size} places, up to {hertz.max():.0f} MPa",
        f"up to {peaks.max():.0f} MPa",
        f"{100.0 * np.abs(peaks / hertz - 1.0).max():.1g} %",
    )
    left, right = (worm.loaded(worm.PHI1, torque, hand=hand, hob=44.0) for hand in (False, True))
    yield Line(
        "left-hand worm drive of an oversized hob under load",
        "mirror image of the right-hand one",
        "rotation, load of each line",
        "",
        f"{apart(left, right):.1g} relative",
    )


def apart(left: Any, right: Any) -> float:
    """Largest relative difference of rotations and of the loads that lines of contact carry."""
    forces = [np.sort(found.loads[0].force) for found in (left, right)]
    return max(
        np.abs(left.rotation / right.rotation - 1.0).max(), np.abs(forces[0] - forces[1]).max() / forces[1].max()
    )


def of_volume() -> Iterator[Line]:
    """Volume of a solid and of a CAD body against the integral over the exact surfaces."""
    import gearmesh as gm
    from gearmesh.cad.brep import exact_volume

    gears = gm.build(gm.load(ROOT / "samples" / "helical.toml"))
    exact = exact_volume(gears.members["pinion"])
    solid = gears.solid("pinion", tolerance="1um")
    volume = solid.mesh.volume()
    off = abs(volume / exact - 1.0)
    yield Line(
        "volume of the solid of `helical`'s pinion at 1 um",
        "integral over the exact surfaces",
        f"{exact:.2f} mm3",
        f"{volume:.2f} mm3",
        f"{off:.1g} relative",
    )


def of_calculix() -> Iterator[Line]:
    """Loaded contact: extremes of the table of load_checks.py, by pairs."""
    rows = kept("truth")
    groups: dict[str, list[dict[str, str]]] = {}
    for row in rows:
        groups.setdefault(row["pair"], []).append(row)
    for pair, own in groups.items():
        turned = furthest(row["rotation, arcsec"] and row["loaded, %"] for row in own)
        shares = furthest(row["loaded, points"] for row in own)
        roots = furthest(row[key] for row in own for key in ("loaded, % 3", "loaded, % 4"))
        peaks = furthest(row["loaded, % 2"] for row in own)
        parts = [f"rotation {turned:+.1f} %", f"load share {shares:.1f} points"]
        parts += [f"root stress {roots:+.1f} %"] if roots else []
        parts += [f"peak pressure {peaks:+.1f} %"] if peaks else []
        positions = f"{len(own)} position" + ("s" if len(own) > 1 else "")
        yield Line(
            f"contact under load, {pair}",
            "CalculiX, C3D8I with contact, solved once",
            positions,
            "",
            ", ".join(parts),
            "load_checks.py",
        )


def of_random_designs() -> Iterator[Line]:
    """Seeded designs of every kind, each answer checked by another route: the table of stress.py."""
    rows = kept("stress")
    count = sum(int(row["designs"]) for row in rows)
    refused = sum(int(row["refused, set key"]) for row in rows)
    faults = [
        key
        for key in rows[0]
        if key not in ("kind, range", "designs", "refused, set key") and " s" not in key and "MB" not in key
    ]
    failures = sum(int(row[key]) for row in rows for key in faults)
    yield Line(
        "random designs of 9 kinds: no traceback, bad solid, wrong contact or first touch, silent interference",
        "roll of exact grids and whole members; proofs of the files",
        f"{count:,} designs",
        f"{refused} refused by a key that is set",
        f"{failures} failures",
        "stress.py",
    )


def furthest(texts: Any) -> float:
    """Return the figure furthest from 0 of figures as texts, of which some are empty."""
    return max((float(text) for text in texts if text), key=abs, default=0.0)


PARTS: dict[str, Callable[[], Iterator[Line]]] = {
    name.removeprefix("of_"): part for name, part in list(globals().items()) if name.startswith("of_")
}


def lines(names: list[str]) -> list[Line]:
    """The lines of some parts, or of all."""
    return [replace(line, script=f"`{line.script or name}`") for name in names or PARTS for line in PARTS[name]()]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", metavar="NAME", choices=[*PARTS, []], help=", ".join(PARTS))
    parser.add_argument("--write", action="store_true", help="put the whole table into the site's page")
    options = parser.parse_args()
    made = table([asdict(line) for line in lines([] if options.write else options.names)], TITLES)
    print(made)
    if options.write:
        rewrite(PAGE, {"validation": made})


if __name__ == "__main__":
    main()
