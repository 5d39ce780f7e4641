"""Loaded contact (gearmesh.loaded) against CalculiX on the same models: a few teeth with their rim, cut faces held.

Usage: python scripts/load_checks.py [--only CASE ...] [--resume FOLDER [--kept]] [--write]

Positions over a pitch of each case: rotation under load, share of the load of each tooth pair, peak pressure, root stress.
`--resume` keeps what was solved in a folder and does not solve it again; `--write` keeps the table in scripts/measured. Needs
CalculiX (ccx).
"""

from __future__ import annotations

import argparse
import json
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from tables import keep

import gearmesh as gm
from gearmesh.contact.hertz import STEEL
from gearmesh.fe import ccx
from gearmesh.fe.gear_model import GearModel, Request, contact_stiffness, gear_model
from gearmesh.fe.placing import PlacedPair, place
from gearmesh.fe.results import NodalSolution, contact_figures, largest_principal
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.loaded.compliance.compliance import SECTOR_CELLS, HeldTeeth, held_teeth
from gearmesh.loaded.sharing import LoadedMesh, inside, loaded_mesh
from gearmesh.mesh.hexahedra.hexahedra import Cells
from gearmesh.teeth.gear_train import GearPair

Row = dict[str, Any]
ROOT = Path(__file__).parents[1]
#: elements of the models that CalculiX solves: three teeth of either member; one tooth, fine enough for the pressure; three teeth,
#: to measure the error of the first model
DECK = Cells(flank=20, fillet=10, thickness=3, rim=2, face=6)
FINE = Cells(flank=28, fillet=5, thickness=4, rim=3, face=16)
FINER = Cells(flank=26, fillet=10, thickness=7, rim=3, face=6)
#: flanks that curve along the face need more elements along it: otherwise facets are farther off than teeth deflect
CURVED = Cells(flank=12, fillet=8, thickness=3, rim=2, face=12)
#: share of the face at either end in which peak pressures are not compared: there they depend on how fine the grids are
END = 0.12
#: rows of elements at tip and root in which peak pressures are not compared
ROWS = 2

NARROW = (
    "module=5",
    "pinion.teeth=20",
    "gear.teeth=25",
    "pinion.face_width=12",
    "gear.face_width=12",
    "pinion.profile_shift=0",
    "gear.profile_shift=0",
    "backlash=0.1",
    "assembly.center_distance=112.5",
)
MODIFIED = tuple(
    f"{member}.modifications={{helix_crowning=0.012, tip_relief={{amount=0.02, start_diameter={start}}}}}"
    for member, start in (("pinion", 106), ("gear", 131))
)
#: parts of the grid along and across that are left out next to edges, where the models' pressure is not resolved
CELLS_BESIDE_EDGES = (20, 12)


@dataclass(frozen=True)
class Case:
    """A pair to compare: its sample, the keys set in it, and the torque on the pinion, Nm.

    - `teeth`: number of teeth of either member in the model; the middle tooth has the leading contact.
    - `phases`: positions, in pitches; with a single tooth, positions at which no other pair carries.
    - `ellipse`: elements over each semi-axis of the contact; 0 for the elements of `deck`.
    """

    sample: str
    torque: float
    keys: tuple[str, ...] = ()
    deck: Cells = DECK
    teeth: int = 3
    phases: tuple[float, ...] = (0.0, 0.2, 0.4, 0.6, 0.8)
    ellipse: int = 0


SLICE = ("pinion.face_width=20", "gear.face_width=20")
FACE = ("gear.inner_radius=486", "gear.outer_radius=530")
#: for the tests: some seconds
SMALLEST = Case("spur", 300.0, NARROW, Cells(flank=14, fillet=8, thickness=3, rim=2, face=4))
CASES = {
    "spur": Case("spur", 300.0, NARROW),
    "spur, relieved and crowned": Case("spur", 300.0, (*NARROW, *MODIFIED)),
    "helical": Case("helical", 600.0, SLICE),
    "spiral_bevel_basic": Case("spiral_bevel_basic", 100.0, (), CURVED),
    "face_gear": Case("face_gear", 2000.0, FACE, Cells(flank=14, fillet=9, thickness=3, rim=2, face=8)),
    "finer: spur": Case("spur", 300.0, NARROW, FINER, 3, (0.2,)),
    "finer: helical": Case("helical", 600.0, SLICE, FINER, 3, (0.6,)),
    "one tooth: spur, relieved and crowned": Case("spur", 300.0, (*NARROW, *MODIFIED), FINE, 1, (0.75,), 4),
    "one tooth: spiral_bevel_basic": Case("spiral_bevel_basic", 40.0, (), FINE, 1, (0.0,), 4),
}


