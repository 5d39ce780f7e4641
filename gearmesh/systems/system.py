"""Gear systems: a design class with the functions for its designs. Each system is registered in one line."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import field, replace
from importlib import import_module
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeAlias, TypeVar, cast

from gearmesh.arguments import checks_arguments
from gearmesh.design.unusual import unusual_settings
from gearmesh.errors import ArgumentError, DesignError, FileError, KindError, NoSolutionError
from gearmesh.figures import Summary
from gearmesh.records import dataclass
from gearmesh.systems.kinds import OWN_KINDS, kind_of_words

if TYPE_CHECKING:
    from collections.abc import Mapping

    from gearmesh.design.core import Design
    from gearmesh.exchange.stage_form import StageForm
    from gearmesh.kernel.motion.rigid import Rigid
    from gearmesh.kernel.numeric.algebra import Array
    from gearmesh.metrology.measured_teeth import InspectionBasis
    from gearmesh.teeth.gear_train import GearPair, GearTrain, Member
    from gearmesh.teeth.tooth import Tooth

DesignT = TypeVar("DesignT", bound="Design")
#: contravariant: a function for designs of a class works for its subclasses, too
ForD = TypeVar("ForD", bound="Design", contravariant=True)

#: pinion rotations (P,), rad -> transmission error (P,), rad, relative to the value at 0
FirstOrder: TypeAlias = "Callable[[Array], Array]"


@dataclass(frozen=True)
class ToolPart:
    """A tool as a part that people make, such as the worm that grinds a pinion."""

    #: the part
    member: Member
    #: its own figures
    figures: Summary = field(default_factory=Summary)
    #: warnings about it
    warnings: tuple[str, ...] = ()
    #: transformation from its frame to the frame in which the tool generates teeth; None if it is no tool
    own_to_tool: Rigid | None = None
    #: name of the member that the tool generates
    ground: str = "pinion"
    #: tooth of this member as the tool generates it; None if the member is made this way
    tooth: Tooth | None = None


@dataclass(frozen=True)
class MissingValue:
    """A value that a table does not have. Symbol and column are empty if the whole table is missing.

    - symbol: symbol of its row, or the item where there are no symbols.
    - column: name of its column.
    - reason: why it is missing.
    """

    symbol: str
    column: str
    reason: str


@dataclass(frozen=True)
class SheetTable:
    """A table of a sheet."""

    #: its title
    title: str
    #: names of the columns with values
    columns: tuple[str, ...]
    #: rows of item, unit and one value per column; None if a column has no such value
    rows: tuple[tuple[Any, ...], ...]
    #: one symbol per row, or none at all
    symbols: tuple[str, ...] = ()
    #: values that are None for a reason that the reader should know
    missing: tuple[MissingValue, ...] = ()


@dataclass(frozen=True)
class Sheet:
    """Values derived from a design."""

    #: tables to print
    tables: tuple[SheetTable, ...]
    #: derived values under the design's keys, in its units
    values: dict[str, float]
    #: keys whose place the derived values take
    replaced: tuple[str, ...] = ()
    #: warnings in addition to those of the gear set
    warnings: tuple[str, ...] = ()
    #: values that follow from others; they are also needed to keep the gears if defaults change
    following: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Reserve:
    """Reserve of a pair's teeth against interference, in closed form."""

    #: number of the pair in the gear set
    pair: int
    #: row of the sheet and the member
    name: str
    #: the reserve, negative where teeth interfere
    value: float
    #: its unit
    unit: str


@dataclass(frozen=True)
class Setting:
    """A change of a key of the design."""

    #: dotted key
    key: str
    #: value before the change, in the design's units
    before: float
    #: value after the change
    after: float
    #: unit of both values
    unit: str
    #: effect of the change, as text
    effect: str


@dataclass(frozen=True)
class PatternShift:
    """Displacements that bring the contact of a flank to a place along the face, or next to it."""

    #: member and flank
    side: str
    #: the place along the face
    place: str
    #: wanted place, share of the gear's face from the toe
    asked: float
    #: displacement V of the pinion across both axes, mm
    v: float
    #: displacement H of the pinion along its axis, mm
    h: float
    #: displacement J of the gear along its axis, mm
    j: float
    #: change of the shaft angle, deg
    alpha: float
    #: place of the contact with these displacements, the nearest that can be reached; share of the face
    share: float

    @property
    def reached(self) -> bool:
        """True if the contact is at the wanted place."""
        return self.share == self.asked


