"""Frozen and strict models of all user input: numbers with units, no unknown keys."""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field


class Model(BaseModel):
    """Base of all models of user input: frozen, strict about types, no unknown keys, no NaN and no infinity."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


def quantity(unit: str, default: Any = ..., **bounds: Any) -> Any:
    """Pydantic field with a unit, which messages and the schema show; bounds: pydantic's `gt`, `ge`, `lt`, `le`."""
    return Field(default, json_schema_extra={"unit": unit}, **bounds)


def in_brackets(unit: str | None) -> str:
    """Unit in brackets after a space, as in ` [m/s]`, to follow a quantity; empty without a unit, and for "1"."""
    return f" [{unit}]" if unit not in (None, "", "1") else ""


Vector2 = Annotated[tuple[float, float], Field(strict=False)]
Vector3 = Annotated[tuple[float, float, float], Field(strict=False)]
