"""Conditions of contact, with exact Jacobians, and their solution at many places at once."""
