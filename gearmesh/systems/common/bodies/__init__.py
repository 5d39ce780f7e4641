"""Bodies of members: bore, keyway, hub, web, holes, and turned tips."""
