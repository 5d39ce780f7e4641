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
    from gearmesh.answers.bodies.cad import Cad, CadFigures, CadSurfaceFigures
    from gearmesh.answers.bodies.face_names import FaceNameFigures, FaceNames
    from gearmesh.answers.bodies.finite_element_model import FiniteElementModel, UnloadedFiniteElements
    from gearmesh.answers.bodies.finite_elements import FiniteElementDecks, FiniteElements, FiniteElementSolution
    from gearmesh.answers.bodies.measuring_grid import MeasuringGridFigures, MeasuringGrids, PointColumns
    from gearmesh.answers.bodies.model_figures import (
        CyclicFigures,
        DeckFigures,
        HalfAxes,
        MeshFigures,
        ModelFigures,
        Resolution,
        SolutionFigures,
        SolvedContact,
        SolvedFillets,
        SolvedToothPair,
    )
    from gearmesh.answers.bodies.section import Section, SectionFigures
    from gearmesh.answers.bodies.solid import Solid, SolidFigures, Solids
    from gearmesh.answers.bodies.toolpath import PathAngles, SurfaceLeft, ToolPathAnswer, ToolPathFigures
    from gearmesh.answers.bodies.topography import AmountColumns, FlankTopography, TopographyFigures
    from gearmesh.answers.check import Check, RollRow, RollTest, Verdict
    from gearmesh.answers.contact.contact import Contact
    from gearmesh.answers.contact.ease_off import EaseOffMap, EaseOffPoint
    from gearmesh.answers.contact.figures import (
        CurvatureFigures,
        EllipseFigures,
        HertzFigures,
        MemberPoint,
        PairCurvature,
        PositionFigures,
    )
    from gearmesh.answers.contact.fit import BacklashCurve
    from gearmesh.answers.contact.sides import SideContact
    from gearmesh.answers.contact.vh import Displacement, NearestPlace, PlaceFigures, TotalFigures, VHCheck
    from gearmesh.answers.exchange import RexsExport, RexsReading, TorqueFigures, UnusedAttributeFigures, load_rexs
    from gearmesh.answers.inspection.composite import CompositeFigures, CompositeTest
    from gearmesh.answers.inspection.correction import (
        CorrectedSettingFigures,
        Correction,
        CorrectionFigures,
        EffectFigures,
        ExchangeFigures,
        PrognosisFigures,
        ResidualFigures,
    )
    from gearmesh.answers.inspection.figures import (
        ClassFigures,
        FlankInspectionFigures,
        FlankOrderFigures,
        InspectionFigures,
        PitchFigures,
        TraceFigures,
    )
    from gearmesh.answers.inspection.flank_map import DeviationMap, MeasuredTrace
    from gearmesh.answers.inspection.inspection import Inspection
    from gearmesh.answers.inspection.machine_settings import MovableSetting
    from gearmesh.answers.limits import LimitingLineFigures, Limits, MemberLimitFigures, SideLimitFigures
    from gearmesh.answers.load.figures import (
        FilletFigures,
        LoadedFigures,
        LoadedPosition,
        LoadedTotals,
        MemberDisplacement,
        ToothPairFigures,
        ToothPairPosition,
    )
    from gearmesh.answers.load.loaded import LoadedContact
    from gearmesh.answers.pinned import Pinned
    from gearmesh.answers.planetary_sizing import PlanetarySizing, RejectedFigures, SetFigures, size_planetary
    from gearmesh.answers.result import Result, RunTime
    from gearmesh.answers.sheet import Compensation, DesignSheet, MissingFigures, SettingFigures
    from gearmesh.answers.sizing import CandidateFigures, Sizing, size
    from gearmesh.answers.tables import Listing
    from gearmesh.api.gear import gear
    from gearmesh.api.gears import Gears, build
    from gearmesh.cad.contours.curves import Contour
    from gearmesh.cad.section import MemberSection
    from gearmesh.cad.step import NamedFace, Occurrence, Part, PartAssembly
    from gearmesh.check.roll import RollContact
    from gearmesh.contact.assemblies import AssemblyPaths
    from gearmesh.contact.conditions.refinement import Contacts
    from gearmesh.contact.engagement.cycle import Break, Cycle
    from gearmesh.contact.engagement.ease_off import EaseOff
    from gearmesh.contact.engagement.engagement import Engagement
    from gearmesh.contact.engagement.turns import FullTurns, Wave
    from gearmesh.contact.fit.clearance import Clearance
    from gearmesh.contact.fit.fit import Fit, Gap, Interference, TipCollision
    from gearmesh.contact.fit.tight_mesh import TightMesh
    from gearmesh.contact.flanks import PathHertz
    from gearmesh.contact.path import ContactPath
    from gearmesh.design.core import (
        BoltHoles,
        BoreSteps,
        ContactTable,
        Design,
        FiniteElementTable,
        FlankContact,
        GearBody,
        Holes,
        Hub,
        Keyway,
        MaterialTable,
        MemberMaterial,
        MemberMount,
        MeshTable,
        Phi1,
        RexsSource,
        ShaftSteps,
        SpokeTable,
        UnloadedElementTable,
        Web,
    )
    from gearmesh.design.files import toml
    from gearmesh.design.keys import Key, KeyLine, Table
    from gearmesh.design.measured import PairMeasured, PlanetaryMeasured, RackMeasured, WormDriveMeasured
    from gearmesh.design.modifications import EndRelief, Modifications, ProfileRelief, TriangularRelief
    from gearmesh.design.topography_file import TopographyGrid
    from gearmesh.drawing.drawing import WorkshopDrawing
    from gearmesh.drawing.outline import Outline, ToothRow
    from gearmesh.errors import Bounds, DesignError, GearmeshError, NoSolutionError, OutputError
    from gearmesh.fe.results import ContactFigures, ContactTotal, NodalSolution, ReferenceNode
    from gearmesh.figures import Entry, Figure, Figures, Summary
    from gearmesh.kernel.motion.joint import Joint, MotionUnits
    from gearmesh.kernel.motion.motion import MachineAxis
    from gearmesh.kernel.motion.rigid import Rigid
    from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve, PlaneLine
    from gearmesh.kernel.surface.levels import ConeLevel, ConeSurface, LandLevel, LandSurface, Level
    from gearmesh.kernel.surface.surface import GeneratedSurface, Jet, Surface
    from gearmesh.loaded.mounts import FlexibleMount
    from gearmesh.loaded.root_stress import RootStress
    from gearmesh.loaded.separation import Separation
    from gearmesh.loaded.sharing import LoadedMesh, PairLoad
    from gearmesh.member_names import MemberNames
    from gearmesh.mesh.hexahedra.hexes import HexMesh
    from gearmesh.mesh.triangles import TriangleMesh
    from gearmesh.metrology.correction import Exchange, SettingChanges
    from gearmesh.metrology.evaluation import EvaluatedTrace, TraceRange
    from gearmesh.metrology.flanks.measuring_grid import MeasuringGrid
    from gearmesh.metrology.measured_teeth import FlankDeviations, MeasuredTeeth
    from gearmesh.metrology.pitch import PitchDeviations
    from gearmesh.metrology.second_order import SecondOrder
    from gearmesh.metrology.tolerances import FigureClass, GearClass
    from gearmesh.reports.report import ReportPage
    from gearmesh.reports.run import Report
    from gearmesh.study.largest_errors import KeyRange, LargestErrors, LargestFigures
    from gearmesh.study.plan import Plan
    from gearmesh.study.rows.patterns import AssemblyContact
    from gearmesh.study.statistics import Effect, Limit
    from gearmesh.study.study import Study
    from gearmesh.study.summary import StudySummary
    from gearmesh.study.variance import VarianceShare
    from gearmesh.systems.beveloid.design import BeveloidAssembly, BeveloidDesign, BeveloidMember
    from gearmesh.systems.circular_arc.design import (
        CircularArcAssembly,
        CircularArcContact,
        CircularArcDesign,
        CircularArcGear,
        CircularArcPinion,
    )
    from gearmesh.systems.circular_arc.fillets import ArcRack
    from gearmesh.systems.common.standards.iso286 import Deviations
    from gearmesh.systems.common.worm_keys import WormTool
    from gearmesh.systems.cylindrical.allowance_keys import DiameterTolerance, ThicknessAllowance
    from gearmesh.systems.cylindrical.design import (
        CylindricalAssembly,
        CylindricalDesign,
        CylindricalMember,
        Hob,
        ShaperCutter,
    )
    from gearmesh.systems.cylindrical.measure_keys import BallMeasurement, SpanMeasurement
    from gearmesh.systems.cylindrical.merit import MeshMerit
    from gearmesh.systems.cylindrical.planetary.design import PlanetaryAssembly, PlanetaryDesign, RingMember
    from gearmesh.systems.cylindrical.planetary.sizing import RejectedSet, SetCandidate, SetSearch, SetTrial, WantedSet
    from gearmesh.systems.cylindrical.rack.design import BoltRow, RackAssembly, RackDesign, RackTable, SingleRackDesign
    from gearmesh.systems.cylindrical.single.design import SingleGearDesign
    from gearmesh.systems.cylindrical.sizing import Candidate, Wanted
    from gearmesh.systems.designs import load, new, parse
    from gearmesh.systems.face_gear.design import (
        FaceGearAssembly,
        FaceGearDesign,
        FaceGearGear,
        FaceGearMachine,
        FaceGearPinion,
        FaceGearWorm,
        ShaperTool,
    )
    from gearmesh.systems.parabolic_helical.design import (
        DiskTool,
        ModifiedInvoluteDesign,
        ModifiedInvoluteGear,
        NovikovDesign,
        NovikovGear,
        ParabolicAssembly,
        ParabolicMember,
        ParabolicPinion,
    )
    from gearmesh.systems.spiral_bevel.conjugate.design import ConjugateContact, ConjugateDesign, ConjugateMember
    from gearmesh.systems.spiral_bevel.design import (
        BevelAssembly,
        BevelBody,
        BevelContact,
        BevelGear,
        BevelPinion,
        BladeTable,
        EaseOffTable,
        GearCutter,
        PinionSide,
        SpiralBevelContact,
        SpiralBevelDesign,
    )
    from gearmesh.systems.spiral_bevel.hypoid_design import HypoidDesign
    from gearmesh.systems.system import (
        Displacements,
        DrawnRows,
        MissingValue,
        PatternCheck,
        PatternShift,
        Reserve,
        Setting,
        Sheet,
        SheetTable,
        System,
        ToolPart,
        kinds,
        register,
        system,
    )
    from gearmesh.systems.worm_drive.design import HobTable, WheelTable, WormDriveAssembly, WormDriveDesign, WormTable
    from gearmesh.teeth.blank.blank import Blank
    from gearmesh.teeth.blank.body import Body, Disc, PlaneFace, TurnedStep
    from gearmesh.teeth.blank.end_edge import EndChamfer
    from gearmesh.teeth.blank.features import BodyFeatures, Boss, Drilling, HoleRow, Opening, Pattern, Slot, Spokes
    from gearmesh.teeth.blank.halves import AxialGap, HalfGear, Rows
    from gearmesh.teeth.blank.tip_edge import TipEdge
    from gearmesh.teeth.end_strip import EndStrip, SharpOutline, StripPiece
    from gearmesh.teeth.flank_frame import FlankFrame
    from gearmesh.teeth.gear_train import GearPair, GearTrain, Member
    from gearmesh.teeth.limits import LostFlank, MemberLimits, SideLimits
    from gearmesh.teeth.micro_geometry.deviations import DeviationGrid
    from gearmesh.teeth.micro_geometry.index_angles import IndexAngles
    from gearmesh.teeth.mount import Mount
    from gearmesh.teeth.region import Region, Side
    from gearmesh.teeth.section import Ends, Grid, Link, Sections
    from gearmesh.teeth.tooth import Tooth
    from gearmesh.teeth.tooth_side import Bottom, TipCorner, ToothSide
    from gearmesh.toolpath.motion import ToolMotion
    from gearmesh.toolpath.toolpath import PathOrder
    from gearmesh.tools.rack import Parabola, RackLine
    from gearmesh.view.picture import Animation, Diagram, Picture

