"""The pictures of samples/README.md and README.md, made anew by the program itself. Needs OpenGL (see README.md).

Usage: python scripts/gallery.py [NAME ...] [-o FOLDER]

Each picture is drawn three times as large as it is kept, then scaled down to 480 x 360, but for LARGE ones, and written with
160 greys and 64 colours, chosen apart: in a common palette the few red pixels of a path of contact would be lost. That makes
15 to 50 kB of it.
Without NAME all pictures are made (four minutes); a NAME is a file name without its suffix.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
SAMPLES = ROOT / "samples"
PICTURES = SAMPLES / "pictures"
SIZE = (480, 360)
GREYS, COLOURS = 160, 64
#: greys of a drawing or diagram, which has lines alone
LINE_GREYS = 15
#: saturation (0 to 255) from which a pixel is coloured, not grey
COLOURED = 90
#: one design of each gear system, shown as a pair in its folder's README.md, and the tolerance of its meshes, about 50 um
PAIRS = {
    "internal": 0.02,
    "double_helical": 0.02,
    "helical_hub": 0.02,
    "planetary": 0.02,
    "rack": 0.02,
    "beveloid_crossed": 0.05,
    "circular_arc": 0.002,
    "novikov": 0.05,
    "face_gear": 0.05,
    "straight_bevel": 0.01,
    "spiral_bevel_basic": 0.05,
    "hypoid": 0.05,
    "worm_drive": 0.05,
    "cycloidal": 0.01,
    "spline": 0.01,
}
#: members whose tooth is shown, for designs that do not show the first member's
MEMBERS = {"worm_drive": "wheel", "worm_drive_dual_lead": "wheel", "worm_drive_zk_oversize": "wheel"}
#: figures that are read, not only looked at
LARGE = {"bevel_machine_frames": (800, 900), "te_under_torque": (880, 660)}
#: designs whose flanks are shown in their planes, and how large
PLANES = ("spiral_bevel_basic", "circular_arc", "face_gear")
PLANE = (900, 600)
#: torques (Nm) under which flanks of a design are shown, and the torque of the picture of its tooth
LOADED = {"spiral_bevel_basic": ("20,60,150", "60")}
#: designs of which the pattern is shown in marking compound
MARKED = ("spiral_bevel_basic",)
#: designs of which a member is shown with its tool
TOOLS = {"spiral_bevel_basic": "gear", "cyclo_palloid": "gear"}
#: designs of which a member is shown with its grinding worm
GROUND = ("face_gear",)
#: designs of which the tool of a member is shown with its lines of contact
TOUCHED = {"face_gear": "gear"}
#: designs of which a member has a workshop drawing: its name and keys set anew; and how large that is
DRAWINGS = {
    "helical": (
        "pinion",
        *("pinion.bore=30", "pinion.keyway={width=8, depth=3.3}", "pinion.hub={diameter=50, length=15}"),
        *('pinion.thickness_allowance="cd25"', 'pinion.tip_diameter_tolerance="h8"', "accuracy_class=7"),
        'assembly.center_distance_allowance="js7"',
    )
}
SHEET = (1260, 891)
#: designs of which a member is finished by a ball-end cutter: its name, the cutter, and the scallop
CUT = {"spiral_bevel_basic": ("pinion", "ball:1.2mm,20mm", "20um")}
DRAWN = "1440x1080"
GEARMESH = (sys.executable, "-m", "gearmesh")


@dataclass(frozen=True)
class Picture:
    """Command that draws a picture; {to} in it stands for the file that it writes."""

    name: str
    command: tuple[str, ...]
    size: tuple[int, int] = SIZE
    greys: int = GREYS


def rendered(name: str, sample: str, *options: str) -> Picture:
    """Return the picture of a sample by the command `render`."""
    design = f"{SAMPLES / sample}.toml"
    return Picture(name, (*GEARMESH, "render", design, "-o", "{to}", "--size", DRAWN, *options))


def tooth(sample: str) -> Picture:
    """The first member's tooth of a sample, or that of `MEMBERS`, with its contact."""
    return rendered(sample, sample, *(("--member", MEMBERS[sample]) if sample in MEMBERS else ()))


def pair(sample: str) -> Picture:
    """A sample's gears in mesh."""
    return rendered(f"{sample}_pair", sample, "--view", "pair", "--set", f"mesh.tolerance={PAIRS[sample]}")


def plane(sample: str) -> Picture:
    """The flanks of a sample in their planes, with the ease-off."""
    drawn = rendered(f"{sample}_flank", sample, "--view", "flank")
    larger = (*drawn.command, "--size", "{}x{}".format(*(2 * n for n in PLANE)))
    return replace(drawn, command=larger, size=PLANE, greys=LINE_GREYS)


def tool(sample: str, member: str, view: str = "tool") -> Picture:
    """A member of a sample with the tool that cuts it, or another view of that."""
    return rendered(f"{sample}_{view}", sample, "--view", view, "--member", member)


