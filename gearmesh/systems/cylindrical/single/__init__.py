"""One cylindrical gear without a mating gear: its keys, the member, its data sheet."""
