"""One side of a tooth: the generated surfaces of its profile and where they pass into each other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from gearmesh.kernel.surface.surface import GeneratedSurface, Surface
from gearmesh.tools.description import ToolDescription


@dataclass(frozen=True)
class TipCorner:
    """Tip corner that the tool generates: a rounding, which touches the tip land, or a chamfer; surface parameters (q, v), q
    across the profile.

    `form_point` (p, q): parameters of flank and tip chamfer or rounding where they meet; `end`: parameter of the latter where the
    land begins. `crossed`: the flank was modified since, and they end where they cross.
    """

    surface: Surface
    form_point: tuple[float, float]
    end: float
    crossed: bool = False


@dataclass(frozen=True)
class ToothSide:
    """One side of a tooth: generated flank and fillet, surface parameters (p, v) with p across the profile.

    `form_point` (p, q): flank and fillet parameters where the tool's flank passes into its tip rounding;
    `root`: fillet parameter where the tool's tip plane begins; `tip`: flank parameter near the tip, a start value.
    `sharp`: they meet there in an edge, as what two tools or two parts of one generate does, not smoothly. `crossed`: at the
    joint, a hollow corner of the tool, they have run past each other, and end where they cross.
    `tip_corner`: rounding or chamfer of the tip that the tool generates, on both sides or none.

    `tool`: what made it, as its tool describes itself; `generation`: flank and fillet by their motion of the tool, None where they
    have other parameters than it, or no tool at all is known to have left them.

    `flank_breaks`, `fillet_breaks`: parameters p and q of lines over which flank or fillet are not smooth, where a relief begins or
    the tool's profile has a corner or a jump of its curvature; `face_breaks`: station coordinates (mm) of such lines across the
    face. All grids have lines there. `face_bends`: those where only higher derivatives jump, which grids need no lines for.
    `creases` and `ridges`: those of the flank's over which it has a corner, and those across the face. `smooth_flank`: the flank's
    surface about a place (p, v), going on over creases and ridges as if there were none, where there are some. `tabulated`: the
    flank goes by a table, whose points do not determine what is between. `generated`: the side as the tool leaves it, where it
    was modified since.
    """

    flank: Surface
    fillet: Surface
    form_point: tuple[float, float]
    root: float
    tip: float
    tip_corner: TipCorner | None = None
    flank_breaks: tuple[float, ...] = ()
    fillet_breaks: tuple[float, ...] = ()
    face_breaks: tuple[float, ...] = ()
    face_bends: tuple[float, ...] = ()
    creases: tuple[float, ...] = ()
    ridges: tuple[float, ...] = ()
    smooth_flank: Callable[[float, float], Surface] | None = None
    tabulated: bool = False
    generated: ToothSide | None = None
    sharp: bool = False
    crossed: bool = False
    tool: ToolDescription = field(kw_only=True)
    generation: tuple[GeneratedSurface, GeneratedSurface] | None = field(default=None, kw_only=True)


@dataclass(frozen=True)
class Bottom:
    """Generated root between the fillets of neighbouring teeth: surface parameters (h, v), h across it.

    `ends`: h where the fillet of the tooth before ends, and where that of this tooth's right side does.
    """

    surface: Surface
    ends: tuple[float, float]
