"""Table of the dimensions of a pair: symbols of ISO 23509, words, units and values, lengths in mm and angles in deg."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from gearmesh.systems.common.bevel.iso23509.dimensions import BevelDimensions, MemberDimensions

#: a row of the table: symbol, words, unit ("mm", "deg" or "-"), value
Dimension: TypeAlias = "tuple[str, str, str, float]"


def dimension_rows(dimensions: BevelDimensions) -> tuple[Dimension, ...]:
    """Return all rows of a pair; suffixes: pinion 1, wheel 2, e outer, m mean, i inner, D drive, C coast."""
    member_rows_in_rad = [
        row for k, member in (("1", dimensions.pinion), ("2", dimensions.wheel)) for row in _of_member(k, member)
    ]
    return (*pair_rows(dimensions), *_in_degrees(tuple(member_rows_in_rad)))


def pair_rows(dimensions: BevelDimensions) -> tuple[Dimension, ...]:
    """Return the rows that both members share."""
    return _in_degrees((*_shared_rows(dimensions), *_pressure_rows(dimensions), *_plane_rows(dimensions)))


def member_rows(member: MemberDimensions) -> tuple[Dimension, ...]:
    """Return all rows of one member, without its number in the symbols."""
    return _in_degrees(_of_member("", member))


def _in_degrees(rows: tuple[Dimension, ...]) -> tuple[Dimension, ...]:
    """Return rows whose values in rad are converted to deg."""
    return tuple(
        (symbol, words, unit, float(np.degrees(value) if unit == "deg" else value))
        for symbol, words, unit, value in rows
    )


def _of_member(k: str, member: MemberDimensions) -> tuple[Dimension, ...]:
    """Return all rows of one member in rad; `k`: number of the member in the symbols."""
    return (*_cone_rows(k, member), *_depth_rows(k, member), *_thickness_rows(k, member), *_outline_rows(k, member))


def _shared_rows(dimensions: BevelDimensions) -> tuple[Dimension, ...]:
    """Return the rows of pitch cones, depths and face of a pair."""
    pitch, face = dimensions.pitch, dimensions.pinion_face
    return (
        ("u", "gear ratio", "-", pitch.ratio),
        ("Sigma", "shaft angle", "deg", pitch.shaft_angle),
        ("a", "offset", "mm", pitch.offset),
        ("ap", "offset in the pitch plane", "mm", pitch.pitch_plane_offset),
        ("zeta_m", "offset angle in the pinion's axial plane", "deg", pitch.axial_offset_angle),
        ("zeta_mp", "offset angle in the pitch plane", "deg", pitch.offset_angle),
        ("m_mn", "mean normal module", "mm", pitch.mean_normal_module),
        ("met2", "outer transverse module", "mm", dimensions.outer_transverse_module),
        ("c_be2", "face width factor", "-", pitch.face_width_factor),
        ("hmw", "mean working depth", "mm", dimensions.working_depth),
        ("c", "clearance", "mm", dimensions.clearance),
        ("hm", "mean whole depth", "mm", dimensions.working_depth + dimensions.clearance),
        ("ht1", "whole depth of the pinion, across its root cone", "mm", dimensions.pinion_whole_depth),
        ("bp1", "pinion face width in the pitch plane", "mm", face.pitch_plane_width),
        ("b1A", "pinion face width from mean point to front crown", "mm", face.front_crown_width),
        ("lambda'", "auxiliary angle of the pinion face width", "deg", face.auxiliary_angle),
        ("b_reri1", "pinion face width, projected", "mm", face.projected_width),
        *(
            row
            for k, end, words in ((0, "e", "outer"), (1, "i", "inner"))
            for row in (
                (f"R{end}21", f"wheel cone distance at the pinion's {words} end", "mm", face.wheel_cone_distances[k]),
                (
                    f"beta_{end}21",
                    f"wheel spiral angle at the pinion's {words} end",
                    "deg",
                    face.wheel_spiral_angles[k],
                ),
                (f"zeta_{end}p21", f"offset angle at the pinion's {words} end", "deg", face.offset_angles[k]),
            )
        ),
    )


def _pressure_rows(dimensions: BevelDimensions) -> tuple[Dimension, ...]:
    """Return the rows of the pressure angles."""
    return (
        ("alpha_lim", "limit pressure angle", "deg", dimensions.pitch.limit_pressure_angle),
        ("alpha_nD", "generated pressure angle, drive side", "deg", dimensions.drive.generated),
        ("alpha_nC", "generated pressure angle, coast side", "deg", dimensions.coast.generated),
        ("alpha_eD", "effective pressure angle, drive side", "deg", dimensions.drive.effective),
        ("alpha_eC", "effective pressure angle, coast side", "deg", dimensions.coast.effective),
        ("alpha_n", "mean normal pressure angle", "deg", dimensions.pressure_angle),
    )


def _plane_rows(dimensions: BevelDimensions) -> tuple[Dimension, ...]:
    """Return the rows of the planes on the wheel's root and tip cone."""
    root, face = dimensions.cones.root_plane, dimensions.cones.face_plane
    return (
        ("phi_R", "auxiliary angle of the root plane", "deg", root.auxiliary_angle),
        ("phi_o", "auxiliary angle of the face plane", "deg", face.auxiliary_angle),
        ("zeta_R", "offset angle in the root plane", "deg", root.offset_angle),
        ("zeta_o", "offset angle in the face plane", "deg", face.offset_angle),
    )


