"""Sections: their curves against exact surfaces, both ways, against solids and volumes; the files as other programs read them."""

from __future__ import annotations

import re
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from oracles import built, ring
from oracles.command_line import refused, run
from oracles.places import SAMPLES
from oracles.plane_curves import evenly, from_polylines

import gearmesh as gm
from gearmesh import Member, load
from gearmesh.cad.brep import Piece, exact_volume
from gearmesh.cad.contours.curves import PlaneSpline
from gearmesh.cad.section import member_section
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneArc, PlaneLine
from gearmesh.kinds import Region
from gearmesh.mesh.solid import gear_solid

#: case -> sample, changes, member, share of the face: keyway and rounded edges, undercut and chamfers at the toe's end face, no
#: bore, a ground root that is no arc of the blank's
CASES = {
    "keyed": (
        "helical",
        ["pinion.bore=30", "pinion.keyway={width=8, depth=3.3}", "pinion.tip_rounding=0.4"],
        "pinion",
        0.31,
    ),
    "undercut": ("beveloid_crossed", ["pinion.teeth=12", "pinion.tip_chamfer=0.2"], "pinion", 0.0),
    "full": ("spur", ["gear.bore=0"], "gear", 0.5),
    "throated": ("worm_drive", [], "wheel", 0.5),
    "novikov": ("novikov", [], "pinion", 0.77),
    "relieved": ("spur", ['pinion.modifications={tip_relief={amount="20um", start_roll_length=13}}'], "pinion", 0.5),
}
#: the same within a broken edge of an end face: z 0.4 of its depth above the toe's end face
WITHIN = {
    "chamfered": ("helical", ["pinion.end_chamfer=0.5", "pinion.tip_rounding=0.4"], "pinion", 0.2 / 50.0),
    "ring": ("internal", ["gear.end_rounding=0.2"], "gear", 0.08 / 20.0),
    "bar": ("rack", ["rack.end_rounding=0.4", "rack.length=210"], "rack", 0.16 / 24.0),
}
#: contours are closed to this, mm
CLOSED = 1e-9
#: and in files, whose numbers have nine decimals
CLOSED_IN_FILES = 2e-9
#: points on every curve of a tooth, or so far apart (mm): chords between them are within CHORD (mm) of it
DENSE, CLOSE, CHORD = 4001, 5e-4, 1e-7


def member_of(case: str) -> tuple[Member, float]:
    """A member, and z of its section."""
    sample, changes, name, share = {**CASES, **WITHIN}[case]
    member = built.pair_of(load(SAMPLES / f"{sample}.toml", changes)).members[name]
    low, high = member.tooth.blank.body.ends
    return member, low + share * (high - low)


def exact_lines(member: Member, z: float, count: int = DENSE) -> list[Array]:
    """The exact section of tooth 1: polylines through so many points on every link."""
    tooth = member.tooth
    toe, heel = tooth.blank.extent
    sections = tooth.sections([(z * (1.0 if heel > toe else -1.0) - toe) / (heel - toe)])
    return [tooth.grid(region, np.linspace(0.0, 1.0, count), sections).points[:, 0, :2] for region in tooth.regions]


