"""The quick selection: `pytest -m quick`, under a minute on two cores, something of every package."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

#: file or folder -> which of its tests are quick, by how their names go on after "test_" (a regular expression)
QUICK = {
    "test_contract.py": "(?!the_quick)",
    "test_readme.py": "(?!the_python)",
    "answers": "",
    "api": "(?!cad_answers|solved_models|pictures|answers_speak)",
    "app/test_cli.py": "(?!one_wrong_value|any_file)",
    "app/test_load.py": "what_load|positions_|edges_",
    "app/test_commands.py": "a_new_file|samples_are|what_render|a_format|completion|json_is",
    "cad": "nodes_grow|refusals|svg|teeth_bound",
    "check": "beyond",
    "contact/test_hertz.py": "",
    "contact/test_invariance.py": "the_frame",
    "design": "",
    "fe/test_fe_formats.py": "",
    "files": "",
    "fe/test_fe_solve.py": "beam",
    "fe/test_fe_command.py": "deck_and|without_calculix",
    "io/test_io.py": "",
    "io/test_leftovers.py": "",
    "io/test_single.py": "samples.*spur",
    "kernel": "",
    "loaded": "(?!sharing)",
    "mesh": "every_element_is_well_shaped.*spur-plain|spacing|outline",
    "study/test_plan.py": "",
    "study/test_statistics.py": "",
    "systems/test_bevel_blank.py": "",
    "systems/test_bodies.py": "keyways_are|bodies_|sections_",
    "systems/test_conjugate.py": "",
    "systems/test_cylindrical_sheet.py": "tolerances|measures.*(spur_shifted|internal_helical)|root.*(spur_shifted|shaped)",
    "systems/test_face_gear.py": "",
    "systems/test_hypoid.py": "axes_|tips_|what_cannot",
    "systems/test_iso23509.py": "sample|tooth_line|tapers|duplex",
    "systems/test_kinematic_errors.py": "(?!roll_and|misalignment)",
    "systems/test_own_system.py": "models",
    "systems/test_parabolic_helical.py": "teeth_share|refused",
    "systems/test_published.py": "lt85",
    "systems/test_rack_design.py": "what_cannot|limits_|as_many",
    "systems/test_sizing.py": "no_pair|wishes",
    "systems/test_spiral_bevel.py": "contact_of_the_printed|refused|free_edge",
    "systems/test_worm_solid.py": "thread_|bore",
    "teeth/test_limits.py": "(?!a_crowned|the_command)",
    "teeth/test_station_levels.py": "(?!mesh_is_a|cad_)",
    "teeth/test_teeth.py": "sides|spur|features|every_solid_is_proved.*(spur|face_gear)",
    "tools": "",
    "view": "(?!ellipse_is_seen|plots_are|equal_scenes|no_side|browser|page|command)",
}


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the mark on the tests that the table names."""
    for item in items:
        file = item.path.relative_to(Path(__file__).parent)
        names = QUICK.get(file.as_posix(), QUICK.get(file.parts[0]))
        if names is not None and re.match(f"test_({names})", item.name):
            item.add_marker("quick")
