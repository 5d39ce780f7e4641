"""Names of the parts of a gear's surface: sides of a tooth, regions of teeth and body. Files and JSON hold their values."""

from __future__ import annotations

from enum import StrEnum


class Side(StrEnum):
    """A side of a tooth centred on +x, seen from +z: right is y < 0 (ISO 21771)."""

    RIGHT = "right"
    LEFT = "left"

    @property
    def sign(self) -> int:
        """+1 right, -1 left."""
        return 1 if self is Side.RIGHT else -1

    @property
    def other(self) -> Side:
        return Side.LEFT if self is Side.RIGHT else Side.RIGHT


class Region(StrEnum):
    """A part of a gear's surface: the links of a tooth's sections, and what the body has under them."""

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

    @property
    def side(self) -> Side | None:
        """The side of the tooth that it belongs to; None for root, land and body."""
        return _SIDES.get(self)

    @property
    def is_flank(self) -> bool:
        return self in FLANKS.values()


FLANKS = {Side.RIGHT: Region.FLANK_RIGHT, Side.LEFT: Region.FLANK_LEFT}
FILLETS = {Side.RIGHT: Region.FILLET_RIGHT, Side.LEFT: Region.FILLET_LEFT}
EDGES = {Side.RIGHT: Region.EDGE_RIGHT, Side.LEFT: Region.EDGE_LEFT}
#: the ends of the face, plane end faces there, and the broken edges of end faces
TOE, HEEL = "toe", "heel"
END_FACES = {TOE: Region.FACE_TOE, HEEL: Region.FACE_HEEL}
END_EDGES = {TOE: Region.EDGE_TOE, HEEL: Region.EDGE_HEEL}
_SIDES = {region: side for regions in (FLANKS, FILLETS, EDGES) for side, region in regions.items()}

#: regions that a body may have, in the order of the files, which list them all; and those listed only where there are any
BODY_REGIONS = tuple(Region)[8:18]
RARE_REGIONS = tuple(Region)[18:20]
#: only where there are two halves with a gap between
GAP_REGIONS = tuple(Region)[20:21]
#: only where there is one of them: steps of shaft and bore, bolt holes, openings between spokes
FEATURE_REGIONS = (Region.SHAFT, Region.COUNTERBORE, Region.BOLT, Region.SPOKE)
#: those of the bar of a rack
BAR_REGIONS = (Region.FACE_TOE, Region.FACE_HEEL, Region.BACK, Region.END)
#: cut faces of a sector of some teeth: before its first tooth, and after its last
CUT_REGIONS = (Region.CUT_RIGHT, Region.CUT_LEFT)
