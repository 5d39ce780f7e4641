"""STEP files: the splines against the exact surfaces, and the files as other programs read them."""

from __future__ import annotations

import errno
import json
import os
import re
import resource
import subprocess
import sys
from collections import Counter
from collections.abc import Callable
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles import built, internal, ring
from oracles.examples import some
from oracles.places import SAMPLES

from gearmesh import GearPair, Member, NoSolutionError, Rigid, load
from gearmesh.app.cli import main
from gearmesh.cad import brep
from gearmesh.cad.brep import DEFAULT_TOLERANCE_MM, Piece, SplineTooth, exact_volume, spline_tooth
from gearmesh.cad.nodes import plan, samples
from gearmesh.cad.part21 import condense
from gearmesh.cad.solid_part import solid_part
from gearmesh.cad.step import write_step
from gearmesh.cad.volume import volume
from gearmesh.contact.flanks import analyse
from gearmesh.io.digits import points_on_grid
from gearmesh.io.palette import region_colours
from gearmesh.kernel.surface.nearest import nearest
from gearmesh.kinds import ConeLevel, Region
from gearmesh.mesh.solid import gear_solid
from gearmesh.teeth.blank.body import end_regions
from gearmesh.teeth.region import BODY_REGIONS
from gearmesh.teeth.section import breaks

KEYED = [
    "pinion.teeth=14",
    "pinion.bore=16",
    "pinion.keyway={width=5, depth=2.3}",
    "pinion.hub={diameter=36, length=12}",
]
SMALL = ["pinion.bore=12", "pinion.keyway={width=4, depth=2}", "pinion.hub={diameter=30, length=9}"]
CHAMFERED = ["pinion.teeth=12", "pinion.bore=0", "pinion.tip_chamfer=0.2"]
#: flanks with corners along and across, and lines where their curvature jumps
RELIEVED = [
    "pinion.teeth=12",
    "pinion.modifications.tip_relief={amount='30um', start_roll_length=19}",
    "pinion.modifications.root_relief={amount='15um', start_roll_length=6, shape='parabolic'}",
    "pinion.modifications.end_relief_toe={amount='20um', length=6}",
    "pinion.modifications_left.end_relief_heel={amount='12um', length=9, shape='parabolic'}",
    "pinion.modifications_left.profile_twist=0.02",
]
#: amounts with bumps, on knots that the solid does not know of
SURVEYED = Path(__file__).parent.parent / "corpus" / "topography.csv"
FEWER = ["gear.teeth=20"]
SMALL_RING = ["gear.teeth=40", "gear.bore=160"]
#: file -> sample, changes, member: plane, conical and cylindrical end faces, undercut, broken edges, hub, keyway, no bore, an
#: assembly
FILES = {
    "keyed": ("helical", KEYED, "pinion"),
    "undercut": ("beveloid_crossed", CHAMFERED, "pinion"),
    "pair": ("zerol", FEWER, "both"),
    "face": ("face_gear", SMALL_RING, "gear"),
    "relieved": ("helical", RELIEVED, "pinion"),
    "topography": ("helical", ["pinion.teeth=12", f"pinion.modifications.topography={SURVEYED}"], "pinion"),
}
#: what is written and read together, all but the first with the mark sweep
GROUPS = (("keyed",), ("undercut", "pair"), ("face", "relieved", "topography"))
EVERY_FILE = [*GROUPS[0], *some((*GROUPS[1], *GROUPS[2]), 0)]
#: sample -> changes, member: all with end faces on cones or cylinders, and one with planes
CHECKED = {
    "zerol": ([], "pinion"),
    "spiral_bevel_basic": ([], "pinion"),
    "face_gear_conjugate": (["gear.teeth=40", "gear.bore=100"], "gear"),
    "spiral_bevel_abdullah_curved": ([], "pinion"),
    "helical": (KEYED, "pinion"),
}
#: relative error of exact volumes: their quadrature is not split at the knots of a topography, where third derivatives jump
OFF = {"topography": 4e-6}
#: what CAD programs take for the same point, mm
SAME_POINT = 1e-7

