#!/usr/bin/env bash
# CalculiX 2.20: a torque on the reference node of a distributing coupling is left out, without a warning, where a kinematic one takes it.
# Expected: a bar fixed at one end; at the other a coupling of the end face to a node, "1,3" as its degrees of freedom, and a
#   force of 30 N and a torque of 100 Nmm (`*CLOAD` on 1 and 6) on that node. Both reach the support, or the load on 6 is refused.
# Seen: with *KINEMATIC the support takes 30 N and 100 Nmm. With *DISTRIBUTING in its place, all else unchanged, it takes 30 N
#   and 0 Nmm; exit code 0, no warning. With "1,6" the torque is there (which *KINEMATIC refuses). The same loss with no
#   degrees of freedom at all below *DISTRIBUTING, as decks for Abaqus have it.
# Versions: calculix-ccx 2.20-1 of Debian 12.
# Meets: whoever puts a torque on a hub or shaft end, and lets go of the rigid end by changing the one word.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get download -q calculix-ccx=2.20-1 libspooles2.2 libarpack2 libblas3 liblapack3 libgfortran5 >apt.log
for package in *.deb; do dpkg -x "$package" root; done
library="$folder/root/usr/lib/$(uname -m)-linux-gnu"
LD_LIBRARY_PATH="$library:$library/blas:$library/lapack" OMP_NUM_THREADS=1 python3 - <<'END'
import subprocess

LENGTH, ELEMENTS, FORCE, TORQUE = 10.0, 5, 30.0, 100.0
SQUARE = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))


def support(coupling):
    """Force along x (N) and torque about the axis (Nmm) that the nodes of the fixed end take, and messages."""
    nodes = [(x, y, LENGTH * k / ELEMENTS) for k in range(ELEMENTS + 1) for x, y in SQUARE] + [(0.0, 0.0, LENGTH)]
    load = len(nodes)
    deck = "*NODE\n" + "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in enumerate(nodes, 1))
    deck += "*ELEMENT, TYPE=C3D8I, ELSET=BAR\n"
    deck += "".join(f"{k + 1}, " + ", ".join(str(4 * k + n) for n in range(1, 9)) + "\n" for k in range(ELEMENTS))
    deck += f"*NSET, NSET=FIXED\n1, 2, 3, 4\n*SURFACE, NAME=END, TYPE=ELEMENT\n{ELEMENTS}, S2\n"
    deck += "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL\n"
    deck += f"*COUPLING, REF NODE={load}, SURFACE=END, CONSTRAINT NAME=HUB\n{coupling}*BOUNDARY\nFIXED, 1, 3\n"
    deck += f"*STEP\n*STATIC\n*CLOAD\n{load}, 1, {FORCE}\n{load}, 6, {TORQUE}\n*NODE PRINT, NSET=FIXED\nRF\n*END STEP\n"
    with open("bar.inp", "w") as file:
        file.write(deck)
    done = subprocess.run(["root/usr/bin/ccx", "bar"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout[-500:] + done.stderr
    force = torque = 0.0
    for line in open("bar.dat"):
        words = line.split()
        if len(words) == 4 and words[0].isdigit():
            x, y, _ = nodes[int(words[0]) - 1]
            force += float(words[1])
            torque += x * float(words[2]) - y * float(words[1])
    print(f"{coupling.split()}: support takes {-force:.3f} N, {-torque:.3f} Nmm; warnings: {done.stdout.count('*WARNING')}")
    return -force, -torque, done.stdout.count("*WARNING")


kinematic, told = support("*KINEMATIC\n1, 3\n"), support("*DISTRIBUTING\n1, 6\n")
assert all(abs(force - FORCE) < 1e-3 and abs(torque - TORQUE) < 1e-3 for force, torque, _ in (kinematic, told))
for lines in ("1, 3\n", ""):
    force, torque, warnings = support("*DISTRIBUTING\n" + lines)
    assert abs(force - FORCE) < 1e-3
    assert abs(torque) < 1e-3, "the torque is taken now"
    assert warnings == 0, "there is a warning now"
END
