"""Cylindrical stages of REXS models as pairs and planetary sets, and back."""
