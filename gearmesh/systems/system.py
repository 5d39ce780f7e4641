"""What a gear system is: a design class, and what is made of its designs. Each is registered in one line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from importlib import import_module
from typing import TYPE_CHECKING, Any, Generic, TypeAlias, TypeVar, cast

from gearmesh.arguments import checks_arguments
from gearmesh.design.unusual import unusual_settings
from gearmesh.errors import ArgumentError, DesignError, FileError, NoSolutionError
from gearmesh.figures import Summary
from gearmesh.systems.kinds import KINDS, kind_of_words

if TYPE_CHECKING:
    from collections.abc import Mapping

    from gearmesh.design.core import Design
    from gearmesh.exchange.stage_form import StageForm
    from gearmesh.kernel.motion.rigid import Rigid
    from gearmesh.kernel.numeric.algebra import Array
    from gearmesh.metrology.measured_teeth import InspectionBasis
    from gearmesh.teeth.gear_train import GearTrain, Member
    from gearmesh.teeth.tooth import Tooth

D = TypeVar("D", bound="Design")
#: what is made for designs of one class is for those of its subclasses, too
ForD = TypeVar("ForD", bound="Design", contravariant=True)
T = TypeVar("T")

#: pinion rotations (P,), rad -> transmission error (P,), rad, relative to that at 0
FirstOrder: TypeAlias = "Callable[[Array], Array]"


@dataclass(frozen=True)
class ToolPart:
    """A tool as a part that people make, as the worm that grinds a pinion; its own figures, and warnings.

    `own_to_tool` takes its own frame to that in which the tool's surface generates teeth, if it is a tool; of the member `ground`;
    `tooth`: that member's as the tool generates it, None if that is how the member is made.
    """

    member: Member
    figures: Summary = field(default_factory=Summary)
    warnings: tuple[str, ...] = ()
    own_to_tool: Rigid | None = None
    ground: str = "pinion"
    tooth: Tooth | None = None


@dataclass(frozen=True)
class MissingValue:
    """A value that a table has not: the `symbol` of its row (or item where there are no symbols), its `column`, the `reason`.

    Both are empty of a table that is missing as a whole.
    """

    symbol: str
    column: str
    reason: str


@dataclass(frozen=True)
class SheetTable:
    """Rows of (item, unit, one value per column); a value that a column has not is None. `symbols`: one per row, or none at all.
    `missing`: values that are None for a reason that the reader is to know."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[Any, ...], ...]
    symbols: tuple[str, ...] = ()
    missing: tuple[MissingValue, ...] = ()


@dataclass(frozen=True)
class Sheet:
    """What is derived from a design: tables to print, and the derived values under the design's keys, in its own units, which take
    the place of the keys `replaced`; `warnings` beside those of the gear set; `following`: values that follow from the others,
    and are given too by who wants the same gears whatever defaults become."""

    tables: tuple[SheetTable, ...]
    values: dict[str, float]
    replaced: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    following: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Reserve:
    """How far the teeth of a pair are from interference, in closed form: `pair`, its number in the gear set; `name`, the row of the
    sheet and the member; `value` and its `unit`, negative where teeth interfere."""

    pair: int
    name: str
    value: float
    unit: str


@dataclass(frozen=True)
class Setting:
    """A key of the design, its value before and after in the design's units, and what the change does."""

    key: str
    before: float
    after: float
    unit: str
    effect: str


@dataclass(frozen=True)
class PatternShift:
    """Displacements that bring the contact of a `side` (member and flank) to a `place` along the face, or next to it.

    V of the pinion across both axes, H along its own, J of the gear along its axis (mm), alpha of the shaft angle (deg).

    `asked`, `share`: of the gear's face, from the toe, the place and where the contact is with these displacements: the nearest
    to which it can be brought.
    """

    side: str
    place: str
    asked: float
    v: float
    h: float
    j: float
    alpha: float
    share: float

    @property
    def reached(self) -> bool:
        """Whether the contact is where it was asked for."""
        return self.share == self.asked