OCP_READER = r"""
import json, sys
from OCP.BRepAdaptor import BRepAdaptor_Surface
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepGProp import BRepGProp
from OCP.collections import IndexedDataMap_TopoDS_Shape_List_TopoDS_Shape_TopTools_ShapeMapHasher as Ancestors
from OCP.collections import Sequence_TDF_Label
from OCP.GProp import GProp_GProps
from OCP.Interface import Interface_Static
from OCP.Quantity import Quantity_Color, Quantity_TypeOfColor
from OCP.STEPCAFControl import STEPCAFControl_Reader
from OCP.TCollection import TCollection_ExtendedString
from OCP.TDataStd import TDataStd_Name
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_ShapeEnum as Kind
from OCP.TopExp import TopExp, TopExp_Explorer
from OCP.TopoDS import TopoDS
from OCP.XCAFDoc import XCAFDoc_ColorType, XCAFDoc_DocumentTool
from OCP.gp import gp_Pnt

def listed(fill):
    labels = Sequence_TDF_Label()
    fill(labels)
    return [labels.Value(i + 1) for i in range(labels.Length())]

def name(label):
    found = TDataStd_Name()
    return found.Get().ToExtString() if label.FindAttribute(TDataStd_Name.GetID_s(), found) else ""

def count(shape, kind):
    explorer, n = TopExp_Explorer(shape, kind), 0
    while explorer.More():
        n += 1
        explorer.Next()
    return n

def surface(face):
    # kind, and points at a quarter and three quarters of its parameters
    drawn = BRepAdaptor_Surface(TopoDS.Face(face))
    u, v = (
        [low + share * (high - low) for share in (0.25, 0.75)]
        for low, high in (
            (drawn.FirstUParameter(), drawn.LastUParameter()), (drawn.FirstVParameter(), drawn.LastVParameter())
        )
    )
    points = [drawn.Value(a, b) for a in u for b in v]
    return drawn.GetType().name.split("_")[-1], [(p.X(), p.Y(), p.Z()) for p in points]

def part(label, probes):
    shape = shapes.GetShape_s(label)
    edges, mass = Ancestors(), GProp_GProps()
    TopExp.MapShapesAndAncestors_s(shape, Kind.TopAbs_EDGE, Kind.TopAbs_FACE, edges)
    BRepGProp.VolumeProperties_s(shape, mass)
    faces, named, turned = [], {}, []
    for own in listed(lambda labels: shapes.GetSubShapes_s(label, labels)):
        face, colour = shapes.GetShape_s(own), Quantity_Color()
        assert colours.GetColor(face, XCAFDoc_ColorType.XCAFDoc_ColorSurf, colour)
        faces.append((name(own), colour.Values(Quantity_TypeOfColor.Quantity_TOC_sRGB)))
        if name(own).startswith(("land", "root")):
            turned.append((name(own), *surface(face)))
        named.setdefault(name(own), []).append(face)
    def distance(point, names):
        vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*point)).Vertex()
        return min(BRepExtrema_DistShapeShape(vertex, face).Value() for each in names for face in named[each])
    return {
        "solids": count(shape, Kind.TopAbs_SOLID),
        "shells": count(shape, Kind.TopAbs_SHELL),
        "faces": count(shape, Kind.TopAbs_FACE),
        "edge_sides": sorted({edges.FindFromIndex(i + 1).Size() for i in range(edges.Extent())}),
        "valid": BRepCheck_Analyzer(shape).IsValid(),
        "volume": mass.Mass(),
        "named": faces,
        "turned": turned,
        "off": {key: max(distance(p, names) for p in points) for key, (names, points) in probes.items()},
    }

result = {}
for file, probes in json.load(sys.stdin).items():
    reader = STEPCAFControl_Reader()
    Interface_Static.SetIVal_s("read.stepcaf.subshapes.name", 1)
    reader.SetNameMode(True)
    reader.SetColorMode(True)
    reader.ReadFile(file)
    document = TDocStd_Document(TCollection_ExtendedString("test"))
    reader.Transfer(document)
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    colours = XCAFDoc_DocumentTool.ColorTool_s(document.Main())
    (top,) = listed(shapes.GetFreeShapes)
    components = listed(lambda labels: shapes.GetComponents_s(top, labels)) if shapes.IsAssembly_s(top) else []
    parts = [top]
    instances = {}
    for component in components:
        place = shapes.GetLocation_s(component).Transformation()
        instances[name(component)] = [[place.Value(i, j) for j in (1, 2, 3, 4)] for i in (1, 2, 3)]
    if components:
        parts = [label for label in listed(shapes.GetShapes) if shapes.IsSimpleShape_s(label) and not shapes.IsSubShape_s(label)]
    result[file] = {
        "instances": instances,
        "parts": {name(label): part(label, probes.get(name(label), {})) for label in parts},
    }
json.dump(result, open(sys.argv[1], "w"))
"""

Command = Callable[..., tuple[int, str]]

GMSH_READER = r"""
import json, sys
import gmsh
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
result = {}
for file in sys.argv[2:]:
    gmsh.clear()
    gmsh.model.occ.importShapes(file)
    gmsh.model.occ.synchronize()
    one_sided = []
    for edge in gmsh.model.getEntities(1):
        faces, _ = gmsh.model.getAdjacencies(*edge)
        one_sided += [int(face) for face in faces] if len(faces) == 1 else []
    result[file] = {
        "volumes": [gmsh.model.occ.getMass(*volume) for volume in gmsh.model.getEntities(3)],
        "faces": len(gmsh.model.getEntities(2)),
        "outside": len(gmsh.model.getBoundary(gmsh.model.getEntities(3), combined=True)),
        "one_sided": [gmsh.model.getType(2, face) for face in one_sided],
    }
json.dump(result, open(sys.argv[1], "w"))
"""


