"""Run time against error, in one run: contact, meshes, imports. Prints tables, writes bench.json and mesh_cost.png.

python scripts/bench.py [-o out/bench] [--quick] [--write] [--only TABLE ...]
python scripts/bench.py --against 0.17.0 [--rounds 5] [--write] [--only COMMAND ...]

With --write the tables in scripts/measured and the figures of README.md become those of this run, with --only some of the tables.
With --against another version and this one run the same commands in turns ([against.py](against.py)).
"""

from __future__ import annotations

import argparse
import json
import math
import os
import platform
import resource
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import against
import numpy as np
import tables
from scipy.optimize import root

import gearmesh as gm
from gearmesh import io
from gearmesh.answers.bodies.solid import mesh_within
from gearmesh.contact.conditions.meshing import Conditions
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import Pair, contact_path
from gearmesh.kernel.numeric.algebra import cross, dot, unit
from gearmesh.kernel.surface.curvature import gaussian_curvature, shape_operator, tangent_basis
from gearmesh.mesh.body import ring_count
from gearmesh.mesh.deviation.bound import tooth_bound
from gearmesh.mesh.solid import gear_solid
from gearmesh.mesh.tessellate import tessellate
from gearmesh.systems.system import worm
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import FILLET_REGIONS, FLANK_REGIONS, Region
from gearmesh.teeth.tooth import Tooth
from gearmesh.view.diagrams.plots import CostRun, plot_cost

ROOT = Path(__file__).parent.parent
SAMPLES = ROOT / "samples"
#: z = 24, m_n = 5, alpha 20, beta 15, b = 50 mm, standard rack, no bore
HELICAL = ("helical", ["pinion.bore=0"])
#: members whose STEP files are timed; None: all of them in mesh
STEP_PARTS: tuple[tuple[str, str | None], ...] = (
    ("helical", "pinion"),
    ("beveloid_crossed", "pinion"),
    ("circular_arc", "pinion"),
    ("spiral_bevel_basic", "pinion"),
    ("zerol", "pinion"),
    ("novikov", "pinion"),
    ("face_gear", "gear"),
    ("planetary", None),
)
TOLERANCES_UM = (100.0, 10.0, 1.0, 0.1)
#: a member of every kind
KINDS = (
    ("helical", "pinion"),
    ("internal", "gear"),
    ("beveloid_crossed", "pinion"),
    ("beveloid_crossed", "gear"),
    ("spiral_bevel_basic", "pinion"),
    ("spiral_bevel_basic", "gear"),
    ("hypoid", "pinion"),
    ("zerol", "gear"),
    ("face_gear", "gear"),
    ("novikov", "pinion"),
    ("novikov", "gear"),
    ("novikov", "worm"),
    ("circular_arc", "pinion"),
    ("modified_involute", "pinion"),
    ("worm_drive", "worm"),
    ("worm_drive", "wheel"),
)
#: one member of each kind that teeth are made in another way
EVERY_WAY = (
    ("helical", "pinion"),
    ("internal", "gear"),
    ("beveloid_crossed", "pinion"),
    ("circular_arc", "pinion"),
    ("novikov", "pinion"),
    ("novikov", "worm"),
    ("modified_involute", "pinion"),
    ("face_gear", "gear"),
    ("spiral_bevel_basic", "pinion"),
    ("hypoid", "pinion"),
    ("spiral_bevel_geometry1", "pinion"),
    ("worm_drive", "worm"),
    ("worm_drive", "wheel"),
    ("worm_drive_zk_oversize", "worm"),
)
#: CPU seconds and bytes that a row of `tolerances` may take at most
MOST_SECONDS, MOST_BYTES = 60, 2 * 1024**3


def best_of(repeats: int, work: Callable[[], Any]) -> tuple[float, Any]:
    """Shortest of several run times, s, and the last result."""
    shortest, result = np.inf, None
    for _ in range(repeats):
        started = time.perf_counter()
        result = work()
        shortest = min(shortest, time.perf_counter() - started)
    return shortest, result


