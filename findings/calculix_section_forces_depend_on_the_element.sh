#!/usr/bin/env bash
# CalculiX 2.20: forces of `*SECTION PRINT` are not in equilibrium with the loads for C3D20 and C3D8, and are for C3D20R and C3D8I.
# Expected: a cantilever with 30 N across its end has a shear force of 30 N in every section, in any mesh: the nodal forces of
#   the elements are in equilibrium, and Abaqus and others sum those. Reactions are 30 N in all cases.
# Seen: in the middle of a bar 2 x 2 x 10 mm with 2 x 2 x 5 elements: C3D20R and C3D8I 30.0 N, C3D20 40.7 N, C3D8 3.8 N, and C3D8 with
#   three elements 8.5 N of the wrong sign. Stresses are taken from the integration points to the nodes of the face and
#   integrated there. No warning; the error falls with the square of the element's length (2 x 2 x 10: 32.8 and 22.4 N).
# Versions: calculix-ccx 2.20-1 of Debian 12.
# Meets: whoever reads bolt, bearing or tooth forces off a section of C3D20 or C3D8 elements.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get download -q calculix-ccx=2.20-1 libspooles2.2 libarpack2 libblas3 liblapack3 libgfortran5 >apt.log
for package in *.deb; do dpkg -x "$package" root; done
library="$folder/root/usr/lib/$(uname -m)-linux-gnu"
LD_LIBRARY_PATH="$library:$library/blas:$library/lapack" OMP_NUM_THREADS=1 python3 - <<'END'
import subprocess

FORCE, SIZE = 30.0, (2.0, 2.0, 10.0)
CORNERS = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
MIDDLES = [tuple((a + b) // 2 for a, b in zip(CORNERS[first], CORNERS[last])) for first, last in EDGES]


def shear(kind, counts):
    """Shear force (N) that *SECTION PRINT gives in the middle of the bar, and the force on the support."""
    places = CORNERS + (MIDDLES if kind.startswith("C3D20") else [])
    numbers, elements = {}, []
    for i in range(counts[0]):
        for j in range(counts[1]):
            for k in range(counts[2]):
                keys = [(2 * i + a, 2 * j + b, 2 * k + c) for a, b, c in places]
                elements.append((k, [numbers.setdefault(key, len(numbers) + 1) for key in keys]))
    ends = [[n for key, n in numbers.items() if key[2] == level] for level in (0, 2 * counts[2])]
    deck = "*NODE\n"
    for key, n in numbers.items():
        deck += f"{n}, " + ", ".join(f"{size * at / (2 * count):.9f}" for size, at, count in zip(SIZE, key, counts)) + "\n"
    deck += f"*ELEMENT, TYPE={kind}, ELSET=BAR\n"
    for n, (_, nodes) in enumerate(elements, 1):
        words = [str(n)] + [str(node) for node in nodes]
        deck += ", ".join(words[:12]) + (",\n" + ", ".join(words[12:]) if words[12:] else "") + "\n"
    deck += "*NSET, NSET=FIXED\n" + "".join(f"{n},\n" for n in ends[0]) + "*SURFACE, NAME=MIDDLE, TYPE=ELEMENT\n"
    deck += "".join(f"{n}, S1\n" for n, (k, _) in enumerate(elements, 1) if k == counts[2] // 2)
    deck += "*MATERIAL, NAME=STEEL\n*ELASTIC\n200000., 0.3\n*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL\n"
    deck += "*BOUNDARY\nFIXED, 1, 3\n*STEP\n*STATIC\n*CLOAD\n" + "".join(f"{n}, 1, {FORCE / len(ends[1])}\n" for n in ends[1])
    deck += "*NODE PRINT, NSET=FIXED, TOTALS=ONLY\nRF\n*SECTION PRINT, SURFACE=MIDDLE, NAME=CUT\nSOF\n*END STEP\n"
    with open("bar.inp", "w") as file:
        file.write(deck)
    done = subprocess.run(["root/usr/bin/ccx", "bar"], capture_output=True, text=True)
    assert done.returncode == 0 and "*WARNING" not in done.stdout, done.stdout[-500:] + done.stderr
    table = open("bar.dat").read()
    section = -float(table.split("moment about the origin(mx,my,mz)")[1].split()[0])
    reaction = -float(table.split("total force (fx,fy,fz) for set FIXED")[1].split("\n")[2].split()[0])
    print(f"{kind} {counts}: section {section:.2f} N, support {reaction:.2f} N")
    assert abs(reaction - FORCE) < 1e-3
    return section


for kind in ("C3D20R", "C3D8I"):
    assert abs(shear(kind, (2, 2, 5)) - FORCE) < 0.01
assert shear("C3D20", (2, 2, 5)) > 1.3 * FORCE, "sections of C3D20 are in equilibrium now"
assert shear("C3D8", (2, 2, 5)) < 0.2 * FORCE, "sections of C3D8 are in equilibrium now"
assert shear("C3D8", (1, 1, 3)) < 0.0, "sections of C3D8 are in equilibrium now"
assert 1.05 * FORCE < shear("C3D20", (2, 2, 10)) < 1.15 * FORCE
assert 0.7 * FORCE < shear("C3D8", (2, 2, 10)) < 0.8 * FORCE
END