def pair_of(sample: str, changes: list[str]) -> GearPair:
    return built.pair_of(load(str(SAMPLES / f"{sample}.toml"), changes))


@cache
def gears_in(file: str) -> GearPair:
    return pair_of(*FILES[file][:2])


def members(file: str) -> dict[str, Member]:
    found, member = gears_in(file).members, FILES[file][2]
    return found if member == "both" else {member: found[member]}


@cache
def volumes(file: str) -> dict[str, float]:
    """Exact volumes, by Gauss quadrature of exact sections."""
    return {name: exact_volume(member) for name, member in members(file).items()}


def probes(member: Member) -> dict[str, Any]:
    """Names of faces, and exact points (n, 3) of tooth 1, which no node of a spline is likely to be."""
    rng = np.random.default_rng(7)
    s, t = (np.sort(rng.uniform(0.01, 0.99, n)) for n in (7, 6))
    sections = member.tooth.sections(t)
    regions = [region for region in member.tooth.regions if region.startswith(("flank", "fillet"))]
    return {
        region: ([f"{region}_1"], member.tooth.grid(region, s, sections).points.reshape(-1, 3).tolist())
        for region in regions
    }


def read_back(file: Path) -> Any:
    """The solid in a STEP file."""
    from OCP.STEPControl import STEPControl_Reader

    reader = STEPControl_Reader()
    reader.ReadFile(str(file))
    reader.TransferRoots()
    (solid,) = inside(reader.OneShape(), "SOLID")
    return solid


def inside(shape: Any, kind: str) -> list[Any]:
    from OCP.TopAbs import TopAbs_ShapeEnum
    from OCP.TopExp import TopExp_Explorer

    explorer, found = TopExp_Explorer(shape, getattr(TopAbs_ShapeEnum, f"TopAbs_{kind}")), []
    while explorer.More():
        found.append(explorer.Current())
        explorer.Next()
    return found


def curves_apart(solid: Any, places: int = 23) -> tuple[np.ndarray, np.ndarray]:
    """Largest distance (mm) of every edge on a cylinder or cone from its curve there, and the edge's tolerance."""
    from OCP.BRep import BRep_Tool
    from OCP.BRepAdaptor import BRepAdaptor_Curve, BRepAdaptor_Surface
    from OCP.TopoDS import TopoDS

    apart, allowed = [], []
    for face in map(TopoDS.Face, inside(solid, "FACE")):
        surface = BRepAdaptor_Surface(face, False)
        if surface.GetType().name not in ("GeomAbs_Cylinder", "GeomAbs_Cone"):
            continue
        for edge in map(TopoDS.Edge, inside(face, "EDGE")):
            low, high = BRep_Tool.Range_s(edge)
            curve, flat = BRepAdaptor_Curve(edge), BRep_Tool.CurveOnSurface_s(edge, face, low, high)
            there = [(at, flat.Value(at)) for at in np.linspace(low, high, places).tolist()]
            apart.append(max(curve.Value(at).Distance(surface.Value(uv.X(), uv.Y())) for at, uv in there))
            allowed.append(BRep_Tool.Tolerance_s(edge))
    return np.array(apart), np.array(allowed)


def whole_volume(solid: Any) -> float:
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(solid, properties)
    return float(properties.Mass())


def faults(solid: Any, *, self_intersection: bool) -> list[str]:
    """Return the faults by OpenCASCADE's analysis of arguments, with the questions that FreeCAD's geometry check asks."""
    from OCP.BOPAlgo import BOPAlgo_ArgumentAnalyzer

    analysis = BOPAlgo_ArgumentAnalyzer()
    analysis.SetShape1(solid)
    for mode in ("ArgumentType", "SmallEdge", "RebuildFace", "Tangent", "MergeVertex", "MergeEdge", "CurveOnSurface"):
        setattr(analysis, f"{mode}Mode", True)
    analysis.ContinuityMode = True
    analysis.SelfInterMode = self_intersection
    analysis.Perform()
    return [found.GetCheckStatus().name for found in analysis.GetCheckResult()]


def run_reader(program: str, folder: Path, arguments: list[str], text: str = "") -> dict[str, Any]:
    out = folder / "read.json"
    run = subprocess.run(
        [sys.executable, "-c", program, str(out), *arguments], input=text, capture_output=True, text=True, check=False
    )
    assert run.returncode == 0, run.stderr
    return {Path(file).stem: found for file, found in json.loads(out.read_text()).items()}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("step")