def contact(repeats: int) -> list[dict[str, Any]]:
    """(a), (b): all positions in one batch, against scipy.optimize.root position by position on the same equations.

    Both are the best of the same number of runs. Residuals are the largest of all five equations, mm.
    """
    pair = solver_pair(gm.build(gm.load(SAMPLES / "beveloid_crossed.toml")).pairs[0])
    phi1 = np.radians(np.linspace(-6.0, 6.0, 201))
    many_phi1 = np.radians(np.linspace(-6.0, 6.0, 10_000))
    rows = []
    for name, angles in (("one batch", phi1), ("one batch", many_phi1)):
        seconds, path = best_of(repeats, partial(contact_path, pair, angles))
        solution = np.column_stack((path.params1, path.params2, path.phi2))
        solved = int((path.kind == "point").sum())
        rows.append(_contact_row(name, pair, angles, solution, solved, seconds))
        if angles is phi1:
            start = solution[0]
    single = [Conditions(pair.flanks, np.array([angle]), pair.length) for angle in phi1]
    for name, exact in (("root, differences", False), ("root, exact Jacobian", True)):
        seconds, (solution, solved) = best_of(repeats, partial(_one_by_one, single, start, exact))
        rows.append(_contact_row(name, pair, phi1, solution, solved, seconds))
    for row in rows[2:]:
        row["batch_is_faster"] = row["seconds"] / rows[0]["seconds"]
    return rows


def _contact_row(
    name: str, pair: Pair, phi1: np.ndarray, solution: np.ndarray, solved: int, seconds: float
) -> dict[str, Any]:
    residuals = Conditions(pair.flanks, phi1, pair.length)(solution, np.arange(phi1.size))[0]
    return {
        "what": name,
        "positions": phi1.size,
        "solved": solved,
        "seconds": seconds,
        "residual_mm": float(np.abs(residuals).max()),
    }


def _one_by_one(single: list[Conditions], start: np.ndarray, exact: bool) -> tuple[np.ndarray, int]:
    """Solve each position by scipy's hybrid method, from the solution of its neighbour: unknowns (P, 5), and the number of
    solved positions.

    Only values that scipy uses are computed: without Jacobian the residuals alone, with it both from one evaluation. The
    tolerances are the loosest powers of ten that bring the residual below 1e-11 mm (tenfold looser differences end at 4e-11;
    the exact Jacobian ends at 2e-12 from 1e-8 on).
    """
    index, x, found, solved = np.array([0]), start, [], 0

    def residuals(y: np.ndarray, conditions: Conditions) -> np.ndarray:
        one, two = conditions.touch(y[None], index).fixed
        first = unit(one.r_u)
        normals, tangents = one.n + two.n, (first, cross(one.n, first))
        return np.concatenate(((one.r - two.r)[0], *(conditions.length * dot(normals, t) for t in tangents)))

    def with_jacobian(y: np.ndarray, conditions: Conditions) -> tuple[np.ndarray, np.ndarray]:
        f, jacobian = conditions(y[None], index)
        return f[0], jacobian[0]

    for conditions in single:
        if exact:
            answer = root(with_jacobian, x, args=(conditions,), jac=True, tol=1e-10)
        else:
            answer = root(residuals, x, args=(conditions,), tol=1e-11)
        x = answer.x
        solved += bool(answer.success)
        found.append(x)
    return np.array(found), solved


#: samples whose whole analysis is timed
ANALYSES = (
    "beveloid_crossed",
    "circular_arc",
    "spiral_bevel_basic",
    "face_gear",
    "helical",
    "face_gear_conjugate",
    "novikov",
    "modified_involute",
    "worm_drive",
    "worm_drive_zk_oversize",
)


def analyses(repeats: int) -> list[dict[str, Any]]:
    """Everything that `tca` reports, 201 positions over two pitches: edges, cycle, both flanks, backlash, clearance.

    `times_path` compares it with the same positions of the same pair without edges and all the rest.
    """
    rows = []
    for sample in ANALYSES:
        design = gm.load(SAMPLES / f"{sample}.toml")
        pitch = np.degrees(gm.build(design).pairs[0].pitch)
        phi1, best, alone = np.linspace(-pitch, pitch, 201), np.inf, np.inf
        for _ in range(repeats):
            # a pair keeps what it has prepared: each run begins with a new one
            gears = gm.build(design)
            alone = min(alone, best_of(1, partial(_path, gears, np.radians(phi1)))[0])
            best = min(best, best_of(1, partial(gm.build(design).contact, phi1))[0])
        rows.append({"sample": sample, "positions": 201, "seconds": best, "times_path": best / alone})
    return rows


def _path(gears: gm.Gears, phi1: np.ndarray) -> Any:
    return contact_path(solver_pair(gears.pairs[0]), phi1, edges=False)


#: contact of a design in many assemblies, with axes that are off by some mm
ASSEMBLIES = """
        pair = solver_pair(gm.build(gm.load({})).pairs[0])
        rng = np.random.default_rng(0)
        bases = []
        for flank in (pair.pinion, pair.gear):
            shifts = rng.normal(scale={}, size=(1000, 3))
            base = flank.mount.base
            bases.append(Rigid(np.broadcast_to(base.rotation, (1000, 3, 3)), base.translation + shifts))
        phi1 = np.linspace(-0.5, 0.5, 21) * pair.pitch
        def work(): many_assemblies(pair, tuple(bases), phi1)
    """
