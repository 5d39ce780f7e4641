"""What a workshop drawing of a cylindrical gear or a rack has of the data sheet [DIN 3966-1, ISO 1340]."""

from gearmesh.metrology.iso1328 import NAMES
from gearmesh.systems.system import DrawnRows

#: what both have
TEETH = ("z", "m_n", "alpha_n", "beta", "hand", "x", "k", "d", "d_b", "d_f", "d_Ff", "d_Fa", "h")
#: thickness and its measures, whose ends are given where it has allowances
THICKNESS = (*("s_n", "A_sne", "A_sni", "k_W", "W_k", "D_M", "M_dK"),)
#: of a rack
BAR = ("p_n", "p_t", "H_0", "h_a", "h_f", "rho_f", "M_r", "a_0", "a_M")
#: of the pair
MESH = ("a", "A_ae", "A_ai", "j_wt")
DRAWN = DrawnRows(
    own=(*TEETH, *BAR, *THICKNESS, *MESH),
    mating=("z",),
    tip="d_a",
    reference=("d", "d"),
    tolerances=("A", *NAMES),
    accuracy="accuracy_class",
    ranges=(("least", "largest"), ("working",)),
)