@dataclass(frozen=True)
class PatternCheck(Generic[DesignT]):
    """Mountings that bring the contact to places of the gear's face.

    - shifts: returns them for a design in mm, its gear set and the letters of the displacements.
    - keys: keys of the table assembly, by the letters V, H, J and alpha.
    - usual: letters of the displacements that are used by default; their number is always the same.
    """

    shifts: Callable[[DesignT, GearTrain, tuple[str, ...]], list[PatternShift]]
    keys: Mapping[str, str]
    usual: tuple[str, ...]


@dataclass(frozen=True)
class Displacements(Generic[ForD]):
    """Errors of assembly that move the members of a pair and do not change their teeth.

    - keys: keys of the table `assembly`, without its name: "dx", not "assembly.dx".
    - bases: returns the bases of the mounts of pinion and gear. Its arguments are a design in mm in which all errors
      are 0, its gear set, and values (M,) of each error (mm, deg) by the names in `keys`. It returns rotations (M, 3, 3)
      and translations (M, 3).
    """

    keys: tuple[str, ...]
    bases: Callable[[ForD, GearTrain, Mapping[str, Array]], tuple[Rigid, Rigid]]

    def __post_init__(self) -> None:
        """Raise KindError for names of keys with the name of a table."""
        for key in self.keys:
            if "." in key:
                plain = key.rpartition(".")[2]
                raise KindError(
                    "displacements", key, must_be=f'a key of the table assembly without its name: "{plain}"'
                )

    def displaced(self, design: Any, train: GearTrain, errors: Mapping[str, Array]) -> tuple[Rigid, Rigid]:
        """Return the bases of the mounts of pinion and gear with errors of assembly, from `bases`.

        - design: in mm, without errors of assembly.
        - train: its gear set.
        - errors: values (M,), mm or deg, of every error in `keys`.

        Raises KindError if `bases` asks for another key.
        """
        try:
            return self.bases(design, train, errors)
        except KeyError as missing:
            raise KindError(
                "displacements",
                reason=f"`bases` asks for the error {missing}",
                must_be=f"one of {', '.join(self.keys)}",
            ) from missing


@dataclass(frozen=True)
class DrawnRows:
    """Rows of the sheet that a workshop drawing of a member shows, by their symbols."""

    #: rows with a column of the member, or of the pair
    own: tuple[str, ...]
    #: rows of the mating gears
    mating: tuple[str, ...] = ()
    #: symbol of the tip diameter
    tip: str = ""
    #: symbols of the reference or pitch diameter at toe and heel
    reference: tuple[str, str] | None = None
    #: the class, and the rows that are shown beside it if the design sets the key `accuracy`
    tolerances: tuple[str, ...] = ()
    #: the key of the accuracy class
    accuracy: str = ""
    #: column names, such as least and largest; the first set that a table of a pair has is shown side by side
    ranges: tuple[tuple[str, ...], ...] = ()
    #: title of the table whose rows go before rows of the same symbol in other tables
    measured: str = ""


class NominalStresses(Protocol):
    """Nominal stresses of a mesh by a standard, without load factors."""

    def root_stress(self, torque: float) -> tuple[float, float]:
        """Return root stresses, MPa, of pinion and gear under a torque on the pinion, N mm; NaN where unknown."""
        ...

    def contact_stress(self, torque: float, modulus: float) -> float:
        """Return the contact stress, MPa, under a torque on the pinion, N mm; `modulus`: E*, MPa."""
        ...


