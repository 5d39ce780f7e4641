"""Worm drives: worms of the forms ZA, ZN, ZI, ZK and ZC [ISO 10828], wheels as their hobs generate them."""

from gearmesh.systems.system import PatternCheck, System
from gearmesh.systems.worm_drive.build import ASSEMBLY_DISPLACEMENTS, build, pinned_values
from gearmesh.systems.worm_drive.contact.pattern import ASSEMBLY_MOVES, pattern_shifts
from gearmesh.systems.worm_drive.cutting.proportions import derived_values
from gearmesh.systems.worm_drive.design import WormDriveDesign
from gearmesh.systems.worm_drive.force_tables import pair_forces
from gearmesh.systems.worm_drive.rexs import WORM_DRIVE
from gearmesh.systems.worm_drive.sheet import DRAWN_ROWS, data_sheet

GEAR_SYSTEMS = (
    System(
        "worm_drive",
        WormDriveDesign,
        build,
        derive=derived_values,
        sheet=data_sheet,
        forces=pair_forces,
        displacements=ASSEMBLY_DISPLACEMENTS,
        pinned=pinned_values,
        vh=PatternCheck(pattern_shifts, ASSEMBLY_MOVES.keys, ("J",)),
        drawn=DRAWN_ROWS,
        rexs=WORM_DRIVE,
    ),
)
