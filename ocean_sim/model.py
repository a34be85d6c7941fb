"""Frozen and strict models of all user input: numbers with units, no unknown keys."""

from collections.abc import Iterable
from typing import Annotated, Any, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

Key = tuple[str | int, ...]  # path below a part, or below a key of it
Fault = tuple[Key, str]  # a key and a sentence
Faults = Iterable[Fault]


class Model(BaseModel):
    """Base of all models of user input: frozen, strict about types, no unknown keys, no NaN and no infinity."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)

    def contradictions(self) -> Iterable[str]:
        """Sentences on keys of this model that do not go together; the first one refuses it."""
        return ()

    @model_validator(mode="after")
    def _without_contradiction(self) -> Self:
        for sentence in self.contradictions():
            raise ValueError(sentence)
        return self


def quantity(unit: str, default: Any = ..., **bounds: Any) -> Any:
    """Pydantic field with a unit, which messages and the schema show; bounds: pydantic's `gt`, `ge`, `lt`, `le`."""
    return Field(default, json_schema_extra={"unit": unit}, **bounds)


def in_brackets(unit: str | None) -> str:
    """Unit in brackets after a space, as in ` [m/s]`, to follow a quantity; empty without a unit, and for "1"."""
    return f" [{unit}]" if unit not in (None, "", "1") else ""


def below(*key: str | int, faults: Faults) -> Faults:
    """Prepend `key`, the path of a mapping, to the key path of each of its faults (key path, sentence)."""
    return (((*key, *path), sentence) for path, sentence in faults)


Name = Annotated[str, Field(pattern=r"^[A-Za-z][A-Za-z0-9_]*$")]
Point = Annotated[tuple[float, ...], Field(strict=False, min_length=2, max_length=3)]  # z may be left out in 2-D
Positive = Annotated[float, Field(gt=0.0)]
Positive3 = Annotated[tuple[Positive, Positive, Positive], Field(strict=False)]
NotNegative = Annotated[float, Field(ge=0.0)]
NotNegative3 = Annotated[tuple[NotNegative, NotNegative, NotNegative], Field(strict=False)]
Vector2 = Annotated[tuple[float, float], Field(strict=False)]
Vector3 = Annotated[tuple[float, float, float], Field(strict=False)]
