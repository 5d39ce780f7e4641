"""Helical gears of parabolic racks, ground by worms and disks: Novikov-Wildhaber and modified involute [LF04 17]."""
