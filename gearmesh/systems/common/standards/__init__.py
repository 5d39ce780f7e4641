"""Tables of standards of sizes and tolerances: ISO 286, DIN 3967, rounding of gear tolerances."""
