"""gearmesh: exact gear tooth surfaces, their contact, and meshes proved against both.

    import gearmesh as gm

    design = gm.load("helical.toml", ["contact.delta=0.005"])    a design file; any key can be set anew
    gears = gm.build(design)                                      exact teeth of all members, nothing else yet
    gears.contact()                                               path, transmission error, ellipses, mesh cycle
    gears.loaded_contact([50, 100])                               load sharing, loaded transmission error, root stress
    gears.solid("pinion", tolerance=0.01).save("pinion.stl")      watertight, within 0.01 mm, measured
    gears.cad().save("pair.step")                                 CAD solids, placed as they mesh
    gears.to_build123d(), gears.to_cadquery()                     the same in memory
    gears.section("pinion").save("pinion.dxf")                    the section across the axis, as arcs and splines
    gears.drawing("pinion").save("pinion.pdf")                    a workshop drawing with dimensions and gear data
    gears.topography("pinion").save("right.csv")                  all modifications of a flank, as a file to design with
    gears.toolpath("pinion", "ball:1mm", "10um").save("p.cls")     passes of a ball-end cutter on a five-axis machine, proved
    gears.finite_elements(phi1=0.0).save("pair.inp")              a complete model of three teeth each
    gears.check(), gears.limits(), gears.sheet()                  meshes and contact checked; undercut; derived values
    gears.vh()                                                    of bevel gears: V-H check
    gears.study({"assembly.dx": "-0.1:0.1:5"})                    many assemblies or designs: figures, sensitivities
    gears.optimize({"pinion.teeth": "18:30"}, "contact_ratio")     values of keys at which figures are best
    gears.largest_errors(["assembly.dx"])                         how large errors may be before a criterion fails
    gears.picture("pattern").save("pattern.png")                  contact on the tooth
    gears.picture("flank").save("flank.svg")                      both sides in the planes of their flanks, with the ease-off
    gears.animation().save("mesh.gif")                            the mesh cut open, rolling
    gears.report().save("report.html")                            one page for a browser: the gears roll, figures, plots
    gears.explore()                                               a page in the browser: gears and figures follow each key
    gears.run("out")                                              all of it into a folder
    gm.prove("my_kind")                                           a kind of your own: derivatives, normals, joins, motions
    gm.gear(30, module=1, helix=15)                               one gear without a mating gear
    gm.size(2.5, 64, 2).design(1)                                 cylindrical gears of a ratio, centre distance and module

Every answer prints as a table, shows as one in a notebook, and has `.to_dict()` (columns), `.document()` (as JSON) and
`.save(path)`. Lengths are in mm, or texts with their unit ("10um"), angles in deg, torques in Nm. What is impossible raises
DesignError with one line that names key, value and what is allowed; all errors are GearmeshErrors.
"""

from __future__ import annotations

from typing import Any

import lazy_loader

__version__ = "0.18.0"

#: `__init__.pyi` lists the public names and their modules, for type checkers and for this package
_public_name, _, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    """Return a public name, or one that goes, with a warning."""
    if name in __all__ or not name[:1].isupper():
        return _public_name(name)
    from gearmesh.former_names import former_name

    return former_name(name)


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