@dataclass(frozen=True)
class PatternCheck(Generic[D]):
    """Mountings that bring the contact to places of the gear's face, of a design in mm and its gear set.

    `keys`: those of the table assembly that may be moved, by the letters V, H, J and alpha; `usual`: which are moved where nothing
    is asked for, and as many as always are.
    """

    shifts: Callable[[D, GearTrain, tuple[str, ...]], list[PatternShift]]
    keys: Mapping[str, str]
    usual: tuple[str, ...]


@dataclass(frozen=True)
class Displacements(Generic[ForD]):
    """Errors of assembly that move the members of a pair and leave their teeth as they are.

    `keys`: those of the table `assembly`. `bases` gives, for a design in mm in which they are all 0, its gear set and M values
    (M,) of each of them (mm, deg), the bases of the mounts of pinion and gear: rotations (M, 3, 3), translations (M, 3).
    """

    keys: tuple[str, ...]
    bases: Callable[[ForD, GearTrain, Mapping[str, Array]], tuple[Rigid, Rigid]]


@dataclass(frozen=True)
class DrawnRows:
    """Which rows of the sheet a workshop drawing of a member has, by their symbols: `own` of its own columns and of those of
    the pair, `mating` of the mating gears; `tip`: symbol of the tip diameter; `reference`: symbols of the reference or pitch
    diameter at toe and heel; `tolerances`: those that it has where the design sets the key `accuracy`; `ranges`: names of columns,
    such as least and largest, the first of which that a table of a pair has are given beside each other; `measured`: title of the
    table of the sheet whose rows go before rows of the same symbol elsewhere."""

    own: tuple[str, ...]
    mating: tuple[str, ...] = ()
    tip: str = ""
    reference: tuple[str, str] | None = None
    tolerances: tuple[str, ...] = ()
    accuracy: str = ""
    ranges: tuple[tuple[str, ...], ...] = ()
    measured: str = ""


@dataclass(frozen=True)
class System(Generic[D]):
    """A gear system: `build` makes the gear set of a design in mm, and may be all that there is. `members`, by their names,
    where they can be made one without the other: each of a design in mm of which `derive` was not asked, with its own warnings.
    `tried`, if it is faster, fails where `build` does, and at most where that has to search for long, of a design in mm of which
    `derive` was not asked: it looks for the key that makes it impossible.

    `derive` gives the values, in the design's units, of keys that are left out and that only geometry knows, by dotted key.
    `worm` makes the grinding worm of a design in mm; `sheet` derives the sheet of a design and its gear set, `member_sheet` the
    tables of one of the `members` without the others, `forces` the tables of what a torque (Nm) on the pinion puts on its
    members, with the powers at a speed (1/min) of it where one is given, `compensate` the settings that compensate its assembly
    errors, `refinish` the same by settings of the member named, all of designs in their own units; `vh` makes the V-H check of a
    design in mm and its gear set, `first_order` gives, for a design in mm with errors, its
    transmission error in closed form; `displacements` moves the members of many assemblies at once. `single` makes designs of the
    same kind of one member without a mating gear, those whose keys `is_single`.
    `reserves`: those of a design and its gear set of which the sheet warns, for the check.
    `drawn`: what of the sheet a workshop drawing has; without it, all that it says of the member; `inspection`: what the member
    named, of a design and its gear set, is inspected by. `rexs`: how its stages are read from REXS models and written to them.
    """

    kind: str
    design: type[D]
    build: Callable[[D], GearTrain]
    members: Mapping[str, Callable[[D], ToolPart]] = field(default_factory=dict)
    tried: Callable[[D], object] | None = None
    derive: Callable[[D], dict[str, float]] | None = None
    worm: Callable[[D], ToolPart] | None = None
    sheet: Callable[[D, GearTrain], Sheet] | None = None
    reserves: Callable[[D, GearTrain], tuple[Reserve, ...]] | None = None
    member_sheet: Callable[[D, str], tuple[SheetTable, ...]] | None = None
    forces: Callable[[D, float, float | None], tuple[SheetTable, ...]] | None = None
    compensate: Callable[[D], list[Setting]] | None = None
    refinish: Callable[[D, str], list[Setting]] | None = None
    vh: PatternCheck[D] | None = None
    first_order: Callable[[D], FirstOrder | None] | None = None
    displacements: Displacements[D] | None = None
    pinned: Callable[[D, GearTrain], dict[str, Any]] | None = None
    drawn: DrawnRows | None = None
    inspection: Callable[[D, GearTrain, str], InspectionBasis] | None = None
    rexs: StageForm | None = None
    single: System[Any] | None = None
    is_single: Callable[[Mapping[str, Any]], bool] | None = None

    def of_keys(self, keys: Mapping[str, Any]) -> System[Any]:
        """The system itself, or that of single members where the keys of a design are those of one.

        Parameters
        ----------
        keys : mapping of str to values
            Keys and tables of a design.

        Returns
        -------
        System
            Of these keys.

        Examples
        --------
        >>> gm.system("cylindrical").of_keys({"gear": {"teeth": 20}}).design.__name__
        'SingleGearDesign'
        """
        return self if self.single is None or self.is_single is None or not self.is_single(keys) else self.single


