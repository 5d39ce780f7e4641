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
    from gearmesh.answers.bodies.measuring_grid import MeasuringGridFigures, MeasuringGrids
    from gearmesh.answers.bodies.model_figures import CyclicFigures
    from gearmesh.answers.bodies.section import Section, SectionFigures
    from gearmesh.answers.bodies.solid import Solid, Solids
    from gearmesh.answers.bodies.toolpath import ToolPathAnswer, ToolPathFigures
    from gearmesh.answers.bodies.topography import FlankTopography, TopographyFigures
    from gearmesh.answers.check import Check, RollTest, Verdict
    from gearmesh.answers.contact.contact import Contact
    from gearmesh.answers.contact.ease_off import EaseOffMap, EaseOffPoint
    from gearmesh.answers.contact.figures import PositionFigures
    from gearmesh.answers.contact.fit import BacklashCurve
    from gearmesh.answers.contact.sides import SideContact
    from gearmesh.answers.contact.vh import PlaceFigures, TotalFigures, VHCheck
    from gearmesh.answers.exchange import RexsExport, RexsReading, load_rexs
    from gearmesh.answers.inspection.composite import CompositeFigures, CompositeTest
    from gearmesh.answers.inspection.correction import Correction, CorrectionFigures
    from gearmesh.answers.inspection.figures import InspectionFigures
    from gearmesh.answers.inspection.flank_map import DeviationMap, MeasuredTrace
    from gearmesh.answers.inspection.inspection import Inspection
    from gearmesh.answers.limits import Limits, MemberLimitFigures
    from gearmesh.answers.load.figures import LoadedFigures, LoadedPosition, LoadedTotals, ToothPairPosition
    from gearmesh.answers.load.loaded import LoadedContact
    from gearmesh.answers.pinned import Pinned
    from gearmesh.answers.planetary_sizing import PlanetarySizing, RejectedFigures, SetFigures, size_planetary
    from gearmesh.answers.result import Result, RunTime
    from gearmesh.answers.sheet import Compensation, DesignSheet, SettingFigures
    from gearmesh.answers.sizing import CandidateFigures, Sizing, size
    from gearmesh.answers.tables import Listing
    from gearmesh.api.gear import gear
    from gearmesh.api.gears import Gears, build
    from gearmesh.cad.contours.curves import Contour
    from gearmesh.cad.step import Part
    from gearmesh.contact.conditions.refinement import Contacts
    from gearmesh.contact.engagement.engagement import Engagement
    from gearmesh.contact.engagement.turns import FullTurns
    from gearmesh.contact.path import ContactPath
    from gearmesh.design.core import Design, MemberMount
    from gearmesh.design.files import toml
    from gearmesh.design.keys import Key, KeyLine, Table
    from gearmesh.drawing.drawing import WorkshopDrawing
    from gearmesh.drawing.outline import Outline
    from gearmesh.errors import DesignError, GearmeshError, NoSolutionError, OutputError
    from gearmesh.figures import Entry, Figure, Summary
    from gearmesh.kernel.motion.joint import Joint, MotionUnits
    from gearmesh.kernel.motion.rigid import Rigid
    from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve, PlaneLine
    from gearmesh.kernel.surface.levels import ConeLevel, ConeSurface, Level
    from gearmesh.kernel.surface.surface import Jet, Surface
    from gearmesh.loaded.mounts import FlexibleMount
    from gearmesh.mesh.triangles import TriangleMesh
    from gearmesh.metrology.second_order import SecondOrder
    from gearmesh.metrology.tolerances import FigureClass, GearClass
    from gearmesh.reports.report import ReportPage
    from gearmesh.reports.run import Report
    from gearmesh.study.largest_errors import KeyRange, LargestErrors
    from gearmesh.study.rows.patterns import AssemblyContact
    from gearmesh.study.statistics import Effect
    from gearmesh.study.study import Study
    from gearmesh.study.summary import StudySummary
    from gearmesh.study.variance import VarianceShare
    from gearmesh.systems.beveloid.design import BeveloidDesign
    from gearmesh.systems.circular_arc.design import CircularArcDesign
    from gearmesh.systems.circular_arc.fillets import ArcRack
    from gearmesh.systems.cylindrical.design import CylindricalDesign, CylindricalMember
    from gearmesh.systems.cylindrical.planetary.design import PlanetaryDesign
    from gearmesh.systems.cylindrical.planetary.sizing import SetCandidate
    from gearmesh.systems.cylindrical.rack.design import RackDesign, SingleRackDesign
    from gearmesh.systems.cylindrical.single.design import SingleGearDesign
    from gearmesh.systems.designs import load, new, parse
    from gearmesh.systems.face_gear.design import FaceGearDesign
    from gearmesh.systems.parabolic_helical.design import ModifiedInvoluteDesign, NovikovDesign
    from gearmesh.systems.spiral_bevel.conjugate.design import ConjugateDesign
    from gearmesh.systems.spiral_bevel.design import EaseOffTable, SpiralBevelDesign
    from gearmesh.systems.spiral_bevel.hypoid_design import HypoidDesign
    from gearmesh.systems.system import System, ToolPart, kinds, register, system
    from gearmesh.systems.worm_drive.design import WormDriveDesign
    from gearmesh.teeth.blank.body import Body, Disc, PlaneFace, TurnedStep
    from gearmesh.teeth.blank.end_edge import EndChamfer
    from gearmesh.teeth.blank.features import Boss, Drilling, Opening, Slot
    from gearmesh.teeth.blank.halves import AxialGap, HalfGear
    from gearmesh.teeth.end_strip import EndStrip, SharpOutline, StripPiece
    from gearmesh.teeth.gear_train import GearPair, GearTrain, Member
    from gearmesh.teeth.mount import Mount
    from gearmesh.teeth.region import Region, Side
    from gearmesh.teeth.section import Ends, Grid, Link, Sections
    from gearmesh.teeth.tooth import Tooth
    from gearmesh.teeth.tooth_side import ToothSide
    from gearmesh.tools.rack import Parabola
    from gearmesh.view.picture import Animation, Diagram, Picture

