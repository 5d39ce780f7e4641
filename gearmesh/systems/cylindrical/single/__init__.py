"""One cylindrical gear without a mating gear: its keys, the member built of it, its data sheet."""
