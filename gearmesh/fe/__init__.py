"""Finite-element models: teeth in mesh, decks, CalculiX, results."""