#: programs by name, each timed in its own process, because peak memory is measured too
MANY = {
    "beveloid_crossed, 100,000 positions": """
        pair = solver_pair(gm.build(gm.load("samples/beveloid_crossed.toml")).pairs[0])
        phi1 = np.linspace(-0.1, 0.1, 100_000)
        def work(): contact_path(pair, phi1)
    """,
    "spiral_bevel_basic, 1,000 assemblies of 21 positions": ASSEMBLIES.format(
        '"samples/spiral_bevel_basic.toml"', 0.01
    ),
    "worm_drive, hob 10 % larger, 1,000 assemblies of 21 positions": ASSEMBLIES.format(
        '"samples/worm_drive.toml", ["hob.reference_diameter=66"]', 0.02
    ),
}


def many() -> list[dict[str, Any]]:
    """Very many positions in one call: run time, and how much memory the process has used at most."""
    rows = []
    for name, program in MANY.items():
        code = "\n".join(
            (
                "import resource, time, numpy as np, gearmesh as gm",
                "from gearmesh.contact.assemblies import many_assemblies",
                "from gearmesh.contact.flanks import solver_pair",
                "from gearmesh.contact.tca import contact_path",
                "from gearmesh.kernel.motion.rigid import Rigid",
                textwrap.dedent(program),
                "started = time.perf_counter(); work()",
                "print(time.perf_counter() - started, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)",
            )
        )
        ran = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True)
        seconds, megabytes = map(float, ran.stdout.split())
        rows.append({"what": name, "seconds": seconds, "megabytes": round(megabytes)})
    return rows


@dataclass(frozen=True)
class Need:
    """Demand of a link of a tooth on any mesh: integrals of sqrt(|k1 k2|) dA, mm, separately where k1 k2 > 0 and < 0."""

    elliptic: float
    saddle: float

    @property
    def fewest(self) -> float:
        """Divided by the tolerance (mm), the least triangles of any mesh with its vertices on the surface.

        A triangle within tol of k (x^2 + y^2) / 2 covers at most 3 sqrt(3) / 2 tol / k, within tol of k x y at most
        2 sqrt(5) tol / k: on a saddle the error has both signs and only the edges count. Developable surfaces
        (k1 k2 = 0), which all flanks cut by a plane are, need nothing.
        """
        return self.elliptic / (1.5 * np.sqrt(3.0)) + self.saddle / (2.0 * np.sqrt(5.0))

    @property
    def estimate(self) -> float:
        """Estimate like `fewest`, but with 2.6 for saddles, too, as if they cost as much as bowls: no bound, but a common
        yardstick."""
        return (self.elliptic + self.saddle) / 2.6