@dataclass(frozen=True)
class System(Generic[DesignT]):
    """A gear system: a kind with its designs and the functions for them. Only `build` is required.

    Functions take a complete design in mm unless stated otherwise, with its gear set (`GearTrain`) as second argument
    where they have one.
    """

    #: name of the kind
    kind: str
    #: class of its designs
    design: type[DesignT]
    #: gear set of a design
    build: Callable[[DesignT], GearTrain]
    #: functions for single members by name, if one can be made without the other; `derive` is not called for the design
    members: Mapping[str, Callable[[DesignT], ToolPart]] = field(default_factory=dict)
    #: faster substitute of `build` for the search of the key at fault; `derive` is not called for its design. It is
    #: refused where `build` is, except perhaps where `build` would have to search long
    tried: Callable[[DesignT], object] | None = None
    #: values, in the design's units, of keys left out that only geometry knows, by dotted key
    derive: Callable[[DesignT], dict[str, float]] | None = None
    #: grinding worm of a design in mm
    worm: Callable[[DesignT], ToolPart] | None = None
    #: sheet of a design, in its own units, and its gear set
    sheet: Callable[[DesignT, GearTrain], Sheet] | None = None
    #: reserves of which the sheet warns, for the check
    reserves: Callable[[DesignT, GearTrain], tuple[Reserve, ...]] | None = None
    #: tables of one of the `members` without the others
    member_sheet: Callable[[DesignT, str], tuple[SheetTable, ...]] | None = None
    #: tables of the forces for a torque (Nm) on the pinion, with powers if its speed (1/min) is given
    forces: Callable[[DesignT, float, float | None], tuple[SheetTable, ...]] | None = None
    #: factors of the nominal stresses of a mesh of a design
    nominal: Callable[[DesignT, GearPair], NominalStresses | None] | None = None
    #: settings that compensate the assembly errors of a design in its own units
    compensate: Callable[[DesignT], list[Setting]] | None = None
    #: settings of the named member that compensate the assembly errors
    refinish: Callable[[DesignT, str], list[Setting]] | None = None
    #: V-H check of a design in mm and its gear set
    vh: PatternCheck[DesignT] | None = None
    #: transmission error in closed form for a design in mm with assembly errors
    first_order: Callable[[DesignT], FirstOrder | None] | None = None
    #: moves the members for many assemblies at once
    displacements: Displacements[DesignT] | None = None
    #: values by dotted key that the build chose, in mm, for a complete design in mm and its gear set
    pinned: Callable[[DesignT, GearTrain], dict[str, Any]] | None = None
    #: rows of the sheet on a workshop drawing; by default all rows of the member
    drawn: DrawnRows | None = None
    #: basis for the inspection of the named member of a design and its gear set
    inspection: Callable[[DesignT, GearTrain, str], InspectionBasis] | None = None
    #: reading and writing of its stages in REXS models
    rexs: StageForm | None = None
    #: system for designs of the same kind with one member and no mating gear
    single: System[Any] | None = None
    #: True for the keys of such a design
    is_single: Callable[[Mapping[str, Any]], bool] | None = None

    def of_keys(self, keys: Mapping[str, Any]) -> System[Any]:
        """Return the system itself, or the system of single members for the keys of such a design.

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


@dataclass(frozen=True)
class _LateFunction:
    """A function that is loaded on its first call."""

    #: module below `gearmesh.systems`
    module: str
    #: name of the function
    name: str

    def __call__(self, *arguments: Any) -> Any:
        return getattr(import_module(f"gearmesh.systems.{self.module}"), self.name)(*arguments)


def late(reference: str) -> Any:
    """Return a function of a kind that is loaded on its first call, by its reference, "beveloid.build:build"."""
    module, _, name = reference.partition(":")
    return _LateFunction(module, name)


#: gear systems by kind
_REGISTERED_SYSTEMS: dict[str, System[Any]] = {}
#: group of the entry points by which other packages add gear systems, each under its kind
ENTRY_POINT_GROUP = "gearmesh.systems"


@checks_arguments
def register(system: System[Any]) -> None:
    """Register a gear system under its kind, for `load`, `build` and everything else.

    The command line also finds systems of installed packages by their entry points of the group `gearmesh.systems`. The
    name of an entry point is the kind, and its object is the system.

    Parameters
    ----------
    system : System
        Its kind, its class of designs, and what is made of them.

    Examples
    --------
    >>> gm.register(gm.system("beveloid"))
    """
    _REGISTERED_SYSTEMS[system.kind] = system


def kinds() -> tuple[str, ...]:
    """Return all kinds of designs.

    Returns
    -------
    tuple of str
        What the key `kind` of a design may be: kinds of gearmesh, of registered systems, and of installed packages,
        which are not loaded.

    Examples
    --------
    >>> "hypoid" in gm.kinds()
    True
    """
    from importlib.metadata import entry_points

    installed = (entry.name for entry in entry_points(group=ENTRY_POINT_GROUP))
    return tuple(dict.fromkeys((*loaded_kinds(), *installed)))


def loaded_kinds() -> tuple[str, ...]:
    """Return the kinds that come with gearmesh, and the kinds that were registered; installed packages are not searched."""
    return tuple(dict.fromkeys((*OWN_KINDS, *_REGISTERED_SYSTEMS)))


def system(kind: Any) -> System[Any]:
    """Return the gear system of a kind.

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
    if isinstance(kind, str) and kind not in _REGISTERED_SYSTEMS and kind in OWN_KINDS:
        for registered in import_module(f"gearmesh.systems.{OWN_KINDS[kind].system}").GEAR_SYSTEMS:
            _REGISTERED_SYSTEMS.setdefault(registered.kind, registered)
    if isinstance(kind, str) and (kind in _REGISTERED_SYSTEMS or _registered_from_outside(kind)):
        return _REGISTERED_SYSTEMS[kind]
    from gearmesh.design.shown import value_text
    from gearmesh.errors import nearest

    made_by = kind_of_words(kind) if isinstance(kind, str) else ""
    close = nearest(kind, kinds()) if isinstance(kind, str) and not made_by else None
    hint = f"; {made_by}" if made_by else f'; did you mean "{close}"?' if close else ""
    raise DesignError("kind", kind, shown=value_text(kind), must_be=f"{one_of_kinds()}{hint}")


