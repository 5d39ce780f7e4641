"""Cylindrical stages of REXS models read as pairs and planetary sets, and written."""
