"""Rack cutters: their tooth space, and the members that they generate."""
