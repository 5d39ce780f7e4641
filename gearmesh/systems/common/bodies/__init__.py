"""Bodies of members: bore, keyway, hub, web and holes; tips that are turned."""
