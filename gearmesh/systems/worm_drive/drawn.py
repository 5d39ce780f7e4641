"""Rows of the data sheet on a workshop drawing of a worm or its wheel [DIN 3966-3, ISO 1340]."""

from gearmesh.systems.system import DrawnRows

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