_REGISTERED: dict[str, System[Any]] = {}
#: group of the entry points by which other packages add gear systems, each under its kind
OUTSIDE = "gearmesh.systems"


@checks_arguments
def register(system: System[Any]) -> None:
    """Make a gear system known under its kind, for `load`, `build` and all that follows.

    The command line knows those of installed packages that have an entry point of the group `gearmesh.systems`, whose name is the
    kind and whose object the system.

    Parameters
    ----------
    system : System
        Its kind, its class of designs, and what is made of them.

    Examples
    --------
    >>> gm.register(gm.system("beveloid"))
    """
    _REGISTERED[system.kind] = system


def kinds() -> tuple[str, ...]:
    """All kinds of designs.

    Returns
    -------
    tuple of str
        What the key `kind` of a design may be; of systems that were registered, too.

    Examples
    --------
    >>> "hypoid" in gm.kinds()
    True
    """
    return (*KINDS, *(kind for kind in _REGISTERED if kind not in KINDS))


def system(kind: Any) -> System[Any]:
    """The gear system of a kind.

    Parameters
    ----------
    kind : str
        One of `kinds`.

    Returns
    -------
    System
        Its class of designs, and what is made of them.

    Raises
    ------
    DesignError
        For another kind, naming the nearest.

    Examples
    --------
    >>> gm.system("hypoid").design.__name__
    'HypoidDesign'
    """
    if isinstance(kind, str) and kind not in _REGISTERED and kind in KINDS:
        for registered in import_module(f"gearmesh.systems.registered.{KINDS[kind].registered}").GEAR_SYSTEMS:
            _REGISTERED.setdefault(registered.kind, registered)
    if isinstance(kind, str) and (kind in _REGISTERED or _registered_from_outside(kind)):
        return _REGISTERED[kind]
    from gearmesh.design.shown import value_text
    from gearmesh.errors import nearest

    made_by = kind_of_words(kind) if isinstance(kind, str) else ""
    close = nearest(kind, kinds()) if isinstance(kind, str) and not made_by else None
    hint = f"; {made_by}" if made_by else f'; did you mean "{close}"?' if close else ""
    raise DesignError("kind", kind, shown=value_text(kind), must_be=f"{one_of_kinds()}{hint}")


def _registered_from_outside(kind: str) -> bool:
    """Whether an installed package has a gear system of this kind, as an entry point of the group gearmesh.systems; it is then
    registered. They are asked for kinds that are not known otherwise, alone."""
    from importlib.metadata import entry_points

    for entry in entry_points(group=OUTSIDE, name=kind):
        register(entry.load())
    return kind in _REGISTERED


def about(kind: str) -> str:
    """One line about a kind. Raises DesignError naming the nearest kind. Nothing of the gear system is loaded for it."""
    return KINDS[kind].about if kind in KINDS and kind not in _REGISTERED else system(kind).design.about


def design_class(kind: str) -> type[Design]:
    """The class of the designs of a kind. Raises DesignError naming the nearest kind. What is made of them is not loaded for it."""
    if kind not in KINDS or kind in _REGISTERED:
        return system(kind).design
    module, name = KINDS[kind].design
    own: type[Design] = getattr(import_module(f"gearmesh.systems.{module}"), name)
    return own


