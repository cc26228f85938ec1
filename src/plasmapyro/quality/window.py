"""Rules for the reference window: what is subtracted as gas must be gas, and steady."""

from plasmapyro.quality.rule import DOUBT, rule
from plasmapyro.record import onset


@rule(
    "surface_in_window",
    looks_at="growth of the light in the reference window as that of a heating surface",
    needs=("plasma",),
    limit=onset.SIGNIFICANT,
    unit="standard deviations",
    reason="passed by chance in 1 of 16 000 windows; and a thousandth of the mean, which is 1.4 K at 1600 K",
    says="reference window {begin:g} to {end:g} s: the surface already shows: it adds about {first:.2g} % to"
    " the mean of the {one}, {second:.2g} % to that of the {other}",
    remedy="{advice}",
)
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
        "advice": f"try --reference-window {low:g} {high:.3g}" if high else "let it begin or end earlier",
    }


@rule(
    "gas_drifts",
    looks_at="growth of the light in the reference window in ways that no surface has",
    needs=("plasma",),
    limit=onset.SIGNIFICANT,
    unit="standard deviations",
    reason="as above; what is subtracted later is then as wrong as the gas went on to drift",
    says="reference window {begin:g} to {end:g} s: the gas drifts in it beyond its noise",
    remedy="take a --gas-variation that covers the drift, or a steadier part of the test",
    severity=DOUBT,
)
def gas_drifts(case, limit):
    if case.window[0]["seen_reference_verdict"] != onset.DRIFTS:
        return None
    begin, end = (float(edge) for edge in case.test.attrs["reference_window"])
    return {"begin": begin, "end": end}
