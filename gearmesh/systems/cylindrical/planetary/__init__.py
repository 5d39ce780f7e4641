"""Planetary sets: sun, planets and ring as cylindrical pairs that share the planet, their positions, motions and sheet."""
