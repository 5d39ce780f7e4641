"""Optimisation: the values of keys of a design at which figures are best, within limits and over errors."""
