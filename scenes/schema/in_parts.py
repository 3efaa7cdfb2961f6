"""A document read part by part: what has a fault is set aside, and all other parts are read. So the faults of names
and places are found beside those of form."""

from __future__ import annotations

from typing import Any, get_args, get_origin

from pydantic import BaseModel, TypeAdapter, ValidationError

from assur.planner.errors import InputError
from assur.scenes.faults import Unreadable
from assur.scenes.schema.model import Document
from assur.scenes.schema.normal import normal
from assur.scenes.schema.read import adapter, options_of, read_fields
from assur.scenes.schema.request import OptionsDocument


class Unread(Unreadable):
    """In place of a part of a document that has a fault, or that is made of one. What names it has no fault of its
    own."""

    def get(self, *path: str) -> object:
        """What is written at these keys; None where nothing is."""
        here = self.written
        for key in path:
            here = here.get(key) if isinstance(here, dict) else None
        return here

    def part(self, model: type[Document], *path: str) -> Any:
        """The same where `model` reads it, else None."""
        found = self.get(*path)
        read = Unread() if found is None else _part(adapter(model), found, found, as_written=False)
        return None if isinstance(read, Unread) else read

    def items(self, *path: str) -> list[object]:
        """The same where it is a list, else nothing."""
        found = self.get(*path)
        return found if isinstance(found, list) else []

    def text(self, *path: str) -> str:
        """The same where it is text, else nothing."""
        found = self.get(*path)
        return found if isinstance(found, str) else ""


def in_parts(model: type[BaseModel], document: dict[str, Any], *, as_written: bool = False) -> dict[str, Any] | None:
    """The fields of a document by their names, as `model` reads them, or `as_written`: every entry of a list and of a
    mapping of names alone, and every other field as a whole. `Unread` is in place of what has a fault. None where a
    list or a mapping of names is something else: then nothing more is read.
    """
    found: dict[str, Any] = {}
    for name, field in model.model_fields.items():
        key, of = field.alias or name, options_of(field.rebuild_annotation())[0]
        if key not in document:
            if field.is_required():
                found[name] = [] if get_origin(of) is list else Unread()
            elif not as_written:
                found[name] = field.get_default(call_default_factory=True)
            continue
        value = document[key]
        if get_origin(of) not in (list, dict) or get_args(of)[-1] is Any:
            found[name] = _part(adapter(of), value, value, as_written=as_written)
            continue
        if type(value) is not get_origin(of):
            return None
        if isinstance(value, list):
            found[name] = [_part(adapter(of), [each], each, as_written=as_written) for each in value]
        else:
            found[name] = {
                str(part): _part(adapter(of), {part: each}, each, as_written=as_written) for part, each in value.items()
            }
    return found


def _part(by: TypeAdapter[Any], document: object, written: object, *, as_written: bool) -> Any:
    """What is read of `written`, which is the only entry of `document` or the same."""
    try:
        found = by.validate_python(normal(document))
    except (ValidationError, InputError):  # a fault of form, which is reported of the whole document
        return Unread(written)
    if as_written:
        return written
    if document is written:
        return found
    return found[0] if isinstance(found, list) else next(iter(found.values()))


def right_options(document: object) -> OptionsDocument:
    """Those of the options of a request that have no fault."""
    right: dict[str, Any] = {}
    for key, value in document.items() if isinstance(document, dict) else ():
        try:
            right |= read_fields(OptionsDocument, {str(key): value})
        except InputError:  # as above
            continue
    return OptionsDocument.model_construct(**right)