#: said here alone: pyproject.toml has it from here
__version__ = "0.18.0"

__all__ = [
    "AmountColumns",
    "Animation",
    "ArcRack",
    "AssemblyContact",
    "AssemblyPaths",
    "AxialGap",
    "BacklashCurve",
    "BallMeasurement",
    "BevelAssembly",
    "BevelBody",
    "BevelContact",
    "BevelGear",
    "BevelPinion",
    "BeveloidAssembly",
    "BeveloidDesign",
    "BeveloidMember",
    "BladeTable",
    "Blank",
    "Body",
    "BodyFeatures",
    "BoltHoles",
    "BoltRow",
    "BoreSteps",
    "Boss",
    "Bottom",
    "Bounds",
    "Break",
    "Cad",
    "CadFigures",
    "CadSurfaceFigures",
    "Candidate",
    "CandidateFigures",
    "Check",
    "CircularArcAssembly",
    "CircularArcContact",
    "CircularArcDesign",
    "CircularArcGear",
    "CircularArcPinion",
    "ClassFigures",
    "Clearance",
    "Compensation",
    "CompositeFigures",
    "CompositeTest",
    "ConeLevel",
    "ConeSurface",
    "ConjugateContact",
    "ConjugateDesign",
    "ConjugateMember",
    "Contact",
    "ContactFigures",
    "ContactPath",
    "ContactTable",
    "ContactTotal",
    "Contacts",
    "Contour",
    "CorrectedSettingFigures",
    "Correction",
    "CorrectionFigures",
    "CurvatureFigures",
    "Cycle",
    "CyclicFigures",
    "CylindricalAssembly",
    "CylindricalDesign",
    "CylindricalMember",
    "DeckFigures",
    "Design",
    "DesignError",
    "DesignSheet",
    "DeviationGrid",
    "DeviationMap",
    "Deviations",
    "Diagram",
    "DiameterTolerance",
    "Disc",
    "DiskTool",
    "Displacement",
    "Displacements",
    "DrawnRows",
    "Drilling",
    "EaseOff",
    "EaseOffMap",
    "EaseOffPoint",
    "EaseOffTable",
    "Effect",
    "EffectFigures",
    "EllipseFigures",
    "EndChamfer",
    "EndRelief",
    "EndStrip",
    "Ends",
    "Engagement",
    "Entry",
    "EvaluatedTrace",
    "Exchange",
    "ExchangeFigures",
    "FaceGearAssembly",
    "FaceGearDesign",
    "FaceGearGear",
    "FaceGearMachine",
    "FaceGearPinion",
    "FaceGearWorm",
    "FaceNameFigures",
    "FaceNames",
    "Figure",
    "FigureClass",
    "Figures",
    "FilletFigures",
    "FiniteElementDecks",
    "FiniteElementModel",
    "FiniteElementSolution",
    "FiniteElementTable",
    "FiniteElements",
    "Fit",
    "FlankContact",
    "FlankDeviations",
    "FlankFrame",
    "FlankInspectionFigures",
    "FlankOrderFigures",
    "FlankTopography",
    "FlexibleMount",
    "FullTurns",
    "Gap",
    "GearBody",
    "GearClass",
    "GearCutter",
    "GearPair",
    "GearTrain",
    "GearmeshError",
    "Gears",
    "GeneratedSurface",
    "Grid",
    "HalfAxes",
    "HalfGear",
    "HertzFigures",
    "HexMesh",
    "Hob",
    "HobTable",
    "HoleRow",
    "Holes",
    "Hub",
    "HypoidDesign",
    "IndexAngles",
    "Inspection",
    "InspectionFigures",
    "Interference",
    "Jet",
    "Joint",
    "Key",
    "KeyLine",
    "KeyRange",
    "Keyway",
    "LandLevel",
    "LandSurface",
    "LargestErrors",
    "LargestFigures",
    "Level",
    "Limit",
    "LimitingLineFigures",
    "Limits",
    "Link",
    "Listing",
    "LoadedContact",
    "LoadedFigures",
    "LoadedMesh",
    "LoadedPosition",
    "LoadedTotals",
    "LostFlank",
    "MachineAxis",
    "MaterialTable",
    "MeasuredTeeth",
    "MeasuredTrace",
    "MeasuringGrid",
    "MeasuringGridFigures",
    "MeasuringGrids",
    "Member",
    "MemberDisplacement",
    "MemberLimitFigures",
    "MemberLimits",
    "MemberMaterial",
    "MemberMount",
    "MemberNames",
    "MemberPoint",
    "MemberSection",
    "MeshFigures",
    "MeshMerit",
    "MeshTable",
    "MissingFigures",
    "MissingValue",
    "ModelFigures",
    "Modifications",
    "ModifiedInvoluteDesign",
    "ModifiedInvoluteGear",
    "MotionUnits",
    "Mount",
    "MovableSetting",
    "NamedFace",
    "NearestPlace",
    "NoSolutionError",
    "NodalSolution",
    "NovikovDesign",
    "NovikovGear",
    "Occurrence",
    "Opening",
    "Outline",
    "OutputError",
    "PairCurvature",
    "PairLoad",
    "PairMeasured",
    "Parabola",
    "ParabolicAssembly",
    "ParabolicMember",
    "ParabolicPinion",
    "Part",
    "PartAssembly",
    "PathAngles",
    "PathHertz",
    "PathOrder",
    "Pattern",
    "PatternCheck",
    "PatternShift",
    "Phi1",
    "Picture",
    "PinionSide",
    "Pinned",
    "PitchDeviations",
    "PitchFigures",
    "PlaceFigures",
    "Plan",
    "PlaneArc",
    "PlaneCurve",
    "PlaneFace",
    "PlaneLine",
    "PlanetaryAssembly",
    "PlanetaryDesign",
    "PlanetaryMeasured",
    "PlanetarySizing",
    "PointColumns",
    "PositionFigures",
    "ProfileRelief",
    "PrognosisFigures",
    "RackAssembly",
    "RackDesign",
    "RackLine",
    "RackMeasured",
    "RackTable",
    "ReferenceNode",
    "Region",
    "RejectedFigures",
    "RejectedSet",
    "Report",
    "ReportPage",
    "Reserve",
    "ResidualFigures",
    "Resolution",
    "Result",
    "RexsExport",
    "RexsReading",
    "RexsSource",
    "Rigid",
    "RingMember",
    "RollContact",
    "RollRow",
    "RollTest",
    "RootStress",
    "Rows",
    "RunTime",
    "SecondOrder",
    "Section",
    "SectionFigures",
    "Sections",
    "Separation",
    "SetCandidate",
    "SetFigures",
    "SetSearch",
    "SetTrial",
    "Setting",
    "SettingChanges",
    "SettingFigures",
    "ShaftSteps",
    "ShaperCutter",
    "ShaperTool",
    "SharpOutline",
    "Sheet",
    "SheetTable",
    "Side",
    "SideContact",
    "SideLimitFigures",
    "SideLimits",
    "SingleGearDesign",
    "SingleRackDesign",
    "Sizing",
    "Slot",
    "Solid",
    "SolidFigures",
    "Solids",
    "SolutionFigures",
    "SolvedContact",
    "SolvedFillets",
    "SolvedToothPair",
    "SpanMeasurement",
    "SpiralBevelContact",
    "SpiralBevelDesign",
    "SpokeTable",
    "Spokes",
    "StripPiece",
    "Study",
    "StudySummary",
    "Summary",
    "Surface",
    "SurfaceLeft",
    "System",
    "Table",
    "ThicknessAllowance",
    "TightMesh",
    "TipCollision",
    "TipCorner",
    "TipEdge",
    "ToolMotion",
    "ToolPart",
    "ToolPathAnswer",
    "ToolPathFigures",
    "Tooth",
    "ToothPairFigures",
    "ToothPairPosition",
    "ToothRow",
    "ToothSide",
    "TopographyFigures",
    "TopographyGrid",
    "TorqueFigures",
    "TotalFigures",
    "TraceFigures",
    "TraceRange",
    "TriangleMesh",
    "TriangularRelief",
    "TurnedStep",
    "UnloadedElementTable",
    "UnloadedFiniteElements",
    "UnusedAttributeFigures",
    "VHCheck",
    "VarianceShare",
    "Verdict",
    "Wanted",
    "WantedSet",
    "Wave",
    "Web",
    "WheelTable",
    "WorkshopDrawing",
    "WormDriveAssembly",
    "WormDriveDesign",
    "WormDriveMeasured",
    "WormTable",
    "WormTool",
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
    "gearmesh.answers.bodies.cad": (
        "Cad",
        "CadFigures",
        "CadSurfaceFigures",
    ),
    "gearmesh.answers.bodies.face_names": (
        "FaceNameFigures",
        "FaceNames",
    ),
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
        "PointColumns",
    ),
    "gearmesh.answers.bodies.model_figures": (
        "CyclicFigures",
        "DeckFigures",
        "HalfAxes",
        "MeshFigures",
        "ModelFigures",
        "Resolution",
        "SolutionFigures",
        "SolvedContact",
        "SolvedFillets",
        "SolvedToothPair",
    ),
    "gearmesh.answers.bodies.section": (
        "Section",
        "SectionFigures",
    ),
    "gearmesh.answers.bodies.solid": (
        "Solid",
        "SolidFigures",
        "Solids",
    ),
    "gearmesh.answers.bodies.toolpath": (
        "PathAngles",
        "SurfaceLeft",
        "ToolPathAnswer",
        "ToolPathFigures",
    ),
    "gearmesh.answers.bodies.topography": (
        "AmountColumns",
        "FlankTopography",
        "TopographyFigures",
    ),
    "gearmesh.answers.check": (
        "Check",
        "RollRow",
        "RollTest",
        "Verdict",
    ),
    "gearmesh.answers.contact.contact": ("Contact",),
    "gearmesh.answers.contact.ease_off": (
        "EaseOffMap",
        "EaseOffPoint",
    ),
    "gearmesh.answers.contact.figures": (
        "CurvatureFigures",
        "EllipseFigures",
        "HertzFigures",
        "MemberPoint",
        "PairCurvature",
        "PositionFigures",
    ),
    "gearmesh.answers.contact.fit": ("BacklashCurve",),
    "gearmesh.answers.contact.sides": ("SideContact",),
    "gearmesh.answers.contact.vh": (
        "Displacement",
        "NearestPlace",
        "PlaceFigures",
        "TotalFigures",
        "VHCheck",
    ),
    "gearmesh.answers.exchange": (
        "RexsExport",
        "RexsReading",
        "TorqueFigures",
        "UnusedAttributeFigures",
        "load_rexs",
    ),
    "gearmesh.answers.inspection.composite": (
        "CompositeFigures",
        "CompositeTest",
    ),
    "gearmesh.answers.inspection.correction": (
        "CorrectedSettingFigures",
        "Correction",
        "CorrectionFigures",
        "EffectFigures",
        "ExchangeFigures",
        "PrognosisFigures",
        "ResidualFigures",
    ),
    "gearmesh.answers.inspection.figures": (
        "ClassFigures",
        "FlankInspectionFigures",
        "FlankOrderFigures",
        "InspectionFigures",
        "PitchFigures",
        "TraceFigures",
    ),
    "gearmesh.answers.inspection.flank_map": (
        "DeviationMap",
        "MeasuredTrace",
    ),
    "gearmesh.answers.inspection.inspection": ("Inspection",),
    "gearmesh.answers.inspection.machine_settings": ("MovableSetting",),
    "gearmesh.answers.limits": (
        "LimitingLineFigures",
        "Limits",
        "MemberLimitFigures",
        "SideLimitFigures",
    ),
    "gearmesh.answers.load.figures": (
        "FilletFigures",
        "LoadedFigures",
        "LoadedPosition",
        "LoadedTotals",
        "MemberDisplacement",
        "ToothPairFigures",
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
        "MissingFigures",
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
    "gearmesh.cad.section": ("MemberSection",),
    "gearmesh.cad.step": (
        "NamedFace",
        "Occurrence",
        "Part",
        "PartAssembly",
    ),
    "gearmesh.check.roll": ("RollContact",),
    "gearmesh.contact.assemblies": ("AssemblyPaths",),
    "gearmesh.contact.conditions.refinement": ("Contacts",),
    "gearmesh.contact.engagement.cycle": (
        "Break",
        "Cycle",
    ),
    "gearmesh.contact.engagement.ease_off": ("EaseOff",),
    "gearmesh.contact.engagement.engagement": ("Engagement",),
    "gearmesh.contact.engagement.turns": (
        "FullTurns",
        "Wave",
    ),
    "gearmesh.contact.fit.clearance": ("Clearance",),
    "gearmesh.contact.fit.fit": (
        "Fit",
        "Gap",
        "Interference",
        "TipCollision",
    ),
    "gearmesh.contact.fit.tight_mesh": ("TightMesh",),
    "gearmesh.contact.flanks": ("PathHertz",),
    "gearmesh.contact.path": ("ContactPath",),
    "gearmesh.design.core": (
        "BoltHoles",
        "BoreSteps",
        "ContactTable",
        "Design",
        "FiniteElementTable",
        "FlankContact",
        "GearBody",
        "Holes",
        "Hub",
        "Keyway",
        "MaterialTable",
        "MemberMaterial",
        "MemberMount",
        "MeshTable",
        "Phi1",
        "RexsSource",
        "ShaftSteps",
        "SpokeTable",
        "UnloadedElementTable",
        "Web",
    ),
    "gearmesh.design.files": ("toml",),
    "gearmesh.design.keys": (
        "Key",
        "KeyLine",
        "Table",
    ),
    "gearmesh.design.measured": (
        "PairMeasured",
        "PlanetaryMeasured",
        "RackMeasured",
        "WormDriveMeasured",
    ),
    "gearmesh.design.modifications": (
        "EndRelief",
        "Modifications",
        "ProfileRelief",
        "TriangularRelief",
    ),
    "gearmesh.design.topography_file": ("TopographyGrid",),
    "gearmesh.drawing.drawing": ("WorkshopDrawing",),
    "gearmesh.drawing.outline": (
        "Outline",
        "ToothRow",
    ),
    "gearmesh.errors": (
        "Bounds",
        "DesignError",
        "GearmeshError",
        "NoSolutionError",
        "OutputError",
    ),
    "gearmesh.fe.results": (
        "ContactFigures",
        "ContactTotal",
        "NodalSolution",
        "ReferenceNode",
    ),
    "gearmesh.figures": (
        "Entry",
        "Figure",
        "Figures",
        "Summary",
    ),
    "gearmesh.kernel.motion.joint": (
        "Joint",
        "MotionUnits",
    ),
    "gearmesh.kernel.motion.motion": ("MachineAxis",),
    "gearmesh.kernel.motion.rigid": ("Rigid",),
    "gearmesh.kernel.plane.curves": (
        "PlaneArc",
        "PlaneCurve",
        "PlaneLine",
    ),
    "gearmesh.kernel.surface.levels": (
        "ConeLevel",
        "ConeSurface",
        "LandLevel",
        "LandSurface",
        "Level",
    ),
    "gearmesh.kernel.surface.surface": (
        "GeneratedSurface",
        "Jet",
        "Surface",
    ),
    "gearmesh.loaded.mounts": ("FlexibleMount",),
    "gearmesh.loaded.root_stress": ("RootStress",),
    "gearmesh.loaded.separation": ("Separation",),
    "gearmesh.loaded.sharing": (
        "LoadedMesh",
        "PairLoad",
    ),
    "gearmesh.member_names": ("MemberNames",),
    "gearmesh.mesh.hexahedra.hexes": ("HexMesh",),
    "gearmesh.mesh.triangles": ("TriangleMesh",),
    "gearmesh.metrology.correction": (
        "Exchange",
        "SettingChanges",
    ),
    "gearmesh.metrology.evaluation": (
        "EvaluatedTrace",
        "TraceRange",
    ),
    "gearmesh.metrology.flanks.measuring_grid": ("MeasuringGrid",),
    "gearmesh.metrology.measured_teeth": (
        "FlankDeviations",
        "MeasuredTeeth",
    ),
    "gearmesh.metrology.pitch": ("PitchDeviations",),
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
        "LargestFigures",
    ),
    "gearmesh.study.plan": ("Plan",),
    "gearmesh.study.rows.patterns": ("AssemblyContact",),
    "gearmesh.study.statistics": (
        "Effect",
        "Limit",
    ),
    "gearmesh.study.study": ("Study",),
    "gearmesh.study.summary": ("StudySummary",),
    "gearmesh.study.variance": ("VarianceShare",),
    "gearmesh.systems.beveloid.design": (
        "BeveloidAssembly",
        "BeveloidDesign",
        "BeveloidMember",
    ),
    "gearmesh.systems.circular_arc.design": (
        "CircularArcAssembly",
        "CircularArcContact",
        "CircularArcDesign",
        "CircularArcGear",
        "CircularArcPinion",
    ),
    "gearmesh.systems.circular_arc.fillets": ("ArcRack",),
    "gearmesh.systems.common.standards.iso286": ("Deviations",),
    "gearmesh.systems.common.worm_keys": ("WormTool",),
    "gearmesh.systems.cylindrical.allowance_keys": (
        "DiameterTolerance",
        "ThicknessAllowance",
    ),
    "gearmesh.systems.cylindrical.design": (
        "CylindricalAssembly",
        "CylindricalDesign",
        "CylindricalMember",
        "Hob",
        "ShaperCutter",
    ),
    "gearmesh.systems.cylindrical.measure_keys": (
        "BallMeasurement",
        "SpanMeasurement",
    ),
    "gearmesh.systems.cylindrical.merit": ("MeshMerit",),
    "gearmesh.systems.cylindrical.planetary.design": (
        "PlanetaryAssembly",
        "PlanetaryDesign",
        "RingMember",
    ),
    "gearmesh.systems.cylindrical.planetary.sizing": (
        "RejectedSet",
        "SetCandidate",
        "SetSearch",
        "SetTrial",
        "WantedSet",
    ),
    "gearmesh.systems.cylindrical.rack.design": (
        "BoltRow",
        "RackAssembly",
        "RackDesign",
        "RackTable",
        "SingleRackDesign",
    ),
    "gearmesh.systems.cylindrical.single.design": ("SingleGearDesign",),
    "gearmesh.systems.cylindrical.sizing": (
        "Candidate",
        "Wanted",
    ),
    "gearmesh.systems.designs": (
        "load",
        "new",
        "parse",
    ),
    "gearmesh.systems.face_gear.design": (
        "FaceGearAssembly",
        "FaceGearDesign",
        "FaceGearGear",
        "FaceGearMachine",
        "FaceGearPinion",
        "FaceGearWorm",
        "ShaperTool",
    ),
    "gearmesh.systems.parabolic_helical.design": (
        "DiskTool",
        "ModifiedInvoluteDesign",
        "ModifiedInvoluteGear",
        "NovikovDesign",
        "NovikovGear",
        "ParabolicAssembly",
        "ParabolicMember",
        "ParabolicPinion",
    ),
    "gearmesh.systems.spiral_bevel.conjugate.design": (
        "ConjugateContact",
        "ConjugateDesign",
        "ConjugateMember",
    ),
    "gearmesh.systems.spiral_bevel.design": (
        "BevelAssembly",
        "BevelBody",
        "BevelContact",
        "BevelGear",
        "BevelPinion",
        "BladeTable",
        "EaseOffTable",
        "GearCutter",
        "PinionSide",
        "SpiralBevelContact",
        "SpiralBevelDesign",
    ),
    "gearmesh.systems.spiral_bevel.hypoid_design": ("HypoidDesign",),
    "gearmesh.systems.system": (
        "Displacements",
        "DrawnRows",
        "MissingValue",
        "PatternCheck",
        "PatternShift",
        "Reserve",
        "Setting",
        "Sheet",
        "SheetTable",
        "System",
        "ToolPart",
        "kinds",
        "register",
        "system",
    ),
    "gearmesh.systems.worm_drive.design": (
        "HobTable",
        "WheelTable",
        "WormDriveAssembly",
        "WormDriveDesign",
        "WormTable",
    ),
    "gearmesh.teeth.blank.blank": ("Blank",),
    "gearmesh.teeth.blank.body": (
        "Body",
        "Disc",
        "PlaneFace",
        "TurnedStep",
    ),
    "gearmesh.teeth.blank.end_edge": ("EndChamfer",),
    "gearmesh.teeth.blank.features": (
        "BodyFeatures",
        "Boss",
        "Drilling",
        "HoleRow",
        "Opening",
        "Pattern",
        "Slot",
        "Spokes",
    ),
    "gearmesh.teeth.blank.halves": (
        "AxialGap",
        "HalfGear",
        "Rows",
    ),
    "gearmesh.teeth.blank.tip_edge": ("TipEdge",),
    "gearmesh.teeth.end_strip": (
        "EndStrip",
        "SharpOutline",
        "StripPiece",
    ),
    "gearmesh.teeth.flank_frame": ("FlankFrame",),
    "gearmesh.teeth.gear_train": (
        "GearPair",
        "GearTrain",
        "Member",
    ),
    "gearmesh.teeth.limits": (
        "LostFlank",
        "MemberLimits",
        "SideLimits",
    ),
    "gearmesh.teeth.micro_geometry.deviations": ("DeviationGrid",),
    "gearmesh.teeth.micro_geometry.index_angles": ("IndexAngles",),
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
    "gearmesh.teeth.tooth_side": (
        "Bottom",
        "TipCorner",
        "ToothSide",
    ),
    "gearmesh.toolpath.motion": ("ToolMotion",),
    "gearmesh.toolpath.toolpath": ("PathOrder",),
    "gearmesh.tools.rack": (
        "Parabola",
        "RackLine",
    ),
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
