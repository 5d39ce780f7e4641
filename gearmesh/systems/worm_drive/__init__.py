"""Worm drives: worms of the forms ZA, ZN, ZI, ZK and ZC [ISO 10828], wheels as their hobs generate them."""

from gearmesh.systems.system import System
from gearmesh.systems.worm_drive.build import DISPLACEMENTS, build, pinned_values
from gearmesh.systems.worm_drive.design import WormDriveDesign

SYSTEMS = (System("worm_drive", WormDriveDesign, build, displacements=DISPLACEMENTS, pinned=pinned_values),)
