"""Faults of a document, reported where its author wrote them: dotted path, value, and what is allowed.

The code that finds a fault (the model of the document, a constructor of the planner, a reader of text) knows the path
by SI names. Here it becomes the path with the keys as they were written (`speed_mm_s`), and the value as written.
"""

from __future__ import annotations

import difflib
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from assur.planner.errors import InputError
from assur.scenes.units import any_unit, twin_of

Path = tuple[str | int, ...]
"""Keys and indices from the root of a document."""


class _Nothing:
    """In place of a value that was not given."""

    def __repr__(self) -> str:
        return "nothing"

    def __reduce__(self) -> str:
        return "NOTHING"


NOTHING = _Nothing()


class Unreadable:
    """In place of a part of a document that has a fault: `written`."""

    def __init__(self, written: object = NOTHING) -> None:
        self.written: object = written.written if isinstance(written, Unreadable) else written


SILENT = ("match",)
"""Fields that a document may leave out, although a missing one can be the fault: a message may name them."""


MOST_FAULTS = 20
"""Number of faults of one document that are reported; of further faults only their number is."""


class DocumentError(InputError):
    """The caller's fault in a document. `line`: where in its file, if it came from one; `more`: further faults, up to
    `MOST_FAULTS` in all, each with its line; `left_out`: the number of those beyond."""

    def __init__(
        self,
        field: str,
        value: object,
        allowed: str,
        line: int | None = None,
        more: Sequence[InputError] = (),
        left_out: int = 0,
    ) -> None:
        super().__init__(field, value, allowed)
        self.line = line
        if line is not None:
            self.args = (f"line {line}: {self.args[0]}",)
        self.more = tuple(more)
        self.left_out = left_out
        for other in self.more:
            self.add_note(str(other))
        if left_out:
            self.add_note(f"and {left_out} more")

    def __reduce__(self) -> tuple[type[DocumentError], tuple[object, ...]]:  # type: ignore[override]
        return type(self), (self.field, self.value, self.allowed, self.line, self.more, self.left_out)

    @property
    def errors(self) -> list[dict[str, Any]]:
        """This fault and the further ones, as a list of mappings: `field`, `value`, `allowed`, and `line` if it came
        from a text. A field that is missing has no `value`."""
        return [_as_mapping(each) for each in (self, *self.more)]

    def relocated(
        self, field: Callable[[str], str], line: Callable[[str], int | None] = lambda _: None
    ) -> DocumentError:
        """The same faults where the document is a part of another: each with the `field` and the `line` that it has
        there. A line that is known stays. Of two that have one field there, the first is kept."""

        def one(each: InputError) -> DocumentError:
            known, name = getattr(each, "line", None), field(each.field)
            return DocumentError(name, each.value, each.allowed, line(name) if known is None else known)

        return together([one(each) for each in (self, *self.more)], self.left_out)


def documented(error: InputError) -> DocumentError:
    """A fault as one of a document."""
    return error if isinstance(error, DocumentError) else DocumentError(error.field, error.value, error.allowed)


@contextmanager
def raised_as(make: Callable[[InputError], Exception]) -> Iterator[None]:
    """An `InputError` that is raised inside is raised as what `make` makes of it."""
    try:
        yield
    except InputError as error:
        raise make(error) from error


def _as_mapping(error: InputError) -> dict[str, Any]:
    line = getattr(error, "line", None)
    value = {} if error.value is NOTHING else {"value": error.value}
    return {"field": error.field, **value, "allowed": error.allowed} | ({} if line is None else {"line": line})


def together(faults: Sequence[DocumentError], left_out: int = 0) -> DocumentError:
    """Several faults of one document as one error: the first fault, with the others in `more`. Of two at one field the
    first is kept, for the second follows from it. `left_out`: the number of further ones."""
    every = {each.field: each for fault in reversed(faults) for each in reversed((fault, *fault.more))}
    order = dict.fromkeys(each.field for fault in faults for each in (fault, *fault.more))
    return _joined([every[name] for name in order], left_out + sum(fault.left_out for fault in faults))


def _joined(faults: Sequence[InputError], left_out: int) -> DocumentError:
    first, *rest = faults
    kept, line = rest[: MOST_FAULTS - 1], getattr(first, "line", None)
    return DocumentError(first.field, first.value, first.allowed, line, kept, left_out + len(rest) - len(kept))


WHOLE = "request"
"""Name of a whole document, in which a fault has no field."""


def dotted(path: Sequence[str | int]) -> str:
    """("task", 0, "pick") → "task[0].pick"; the root is `WHOLE`."""
    text = ""
    for part in path:
        text += f"[{part}]" if isinstance(part, int) else f".{part}" if text else part
    return text or WHOLE


