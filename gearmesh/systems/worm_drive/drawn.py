"""What a workshop drawing of a worm or its wheel has of the data sheet [DIN 3966-3, ISO 1340]."""

from gearmesh.systems.system import DrawnRows

#: of the pair
PAIR = ("a", "Sigma", "m_x", "m_n", "q", "gamma_m", "alpha_0", "alpha_n", "j_n")
#: of threads and teeth
TEETH = ("z", "form", "hand", "p_x", "p_z", "x_2", "h_am", "h_fm", "d", "d_a", "d_e", "r_k", "d_f", "d_b")
#: of the thickness, and of the hob
MADE = ("s_mx", "s_mn", "D_M", "M_d", "z_0", "d_0", "d_a0", "gamma_0", "a_0", "eta_0")
DRAWN = DrawnRows(own=(*TEETH, *MADE, *PAIR), mating=("z", "d", "d_a"), tip="d_e", reference=("d", "d"))
