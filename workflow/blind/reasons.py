"""Why a bar is missed, as far as the cases tell: one sentence each."""

from collections import Counter

LISTED = 3  # culprits that a sentence names


def answer(one):
    """What a diagnosis said, in a word or two."""
    return "+".join(one["named"]) or {"null": "none"}.get(one["status"], one["status"])


def hidden(one):
    """What was hidden in a case."""
    return "+".join(effect["effect"] for effect in one["effects"]) or one["noise"] or "nothing"


def most(pairs):
    """Sentence about the most frequent of (hidden, answer) pairs; None without any."""
    pairs = list(pairs)
    if not pairs:
        return None
    parts = []
    for name, number in Counter(name for name, _ in pairs).most_common(LISTED):
        said = Counter(word for other, word in pairs if other == name).most_common(2)
        told = ", ".join(word if count == 1 else f"{word} {count} times" for word, count in said)
        parts.append(f"{name} {number} ({told})")
    rest = len({name for name, _ in pairs}) - LISTED
    more = f"; {rest} others" if rest > 0 else ""
    return f"{len(pairs)} cases, hidden (and said): " + "; ".join(parts) + more + "."


def misses(cases, good):
    """Sentence about the cases that are not good."""
    return most((hidden(one), answer(one)) for one in cases if not good(one))


def extras(cases):
    """Sentence about names that nothing was hidden for."""
    return most((name, f"with {hidden(one)}") for one in cases for name in one["extra"])


def hot(cases, limit):
    """Sentence about cases whose extended temperature keeps a bias beyond a limit [K]."""
    left = [one for one in cases if (one["temperature"]["extended"]["bias"] or 0) >= limit]
    if not left:
        return f"No case keeps a bias of {limit:g} K or more."
    return f"{len(left)} of {len(cases)} keep a bias of {limit:g} K or more. " + (
        most((hidden(one), answer(one)) for one in left) or ""
    )


def uncovered(cases):
    """Sentence about cases whose interval holds the truth less than half of the time."""
    held = [one["temperature"]["extended"]["coverage"] for one in cases]
    return most(
        (hidden(one), answer(one))
        for one, share in zip(cases, held, strict=True)
        if share is not None and share < 0.5  # None of a sample that never gets hot
    )
