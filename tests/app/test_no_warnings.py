"""No command warns of arithmetic on its way: warnings of NumPy are errors in all tests, so each run here ends by its own status."""

from __future__ import annotations

import zlib
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from oracles.command_line import run
from oracles.places import SAMPLES

CORPUS = Path(__file__).parents[1] / "corpus"
#: commands with what makes them short; {member} is the first member of the design
LIGHT = {
    "describe": "describe {design}",
    "tca": "tca {design} --torque 20 --ease-off {folder}/a.json",
    "limits": "limits {design}",
    "prove": "prove {design}",
    "drawing": "drawing {design} --member {member} -o {folder}/a.svg",
    "section": "solid {design} --member {member} -o {folder}/a.dxf --curves arcs --tol 50um",
    "grid": "grid {design} --member {member} -o {folder}/a.csv --surface all",
    "topography": "topography {design} --member {member} --flank left -o {folder}/a.csv",
    "settings": "settings {design}",
    "compensate": "settings {design} --compensate --set assembly.dC=0.02",
    "pin": "pin {design} -o {folder}/a.toml",
    "convert": "convert {design} -o {folder}/a.rexs",
    "composite": "composite {design}",
    "freecad": "freecad {design} -o {folder}/a.FCMacro --tol 200um",
    "render": "render {design} -o {folder}/a.svg --view te",
}
HEAVY = {
    "check": "check {design} --tol 200um",
    "step": "solid {design} --member {member} -o {folder}/a.step --tol 200um",
    "load": "load {design} --torque 20 --phi1 0",
    "fe": "fe {design} -o {folder}/a.inp --teeth 1 --set fe.flank=5 --set fe.face=6",
    "toolpath": "toolpath {design} --member {member} --tool ball:2 --scallop 50um -o {folder}/a.csv",
}
#: teeth that are only compressed have no bending stress
COMPRESSED = ("load", SAMPLES / "cycloidal.toml")
#: designs of which each heavy command gets as many of the samples and of the corpus
OF_SAMPLES, OF_CORPUS = 4, 1


def _chosen(command: str, designs: list[Path], count: int) -> list[Path]:
    """Some designs, the same for a command whatever else there is."""
    return sorted(designs, key=lambda path: zlib.crc32(f"{command} {path.stem}".encode()))[:count]


def _cases() -> list[tuple[str, Path]]:
    samples, corpus = sorted(SAMPLES.glob("*.toml")), sorted(CORPUS.glob("*.toml"))
    cases = [(command, design) for command in LIGHT for design in (*samples, *_chosen(command, corpus, OF_CORPUS))]
    for command in HEAVY:
        cases += [(command, design) for design in _chosen(command, samples, OF_SAMPLES)]
        cases += [(command, design) for design in _chosen(command, corpus, OF_CORPUS)]
    return list(dict.fromkeys([*cases, COMPRESSED]))


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("command", "design"), [pytest.param(*case, id=f"{case[0]}-{case[1].stem}") for case in _cases()]
)
def test_no_command_warns_of_arithmetic(
    command: str, design: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("gearmesh.view.opengl.missing_opengl_message", lambda: "no pictures here")
    monkeypatch.setattr(Figure, "savefig", lambda self, file, **_: Path(file).write_bytes(b"drawn"))
    text = design.read_text(encoding="utf-8")
    member = next(name for name in ("pinion", "sun", "worm", "gear") if f"[{name}" in text or name == "gear")
    line = {**LIGHT, **HEAVY}[command]
    arguments = [part.format(design=design, folder=tmp_path, member=member) for part in line.split()]
    status, out, err = run(*arguments, "--set", "contact.phi1.count=3")
    # what a kind has not is refused, what jams or has no contact ends with 3
    assert status in (0, 2, 3), err
    assert out or err or any(tmp_path.iterdir())
