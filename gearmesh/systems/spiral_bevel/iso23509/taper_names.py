"""Names of the depth tapers of ISO 23509:2016, annex C.5."""

#: root lines through the apex; none; the same slot width from toe to heel; that, but not beyond a tilt of the standard one
TAPERS = ("standard", "uniform", "duplex", "tilted_root_line")
#: of these, those that follow from the radius of a face-milling cutter
CUTTER_TAPERS = ("duplex", "tilted_root_line")