@cache
def written(folder: Path, group: tuple[str, ...]) -> list[str]:
    """A group of FILES in a folder, written by the command line."""
    for file in group:
        write(folder, file)
    return [str(folder / f"{file}.step") for file in group]


def write(folder: Path, file: str) -> None:
    """One of FILES by the command line."""
    sample, changes, member = FILES[file]
    settings = [word for change in changes for word in ("--set", change)]
    arguments = ["solid", str(SAMPLES / f"{sample}.toml"), "--member", member, *settings]
    assert main([*arguments, "-o", str(folder / f"{file}.step")]) == 0


@cache
def group_by_occ(folder: Path, group: tuple[str, ...]) -> dict[str, Any]:
    """Return the contents of the files of a group as a fresh process with OpenCASCADE reads them."""
    files = written(folder, group)
    asked = {
        path: {name: probes(member) for name, member in members(file).items()}
        for path, file in zip(files, group, strict=True)
    }
    if "pair" in group:
        gears = gears_in("pair")
        path = analyse(gears, np.zeros(1))
        for name, flank, point in zip(gears.members, gears.flanks, (path.point1[0], path.point2[0]), strict=True):
            names = [f"flank_{flank}_{k + 1}" for k in range(gears.members[name].tooth.teeth)]
            asked[str(folder / "pair.step")][name]["contact"] = (names, [point.tolist()])
    return run_reader(OCP_READER, folder, [], json.dumps(asked))


@cache
def group_by_gmsh(folder: Path, group: tuple[str, ...]) -> dict[str, Any]:
    return run_reader(GMSH_READER, folder, written(folder, group))


def read_by_occ(folder: Path, file: str) -> Any:
    """Return the contents of one of FILES as OpenCASCADE reads it."""
    return group_by_occ(folder, group_of(file))[file]


def read_by_gmsh(folder: Path, file: str) -> Any:
    return group_by_gmsh(folder, group_of(file))[file]


def group_of(file: str) -> tuple[str, ...]:
    (group,) = (group for group in GROUPS if file in group)
    return group


def face_names(member: Member) -> Counter[str]:
    """Names that the faces of a member should have, and how often."""
    tooth, body = member.tooth, member.tooth.blank.body.profile
    names: Counter[str] = Counter()
    for region in tooth.regions:
        segments = 1 if region in ("land", "root") else len(tooth.breaks) + 1
        if region.startswith(("flank", "fillet")):
            segments *= len(breaks(tooth.chain[region])) + 1
        names.update({f"{region}_{k + 1}": segments for k in range(tooth.teeth)})
    names.update(["face_toe", "face_heel"])
    if len(body) == 4:
        names.update(end_regions(tooth.blank.axial))
    if member.tooth.blank.body.bore_radius:
        names["bore"] = 1
    if member.keyway:
        names.update(["keyway_1", "keyway_2", "keyway_3"])
    if member.hub:
        names["hub"] = 2
    return names


@pytest.mark.parametrize("file", EVERY_FILE)
def test_a_fresh_process_reads_one_valid_solid(file: str, folder: Path) -> None:
    """One closed shell, every edge between two faces, and the exact volume (Gauss quadrature of exact sections)."""
    expected = members(file)
    assert read_by_occ(folder, file)["parts"].keys() == expected.keys()
    for name, found in read_by_occ(folder, file)["parts"].items():
        assert (found["solids"], found["shells"], found["valid"]) == (1, 1, True)
        assert found["edge_sides"] == [2]
        assert found["faces"] == face_names(expected[name]).total()
        assert found["volume"] == pytest.approx(volumes(file)[name], rel=OFF.get(file, 1e-6))


@pytest.mark.parametrize("file", EVERY_FILE)
def test_faces_keep_names_and_colours(file: str, folder: Path) -> None:
    for name, member in members(file).items():
        named = read_by_occ(folder, file)["parts"][name]["named"]
        assert Counter(each for each, _ in named) == face_names(member)
        regions = (*member.tooth.regions, *BODY_REGIONS)
        palette = dict(zip(regions, region_colours(len(regions)), strict=True))
        for each, colour in named:
            stem, _, number = each.rpartition("_")
            np.testing.assert_allclose(colour, palette[stem if number.isdigit() else each], atol=1e-6)


@pytest.mark.parametrize("file", EVERY_FILE)
def test_lands_and_roots_are_planes_cylinders_and_cones(file: str, folder: Path) -> None:
    """One face for every tooth, undercut or not, on the very level that the blank has: tip diameters can be picked."""
    for name, member in members(file).items():
        blank, faces = member.tooth.blank, read_by_occ(folder, file)["parts"][name]["turned"]
        assert Counter(each for each, _, _ in faces) == {
            f"{link}_{k + 1}": 1 for link in ("land", "root") for k in range(member.tooth.teeth)
        }
        for each, kind, points in faces:
            level = blank.tip if each.startswith("land") else blank.root
            assert isinstance(level, ConeLevel)
            across, up = level.normal
            assert kind == ("Plane" if across == 0.0 else "Cylinder" if up == 0.0 else "Cone")
            np.testing.assert_allclose(level.value(np.array(points)), 0.0, atol=1e-9)


