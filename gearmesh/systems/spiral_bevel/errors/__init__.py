"""Errors of assembly and eccentricity of bevel pairs, in closed form, and what compensates them; V-H check."""
