"""Attributes of the format that have keys in a design: unit, type of the value and range of each [REXS 1.7].

Versions 1.0 to 1.6 have the same units (the degree is "°" up to 1.3) and choices. Up to 1.2 helix angles have no sign.
"""

from __future__ import annotations

import math

from gearmesh.records import dataclass


@dataclass(frozen=True)
class AttributeForm:
    """An attribute of the format."""

    #: unit of the value, "none" without a unit
    unit: str = "none"
    #: name of the type in JSON files
    type: str = "floating_point"
    #: lower end of the range
    low: float = -math.inf
    #: upper end of the range
    high: float = math.inf
    #: True if the ends are excluded
    open: bool = True
    #: allowed words of an enum
    choices: tuple[str, ...] = ()

    @property
    def excludes_zero(self) -> bool:
        """True if 0 is outside the range: a 0 in a file then means that no value is given."""
        return self.open and self.low == 0.0

    def holds(self, value: float) -> bool:
        """True if a number is in the range."""
        return self.low < value < self.high if self.open else self.low <= value <= self.high

    @property
    def range_in_words(self) -> str:
        """The range in words."""
        unit = "" if self.unit == "none" else f" {self.unit}"
        if not math.isfinite(self.low):
            return f"a finite number{f' of{unit}' if unit else ''}"
        if math.isfinite(self.low) and math.isfinite(self.high):
            return f"between {self.low:g} and {self.high:g}{unit}"
        return f"{'above' if self.open else 'at least'} {self.low:g}{unit}"


#: a length of either sign
_LENGTH_FORM = AttributeForm("mm")
#: a length above 0
_SIZE_FORM = AttributeForm("mm", low=0.0)
#: a length that may be 0
_SIZE_OR_NONE = AttributeForm("mm", low=0.0, open=False)
#: an angle of either sign
_ANGLE_FORM = AttributeForm("deg")
#: an angle above 0
_POSITIVE_ANGLE = AttributeForm("deg", low=0.0)
#: an angle between -90 and 90 deg
_SLOPE_FORM = AttributeForm("deg", low=-90.0, high=90.0)
#: a number of either sign
_NUMBER_FORM = AttributeForm()
#: a number above 0
_COEFFICIENT_FORM = AttributeForm(low=0.0)
#: a whole number above 0
_COUNT_FORM = AttributeForm(type="integer", low=0.0)
#: an amount of micro-geometry above 0
_AMOUNT_FORM = AttributeForm("mum", low=0.0)
#: a torque of either sign
_TORQUE_FORM = AttributeForm("N m")
#: a vector in space
_VECTOR_FORM = AttributeForm("mm", "floating_point_array")
#: true or false
_FLAG_FORM = AttributeForm(type="boolean")


def _enum(*choices: str) -> AttributeForm:
    """Return an attribute with a choice of words."""
    return AttributeForm(type="enum", choices=choices)


#: letters and numbers of DIN 3967 that the format lists
DIN_3967_SERIES = tuple(
    f"{letter}{n}" for letter in ("a", "ab", "b", "bc", "c", "cd", "d", "e", "f", "g", "h") for n in range(21, 31)
)
#: shapes of a relief
_RELIEF_SHAPES = _enum("circular", "exponential", "linear", "logarithmic", "parabolic")

