"""Studies: many assemblies or designs in one go, on one machine or many, and what their figures say together."""
