"""Ways to break a scene: what a hand that slips, a program that writes scenes, or ill will would do to one."""

import json
import string
from collections.abc import Callable
from typing import Any, NamedTuple

from hypothesis import strategies as st

from ocean_sim.reading.keys import named_so

HUGE = 10**400


class Broken(NamedTuple):
    """The bytes of a scene file, what was done to it, and the name that a good message suggests."""

    content: bytes
    how: str
    suggestion: str | None = None

    def __repr__(self) -> str:
        return f"Broken({self.how!r}, {len(self.content)} bytes)"


def yaml(scene: Any) -> str:
    """A scene as YAML, which all JSON is but for infinities."""
    text = json.dumps(scene, indent=1, ensure_ascii=False)
    return text.replace("NaN", ".nan").replace("-Infinity", "-.inf").replace("Infinity", ".inf")


def paths(data: Any, above: tuple[str | int, ...] = ()) -> list[tuple[str | int, ...]]:
    """Where everything stands."""
    inner = data.items() if isinstance(data, dict) else enumerate(data) if isinstance(data, list) else ()
    return [path for key, value in inner for path in ((*above, key), *paths(value, (*above, key)))]


def changed(data: Any, path: tuple[str | int, ...], change: Any) -> Any:
    """A copy in which `change(mapping or list, key)` was done at a place."""
    copy = json.loads(json.dumps(data))
    at = copy
    for step in path[:-1]:
        at = at[step]
    change(at, path[-1])
    return copy


garbage = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-3, 3),
    st.sampled_from([HUGE, -HUGE, 10**19, 0, -1, 2**31, 2**63]),
    st.sampled_from([float("nan"), float("inf"), float("-inf"), 1e308, -1e308, 5e-324, 1e-30, -0.0, 1e30]),
    st.floats(width=64),
    st.text(max_size=6),
    st.sampled_from(
        ["", " ", "null", "1,5", "1e", "../../etc/passwd", "yacht.stl", "x" * 300, "\u202e", "é", "0x", "~"]
    ),
    st.sampled_from([[], {}, [[]], [{}], {"kind": "x"}, {"file": "nowhere.csv"}, {"kind": []}, [1.0, 2.0], [None] * 3]),
)
paths_to_nowhere = st.sampled_from(
    ["", ".", "..", "/", "/dev/zero", "/dev/null", "/etc/passwd", "fifo", "folder", "nowhere.csv", "a\x00b.csv"]
    + ["../" * 40 + "etc/passwd", "x" * 5000, "~", "empty.csv", "words.csv", "short.csv", "latin.csv", "loop.csv"]
)
meshes_from_nowhere = st.sampled_from(
    ["/dev/zero", "fifo.stl", "folder.stl", "nowhere.stl", "empty.stl", "empty.obj", "empty.ply", "words.stl"]
    + [
        "words.ply",
        "hole.stl",
        "a\x00b.stl",
        "../" * 40 + "etc/x.stl",
        "noise.stl",
        "noise.obj",
        "noise.ply",
        "cut.stl",
    ]
)


@st.composite
def slips(draw: Any, scene: dict[str, Any]) -> Broken:
    """One value or key that is wrong."""
    places = paths(scene)
    path = draw(st.sampled_from(places))
    how = draw(st.sampled_from(["value", "value", "scaled", "typo", "extra", "removed", "doubled", "shortened"]))
    if how == "value":
        new = draw(garbage)
        return Broken(
            yaml(changed(scene, path, lambda at, key: at.__setitem__(key, new))).encode(), f"{path}: {new!r:.60}"
        )
    if how == "scaled":
        numbers = [p for p in places if isinstance(found(scene, p), float)] or [path]
        path = draw(st.sampled_from(numbers))
        old = found(scene, path)
        new = old * draw(st.sampled_from([-1.0, 0.0, 1e-9, 1e-3, 1e3, 1e9, 1e300])) if isinstance(old, float) else old
        return Broken(
            yaml(changed(scene, path, lambda at, key: at.__setitem__(key, new))).encode(), f"{path} = {new!r}"
        )
    if how in ("typo", "extra"):
        keys = [p for p in places if isinstance(p[-1], str) and p[-1] not in ("a", "bow", "gauge_2", "kind")]
        path = draw(st.sampled_from(keys))
        key = str(path[-1])
        slipped = how == "typo" and len(key) > 3
        wrong = mistyped(draw, key) if slipped else draw(st.text(string.printable, min_size=1))

        def rename(at: Any, key: Any) -> None:
            at[wrong] = at.pop(key)

        return Broken(
            yaml(changed(scene, path, rename)).encode(),
            f"{path} as {wrong!r}",
            key if slipped and wrong != key and not named_so(wrong) else None,  # `title` as `tile` is a key of seas
        )
    if how == "removed":
        return Broken(yaml(changed(scene, path, lambda at, key: at.__delitem__(key))).encode(), f"without {path}")
    if how == "doubled":
        key = json.dumps(str(path[0]), ensure_ascii=False)
        return Broken(yaml(scene).rstrip()[:-1].encode() + f",\n{key}: 1}}".encode(), f"{key} twice")
    text = yaml(scene)
    return Broken(text[: draw(st.integers(0, len(text)))].encode(), "cut short")


def found(data: Any, path: tuple[str | int, ...]) -> Any:
    for step in path:
        data = data[step]
    return data


def mistyped(draw: Any, word: str) -> str:
    """A word with two letters changed places, one left out, or one twice."""
    k = draw(st.integers(1, len(word) - 2))
    return draw(
        st.sampled_from(
            [word[:k] + word[k + 1 :], word[:k] + word[k] + word[k:], word[:k] + word[k + 1] + word[k] + word[k + 2 :]]
        )
    )


