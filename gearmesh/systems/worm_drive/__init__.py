"""Worm drives: worms of the forms ZA, ZN, ZI, ZK and ZC [ISO 10828], wheels as their hobs generate them."""
