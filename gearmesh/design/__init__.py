"""Design files: keys, units, tables, reading and writing. The kinds of gears are in `systems`."""
