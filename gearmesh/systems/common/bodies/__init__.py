"""Bodies of members: bore, keyway, hub, web and holes."""
