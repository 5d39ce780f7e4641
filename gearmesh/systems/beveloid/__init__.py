"""Beveloid gears: involute spur, helical and conical gears on any axes [LT02]."""