@pytest.mark.sweep_cases(
    "novikov-0.01",
    "novikov-1e-05",
    "full-0.01",
    "full-1e-05",
    "keyed-0.01",
    "relieved-0.01",
    "relieved-1e-05",
    "throated-1e-05",
    "undercut-0.01",
    "undercut-1e-05",
)
@pytest.mark.parametrize("tolerance", [1e-2, 1e-5])
@pytest.mark.parametrize("case", CASES)
def test_curves_are_within_the_tolerance_of_the_exact_section_both_ways(case: str, tolerance: float) -> None:
    member, z = member_of(case)
    section = member_section(member, z, tolerance)
    assert section.deviation <= tolerance
    teeth = next(each for each in section.contours if each.name == "teeth")
    one = teeth.curves[: len(teeth.curves) // member.tooth.teeth]
    drawn = [curve.at(np.linspace(0.0, 1.0, DENSE)) for curve in one]
    exact = exact_lines(member, z)
    assert from_polylines(np.concatenate(drawn), exact).max() <= tolerance
    assert from_polylines(np.concatenate(exact), drawn).max() <= tolerance
    kinds = {"flank": PlaneSpline, "land": PlaneArc, "edge": PlaneLine if case == "undercut" else PlaneArc}
    pieces = [piece for region in member.tooth.regions for piece in Piece.of(member.tooth, region)]
    # a flank with a corner, where a relief begins, takes a spline on either side of it
    assert len(pieces) == len(member.tooth.regions) + (2 if case == "relieved" else 0)
    for piece, curve in zip(pieces, one, strict=True):
        assert isinstance(curve, kinds.get(piece.region.split("_")[0], (PlaneArc, PlaneSpline)))
        assert not isinstance(curve, PlaneSpline) or len(curve.control) <= 40


@pytest.mark.sweep_cases("novikov", "bar", "chamfered", "keyed", "ring", "throated", "undercut")
@pytest.mark.parametrize("case", [*CASES, *WITHIN])
def test_loops_close_and_are_what_the_solid_has_there(case: str) -> None:
    """The solid's triangles, cut by the plane: segments as near as the solid is, and the length of all of them."""
    import trimesh

    member, z = member_of(case)
    section, fine = member_section(member, z, 1e-4), 1e-3
    assert section.gap <= CLOSED
    mesh = gear_solid(member, fine)
    # on an end face there is nothing to cut
    height = z + 1e-7 if case == "undercut" else z
    solid = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    segments = trimesh.intersections.mesh_plane(solid, (0.0, 0.0, 1.0), (0.0, 0.0, height))[..., :2]
    lines = [evenly(curve) for each in section.contours for curve in each.curves]
    assert from_polylines(segments.reshape(-1, 2), lines).max() <= fine + 1e-4
    length = sum(np.linalg.norm(np.diff(line, axis=0), axis=-1).sum() for line in lines)
    assert np.linalg.norm(segments[:, 1] - segments[:, 0], axis=-1).sum() == pytest.approx(length, rel=1e-3)


@pytest.mark.parametrize(("case", "stations"), [("keyed", 1), ("full", 1), ("beveloid", 10)])
@pytest.mark.sweep_cases("beveloid-10")
def test_area_makes_the_exact_volume(case: str, stations: int) -> None:
    """Sections of cylindrical gears are all alike; else Gauss quadrature over the face."""
    if case == "beveloid":
        member = built.pair_of(load(SAMPLES / "beveloid_crossed.toml")).members["gear"]
    else:
        member, _ = member_of(case)
    nodes, weights = np.polynomial.legendre.leggauss(stations)
    low, high = member.tooth.blank.body.ends
    areas = [member_section(member, low + 0.5 * (high - low) * (x + 1.0), 1e-5).area for x in nodes]
    assert 0.5 * (high - low) * float(weights @ areas) == pytest.approx(exact_volume(member), rel=5e-8)


@pytest.mark.sweep
@pytest.mark.sweep_cases("double_helical-pinion", "internal-gear", "helical-pinion")
@pytest.mark.parametrize(
    ("sample", "member"), [("helical", "pinion"), ("double_helical", "pinion"), ("internal", "gear"), ("rack", "rack")]
)
def test_areas_within_chamfers_make_the_exact_volume(sample: str, member: str) -> None:
    """Between plane end faces a chamfer is ruled: the area is of the second degree in z there, which two points integrate."""
    depth, changes = 0.2, [f"{member}.end_chamfer=0.2"]
    part = built.pair_of(load(SAMPLES / f"{sample}.toml", changes)).members[member]
    ends = [z for body in (part.plain_body, *(gap.body for gap in part.gaps)) for z in body.ends]
    # a half beside a gap has a broken edge there, too
    halves = np.array(sorted(ends)).reshape(-1, 2)
    places = np.sort(np.concatenate((halves, halves + np.array([depth, -depth])), axis=None))
    total = 0.0
    for low, high in pairwise(places.tolist()):
        middle, off = 0.5 * (low + high), 0.5 * (high - low) / np.sqrt(3.0)
        areas = [member_section(part, z, 1e-5).area for z in (middle - off, middle + off)]
        total += 0.5 * (high - low) * sum(areas)
    assert total == pytest.approx(exact_volume(part), rel=5e-8)


@pytest.mark.quick
@pytest.mark.parametrize("heel", [1.0, -1.0])
def test_teeth_bound_a_ring_from_inside(heel: float) -> None:
    section = member_section(ring.ring(heel), 3.0, 1e-5)
    assert [(each.name, each.material) for each in section.contours] == [("rim", True), ("teeth", False)]
    assert section.gap <= CLOSED
    assert section.area == pytest.approx(ring.ring_volume() / (2.0 * ring.HALF), rel=1e-7)


@pytest.mark.sweep
def test_a_root_too_narrow_to_be_drawn_leaves_no_gap() -> None:
    """Fillets that meet but for some 1e-7 mm: nearly as large a rounding of the tool's tip as there can be."""

    def pinion(radius: float) -> Member:
        design = load(SAMPLES / "spur.toml", [f"pinion.tool_tip_radius={radius!r}"])
        return built.pair_of(design).members["pinion"]

    low, high = 0.3, 0.9
    for _ in range(50):
        middle = 0.5 * (low + high)
        try:
            pinion(middle)
            low = middle
        except gm.DesignError:
            high = middle
    member = pinion(low - 1e-7)
    root = member.tooth.grid(Region.ROOT, [0.0, 1.0], member.tooth.sections([0.5])).points[:, 0]
    assert 1e-8 < np.linalg.norm(root[1] - root[0]) < 1e-6
    section = member_section(member, 0.0, 1e-4)
    assert len(section.contours[0].curves) == member.tooth.teeth * (len(member.tooth.regions) - 1)
    assert section.gap <= CLOSED
    assert section.deviation <= 1e-4


def parsed_svg(text: str) -> dict[str, Array]:
    """Points on the path of every id, from its commands, y upwards: the reader that this test is."""
    found = {}
    for name, data in re.findall(r'<path id="([^"]+)" d="([^"]+)"', text):
        words, lines, here = re.findall(r"[MCLAZ]|-?[\d.]+", data), list[Array](), np.zeros(2)
        while words:
            command = words.pop(0)
            count = {"M": 2, "L": 2, "C": 6, "A": 7, "Z": 0}[command]
            values, words = np.array([float(word) for word in words[:count]]), words[count:]
            t = np.linspace(0.0, 1.0, 33 if command == "C" else 1025)[:, None]
            if command == "C":
                one, two, three = values.reshape(3, 2)
                lines.append((1 - t) ** 3 * here + 3 * (1 - t) ** 2 * t * one + 3 * (1 - t) * t**2 * two + t**3 * three)
            elif command == "A":
                (radius, _, _, large, clockwise), end = values[:5], values[5:]
                chord = end - here
                aside = np.array([-chord[1], chord[0]]) / np.linalg.norm(chord)
                rise = np.sqrt(max(radius**2 - 0.25 * chord @ chord, 0.0)) * (1.0 if large != clockwise else -1.0)
                centre = 0.5 * (here + end) + rise * aside
                first, last = (np.arctan2(*(point - centre)[::-1]) for point in (here, end))
                width = (last - first) % (2 * np.pi) if clockwise else -((first - last) % (2 * np.pi))
                angle = first + t * width
                lines.append(centre + radius * np.hstack((np.cos(angle), np.sin(angle))))
            elif command == "L":
                lines.append(here + t * (values - here))
            elif command == "M":
                lines.append(values[None])
            here = lines[-1][-1]
        found[name] = np.concatenate(lines) * [1.0, -1.0]
    return found


@pytest.mark.sweep
def test_svg_files_hold_the_curves(tmp_path: Path) -> None:
    sample, changes, name, _ = CASES["keyed"]
    section = gm.build(load(SAMPLES / f"{sample}.toml", changes)).section(name, -7.0, 1e-3)
    text = section.save(tmp_path / "a.svg").read_text()
    paths = parsed_svg(text)
    assert list(paths) == ["pinion_teeth", "pinion_bore"]
    size = float(re.search(r'width="([\d.]+)mm"', text)[1])  # type: ignore[index]
    corner, _, wide, high = map(float, re.search(r'viewBox="([^"]+)"', text)[1].split())  # type: ignore[index]
    assert size == wide == high == pytest.approx(-2.0 * corner)
    for loop, points in zip(section.loops, paths.values(), strict=True):
        lines = [evenly(curve, CLOSE) for curve in loop.curves]
        assert from_polylines(points, lines).max() < CHORD
        assert from_polylines(np.concatenate(lines)[::97], [points]).max() < 0.1
        assert np.abs(points).max() < -corner
        assert np.linalg.norm(points[-1] - points[0]) <= CLOSED
        x, y = points.T
        assert 0.5 * float(x[:-1] @ y[1:] - x[1:] @ y[:-1]) == pytest.approx(loop.area, rel=1e-3)


def test_dxf_files_are_sound_and_hold_the_curves(tmp_path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    sample, changes, name, _ = CASES["keyed"]
    section = gm.build(load(SAMPLES / f"{sample}.toml", changes)).section(name, tolerance=1e-3)
    document = ezdxf.readfile(section.save(tmp_path / "a.dxf"))
    found = document.audit()
    assert (found.errors, found.fixes) == ([], [])
    # mm
    assert (document.header["$INSUNITS"], document.header["$MEASUREMENT"]) == (4, 1)
    entities = list(document.modelspace())
    assert [each.dxf.layer for each in entities] == [
        layer for layer, loop in zip(["pinion_teeth", "pinion_bore"], section.loops, strict=True) for _ in loop.curves
    ]
    for loop in section.loops:
        ends = []
        for curve in loop.curves:
            entity = entities.pop(0)
            if entity.dxftype() == "SPLINE":
                points = [tuple(point) for point in entity.construction_tool().approximate(64)]
                assert (entity.dxf.degree, entity.dxf.n_knots) == (3, entity.dxf.n_control_points + 4)
            elif entity.dxftype() == "ARC":
                points = [tuple(point) for point in entity.flattening(1e-4)]
            else:
                points = [tuple(entity.dxf.start), tuple(entity.dxf.end)]
            flat = np.array(points)[:, :2]
            ends.append((flat[0], flat[-1]))
            assert from_polylines(flat, [evenly(curve, CLOSE)]).max() < CHORD
        gaps = [np.linalg.norm(ends[k][0] - ends[k - 1][1]) for k in range(len(ends))]
        assert max(gaps) <= CLOSED_IN_FILES


@pytest.mark.parametrize(
    ("sample", "arguments", "words"),
    [
        (
            "spur",
            "pinion -o a.stl --section 2",
            "--section = 2: must be left out for .stl; formats of sections are .dxf, .svg",
        ),
        ("spur", "pinion -o a.svg --section high", "--section = high: must be a length"),
        (
            "spur",
            "pinion -o a.svg --section -15.1mm",
            "--section = -15.1 mm: must be within the face of the pinion, from -15 to 15",
        ),
        ("spur", "both -o a.svg", "--member = both: .svg holds one part"),
        ("spur", "gear -o a.svg --teeth 3", "--teeth = 3: must be left out for .svg"),
        ("zerol", "gear -o a.svg", "gear: has no transverse section: its teeth end on cones or cylinders"),
    ],
)
def test_refusals(sample: str, arguments: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    message = refused("solid", SAMPLES / f"{sample}.toml", "--member", *arguments.split(" "))
    assert message.startswith(words)
    assert not list(tmp_path.iterdir())


def test_a_section_on_an_end_face_in_inches(tmp_path: Path) -> None:
    file = tmp_path / "a.svg"
    status, out, _ = run("solid", SAMPLES / "spur.toml", "--member", "gear", "-o", file, "--section=-0.5in")
    assert status == 0
    assert re.search(r"z_mm +-12\.7\n", out)
    assert file.read_text().startswith("<?xml")


def test_without_the_extra_one_line_names_it(tmp_path: Path) -> None:
    """ezdxf's absence is found before the work; the existing file stays."""
    old = tmp_path / "gear.dxf"
    old.write_text("kept")
    program = "import sys; sys.modules['ezdxf'] = None; from gearmesh.app.cli import main; sys.exit(main(sys.argv[1:]))"
    arguments = ["solid", str(SAMPLES / "spur.toml"), "--member", "gear", "-o", str(old)]
    done = subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == 'gearmesh: error: DXF needs ezdxf: pip install "gearmesh[cad]"\n'
    assert [file.read_text() for file in tmp_path.iterdir()] == ["kept"]
