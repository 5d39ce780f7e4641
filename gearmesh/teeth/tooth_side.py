"""One side of a tooth: the surfaces of its profile, and the parameters where they meet."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.surface import GeneratedSurface, Surface
from gearmesh.records import dataclass
from gearmesh.tools.description import ToolDescription


@dataclass(frozen=True)
class TipCorner:
    """Chamfer or rounding of the tip that the tool generates; surface parameters (q, v), q across the profile.

    A rounding is tangent to the tip land.
    """

    #: surface of the chamfer or rounding
    surface: Surface
    #: parameters p of the flank and q of `surface` where they meet
    form_point: tuple[float, float]
    #: parameter q where the land begins
    end: float
    #: True if the flank was modified after cutting: both surfaces then end where they cross
    crossed: bool = False


@dataclass(frozen=True)
class ToothSide:
    """One side of a tooth: flank and fillet with surface parameters (p, v) and (q, v), p and q across the profile.

    Breaks are lines over which a surface is not smooth, because a relief begins there, or because the tool's profile
    has a corner or a jump of its curvature. Every grid has a line on every break.
    """

    #: surface of the flank
    flank: Surface
    #: surface of the fillet
    fillet: Surface
    #: parameters p of the flank and q of the fillet where the tool's flank passes into its tip rounding
    form_point: tuple[float, float]
    #: parameter q where the tool's tip plane begins
    root: float
    #: parameter p near the tip, a start value; with a generated land, p at the tip
    tip: float
    #: parameters p near the tip at station coordinates (T,), start values; None: `tip` everywhere
    tip_along: Callable[[Array], Array] | None = None
    #: chamfer or rounding of the tip that the tool generates, on both sides of a tooth or on none
    tip_corner: TipCorner | None = None
    #: parameters p of breaks along the flank
    flank_breaks: tuple[float, ...] = ()
    #: parameters q of breaks along the fillet
    fillet_breaks: tuple[float, ...] = ()
    #: station coordinates (mm) of breaks across the face
    face_breaks: tuple[float, ...] = ()
    #: station coordinate (mm) at the root, and second surface parameter, of each line aslant across fillet and flank over which
    #: their curvature jumps; `face_breaks` has the stations of its ends
    slanted_breaks: tuple[tuple[float, float], ...] = ()
    #: station coordinates (mm) where only higher derivatives jump; grids need no lines there
    face_bends: tuple[float, ...] = ()
    #: those of `flank_breaks` over which the flank has a corner
    creases: tuple[float, ...] = ()
    #: those of the breaks across the face over which the flank has a corner
    ridges: tuple[float, ...] = ()
    #: flank near a place (p, v), continued over creases and ridges as if there were none; None without them
    smooth_flank: Callable[[float, float], Surface] | None = None
    #: True if the flank interpolates a table, whose points do not determine the surface between them
    tabulated: bool = False
    #: the side as its tool leaves it; None if it was not modified
    generated: ToothSide | None = None
    #: True if flank and fillet meet in an edge, because two tools, or two parts of one tool, generate them
    sharp: bool = False
    #: True if flank and fillet overlap at a hollow corner of the tool and end where they cross
    crossed: bool = False
    #: parameter p of the flank up to which it may cross the fillet, from the form point; None: up to the tip
    crossing_end: float | None = None
    #: description of the tool that made the side
    tool: ToolDescription = field(kw_only=True)
    #: flank and fillet by their motion of the tool; None if their parameters differ, or if no tool is known
    generation: tuple[GeneratedSurface, GeneratedSurface] | None = field(default=None, kw_only=True)


@dataclass(frozen=True)
class Crest:
    """Generated land between the flanks of a tooth: surface parameters (h, v), h across it.

    The flanks end at its ends, with the parameter `ToothSide.tip`; the tip of the blank is the level through its middle.
    """

    #: surface of the land
    surface: Surface
    #: values of h at the right and at the left flank
    ends: tuple[float, float]
    #: the land between unmodified flanks; None if they were not modified
    generated: Crest | None = None


@dataclass(frozen=True)
class Bottom:
    """Generated root between the fillets of neighbouring teeth: surface parameters (h, v), h across it.

    `ends`: values of h at the fillet of the tooth before and at the right fillet of this tooth.
    """

    surface: Surface
    ends: tuple[float, float]
