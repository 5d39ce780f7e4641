"""What a workshop drawing of a bevel or hypoid gear has of the data sheet [DIN 3966-2, ISO 1340]."""

from gearmesh.metrology.iso17485 import NAMES
from gearmesh.systems.system import DrawnRows

#: teeth and cones
BLANK = (
    *("z", "m_et", "m_mn", "alpha_n", "beta_m", "hand", "r_c0", "delta", "delta_a", "delta_f", "Re", "Rm", "b"),
    *("de", "dae", "hae", "he", "ham", "smnc", "hamc", "tzF", "tzR", "t_B", "t_xoB", "delta_b"),
)
DRAWN = DrawnRows(
    own=(*BLANK, "Sigma", "a", "c", "j_en"),
    mating=("z",),
    tip="dae",
    reference=("di", "de"),
    tolerances=("B", *NAMES),
    accuracy="accuracy_grade",
)