#: form of each attribute by its id
ATTRIBUTE_FORMS: dict[str, AttributeForm] = {
    # stages
    **dict.fromkeys(("center_distance", "common_face_width", "cutter_radius", "outer_transverse_module"), _SIZE_FORM),
    **dict.fromkeys(("upper_center_distance_allowance", "lower_center_distance_allowance"), _AMOUNT_FORM),
    "center_distance_tolerance_field_din_3964_1980": _enum("5", "6", "7", "8", "9", "10", "11"),
    "gear_ratio": AttributeForm(low=1.0, open=False),
    "hypoid_offset": _LENGTH_FORM,
    "shaft_angle": AttributeForm("deg", low=0.0, high=180.0),
    "nominal_design_pressure_angle_drive": _POSITIVE_ANGLE,
    "nominal_design_pressure_angle_coast": _POSITIVE_ANGLE,
    "torque": _TORQUE_FORM,
    "torque_around_u_axis": _TORQUE_FORM,
    # positions
    "reference_component_for_position": AttributeForm(type="reference_component"),
    **dict.fromkeys(("support_vector", "u_axis_vector", "w_axis_vector"), _VECTOR_FORM),
    "u_coordinate_on_shaft": _SIZE_OR_NONE,
    # gears
    "number_of_teeth": _COUNT_FORM,
    **dict.fromkeys(("normal_module", "transverse_module", "axial_module"), _SIZE_FORM),
    **dict.fromkeys(("face_width", "tip_diameter", "reference_circle_diameter", "base_circle_diameter"), _SIZE_FORM),
    **dict.fromkeys(
        ("addendum_basic_profile", "normal_circular_pitch", "maximum_tip_diameter", "minimum_tip_diameter"), _SIZE_FORM
    ),
    "inner_diameter": _SIZE_OR_NONE,
    "datum_face_orientation": _enum("negative", "positive"),
    "root_diameter": _LENGTH_FORM,
    **dict.fromkeys(("helix_angle_reference_diameter", "helix_angle_base_circle"), _SLOPE_FORM),
    **dict.fromkeys(
        ("chordal_tooth_thickness_upper_deviation", "chordal_tooth_thickness_lower_deviation"), _LENGTH_FORM
    ),
    "tooth_thickness_deviation_tolerance_series_din_3967_1978": _enum(*DIN_3967_SERIES),
    # flanks
    "normal_pressure_angle": _POSITIVE_ANGLE,
    "pressure_angle_in_the_transverse_section": AttributeForm("deg", low=0.0, high=90.0),
    "addendum_modification_coefficient": _NUMBER_FORM,
    "addendum_modification": _LENGTH_FORM,
    "addendum_coefficient_basic_profile": _COEFFICIENT_FORM,
    "tooth_tip_chamfer": _SIZE_OR_NONE,
    # tools and what is set for them
    "addendum_coefficient_reference_profile": _COEFFICIENT_FORM,
    "addendum_reference_profile": _SIZE_FORM,
    "tip_radius_factor": _COEFFICIENT_FORM,
    "tip_radius": _SIZE_OR_NONE,
    "protuberance_amount": _SIZE_OR_NONE,
    "protuberance_amount_factor": AttributeForm(low=0.0, open=False),
    "protuberance_angle": AttributeForm("deg", low=0.0, open=False),
    "machining_allowance": _SIZE_OR_NONE,
    "generated_addendum_modification_coefficient": _NUMBER_FORM,
    # modifications
    **dict.fromkeys(
        (
            "profile_crowning_at_tip",
            "profile_crowning_at_root",
            "helix_crowning_amount_datum_face",
            "helix_crowning_amount_non_datum_face",
            "profile_slope",
            "helix_slope",
            "tip_relief_depth",
            "root_relief_depth",
            "end_relief_depth_datum_face",
            "end_relief_depth_non_datum_face",
        ),
        _LENGTH_FORM,
    ),
    **dict.fromkeys(
        (
            "tip_relief_datum_diameter",
            "root_relief_datum_diameter",
            "tip_relief_datum_length",
            "root_relief_datum_length",
            "end_relief_length_datum_face",
            "end_relief_length_non_datum_face",
        ),
        _SIZE_FORM,
    ),
    "shape_of_relief": _RELIEF_SHAPES,
    "shape_of_profile_crowning": _enum("circular", "parabolic"),
    "shape_of_helix_crowning": _enum("circular", "parabolic"),
    "is_additive_modification": _FLAG_FORM,
    # worms and wheels
    "flank_form": _enum("za", "zc", "zi", "zk", "zn"),
    "pressure_angle_worm_gear": _POSITIVE_ANGLE,
    "lead_angle_worm_gear": _SLOPE_FORM,
    "form_factor_worm_gear": _COEFFICIENT_FORM,
    "addendum_modification_coefficient_worm_wheel": _NUMBER_FORM,
    **dict.fromkeys(
        (
            "reference_diameter_worm_gear",
            "tip_diameter_worm_gear",
            "root_diameter_worm_gear",
            "length_worm_gear",
            "lead",
            "face_width_worm_wheel",
            "effective_face_width_worm_wheel",
            "rim_width_worm_wheel",
            "throat_radius_worm_wheel",
            "outer_diameter_worm_wheel",
            "grinding_disk_diameter",
            "profile_radius_zc_disc",
            "tooth_addendum_worm_wheel_hob",
            "tooth_depth_worm_wheel_hob",
        ),
        _SIZE_FORM,
    ),
    # bevel gears
    "mean_spiral_angle": _ANGLE_FORM,
    "spiral_angle_pitch_direction": _enum("left", "right"),
    **dict.fromkeys(("root_angle", "face_angle", "pitch_angle"), _POSITIVE_ANGLE),
    **dict.fromkeys(
        (
            "mean_cone_distance",
            "outer_cone_distance",
            "inner_cone_distance",
            "outer_pitch_diameter",
            "mean_addendum",
            "mean_dedendum",
            "blade_point_radius",
            "tool_edge_radius_bevel_gear_tool",
        ),
        _SIZE_FORM,
    ),
    **dict.fromkeys(
        (
            "pitch_apex_beyond_crossing_point",
            "root_apex_beyond_crossing_point",
            "blade_spheric_radius",
            "radial_distance",
            "work_offset",
            "machine_center_to_crossing_point",
            "sliding_base",
        ),
        _LENGTH_FORM,
    ),
    **dict.fromkeys(("center_roll_position", "machine_root_angle", "cutter_tilt", "cutter_swivel"), _ANGLE_FORM),
    "blade_pressure_angle": AttributeForm("deg", low=0.0, open=False),
    "ratio_of_roll": AttributeForm(low=0.0, open=False),
    # materials
    "elastic_modulus": AttributeForm("N / mm^2", low=0.0, open=False),
    "poisson_ratio": AttributeForm(low=0.0, open=False),
    "density": AttributeForm("kg / dm^3", low=0.0, open=False),
}