def _registered_from_outside(kind: str) -> bool:
    """True if an installed package has a gear system of this kind; it is then registered.

    The system is an entry point of the group gearmesh.systems. Entry points are only searched for unknown kinds. Raises
    KindError where the package cannot be loaded, or the object is no system of this kind.
    """
    from importlib.metadata import entry_points

    for entry in entry_points(group=ENTRY_POINT_GROUP, name=kind):
        where = f'entry point "{entry.name}" = "{entry.value}"'
        try:
            found = entry.load()
        except Exception as failure:  # of a package that is not ours
            reason = " ".join(f"{type(failure).__name__}: {failure}".split())
            raise KindError(where, reason=f"the kind cannot be loaded: {reason}") from failure
        if not isinstance(found, System) or found.kind != kind:
            has = f'a system of the kind "{found.kind}"' if isinstance(found, System) else f"a {type(found).__name__}"
            raise KindError(where, reason=f"it is {has}", must_be=f'a gearmesh.System of the kind "{kind}"')
        register(found)
    return kind in _REGISTERED_SYSTEMS


def about(kind: str) -> str:
    """Return the description of a kind in one line; no gear system of gearmesh is loaded.

    The description of an installed kind that cannot be loaded is the reason. Raises DesignError naming the nearest kind.
    """
    if kind in OWN_KINDS and kind not in _REGISTERED_SYSTEMS:
        return OWN_KINDS[kind].about
    try:
        known: str = system(kind).design.about
        return known
    except KindError as fault:
        return f"({fault})"


def design_class(kind: str) -> type[Design]:
    """Return the class of the designs of a kind; its other functions are not loaded.

    Raises DesignError naming the nearest kind.
    """
    if kind not in OWN_KINDS or kind in _REGISTERED_SYSTEMS:
        return system(kind).design
    module, name = OWN_KINDS[kind].design
    own: type[Design] = getattr(import_module(f"gearmesh.systems.{module}"), name)
    return own


def assembly_key(design: type[Design], key: str) -> str:
    """Return the dotted key of an error of assembly of a class of designs.

    Raises KindError where a kind names a key that its designs do not have.
    """
    dotted, table = f"assembly.{key}", design.table_of("assembly") if "assembly" in design.names() else None
    if table is None or design.key_at(dotted) is None:
        known = "its designs have no table assembly" if table is None else f"one of {', '.join(table.names())}"
        raise KindError(f"{design.own_kind}: errors of assembly", key, must_be=known)
    return dotted


def system_of(design: Design) -> System[Any]:
    """Return the gear system of a design: the system of its kind, or of single members of this kind."""
    own = system(design.kind)
    return own.single if own.single is not None and isinstance(design, own.single.design) else own


def one_of_kinds() -> str:
    """Return the allowed kinds as text."""
    return "one of " + ", ".join(f'"{kind}"' for kind in kinds())


class NotBuiltError(Exception):
    """A build was requested where building is not allowed."""


_builds: ContextVar[bool] = ContextVar("builds", default=True)


@contextmanager
def without_building() -> Iterator[None]:
    """Run the body of the context until it would build a design; refusals before are raised without any work."""
    token = _builds.set(False)
    try:
        yield
    except NotBuiltError:
        pass
    finally:
        _builds.reset(token)


