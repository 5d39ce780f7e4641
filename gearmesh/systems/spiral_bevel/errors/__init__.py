"""Errors of assembly and eccentricity of bevel pairs in closed form, their compensation, and the V-H check."""