def system_of(design: Design) -> System[Any]:
    """The gear system of a design: that of its kind, or of single members of it."""
    own = system(design.kind)
    return own.single if own.single is not None and isinstance(design, own.single.design) else own


def one_of_kinds() -> str:
    """What a kind may be, in words."""
    return "one of " + ", ".join(f'"{kind}"' for kind in kinds())


def complete_design(design: D) -> D:
    """The design with the defaults that only geometry knows. Raises DesignError for geometry that cannot exist."""
    return _refused_by_name(design, _fill)


def _fill(design: D) -> D:
    derive = system_of(design).derive
    if derive is None or design.complete:
        return design
    try:
        return design.fill(derive(design))
    except DesignError:
        # values are derived in the design's units, refusals are in mm
        if design.units != "mm":
            derive(design.in_mm())
        raise


def _train(design: Design) -> GearTrain:
    own = _fill(design).in_mm()
    train: GearTrain = system_of(own).build(own)
    # what makes measured teeth is loaded for designs that have some
    if getattr(own, "measured", None) is not None:
        train = _with_measured_places(own, _with_measured_flanks(own, train))
    return _eccentric(own, train)


def _with_measured_flanks(design: Design, train: GearTrain) -> GearTrain:
    """A gear set with the flanks that were measured, as the table `measured` of a design in mm says."""
    from gearmesh.metrology.flanks.measured_members import MeasuredMembers

    real = MeasuredMembers(design)
    if not real.any:
        return train
    return replace(made := train.with_members(real.of_member), warnings=(*made.warnings, *real.warnings))


def _with_measured_places(design: Design, train: GearTrain) -> GearTrain:
    """A gear set with its teeth at the places that were measured, as the table `measured` of a design in mm says."""
    from gearmesh.metrology.flanks.measured_members import MeasuredPlaces

    places, inspection = MeasuredPlaces(design), system_of(design).inspection
    if not any(places.says(name) for name in train.members):
        return train

    def basis_of(name: str) -> InspectionBasis | None:
        return None if inspection is None else inspection(design, train, name)

    return train.with_members(lambda member: places.of_member(member, basis_of))


def _eccentric(design: Design, train: GearTrain) -> GearTrain:
    """A gear set with the teeth of its members off their axes, as the table `assembly` of a design in mm says."""
    from gearmesh.design.runout import runout

    off = {name: runout(design, name) for name in train.members}
    if not any(map(any, off.values())):
        return train

    def place(member: Member) -> Member:
        return replace(member, mount=replace(member.mount, eccentricity=off[member.name]))

    pairs = tuple(replace(pair, pinion=place(pair.pinion), gear=place(pair.gear)) for pair in train.pairs)
    return replace(train, pairs=pairs, alike=())


def _try_build(design: Design) -> object:
    own = system_of(design)
    return own.build(_fill(design).in_mm()) if own.tried is None else own.tried(design.in_mm())


def build(design: Design) -> GearTrain:
    """The gear set of a validated design. Raises DesignError, with key, value and limit, for geometry that cannot exist."""
    whole = complete_design(design)
    train = _refused_by_name(whole, _train)
    notes = (*_of_small_teeth(whole), *unusual_settings(whole), *_of_other_defaults(whole))
    return replace(train, warnings=(*train.warnings, *notes))


def member(design: Design, name: str) -> ToolPart:
    """One of the members that the kind of a design, complete or not, makes one without the other. Raises as `build`."""
    make = system_of(design).members[name]

    def alone(design: Design) -> ToolPart:
        from gearmesh.metrology.flanks.measured_members import MeasuredMembers, MeasuredPlaces

        own = design.in_mm()
        if MeasuredPlaces(own).says(name):
            # the circle that pitch deviations are measured on is that of the whole gear set
            train = _train(design)
            return ToolPart(train.members[name], warnings=train.warnings)
        part, real = make(own), MeasuredMembers(own)
        return replace(part, member=real.of_member(part.member), warnings=(*part.warnings, *real.warnings))

    return _refused_by_name(design, alone, alone)


