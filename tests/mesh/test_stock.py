"""Stock on the flanks alone: its thickness, roots and lands, hobs that leave it, and what is not changed by it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from oracles.built import built, built_sample
from oracles.command_line import refused, run
from oracles.places import SAMPLES
from scipy.spatial import cKDTree

import gearmesh as gm
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Region, Side
from gearmesh.teeth.region import FLANK_REGIONS
from gearmesh.teeth.stock import stock_tooth

#: mm, of the meshes
TOLERANCE = 0.01
#: stock, as a share of the tooth's height
SHARE = 0.02
#: sample, member, changes: kinds with few teeth, undercut along the face, chamfers, rings, cones, threads, bars
MEMBERS = {
    "helical": ("helical", "pinion", ("pinion.tip_chamfer=0.3",)),
    "ring": ("internal", "gear", ()),
    "bar": ("rack", "rack", ()),
    "bevel": ("spiral_bevel_basic", "pinion", ("pinion.end_chamfer=0.3",)),
    "undercut": ("beveloid_parallel", "pinion", ()),
    "worm": ("worm_drive", "worm", ()),
    "wheel": ("worm_drive", "wheel", ()),
    "face": ("face_gear_conjugate", "gear", ()),
    "hypoid": ("hypoid_formate", "gear", ()),
    "relieved": ("spur_relieved", "pinion", ()),
    "novikov": ("novikov", "pinion", ()),
    "halves": ("double_helical", "pinion", ()),
    "arc": ("circular_arc", "pinion", ()),
    "hobbed": ("hob_protuberance", "gear", ()),
}


def gears_of(case: str, share: float = SHARE) -> tuple[gm.Gears, str, float]:
    """Gears with stock on one member, its name, and the stock (mm)."""
    sample, member, changes = MEMBERS[case]
    finished = built_sample(sample, *changes)
    stock = round(share * finished.members[member].tooth.height, 3)
    table = finished.design.table_named(member)
    return built_sample(sample, *changes, f"{table}.stock={stock / finished.design.mm_per_unit}"), member, stock


def heights(points: Array, surface: Array, normals: Array) -> Array:
    """Heights (N,) of points (N, 3) over a surface, given by many of its points and their normals."""
    _, nearest = cKDTree(surface).query(points)
    return np.asarray(((points - surface[nearest]) * normals[nearest]).sum(axis=-1))


@pytest.mark.sweep
@pytest.mark.sweep_cases(*(case for case in MEMBERS if case not in ("ring", "bar")))
@pytest.mark.parametrize("case", MEMBERS)
def test_solid_has_the_stock_on_its_flanks_and_nowhere_else(case: str) -> None:
    gears, name, stock = gears_of(case)
    member = gears.members[name]
    solid = gears.solid(name, TOLERANCE)
    assert solid.measured.watertight
    assert solid.figures["flank_stock_mm"] == stock
    tooth = member.tooth
    s, t = np.linspace(0.0, 1.0, 121), np.linspace(0.0, 1.0, 121)
    for side in Side:
        finished = tooth.flank_grid(side, s, t)
        surface, normals = finished.points.reshape(-1, 3), finished.normals.reshape(-1, 3)
        patch = next(patch for patch in solid.teeth[0].patches if patch.region == FLANK_REGIONS[side])
        over = heights(patch.points, surface, normals)
        # the ramp goes down to the fillet; over the finished flank the stock is even
        assert over.max() == pytest.approx(stock, abs=2e-3 * stock + 1e-4)
        even = np.abs(over - stock) < 2e-3 * stock + 1e-4
        assert even.mean() > 0.4
    # volume: the area of the finished flanks times the stock, and up to a third more on the ramps
    plain = built_sample(*MEMBERS[case][:1], *MEMBERS[case][2]).solid(name, TOLERANCE)
    assert solid.measured.volume is not None
    assert plain.measured.volume is not None
    flanks = [plain.mesh.region_names.index(region) for region in FLANK_REGIONS.values()]
    area = plain.to_trimesh().area_faces[np.isin(plain.mesh.regions, flanks)].sum()
    added = solid.measured.volume - plain.measured.volume
    assert 0.97 < added / (area * stock) < 1.45
    # roots, fillets and lands are those of the finished gear; points of long threads stand close enough that the plane of the
    # nearest one is within the tolerance
    s, t = np.linspace(0.0, 1.0, 241), np.linspace(0.0, 1.0, 1201)
    for region in (Region.ROOT, Region.LAND, Region.FILLET_RIGHT, Region.FILLET_LEFT):
        link = tooth.chain[region]
        sections, made = tooth.sections(t), next(patch for patch in solid.teeth[0].patches if patch.region == region)
        grid = link.grid(s, sections)
        surface, normals = grid.points.reshape(-1, 3), grid.normals.reshape(-1, 3)
        # stock widens the land, far along the tip circle where a thread ends: no finished surface is below that, and the plane
        # of the nearest point is farther away than the tolerance
        reach = np.sqrt(TOLERANCE * np.hypot(made.points[:, 0], made.points[:, 1]).mean())
        below = cKDTree(surface).query(made.points)[0] < reach
        assert below.mean() > 0.9
        assert np.abs(heights(made.points[below], surface, normals)).max() < TOLERANCE


@pytest.mark.sweep
@pytest.mark.sweep_cases("helical", "ring")
@pytest.mark.parametrize("case", ["helical", "ring", "bar"])
def test_step_file_and_section_have_the_stock(case: str) -> None:
    gears, name, stock = gears_of(case)
    part = gears.cad(name, 1e-3)
    (figures,) = part.figures.values()
    assert figures["flank_stock_mm"] == stock
    assert abs(figures["volume_error"]) < 1e-4
    section, plain = (both.section(name) for both in (gears, built_sample(MEMBERS[case][0], *MEMBERS[case][2])))
    assert section.cut.gap < 1e-9
    # two flanks of every tooth, in the section as thick as the stock over the cosine of the helix angle at the base
    member = gears.members[name]
    s, length = np.linspace(0.0, 1.0, 99), 0.0
    for side in Side:
        points = member.tooth.flank_grid(side, s, [0.5]).points[:, 0, :2]
        length += float(np.linalg.norm(np.diff(points, axis=0), axis=-1).sum())
    assert 0.97 < (section.area - plain.area) / (member.tooth.teeth * stock * length) < 1.45


@pytest.mark.parametrize("teeth", [17, 40])
@pytest.mark.sweep_cases("17")
def test_flank_with_stock_is_that_which_a_hob_leaves(teeth: int) -> None:
    """A hob whose flank is thinner by the stock generates the same flank, farther out than the finished one."""
    stock, tables = 0.12, {"teeth": teeth, "face_width": 20.0}
    common = {"kind": "cylindrical", "module": 3.0, "helix_angle": 12.0}
    finished = built({**common, "gear": tables})
    hobbed = built({**common, "gear": {**tables, "hob": {"protuberance": stock, "stock": stock, "finished": False}}})
    with_stock, as_hobbed = stock_tooth(finished.members["gear"].tooth, stock), hobbed.members["gear"].tooth
    for side in Side:
        s, t = np.linspace(0.0, 1.0, 13), [0.0, 0.4, 1.0]
        flank, dense = with_stock.flank_grid(side, s, t), as_hobbed.flank_grid(side, np.linspace(0.0, 1.0, 6001), t)
        # above the ramps of both: the hob's form point is above that of the finished flank
        begins = max(float(own.joint.radius(own.flank_grid(side, [0.0, 1.0], t).points).min()) for own in (as_hobbed,))
        above = with_stock.joint.radius(flank.points) > begins + 0.5
        assert above.mean() > 0.4
        for k in range(len(t)):
            over = heights(flank.points[above[:, k], k], dense.points[:, k], dense.normals[:, k])
            assert np.abs(over).max() < 1e-6


def test_contact_has_no_stock_and_the_sheet_measures_it() -> None:
    plain, stocked = built_sample("spur"), built_sample("spur", "pinion.stock=0.1mm")
    assert stocked.members["pinion"].tooth.volume() == plain.members["pinion"].tooth.volume()
    rows = {
        symbol: row[-1] if isinstance(row[-1], tuple) else row[-2:]
        for table in stocked.sheet().tables
        for symbol, row in zip(table.symbols, table.rows, strict=False)
    }
    # two flanks along the same normal
    for symbol, least in (("W_k", 0.2), ("M_dK", 0.2)):
        (pinion, gear), (with_stock, gear_as_before) = rows[symbol], rows[f"{symbol}_with_stock"]
        assert with_stock - pinion >= least - 1e-9
        assert gear_as_before == gear
    assert rows["W_k_with_stock"][0] - rows["W_k"][0] == pytest.approx(0.2, abs=1e-9)


@pytest.mark.parametrize(
    ("sample", "key", "said"),
    [
        (
            "helical",
            "pinion.stock=5mm",
            "pinion.stock = 5 mm: the ramp under the flank with stock does not meet the fillet",
        ),
        ("helical", "pinion.stock=-1", "pinion.stock = -1: must be"),
        ("hob_protuberance", "pinion.stock=0.1", "pinion.stock = 0.1 mm: cannot be given together with hob.stock"),
    ],
)
@pytest.mark.sweep_cases(
    "helical-pinion.stock=5mm-pinion.stock = 5 mm: the ramp under the flank with stock does not meet the fillet"
)
def test_stock_without_room_is_refused_with_the_largest(sample: str, key: str, said: str, tmp_path: Path) -> None:
    file = tmp_path / "a.stl"
    message = refused("solid", SAMPLES / f"{sample}.toml", "--member", "pinion", "-o", file, "--set", key)
    assert message.startswith(said)
    if "at most" in message:
        bound = f"pinion.stock={message.rsplit('at most ', 1)[1]}"
        arguments = ("--member", "pinion", "-o", file, "--tol", "0.1", "--set", bound)
        assert run("solid", SAMPLES / f"{sample}.toml", *arguments)[0] == 0
