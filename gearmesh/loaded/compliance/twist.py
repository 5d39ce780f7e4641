"""Twist of a gear's body between its teeth and its bore or rim, in closed form: shear of thin nested rings.

A torque T twists a ring of radius r and width b by  d theta = T dr / (2 pi G b r^3).  ISO 6336-1 counts the stiffness
of teeth without this twist, which the finite elements of `compliance` include.
"""

from __future__ import annotations

import numpy as np

from gearmesh.contact.hertz import Material
from gearmesh.loaded.compliance.compliance import without_web
from gearmesh.mesh.hexahedra.hexahedra import usual_rim, whole_rim
from gearmesh.mesh.hexahedra.layers import layers
from gearmesh.teeth.tooth import Tooth

#: stations along the face at which the body's depth is measured
FACE_STATIONS = np.linspace(0.0, 1.0, 12)


def twist_compliance(tooth: Tooth, material: Material, *, by_rim: bool) -> float:
    """Return rotation over torque, rad/(N mm), of the root circle relative to the bore or the rim's inner face; 0 for a
    sliding bar."""
    if np.isinf(tooth.joint.cycle(tooth.teeth)):
        return 0.0
    whole = without_web(tooth)
    body_depth = (usual_rim if by_rim else whole_rim)(whole, FACE_STATIONS)
    root = float(layers(whole, FACE_STATIONS).base.root.mean())
    inner, outer = sorted((abs(root), abs(root - body_depth)))
    toe, heel = tooth.blank.extent
    face, web = abs(heel - toe), tooth.blank.body.web
    bounds, widths = [inner, outer], [face]
    if web is not None:
        # hub, web and rim
        bounds = [inner, *np.clip([web.inner, web.outer], inner, outer).tolist(), outer]
        widths = [face, web.high - web.low, face]
    ring_terms = 0.5 * (np.array(bounds[:-1]) ** -2.0 - np.array(bounds[1:]) ** -2.0) / np.array(widths)
    shear = 0.5 * material.youngs_modulus / (1.0 + material.poisson_ratio)
    return float(ring_terms.sum() / (2.0 * np.pi * shear))