def _refused_by_name(design: D, make: Callable[[D], T], tried: Callable[[D], object] | None = None) -> T:
    """What is made of a design; a refusal names the key that the design sets (see `diagnosis`), looked for by what is `tried`."""
    try:
        return make(design)
    except FileError:
        raise
    except (DesignError, NoSolutionError) as failure:
        from gearmesh.systems.diagnosis import diagnose

        # what is made of a design is in mm
        failure.lengths_in = (design.units, design.mm_per_unit)
        raise diagnose(design, failure, tried or _try_build, _derived_values) from failure


def _derived_values(design: Design, made: object) -> dict[str, Any]:
    """Values by dotted keys, in the design's units, of which a gear set was made; none of what is no gear set."""
    if not hasattr(made, "pairs"):
        return {}
    try:
        return _pinned_values(_fill(design), cast("GearTrain", made))
    except (DesignError, NoSolutionError):
        return {}


def build_without_one(design: D) -> tuple[D, GearTrain, str] | None:
    """For a design that is refused: the design, complete, the gear set that it has without one of its keys, and that key.

    None where leaving out a single one mends nothing.
    """
    from gearmesh.systems.diagnosis import without_one

    mended = without_one(design, _train)
    if mended is None:
        return None
    whole, key = complete_design(mended[0]), mended[1]
    return whole.with_values({key: dict(design.own())[key]}), build(whole), key


def _of_small_teeth(design: Design) -> tuple[str, ...]:
    """What to say of a delta that is left out and thinner than it would be for larger teeth."""
    from gearmesh.design.core import DEFAULT_DELTA_MM

    delta = design.in_mm().contact.delta
    if design.sets("contact.delta") or not delta < (1.0 - 1e-9) * DEFAULT_DELTA_MM:
        return ()
    return (
        f"contact.delta = {delta:.4g} mm: the default, instead of {DEFAULT_DELTA_MM:g} mm because the teeth are small",
    )


def pin(design: D, train: GearTrain) -> D:
    """A design with everything given that its gear set was built of, so that no default has a part in it any more."""
    whole = complete_design(design)
    return whole.with_values(_pinned_values(whole, train))


def _pinned_values(whole: Design, train: GearTrain) -> dict[str, Any]:
    """Values by dotted keys, in the units of a complete design, of which its gear set was built; None of keys that it has not."""
    from gearmesh.systems.common.pinned import body_values

    own, of_kind = whole.in_mm(), system_of(whole).pinned
    values = {**body_values(own, train), **({} if of_kind is None else of_kind(own, train))}
    return {key: None if value is None else _in_units(whole, key, value) for key, value in values.items()}


def _in_units(design: Design, dotted: str, value: Any) -> Any:
    """A value in mm or deg in the units of a design's key."""
    key = type(design).key_at(dotted)
    scale = 1.0 if key is None else design.mm_per_unit**key.power
    return value / scale if isinstance(value, float) and scale != 1.0 else value


def _of_other_defaults(design: Design) -> tuple[str, ...]:
    """What to say of a design of an older version: keys that it leaves out and whose defaults have changed since, and those that
    mean something else."""
    from gearmesh.design.changes import changes_since, meanings_since

    if design.gearmesh is None:
        return ()
    changed = [change for change in changes_since(design.gearmesh, design.kind) if not design.sets(change.key)]
    lines = "; ".join(f"{change.key}: {change.old} -> {change.new} ({change.version})" for change in changed)
    said = [f"defaults have changed since gearmesh {design.gearmesh}: {lines}"] if changed else []
    for meaning in meanings_since(design.gearmesh):
        tables = [name for name in type(design).model_fields if getattr(getattr(design, name), meaning.flag, False)]
        keys = [key for table in tables for name in meaning.keys if design.sets(key := f"{table}.{name}")]
        if keys:
            said.append(f"{', '.join(keys)}: since gearmesh {meaning.version} {meaning.what}")
    return tuple(said)


def worm(design: Design) -> ToolPart:
    """The worm that grinds the pinion of a validated design.

    Raises DesignError, with key, value and limit, for a worm that cannot exist, and for kinds without one.
    """
    made = system_of(design).worm
    if made is None:
        raise ArgumentError("member", "worm", must_be=f"pinion or gear; kind {design.kind} has no worm")
    return made(complete_design(design).in_mm())
