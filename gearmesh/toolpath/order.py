"""Order for a tool path, which all steps of planning and proof take, and the material that passes and chords may leave."""

from __future__ import annotations

from gearmesh.records import dataclass

#: share of the scallop for chords if no tolerance is given
DEFAULT_CHORD_SHARE = 0.1
#: share of the scallop reserved for effects of higher order
RESERVED_SCALLOP_SHARE = 0.05


@dataclass(frozen=True)
class Budget:
    """Allowed material left, mm."""

    #: material left between passes
    scallop: float
    #: material left along passes, by chords
    chord: float


@dataclass(frozen=True)
class PathOrder:
    """Order for a tool path; lengths in mm, angles in rad."""

    #: largest height over the surface (or over the stock), chords included
    scallop: float
    #: part of the scallop for chords; None for a tenth
    chord: float | None = None
    #: material left along the normals on purpose
    stock: float = 0.0
    #: "left", "right" or "both"
    flank: str = "both"
    #: "all" (with fillets and root) or "flanks"
    surfaces: str = "all"
    #: number of the space to cut, which is the number of the tooth after it; None for all spaces of all rows
    spaces: int | None = 0
    #: "zigzag" or "one-way"
    feed: str = "zigzag"
    #: lead of the tool axis; None to choose it
    lead: float | None = None
    #: tilt of the tool axis; None to choose it
    tilt: float | None = None

    @property
    def budget(self) -> Budget:
        """Parts of the scallop for passes and chords."""
        chord = DEFAULT_CHORD_SHARE * self.scallop if self.chord is None else self.chord
        return Budget((1.0 - RESERVED_SCALLOP_SHARE) * self.scallop - chord, chord)
