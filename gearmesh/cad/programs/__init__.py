"""Parts and assemblies as objects of CAD programs."""
