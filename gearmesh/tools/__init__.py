"""Tool surfaces: rack, head cutter, shaper, disk, worm, and their tip roundings."""