def test_a_face_gear_takes_few_points() -> None:
    """Its fillets are almost singular at the inner end: evenly graded nodes were 78 x 37 on each, and the file 122 MB."""
    teeth = spline_tooth(pair_of("face_gear", []).gear.tooth)
    assert max(teeth.deviation.values()) <= DEFAULT_TOLERANCE_MM
    assert sum(patch.control[..., 0].size for link in teeth.patches.values() for patch in link) <= 500


@pytest.mark.sweep
@pytest.mark.parametrize("sample", some(CHECKED, 3))
def test_no_curve_leaves_its_surface(sample: str, tmp_path: Path) -> None:
    """FreeCAD's geometry check after a round trip: edges agree with their curves on both faces."""
    changes, name = CHECKED[sample]
    member = pair_of(sample, changes).members[name]
    write_step(solid_part(member, spline_tooth(member.tooth)), tmp_path / "part.step", sample)
    solid = read_back(tmp_path / "part.step")
    apart, allowed = curves_apart(solid)
    assert apart.max() <= SAME_POINT
    assert (apart <= allowed).all()
    assert faults(solid, self_intersection=sample == "helical") == []


@pytest.mark.parametrize("file", EVERY_FILE)
def test_exact_points_lie_on_the_faces_read(file: str, folder: Path) -> None:
    """Flanks and fillets of tooth 1 within the default tolerance at points between the nodes, by OpenCASCADE's projection."""
    for found in read_by_occ(folder, file)["parts"].values():
        assert len(found["off"]) >= 4
        assert max(found["off"].values()) <= DEFAULT_TOLERANCE_MM


@pytest.mark.sweep
@pytest.mark.parametrize("file", EVERY_FILE)
def test_gmsh_reads_one_closed_volume(file: str, folder: Path) -> None:
    """A second program: all faces are on the outside, and only seams of cylinders and cones have one face."""
    found, expected = read_by_gmsh(folder, file), members(file)
    assert found["volumes"] == pytest.approx(list(volumes(file).values()), rel=OFF.get(file, 1e-6))
    assert found["faces"] == found["outside"] == sum(face_names(member).total() for member in expected.values())
    assert set(found["one_sided"]) <= {"Cylinder", "Cone"}


@pytest.mark.sweep
def test_the_pair_stands_in_mesh(folder: Path) -> None:
    """Instances stand where contact analysis at phi1 = 0 has them, and its contact point is on a flank of both solids."""
    gears = gears_in("pair")
    path = analyse(gears, np.zeros(1))
    places = {"pinion": gears.pinion.mount.at(path.rotation[0]), "gear": gears.gear.mount.at(path.phi2[0])}
    found = read_by_occ(folder, "pair")
    assert found["instances"].keys() == places.keys()
    points = {"pinion": path.point1[0], "gear": path.point2[0]}
    for name, place in places.items():
        rows = np.array(found["instances"][name])
        read = Rigid(rows[:, :3], rows[:, 3])
        np.testing.assert_allclose(read.point(points[name]), path.point[0], atol=1e-9)
        np.testing.assert_allclose(read.point(np.eye(3)), place.point(np.eye(3)), atol=1e-9)
        assert found["parts"][name]["off"]["contact"] <= DEFAULT_TOLERANCE_MM


def test_header_names_schema_and_unit(folder: Path) -> None:
    text = Path(written(folder, GROUPS[0])[0]).read_text()
    header, data = text.split("ENDSEC;", 1)
    assert "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF" in header
    assert "gearmesh" in header
    assert "um of the exact" in header
    assert "SI_UNIT(.MILLI.,.METRE.)" in data


@pytest.mark.sweep_cases("spiral_bevel_geometry1-0.01", "spiral_bevel_basic-1e-05", "spiral_bevel_basic-0.01")
@pytest.mark.parametrize("tolerance", [1e-2, 1e-5])
@pytest.mark.parametrize("sample", ["spiral_bevel_basic", "spiral_bevel_geometry1"])
def test_cones_fit_their_edges_at_any_tolerance(sample: str, tolerance: float) -> None:
    """`solid_part` raises for an invalid solid, as one whose end curves are farther from the cones than they say."""
    member = pair_of(sample, []).pinion
    part = solid_part(member, spline_tooth(member.tooth, tolerance))
    assert volume(part) == pytest.approx(exact_volume(member), rel=3e-6)


# ---------------------------------------------------------------- the splines


