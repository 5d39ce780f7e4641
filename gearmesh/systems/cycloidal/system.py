"""Cycloidal drives: pins on a circle and the lobes that they generate."""

from gearmesh.systems.cycloidal.build import ASSEMBLY_DISPLACEMENTS, build, pinned_values
from gearmesh.systems.cycloidal.design import CycloidalDesign
from gearmesh.systems.cycloidal.forces import pair_forces
from gearmesh.systems.cycloidal.sheet import DRAWN_ROWS, data_sheet
from gearmesh.systems.system import System

GEAR_SYSTEMS = (
    System(
        "cycloidal",
        CycloidalDesign,
        build,
        sheet=data_sheet,
        forces=pair_forces,
        displacements=ASSEMBLY_DISPLACEMENTS,
        pinned=pinned_values,
        drawn=DRAWN_ROWS,
    ),
)
