"""Answers: one typed result for every question about gears."""
