"""The accidents that happen to files, for the fuzzers of all readers; and an end to inputs that hang."""

import signal
from contextlib import contextmanager

import pytest
from hypothesis import strategies as st

LONGEST = 20  # [s] of the processor for one input: far beyond the slowest, short of a hang
FLOOD = 30_000  # times that a piece is repeated: what takes quadratic time becomes a hang
FLOODS = [b" ", b"\r", b"\n", b"\t", b"1", b"1 ", b"a", b"[", b"(", b'"', b":", b",", b";", b"=", b"-", b"1*"]
POISON = [
    b"", b"\0", b"\xff\xfe", b"\xef\xbb\xbf", b"NaN", b"inf", b"1e999", b"-", b"1_0", b"1,2,3", b"\xb2", b'"',
    b"\n", b"\r", b";", b"\t", b",", b".", b"9" * 400, b">>>>>", b"[ms]", b"&a", b"*a", b"{", b": ",
    b"\xc2\xb5", b"400000000*1.0", b"-3", b"99999999999",
]  # fmt: skip


@st.composite
def damage(draw, content):
    """Bytes made from `content` by a few of the accidents that happen to files."""
    for _ in range(draw(st.integers(1, 3))):
        place = draw(st.integers(0, max(len(content) - 1, 0)))
        what = draw(
            st.sampled_from(
                ["cut", "insert", "replace", "remove", "repeat", "swap", "recode", "noise", "flood"]
            )
        )
        lines = content.splitlines(keepends=True)
        index = draw(st.integers(0, max(len(lines) - 1, 0)))
        if what == "cut":
            content = content[:place]
        elif what == "insert":
            content = content[:place] + draw(st.sampled_from(POISON)) + content[place:]
        elif what == "replace":
            content = content[:place] + draw(st.binary(min_size=1, max_size=4)) + content[place + 1 :]
        elif what == "remove":
            content = b"".join(lines[:index] + lines[index + 1 :])
        elif what == "repeat" and lines:
            content = b"".join([*lines[:index], lines[index], *lines[index:]])
        elif what == "swap" and len(lines) > 1:
            lines[index], lines[0] = lines[0], lines[index]
            content = b"".join(lines)
        elif what == "recode":
            target = draw(st.sampled_from(["utf-16", "utf-8-sig", "utf-32"]))
            content = content.decode("latin-1").encode(target)
        elif what == "flood":
            content = content[:place] + draw(st.sampled_from(FLOODS)) * FLOOD + content[place:]
        elif what == "noise":
            content = draw(st.binary(max_size=200))
    return content


class Hang(BaseException):
    """An input that takes too long; no command takes it for bad input, as it would a TimeoutError."""


@pytest.fixture(autouse=True)
def no_hang():
    """Ends the test if an input takes too long inside `bounded`; a busy machine does not count."""

    def late(*_):
        raise Hang(f"an input takes more than {LONGEST} s of the processor")

    before = signal.signal(signal.SIGPROF, late)
    yield
    signal.signal(signal.SIGPROF, before)


@contextmanager
def bounded():
    """One input: as long as `no_hang` allows."""
    signal.setitimer(signal.ITIMER_PROF, LONGEST)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