@dataclass(frozen=True)
class Figures:
    """Figures of one program at a position.

    - `rotation`: arcsec.
    - `forces`: N, by number of the tooth pair; 0 is the leading pair.
    - `roots`: largest principal stresses, MPa, in the fillets of pinion and gear, by number of the tooth pair.
    - `peak`: peak pressure, MPa, of the leading pair, at least `END` of the face and `ROWS` of elements away from edges.
    - `springs`: part of the model's rotation that is due to its contact springs, arcsec.
    """

    rotation: float
    forces: dict[str, float]
    roots: dict[str, list[float]]
    peak: float
    springs: float = 0.0
    nodes: int = 0
    seconds: float = 0.0

    @property
    def share(self) -> dict[str, float]:
        """Per cent of the load."""
        return {n: 100.0 * force / sum(self.forces.values()) for n, force in self.forces.items()}

    def root(self, member: int) -> float:
        return max(each[member] for each in self.roots.values())


def pair_of(case: Case) -> GearPair:
    (pair,) = gm.build(gm.load(ROOT / "samples" / f"{case.sample}.toml", list(case.keys))).pairs
    return pair


def places(case: Case, pair: GearPair) -> list[PlacedPair]:
    """The leading teeth at the phases of the case."""
    return [place(pair, pair.pitch * phase, 1e3 * case.torque, (STEEL, STEEL)) for phase in case.phases]


