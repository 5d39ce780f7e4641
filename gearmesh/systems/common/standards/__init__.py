"""Standards of tolerances that no gear system has to itself: sizes of ISO 286, rounding of gear tolerances."""
