#!/usr/bin/env bash
# CalculiX 2.20: effective modal masses that `*FREQUENCY` prints for C3D8I are nine times too large: more than the body has.
# Expected: their sum over all modes is the mass that can move, at most the mass of the body; the first bending mode of a cantilever
#   has 0.61 of it. For C3D8, C3D20 and C3D20R that is so.
# Seen: for a bar of ten C3D8I the first mode has 5.5 times the mass of the bar, and the "total effective mass" is 8.7 times the
#   mass. Participation factors are three times too large. The first frequency is right to 1 % (C3D8 is 64 % too high), and so are
#   weight and centrifugal force of the same elements. No warning.
# Versions: calculix-ccx 2.20-1 of Debian 12.
# Meets: whoever takes forces of an excited support or a reduced model of a housing, shaft or gear from these tables.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get download -q calculix-ccx=2.20-1 libspooles2.2 libarpack2 libblas3 liblapack3 libgfortran5 >apt.log
for package in *.deb; do dpkg -x "$package" root; done
library="$folder/root/usr/lib/$(uname -m)-linux-gnu"
LD_LIBRARY_PATH="$library:$library/blas:$library/lapack" OMP_NUM_THREADS=1 python3 - <<'END'
import subprocess

ELEMENTS, LENGTH, MODES = 10, 20.0, 20
MASS = 7.8e-9 * LENGTH  # t, section 1 mm2
SQUARE = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))


def masses(kind):
    """Effective mass along x of the first mode, of all modes asked for, and the total, each over the mass of the bar."""
    nodes = [(x, y, LENGTH * k / ELEMENTS) for k in range(ELEMENTS + 1) for x, y in SQUARE]
    deck = "*NODE\n" + "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in enumerate(nodes, 1))
    deck += f"*ELEMENT, TYPE={kind}, ELSET=BAR\n"
    deck += "".join(f"{k + 1}, " + ", ".join(str(4 * k + n) for n in range(1, 9)) + "\n" for k in range(ELEMENTS))
    deck += "*NSET, NSET=FIXED\n1, 2, 3, 4\n*MATERIAL, NAME=STEEL\n*ELASTIC\n200000., 0.3\n*DENSITY\n7.8e-9\n"
    deck += "*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL\n*BOUNDARY\nFIXED, 1, 3\n"
    deck += f"*STEP\n*FREQUENCY\n{MODES}\n*END STEP\n"
    with open("bar.inp", "w") as file:
        file.write(deck)
    done = subprocess.run(["root/usr/bin/ccx", "bar"], capture_output=True, text=True)
    assert done.returncode == 0 and "*WARNING" not in done.stdout, done.stdout[-500:] + done.stderr
    table, total = open("bar.dat").read().split("E F F E C T I V E   M O D A L   M A S S")[1].split("T O T A L   E F F E C T I V E   M A S S")
    rows = [line.split() for line in table.splitlines() if len(line.split()) == 7]
    modes = [(float(row[1]) + float(row[2])) / 2.0 / MASS for row in rows if row[0].isdigit()]
    whole = float(total.split("Z-ROTATION")[1].split()[0]) / MASS
    # the bar is square: bending along x and along y have the same frequency and share their mass at random
    first, found = modes[0] + modes[1], sum(modes)
    frequency = float(next(line.split()[3] for line in open("bar.dat") if line.split()[:1] == ["1"] and len(line.split()) == 5))
    print(f"{kind}: {frequency:.0f} Hz; effective mass of the first mode {first:.3f}, of {MODES} modes {found:.3f}, total {whole:.3f} of the bar's mass")
    return first, found, whole


first, found, whole = masses("C3D8")
assert 0.55 < first < 0.65 and 0.8 < found < whole < 1.0
first, found, whole = masses("C3D8I")
assert found < whole
assert first > 4.0 and whole > 5.0, "modal masses of C3D8I are right now"
END
