"""Rigid motions with exact twists: products of turns and shifts, rolling, feeding."""
