"""Rules for the reference window: what is subtracted as gas must be gas, and steady."""

from plasmapyro.quality.rule import rule
from plasmapyro.record import onset


@rule(limit=onset.SIGNIFICANT)
def surface_in_window(case, limit):
    found, names = case.window
    if found["seen_reference_verdict"] != onset.SHOWS:
        return None
    begin, end = case.test.attrs["reference_window"]
    first, second = (100 * float(share) for share in found["seen_reference_bias"])
    low, high = found.get("seen_proposed_window", (None, None))
    return {
        "begin": float(begin),
        "end": float(end),
        "first": first,
        "second": second,
        "one": names[0],
        "other": names[1],
        "advice": f"try --reference-window {low:g} {high:.3g}"
        if high and high < end
        else "let it begin or end earlier",
    }


@rule(limit=onset.SIGNIFICANT)
def gas_drifts(case, limit):
    if case.window[0]["seen_reference_verdict"] != onset.DRIFTS:
        return None
    begin, end = (float(edge) for edge in case.test.attrs["reference_window"])
    return {"begin": begin, "end": end}
