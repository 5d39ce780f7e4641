"""Which part of a gear does a model with cyclic symmetry need? A third of it, between two cut faces that follow the teeth.

The double helical gear of double_helical.toml, z 57, as three sectors of 19 pitches, one of them drawn out. Its cut faces go
through the middles of the roots of both halves, and are the same face turned by 120 deg: web, hub and the hole that they cut
fit, too. Three sectors have the volume of the gear to 1e-12. As a file, STL or STEP, or, of one half, as a deck for CalculiX:

    gearmesh solid double_helical.toml --member gear --sector 19 -o sector.stl
    gearmesh fe double_helical.toml --member gear --sector 19 -o sector.inp

    python samples/gear_sector.py [picture.png]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import gearmesh as gm
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import unit
from gearmesh.view.render import render
from gearmesh.view.scene import BRASS_PAINT, STEEL_PAINT, Camera, Scene, SceneBody

DESIGN = Path(__file__).parent / "double_helical.toml"
#: of 57; and how far the sector is drawn out, mm
PITCHES, OUT = 19, 55.0


def main() -> None:
    picture = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("gear_sector.png")
    gears = gm.build(gm.load(DESIGN))
    whole, sector = gears.solid("gear", 0.02), gears.solid("gear", 0.02, sector=PITCHES)
    print(sector)
    count = gears.members["gear"].tooth.teeth // PITCHES
    error = count * sector.mesh.volume() / whole.mesh.volume() - 1.0
    print(f"volume of {count} sectors over that of the gear, less 1: {error:.1e}")

    middle = sector.mesh.vertices.mean(axis=0)
    out = unit(middle * [1.0, 1.0, 0.0])
    bodies = [SceneBody(sector.mesh, Rigid.about_z(2.0 * np.pi * k / count), STEEL_PAINT) for k in range(1, count)]
    bodies.append(SceneBody(sector.mesh, Rigid(np.eye(3), OUT * out), BRASS_PAINT))
    focus, beside = np.array([0.0, 0.0, middle[2]]) + 0.25 * OUT * out, np.cross([0.0, 0.0, 1.0], out)
    position = focus + 900.0 * unit(0.35 * out - 0.75 * beside + np.array([0.0, 0.0, 0.75]))
    camera = Camera(position, focus, np.array([0.0, 0.0, 1.0]), height=290.0)
    render(Scene(tuple(bodies), camera, title="A third of a double helical gear"), picture)


if __name__ == "__main__":
    main()
