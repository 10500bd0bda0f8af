"""JSON schemas of the files that people write, for editors that check while one types."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Final, Literal

if TYPE_CHECKING:
    from pydantic import BaseModel

SchemaKind = Literal["native", "sweep", "design"]
TITLES: Final[dict[SchemaKind, str]] = {
    "native": "vincula native file, version 1",
    "sweep": "vincula sweep file, version 1",
    "design": "vincula design file, version 1",
}
"""What there is a schema of."""


def json_schema(kind: SchemaKind = "native") -> dict[str, Any]:
    """The JSON schema of a kind of file, version 1 (draft 2020-12).

    Args:
        kind: `native`, `sweep` or `design`.
    """
    schema = _without_null(_model(kind).model_json_schema(by_alias=True))
    schema["title"] = TITLES[kind]
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def _model(kind: SchemaKind) -> type[BaseModel]:
    """What reads such a file, imported when it is asked for."""
    if kind == "sweep":
        from vincula.files.sweep_schema import SweepEntry

        return SweepEntry
    if kind == "design":
        from vincula.files.design_schema import DesignEntry

        return DesignEntry
    from vincula.files.schema import NativeFile

    return NativeFile


def _without_null(schema: Any) -> Any:
    """The schema without "or null": in Python None is an absent key, in a file a missing value."""
    if isinstance(schema, list):
        return [_without_null(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    kept = {k: _without_null(v) for k, v in schema.items() if k != "default" or v is not None}
    choices = kept.get("anyOf")
    if isinstance(choices, list) and {"type": "null"} in choices:
        choices = [choice for choice in choices if choice != {"type": "null"}]
        del kept["anyOf"]
        kept.update(choices[0] if len(choices) == 1 else {"anyOf": choices})
    return kept