def by_elements(case: Case, pair: GearPair, at: PlacedPair) -> Figures:
    """Return the figures of CalculiX."""
    started = time.perf_counter()
    built = gear_model(
        Request(teeth=case.teeth, cells=case.deck, ellipse=case.ellipse, torque=1e3 * case.torque, every_tooth=True),
        at,
    )
    solution = ccx.solve(built.model, threads=1)
    contacts = contact_figures(built.model, solution)
    mesh = built.model.mesh
    numbers = [
        int(-pair.pinion.mount.sign) * (tooth_of(each.slave) - 1 - case.teeth // 2) for each in built.model.contacts
    ]
    fillets = [f"{name}_fillet_{side}" for name, side in zip(pair.members, pair.flanks, strict=True)]
    roots = [
        [
            largest_principal(mesh, solution, f"{name}_{tooth_of(flank)}")[0]
            for name, flank in zip(fillets, (each.slave, each.master), strict=True)
        ]
        for each in built.model.contacts
    ]
    forces = {str(n): float(np.linalg.norm(each.force)) for n, each in zip(numbers, contacts, strict=True)}
    sense = float(np.sign(at.arm))
    turned = sense * solution.references[f"{pair.pinion.name}_held"].rotation[2]
    peak = peak_inside(built, solution, case, pair)
    return Figures(
        (built.preload + turned) / ARCSEC,
        forces,
        {str(n): each for n, each in zip(numbers, roots, strict=True)},
        peak,
        nodes=len(mesh.nodes),
        seconds=time.perf_counter() - started,
    )


def tooth_of(face_set: str) -> int:
    """Return the number of the tooth of a set of faces, from 1."""
    return int(face_set.rsplit("_", 1)[1])


def peak_inside(built: GearModel, solution: NodalSolution, case: Case, pair: GearPair) -> float:
    """Peak pressure (MPa) of the leading pair away from the edges of the flank."""
    mesh, pinion = built.model.mesh, pair.pinion.name
    (name,) = {each.slave for each in built.model.contacts if tooth_of(each.slave) == 1 + case.teeth // 2}
    layers = len(mesh.element_sets[pinion]) // len(mesh.face_sets[f"{pinion}_toe"])
    # rows of faces run from form point to tip
    inner = np.unique(mesh.face_corners(name).reshape(-1, 4 * layers)[ROWS:-ROWS])
    inner = inner[away_from_ends(pair, mesh.nodes[inner])]
    return float(solution.pressure[inner].max())


def away_from_ends(pair: GearPair, places: Array) -> NDArray[np.bool_]:
    """True for places (..., 3), in a frame whose z axis is the pinion's, on the inner part of the pinion's face."""
    toe, heel = pair.pinion.tooth.blank.extent
    t = (pair.pinion.tooth.blank.axial.value(places) - toe) / (heel - toe)
    found: NDArray[np.bool_] = np.abs(t - 0.5) < 0.5 - END
    return found


def by_loaded(case: Case, pair: GearPair, at: list[PlacedPair], bodies: tuple[HeldTeeth, HeldTeeth]) -> list[Figures]:
    """Return the figures of gearmesh.loaded at all positions."""
    found = loaded_mesh(pair, np.array([each.turns[0] for each in at]), np.array([1e3 * case.torque]), bodies)
    return [_figures(case, pair, found, k, contact_stiffness((STEEL, STEEL), at[k])) for k in range(len(at))]


def _figures(case: Case, pair: GearPair, found: LoadedMesh, k: int, stiffness: float) -> Figures:
    """Return the figures of a mesh under one torque at position k; `stiffness` (MPa/mm) is that of the model's contact springs."""
    (load,) = found.loads
    own = np.flatnonzero((load.position == k) & (load.force > 0.0))
    beyond = [int(load.number[m]) for m in own if abs(load.number[m]) > case.teeth // 2]
    if beyond:
        raise SystemExit(f"tooth pairs {beyond} carry too: the model needs more than {case.teeth} teeth")
    grid = load.separation
    squares = (load.pressure[own] ** 2).sum(axis=(1, 2)) @ (grid.dx[own] * grid.dy[own])
    springs = squares / (stiffness * found.torque[0])
    (leading,) = own[load.number[own] == 0]
    beside = (max(1, round(count / part)) for count, part in zip(grid.on.shape[1:], CELLS_BESIDE_EDGES, strict=True))
    inner = inside(grid.on, *beside)[leading] & away_from_ends(pair, grid.places[0, leading])[:, None]
    return Figures(
        float(found.rotation[0, k]) / ARCSEC,
        {str(load.number[m]): float(load.force[m]) for m in own},
        {"all": found.root_stress[0, k].tolist()},
        float(np.where(inner, load.pressure[leading], 0.0).max()),
        springs=float(springs) / ARCSEC,
    )


def compared(name: str, phase: float, loaded: Figures, wanted: Figures) -> Row:
    """A row of the table: what CalculiX finds, and how far `loaded` is from it."""
    # the springs between the bodies are the model's, not the teeth's
    rotation = wanted.rotation - loaded.springs
    resolved = CASES[name].ellipse > 0
    return {
        "case": name,
        "phase": phase,
        "nodes": wanted.nodes,
        "rotation": round(rotation, 1),
        "rotation_off": percent(loaded.rotation, rotation),
        "springs": round(loaded.springs, 2),
        "share": round(wanted.share["0"], 1),
        "share_off": round(max(abs(wanted.share[n] - loaded.share.get(n, 0.0)) for n in wanted.share), 1),
        "peak": round(wanted.peak) if resolved else "",
        "peak_off": percent(loaded.peak, wanted.peak) if resolved else "",
    } | (
        {
            # root stress of models with three teeth only: a model of one tooth has its elements at the contact
            f"{member}{key}": value
            for n, member in enumerate(("pinion", "gear"))
            for key, value in (("", round(wanted.root(n), 1)), ("_off", percent(loaded.root(n), wanted.root(n))))
        }
        if len(wanted.forces) > 1
        else {}
    )


def percent(found: float, wanted: float) -> str:
    return f"{100.0 * (found / wanted - 1.0):+.1f}"


def kept(folder: Path | None, name: str, k: int, count: int) -> Path | None:
    words = "_".join("".join(c if c.isalnum() else " " for c in name).split())
    return None if folder is None else folder / f"{words}_{k}_of_{count}.json"


def bodies_of(case: Case, pair: GearPair, cells: Cells = SECTOR_CELLS) -> tuple[HeldTeeth, HeldTeeth]:
    """The compliance of the model's bodies, as gearmesh.loaded has it."""
    sides = zip(pair.both, pair.flanks, strict=True)
    first, second = (held_teeth(member.tooth, side, STEEL, cells, None, case.teeth) for member, side in sides)
    return first, second


def rows_of(name: str, folder: Path | None, solve: bool = True) -> list[Row]:
    """Print and return the rows of a case; figures of CalculiX are kept in `folder`. Without `solve`, only kept figures are
    compared."""
    case = CASES[name]
    pair = pair_of(case)
    at = places(case, pair)
    found = by_loaded(case, pair, at, bodies_of(case, pair))
    rows = []
    for k, phase in enumerate(case.phases):
        file = kept(folder, name, k, len(at))
        if file is not None and file.exists():
            wanted = Figures(**json.loads(file.read_text(encoding="utf-8")))
        elif not solve:
            continue
        else:
            wanted = by_elements(case, pair, at[k])
            if file is not None:
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(json.dumps(asdict(wanted)), encoding="utf-8")
        rows.append(compared(name, phase, found[k], wanted))
        print("   ".join(f"{key} {value}" for key, value in rows[-1].items()), flush=True)
    return rows


COLUMNS = {
    "case": "pair",
    "phase": "phase",
    "nodes": "nodes",
    "rotation": "rotation, arcsec",
    "rotation_off": "loaded, %",
    "share": "leading pair, % of the load",
    "share_off": "loaded, points",
    "peak": "peak, MPa",
    "peak_off": "loaded, %",
    "pinion": "pinion's root, MPa",
    "pinion_off": "loaded, %",
    "gear": "gear's root, MPa",
    "gear_off": "loaded, %",
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=tuple(CASES), metavar="CASE", help=f"of {', '.join(CASES)}")
    parser.add_argument("--resume", type=Path, metavar="FOLDER")
    parser.add_argument("--kept", action="store_true", help="solve nothing: only what --resume has")
    parser.add_argument("--write", action="store_true")
    args = parser.parse_args()
    rows = [row for name in args.only or CASES for row in rows_of(name, args.resume, not args.kept)]
    if args.write:
        keep("truth", rows, COLUMNS)


if __name__ == "__main__":
    main()
