"""Names that were public until version 0.17.0 and go with version 0.20.0; until then `gearmesh.NAME` works and warns.

The module is read when one of these names is used, and is removed as a whole with version 0.20.0.
"""

from __future__ import annotations

import warnings
from importlib import import_module
from typing import Any

GOES_WITH_VERSION = "0.20.0"

#: modules below gearmesh, and the names that were public
FORMER_NAMES = """
answers.bodies.cad: CadFigures CadSurfaceFigures
answers.bodies.face_names: FaceNameFigures
answers.bodies.measuring_grid: MeasuringGridFigures PointColumns
answers.bodies.model_figures: CyclicFigures DeckFigures HalfAxes MeshFigures ModelFigures Resolution
answers.bodies.model_figures: SolutionFigures SolvedContact SolvedFillets SolvedToothPair
answers.bodies.section: SectionFigures
answers.bodies.solid: SolidFigures
answers.bodies.toolpath: PathAngles SurfaceLeft ToolPathFigures
answers.bodies.topography: AmountColumns TopographyFigures
answers.check: RollRow Verdict
answers.contact.ease_off: EaseOffPoint
answers.contact.figures: CurvatureFigures EllipseFigures HertzFigures MemberPoint PairCurvature PositionFigures
answers.contact.fit: BacklashCurve
answers.contact.sides: SideContact
answers.contact.vh: Displacement NearestPlace PlaceFigures TotalFigures
answers.exchange: TorqueFigures UnusedAttributeFigures
answers.inspection.composite: CompositeFigures
answers.inspection.correction: CorrectedSettingFigures CorrectionFigures EffectFigures ExchangeFigures
answers.inspection.correction: PrognosisFigures ResidualFigures
answers.inspection.figures: ClassFigures FlankInspectionFigures FlankOrderFigures InspectionFigures PitchFigures
answers.inspection.figures: TraceFigures
answers.inspection.flank_map: DeviationMap MeasuredTrace
answers.inspection.machine_settings: MovableSetting
answers.limits: LimitingLineFigures MemberLimitFigures SideLimitFigures
answers.load.figures: FilletFigures LoadedFigures LoadedPosition LoadedTotals MemberDisplacement ToothPairFigures
answers.load.figures: ToothPairPosition
answers.planetary_sizing: RejectedFigures SetFigures
answers.result: RunTime
answers.sheet: MissingFigures SettingFigures
answers.sizing: CandidateFigures
answers.tables: Listing
cad.contours.curves: Contour
cad.section: MemberSection
cad.step: NamedFace Occurrence Part PartAssembly
check.roll: RollContact
contact.assemblies: AssemblyPaths
contact.conditions.refinement: Contacts
contact.engagement.cycle: Break Cycle
contact.engagement.ease_off: EaseOff
contact.engagement.engagement: Engagement
contact.engagement.turns: FullTurns Wave
contact.fit.clearance: Clearance
contact.fit.fit: Fit Gap Interference TipCollision
contact.fit.tight_mesh: TightMesh
contact.flanks: PathHertz
contact.path: ContactPath
design.core: BoltHoles BoreSteps ContactTable FiniteElementTable FlankContact GearBody Holes Hub Keyway
design.core: MaterialTable MemberMaterial MemberMount MeshTable Phi1 RexsSource ShaftSteps SpokeTable
design.core: UnloadedElementTable Web
design.keys: Key KeyLine Table
design.measured: PairMeasured PlanetaryMeasured RackMeasured WormDriveMeasured
design.modifications: EndRelief Modifications ProfileRelief TriangularRelief
design.topography_file: TopographyGrid
drawing.outline: Outline ToothRow
errors: Bounds
fe.results: ContactFigures ContactTotal NodalSolution ReferenceNode
figures: Entry Figure Figures
kernel.motion.joint: Joint MotionUnits
kernel.motion.motion: MachineAxis
kernel.plane.curves: PlaneArc PlaneCurve PlaneLine
kernel.surface.levels: ConeLevel ConeSurface LandLevel LandSurface Level
kernel.surface.surface: GeneratedSurface Jet Surface
loaded.root_stress: RootStress
loaded.separation: Separation
loaded.sharing: LoadedMesh PairLoad
member_names: MemberNames
mesh.hexahedra.hexes: HexMesh
mesh.triangles: TriangleMesh
metrology.correction: Exchange SettingChanges
metrology.evaluation: EvaluatedTrace TraceRange
metrology.flanks.measuring_grid: MeasuringGrid
metrology.measured_teeth: FlankDeviations MeasuredTeeth
metrology.pitch: PitchDeviations
metrology.second_order: SecondOrder
metrology.tolerances: FigureClass GearClass
study.largest_errors: KeyRange LargestFigures
study.plan: Plan
study.rows.patterns: AssemblyContact
study.statistics: Effect Limit
study.variance: VarianceShare
systems.beveloid.design: BeveloidAssembly BeveloidMember
systems.circular_arc.design: CircularArcAssembly CircularArcContact CircularArcGear CircularArcPinion
systems.circular_arc.fillets: ArcRack
systems.common.standards.iso286: Deviations
systems.common.worm_keys: WormTool
systems.common.bevel.design: BevelAssembly BevelBody
systems.cylindrical.allowance_keys: DiameterTolerance ThicknessAllowance
systems.cylindrical.design: CylindricalAssembly CylindricalMember Hob ShaperCutter
systems.cylindrical.allowance_keys: BallMeasurement SpanMeasurement
systems.cylindrical.merit: MeshMerit
systems.cylindrical.planetary.design: PlanetaryAssembly RingMember
systems.cylindrical.planetary.sizing: RejectedSet SetCandidate SetSearch SetTrial WantedSet
systems.cylindrical.rack.design: BoltRow RackAssembly RackTable SingleRackDesign
systems.cylindrical.single.design: SingleGearDesign
systems.cylindrical.sizing: Candidate Wanted
systems.face_gear.design: FaceGearAssembly FaceGearGear FaceGearMachine FaceGearPinion FaceGearWorm ShaperTool
systems.parabolic_helical.design: DiskTool ModifiedInvoluteGear NovikovGear ParabolicAssembly ParabolicMember
systems.parabolic_helical.design: ParabolicPinion
systems.spiral_bevel.conjugate.design: ConjugateContact ConjugateMember
systems.spiral_bevel.design: BevelContact BevelGear BevelPinion BladeTable EaseOffTable
systems.spiral_bevel.design: GearCutter PinionSide SpiralBevelContact
systems.system: Displacements DrawnRows MissingValue PatternCheck PatternShift Reserve Setting Sheet SheetTable
systems.system: ToolPart
systems.worm_drive.design: HobTable WheelTable WormDriveAssembly WormTable
teeth.blank.blank: Blank
teeth.blank.body: Body Disc PlaneFace TurnedStep
teeth.blank.end_edge: EndChamfer
teeth.blank.bores: Slot
teeth.blank.features: BodyFeatures Boss Drilling HoleRow Opening Pattern Spokes
teeth.blank.halves: AxialGap HalfGear Rows
teeth.blank.tip_edge: TipEdge
teeth.end_strip: EndStrip SharpOutline StripPiece
teeth.flank_frame: FlankFrame
teeth.limits: LostFlank MemberLimits SideLimits
teeth.micro_geometry.deviations: DeviationGrid
teeth.micro_geometry.index_angles: IndexAngles
teeth.mount: Mount
teeth.region: Region Side
teeth.section: Ends Grid Link Sections
teeth.tooth: Tooth
teeth.tooth_side: Bottom TipCorner ToothSide
toolpath.motion: ToolMotion
toolpath.order: PathOrder
tools.rack: Parabola RackLine
"""
MODULE_OF_FORMER_NAME = {
    name: f"gearmesh.{module}"
    for module, _, names in (line.partition(": ") for line in FORMER_NAMES.split("\n") if line)
    for name in names.split()
}


def former_name(name: str) -> Any:
    """Return what a former public name stood for, with a warning; AttributeError if it was none."""
    if name not in MODULE_OF_FORMER_NAME:
        raise AttributeError(f"module 'gearmesh' has no attribute {name!r}")
    module = MODULE_OF_FORMER_NAME[name]
    words = f"gearmesh.{name} is deprecated and goes with version {GOES_WITH_VERSION}; it stands in {module}, which is internal"
    warnings.warn(words, DeprecationWarning, stacklevel=3)
    return getattr(import_module(module), name)
