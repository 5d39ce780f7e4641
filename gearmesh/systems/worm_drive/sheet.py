"""Sheet of a worm drive: symbols and values of ISO 10828 and DIN 3975, backlash, friction, measures, contact.

Workshop drawings of worm and wheel show some of its rows [DIN 3966-3, ISO 1340].
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.contact.fit.fit import fit
from gearmesh.systems.common.plain_sheet import plain_sheet
from gearmesh.systems.common.standards.iso10828 import ThreadForm
from gearmesh.systems.common.symbol_table import Missing, Row, Values, table, tables_by_title, tables_of
from gearmesh.systems.system import DrawnRows, Sheet, SheetTable
from gearmesh.systems.worm_drive.build import DIAMETER_TOLERANCE, hob_apart, nominal_thread, wheel_hob, worm_thread
from gearmesh.systems.worm_drive.cutting.feed import generating_length
from gearmesh.systems.worm_drive.force_tables import MEMBER_NAMES, efficiencies, thread_mesh
from gearmesh.systems.worm_drive.load_parameters import contact_rows
from gearmesh.systems.worm_drive.thread import WormThread
from gearmesh.systems.worm_drive.wires import NO_WIRE, flank_radius, over_balls, wire_rows, wires_at
from gearmesh.teeth.limits import LostFlank, lost_flank
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.worm_drive.design import WormDriveDesign
    from gearmesh.teeth.gear_train import GearTrain


#: columns of tables of the pair
PAIR_COLUMNS = ("",)
#: title of the table of the hob
HOB_TITLE = "Wheel: the hob"
#: title of the table of undercut
UNDERCUT_TITLE = "Wheel: undercut"


def data_sheet(design: WormDriveDesign, train: GearTrain) -> Sheet:
    """Return derived keys, members and axes as for every system, then the tables of a worm drive."""
    design_mm, plain = design.in_mm(), plain_sheet(design, train)
    tip = train.members["wheel"].tooth.blank.tip
    helical = design_mm.wheel.form == "helical"
    # raises DesignError for given wires that do not fit
    wires = wire_rows(design_mm)
    tables = (
        *plain.tables,
        *tables_by_title(
            {
                "Pair [ISO 10828, DIN 3975]": (PAIR_COLUMNS, lambda: _pair(design_mm)),
                "Worm and wheel [ISO 10828, DIN 3975]": (
                    MEMBER_NAMES,
                    lambda: [*_threads(design_mm), *_diameters(design_mm, float(tip.at(0.0)))],
                ),
                "Worm: thickness and over wires": (MEMBER_NAMES[:1], lambda: [*_thickness(design_mm), *wires]),
            }
        ),
        *(tables_of(("Worm: dual lead", lambda: _dual_lead(design_mm))) if design_mm.worm.dual_lead else ()),
        *(
            ()
            if helical
            else tables_of((HOB_TITLE, lambda: _hob(design_mm, train)), (UNDERCUT_TITLE, lambda: _undercut(train)))
        ),
        *tables_by_title({"Backlash and friction": (PAIR_COLUMNS, lambda: _backlash(design_mm, train))}),
    )
    if not helical:
        lines = {
            "Contact lines, wheel of a hob of the worm's size": (PAIR_COLUMNS, lambda: contact_rows(design_mm, tip))
        }
        tables += tables_by_title(lines)
    return Sheet(tables, plain.values, plain.replaced, plain.warnings)


def _pair(design: WormDriveDesign) -> list[Row]:
    """Return the rows of the pair."""
    thread, m = nominal_thread(design), design.axial_module
    return [
        ("form", "flank form", "", (design.worm.form,)),
        ("a", "centre distance", "mm", (design.center_distance,)),
        ("Sigma", "shaft angle", "deg", (design.shaft_angle,)),
        ("i", "ratio", "-", (design.wheel.teeth / design.worm.threads,)),
        ("m_x", "axial module", "mm", (m,)),
        ("m_n", "normal module", "mm", (m * math.cos(thread.lead_angle),)),
        ("q", "diameter quotient", "-", (design.reference_diameter / m,)),
        ("gamma_m", "lead angle", "deg", (math.degrees(thread.lead_angle),)),
        ("alpha_0", "pressure angle of the tool", "deg", (design.pressure_angle,)),
        ("alpha_n", "normal pressure angle", "deg", (math.degrees(thread.normal_angle),)),
        ("v_g / n_1", "sliding speed at d_m1, per speed", "m/s min", (_sliding(thread),)),
    ]


def _sliding(thread: WormThread) -> float:
    """Return the sliding speed on the reference cylinder, m/s per 1/min."""
    return 2.0 * thread.radius * math.pi / (60000.0 * math.cos(thread.lead_angle))


def _threads(design: WormDriveDesign) -> list[Row]:
    """Return the rows of threads and teeth."""
    thread, worm, m = nominal_thread(design), design.worm, design.axial_module
    helix = math.degrees(design.wheel_helix_angle) if design.wheel.form == "helical" else None
    right: Values = ("right" if worm.right_hand else "left",) * 2
    return [
        ("z", "threads, teeth", "-", (worm.threads, design.wheel.teeth)),
        ("hand", "hand", "", right),
        ("beta", "helix angle, of a helical wheel", "deg", (None, helix)),
        ("p_x", "axial pitch", "mm", (thread.axial_pitch, None)),
        ("p_z", "lead", "mm", (thread.axial_pitch * thread.threads, None)),
        ("h_am", "addendum in the middle plane", "mm", (worm.addendum * m, design.wheel.addendum * m)),
        ("h_fm", "dedendum", "mm", (worm.dedendum * m, None)),
        ("x_2", "profile shift", "-", (None, design.wheel.profile_shift)),
    ]


def _diameters(design: WormDriveDesign, tip: float) -> list[Row]:
    """Return the rows of diameters and widths; `tip`: tip radius of the wheel in the middle plane, mm."""
    thread, worm, wheel, m = nominal_thread(design), design.worm, design.wheel, design.axial_module
    hob, d1 = wheel_hob(design), 2.0 * thread.radius
    tip_1, root_1 = d1 + 2.0 * worm.addendum * m, d1 - 2.0 * worm.dedendum * m
    root_2 = 2.0 * (hob.distance - hob.tip_radius)
    base = 2.0 * thread.base_radius if thread.form is ThreadForm.ZI else None
    wide = effective_width(0.5 * tip_1, design.center_distance - 0.5 * wheel.outside_diameter)
    clear = design.center_distance - 0.5 * np.array([tip_1 + root_2, root_1 + 2.0 * tip])
    return [
        ("d", "reference diameter", "mm", (d1, design.wheel_reference_diameter)),
        ("d_m", "mean diameter, 2 a - d_m1 of the wheel", "mm", (d1, 2.0 * design.center_distance - d1)),
        ("d_a", "tip diameter, in the middle plane", "mm", (tip_1, 2.0 * tip)),
        ("d_e", "outside diameter", "mm", (tip_1, wheel.outside_diameter)),
        ("r_k", "throat radius, r_g2 of ISO 10828", "mm", (None, wheel.throat_radius if wheel.throated else None)),
        ("d_f", "root diameter, in the middle plane", "mm", (root_1, root_2)),
        ("d_b", "base diameter, of ZI", "mm", (base, None)),
        ("b", "length of the thread, face width", "mm", (worm.length, wheel.face_width)),
        ("l_o", "run-out of the threads beyond that, at either end", "mm", (worm.run_out or None, None)),
        ("b_H", "effective face width", "mm", (None, min(wide, wheel.face_width))),
        ("c", "tip clearance to the other's root", "mm", (float(clear[0]), float(clear[1]))),
    ]


def effective_width(tip: float, height: float) -> float:
    """Return the width (mm) over which the worm's tip cylinder is inside the wheel's outside cylinder.

    `tip`: radius of the worm's tip, mm; `height`: distance of the outside cylinder from the worm's axis, mm.
    """
    return 2.0 * math.sqrt(max(0.0, tip**2 - height**2))


def _thickness(design: WormDriveDesign) -> list[Row]:
    """Return the rows of thickness of the worm as made, including backlash, on the reference cylinder."""
    thread = worm_thread(design)
    axial = 2.0 * thread.half_thickness(thread.radius)
    narrower = math.cos(thread.lead_angle)
    space = thread.axial_pitch - axial
    return [
        ("s_mx", "axial thickness of the thread", "mm", (axial,)),
        ("e_mx", "axial width of the space", "mm", (space,)),
        ("s_mn", "normal thickness of the thread", "mm", (axial * narrower,)),
        ("e_mn", "normal width of the space", "mm", (space * narrower,)),
    ]


def _dual_lead(design: WormDriveDesign) -> tuple[SheetTable, SheetTable]:
    """Return the tables of the flanks of both leads, and of the thickness along the axis.

    At z the threads are 2 e z thicker than in the middle, for left-hand worms thinner.
    """
    worm, m, sides = design.worm, design.axial_module, (1, -1)
    flanks = [worm_thread(design, side) for side in sides]
    hobs = [wheel_hob(design, side).thread for side in sides]

    def both(figure: Callable[[WormThread], float], threads: list[WormThread] = flanks) -> Values:
        """Return a value of both flanks."""
        return tuple(map(figure, threads))

    leads: list[Row] = [
        ("m_x", "axial module", "mm", both(lambda thread: thread.module)),
        ("p_x", "axial pitch", "mm", both(lambda thread: thread.axial_pitch)),
        ("p_z", "lead", "mm", both(lambda thread: thread.axial_pitch * thread.threads)),
        ("gamma_m", "lead angle", "deg", both(lambda thread: math.degrees(thread.lead_angle))),
        ("alpha_n", "normal pressure angle", "deg", both(lambda thread: math.degrees(thread.normal_angle))),
    ]
    if worm.form == ThreadForm.ZI:
        leads.append(("d_b", "base diameter", "mm", both(lambda thread: 2.0 * thread.base_radius)))
    if design.wheel.form != "helical":
        leads += [
            ("m_x0", "axial module of the hob", "mm", both(lambda thread: thread.module, hobs)),
            ("gamma_0", "lead angle of the hob", "deg", both(lambda thread: math.degrees(thread.lead_angle), hobs)),
        ]
    places = (-0.5 * worm.length, 0.0, 0.5 * worm.length)
    grown = [2.0 * worm.dual_lead * flanks[0].hand * z for z in places]
    middle = sum(thread.half_thickness(thread.radius) for thread in flanks)
    mean = nominal_thread(design)
    wires = worm.wire_diameter or wires_at(worm_thread(design), mean.radius).diameter
    radii = max(flank_radius(design, thread) for thread in flanks), mean.radius + worm.addendum * m
    over = [over_balls((flanks[0], flanks[1]), wires, mean.axial_pitch - more, radii) for more in grown]
    # balls that do not project from their spaces cannot be measured over
    measured = tuple(d if d >= 2.0 * radii[1] else Missing(NO_WIRE) for d in over)
    along: list[Row] = [
        ("z", "position along the axis", "mm", places),
        ("s_mx", "axial thickness of the thread", "mm", tuple(middle + more for more in grown)),
        ("e_mx", "axial width of the space", "mm", tuple(mean.axial_pitch - middle - more for more in grown)),
        ("D_M", "diameter of the balls", "mm", (wires,) * 3),
        ("M_d", "diameter over two balls in spaces there", "mm", measured),
    ]
    return (
        table("Worm: flanks of both leads", ("right flanks", "left flanks"), leads),
        table("Worm: thickness along the axis", ("toe", "middle", "heel"), along),
    )


def _hob(design: WormDriveDesign, train: GearTrain) -> SheetTable:
    """Return the table of the hob."""
    hob = wheel_hob(design)
    made, tooth = hob.thread, train.members["wheel"].tooth.unmodified_tooth
    mean = nominal_thread(design)
    alike = (made.radius, made.threads) == (mean.radius, mean.threads)
    # threads of one size are equal at all heights
    height = None if alike else design.hob.pitch_height * design.axial_module
    rows: list[Row] = [
        ("z_0", "threads of the hob", "-", (made.threads,)),
        ("m_x0", "axial module of the hob", "mm", (made.module,)),
        ("d_0", "reference diameter of the hob", "mm", (2.0 * made.radius,)),
        ("d_a0", "tip diameter of the hob", "mm", (2.0 * hob.tip_radius,)),
        ("gamma_0", "lead angle of the hob", "deg", (math.degrees(made.lead_angle),)),
        ("s_mx0", "axial thickness of its thread", "mm", (2.0 * made.half_thickness(made.radius),)),
        ("a_0", "centre distance of cutting", "mm", (hob.distance,)),
        ("h_w0", "height over d_0 and d_m1 at which hob and worm have one normal pitch", "mm", (height,)),
        (
            "eta_0",
            "swivel of the hob, usually gamma_w0 - gamma_w, lead angles at the height h_w0",
            "deg",
            (design.hob.swivel_angle,),
        ),
        ("feed", "feed of the hob", "", (design.hob.feed,)),
        ("l_0", "least length of its threads, or way of its tangential feed", "mm", (generating_length(tooth, hob),)),
    ]
    return table(HOB_TITLE, MEMBER_NAMES[1:], rows)


def _undercut(train: GearTrain) -> SheetTable:
    """Return the table of hob flank lost to undercut of the wheel; it is nothing beside flanks without undercut."""
    lost = [lost_flank(train.members["wheel"].tooth, side) for side in Side]

    def both(figure: Callable[[LostFlank], float]) -> Values:
        """Return a value of both flanks."""
        return tuple(None if math.isnan(value := figure(lost_part)) else value for lost_part in lost)

    rows: list[Row] = [
        (
            "A_u / A",
            "share of the hob's flank that generates nothing that remains",
            "-",
            both(lambda lost_part: lost_part.share),
        ),
        ("b_u / b", "share of the face width that is undercut", "-", both(lambda lost_part: lost_part.face)),
        (
            "h_u / h",
            "greatest lost share of the hob's flank across the wheel",
            "-",
            both(lambda lost_part: lost_part.most),
        ),
        ("z_u", "where that is, along the wheel's axis", "mm", both(lambda lost_part: lost_part.at)),
    ]
    return table(UNDERCUT_TITLE, tuple(side.value for side in Side), rows)


def _backlash(design: WormDriveDesign, train: GearTrain) -> list[Row]:
    """Return the rows of backlash and friction.

    The backlash is that of an axial shift that separates the worm's flanks; the wheel turns by the shift over its
    reference radius. For a hob with its own distance or swivel it is the least that both flanks leave.
    """
    thread, mesh = nominal_thread(design), thread_mesh(design)
    radius = 0.5 * thread.module * design.wheel.teeth
    steep, angle = thread.lead_angle, thread.normal_angle
    normal, shift = design.backlash, design.backlash / (math.cos(steep) * math.cos(angle))
    if max(map(abs, hob_apart(design))) > DIAMETER_TOLERANCE:
        fitting = fit(train.pairs[0])
        normal = math.nan if fitting is None else fitting.normal_backlash[0]
        shift = math.nan if fitting is None else fitting.backlash[0] * radius
    round_wheel = shift / radius * 0.5 * design.wheel_reference_diameter
    rows: list[Row] = [
        ("j_n", "normal backlash", "mm", (normal,)),
        ("j_x", "axial backlash of the worm", "mm", (shift,)),
        ("j_t2", "circumferential backlash, at the wheel's reference circle", "mm", (round_wheel,)),
        ("j_phi2", "angular backlash of the wheel, worm fixed", "deg", (math.degrees(shift / radius),)),
        ("j_phi1", "angular backlash of the worm, wheel fixed", "deg", (math.degrees(shift / thread.screw),)),
        ("mu_s", "self-locking from this coefficient of friction on", "-", (math.tan(steep) * math.cos(angle),)),
        ("rho_s", "its angle of friction", "deg", (math.degrees(math.atan(math.tan(steep) * math.cos(angle))),)),
    ]
    if design.friction is None:
        return rows
    driving, driven = efficiencies(mesh, design.friction)
    return [
        *rows,
        ("mu", "coefficient of friction, by friction", "-", (design.friction,)),
        (
            "rho_z",
            "angle of friction mu / cos(alpha_n): self-locking up to this lead angle",
            "deg",
            (_friction_angle(design.friction, angle),),
        ),
        ("eta", "efficiency of the teeth, worm driving", "-", (driving,)),
        ("eta'", "efficiency of the teeth, wheel driving (none: self-locking)", "-", (driven,)),
    ]


def _friction_angle(friction: float, normal_angle: float) -> float:
    """Return the angle of friction mu / cos(alpha_n), deg."""
    return math.degrees(math.atan(friction / math.cos(normal_angle)))


#: symbols of the pair
PAIR_SYMBOLS = ("a", "Sigma", "m_x", "m_n", "q", "gamma_m", "alpha_0", "alpha_n", "j_n")
#: symbols of threads and teeth
TOOTH_SYMBOLS = ("z", "form", "hand", "p_x", "p_z", "x_2", "h_am", "h_fm", "d", "d_a", "d_e", "r_k", "d_f", "d_b")
#: symbols of the thickness, and of the hob
CUTTING_SYMBOLS = ("s_mx", "s_mn", "D_M", "M_d", "z_0", "d_0", "d_a0", "gamma_0", "a_0", "eta_0")
#: rows of the drawing
DRAWN_ROWS = DrawnRows(
    own=(*TOOTH_SYMBOLS, *CUTTING_SYMBOLS, *PAIR_SYMBOLS), mating=("z", "d", "d_a"), tip="d_e", reference=("d", "d")
)
