"""Ways to damage a file: what a disk, an editor, another program or an enemy makes of it."""

from __future__ import annotations

import re
from typing import NamedTuple

from hypothesis import strategies as st

TOKENS: tuple[bytes, ...] = (
    *(b"", b"\x00", b"\r", b"\n", b'"', b"'", b",", b";", b"=", b"#", b"\\", b" ", b"\t", b"."),
    *(b"nan", b"inf", b"-inf", b"1e999", b"1e308", b"-1", b"0", b"1", b"2.5", b"1e-320"),
    *(b"true", b"null", b"NaN", b"Infinity", b"all", b"None", b"[]", b"{}", b"[1]", b"-0.0"),
    *(b"9" * 400, b"9" * 5000, b"0x" + b"f" * 5000, b"1_0", b"0b1", b"1979-05-27", b"12:61"),
    *(b"[" * 3000, b'{"a":' * 3000, b"{a=" * 3000, b"a." * 3000, b"[a.b]\n", b"[[a]]\n"),
    *(b"\xff\xfe", b"\xef\xbb\xbf", b"\xc3", b"\x1b[2J", b"\xe2\x80\xae", "\U0001f600".encode()),
    *(b"x" * 3000, b"," * 3000, b"\n" * 3000, b"../../", b"/dev/zero", b"robot=1", b":"),
)
"""What is put in, or in the place of a number or word."""
_WORD = re.compile(rb"-?[0-9][0-9.eE+-]*|[A-Za-z_][A-Za-z_0-9]*")


class Edit(NamedTuple):
    """One change: of which kind, where (shares of the whole), and with what."""

    kind: str
    at: float
    size: float
    token: bytes


edits = st.lists(
    st.builds(
        Edit,
        kind=st.sampled_from(
            ("flip", "cut", "remove", "repeat", "insert", "word", "word", "number", "lines")
        ),
        at=st.floats(0.0, 1.0),
        size=st.floats(0.0, 1.0),
        token=st.sampled_from(TOKENS) | st.binary(max_size=12),
    ),
    min_size=1,
    max_size=3,
)
"""What is done to a file's bytes."""


def damaged(data: bytes, changes: list[Edit]) -> bytes:
    """A file's bytes with every change."""
    for change in changes:
        data = _edited(data, change)
    return data


def _edited(data: bytes, change: Edit) -> bytes:
    kind, at, size, token = change
    here = int(at * len(data))
    # most changes are small, some are not
    end = min(len(data), here + 1 + int(size**6 * len(data)))
    if kind == "flip" and here < len(data):
        return data[:here] + bytes([data[here] ^ (1 << int(size * 7.99))]) + data[here + 1 :]
    if kind == "cut":
        return data[:here]
    if kind == "remove":
        return data[:here] + data[end:]
    if kind == "repeat":
        return data[:here] + data[here:end] * (2 + int(size * 8)) + data[end:]
    if kind == "insert":
        return data[:here] + token + data[here:]
    if kind == "lines":
        lines = data.split(b"\n")
        first, second = int(at * (len(lines) - 1)), int(size * (len(lines) - 1))
        lines[first], lines[second] = lines[second], lines[first]
        return b"\n".join(lines)
    if kind in ("word", "number"):
        found = [m for m in _WORD.finditer(data) if kind == "word" or m[0][:1] in b"-0123456789"]
        if found:
            begin, stop = found[int(at * (len(found) - 1))].span()
            return data[:begin] + token + data[stop:]
    return data