@st.composite
def spoilt(draw: Any, scene: dict[str, Any]) -> Broken:
    """A file that is no text of YAML, or one that asks too much of a reader."""
    text = yaml(scene)
    place = draw(st.integers(0, len(text)))
    bombs = "\n".join(f"a{k}: &a{k} [{', '.join([f'*a{k - 1}' if k else 'x'] * 10)}]" for k in range(12))
    ways: dict[str, Callable[[], bytes]] = {
        "UTF-16": lambda: text.encode("utf-16"),
        "UTF-32": lambda: text.encode("utf-32"),
        "byte order mark": lambda: b"\xef\xbb\xbf" + text.encode(),
        "latin-1": lambda: ("title: \xe9\n" + text).encode("latin-1", "replace"),
        "NUL": lambda: (text[:place] + "\0" + text[place:]).encode(),
        "control": lambda: (text[:place] + "\x1b" + text[place:]).encode(),
        "tab": lambda: text.replace(" ", "\t").encode(),
        "carriage returns": lambda: text.replace("\n", "\r\n").encode(),
        "empty": lambda: b"",
        "blank": lambda: b"\n \n# nothing\n",
        "bomb": lambda: bombs.encode(),
        "own alias": lambda: f"a: &x {{b: *x}}\nbasin: {text}".encode(),
        "deep lists": lambda: b"[" * 100_000,
        "deep mappings": lambda: b"{a: " * 20_000,
        "deep indents": lambda: "".join(f"{' ' * k}a:\n" for k in range(1500)).encode(),
        "long key": lambda: ("x" * 900_000 + ": 1\n").encode() + b"{}",
        "long value": lambda: ("title: " + "x" * 11_000_000).encode(),
        "many lines": lambda: b"a: 1\n" * 2_500_000,
        "huge integer": lambda: b"seed: " + b"9" * 100_000,
        "huge hexadecimal": lambda: b"seed: 0x" + b"f" * 100_000,
        "tag": lambda: b"basin: !!python/object/apply:os.system ['true']",
        "two documents": lambda: f"{text}\n---\n{text}".encode(),
        "flipped bit": lambda: flipped(text.encode(), draw(st.integers(0, 8 * len(text.encode()) - 1))),
        "inserted": lambda: (text[:place] + draw(st.text(max_size=3)) + text[place:]).encode("utf-8", "surrogatepass"),
    }
    how = draw(st.sampled_from(sorted(ways)))
    return Broken(ways[how](), how)


def flipped(content: bytes, bit: int) -> bytes:
    changed = bytearray(content)
    changed[bit // 8] ^= 1 << bit % 8
    return bytes(changed)


@st.composite
def misnamed(draw: Any, scene: dict[str, Any]) -> Broken:
    """A scene that names a file which is none, or not of that sort."""
    csv, mesh = draw(paths_to_nowhere), draw(meshes_from_nowhere)
    scene = json.loads(json.dumps(scene))
    ship = {"kind": "hydrostatic", "hull": {"shape": {"kind": "sphere", "radius": 0.2}, "mass": 10.0}}
    box = {"kind": "sphere", "centre": [0.0, 0.0, 0.0], "radius": 1.0}
    ways: dict[str, dict[str, Any]] = {
        "initial": {"fluid": {"kind": "mueller", "spacing": 0.3, "initial": {"kind": "file", "path": csv}}},
        "archive": {"fluid": {"kind": "mueller", "spacing": 0.3, "initial": {"kind": "file", "path": "noise.npz"}}},
        "tank": {"basin": scene["basin"] | {"motion": {"file": csv}}},
        "wind": {"wind": {"kind": "gusts", "volumes": [{"include": [box], "schedule": {"file": csv}}]}},
        "controls": {"ship": ship | {"controls": {"file": csv}}},
        "hull": {"ship": {"kind": "hydrostatic", "hull": mesh, "mass": 10.0}},
        "shape": {"ship": ship | {"hull": {"shape": {"kind": "mesh", "file": mesh}, "mass": 10.0}}},
        "pressure": {"ship": {"kind": "pressure", "hull": mesh, "mass": 10.0}},
    }
    how = draw(st.sampled_from(sorted(ways)))
    return Broken(yaml(scene | ways[how]).encode(), f"{how}: {csv!r:.60} {mesh!r:.60}")


@st.composite
def decayed(draw: Any, content: bytes) -> Broken:
    """A file that a disk, a cable or a hurried hand has spoilt: cut, bits turned, pieces lost, doubled, or noise."""
    place = draw(st.integers(0, len(content)))
    piece = draw(st.sampled_from([1, 4, 64, 512]))
    ways: dict[str, Callable[[], bytes]] = {
        "empty": lambda: b"",
        "cut": lambda: content[:place],
        "beheaded": lambda: content[place:],
        "zeros": lambda: content[:place] + bytes(len(content[place : place + piece])) + content[place + piece :],
        "a hole": lambda: content[:place] + content[place + piece :],
        "noise": lambda: content[:place] + draw(st.binary(min_size=1, max_size=piece)) + content[place:],
        "doubled": lambda: content[:place] + content[max(0, place - piece) :],
        "all noise": lambda: draw(st.binary(max_size=600)),
        "turned": lambda: turned(content, draw(st.lists(st.integers(0, 8 * len(content) - 1), min_size=1, max_size=4))),
    }
    how = draw(st.sampled_from(sorted(ways)))
    return Broken(ways[how](), f"{how} at {place}")


def turned(content: bytes, bits: list[int]) -> bytes:
    for bit in bits:
        content = flipped(content, bit)
    return content
