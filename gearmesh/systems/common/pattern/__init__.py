"""Contact of displaced members: mountings that bring it to a place on the gear's flank."""