def spline(sample: str, tolerance: float = DEFAULT_TOLERANCE_MM) -> SplineTooth:
    """Spline tooth of the sample's pinion. The beveloid pinion has 18 teeth and two breaks, one of them next to an end face."""
    changes = ["pinion.teeth=18"] if sample == "beveloid_crossed" else []
    return spline_tooth(pair_of(sample, changes).pinion.tooth, tolerance)


@pytest.mark.sweep_cases(
    "beveloid_crossed-1e-05",
    "zerol-0.001",
    "beveloid_crossed-0.001",
    "zerol-1e-05",
    "circular_arc-0.001",
    "circular_arc-1e-05",
    "helical-0.001",
)
@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
@pytest.mark.parametrize("sample", ["helical", "beveloid_crossed", "circular_arc", "zerol"])
def test_splines_keep_their_stated_deviation(sample: str, tolerance: float) -> None:
    """Random points of flanks and fillets, by the closest points of the exact surfaces."""
    teeth, rng = spline(sample, tolerance), np.random.default_rng(3)
    assert max(teeth.deviation.values()) <= tolerance
    assert {piece.region for piece in teeth.patches} == set(teeth.tooth.regions) - {"land", "root"}
    for piece, link in teeth.patches.items():
        region = piece.region
        for patch in link:
            s, t = np.sort(rng.uniform(0, 1, 40)), np.sort(rng.uniform(0, 1, 31))
            drawn, (own_s, own_t) = patch.at(s, t), patch.of_tooth(s, t)
            grid = teeth.tooth.grid(region, own_s, teeth.tooth.sections(own_t))
            surface = teeth.tooth.chain[region].surface
            assert surface is not None
            assert grid.p is not None
            assert grid.v is not None
            off = np.linalg.norm(nearest(surface, drawn, grid.p, grid.v).jet.r - drawn, axis=-1)
            assert off.max() <= 1.1 * teeth.deviation[piece] + 1e-11


@pytest.mark.parametrize("sample", ["helical", "beveloid_crossed", "circular_arc", "zerol"])
@pytest.mark.sweep_cases("beveloid_crossed", "zerol")
def test_borders_lie_on_the_lands_and_roots_beside_them(sample: str) -> None:
    """At any tolerance within what CAD programs take for the same point: the faces share these curves."""
    teeth, places = spline(sample, 1e-2), np.linspace(0.0, 1.0, 301)
    blank = teeth.tooth.blank
    first, last = {"fillet_right": 0.0, "flank_left": 0.0}, {"flank_right": 1.0, "fillet_left": 1.0}
    for link, s in (first | last).items():
        level = blank.root if link.startswith("fillet") else blank.tip
        for patch in teeth.patches[Piece(Region(link))]:
            assert np.abs(level.value(patch.at(np.array([s]), places))).max() <= SAME_POINT


@pytest.mark.quick
def test_nodes_grow_with_the_sixth_root_of_the_tolerance() -> None:
    """A thousandth of the deviation for 1000^(1/6) = 3.2 times as many intervals."""
    coarse, fine = spline("helical", 1e-3), spline("helical", 1e-6)
    intervals = [sum(link[0].s.y.size - 1 for link in teeth.patches.values()) for teeth in (coarse, fine)]
    assert intervals[1] < 3.2 * intervals[0]
    assert max(fine.deviation.values()) <= 1e-6


