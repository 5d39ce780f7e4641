"""Every flank carries what made it; the teeth know tools by what they answer alone."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import (
    Dimension,
    Envelope,
    GeneratedSurface,
    Jet,
    MachineAxis,
    MotionState,
    RackRoll,
    Side,
    Surface,
    ToolDescription,
    ToothSide,
)
from gearmesh.teeth.generation.contact_lines import tool_contact
from gearmesh.teeth.generation.tool_in_place import tool_in_place
from gearmesh.teeth.limits import fewest_teeth, member_limits
from gearmesh.tools.description import HeightZero
from gearmesh.tools.drawing import DrawnPlace, DrawnSide, ToolSheet

#: one sample of every kind, and of every tool: names of the tools of pinion and gear
TOOLS = {
    "helical": ("rack cutter", "rack cutter"),
    "internal": ("rack cutter", "shaper"),
    "rack": ("rack cutter", "planing tool"),
    "planetary": ("rack cutter", "rack cutter"),
    "beveloid_crossed": ("rack cutter", "rack cutter"),
    "circular_arc": ("rack cutter", "rack cutter"),
    "novikov": ("grinding worm", "rack cutter"),
    "modified_involute": ("grinding worm", "rack cutter"),
    "face_gear": ("rack cutter", "shaper"),
    "spiral_bevel_basic": ("head cutter", "head cutter"),
    "spiral_bevel_formate": ("head cutter", "head cutter"),
    "hypoid": ("head cutter", "head cutter"),
    "spiral_bevel_geometry1": ("head cutter", "head cutter"),
}


@pytest.mark.sweep_cases(
    "spiral_bevel_formate", "circular_arc", "hypoid", "internal", "modified_involute", "novikov", "planetary"
)
@pytest.mark.parametrize("sample", TOOLS)
def test_flanks_of_every_kind_say_what_made_them(sample: str) -> None:
    pair = gm.build(gm.load(SAMPLES / f"{sample}.toml")).train.pairs[0]
    for member, name in zip(pair.both, TOOLS[sample], strict=True):
        for which in Side:
            side = member.tooth.unmodified_tooth.side(which)
            assert member.tooth.side(which).tool == side.tool
            assert side.tool.name == name
            assert side.tool.profile is not None
            # both ends of the flank are on the tool's profile, the root end nearer to the tool's tip
            form_point, tip = side.tool.height(np.array([side.form_point[0], side.tip]))
            assert form_point < tip
            if side.generation is not None:
                grid = member.tooth.unmodified_tooth.flank_grid(which, [0.0, 0.5, 1.0], [0.0, 0.5, 1.0])
                fillet = np.linspace(side.form_point[1], side.root, 3)[:, None], grid.parameters[..., 1]
                for surface, generated, at in zip(
                    (side.flank, side.fillet),
                    side.generation,
                    (np.moveaxis(grid.parameters, -1, 0), fillet),
                    strict=True,
                ):
                    # of a helical shaper by its own helicoid, which rolls, and by its section, twisted
                    assert np.abs(surface.jet(*at).r - generated.jet(*at).r).max() < 1e-11
                    assert np.abs(surface.jet(*at).n - generated.jet(*at).n).max() < 1e-11
                assert side.tool.drawing is not None
                assert all(each.unit in ("mm", "deg", "") and np.isfinite(each.value) for each in side.tool.dimensions)


# ---------------------------------------------------------------- a tool that the package has never seen


@dataclass(frozen=True)
class Blueprint:
    """A motion by nothing but what a motion must answer."""

    roll: RackRoll
    linear: bool = True
    unmodified: None = None

    def at(self, phi: Array) -> MotionState:
        return self.roll.at(phi)

    def axes(self, phi: Array) -> tuple[MachineAxis, ...]:
        return (MachineAxis("spindle", np.zeros(3), np.array([1.0, 0.0, 0.0])),)


@dataclass(frozen=True)
class Wire:
    """The surface that a wire sweeps that is drawn across the blank."""

    other: Surface

    def jet(self, u: Array, v: Array) -> Jet:
        return self.other.jet(u, v)


@dataclass(frozen=True)
class Eroded:
    """A generated surface that is no envelope of the kernel."""

    made: Envelope

    @property
    def tool(self) -> Surface:
        return self.made.tool

    @property
    def freedoms(self) -> int:
        return 1

    def jet(self, u: Array, v: Array) -> Jet:
        return self.made.jet(u, v)

    def on_tool(self, u: Array, v: Array) -> tuple[Array, Array]:
        return u, v

    def generating(self, u: Array, v: Array) -> tuple[Array, ...]:
        return (self.made.parameter(u, v),)

    def tool_to_blank(self, *motion: Array) -> Rigid:
        return self.made.motion.at(motion[0]).tool_to_blank

    def axes(self, *motion: Array) -> tuple[MachineAxis, ...]:
        return self.made.motion.axes(motion[0])

    def progress(self, u: Array, v: Array) -> tuple[Array, Array, Array]:
        return self.made.progress(u, v)


@dataclass(frozen=True)
class WireDrawing:
    as_part: bool = False

    def axis_at(self, at: DrawnPlace) -> None:
        return None

    def draw(self, sides: list[DrawnSide], at: DrawnPlace) -> tuple[tuple[ToolSheet, ...], tuple[Array, ...]]:
        points = np.broadcast_to(at.point, (2, 2, 3))
        return (ToolSheet("wire", points, points),) * len(sides), ()


def eroded(side: ToothSide, radius: float) -> ToothSide:
    """The same side, said to be made by the wire."""
    assert side.generation is not None

    def made(surface: GeneratedSurface) -> Eroded:
        return Eroded(Envelope(Wire(surface.tool), Blueprint(RackRoll(radius))))

    flank, fillet = (made(each) for each in side.generation)
    tool = ToolDescription(
        "wire", WireDrawing(), (Dimension("diameter", 0.2, "mm"),), side.tool.profile, zero=HeightZero.PITCH_PLANE
    )
    return replace(side, flank=flank, fillet=fillet, tool=tool, generation=(flank, fillet))


@pytest.mark.sweep
def test_sheets_have_the_dimensions_of_the_tools() -> None:
    """One column for both flanks where one tool, or tools that are alike, cut them; planets are one column."""
    ground = gm.build(gm.load(SAMPLES / "novikov.toml")).sheet().plain_tables["Tools"]
    assert ground["tool"] == ["", "grinding worm", "rack cutter"]
    assert ground["d_0"] == ["mm", 196.0, None]
    assert ground["z_0"] == ["-", 1.0, None]
    cut = gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml")).sheet()
    (table,) = (table for table in cut.tables if table.title == "Tools")
    assert table.columns == ("pinion, right", "pinion, left", "gear, right", "gear, left")
    alone = gm.build(gm.load(SAMPLES / "planetary.toml")).sheet(member="ring").plain_tables["Tools"]
    assert alone["z_0"] == ["-", 29.0]


def test_a_tool_of_another_kind_needs_what_the_protocols_ask_alone() -> None:
    member = gm.build(gm.load(SAMPLES / "helical.toml")).members["pinion"]
    tooth = member.tooth.unmodified_tooth
    rack = tooth.right.tool.rack
    assert rack is not None
    right, left = (eroded(side, rack.radius) for side in (tooth.right, tooth.left))
    member = replace(member, tooth=replace(tooth, right=right, left=left))
    # a proved tooth, as all of a built gear are
    member.tooth.prove()
    found, usual = tool_in_place(member.tooth, Side.RIGHT), tool_in_place(tooth, Side.RIGHT)
    assert (found.name, found.as_part, [axis.name for axis in found.axes]) == ("wire", False, ["spindle"])
    assert [sheet.region for sheet in found.sheets] == ["wire", "wire"]
    np.testing.assert_array_equal(found.touching.r, usual.touching.r)
    lines, known = (tool_contact(each, Side.RIGHT) for each in (member.tooth, tooth))
    assert (lines.name, lines.rolls, len(lines.lines)) == ("wire", True, 6)
    np.testing.assert_array_equal(lines.lines[3].points, known.lines[3].points)
    limits, usual_limits = (member_limits(replace(member, tooth=each)) for each in (member.tooth, tooth))
    np.testing.assert_array_equal(limits.right.h1, usual_limits.right.h1)
    np.testing.assert_array_equal(limits.left.on_tool, usual_limits.left.on_tool)
    assert fewest_teeth(tooth) is not None
    assert fewest_teeth(member.tooth) is None
