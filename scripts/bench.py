"""Run time against error, in one run: contact, meshes, imports. Prints tables, writes bench.json and mesh_cost.png.

python scripts/bench.py [-o out/bench] [--quick]
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import root

from gearmesh import io, job
from gearmesh.contact import solver_pair
from gearmesh.curvature import gaussian_curvature, shape_operator, tangent_basis
from gearmesh.design import load
from gearmesh.deviation import deviations
from gearmesh.frames import cross, dot
from gearmesh.meshing import Conditions
from gearmesh.plots import CostRun, plot_cost
from gearmesh.solid import gear_solid
from gearmesh.tca import contact_path
from gearmesh.tessellate import tessellate
from gearmesh.tooth import Tooth

SAMPLES = Path(__file__).parent.parent / "samples"
#: z = 24, m_n = 5, alpha 20, beta 15, b = 50 mm, standard rack, no bore
HELICAL = ("helical", ["pinion.bore=0"])
TOLERANCES_UM = (100.0, 10.0, 1.0, 0.1)


def best_of(repeats: int, work: Callable[[], Any]) -> tuple[float, Any]:
    """Shortest of several run times, s, and the last result."""
    shortest, result = np.inf, None
    for _ in range(repeats):
        started = time.perf_counter()
        result = work()
        shortest = min(shortest, time.perf_counter() - started)
    return shortest, result


def contact(repeats: int) -> dict[str, Any]:
    """(a), (b): all positions in one batch, against scipy.optimize.root position by position on the same equations."""
    pair = solver_pair(job.pair(load(SAMPLES / "beveloid_crossed.toml")))
    phi1 = np.radians(np.linspace(-6.0, 6.0, 201))
    seconds, path = best_of(repeats, lambda: contact_path(pair, phi1))
    many, long_path = best_of(2, lambda: contact_path(pair, np.radians(np.linspace(-6.0, 6.0, 10_000))))
    solution = np.column_stack((path.params1, path.params2, path.phi2))
    rows = {}
    for name, with_jacobian in (("root, differences", False), ("root, exact Jacobian", True)):
        started = time.perf_counter()
        residual, parameters = _one_by_one(pair, phi1, solution[0], with_jacobian)
        seconds_alone = time.perf_counter() - started
        apart = float(np.abs(parameters - solution[:, :4]).max())
        rows[name] = {"seconds": seconds_alone, "residual_mm": residual, "difference_mm": apart}
    return {
        "positions": 201,
        "seconds": seconds,
        "residual_mm": float(path.residual.max()),
        "seconds_10000": many,
        "residual_10000_mm": float(long_path.residual.max()),
        "one_by_one": rows,
        "times_faster": {name: row["seconds"] / seconds for name, row in rows.items()},
    }


def _one_by_one(pair: Any, phi1: np.ndarray, start: np.ndarray, exact: bool) -> tuple[float, np.ndarray]:
    """Each position from its neighbour's solution by scipy's hybrid method; largest residual (mm) and parameters."""
    index, x, found, worst = np.array([0]), start, [], 0.0
    for angle in phi1:
        conditions = Conditions(pair.flanks, np.array([angle]), pair.length())

        def equations(y: np.ndarray, conditions: Conditions = conditions) -> np.ndarray:
            return conditions(y[None], index)[0][0]

        def jacobian(y: np.ndarray, conditions: Conditions = conditions) -> np.ndarray:
            return conditions(y[None], index)[1][0]

        x = root(equations, x, jac=jacobian if exact else None, tol=1e-13).x
        worst = max(worst, float(np.abs(equations(x)[:3]).max()))
        found.append(x[:4])
    return worst, np.array(found)


def fewest_triangles(tooth: Tooth, order: int = 24) -> float:
    """Integral of sqrt(|k1 k2|) dA / 2.6 (mm) over flanks and fillets: divided by the tolerance, the least triangles.

    Of a tangent-plane quadratic k (x^2 + y^2) / 2 a triangle with its vertices on the surface covers at most
    3 sqrt(3) / 2 tol / k. Developable surfaces (k1 k2 = 0), which all flanks cut by a plane are, count nothing.
    """
    nodes, weights = np.polynomial.legendre.leggauss(order)
    s, w, step = 0.5 * (nodes + 1.0), 0.5 * weights, 1e-5
    sections, after, before = (tooth.sections(s + d) for d in (0.0, step, -step))
    total = 0.0
    for region in tooth.regions:
        if not region.startswith(("flank", "fillet")):
            continue
        jet = tooth.grid(region, s, sections).jet
        assert jet is not None
        along_s = tooth.grid(region, s + step, sections).points - tooth.grid(region, s - step, sections).points
        along_t = tooth.grid(region, s, after).points - tooth.grid(region, s, before).points
        normal = cross(along_s, along_t) / (4.0 * step**2)
        gaussian = gaussian_curvature(shape_operator(jet, *tangent_basis(jet)))
        total += float(w @ (np.sqrt(np.abs(gaussian) * dot(normal, normal))) @ w) / 2.6
    return total


def meshes(quick: bool) -> dict[str, list[dict[str, float]]]:
    """(c): one tooth of each, refined; triangles are those of all teeth, errors are measured at 13 points a facet."""
    results = {}
    for sample, overrides in (HELICAL, ("beveloid_crossed", []), ("circular_arc", [])):
        tooth = job.pair(load(SAMPLES / f"{sample}.toml", overrides)).pinion.tooth
        least, rows = fewest_triangles(tooth), []
        for tolerance in TOLERANCES_UM[: 3 if quick else None]:
            seconds, mesh = best_of(3, lambda tooth=tooth, tolerance=tolerance: tessellate(tooth, 1e-3 * tolerance))
            error = 1e3 * max(d.largest for d in deviations(mesh).values())
            cells = {patch.region: 2 * patch.rising.size for patch in mesh.patches}
            curved = sum(n for region, n in cells.items() if region.startswith(("flank", "fillet")))
            fillets = sum(n for region, n in cells.items() if region.startswith("fillet"))
            rows.append(
                {
                    "tolerance_um": tolerance,
                    "error_um": error,
                    "triangles": tooth.teeth * sum(cells.values()),
                    "flank_and_fillet_triangles": tooth.teeth * curved,
                    "fillet_triangles": tooth.teeth * fillets,
                    "fewest_triangles": tooth.teeth * least / (1e-3 * error),
                    "times_fewest": curved / (least / (1e-3 * error)),
                    "seconds": seconds,
                }
            )
        results[sample] = rows
    return results


def solid_and_stl(folder: Path, repeats: int) -> dict[str, float]:
    """The helical benchmark gear at 10 um, built and written in process."""
    member = job.pair(load(SAMPLES / f"{HELICAL[0]}.toml", HELICAL[1])).pinion
    target = folder / "helical_10um.stl"

    def work() -> int:
        solid = gear_solid(member, 0.01)
        io.write(solid, target)
        return len(solid.triangles)

    seconds, triangles = best_of(repeats, work)
    error = 1e3 * max(d.largest for d in deviations(tessellate(member.tooth, 0.01)).values())
    return {"triangles": triangles, "error_um": error, "seconds": seconds}


def imports(repeats: int = 10) -> dict[str, float]:
    """(d): seconds of `import x` in fresh processes, best of several."""
    times = {}
    for module in ("numpy", "gearmesh", "gearmesh.tca"):
        code = f"import time; t = time.perf_counter(); import {module}; print(time.perf_counter() - t)"
        runs = [
            subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
            for _ in range(repeats)
        ]
        times[module] = min(float(run.stdout) for run in runs)
    return times


def show(title: str, rows: list[dict[str, Any]]) -> None:
    """A plain table."""
    print(f"\n{title}")
    cells = [list(rows[0]), *([f"{v:.4g}" if isinstance(v, float) else str(v) for v in row.values()] for row in rows)]
    widths = [max(len(row[k]) for row in cells) for k in range(len(cells[0]))]
    for row in cells:
        print("  ".join(cell.rjust(width) for cell, width in zip(row, widths, strict=True)))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("out/bench"))
    parser.add_argument("--quick", action="store_true", help="leave out 0.1 um")
    options = parser.parse_args()
    options.output.mkdir(parents=True, exist_ok=True)

    result: dict[str, Any] = {"tca": contact(5)}
    tca = result["tca"]
    rows = [
        {
            "what": "gearmesh, 201 in one batch",
            "seconds": tca["seconds"],
            "residual_mm": tca["residual_mm"],
            "times": 1.0,
        }
    ]
    rows += [
        {"what": name, "seconds": row["seconds"], "residual_mm": row["residual_mm"], "times": tca["times_faster"][name]}
        for name, row in tca["one_by_one"].items()
    ]
    rows.append(
        {
            "what": "gearmesh, 10000",
            "seconds": tca["seconds_10000"],
            "residual_mm": tca["residual_10000_mm"],
            "times": 0.0,
        }
    )
    show("TCA of the crossed beveloid pair", rows)

    result["meshes"] = meshes(options.quick)
    for sample, table in result["meshes"].items():
        show(f"pinion of {sample}: all teeth", table)
    runs = {
        sample: CostRun(
            *(
                np.array([row[key] for row in table])
                for key in ("error_um", "flank_and_fillet_triangles", "seconds", "fewest_triangles")
            )
        )
        for sample, table in result["meshes"].items()
    }
    plot_cost(options.output / "mesh_cost.png", runs)

    result["solid"] = solid_and_stl(options.output, 5)
    show("helical solid at 10 um, built and written as STL", [result["solid"]])
    result["imports"] = imports()
    show("imports, s", [result["imports"]])
    io.whole_text(options.output / "bench.json", json.dumps(result, indent=1) + "\n")
    print(f"\nwritten: {options.output / 'bench.json'}, {options.output / 'mesh_cost.png'}")


if __name__ == "__main__":
    main()
