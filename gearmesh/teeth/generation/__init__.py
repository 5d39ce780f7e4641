"""Tools beside the teeth that they generate: their positions, and the lines of contact."""