def written_key(mapping: dict[str, object], key: str) -> str | None:
    """The key under which `mapping` holds the quantity `key`, in whichever unit; None if it does not."""
    if key in mapping:
        return key
    twin = twin_of(key)
    return twin if twin is not None and twin in mapping else None


def as_written(document: object, path: Sequence[str | int]) -> tuple[Path, object]:
    """The path with the keys as written, and the value there (NOTHING where the document has none)."""
    found: list[str | int] = []
    for part in path:
        document = document.written if isinstance(document, Unreadable) else document
        if hasattr(document, "tolist"):  # an array of NumPy
            document = document.tolist()
        if isinstance(document, dict):
            key = part if part in document else written_key(document, str(part))
            found.append(str(part if key is None else key))
            document = NOTHING if key is None else document[key]
        elif isinstance(document, list) and isinstance(part, int) and 0 <= part < len(document):
            found.append(part)
            document = document[part]
        else:
            found.append(part)
            document = NOTHING
    return tuple(found), document


def fault(document: object, path: Sequence[str | int], allowed: str) -> DocumentError:
    """The error for the field at `path` of `document`."""
    written, value = as_written(document, path)
    return DocumentError(dotted(written), value, allowed)


def between(low: float, high: float, value: object) -> str:
    """A range in words for an error about `value`. If the value is near to the range, the text states how far outside
    it is: as printed, it may be between the ends."""
    printed = f"{low:.6g} to {high:.6g}"
    if not isinstance(value, int | float):
        return printed
    by = max(low - value, value - high)
    hidden = float(f"{low:.6g}") <= value <= float(f"{high:.6g}")
    if not hidden and by > NEAR * (high - low):
        return printed
    return f"{printed}; it is outside by {f'{by:.2g}' if by > LEAST_SHOWN else f'less than {LEAST_SHOWN:g}'}"


NEAR = 1e-3
"""A value that is outside of a range by up to this share of it is near."""
LEAST_SHOWN = 1e-12
"""By less than this a value is outside of a range because units were converted."""
MOST_MEANT = 4
"""Number of names containing the given text that are suggested."""
LEAST_HELD = 3
"""Least length of a given text that is searched within names, in characters."""


def _meant(given: str, names: Sequence[str]) -> str:
    """The names that were probably meant by `given`, as a question: up to `MOST_MEANT` that hold it (`rh-6`), capitals
    and marks left out, else the one that is spelt nearest; nothing if there is none."""
    spoken, known = _spoken(given), {_spoken(name): name for name in names}
    near = [name for name in names if spoken in _spoken(name)] if len(spoken) >= LEAST_HELD else []
    near = near or difflib.get_close_matches(given, names, n=1)
    near = near or [known[each] for each in difflib.get_close_matches(spoken, known, n=1)]
    return f"; did you mean {' or '.join(sorted(near))}?" if 0 < len(near) <= MOST_MEANT else ""


def _spoken(name: str) -> str:
    return "".join(c for c in name.lower() if c.isalnum())


def likeliest(value: str, names: Iterable[str]) -> str:
    """The names that there are, in words, and those that were probably meant by `value`."""
    listed = list(names)
    return ", ".join(listed) + _meant(value, listed)


MOST_CHOICES = 12
"""Number of the names in a document that a message lists."""


def choices(names: Collection[str], given: str) -> str:
    """Names that a document gives, in words, the first `MOST_CHOICES` of them, and those that `given` probably
    means."""
    shown = sorted(names)
    more = f" and {len(shown) - MOST_CHOICES} more" if len(shown) > MOST_CHOICES else ""
    return ", ".join(shown[:MOST_CHOICES]) + more + _meant(given, shown) if shown else "none is there"


class Refused(Exception):
    """A fault in a part of a document: `path` below that part by SI names, and what is `allowed`, or a function that
    returns it for the key and the value as written. `field`: the name that the planner's constructor has for the part.

    The reader of a part does not know the document or its own place in it: `within` adds the place, and `located` makes
    the fault.
    """

    def __init__(self, allowed: str | Callable[[str, object], str], *path: str | int, field: str = "") -> None:
        super().__init__(allowed, path, field)
        self.allowed, self.path, self.field = allowed, path, field
        self.more: tuple[Refused | DocumentError, ...] = ()
        """What is wrong with further parts, where several were read."""

    def at(self, *path: str | int) -> Refused:
        """This, as a fault of the larger part that has the part at `path`."""
        self.path = path + self.path
        for other in self.more:
            if isinstance(other, Refused):
                other.at(*path)
        return self

    def fault(self, document: object) -> DocumentError:
        """The faults, with their places in the document."""
        others = [each if isinstance(each, DocumentError) else each.fault(document) for each in self.more]
        return together([self.one(document), *others])

    def one(self, document: object) -> DocumentError:
        """The first of them."""
        path = _follow(document, self.path, self.field) if self.field else self.path
        if isinstance(self.allowed, str):
            return fault(document, path, self.allowed)
        written, value = as_written(document, path)
        return DocumentError(dotted(written), value, self.allowed(str(written[-1]), value))