def loaded(sample: str, torques: str, one: str) -> list[Picture]:
    """The largest pressures on the pinion's tooth of a sample under a torque, and on the flanks under several."""
    on_tooth = rendered(f"{sample}_loaded", sample, "--view", "loaded", "--torque", one)
    flanks = (
        *GEARMESH,
        "render",
        f"{SAMPLES / sample}.toml",
        "-o",
        "{to}",
        "--view",
        "loaded_flank",
        "--torque",
        torques,
    )
    return [on_tooth, Picture(f"{sample}_loaded_flank", flanks, PLANE)]


def drawing(sample: str, member: str, *settings: str) -> Picture:
    """The workshop drawing of a member of a sample."""
    options = [word for setting in settings for word in ("--set", setting)]
    design = f"{SAMPLES / sample}.toml"
    command = (*GEARMESH, "drawing", design, "--member", member, "-o", "{to}", *options)
    return Picture(f"{sample}_drawing", command, SHEET, LINE_GREYS)


def tool_path(sample: str, member: str, cutter: str, scallop: str) -> Picture:
    """The passes of a ball-end cutter in a space of a member of a sample."""
    asked = ("--member", member, "--tool", cutter, "--scallop", scallop, "-o", "{to}")
    return Picture(f"{sample}_toolpath", (*GEARMESH, "toolpath", f"{SAMPLES / sample}.toml", *asked), (640, 480))


def figure(script: str) -> Picture:
    """The figure that a sample script draws."""
    command = (sys.executable, f"{SAMPLES / script}.py", "{to}")
    return Picture(script, command, LARGE.get(script, SIZE), LINE_GREYS if script in LARGE else GREYS)


def gallery() -> list[Picture]:
    """All pictures: a tooth for each design, a figure for each script, the pairs, flanks in their planes, tools and their paths,
    drawings."""
    designs = sorted(path.stem for path in SAMPLES.glob("*.toml"))
    scripts = sorted(path.stem for path in SAMPLES.glob("*.py"))
    tools = [tool(*each) for each in TOOLS.items()] + [tool(*each, "contact_lines") for each in TOUCHED.items()]
    tools += [replace(tool(sample, "worm"), name=f"{sample}_worm") for sample in GROUND]
    marked = [rendered(f"{each}_compound", each, "--view", "pattern", "--look", "compound") for each in MARKED]
    under_load = [picture for sample, torques in LOADED.items() for picture in loaded(sample, *torques)]
    paths = [tool_path(sample, *rest) for sample, rest in CUT.items()]
    drawings = [drawing(sample, *rest) for sample, rest in DRAWINGS.items()]
    return [
        *map(tooth, designs),
        *map(figure, scripts),
        *map(pair, PAIRS),
        *map(plane, PLANES),
        *tools,
        *marked,
        *under_load,
        *drawings,
        *paths,
    ]


def make(picture: Picture, folder: Path) -> Path:
    """Run the command, and write what it drew, small."""
    target = folder / f"{picture.name}.png"
    with tempfile.TemporaryDirectory() as to:
        drawn = Path(to) / "picture.png"
        command = [str(drawn) if word == "{to}" else word for word in picture.command]
        subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
        shrink(drawn, target, picture.size, picture.greys)
    return target


def shrink(drawn: Path, target: Path, size: tuple[int, int], greys: int = GREYS) -> None:
    """Scale a picture down into a size, keeping its proportions on white, and reduce its colours."""
    from PIL import Image, ImageOps

    with Image.open(drawn) as image:
        small = ImageOps.pad(image.convert("RGB"), size, method=Image.Resampling.LANCZOS, color="white")
    painted(small, greys).save(target, optimize=True)


def painted(picture: Any, greys: int = GREYS) -> Any:
    """A picture in so many `greys` chosen from its grey pixels and COLOURS from the coloured ones, each pixel in the nearest."""
    import numpy as np
    from PIL import Image

    pixels = np.asarray(picture).reshape(-1, 3)
    coloured = np.asarray(picture.convert("HSV")).reshape(-1, 3)[:, 1] > COLOURED
    kinds = (
        (pixels[~coloured], greys, Image.Quantize.MEDIANCUT),
        (pixels[coloured], COLOURS, Image.Quantize.MAXCOVERAGE),
    )
    chosen = [
        Image.fromarray(part[None]).quantize(count, method=method).getpalette()[: 3 * count]
        for part, count, method in kinds
        if len(part)
    ]
    colours = np.concatenate([[255, 255, 255], *chosen]).reshape(-1, 3)
    distinct, place = np.unique(pixels, axis=0, return_inverse=True)
    nearest = ((distinct[:, None].astype(int) - colours) ** 2).sum(axis=-1).argmin(axis=1)
    result = Image.fromarray(nearest[place].reshape(picture.size[::-1]).astype(np.uint8))
    result.putpalette(colours.ravel().tolist())
    return result


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("-o", "--output", type=Path, default=PICTURES)
    options = parser.parse_args()
    pictures = gallery()
    unknown = set(options.names) - {picture.name for picture in pictures}
    if unknown:
        parser.error(f"no such picture: {', '.join(sorted(unknown))}")
    options.output.mkdir(parents=True, exist_ok=True)
    for picture in pictures:
        if not options.names or picture.name in options.names:
            target = make(picture, options.output)
            print(f"{target.name}: {target.stat().st_size / 1000:.0f} kB", flush=True)


if __name__ == "__main__":
    main()
