"""Tools of cylindrical gears and the surfaces that they generate: hobs, shaper cutters, form tools."""
