"""What measuring machines say of teeth: deviations evaluated, tolerances and the classes that gears have by them."""
