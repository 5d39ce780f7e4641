"""Rows of a study: building and solving the design of one row, and its figures."""
