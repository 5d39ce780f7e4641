#!/usr/bin/env bash
# yafem 1.1.6: distributed forces on beams are taken and not applied; the analysis converges with all displacements 0.
# Expected: `fa`, `fby`, `fbz` of `beam3d` and `fa`, `fb` of `beam2d` are "axial" and "lateral distributed force". A cantilever of length L under q a mm
#   sags by q L^4 / (8 E I), and stretches by q L^2 / (2 E A).
# Seen: 0, in static and in dynamic analysis, "converged in 1 iterations with residual 0.0". The loads are there, right and consistent, q L / 2 and
#   q L^2 / 12, in the attribute `r` of a new element, and in no result. The same numbers given as forces on nodes (`dofs_f`, `g_f`) give
#   the closed form, so does a force at the end, and elastic foundations (`k0a`, `k0b`), which the help lists beside, count.
# Versions: yafem 1.1.6, numpy 2.4.6, scipy 1.17.1, jax 0.8.3, matplotlib 3.11.2.
# Meets: whoever loads shafts, spindles or housings by their weight, by pressure, or by the load along a face.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q yafem==1.1.6 numpy==2.4.6 scipy==1.17.1 jax==0.8.3 matplotlib==3.11.2
MPLBACKEND=Agg "$folder/venv/bin/python" - <<'END'
from math import pi

import numpy as np
import yafem
from yafem.elem import beam2d, beam3d

LENGTH, YOUNG, SHEAR, DENSITY = 200.0, 210000.0, 81000.0, 7.85e-6
OUTER, WALL, ACROSS, ALONG, STEPS = 20.0, 2.0, 5.0, 3.0, 3
INNER = OUTER - 2.0 * WALL
AREA, INERTIA = pi / 4.0 * (OUTER**2 - INNER**2), pi / 64.0 * (OUTER**4 - INNER**4)


def cantilever(kind, forces=(), dynamic=False, **loads):
    """Displacements of the free end along x and y at the last step, and the loads that the new element holds; forces: (freedom, force) there."""
    plane = kind is beam2d
    nodes = yafem.nodes({"nodal_data": np.array([[1, 0, 0], [2, LENGTH, 0]] if plane else [[1, 0, 0, 0], [2, LENGTH, 0, 0]], float)})
    section = {"A": AREA, "I": INERTIA} if plane else {"D1": OUTER, "D2": OUTER, "H": WALL}
    beam = kind(nodes, {"nodal_labels": [1, 2], "E": YOUNG, "G": SHEAR, "rho": DENSITY, **section, **loads})
    held = np.ravel(beam.r).copy()
    settings = {"step": STEPS, "dt": 1e-3, "dofs_c": np.array([[1, freedom] for freedom in range(1, 4 if plane else 7)], np.int32)}
    if forces:
        settings["dofs_f"] = np.array([[2, freedom] for freedom, _ in forces], np.int32)
        settings["g_f"] = np.array([[force] * STEPS for _, force in forces])
    run = yafem.simulation(yafem.model(nodes, [beam], settings))
    (run.dynamic_analysis if dynamic else run.static_analysis)(output=False)
    return run.u[0, -1], run.u[1, -1], held


sag, stretch = ACROSS * LENGTH**4 / (8.0 * YOUNG * INERTIA), ALONG * LENGTH**2 / (2.0 * YOUNG * AREA)
for kind, loads in ((beam3d, {"fa": ALONG, "fby": ACROSS}), (beam2d, {"fa": ALONG, "fb": ACROSS})):
    at_nodes = ((1, ALONG * LENGTH / 2.0), (2, ACROSS * LENGTH / 2.0), (3 if kind is beam2d else 6, -ACROSS * LENGTH**2 / 12.0))
    x, y, _ = cantilever(kind, at_nodes)
    print(f"{kind.__name__}: closed form {stretch:.6f} and {sag:.4f} mm, as forces on the node {x:.6f} and {y:.4f}")
    assert abs(x / stretch - 1.0) < 1e-6 and abs(y / sag - 1.0) < 1e-6
    assert 0.0 < cantilever(kind, at_nodes, k0b=3.0)[1] < 0.9 * sag
    for dynamic in (False, True):
        x, y, held = cantilever(kind, dynamic=dynamic, **loads)
        print(f"  as distributed forces, {'dynamic' if dynamic else 'static'}: {x:.6f} and {y:.4f}; in the element {np.round(held, 1)}")
        end = len(held) // 2
        assert np.allclose((held[end], held[end + 1], held[-1]), [force for _, force in at_nodes])
        assert x == 0.0 and y == 0.0, "distributed forces are applied now"
END