@pytest.mark.sweep
def test_last_digits_that_rounding_removes_from_one_tooth_are_in_none(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every tooth is the first one, rounded and then turned, so that few numbers can fall to either side of a border."""
    gears, own_net, rng = built.built_sample("spur"), brep.control_net, np.random.default_rng(7)

    def noisy_net(*arguments: Any) -> np.ndarray:
        net = own_net(*arguments)
        moved = net + rng.uniform(-1e-9, 1e-9, net.shape)
        return np.where(points_on_grid(moved) == points_on_grid(net), moved, net)

    files = []
    for folder in ("exact", "noisy"):
        if folder == "noisy":
            monkeypatch.setattr(brep, "control_net", noisy_net)
        files.append(tmp_path / folder / "pinion.step")
        files[-1].parent.mkdir()
        gears.cad("pinion", "10um").save(files[-1])
    assert files[0].read_bytes() == files[1].read_bytes()


@pytest.mark.parametrize("sample", ["beveloid_crossed", "zerol"])
@pytest.mark.sweep_cases("beveloid_crossed")
def test_neighbours_share_their_borders(sample: str) -> None:
    """Control polygons and knots of common borders agree: of flank and fillet, and at breaks."""
    teeth = spline(sample)
    segments = len(teeth.bounds) - 1
    assert segments == (3 if sample == "beveloid_crossed" else 1)
    for link, after in (("fillet_right", "flank_right"), ("flank_left", "fillet_left")):
        for here, there in zip(teeth.patches[Piece(Region(link))], teeth.patches[Piece(Region(after))], strict=True):
            np.testing.assert_allclose(here.control[-1], there.control[0], rtol=0, atol=1e-10)
            np.testing.assert_array_equal(here.t_knots, there.t_knots)
    for patches in teeth.patches.values():
        for here, there in pairwise(patches):
            np.testing.assert_allclose(here.control[:, -1], there.control[:, 0], rtol=0, atol=1e-10)
            np.testing.assert_array_equal(here.s_knots, there.s_knots)


@pytest.mark.parametrize(("sample", "changes"), [("helical", KEYED), ("zerol", SMALL)])
@pytest.mark.sweep_cases("zerol-changes1")
def test_exact_volume_counts_hub_and_keyway(sample: str, changes: list[str]) -> None:
    """Against the mesh, whose volume may be off by its tolerance all over its area."""
    member = pair_of(sample, changes).members["pinion"]
    mesh = gear_solid(member, tolerance := 0.004)
    a, b, c = np.moveaxis(mesh.corners(), 1, 0)
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=-1).sum()
    assert abs(mesh.volume() - exact_volume(member)) < tolerance * area


@pytest.mark.sweep
@pytest.mark.parametrize("heel", [1.0, -1.0])
def test_a_ring_with_teeth_inside(heel: float, tmp_path: Path) -> None:
    """The body lies outside the teeth; its volume by triangles. Faces that look inwards would count negative."""
    member = ring.ring(heel)
    solid = check_ring(member, ring.ring_volume(), tmp_path)
    assert whole_volume(solid) == pytest.approx(ring.ring_volume(), rel=1e-8)


@pytest.mark.sweep
def test_a_shaped_ring(tmp_path: Path) -> None:
    """Involute teeth that a shaper generates inside, against the exact volume."""
    member = internal.ring(30)
    check_ring(member, exact_volume(member), tmp_path)


def check_ring(member: Member, expected: float, folder: Path) -> Any:
    """The solid read back, free of faults and with the expected volume."""
    part = solid_part(member, spline_tooth(member.tooth))
    write_step(part, folder / "ring.step", "ring")
    solid = read_back(folder / "ring.step")
    assert [face.name for face in part.faces if face.region == "rim"] == ["rim"]
    assert volume(part) == pytest.approx(expected, rel=3e-8)
    assert faults(solid, self_intersection=True) == []
    return solid


def test_nodes_follow_a_curve_that_is_almost_singular() -> None:
    """sqrt(x + 0.02), as where undercut is near: in a bent parameter two thirds of the nodes do, wherever the end is."""
    x = samples()
    size, bend = [], []
    for place in (x, 1.0 - x):
        curve = np.stack((100.0 * place, 3.0 * np.sqrt(place + 0.02), 0.0 * place), axis=-1)[:, None]
        nodes = plan(curve, lambda drawn, exact: np.linalg.norm(drawn - exact, axis=-1).max(axis=1) / 1e-4)
        size.append(nodes.y.size)
        bend.append(nodes.bend)
    assert max(size) <= 11
    assert bend[0] < 0.0 < bend[1]


# ---------------------------------------------------------------- the file's text

TEXT = """ISO-10303-21;
HEADER;
ENDSEC;
DATA;
#7 = SOLID('a;''#3'' and
 more',(#3,#4,#5,
    #6));
#3 = CARTESIAN_POINT('',(0.,1.));
#4 = CARTESIAN_POINT('',(0.,2.));
#5 = CARTESIAN_POINT('',(0.,
    1.));
#6 = VERTEX_POINT('',#5);
#8 = VERTEX_POINT('',#3);
ENDSEC;
END-ISO-10303-21;
"""


def test_equal_geometry_is_said_once() -> None:
    """Points merge, topology and strings stay; text that is no STEP by OpenCASCADE stays altogether."""
    data = condense(TEXT).partition("DATA;\n")[2].partition("ENDSEC;")[0]
    assert data.splitlines() == [
        "#1=SOLID('a;''#3'' and more',(#2,#3,#2,#4));",
        "#2=CARTESIAN_POINT('',(0.,1.));",
        "#3=CARTESIAN_POINT('',(0.,2.));",
        "#4=VERTEX_POINT('',#2);",
        "#5=VERTEX_POINT('',#2);",
    ]
    assert condense(TEXT.replace("#4 =", "#4=")) == TEXT.replace("#4 =", "#4=")


def test_colours_of_parts_have_an_order_of_their_own() -> None:
    """OpenCASCADE writes those of an assembly's parts in either order."""
    faces = "".join(f"#{n} = ADVANCED_FACE('{n}',(),#9,.T.);\n" for n in (1, 2))

    def text(first: int, second: int) -> str:
        groups = (
            f"#{n} = MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',(#{n + 1}),#3);\n"
            f"#{n + 1} = STYLED_ITEM('color',(#{n + 2}),#{face});\n#{n + 2} = COLOUR_RGB('',0.,0.,{face}.);\n"
            for n, face in ((10, first), (20, second))
        )
        return f"DATA;\n{faces}#3 = CONTEXT('');\n#9 = PLANE('');\n{''.join(groups)}ENDSEC;\n"

    assert condense(text(1, 2)) == condense(text(2, 1))
    assert condense(text(1, 2)).count("STYLED_ITEM") == 2


