"""Circular-arc (Wildhaber-Novikov) helical gears [LT85]."""
