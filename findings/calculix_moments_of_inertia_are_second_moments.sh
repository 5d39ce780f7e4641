#!/usr/bin/env bash
# CalculiX 2.20: what `*EL PRINT` with EMAS calls "mass moment of inertia (xx,yy,zz,xy,xz,yz)" are second moments, not moments of inertia.
# Expected: zz is the moment of inertia about the z axis, the integral of x^2 + y^2 over the mass, and xy is that of -x y or x y.
# Seen: zz is the integral of z^2, and so on. Of a shaft (a bar 2 x 2 x 20 mm of steel along z) zz about the centre of gravity
#   is 50 times the true one, and xx a hundredth; of a plate of 4 mm zz is 1/81. Mass, volume and centre of gravity are right.
#   The moment of inertia about z is xx + yy as printed.
# Versions: calculix-ccx 2.20-1 of Debian 12.
# Meets: whoever takes inertias of gears and shafts from a solver's table into a calculation of vibrations or starting.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get download -q calculix-ccx=2.20-1 libspooles2.2 libarpack2 libblas3 liblapack3 libgfortran5 >apt.log
for package in *.deb; do dpkg -x "$package" root; done
library="$folder/root/usr/lib/$(uname -m)-linux-gnu"
LD_LIBRARY_PATH="$library:$library/blas:$library/lapack" OMP_NUM_THREADS=1 python3 - <<'END'
import subprocess

DENSITY = 7.8e-9  # t/mm3


def table(size):
    """Mass (t) and the six numbers (t mm2) about the centre of gravity of a block from the origin, one element."""
    a, b, c = size
    corners = [(x, y, z) for z in (0.0, c) for x, y in ((0.0, 0.0), (a, 0.0), (a, b), (0.0, b))]
    with open("block.inp", "w") as file:
        file.write("*NODE\n" + "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in enumerate(corners, 1)))
        file.write("*ELEMENT, TYPE=C3D8, ELSET=ALL\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n")
        file.write(f"*DENSITY\n{DENSITY}\n*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n*NSET, NSET=FIXED\n1, 2, 3, 4\n")
        file.write("*BOUNDARY\nFIXED, 1, 3\n*STEP\n*STATIC\n*CLOAD\n5, 1, 1.\n*EL PRINT, ELSET=ALL, TOTALS=ONLY\nEMAS\n*END STEP\n")
    done = subprocess.run(["root/usr/bin/ccx", "block"], capture_output=True, text=True)
    assert done.returncode == 0 and "*WARNING" not in done.stdout, done.stdout[-500:] + done.stderr
    text = open("block.dat").read()
    mass = float(text.split("total mass for set")[1].split("\n")[2])
    name = "total mass moment of inertia about the center ofgravity (xx,yy,zz,xy,xz,yz)"
    return mass, [float(word) for word in text.split(name)[1].split("\n")[2].split()]


def alike(values, others):
    return all(abs(value / other - 1.0) < 1e-5 for value, other in zip(values, others))


for size in ((2.0, 2.0, 20.0), (20.0, 30.0, 4.0)):
    mass, printed = table(size)
    assert alike([mass], [DENSITY * size[0] * size[1] * size[2]])
    second = [mass * side**2 / 12.0 for side in size]
    inertia = [sum(second) - own for own in second]
    print(f"block {size}: printed xx, yy, zz {printed[:3]}")
    print(f"    moments of inertia {[float(f'{value:.6e}') for value in inertia]}, second moments {[float(f'{value:.6e}') for value in second]}")
    assert not alike(printed, inertia), "moments of inertia are printed now"
    assert alike(printed, second), "second moments are not printed any more"
END
