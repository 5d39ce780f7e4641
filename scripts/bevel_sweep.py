"""Twenty spiral bevel pairs from basic data only: are all forty members valid solids, and does contact converge on both sides?

Usage: python scripts/bevel_sweep.py [--tol UM]

Prints one line a pair; exit 1 if a member is not a proved solid or a position of contact is not found.
"""

from __future__ import annotations

import argparse
import sys
import time

import numpy as np

import gearmesh as gm

TEETH = ((10, 41), (13, 44), (15, 30), (20, 20), (24, 24))
SPIRAL_ANGLES = (0, 20, 35, 45)


def design(teeth: tuple[int, int], spiral_angle: float, side: str) -> gm.Design:
    return gm.parse(
        {
            "kind": "spiral_bevel",
            "module": 4.0,
            "spiral_angle": spiral_angle,
            "pinion": {"teeth": teeth[0]},
            "gear": {"teeth": teeth[1]},
            "contact": {"side": f"pinion_{side}"},
        }
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tol", type=float, default=20.0, help="tolerance of the solids, micrometres")
    tolerance = 1e-3 * parser.parse_args().tol
    failures = 0
    print(
        "teeth   beta  member  triangles  proved   side     positions  residual mm   TE arcsec  contact ratio  seconds"
    )
    for teeth in TEETH:
        for spiral_angle in SPIRAL_ANGLES:
            started = time.perf_counter()
            name = f"{teeth[0]}/{teeth[1]}   {spiral_angle:3d}"
            try:
                for side in ("concave", "convex"):
                    gears = gm.build(design(teeth, spiral_angle, side))
                    found = gears.contact().summary
                    good = found["converged"] == found["positions"] and found["max_residual_mm"] < 1e-9
                    failures += not good
                    print(
                        f"{name}  {'':27s} {side:8s} {found['converged']:3d} of {found['positions']}   "
                        f"{found['max_residual_mm']:.1e}   {found['mesh_te_peak_to_peak_arcsec']:9.2f}  "
                        f"{found['contact_ratio']:9.3f}{'' if good else '  FAILED'}"
                    )
                for member, gear in gears.members.items():
                    solid = gears.solid(member, tolerance)
                    off = abs(solid.figures["volume_mm3"] / gear.tooth.volume() - 1.0)
                    good = solid.figures["watertight"] and bool(np.isfinite(off)) and off < 0.01
                    failures += not good
                    print(
                        f"{name}  {member:6s} {solid.figures['triangles']:9d}   {good!s:5s}   volume off by {off:.1e}"
                        f"{'' if good else '  FAILED'}"
                    )
            except gm.GearmeshError as error:
                failures += 1
                print(f"{name}  FAILED: {error}")
            print(f"{name}  {time.perf_counter() - started:.2f} s", flush=True)
    print(f"{failures} failures")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
