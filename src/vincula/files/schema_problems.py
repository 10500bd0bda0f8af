"""From pydantic's findings to problems with file, line, column, path and a suggestion."""

from __future__ import annotations

import types
import typing
from collections.abc import Iterator
from typing import Any, Final, TypeVar

from pydantic import BaseModel, Tag, ValidationError
from pydantic_core import ErrorDetails

from vincula.files.problems import form_of, shown
from vincula.files.schema_values import Context, PlacedVector
from vincula.files.tree import Document, Items, Leaf, Node, Table

Model = TypeVar("Model", bound=BaseModel)


def validated(document: Document, model: type[Model], context: Context) -> Model | None:
    """The document as a model; None, with the problems added to the document, when it does not fit.

    Args:
        document: The parsed file.
        model: The schema of its root.
        context: Parameters and dimensions.
    """
    for location in _empty_values(document.root, ()):
        comma = str(location[-1]).isdecimal() and isinstance(location[-1], str)
        expected = "a decimal point instead of the comma before it" if comma else "a value, or no key at all"
        document.problems.add(document.place(location), got="nothing", expected=expected)
    try:
        return model.model_validate(document.plain(), context=context)
    except ValidationError as error:
        for detail in error.errors(include_url=False):
            _add(document, model, detail)
    return None


def _empty_values(node: Node, location: tuple[str | int, ...]) -> Iterator[tuple[str | int, ...]]:
    """Locations of keys and list items without a value; `bodies: {name: }` needs none."""
    children: list[tuple[str | int, Node]] = []
    if isinstance(node, Table):
        children = list(node.entries.items())
    elif isinstance(node, Items):
        children = list(enumerate(node.items))
    for step, child in children:
        here = (*location, step)
        if isinstance(child, Leaf):
            if child.value is None and location != ("bodies",):
                yield here
        else:
            yield from _empty_values(child, here)


def _add(document: Document, model: type[BaseModel], detail: ErrorDetails) -> None:
    location, in_key = location_of(document, detail)
    kind, context, given = detail["type"], detail.get("ctx", {}), detail["input"]
    if isinstance(document.node(location), Leaf) and given is None:
        return  # reported as an empty value
    place = document.place(location, at_key=in_key or kind == "extra_forbidden")
    add = document.problems.add
    if kind == "vincula":
        add(place, got=context["got"], expected=context["expected"])
    elif kind == "extra_forbidden":
        key = str(detail["loc"][-1])
        add(place, f"unknown key {shown(key)}", name=key, choices=_keys(model, detail["loc"][:-1]))
    elif kind == "missing":
        around = document.place(location[:-1]) if location and document.node(location) is None else place
        add(around, f"the key {shown(str(detail['loc'][-1]))} is missing")
    elif kind == "union_tag_not_found":
        add(place, f"the key {context['discriminator']} is missing")
    elif kind == "union_tag_invalid":
        choices = [text.strip("'") for text in context["expected_tags"].split(", ")]
        inner = document.place((*location, str(context["discriminator"]).strip("'")))
        tag = str(context["tag"])
        add(inner, got=shown(tag), expected="a known type", name=tag, choices=choices)
    elif kind == "literal_error":
        choices = [text.strip("'") for text in context["expected"].replace(" or ", ", ").split(", ")]
        word = given if isinstance(given, str) else ""
        add(place, got=shown(given), expected="a known word" if word else context["expected"], name=word,
            choices=choices if word else ())  # fmt: skip
    else:
        add(place, got=form_of(given), expected=_expected(kind, context, detail["loc"]))


_EXPECTED: Final = {
    "list_type": "a list",
    "dict_type": "a table of names with values",
    "model_type": "a table",
    "model_attributes_type": "a table",
    "string_type": "a text; put it in quotes if it looks like a number",
    "bool_type": "true or false",
}


def _expected(kind: str, context: dict[str, Any], location: tuple[str | int, ...]) -> str:
    if kind == "list_type" and location and location[-1] == "list":
        return "coordinates [x, y, z] or {in: BODY, xyz: [x, y, z]}"
    if kind == "too_short":
        return f"at least {_entries(context['min_length'])}"
    if kind == "too_long":
        return f"at most {_entries(context['max_length'])}"
    return _EXPECTED.get(kind, kind.replace("_", " "))


def _entries(count: int) -> str:
    return "one entry" if count == 1 else f"{count} entries"


def location_of(document: Document, detail: ErrorDetails) -> tuple[tuple[str | int, ...], bool]:
    """Keys and indices of one of pydantic's errors, and whether it is about the key itself.

    Pydantic's own words for members of unions and for keys are left out.
    """
    steps: tuple[str | int, ...] = detail["loc"]
    in_key = bool(steps) and steps[-1] == "[key]"
    node: Node | None = document.root
    result: list[str | int] = []
    for index, step in enumerate(steps[:-1] if in_key else steps):
        if isinstance(node, Table) and step in node.entries:
            node = node.entries[str(step)]
        elif isinstance(node, Items) and isinstance(step, int) and step < len(node.items):
            node = node.items[step]
        elif not (detail["type"] == "missing" and index == len(steps) - 1):
            continue
        result.append(step)
    return tuple(result), in_key


def _keys(model: Any, location: tuple[str | int, ...]) -> list[str]:
    """The keys that the table at a location may have."""
    found = model
    for step in location:
        found = _step(found, step)
    for kind in _members(found):
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            return [field.alias or name for name, field in kind.model_fields.items()]
    return []


def _step(annotation: Any, step: str | int) -> Any:
    """The annotation one step further down: a field, a list item, a table value, a union member."""
    for kind in _members(annotation):
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            for name, info in kind.model_fields.items():
                if step in (name, info.alias):
                    hints = typing.get_type_hints(kind, include_extras=True)
                    return hints[name]
            if "type" in kind.model_fields and step in typing.get_args(kind.model_fields["type"].annotation):
                return kind
        origin, arguments = typing.get_origin(kind), typing.get_args(kind)
        if (origin is list and isinstance(step, int)) or origin is dict:
            return arguments[-1]
        if step in [extra.tag for extra in getattr(kind, "__metadata__", ()) if isinstance(extra, Tag)]:
            return kind
    return PlacedVector if step == "table" else None


def _members(annotation: Any) -> Iterator[Any]:
    """An annotation and, of unions and annotated types, what they are made of."""
    yield annotation
    origin = typing.get_origin(annotation)
    if origin is typing.Annotated:
        yield from _members(typing.get_args(annotation)[0])
    elif origin in (typing.Union, types.UnionType):
        for member in typing.get_args(annotation):
            yield from _members(member)
