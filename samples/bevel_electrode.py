"""What does the electrode for the spaces of a bevel gear look like? The space between two teeth as a solid, less a spark gap.

Electrode and gear of spiral_bevel_basic.toml: the space between two teeth with its flanks, fillets and root moved by the spark
gap of 0.15 mm along their exact normals, lifted along the normal of the tip cone. As a file, STL or STEP:

    gearmesh solid spiral_bevel_basic.toml --member gear --space --offset 0.15mm -o electrode.stl

    python samples/bevel_electrode.py [picture.png]
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

DESIGN = Path(__file__).parent / "spiral_bevel_basic.toml"
#: spark gap and how far the electrode is lifted, mm
SPARK_GAP, LIFT = 0.15, 14.0


def main() -> None:
    picture = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("bevel_electrode.png")
    gears = gm.build(gm.load(DESIGN))
    gear = gears.solid("gear", 0.02)
    electrode = gears.solid("gear", 0.005, space=True, offset=SPARK_GAP)
    print(electrode)

    middle = electrode.mesh.vertices.mean(axis=0)
    out = unit(gears.members["gear"].tooth.blank.tip.gradient(middle))
    round_axis = unit(np.cross([0.0, 0.0, 1.0], middle))
    along = np.cross(round_axis, out)
    focus = middle + 0.45 * LIFT * out
    bodies = (
        SceneBody(gear.mesh, Rigid.identity(), STEEL_PAINT),
        SceneBody(electrode.mesh, Rigid(np.eye(3), LIFT * out), BRASS_PAINT),
    )
    position = focus + 400.0 * unit(0.75 * out + 0.95 * along + 0.45 * round_axis)
    camera = Camera(position, focus, out, height=62.0)
    render(Scene(bodies, camera, title="Electrode for a spiral bevel gear"), picture)


if __name__ == "__main__":
    main()
