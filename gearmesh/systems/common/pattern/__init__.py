"""Where displaced members touch: mountings that bring the contact to a place of the gear's flank."""
