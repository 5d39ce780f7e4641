"""Names of the parts of a gear's surface: sides of a tooth, regions of teeth and body. Files and JSON contain the
values.
"""

from __future__ import annotations

from enum import StrEnum


class Side(StrEnum):
    """A side of a tooth centred on +x, seen from +z: right is y < 0 (ISO 21771)."""

    RIGHT = "right"
    LEFT = "left"

    @property
    def sign(self) -> int:
        """+1 for the right side, -1 for the left."""
        return 1 if self is Side.RIGHT else -1

    @property
    def other(self) -> Side:
        return Side.LEFT if self is Side.RIGHT else Side.RIGHT


class Region(StrEnum):
    """A part of a gear's surface: a link of a tooth's section, or a part of the body."""

    ROOT = "root"
    FILLET_RIGHT = "fillet_right"
    FLANK_RIGHT = "flank_right"
    EDGE_RIGHT = "edge_right"
    LAND = "land"
    EDGE_LEFT = "edge_left"
    FLANK_LEFT = "flank_left"
    FILLET_LEFT = "fillet_left"

    FACE_TOE = "face_toe"
    FACE_HEEL = "face_heel"
    BORE = "bore"
    KEYWAY = "keyway"
    HUB = "hub"
    FRONT_CONE = "front_cone"
    BACK_CONE = "back_cone"
    INNER_CYLINDER = "inner_cylinder"
    OUTER_CYLINDER = "outer_cylinder"
    RIM = "rim"
    WEB = "web"
    HOLE = "hole"
    GAP = "gap"
    BACK = "back"
    END = "end"
    TIP_SURFACE = "tip_surface"
    CUT_RIGHT = "cut_right"
    CUT_LEFT = "cut_left"
    EDGE_TOE = "edge_toe"
    EDGE_HEEL = "edge_heel"

    SHAFT = "shaft"
    COUNTERBORE = "counterbore"
    BOLT = "bolt"
    SPOKE = "spoke"
    BORE_FLAT = "bore_flat"

    @property
    def side(self) -> Side | None:
        """The side of the tooth that the region belongs to; None for root, land and body."""
        return _REGION_SIDES.get(self)

    @property
    def is_flank(self) -> bool:
        return self in FLANK_REGIONS.values()


#: flank of each side
FLANK_REGIONS = {Side.RIGHT: Region.FLANK_RIGHT, Side.LEFT: Region.FLANK_LEFT}
#: fillet of each side
FILLET_REGIONS = {Side.RIGHT: Region.FILLET_RIGHT, Side.LEFT: Region.FILLET_LEFT}
#: broken tip edge of each side
TIP_EDGES = {Side.RIGHT: Region.EDGE_RIGHT, Side.LEFT: Region.EDGE_LEFT}
#: name of the end at the toe
TOE_END = "toe"
#: name of the end at the heel
HEEL_END = "heel"
#: plane end face at each end
END_FACES = {TOE_END: Region.FACE_TOE, HEEL_END: Region.FACE_HEEL}
#: broken edge of the end face at each end
END_EDGES = {TOE_END: Region.EDGE_TOE, HEEL_END: Region.EDGE_HEEL}
#: side of each region of a flank, fillet or tip edge
_REGION_SIDES = {
    region: side for regions in (FLANK_REGIONS, FILLET_REGIONS, TIP_EDGES) for side, region in regions.items()
}

#: regions of a body that files always list, in their order
BODY_REGIONS = tuple(Region)[8:18]
#: regions of a body that files list only if there are any
RARE_REGIONS = tuple(Region)[18:20]
#: region between two halves of a member
GAP_REGIONS = tuple(Region)[20:21]
#: regions of steps of shaft and bore, bolt holes and openings between spokes; listed only if there are any
FEATURE_REGIONS = (Region.SHAFT, Region.COUNTERBORE, Region.BOLT, Region.SPOKE)
#: plane walls of a bore with a hexagon or flats; listed only if there are any
BORE_REGIONS = (Region.BORE_FLAT,)
#: regions of the bar of a rack
BAR_REGIONS = (Region.FACE_TOE, Region.FACE_HEEL, Region.BACK, Region.END)
#: cut faces of a sector of some teeth: before its first tooth and after its last
CUT_REGIONS = (Region.CUT_RIGHT, Region.CUT_LEFT)
