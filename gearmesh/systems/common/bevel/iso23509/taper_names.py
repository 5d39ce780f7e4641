"""Names of the depth tapers of ISO 23509:2016, annex C.5."""

#: root lines through the apex; no taper; one slot width from toe to heel; the same up to a limit of the root line's
#: tilt
TAPER_NAMES = ("standard", "uniform", "duplex", "tilted_root_line")
#: tapers that depend on the radius of a face-milling cutter
CUTTER_TAPERS = ("duplex", "tilted_root_line")
