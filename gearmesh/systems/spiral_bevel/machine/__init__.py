"""Bevel gears as the machine cuts them: cutter, cradle, index, sides, members, pairs."""
