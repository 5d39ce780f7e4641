"""gearmesh: exact gear tooth surfaces, their contact, and meshes proved against both.

    import gearmesh as gm

    design = gm.load("helical.toml", ["contact.delta=0.005"])    a design file; any key can be set anew
    gears = gm.build(design)                                      exact teeth of all members, nothing else yet
    gears.contact()                                               path, transmission error, ellipses, mesh cycle
    gears.loaded_contact([50, 100])                               load sharing, loaded transmission error, root stress
    gears.solid("pinion", tolerance=0.01).save("pinion.stl")      watertight, within 0.01 mm, measured
    gears.cad().save("pair.step")                                 CAD solids, placed as they mesh
    gears.to_build123d(), gears.to_cadquery()                     the same in memory
    gears.section("pinion").save("pinion.dxf")                    the section across the axis, as arcs and splines
    gears.drawing("pinion").save("pinion.pdf")                    a workshop drawing with dimensions and gear data
    gears.topography("pinion").save("right.csv")                  all modifications of a flank, as a file to design with
    gears.toolpath("pinion", "ball:1mm", "10um").save("p.cls")     passes of a ball-end cutter on a five-axis machine, proved
    gears.finite_elements(phi1=0.0).save("pair.inp")              a complete model of three teeth each
    gears.check(), gears.limits(), gears.sheet()                  meshes and contact checked; undercut; derived values
    gears.vh()                                                    of bevel gears: V-H check
    gears.study({"assembly.dx": "-0.1:0.1:5"})                    many assemblies or designs: figures, sensitivities
    gears.largest_errors(["assembly.dx"])                         how large errors may be before a criterion fails
    gears.picture("pattern").save("pattern.png")                  contact on the tooth
    gears.picture("flank").save("flank.svg")                      both sides in the planes of their flanks, with the ease-off
    gears.animation().save("mesh.gif")                            the mesh cut open, rolling
    gears.report().save("report.html")                            one page for a browser: the gears roll, figures, plots
    gears.run("out")                                              all of it into a folder
    gm.gear(30, module=1, helix=15)                               one gear without a mating gear
    gm.size(2.5, 64, 2).design(1)                                 cylindrical gears of a ratio, centre distance and module

Every answer prints as a table, shows as one in a notebook, and has `.to_dict()` (columns), `.document()` (as JSON) and
`.save(path)`. Lengths are in mm, or texts with their unit ("10um"), angles in deg, torques in Nm. What is impossible raises
DesignError with one line that names key, value and what is allowed; all errors are GearmeshErrors.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gearmesh.answers.bodies.cad import Cad
    from gearmesh.answers.bodies.finite_element_model import FiniteElementModel, UnloadedFiniteElements
    from gearmesh.answers.bodies.finite_elements import FiniteElementDecks, FiniteElements, FiniteElementSolution
    from gearmesh.answers.bodies.measuring_grid import MeasuringGrids
    from gearmesh.answers.bodies.section import Section
    from gearmesh.answers.bodies.solid import Solid, Solids
    from gearmesh.answers.bodies.toolpath import ToolPathAnswer
    from gearmesh.answers.bodies.topography import FlankTopography
    from gearmesh.answers.check import Check, RollTest
    from gearmesh.answers.contact.contact import Contact
    from gearmesh.answers.contact.ease_off import EaseOffMap
    from gearmesh.answers.contact.vh import VHCheck
    from gearmesh.answers.exchange import RexsExport, RexsReading, load_rexs
    from gearmesh.answers.inspection.composite import CompositeTest
    from gearmesh.answers.inspection.correction import Correction
    from gearmesh.answers.inspection.inspection import Inspection
    from gearmesh.answers.limits import Limits
    from gearmesh.answers.load.loaded import LoadedContact
    from gearmesh.answers.pinned import Pinned
    from gearmesh.answers.planetary_sizing import PlanetarySizing, size_planetary
    from gearmesh.answers.result import Result
    from gearmesh.answers.sheet import Compensation, DesignSheet
    from gearmesh.answers.sizing import Sizing, size
    from gearmesh.api.gear import gear
    from gearmesh.api.gears import Gears, build
    from gearmesh.design.core import Design
    from gearmesh.design.files import toml
    from gearmesh.drawing.drawing import WorkshopDrawing
    from gearmesh.errors import DesignError, GearmeshError, NoSolutionError, OutputError
    from gearmesh.loaded.mounts import FlexibleMount as FlexibleMount
    from gearmesh.reports.report import ReportPage
    from gearmesh.reports.run import Report
    from gearmesh.study.largest_errors import LargestErrors
    from gearmesh.study.study import Study
    from gearmesh.systems.beveloid.design import BeveloidDesign
    from gearmesh.systems.circular_arc.design import CircularArcDesign
    from gearmesh.systems.cylindrical.design import CylindricalDesign
    from gearmesh.systems.cylindrical.planetary.design import PlanetaryDesign
    from gearmesh.systems.cylindrical.rack.design import RackDesign, SingleRackDesign
    from gearmesh.systems.cylindrical.single.design import SingleGearDesign
    from gearmesh.systems.designs import load, new, parse
    from gearmesh.systems.face_gear.design import FaceGearDesign
    from gearmesh.systems.parabolic_helical.design import ModifiedInvoluteDesign, NovikovDesign
    from gearmesh.systems.spiral_bevel.conjugate.design import ConjugateDesign
    from gearmesh.systems.spiral_bevel.design import SpiralBevelDesign
    from gearmesh.systems.spiral_bevel.hypoid_design import HypoidDesign
    from gearmesh.systems.system import System, kinds, register, system
    from gearmesh.systems.worm_drive.design import WormDriveDesign
    from gearmesh.view.picture import Animation, Diagram, Picture

#: said here alone: pyproject.toml has it from here
__version__ = "0.10.0"

__all__ = [
    "Animation",
    "BeveloidDesign",
    "Cad",
    "Check",
    "CircularArcDesign",
    "Compensation",
    "CompositeTest",
    "ConjugateDesign",
    "Contact",
    "Correction",
    "CylindricalDesign",
    "Design",
    "DesignError",
    "DesignSheet",
    "Diagram",
    "EaseOffMap",
    "FaceGearDesign",
    "FiniteElementDecks",
    "FiniteElementModel",
    "FiniteElementSolution",
    "FiniteElements",
    "FlankTopography",
    "FlexibleMount",
    "GearmeshError",
    "Gears",
    "HypoidDesign",
    "Inspection",
    "LargestErrors",
    "Limits",
    "LoadedContact",
    "MeasuringGrids",
    "ModifiedInvoluteDesign",
    "NoSolutionError",
    "NovikovDesign",
    "OutputError",
    "Picture",
    "Pinned",
    "PlanetaryDesign",
    "PlanetarySizing",
    "RackDesign",
    "Report",
    "ReportPage",
    "Result",
    "RexsExport",
    "RexsReading",
    "RollTest",
    "Section",
    "SingleGearDesign",
    "SingleRackDesign",
    "Sizing",
    "Solid",
    "Solids",
    "SpiralBevelDesign",
    "Study",
    "System",
    "ToolPathAnswer",
    "UnloadedFiniteElements",
    "VHCheck",
    "WorkshopDrawing",
    "WormDriveDesign",
    "build",
    "gear",
    "kinds",
    "load",
    "load_rexs",
    "new",
    "parse",
    "register",
    "size",
    "size_planetary",
    "system",
    "toml",
]

#: where each name is, to be loaded when it is asked for
_HOMES = {
    "gearmesh.answers.bodies.cad": ("Cad",),
    "gearmesh.answers.bodies.finite_element_model": (
        "FiniteElementModel",
        "UnloadedFiniteElements",
    ),
    "gearmesh.answers.bodies.finite_elements": (
        "FiniteElementDecks",
        "FiniteElementSolution",
        "FiniteElements",
    ),
    "gearmesh.answers.bodies.measuring_grid": ("MeasuringGrids",),
    "gearmesh.answers.bodies.section": ("Section",),
    "gearmesh.answers.bodies.solid": (
        "Solid",
        "Solids",
    ),
    "gearmesh.answers.bodies.toolpath": ("ToolPathAnswer",),
    "gearmesh.answers.bodies.topography": ("FlankTopography",),
    "gearmesh.answers.check": (
        "Check",
        "RollTest",
    ),
    "gearmesh.answers.contact.contact": ("Contact",),
    "gearmesh.answers.contact.ease_off": ("EaseOffMap",),
    "gearmesh.answers.contact.vh": ("VHCheck",),
    "gearmesh.answers.exchange": (
        "RexsExport",
        "RexsReading",
        "load_rexs",
    ),
    "gearmesh.answers.inspection.composite": ("CompositeTest",),
    "gearmesh.answers.inspection.correction": ("Correction",),
    "gearmesh.answers.inspection.inspection": ("Inspection",),
    "gearmesh.answers.limits": ("Limits",),
    "gearmesh.answers.load.loaded": ("LoadedContact",),
    "gearmesh.answers.pinned": ("Pinned",),
    "gearmesh.answers.planetary_sizing": (
        "PlanetarySizing",
        "size_planetary",
    ),
    "gearmesh.answers.result": ("Result",),
    "gearmesh.answers.sheet": (
        "Compensation",
        "DesignSheet",
    ),
    "gearmesh.answers.sizing": (
        "Sizing",
        "size",
    ),
    "gearmesh.api.gear": ("gear",),
    "gearmesh.api.gears": (
        "Gears",
        "build",
    ),
    "gearmesh.reports.report": ("ReportPage",),
    "gearmesh.reports.run": ("Report",),
    "gearmesh.design.core": ("Design",),
    "gearmesh.design.files": ("toml",),
    "gearmesh.drawing.drawing": ("WorkshopDrawing",),
    "gearmesh.errors": (
        "DesignError",
        "GearmeshError",
        "NoSolutionError",
        "OutputError",
    ),
    "gearmesh.loaded.mounts": ("FlexibleMount",),
    "gearmesh.study.largest_errors": ("LargestErrors",),
    "gearmesh.study.study": ("Study",),
    "gearmesh.systems.beveloid.design": ("BeveloidDesign",),
    "gearmesh.systems.circular_arc.design": ("CircularArcDesign",),
    "gearmesh.systems.cylindrical.design": ("CylindricalDesign",),
    "gearmesh.systems.cylindrical.planetary.design": ("PlanetaryDesign",),
    "gearmesh.systems.cylindrical.rack.design": (
        "RackDesign",
        "SingleRackDesign",
    ),
    "gearmesh.systems.cylindrical.single.design": ("SingleGearDesign",),
    "gearmesh.systems.designs": (
        "load",
        "new",
        "parse",
    ),
    "gearmesh.systems.face_gear.design": ("FaceGearDesign",),
    "gearmesh.systems.parabolic_helical.design": (
        "ModifiedInvoluteDesign",
        "NovikovDesign",
    ),
    "gearmesh.systems.spiral_bevel.conjugate.design": ("ConjugateDesign",),
    "gearmesh.systems.spiral_bevel.design": ("SpiralBevelDesign",),
    "gearmesh.systems.spiral_bevel.hypoid_design": ("HypoidDesign",),
    "gearmesh.systems.system": (
        "System",
        "kinds",
        "register",
        "system",
    ),
    "gearmesh.systems.worm_drive.design": ("WormDriveDesign",),
    "gearmesh.view.picture": (
        "Animation",
        "Diagram",
        "Picture",
    ),
}
_HOME = {name: home for home, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'gearmesh' has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(_HOME[name]), name)
    return value


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
