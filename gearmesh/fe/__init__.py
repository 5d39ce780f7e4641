"""Finite-element models of gears: teeth in mesh, input decks, the solver CalculiX, and results."""