def _refuse_to_build() -> None:
    """Raise NotBuiltError where nothing may be built."""
    if not _builds.get():
        raise NotBuiltError


def complete_design(design: DesignT) -> DesignT:
    """Return the design with the defaults that only geometry knows.

    Raises DesignError for geometry that cannot exist.
    """
    _refuse_to_build()
    with _naming_keys(design):
        return _fill(design)


def _fill(design: DesignT) -> DesignT:
    """Return the design with its derived values."""
    derive = system_of(design).derive
    if derive is None or design.complete:
        return design
    try:
        return design.fill(derive(design))
    except DesignError:
        # values are derived in the design's units, but refusals are in mm: derive again in mm
        if design.units != "mm":
            derive(design.in_mm())
        raise


def _train(design: Design) -> GearTrain:
    """Return the gear set of a design, with measured flanks and places and with eccentric members."""
    own = _fill(design).in_mm()
    return finished(own, system_of(own).build(own))


def finished(own: Design, train: GearTrain) -> GearTrain:
    """Return the gear set that a kind built of a design in mm, with measured flanks and places and eccentric members.

    Raises KindError where surfaces of a tooth do not join.
    """
    for member in train.members.values():
        member.tooth.prove_joined()
    # modules for measured teeth are only loaded if the design has some
    if getattr(own, "measured", None) is not None:
        train = _with_measured_places(own, _with_measured_flanks(own, train))
    return _eccentric(own, train)


def _with_measured_flanks(design: Design, train: GearTrain) -> GearTrain:
    """Return a gear set with the measured flanks of the table `measured` of a design in mm."""
    from gearmesh.metrology.flanks.measured_members import MeasuredMembers

    real = MeasuredMembers(design)
    if not real.any:
        return train
    return replace(made := train.with_members(real.of_member), warnings=(*made.warnings, *real.warnings))


def _with_measured_places(design: Design, train: GearTrain) -> GearTrain:
    """Return a gear set with its teeth at the measured places of the table `measured` of a design in mm."""
    from gearmesh.metrology.flanks.measured_members import MeasuredPlaces

    places, inspection = MeasuredPlaces(design), system_of(design).inspection
    if not any(places.says(name) for name in train.members):
        return train

    def basis_of(name: str) -> InspectionBasis | None:
        return None if inspection is None else inspection(design, train, name)

    made = train.with_members(lambda member: places.of_member(member, basis_of))
    # at the same rotation, meshes have different teeth of a sun in contact
    return replace(made, alike=()) if any(member.index.uneven for member in made.members.values()) else made


def _eccentric(design: Design, train: GearTrain) -> GearTrain:
    """Return a gear set whose teeth are off the axes as the table `assembly` of a design in mm says."""
    from gearmesh.design.runout import runout

    off = {name: runout(design, name) for name in train.members}
    if not any(map(any, off.values())):
        return train

    def place(member: Member) -> Member:
        return replace(member, mount=replace(member.mount, eccentricity=off[member.name]))

    return replace(train.with_members(place), alike=())


def try_build(design: Design) -> object:
    """Build the gear set of a design, or try it faster if the system can."""
    own = system_of(design)
    return own.build(_fill(design).in_mm()) if own.tried is None else own.tried(design.in_mm())


def build(design: Design) -> GearTrain:
    """Return the gear set of a validated design.

    Raises DesignError, with key, value and limit, for geometry that cannot exist.
    """
    _refuse_to_build()
    whole = complete_design(design)
    own = whole.in_mm()
    with _naming_keys(whole):
        made = system_of(own).build(own)
    # what is refused here is not in the trials of a search
    with _naming_keys(whole, None):
        train = finished(own, made)
    notes = (*_of_small_teeth(whole), *unusual_settings(whole), *_of_other_defaults(whole))
    return replace(train, warnings=(*train.warnings, *notes))


