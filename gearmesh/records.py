"""Data classes that start quickly: as those of the standard library, with methods that are made when they are needed.

`dataclasses.dataclass` writes and compiles up to six methods of each class when its module is imported. That takes half
of the import of gearmesh's modules, and most classes are never used by a command. Here a class compiles only its
`__init__`, when it makes its first instance. The other methods are shared functions. Fields, defaults, `replace`,
pickling, subclasses of either kind and signatures are those of the standard library.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dataclasses import dataclass as dataclass
else:
    import dataclasses
    from operator import attrgetter
    from reprlib import recursive_repr

    def dataclass(cls=None, /, *, frozen=False, eq=True, repr=True):
        """Return a class with the methods of a data class, or the decorator for these options."""
        if cls is None:
            return lambda decorated: _finished(decorated, frozen, eq, repr)
        return _finished(cls, frozen, eq, repr)

    def _finished(cls, frozen, eq, shown):
        """Return a class with its fields and methods."""
        own = dict(vars(cls))
        # a subclass of a data class is checked, and guarded, by the standard library
        derived = any(dataclasses.is_dataclass(base) for base in cls.__mro__[1:])
        dataclasses.dataclass(init=False, repr=False, eq=False, frozen=frozen and derived)(cls)
        if frozen and not derived:
            cls.__dataclass_params__.frozen = True
            _guard(cls)
        if "__init__" not in own:
            cls.__init__ = _Later(cls, frozen)
        if shown and "__repr__" not in own:
            cls.__repr__ = _repr(cls)
        if eq:
            compared = tuple(field.name for field in dataclasses.fields(cls) if field.compare)
            values = _getter(compared)
            if "__eq__" not in own:
                cls.__eq__ = _eq(values)
            # a class that defines __eq__ alone has the __hash__ None
            if own.get("__hash__") is None:
                cls.__hash__ = _hash(values) if frozen else None
        return cls

    def _getter(names):
        """Return the function that returns the values of an instance as a tuple."""
        if len(names) > 1:
            return attrgetter(*names)
        return lambda instance: tuple(getattr(instance, name) for name in names)

    def _eq(values):
        """Return the comparison of instances of one class by their values."""

        def __eq__(self, other):
            return values(self) == values(other) if other.__class__ is self.__class__ else NotImplemented

        return __eq__

    def _hash(values):
        """Return the hash of an instance by its values."""

        def __hash__(self):
            return hash(values(self))

        return __hash__

    def _repr(cls):
        """Return the text of an instance: the name of its class, and its fields."""
        names = tuple(field.name for field in dataclasses.fields(cls) if field.repr)

        @recursive_repr()
        def __repr__(self):
            return f"{self.__class__.__qualname__}({', '.join(f'{name}={getattr(self, name)!r}' for name in names)})"

        return __repr__

    def _guard(cls):
        """Refuse that fields of a frozen class are set or deleted."""
        names = frozenset(field.name for field in dataclasses.fields(cls))

        def __setattr__(self, name, value):
            if type(self) is cls or name in names:
                raise dataclasses.FrozenInstanceError(f"cannot assign to field {name!r}")
            super(cls, self).__setattr__(name, value)

        def __delattr__(self, name):
            if type(self) is cls or name in names:
                raise dataclasses.FrozenInstanceError(f"cannot delete field {name!r}")
            super(cls, self).__delattr__(name)

        cls.__setattr__, cls.__delattr__ = __setattr__, __delattr__

    class _Later:
        """The `__init__` of a class, which is compiled and takes the place of this object when it is first asked for."""

        def __init__(self, cls, frozen):
            self.cls, self.frozen = cls, frozen

        def __get__(self, instance, owner=None):
            made = _init(self.cls, self.frozen)
            self.cls.__init__ = made
            return made.__get__(instance, owner)

    def _init(cls, frozen):
        """Return the `__init__` of a class, compiled."""
        given = [field for field in dataclasses.fields(cls) if field.init]
        # values of a frozen class go straight into its table: half the time of object.__setattr__
        known, lines = {"UNSET": _UNSET}, ["put = self.__dict__"] if frozen else []
        for field in dataclasses.fields(cls):
            name, value = field.name, field.name
            if field.default_factory is not dataclasses.MISSING:
                known[f"factory_{name}"] = field.default_factory
                value = f"factory_{name}() if {name} is UNSET else {name}" if field.init else f"factory_{name}()"
            elif not field.init:
                continue
            lines.append(f"put[{name!r}] = {value}" if frozen else f"self.{name} = {value}")
        if hasattr(cls, "__post_init__"):
            lines.append("self.__post_init__()")
        parameters = ["self"] + [_parameter(field, known) for field in given if not field.kw_only]
        if any(field.kw_only for field in given):
            parameters += ["*"] + [_parameter(field, known) for field in given if field.kw_only]
        body = "\n  ".join(lines or ["pass"])
        made = {}
        exec(
            f"def make({', '.join(known)}):\n def __init__({', '.join(parameters)}):\n  {body}\n return __init__", made
        )
        init = made["make"](**known)
        init.__qualname__, init.__module__ = f"{cls.__qualname__}.__init__", cls.__module__
        init.__annotations__ = {**{field.name: field.type for field in given}, "return": None}
        return init

    def _parameter(field, known):
        """Return a parameter of `__init__`, and add its default to the `known` values."""
        if field.default is not dataclasses.MISSING:
            known[f"default_{field.name}"] = field.default
            return f"{field.name}=default_{field.name}"
        return field.name if field.default_factory is dataclasses.MISSING else f"{field.name}=UNSET"

    class _Unset:
        """The default of a parameter whose field has a factory."""

        def __repr__(self):
            return "<factory>"

    _UNSET = _Unset()
