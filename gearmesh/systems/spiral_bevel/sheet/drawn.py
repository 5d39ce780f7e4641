"""Rows of the data sheet on a workshop drawing of a bevel or hypoid gear [DIN 3966-2, ISO 1340], for its teeth as cut."""

from gearmesh.metrology.iso17485 import TOLERANCE_NAMES
from gearmesh.systems.common.bevel.sheet_rows import CUT_TEETH_TITLE
from gearmesh.systems.system import DrawnRows

#: symbols of teeth and cones
BLANK_SYMBOLS = (
    *("z", "m_et", "m_mn", "alpha_n", "beta_m", "hand", "r_c0", "delta", "delta_a", "delta_f", "Re", "Rm", "b"),
    *("de", "d_ae", "h_ae", "h_e", "h_am", "s_mnc", "h_amc", "tzF", "t_zR", "t_B", "t_xoB", "delta_b"),
)
#: rows of the drawing
DRAWN_ROWS = DrawnRows(
    own=(*BLANK_SYMBOLS, "Sigma", "a", "c", "j_en"),
    mating=("z",),
    tip="d_ae",
    reference=("di", "de"),
    tolerances=("B", *TOLERANCE_NAMES),
    accuracy="accuracy_grade",
    measured=CUT_TEETH_TITLE,
)
