"""Tools of cylindrical gears and what they generate: hobs, shaper cutters."""