#: said here alone: pyproject.toml has it from here
__version__ = "0.16.0"

__all__ = [
    "Animation",
    "ArcRack",
    "AssemblyContact",
    "AxialGap",
    "BacklashCurve",
    "BeveloidDesign",
    "Body",
    "Boss",
    "Cad",
    "CandidateFigures",
    "Check",
    "CircularArcDesign",
    "Compensation",
    "CompositeFigures",
    "CompositeTest",
    "ConeLevel",
    "ConeSurface",
    "ConjugateDesign",
    "Contact",
    "ContactPath",
    "Contacts",
    "Contour",
    "Correction",
    "CorrectionFigures",
    "CyclicFigures",
    "CylindricalDesign",
    "CylindricalMember",
    "Design",
    "DesignError",
    "DesignSheet",
    "DeviationMap",
    "Diagram",
    "Disc",
    "Drilling",
    "EaseOffMap",
    "EaseOffPoint",
    "EaseOffTable",
    "Effect",
    "EndChamfer",
    "EndStrip",
    "Ends",
    "Engagement",
    "Entry",
    "FaceGearDesign",
    "Figure",
    "FigureClass",
    "FiniteElementDecks",
    "FiniteElementModel",
    "FiniteElementSolution",
    "FiniteElements",
    "FlankTopography",
    "FlexibleMount",
    "FullTurns",
    "GearClass",
    "GearPair",
    "GearTrain",
    "GearmeshError",
    "Gears",
    "Grid",
    "HalfGear",
    "HypoidDesign",
    "Inspection",
    "InspectionFigures",
    "Jet",
    "Joint",
    "Key",
    "KeyLine",
    "KeyRange",
    "LargestErrors",
    "Level",
    "Limits",
    "Link",
    "Listing",
    "LoadedContact",
    "LoadedFigures",
    "LoadedPosition",
    "LoadedTotals",
    "MeasuredTrace",
    "MeasuringGridFigures",
    "MeasuringGrids",
    "Member",
    "MemberLimitFigures",
    "MemberMount",
    "ModifiedInvoluteDesign",
    "MotionUnits",
    "Mount",
    "NoSolutionError",
    "NovikovDesign",
    "Opening",
    "Outline",
    "OutputError",
    "Parabola",
    "Part",
    "Picture",
    "Pinned",
    "PlaceFigures",
    "PlaneArc",
    "PlaneCurve",
    "PlaneFace",
    "PlaneLine",
    "PlanetaryDesign",
    "PlanetarySizing",
    "PositionFigures",
    "RackDesign",
    "Region",
    "RejectedFigures",
    "Report",
    "ReportPage",
    "Result",
    "RexsExport",
    "RexsReading",
    "Rigid",
    "RollTest",
    "RunTime",
    "SecondOrder",
    "Section",
    "SectionFigures",
    "Sections",
    "SetCandidate",
    "SetFigures",
    "SettingFigures",
    "SharpOutline",
    "Side",
    "SideContact",
    "SingleGearDesign",
    "SingleRackDesign",
    "Sizing",
    "Slot",
    "Solid",
    "Solids",
    "SpiralBevelDesign",
    "StripPiece",
    "Study",
    "StudySummary",
    "Summary",
    "Surface",
    "System",
    "Table",
    "ToolPart",
    "ToolPathAnswer",
    "ToolPathFigures",
    "Tooth",
    "ToothPairPosition",
    "ToothSide",
    "TopographyFigures",
    "TotalFigures",
    "TriangleMesh",
    "TurnedStep",
    "UnloadedFiniteElements",
    "VHCheck",
    "VarianceShare",
    "Verdict",
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
    "gearmesh.answers.bodies.measuring_grid": (
        "MeasuringGridFigures",
        "MeasuringGrids",
    ),
    "gearmesh.answers.bodies.model_figures": ("CyclicFigures",),
    "gearmesh.answers.bodies.section": (
        "Section",
        "SectionFigures",
    ),
    "gearmesh.answers.bodies.solid": (
        "Solid",
        "Solids",
    ),
    "gearmesh.answers.bodies.toolpath": (
        "ToolPathAnswer",
        "ToolPathFigures",
    ),
    "gearmesh.answers.bodies.topography": (
        "FlankTopography",
        "TopographyFigures",
    ),
    "gearmesh.answers.check": (
        "Check",
        "RollTest",
        "Verdict",
    ),
    "gearmesh.answers.contact.contact": ("Contact",),
    "gearmesh.answers.contact.ease_off": (
        "EaseOffMap",
        "EaseOffPoint",
    ),
    "gearmesh.answers.contact.figures": ("PositionFigures",),
    "gearmesh.answers.contact.fit": ("BacklashCurve",),
    "gearmesh.answers.contact.sides": ("SideContact",),
    "gearmesh.answers.contact.vh": (
        "PlaceFigures",
        "TotalFigures",
        "VHCheck",
    ),
    "gearmesh.answers.exchange": (
        "RexsExport",
        "RexsReading",
        "load_rexs",
    ),
    "gearmesh.answers.inspection.composite": (
        "CompositeFigures",
        "CompositeTest",
    ),
    "gearmesh.answers.inspection.correction": (
        "Correction",
        "CorrectionFigures",
    ),
    "gearmesh.answers.inspection.figures": ("InspectionFigures",),
    "gearmesh.answers.inspection.flank_map": (
        "DeviationMap",
        "MeasuredTrace",
    ),
    "gearmesh.answers.inspection.inspection": ("Inspection",),
    "gearmesh.answers.limits": (
        "Limits",
        "MemberLimitFigures",
    ),
    "gearmesh.answers.load.figures": (
        "LoadedFigures",
        "LoadedPosition",
        "LoadedTotals",
        "ToothPairPosition",
    ),
    "gearmesh.answers.load.loaded": ("LoadedContact",),
    "gearmesh.answers.pinned": ("Pinned",),
    "gearmesh.answers.planetary_sizing": (
        "PlanetarySizing",
        "RejectedFigures",
        "SetFigures",
        "size_planetary",
    ),
    "gearmesh.answers.result": (
        "Result",
        "RunTime",
    ),
    "gearmesh.answers.sheet": (
        "Compensation",
        "DesignSheet",
        "SettingFigures",
    ),
    "gearmesh.answers.sizing": (
        "CandidateFigures",
        "Sizing",
        "size",
    ),
    "gearmesh.answers.tables": ("Listing",),
    "gearmesh.api.gear": ("gear",),
    "gearmesh.api.gears": (
        "Gears",
        "build",
    ),
    "gearmesh.cad.contours.curves": ("Contour",),
    "gearmesh.cad.step": ("Part",),
    "gearmesh.contact.conditions.refinement": ("Contacts",),
    "gearmesh.contact.engagement.engagement": ("Engagement",),
    "gearmesh.contact.engagement.turns": ("FullTurns",),
    "gearmesh.contact.path": ("ContactPath",),
    "gearmesh.design.core": (
        "Design",
        "MemberMount",
    ),
    "gearmesh.design.files": ("toml",),
    "gearmesh.design.keys": (
        "Key",
        "KeyLine",
        "Table",
    ),
    "gearmesh.drawing.drawing": ("WorkshopDrawing",),
    "gearmesh.drawing.outline": ("Outline",),
    "gearmesh.errors": (
        "DesignError",
        "GearmeshError",
        "NoSolutionError",
        "OutputError",
    ),
    "gearmesh.figures": (
        "Entry",
        "Figure",
        "Summary",
    ),
    "gearmesh.kernel.motion.joint": (
        "Joint",
        "MotionUnits",
    ),
    "gearmesh.kernel.motion.rigid": ("Rigid",),
    "gearmesh.kernel.plane.curves": (
        "PlaneArc",
        "PlaneCurve",
        "PlaneLine",
    ),
    "gearmesh.kernel.surface.levels": (
        "ConeLevel",
        "ConeSurface",
        "Level",
    ),
    "gearmesh.kernel.surface.surface": (
        "Jet",
        "Surface",
    ),
    "gearmesh.loaded.mounts": ("FlexibleMount",),
    "gearmesh.mesh.triangles": ("TriangleMesh",),
    "gearmesh.metrology.second_order": ("SecondOrder",),
    "gearmesh.metrology.tolerances": (
        "FigureClass",
        "GearClass",
    ),
    "gearmesh.reports.report": ("ReportPage",),
    "gearmesh.reports.run": ("Report",),
    "gearmesh.study.largest_errors": (
        "KeyRange",
        "LargestErrors",
    ),
    "gearmesh.study.rows.patterns": ("AssemblyContact",),
    "gearmesh.study.statistics": ("Effect",),
    "gearmesh.study.study": ("Study",),
    "gearmesh.study.summary": ("StudySummary",),
    "gearmesh.study.variance": ("VarianceShare",),
    "gearmesh.systems.beveloid.design": ("BeveloidDesign",),
    "gearmesh.systems.circular_arc.design": ("CircularArcDesign",),
    "gearmesh.systems.circular_arc.fillets": ("ArcRack",),
    "gearmesh.systems.cylindrical.design": (
        "CylindricalDesign",
        "CylindricalMember",
    ),
    "gearmesh.systems.cylindrical.planetary.design": ("PlanetaryDesign",),
    "gearmesh.systems.cylindrical.planetary.sizing": ("SetCandidate",),
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
    "gearmesh.systems.spiral_bevel.design": (
        "EaseOffTable",
        "SpiralBevelDesign",
    ),
    "gearmesh.systems.spiral_bevel.hypoid_design": ("HypoidDesign",),
    "gearmesh.systems.system": (
        "System",
        "ToolPart",
        "kinds",
        "register",
        "system",
    ),
    "gearmesh.systems.worm_drive.design": ("WormDriveDesign",),
    "gearmesh.teeth.blank.body": (
        "Body",
        "Disc",
        "PlaneFace",
        "TurnedStep",
    ),
    "gearmesh.teeth.blank.end_edge": ("EndChamfer",),
    "gearmesh.teeth.blank.features": (
        "Boss",
        "Drilling",
        "Opening",
        "Slot",
    ),
    "gearmesh.teeth.blank.halves": (
        "AxialGap",
        "HalfGear",
    ),
    "gearmesh.teeth.end_strip": (
        "EndStrip",
        "SharpOutline",
        "StripPiece",
    ),
    "gearmesh.teeth.gear_train": (
        "GearPair",
        "GearTrain",
        "Member",
    ),
    "gearmesh.teeth.mount": ("Mount",),
    "gearmesh.teeth.region": (
        "Region",
        "Side",
    ),
    "gearmesh.teeth.section": (
        "Ends",
        "Grid",
        "Link",
        "Sections",
    ),
    "gearmesh.teeth.tooth": ("Tooth",),
    "gearmesh.teeth.tooth_side": ("ToothSide",),
    "gearmesh.tools.rack": ("Parabola",),
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
