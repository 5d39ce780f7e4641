#!/usr/bin/env bash
# pygritbx 1.1.4: contact stress of a spur pair is 0.56 times what its own equation gives, and thrust of helical gears ignores the sense of torque.
# Expected: the pitting stress of AGMA 2101 with the geometry factor I = cos(phi) sin(phi) / (2 m_N) * i / (i + 1), where m_N is
#   1 for spur gears and p_n cos(phi) / (0.95 Z) for helical ones; Z is the path of contact, sums of roots of r_a^2 - r_b^2 less
#   (r1 + r2) sin(phi_t). A torque of the other sense turns tangential and axial forces round.
# Seen: Z is taken from roots of r^2 + h_a^2, the limit (r1 + r2) sin(phi_t) is always the smaller one, and Z becomes that limit:
#   30.8 mm for 14.5 mm at 20/40 teeth, module 3. Spur gears get an m_N below 1 too (0.309): I is 0.346 for 0.107. The base helix angle
#   uses the normal pressure angle (18.882 for 18.747 deg). With the torque turned round only the tangential force is. No warning.
# Versions: pygritbx 1.1.4, numpy 2.4.6, scipy 1.17.1, matplotlib 3.11.2.
# Meets: whoever checks pitting, or bearings of a shaft that is driven both ways: safety against pitting is 1.8 times too large.
set -eo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install -q pygritbx==1.1.4 numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2
cd "$folder"
"$folder/venv/bin/python" - <<'END' | grep helix
import builtins

import numpy as np
import pygritbx as pg

# it asks at the terminal whether to go on; reactions are not looked at
builtins.input = lambda question="": "n" if "reaction" in question else "y"
AXIS, ACROSS, TEETH, MODULE, FACE_WIDTH = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0]), (20, 40), 3.0, 30.0
BENDING = {
    **dict(powerSource="Uniform", drivenMachine="Uniform", dShaft=25, Ce=1, teethCond="uncrowned teeth", lShaft=100),
    **dict(useCond="Commercial, enclosed units", sigma_FP=400, b_YN=1.3558, e_YN=-0.0178, N=1e8, temp=60, rel=0.99),
}


def solved(helix, sense):
    steel = pg.Material("Steel", 900, 700, 400, 300)
    motor = pg.Motor("motor", loc=[0.0, 0.0, -50.0], power=5000.0, n=1000.0, axis=sense * AXIS)
    pinion, gear = (
        pg.Gear(name, axis=AXIS, loc=50.0, m_n=MODULE, z=z, psi=psi, phi_n=20.0, Q_v=7, FW=FACE_WIDTH, material=steel)
        for name, z, psi in zip(("pinion", "gear"), TEETH, (helix, -helix))
    )
    shaft = pg.Shaft("shaft", inputs=[motor], outputs=[pinion], axis=AXIS, material=steel, loc=[0.0, 0.0, 0.0])
    mesh = pg.GearMesh("mesh", pinion, gear, radiality=np.array([ACROSS]))
    shaft.solve()
    pinion.analyseGearToothBending(mesh=mesh, **BENDING)
    pinion.calculateSigmaMaxPitting(mesh=mesh, Z_R=1)
    return pinion, mesh


def geometry_factor(helix):
    normal, slope = np.radians(20.0), np.radians(helix)
    alpha = np.arctan(np.tan(normal) / np.cos(slope))
    radii = 0.5 * MODULE / np.cos(slope) * np.array(TEETH)
    path = np.sqrt((radii + MODULE) ** 2 - (radii * np.cos(alpha)) ** 2).sum() - radii.sum() * np.sin(alpha)
    sharing = np.pi * MODULE * np.cos(normal) / (0.95 * path) if helix else 1.0
    ratio = TEETH[1] / TEETH[0]
    return np.cos(alpha) * np.sin(alpha) / (2.0 * sharing) * ratio / (ratio + 1.0)


for helix in (0.0, 20.0):
    (pinion, mesh), (_, reverse) = solved(helix, 1), solved(helix, -1)
    wanted = geometry_factor(helix)
    stress = pinion.sigma_max_pitting
    print(f"helix {helix:4.1f} deg: I {pinion.Z_I:.4f}, should be {wanted:.4f}; contact stress {stress:.1f} MPa, should be "
          f"{stress * np.sqrt(pinion.Z_I / wanted):.1f}; tangential {mesh.F_t.force[1]:.1f} and {reverse.F_t.force[1]:.1f} N, "
          f"axial {mesh.F_a.force[2]:.1f} and {reverse.F_a.force[2]:.1f} N")
    assert pinion.Z_I > 2.0 * wanted, "the geometry factor is another one now"
    assert np.allclose(mesh.F_t.force, -reverse.F_t.force)
    assert np.allclose(mesh.F_a.force, reverse.F_a.force), "the axial force turns round with the torque now"
END
