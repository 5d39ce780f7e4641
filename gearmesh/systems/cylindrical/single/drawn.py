"""Rows of the data sheet on the workshop drawing of a cylindrical gear or a rack [DIN 3966-1, ISO 1340]."""

from gearmesh.metrology.iso1328 import TOLERANCE_NAMES
from gearmesh.systems.system import DrawnRows

#: rows of gears and racks
TOOTH_SYMBOLS = ("z", "m_n", "alpha_n", "beta", "hand", "x", "k", "d", "d_b", "d_f", "d_Ff", "d_Fa", "h", "l_o", "r_o")
#: rows of the thickness and its measures; with allowances both ends are given
THICKNESS_SYMBOLS = (*("s_n", "A_sne", "A_sni", "k_W", "W_k", "D_M", "M_dK"),)
#: rows of the basic rack
BASIC_RACK_SYMBOLS = ("rack", "alpha_P", "alpha_P_coast", "h_aP", "h_fP", "rho_fP", "pr_P0", "q")
#: rows of a rack
RACK_SYMBOLS = ("p_n", "p_t", "H_0", "h_a", "h_f", "rho_f", "M_r", "a_0", "a_M")
#: rows of the pair
MESH_SYMBOLS = ("a", "A_ae", "A_ai", "j_wt")
#: rows of the drawing
DRAWN_ROWS = DrawnRows(
    own=(*TOOTH_SYMBOLS, *BASIC_RACK_SYMBOLS, *RACK_SYMBOLS, *THICKNESS_SYMBOLS, *MESH_SYMBOLS),
    mating=("z",),
    tip="d_a",
    reference=("d", "d"),
    tolerances=("A", *TOLERANCE_NAMES),
    accuracy="accuracy_class",
    ranges=(("least", "largest"), ("working",)),
)