FAULTS = (Refused, InputError)
"""What a reader of a part raises for a fault in it."""


def fault_at(error: Refused | InputError, *path: str | int) -> Refused | DocumentError:
    """The fault of a part, as one of the larger part that has the part at `path`."""
    if isinstance(error, Refused):
        return error.at(*path)
    return error if isinstance(error, DocumentError) else Refused(error.allowed, *path, field=error.field)


class within:
    """A part that is refused inside is refused at `path`, or below it."""

    def __init__(self, *path: str | int) -> None:
        self._path = path

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> None:
        if isinstance(error, FAULTS):
            found = fault_at(error, *self._path)
            if found is not error:
                raise found from error


class FollowsError(Refused):
    """A part cannot be read because another part that it names has a fault. This is no further fault."""

    def __init__(self) -> None:
        super().__init__("what can be read")


class Gathered:
    """The faults of parts that are read one after another: each `part` is read, even if parts before it have faults,
    and `settle` raises all faults at once."""

    def __init__(self) -> None:
        self.faults: list[Refused | DocumentError] = []
        self._follows = False

    def add(self, error: Refused | InputError, *path: str | int) -> None:
        """A part is refused at `path`, or below it."""
        if isinstance(error, FollowsError):
            self._follows = True
        else:
            self.faults.append(fault_at(error, *path))

    def part(self, *path: str | int) -> _Part:
        """A part is read inside: what is refused is refused at `path`, or below it."""
        return _Part(self, path)

    def settle(self) -> None:
        """Raises the faults of all parts, if there are any."""
        if not self.faults and self._follows:
            raise FollowsError
        if not self.faults:
            return
        first, *rest = self.faults
        if isinstance(first, DocumentError) and all(isinstance(each, DocumentError) for each in rest):
            raise together(self.faults)  # type: ignore[arg-type]
        if isinstance(first, DocumentError):
            first = _Located(first)
        first.more = (*first.more, *rest)
        raise first


class _Part:
    """Inside, faults are added to those that are gathered."""

    def __init__(self, gathered: Gathered, path: Path) -> None:
        self._gathered, self._path = gathered, path

    def __enter__(self) -> None:
        pass

    def __exit__(self, kind: object, error: BaseException | None, trace: object) -> bool:
        if not isinstance(error, FAULTS):
            return False
        self._gathered.add(error, *self._path)
        return True


class _Located(Refused):
    """A fault whose field is known already, before others whose fields are not."""

    def __init__(self, error: DocumentError) -> None:
        super().__init__(error.allowed)
        self._error = error

    def one(self, document: object) -> DocumentError:  # noqa: ARG002 - its field is known without it
        return self._error


@contextmanager
def located(document: object) -> Iterator[None]:
    """A part that is refused inside becomes a fault of `document`."""
    try:
        yield
    except FAULTS as error:
        if isinstance(found := fault_at(error), Refused):
            raise found.fault(document) from error
        raise


def _follow(document: object, path: Path, field: str) -> Path:
    """`path`, and as much of the planner's own field name (`conveyor.changes[1].time`) as the document has below it."""
    _, here = as_written(document, path)
    tokens = field.replace("[", ".[").split(".")
    for token in tokens[1:] if path else tokens:
        if token.startswith("[") and token[1:-1].isdigit():
            index = int(token[1:-1])
            if not (isinstance(here, list) and index < len(here)):
                return path
            path, here = (*path, index), here[index]
        elif isinstance(here, dict):
            key = _key_for(here, token)
            if key is None:
                return (*path, token) if token in SILENT else path
            path, here = (*path, key), here[key]
        else:
            return path
    return path


def _key_for(mapping: dict[str, object], name: str) -> str | None:
    """The key of `mapping` that holds what the planner calls `name`: without its unit, or with one."""
    stem = {"time": "at", "start": "at"}.get(name, name)
    for key in mapping:
        unit = any_unit(key)
        bare = key if unit is None else key[: -len(unit) - 1]
        if bare in (name, stem):
            return key
    return None
