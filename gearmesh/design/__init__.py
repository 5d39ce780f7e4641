"""What every design file has: keys, units, tables, files. The gear systems are in `systems`."""
