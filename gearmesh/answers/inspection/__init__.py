"""What was measured of a gear, evaluated, with the tolerance classes that it has."""
