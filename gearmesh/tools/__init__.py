"""Tool surfaces: rack, head cutter, shaper, disk, worm, with their tip roundings, descriptions and drawings."""
