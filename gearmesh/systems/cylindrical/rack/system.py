"""A pinion and a rack of finite length, and a rack alone: keys, mesh, the rack as a member, data sheet."""

from gearmesh.systems.cylindrical.force_tables import rack_forces
from gearmesh.systems.cylindrical.pinned import rack_values
from gearmesh.systems.cylindrical.rack import single
from gearmesh.systems.cylindrical.rack.build import build
from gearmesh.systems.cylindrical.rack.design import RackDesign, SingleRackDesign, is_single_rack
from gearmesh.systems.cylindrical.rack.proportions import derived_values
from gearmesh.systems.cylindrical.rack.sheet import rack_reserves, rack_sheet
from gearmesh.systems.cylindrical.single.drawn import DRAWN_ROWS
from gearmesh.systems.system import System

GEAR_SYSTEMS = (
    System(
        "rack",
        RackDesign,
        build,
        derive=derived_values,
        sheet=rack_sheet,
        reserves=rack_reserves,
        forces=rack_forces,
        pinned=rack_values,
        drawn=DRAWN_ROWS,
        single=System(
            "rack",
            SingleRackDesign,
            single.build,
            derive=single.derived_values,
            sheet=single.sheet,
            pinned=single.pinned_values,
            drawn=DRAWN_ROWS,
        ),
        is_single=is_single_rack,
    ),
)