def needs(tooth: Tooth, order: int = 24) -> dict[str, Need]:
    """Return the demand of the flanks and fillets of one tooth on any mesh, by Gauss quadrature."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    s, w, step = 0.5 * (nodes + 1.0), 0.5 * weights, 1e-5
    sections, after, before = (tooth.sections(s + d) for d in (0.0, step, -step))
    found = {}
    for region in tooth.regions:
        if region not in (*FLANK_REGIONS.values(), *FILLET_REGIONS.values()):
            continue
        jet = tooth.grid(region, s, sections).jet
        assert jet is not None
        along_s = tooth.grid(region, s + step, sections).points - tooth.grid(region, s - step, sections).points
        along_t = tooth.grid(region, s, after).points - tooth.grid(region, s, before).points
        normal = cross(along_s, along_t) / (4.0 * step**2)
        gaussian = gaussian_curvature(shape_operator(jet, *tangent_basis(jet)))
        density = np.sqrt(np.abs(gaussian) * dot(normal, normal))
        found[region] = Need(*(float(w @ np.where(here, density, 0.0) @ w) for here in (gaussian > 0, gaussian < 0)))
    return found


def meshes(quick: bool) -> list[dict[str, Any]]:
    """(c): one tooth of each, refined; triangles are those of all teeth, errors are bounds over the whole tooth."""
    rows = []
    for sample, overrides in (HELICAL, ("beveloid_crossed", []), ("circular_arc", [])):
        tooth = gm.build(gm.load(SAMPLES / f"{sample}.toml", overrides)).members["pinion"].tooth
        asked = needs(tooth)
        fewest, estimate = (sum(getattr(need, name) for need in asked.values()) for name in ("fewest", "estimate"))
        bent = [region for region, need in asked.items() if need.estimate > 1e-6 * estimate]
        for tolerance in TOLERANCES_UM[: 3 if quick else None]:
            seconds, mesh = best_of(3, partial(tessellate, tooth, 1e-3 * tolerance))
            error = 1e3 * tooth_bound(mesh).largest
            cells = {patch.region: len(patch.triangles) for patch in mesh.patches}
            curved = sum(cells[region] for region in asked)
            rows.append(
                {
                    "pinion": sample,
                    "tolerance_um": tolerance,
                    "error_um": error,
                    "triangles": tooth.teeth * sum(cells.values()),
                    "flank_and_fillet_triangles": tooth.teeth * curved,
                    "fewest_triangles": tooth.teeth * fewest / (1e-3 * error),
                    "times_fewest": curved * 1e-3 * error / fewest,
                    "times_estimate": curved * 1e-3 * error / estimate,
                    "times_fewest_not_developable": sum(cells[region] for region in bent) * 1e-3 * error / fewest,
                    "seconds": seconds,
                }
            )
    return rows


def cost_runs(rows: list[dict[str, Any]]) -> dict[str, CostRun]:
    """Rows of `meshes` as they are plotted, by sample."""
    keys = "error_um", "flank_and_fillet_triangles", "seconds", "fewest_triangles"
    return {
        sample: CostRun(*(np.array([row[key] for row in rows if row["pinion"] == sample]) for key in keys))
        for sample in dict.fromkeys(row["pinion"] for row in rows)
    }


def kinds(quick: bool) -> list[dict[str, Any]]:
    """Flanks, fillets and ends of a member of every kind: triangles over the fewest possible, by the mesher's own error.

    A bound below one triangle, as rounding leaves it on developable flanks, is no bound: the cell is empty.
    """
    rows = []
    for sample, name in KINDS:
        member = _member(sample, name)
        asked = needs(member.tooth, 40)
        for tolerance in TOLERANCES_UM[: 3 if quick else None]:
            mesh = tessellate(member.tooth, 1e-3 * tolerance)
            solid = gear_solid(member, 1e-3 * tolerance, mesh)
            error = max(patch.deviation for patch in mesh.patches if patch.region in asked)
            taken = {patch.region: len(patch.triangles) for patch in mesh.patches}
            curved = sum(taken[region] for region in asked)
            edges = borders(member.tooth, error, max(patch.deviation for patch in mesh.patches))
            counted = sum(max(need.fewest / error, edges[k]) for k, need in asked.items())
            row = {"member": f"{sample}, {name}", "tolerance_um": tolerance, "error_um": 1e3 * error}
            for links, regions in (("flanks", FLANK_REGIONS), ("fillets", FILLET_REGIONS)):
                least = sum(asked[region].fewest for region in regions.values()) / error
                least = least if least >= 1.0 else np.nan
                row[links] = sum(taken[region] for region in regions.values()) / least
            least = sum(need.fewest for need in asked.values()) / error
            teeth = sum(taken.values()) * member.tooth.teeth * len(member.halves)
            least_ends = fewest_under(member, 1e-3 * tolerance)
            rows.append(
                {
                    **{
                        key: "" if isinstance(value, float) and np.isnan(value) else value for key, value in row.items()
                    },
                    "both": curved / least if least >= 1.0 else "",
                    "counted": curved / counted,
                    "ends": 100.0 * (1.0 - teeth / len(solid.triangles)),
                    "least_ends": 100.0 * least_ends / (least_ends + teeth),
                    "triangles": len(solid.triangles),
                }
            )
    return rows


def _member(sample: str, name: str) -> Member:
    """A member of a sample, or the worm that grinds one."""
    design = gm.load(SAMPLES / f"{sample}.toml", HELICAL[1] if sample == HELICAL[0] else [])
    members = gm.build(design).members
    return members[name] if name in members else worm(design).member


def borders(tooth: Tooth, error: float, most: float) -> dict[Region, float]:
    """Fewest triangles of each link whose border, drawn as parabolas, keeps the error, mm: the edges of its border less two.

    At toe and heel, edges keep to the section curve. On seams they keep to the surfaces on both sides: an edge is one chord,
    and its height over neither surface exceeds that link's error. `most` (mm) is the error of links other than the own.
    """
    x, bends, chords = np.linspace(0.0, 1.0, 65), dict[Region, Any](), dict[Region, float]()
    for region in tooth.regions:
        ends, seams = (
            tooth.grid(region, x, tooth.sections([0.0, 1.0])),
            tooth.grid(region, [0.0, 1.0], tooth.sections(x)),
        )
        points = np.moveaxis(ends.points, 1, 0)
        bent, along = np.diff(points, 2, axis=1), points[:, 2:] - points[:, :-2]
        across = bent - (dot(bent, along) / dot(along, along))[..., None] * along
        chords[region] = _chords(np.sqrt(dot(across, across)) / error)
        bends[region] = np.abs(dot(np.diff(seams.points, 2, axis=1), seams.normals[:, 1:-1]))
    before = dict(zip(tooth.regions, (tooth.regions[-1], *tooth.regions), strict=False))
    after = {region: following for following, region in before.items()}
    for region, own in bends.items():
        other = np.stack((bends[before[region]][1], bends[after[region]][0]))
        chords[region] += _chords(np.maximum(own / error, other / most))
    return {region: edges - 2.0 for region, edges in chords.items()}


def _chords(bends: np.ndarray) -> float:
    """Fewest chords of curves whose second differences (K, N) are so many times the error."""
    return float(np.maximum(1.0, np.ceil(np.sqrt(bends / 8.0).mean(axis=1) * (bends.shape[1] + 1) - 0.05)).sum())


def fewest_under(member: Member, tolerance: float) -> float:
    """Fewest triangles of end faces, bore and back: one for each chord of the end sections that keeps the tolerance (mm), and one
    on either side of each chord of a ring. A plane between rings of N and M nodes has N + M triangles.

    As many chords for every tooth; gaps of double helical gears are left out.
    """
    tooth, x = member.tooth, np.linspace(0.0, 1.0, 1_001)
    outline, sections = 0.0, tooth.sections(np.array([0.0, 1.0]))
    for region in tooth.regions:
        points = np.moveaxis(tooth.grid(region, x, sections).points, 1, 0)
        bent, along = np.diff(points, 2, axis=1), points[:, 2:] - points[:, :-2]
        size = np.maximum(dot(along, along), 1e-300)
        across = bent - (dot(bent, along) / size)[..., None] * along
        chords = np.sqrt(np.sqrt(dot(across, across)) / (8.0 * tolerance)).sum(axis=1)
        outline += float(np.maximum(1.0, np.ceil(chords - 0.05)).sum())
    if tooth.joint.travel is not None:
        return tooth.teeth * outline
    rings = sum(ring_count(tooth.teeth, rho, tolerance) for rho, _ in member.body.profile if rho > 0.0)
    return tooth.teeth * outline + 2.0 * rings


def tolerances(quick: bool) -> list[dict[str, Any]]:
    """A member of every kind at every tolerance, in a process of its own each; what takes too much is left empty."""
    rows = []
    for sample, name in EVERY_WAY:
        for tolerance in TOLERANCES_UM[: 3 if quick else None]:
            row: dict[str, Any] = {"member": f"{sample}, {name}", "tolerance_um": tolerance}
            with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
                try:
                    row |= pool.submit(meshed_and_measured, sample, name, tolerance).result()
                except (BrokenProcessPool, MemoryError):
                    print(f"{row['member']}, {tolerance:g} um: more than {MOST_SECONDS} s or {MOST_BYTES} bytes")
            rows.append(row)
    return rows


def meshed_and_measured(sample: str, name: str, tolerance_um: float) -> dict[str, Any]:
    """A row of `tolerances`. This process ends if it takes longer than MOST_SECONDS; MemoryError beyond MOST_BYTES."""
    member, tolerance = _member(sample, name), 1e-3 * tolerance_um
    resource.setrlimit(resource.RLIMIT_CPU, (math.ceil(time.process_time()) + MOST_SECONDS, resource.RLIM_INFINITY))
    resource.setrlimit(resource.RLIMIT_DATA, (MOST_BYTES, resource.RLIM_INFINITY))

    # the first run imports what others find loaded
    gear_solid(member, 0.1)
    seconds, _ = best_of(3 if tolerance_um >= 1.0 else 1, lambda: gear_solid(member, tolerance))
    with_bound, (made, mesh, largest) = best_of(1, lambda: mesh_within(member, tolerance))
    return {
        "seconds": seconds,
        "seconds_with_bound": with_bound,
        "triangles": mesh.triangle_count,
        "max_deviation_um": 1e3 * largest,
        "sampled_deviation_um": 1e3 * made.bound.sampled,
        "megabytes": round(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024),
    }


def solids_and_stl(folder: Path, repeats: int) -> list[dict[str, Any]]:
    """The helical benchmark gear and the worm of a ground pinion at 10 um, built and written in process; bounds of the files."""
    members = {
        "helical, pinion": gm.build(gm.load(SAMPLES / f"{HELICAL[0]}.toml", HELICAL[1])).members["pinion"],
        "novikov, worm": worm(gm.load(SAMPLES / "novikov.toml")).member,
        "worm_drive, worm": _member("worm_drive", "worm"),
        "worm_drive, wheel": _member("worm_drive", "wheel"),
    }
    rows, file = [], folder / "solid_10um.stl"
    for part, member in members.items():
        seconds, _ = best_of(repeats, lambda member=member: io.write(gear_solid(member, 0.01), file))
        _, written, largest = mesh_within(member, 0.01, file=file)
        rows.append({"part": part, "triangles": written.triangle_count, "error_um": 1e3 * largest, "seconds": seconds})
    return rows


def from_design_to_check(sample: str, tolerance: float, repeats: int) -> list[dict[str, Any]]:
    """From the design to proved solids within `tolerance` (mm), contact and roll test, each step and the whole."""
    design = gm.load(SAMPLES / f"{sample}.toml")
    seconds, built = best_of(repeats, lambda: gm.build(design))
    gears = built.pairs[0]
    rows = [{"step": "settings, teeth proved", "seconds": seconds, "error": ""}]
    tooth, s, t = gears.pinion.tooth, np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 10)
    seconds, grid = best_of(repeats, lambda: tooth.flank_grid(gears.flanks[0], s, t))
    off = np.abs(tooth.blank.axial.value(grid.points) - tooth.stations(t)).max()
    rows.append({"step": "trimmed flank grid 5 x 10", "seconds": seconds, "error": f"{off:.1e} mm"})
    phi1 = np.linspace(-0.5, 0.5, 101) * gears.pitch
    seconds, path = best_of(repeats, lambda: contact_path(solver_pair(gears), phi1, gears.generation))
    rows.append({"step": "contact, 101 positions", "seconds": seconds, "error": f"{np.nanmax(path.residual):.1e} mm"})
    seconds, contact = best_of(repeats, built.contact)
    residual = contact.summary["max_residual_mm"]
    positions = contact.summary["positions"]
    rows.append({"step": f"{positions} positions and mesh cycle", "seconds": seconds, "error": f"{residual:.1e} mm"})
    for member in ("pinion", "gear"):
        meshing, _ = best_of(repeats, lambda member=member: gear_solid(built.members[member], tolerance))
        seconds, solid = best_of(repeats, lambda member=member: built.solid(member, tolerance))
        found = solid.figures
        error = f"{found['max_deviation_um']:.2f} um, {found['triangles']} triangles"
        rows.append({"step": f"{member}: meshed and closed", "seconds": meshing, "error": error})
        rows.append({"step": f"{member}: measured and proved as well", "seconds": seconds, "error": ""})
    seconds, checked = best_of(repeats, lambda: gm.build(design).check(tolerance))
    te = max(abs(row.te_difference) for row in checked.roll.rows)
    rows.append({"step": "all: both solids, contact, roll test", "seconds": seconds, "error": f"TE {te:.2f} arcsec"})
    return rows


def step_files(folder: Path, repeats: int) -> list[dict[str, Any]]:
    """Members as STEP at 0.1 um: one of every way that teeth are made, and a whole set."""
    rows = []
    for sample, member in STEP_PARTS:
        gears, file = gm.build(gm.load(SAMPLES / f"{sample}.toml")), folder / f"{sample}.step"

        def step(gears: gm.Gears = gears, member: str | None = member, file: Path = file) -> list[Mapping[str, Any]]:
            result = gears.cad(member, 1e-4)
            result.save(file)
            return list(result.figures.values())

        seconds, found = best_of(repeats, step)
        rows.append(
            {
                "part": f"{sample}, {member or 'all'}",
                "error_um": max(part["max_deviation_um"] for part in found),
                "faces": sum(part["faces"] for part in found),
                "volume_error": f"{max((part['volume_error'] for part in found), key=abs):.0e}",
                "seconds": seconds,
                "megabytes": file.stat().st_size / 1e6,
            }
        )
    return rows


def models(folder: Path, repeats: int) -> list[dict[str, Any]]:
    """Finite-element models of three teeth with their decks."""
    rows = []
    for sample, overrides in (("helical", []), ("spiral_bevel_basic", ["fe.ellipse=8"])):
        gears = gm.build(gm.load(SAMPLES / f"{sample}.toml", overrides))
        seconds, problem = best_of(repeats, gears.finite_elements)
        error = f"{problem.figures['elements']} elements, scaled Jacobian {problem.figures['min_scaled_jacobian']:.2f}"
        rows.append({"step": " ".join([f"{sample}: model", *overrides]), "seconds": seconds, "error": error})
        seconds, _ = best_of(repeats, lambda problem=problem: problem.save(folder / "model.inp"))
        rows.append({"step": f"{sample}: deck", "seconds": seconds, "error": ""})
    return rows


def imports(repeats: int = 10) -> list[dict[str, Any]]:
    """(d): seconds of `import x` in fresh processes, best of several.

    `import gearmesh` loads no submodule, so what the solver and the commands cost to import stands beside it.
    """
    times = {}
    for module in ("numpy", "gearmesh", "gearmesh.contact.tca", "gearmesh.app.cli"):
        code = f"import time; t = time.perf_counter(); import {module}; print(time.perf_counter() - t)"
        command = [sys.executable, "-c", code]
        runs = [subprocess.run(command, capture_output=True, text=True, check=True) for _ in range(repeats)]
        times[module] = min(float(run.stdout) for run in runs)
    return [{"module": m, "seconds": t, "times_numpy": t / times["numpy"]} for m, t in times.items()]


def processes(folder: Path, repeats: int = 5) -> list[dict[str, Any]]:
    """Seconds of whole commands, start-up included, best of several."""
    rows = []
    for command in (
        "gear --module 1 --teeth 30 -o {}",
        "tca samples/helical.toml",
        "solid samples/helical.toml --member pinion --tol 10um -o {}",
        "solid samples/novikov.toml --member worm --tol 10um -o {}",
    ):
        words = command.format(folder / "part.stl").split()
        run = partial(
            subprocess.run, [sys.executable, "-m", "gearmesh", *words], cwd=ROOT, capture_output=True, check=True
        )
        rows.append({"command": f"gearmesh {command.format('part.stl')}", "seconds": best_of(repeats, run)[0]})
    return rows


def show(title: str, rows: list[dict[str, Any]]) -> None:
    """A plain table."""
    print(f"\n{title}")
    names = list(dict.fromkeys(name for row in rows for name in row))
    texts = [[row.get(name, "") for name in names] for row in rows]
    cells = [names, *([f"{v:.4g}" if isinstance(v, float) else str(v) for v in row] for row in texts)]
    widths = [max(len(row[k]) for row in cells) for k in range(len(cells[0]))]
    for row in cells:
        print("  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)))


STEPS = {"step": "step", "seconds": "time, s", "error": "error"}
MACHINE = {"cores": "cores", "processor": "processor", "python": "Python", "numpy": "numpy"}
#: columns of each table of scripts/measured
COLUMNS: dict[str, dict[str, str]] = {
    "contact": {
        "what": "contact, LT02 crossed pair",
        "positions": "positions",
        "seconds": "time, s",
        "residual_mm": "largest residual, mm",
        "batch_is_faster": "one batch is faster, times",
    },
    "analyses": {
        "sample": "sample",
        "positions": "positions",
        "seconds": "all that `tca` reports, s",
        "times_path": "times the path alone",
    },
    "many": {"what": "one call", "seconds": "time, s", "megabytes": "peak, MB"},
    "meshes": {
        "pinion": "pinion, all teeth",
        "tolerance_um": "asked, µm",
        "error_um": "bound, µm",
        "triangles": "triangles",
        "times_fewest": "times the fewest possible",
        "times_estimate": "times the integral / (2.6 bound)",
        "seconds": "meshing time, s",
    },
    "kinds": {
        "member": "member",
        "tolerance_um": "asked, µm",
        "error_um": "reported, µm",
        "flanks": "flanks, times the fewest",
        "fillets": "fillets, times the fewest",
        "both": "both",
        "counted": "both, times the fewest by integral and border",
        "ends": "ends, bore and back, % of all",
        "least_ends": "the least, %",
        "triangles": "triangles of the solid",
    },
    "tolerances": {
        "member": "member",
        "tolerance_um": "asked, µm",
        "triangles": "triangles",
        "max_deviation_um": "bound, µm",
        "sampled_deviation_um": "sampled, µm",
        "seconds": "meshed and closed, s",
        "seconds_with_bound": "with bound, s",
        "megabytes": "peak, MB",
    },
    "solid": {
        "part": "solid within 10 µm",
        "triangles": "triangles",
        "error_um": "bound, µm",
        "seconds": "built and written, s",
    },
    "spiral_bevel_basic": STEPS,
    "novikov": STEPS,
    "face_gear": STEPS,
    "step_files": {
        "part": "STEP within 0.1 µm",
        "error_um": "reached, µm",
        "faces": "faces",
        "volume_error": "volume error",
        "seconds": "solid and file, s",
        "megabytes": "size, MB",
    },
    "models": STEPS,
    "commands": {"command": "command, as a whole process", "seconds": "time, s"},
    "imports": {"module": "import", "seconds": "time, s", "times_numpy": "times import numpy"},
}


def keep(result: dict[str, list[dict[str, Any]]]) -> None:
    """Keep the tables of a run, and write the figures of README.md. The machine is that of a run of all tables."""
    for name, rows in result.items():
        tables.keep(name, rows, COLUMNS[name])
    if result.keys() >= COLUMNS.keys():
        machine = (os.cpu_count(), platform.machine(), platform.python_version(), np.__version__)
        tables.keep("machine", [dict(zip(MACHINE, machine, strict=True))], MACHINE)
    if result.keys() >= {"solid", "contact"}:
        tables.rewrite(ROOT / "README.md", {"figures": sentences(result["solid"][0], result["contact"][0])})


def sentences(solid: Mapping[str, Any], batch: Mapping[str, Any]) -> str:
    """The figures that README.md opens with."""
    return textwrap.fill(
        f"For a helical gear (24 teeth, module 5 mm, 15 deg, 50 mm wide) and a tolerance of 10 µm the mesh has "
        f"{solid['triangles']:,} triangles. Mesh and exact gear are nowhere farther than {solid['error_um']:.1f} µm "
        f"from each other, the rounding of the file included: this [bound](gearmesh/mesh/README.md) is proved. The STL file takes "
        f"{solid['seconds']:.2g} s. Contact at {batch['positions']} positions takes {batch['seconds']:.2g} s at a "
        f"residual of {batch['residual_mm']:.0e} mm.",
        width=140,
    )


def measures(folder: Path, quick: bool) -> dict[str, Callable[[], list[dict[str, Any]]]]:
    """Return the functions that measure the rows of each table."""
    often = 1 if quick else 3
    checked = {"spiral_bevel_basic": 0.005, "novikov": 0.001, "face_gear": 0.02}
    return {
        "contact": partial(contact, 3),
        "analyses": partial(analyses, often),
        "many": many,
        "meshes": partial(meshes, quick),
        "kinds": partial(kinds, quick),
        "tolerances": partial(tolerances, quick),
        "solid": partial(solids_and_stl, folder, 5),
        **{name: partial(from_design_to_check, name, tolerance, often) for name, tolerance in checked.items()},
        "step_files": partial(step_files, folder, often),
        "models": partial(models, folder, 3),
        "imports": imports,
        "commands": partial(processes, folder),
    }


def versions_side_by_side(options: argparse.Namespace) -> None:
    """Table of two versions, printed row by row, written as against.json and, if asked for, kept in scripts/measured."""
    rows = []
    for row in against.compare(options.against, options.only, options.rounds):
        rows.append(row)
        print(
            tables.table([row], against.COLUMNS).splitlines()[-1],
            *row.get("differing", [])[:5],
            sep="\n    ",
            flush=True,
        )
        # a command that fails later takes nothing away
        path = options.output / "against.json"
        io.whole_text(path, json.dumps(rows, indent=1) + "\n")
        if options.write:
            against.keep(rows)
    print(f"\nwritten: {path}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("out/bench"))
    parser.add_argument("--quick", action="store_true", help="leave out 0.1 um")
    parser.add_argument(
        "--write", action="store_true", help="keep the tables in scripts/measured, figures in README.md"
    )
    parser.add_argument("--against", metavar="VERSION", help="commands of another version and of this one in turns")
    parser.add_argument("--rounds", type=int, default=5, help="with --against: how often each command runs")
    parser.add_argument("--only", nargs="+", metavar="TABLE", help="these tables; with --against these commands")
    options = parser.parse_args()
    known = against.COMMANDS if options.against else COLUMNS
    options.only = options.only or [*known]
    unknown = [name for name in options.only if name not in known]
    if unknown:
        parser.error(f"--only {unknown[0]!r}: must be one of {', '.join(map(repr, known))}")
    if options.write and options.quick:
        parser.error("--write: not with --quick, which leaves rows out")
    options.output.mkdir(parents=True, exist_ok=True)

    if options.against:
        versions_side_by_side(options)
        return
    result = {}
    for name, measure in measures(options.output, options.quick).items():
        if name in options.only:
            result[name] = measure()
            show(name, result[name])
    io.whole_text(options.output / "bench.json", json.dumps(result, indent=1) + "\n")
    written = [options.output / "bench.json"]
    if "meshes" in result:
        written.append(options.output / "mesh_cost.png")
        plot_cost(written[-1], cost_runs(result["meshes"]))
    if options.write:
        keep(result)
        written.append(tables.MEASURED)
    print(f"\nwritten: {', '.join(map(str, written))}")


if __name__ == "__main__":
    main()