def member(design: Design, name: str) -> ToolPart:
    """Return a member that the kind of a design, complete or not, makes without the other. Raises as `build` does."""
    _refuse_to_build()
    make = system_of(design).members[name]

    def alone(design: Design) -> ToolPart:
        from gearmesh.metrology.flanks.measured_members import MeasuredMembers, MeasuredPlaces

        own = design.in_mm()
        if MeasuredPlaces(own).says(name):
            # the measuring circle of pitch deviations needs the whole gear set
            train = _train(design)
            return ToolPart(train.members[name], warnings=train.warnings)
        part, real = make(own), MeasuredMembers(own)
        part.member.tooth.prove_joined()
        return replace(part, member=real.of_member(part.member), warnings=(*part.warnings, *real.warnings))

    with _naming_keys(design, alone):
        return alone(design)


@contextmanager
def _naming_keys(design: Design, tried: Callable[[Any], object] | None = try_build) -> Iterator[None]:
    """Run the body of the context; refusals of a design then name a key that the design sets (see `diagnosis`).

    `tried`: function with which the key is searched; None: refusals keep their key, and get its value.
    """
    try:
        yield
    except FileError:
        raise
    except (DesignError, NoSolutionError) as failure:
        from gearmesh.systems.diagnosis import diagnose, with_set_value

        # refusals are in mm
        failure.lengths_in = (design.units, design.mm_per_unit)
        told = with_set_value(design, failure) if tried is None else diagnose(design, failure, tried, _derived_values)
        # an error that is its own cause would send whoever follows causes round in a circle
        raise told from (failure if told is not failure else failure.__cause__)


def _derived_values(design: Design, made: object) -> dict[str, Any]:
    """Return the values by dotted key, in the design's units, with which a gear set was built.

    The result is empty for an object that is no gear set.
    """
    if not hasattr(made, "pairs"):
        return {}
    try:
        whole = _fill(design)
        return {**dict(whole.derived_keys()), **_pinned_values(whole, cast("GearTrain", made))}
    except (DesignError, NoSolutionError):
        return {}


def build_without_one(design: DesignT) -> tuple[DesignT, GearTrain, str] | None:
    """Return a refused design with its gear set without one of its keys, and this key.

    The returned design is complete. None if no single key, when left out, makes the design buildable.
    """
    from gearmesh.systems.diagnosis import without_one

    mended = without_one(design, _train)
    if mended is None:
        return None
    whole, key = complete_design(mended[0]), mended[1]
    return whole.with_values({key: dict(design.own())[key]}), build(whole), key


def _of_small_teeth(design: Design) -> tuple[str, ...]:
    """Return the note on a default delta that is reduced for small teeth."""
    from gearmesh.design.core import DEFAULT_DELTA_MM

    delta = design.in_mm().contact.delta
    if design.sets("contact.delta") or not delta < (1.0 - 1e-9) * DEFAULT_DELTA_MM:
        return ()
    return (
        f"contact.delta = {delta:.4g} mm: the default, instead of {DEFAULT_DELTA_MM:g} mm because the teeth are small",
    )


def pin(design: DesignT, train: GearTrain) -> DesignT:
    """Return a design with every value with which its gear set was built, so that no default matters any more."""
    whole = complete_design(design)
    return whole.with_values(_pinned_values(whole, train))


def _pinned_values(whole: Design, train: GearTrain) -> dict[str, Any]:
    """Return the values by dotted key with which the gear set of a complete design was built.

    Values are in the design's units; None for keys that the pinned design must not have.
    """
    from gearmesh.systems.common.pinned import body_values

    own, of_kind = whole.in_mm(), system_of(whole).pinned
    values = {**body_values(own, train), **({} if of_kind is None else of_kind(own, train))}
    return {key: None if value is None else _in_units(whole, key, value) for key, value in values.items()}


def _in_units(design: Design, dotted: str, value: Any) -> Any:
    """Return a value in mm or deg in the units of a design's key."""
    key = type(design).key_at(dotted)
    scale = 1.0 if key is None else design.mm_per_unit**key.power
    return value / scale if isinstance(value, float) and scale != 1.0 else value


def _of_other_defaults(design: Design) -> tuple[str, ...]:
    """Return the notes on a design of an older version.

    They concern defaults that have changed for keys left out, and keys whose meaning has changed.
    """
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
    """Return the worm that grinds the pinion of a validated design.

    Raises DesignError, with key, value and limit, for a worm that cannot exist, and for kinds without a worm.
    """
    made = system_of(design).worm
    if made is None:
        raise ArgumentError("member", "worm", must_be=f"pinion or gear; kind {design.kind} has no worm")
    part = made(complete_design(design).in_mm())
    part.member.tooth.prove_joined()
    return part