@pytest.mark.sweep
def test_the_same_command_writes_the_same_bytes(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The date is that of SOURCE_DATE_EPOCH, and none else. Other processes have their test with those of all formats."""
    written(folder, GROUPS[0])
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "86400")
    write(tmp_path, "undercut")
    again, first = ((place / "undercut.step").read_text() for place in (tmp_path, folder))
    assert "'1970-01-02T00:00:00'" in again
    assert again.replace("1970-01-02T", "1970-01-01T") == first


def test_a_full_disk_says_so(command: Command, tmp_path: Path) -> None:
    """The system's reason, and no file."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    try:
        resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, before[1]))
        status, err = command("--member", "pinion", "--set", "pinion.teeth=12", "-o", "gear.step")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert status == 2
    assert err.splitlines()[-1] == f"gearmesh: error: cannot write gear.step: {os.strerror(errno.EFBIG)}"
    assert not list(tmp_path.iterdir())


# ---------------------------------------------------------------- refusals


@pytest.fixture
def command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Command:
    """Run `gearmesh solid` on the helical sample in an empty folder: exit status, standard error."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments: str) -> tuple[int, str]:
        status = main(["solid", str(SAMPLES / "helical.toml"), *arguments])
        return status, capsys.readouterr().err

    return run


@pytest.mark.quick
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            "--member both -o a.stl",
            "--member = both: .stl holds one part; for both use .glb, .obj, .3mf, .vtm, .step, .stp",
        ),
        ("--member gear -o a.svg --teeth 3", "--teeth = 3: must be left out for .svg"),
        ("--member gear -o a.step --tol 0", "--tol = 0: must be a length"),
        ("--member gear -o none/a.stp", "the folder none does not exist"),
        (
            "--member pinion -o a.step --set pinion.bore=40 --set pinion.keyway={width=38,depth=1} "
            "--set pinion.hub={diameter=43,length=5}",
            "pinion.hub.diameter = 43 mm: allowed is between 56.6393 (keyway) and 111.733 mm (root)",
        ),
    ],
)
def test_refusals(command: Command, tmp_path: Path, arguments: str, words: str) -> None:
    status, err = command(*arguments.split(" "))
    assert (status, err.count("\n")) == (2, 1)
    assert words in err
    assert not list(tmp_path.iterdir())


@pytest.mark.sweep
def test_without_the_extra_one_line_names_it(tmp_path: Path) -> None:
    """OpenCASCADE's absence is found before the work; the existing file stays."""
    old = tmp_path / "gear.step"
    old.write_text("kept")
    program = "import sys; sys.modules['OCP'] = None; from gearmesh.app.cli import main; sys.exit(main(sys.argv[1:]))"
    arguments = ["solid", str(SAMPLES / "helical.toml"), "--member", "both", "-o", str(old)]
    run = subprocess.run([sys.executable, "-c", program, *arguments], capture_output=True, text=True, check=False)
    assert (run.returncode, run.stdout) == (2, "")
    assert run.stderr == 'gearmesh: error: STEP needs OpenCASCADE: pip install "gearmesh[step]"\n'
    assert [file.read_text() for file in tmp_path.iterdir()] == ["kept"]


def test_no_pair_without_contact(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "pair.step"
    arguments = ["solid", str(SAMPLES / "spur.toml"), "--member", "both", "--set", "assembly.dx=10"]
    assert main([*arguments, "-o", str(file)]) == 3
    assert "no contact at phi1 = 0" in capsys.readouterr().err
    assert not file.exists()


def test_refused_tolerance_is_compared_with_its_own_share(monkeypatch: pytest.MonkeyPatch) -> None:
    """A refusal said that 0.0633 um is more than a tolerance of 0.1 um, and not which tolerance would do."""
    monkeypatch.setattr("gearmesh.cad.brep.MAX_NODES", 8)
    pinion = built.built_sample("beveloid_intersected").members["pinion"]
    told = r"deviate by ([\d.]+) um, more than the 0\.00045 um allowed for a tolerance of 0\.001 um; .* from about ([\d.]+) um on"
    with pytest.raises(NoSolutionError, match=told) as refused:
        spline_tooth(pinion.tooth, 1e-6)
    deviation, enough = map(float, re.search(told, str(refused.value)).groups())  # type: ignore[union-attr]
    assert deviation > 0.00045
    assert deviation / 0.45 < enough < 1.2 * deviation / 0.45
