#!/usr/bin/env bash
# anyfileio 0.3.2: participation factors and modal masses of CalculiX count as natural frequencies, and elements of 20 nodes as two.
# Expected: `frequencies_hz` of a `.dat` file has one frequency a mode. `read_nodes_and_element_count` counts the elements of a deck.
# Seen: for four modes there are 12 numbers: the frequencies, 2059 and 12919 Hz twice, then eight from the tables "PARTICIPATION FACTORS" and
#   "EFFECTIVE MODAL MASS" below, which the solver always prints: their column of the rotation about z comes down to 1e-36 and can be
#   negative. The smallest frequency and the range of the modes are no frequencies. A C3D20 stands on two lines, since a line takes 16
#   entries, and each line counts: the bar of ten has 20 elements, of C3D8 ten. Buckling factors and fields are right. No warning.
# Versions: anyfileio 0.3.2, numpy 2.4.6; calculix-ccx 2.20-1 of Debian 12.
# Meets: whoever compares natural frequencies of gears and housings with speeds, or checks decks by their counts.
set -e
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
apt-get download -q calculix-ccx=2.20-1 libspooles2.2 libarpack2 libblas3 liblapack3 libgfortran5 >apt.log
for package in *.deb; do dpkg -x "$package" root; done
python3 -m venv venv
venv/bin/pip install -q ANYfileio==0.3.2 numpy==2.4.6
library="$folder/root/usr/lib/$(uname -m)-linux-gnu"
LD_LIBRARY_PATH="$library:$library/blas:$library/lapack" OMP_NUM_THREADS=1 venv/bin/python - <<'END'
import subprocess

from anyfileio import parse_dat
from anyfileio.calculix import read_nodes_and_element_count

ELEMENTS, LENGTH = 10, 20.0
CORNERS = ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))


def bar(name, kind, step):
    """Bar of 1 x 1 x 20 mm, fixed at one end; C3D20 has its mid-side nodes in the order of the solver."""
    numbers, nodes, elements = {}, [], []
    for k in range(ELEMENTS):
        low, high = ([(x, y, LENGTH * (k + up) / ELEMENTS) for x, y in CORNERS] for up in (0, 1))
        points = low + high
        if kind == "C3D20":
            edges = [(a, (a + 1) % 4) for a in range(4)] + [(4 + a, 4 + (a + 1) % 4) for a in range(4)] + [(a, a + 4) for a in range(4)]
            points += [tuple((p + q) / 2.0 for p, q in zip(points[a], points[b])) for a, b in edges]
        for point in points:
            if point not in numbers:
                numbers[point] = len(numbers) + 1
                nodes.append(f"{numbers[point]}, {point[0]}, {point[1]}, {point[2]}\n")
        entries = [k + 1, *(numbers[point] for point in points)]
        lines = [entries[start : start + 15] for start in range(0, len(entries), 15)]
        elements.append(",\n".join(", ".join(map(str, line)) for line in lines) + "\n")
    fixed = ",\n".join(str(number) for point, number in numbers.items() if point[2] == 0.0)
    with open(f"{name}.inp", "w") as file:
        file.write("*NODE\n" + "".join(nodes) + f"*ELEMENT, TYPE={kind}, ELSET=BAR\n" + "".join(elements) + f"*NSET, NSET=FIXED\n{fixed}\n")
        file.write("*MATERIAL, NAME=STEEL\n*ELASTIC\n200000., 0.3\n*DENSITY\n7.8e-9\n*SOLID SECTION, ELSET=BAR, MATERIAL=STEEL\n")
        file.write("*BOUNDARY\nFIXED, 1, 3\n" + step)
    done = subprocess.run(["root/usr/bin/ccx", name], capture_output=True, text=True)
    assert done.returncode == 0 and "*ERROR" not in done.stdout, done.stdout[-500:] + done.stderr


bar("first", "C3D8I", "*STEP\n*FREQUENCY\n4\n*END STEP\n")
bar("second", "C3D20", "*STEP\n*BUCKLE\n4\n*DLOAD\nBAR, P2, 1.0\n*END STEP\n")
found = parse_dat("first.dat").frequencies_hz
printed = [line.split() for line in open("first.dat") if line.split()[:1] and line.split()[0] in "1234" and len(line.split()) == 5]
solved = [float(row[3]) for row in printed]
counts = {name: read_nodes_and_element_count(f"{name}.inp")[1] for name in ("first", "second")}
factors = parse_dat("second.dat").buckling_factors
print(f"frequencies of the solver {solved}\nfrequencies_hz {found}\nelements {counts}, buckling factors {len(factors)}")
assert len(solved) == 4 and found[:4] == solved and abs(solved[0] - 2059.0) < 20.0
assert len(factors) == 4 and counts["first"] == ELEMENTS
assert len(found) == 12 and min(found) < 1e-6, "frequencies are those of the modes alone now"
assert counts["second"] == 2 * ELEMENTS, "elements of 20 nodes count once now"
END
