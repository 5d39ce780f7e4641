"""Figures on paper: plots of contact, inspection and studies."""
