"""Settings that give the requested contact: local synthesis, ease-off, and the choices for contact that a design leaves
open.
"""
