"""Copy many Taichi fields to and from NumPy in one kernel, as compiling one kernel per field would delay the start."""

from collections.abc import Iterator
from math import prod

import numpy as np

from ocean_sim.kernel_library import ti, to_numpy_type
from ocean_sim.runtime import in_kernels

MAX_FIELDS_PER_KERNEL = 32  # fields of a kernel; Taichi warns of more
MAX_ROW_LENGTH = 2**31 - 1  # numbers in a row: kernels count them in 32 bits


@in_kernels
class FieldBundle:
    """Scalar fields of one type, copied together to and from a flat array by one kernel with a loop per field shape."""

    def __init__(self, fields: list[ti.ScalarField]) -> None:
        self.shapes = [field.shape for field in fields]
        sizes = [prod(shape) for shape in self.shapes]
        self.firsts = [sum(sizes[:k]) for k in range(len(sizes))]
        placed = list(zip(fields, self.firsts, strict=True))
        self.alike = tuple(tuple(p for p in placed if p[0].shape == shape) for shape in dict.fromkeys(self.shapes))
        self.row = np.zeros(sum(sizes), dtype=to_numpy_type(fields[0].dtype))

    def read(self) -> list[np.ndarray]:
        """Values of each field, in the order of the fields, as an array of the field's shape."""
        self.copy_to(self.row)
        ends = [*self.firsts[1:], len(self.row)]
        rows = [self.row[first:end].copy() for first, end in zip(self.firsts, ends, strict=True)]
        return [row.reshape(shape) for row, shape in zip(rows, self.shapes, strict=True)]

    def write(self, arrays: list[np.ndarray]) -> None:
        """Set each field from the array at the same position in the list."""
        self.copy_from(np.concatenate([array.ravel() for array in arrays]).astype(self.row.dtype))

    @ti.func
    def index_of(self, field: ti.template(), index):  # type: ignore[valid-type]
        """Flat index, last axis fastest, of the entry of a field at a vector of indices."""
        k = 0
        for axis in ti.static(range(len(field.shape))):
            k = k * field.shape[axis] + index[axis]
        return k

    @ti.kernel
    def copy_to(self, row: ti.types.ndarray(ndim=1)):  # type: ignore[valid-type]
        """Copy all fields of the bundle into `row`, one after the other."""
        for alike in ti.static(self.alike):
            for index in ti.grouped(alike[0][0]):
                k = self.index_of(alike[0][0], index)
                for field, first in ti.static(alike):
                    row[first + k] = field[index]

    @ti.kernel
    def copy_from(self, row: ti.types.ndarray(ndim=1)):  # type: ignore[valid-type]
        """Set all fields of the bundle from `row`, which holds their values one after the other."""
        for alike in ti.static(self.alike):
            for index in ti.grouped(alike[0][0]):
                k = self.index_of(alike[0][0], index)
                for field, first in ti.static(alike):
                    field[index] = row[first + k]


class FieldContents:
    """Reader and writer of Taichi fields by name; its kernels are compiled once for the same set of fields."""

    def __init__(self) -> None:
        self.known: list[ti.Field] = []
        self.bundles: list[tuple[list[str], FieldBundle]] = []

    def read(self, fields: dict[str, ti.Field]) -> dict[str, np.ndarray]:
        """Copy of each field as an array, by the name of the field."""
        self.bundle(fields)
        arrays = {name: field.to_numpy() for name, field in fields.items() if not isinstance(field, ti.ScalarField)}
        for names, bundle in self.bundles:
            arrays |= dict(zip(names, bundle.read(), strict=True))
        return arrays

    def write(self, fields: dict[str, ti.Field], arrays: dict[str, np.ndarray]) -> None:
        """Set each field to the array of the same name, shape and type."""
        self.bundle(fields)
        for name, field in fields.items():
            if not isinstance(field, ti.ScalarField):
                field.from_numpy(arrays[name])
        for names, bundle in self.bundles:
            bundle.write([arrays[name] for name in names])

    def bundle(self, fields: dict[str, ti.Field]) -> None:
        """Group the scalar fields by type into bundles, unless the last call had these same fields."""
        if len(fields) == len(self.known) and all(a is b for a, b in zip(fields.values(), self.known)):
            return
        self.known, self.bundles = list(fields.values()), []
        scalar = {name: field for name, field in fields.items() if isinstance(field, ti.ScalarField)}
        for kind in sorted({str(field.dtype) for field in scalar.values()}):
            sizes = {name: prod(field.shape) for name, field in scalar.items() if str(field.dtype) == kind}
            self.bundles += [(names, FieldBundle([scalar[name] for name in names])) for names in group_names(sizes)]


def group_names(sizes: dict[str, int]) -> Iterator[list[str]]:
    """Yield groups of field names, each small enough for one kernel and one array; `sizes`: lengths by name."""
    together: list[str] = []
    length = 0
    for name, size in sizes.items():
        if together and (len(together) == MAX_FIELDS_PER_KERNEL or length + size > MAX_ROW_LENGTH):
            yield together
            together, length = [], 0
        together.append(name)
        length += size
    if together:
        yield together


def array_shape(field: ti.Field) -> tuple[int, ...]:
    """Shape of the NumPy array that holds a field: the field's shape, then that of its vectors or matrices."""
    own = getattr(field, "n", None), getattr(field, "m", None)
    return (*field.shape, *(() if isinstance(field, ti.ScalarField) else own[: field.ndim]))