def _cone_rows(k: str, member: MemberDimensions) -> tuple[Dimension, ...]:
    """Return the rows of cone angles, cone distances and spiral angles of a member."""
    outer, inner = member.cone_distances
    return (
        (f"delta{k}", "pitch angle", "deg", member.pitch_angle),
        (f"delta_a{k}", "face angle", "deg", member.face_angle),
        (f"delta_f{k}", "root angle", "deg", member.root_angle),
        (f"theta_a{k}", "addendum angle", "deg", member.addendum_angle),
        (f"theta_f{k}", "dedendum angle", "deg", member.dedendum_angle),
        (f"Re{k}", "outer cone distance", "mm", outer),
        (f"Rm{k}", "mean cone distance", "mm", member.mean_cone_distance),
        (f"Ri{k}", "inner cone distance", "mm", inner),
        (f"b{k}", "face width", "mm", member.face.width),
        (f"be{k}", "face width outside the mean point", "mm", member.face.outer),
        (f"bi{k}", "face width inside the mean point", "mm", member.face.inner),
        (f"beta_e{k}", "outer spiral angle", "deg", member.spiral_angles[0]),
        (f"beta_m{k}", "mean spiral angle", "deg", member.mean_spiral_angle),
        (f"beta_i{k}", "inner spiral angle", "deg", member.spiral_angles[1]),
        (f"de{k}", "outer pitch diameter", "mm", member.pitch_diameter(outer)),
        (f"dm{k}", "mean pitch diameter", "mm", member.mean_diameter),
        (f"di{k}", "inner pitch diameter", "mm", member.pitch_diameter(inner)),
    )


def _depth_rows(k: str, member: MemberDimensions) -> tuple[Dimension, ...]:
    """Return the rows of addenda and dedenda of a member."""
    outer, inner = (member.depth(distance) for distance in member.cone_distances)
    return (
        (f"ham{k}", "mean addendum", "mm", member.mean_depth.addendum),
        (f"hfm{k}", "mean dedendum", "mm", member.mean_depth.dedendum),
        *(
            row
            for end, words, depth in (("e", "outer", outer), ("i", "inner", inner))
            for row in (
                (f"ha{end}{k}", f"{words} addendum", "mm", depth.addendum),
                (f"hf{end}{k}", f"{words} dedendum", "mm", depth.dedendum),
                (f"h{end}{k}", f"{words} whole depth", "mm", depth.whole),
            )
        ),
    )


def _thickness_rows(k: str, member: MemberDimensions) -> tuple[Dimension, ...]:
    """Return the rows of tooth thicknesses of a member."""
    return (
        (f"xsm{k}", "thickness modification coefficient", "-", member.thickness_modification),
        (f"smn{k}", "mean normal circular thickness", "mm", member.normal_thickness),
        (f"smt{k}", "mean transverse circular thickness", "mm", member.transverse_thickness),
        (f"dmn{k}", "mean normal diameter", "mm", member.normal_diameter),
        (f"smnc{k}", "mean normal chordal thickness", "mm", member.chordal_thickness),
        (f"hamc{k}", "mean chordal addendum", "mm", member.chordal_addendum),
    )


def _outline_rows(k: str, member: MemberDimensions) -> tuple[Dimension, ...]:
    """Return the rows of tip and root diameters and of axial positions of a member."""
    outer, inner = member.cone_distances
    return (
        (f"dae{k}", "outer tip diameter", "mm", member.tip_diameter(outer)),
        (f"dai{k}", "inner tip diameter", "mm", member.tip_diameter(inner)),
        (f"dfe{k}", "outer root diameter", "mm", member.root_diameter(outer)),
        (f"dfi{k}", "inner root diameter", "mm", member.root_diameter(inner)),
        (f"txo{k}", "crossing point to crown along the axis", "mm", member.crown(outer)),
        (f"txi{k}", "crossing point to front crown along the axis", "mm", member.crown(inner)),
        (f"tzm{k}", "crossing point to mean point along the axis", "mm", member.crossing_distance),
        (f"tz{k}", "pitch apex beyond crossing point", "mm", member.pitch_apex),
        (f"tzF{k}", "face apex beyond crossing point", "mm", member.face_apex),
        (f"tzR{k}", "root apex beyond crossing point", "mm", member.root_apex),
    )
