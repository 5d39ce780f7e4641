"""Planetary sets: sun, planets and ring as cylindrical pairs that share the planet; positions, motion, sheet."""
