"""The verdict in words."""

from plasmapyro.diagnosis.select.held_out import SURE
from plasmapyro.quantities import behind
from plasmapyro.record.recommended import listed

LEAST = 0.5  # [K] below which a cost is not worth a sentence
NOTHING = "0 K"
AGREE, NOTHING_NEEDED = "The data agree with the base model", "nothing that the program knows of is needed"


def verdict_sentences(
    status, candidates, named, of_gas, p_value, unknown_name, gained, limits, unsure, held=(), apart=False
):
    """Sentences of a verdict; the first stands alone.

    `candidates`: id -> entry of the report; `named`, `of_gas`: ids that the thermometer asks for, and what
    the spectrum of the gas asks of the simulation; `unknown_name`: of the structure that remains; `limits`:
    entries of the report, worst first; `unsure`: why the base fit is not adequate, why names are not certain,
    or parameters far from their priors; `held`: light in the view that the base model holds besides;
    `apart`: a test of its own found what is unknown, of which `p_value` says nothing.
    """
    p = f"p < {10**-3}" if p_value < 1e-3 else f"p = {p_value:.2g}"
    names, gas = (
        listed([candidates[identity]["name"] for identity in ids]) if ids else "" for ids in (named, of_gas)
    )
    if status == "not-adequate":
        lines = ["The base model does not fit well enough to judge single causes."]
    elif named:
        beside = f"; the gas differs from the simulated one as if by: {gas}" if gas else ""
        lines = [f"The data reject the base model ({p}); the best explanation: {names}{beside}."]
    elif unknown_name:
        how, end = ("", ", by a test of its own") if apart else (f" ({p})", "")
        what = f"omething is wrong{how} that no single cause of the catalogue explains: {unknown_name}{end}."
        lines = [f"The gas differs from the simulated one as if by: {gas}; s{what}" if gas else f"S{what}"]
    else:
        lines = [f"{AGREE}: {NOTHING_NEEDED}."]
        if gas:
            lines = [f"Surface, path and instruments agree with the base model; the gas differs: {gas}."]
    if held and lines == [f"{AGREE}: {NOTHING_NEEDED}."]:
        lines = [f"{AGREE}, which holds {listed(held)} in the view: nothing else is needed."]
    elif held:
        lines[0] = f"{lines[0][:-1]}; the base model holds {listed(held)} in the view."
    if status != "not-adequate":
        lines += [candidates[identity]["sentence"] for identity in (*named, *of_gas)]
    if named and unknown_name:
        lines.append(f"Something else remains that the catalogue does not explain: {unknown_name}.")
    lines += unsure
    if gained is not None:
        word = "better" if gained.improves else "not significantly better"
        better = sum(change > 0 for *_, change in gained.blocks)
        sigmas = gained.total / max(gained.standard_error, 1e-9)
        lines.append(
            f"Data left out of the fit are foretold {word} with it: in {better} of {len(gained.blocks)}"
            f" blocks of time, on the whole by {sigmas:.1f} standard errors"
            f" ({SURE:.0f} are asked for)."
        )
    hidden = [row for row in limits if row["invisible"] and row["temperature_prior"] >= LEAST][:3]
    if hidden:
        rows = ", ".join(f"{row['name']} ({row['temperature_prior']:.0f} K)" for row in hidden)
        lines.append(f"What could still be wrong and would not be seen in these data: {rows}.")
    return lines


def candidate_sentence(entry):
    """One sentence about a candidate: how large, and what it costs."""
    size = f"{entry['amplitude']:.3g} ± {entry['standard_error']:.1g}{behind(entry['unit'])}"
    shift = entry["temperature_shift"]
    paper, fitted = (_kelvin(shift[name]) for name in ("paper", "base"))
    cost = "it changes no temperature by a tenth of a kelvin"
    if (paper, fitted) != (NOTHING, NOTHING):
        cost = (
            f"it shifts the corrected temperature of the paper by {paper} and the fitted one by {fitted} at"
            f" worst, {shift['at_time']:.0f} s after the injection"
        )
    name = entry["name"]
    return f"{name[0].upper()}{name[1:]}: {entry['amplitude_name']} {size}; left out, {cost}."


def _kelvin(value):
    """A shift [K] to a tenth, without a sign where nothing is left."""
    return f"{value:+.1f} K" if abs(value) >= 0.05 else NOTHING


def system_sentence(system):
    """One sentence about a radiating system whose light differs from the simulated one."""
    first, last = (round(1e9 * end) for end in system.wavelength)
    place = f" ({first} to {last} nm)" if last > first and "nm" not in system.name else ""
    return (
        f"{system.name}{place}: {system.ratio:.2f} ± {system.error:.1g} of the simulated light is measured,"
        f" the best power would make it {system.by_power:.2f}; {system.ratio / system.by_power - 1:+.0%}"
        f" remain, the simulation states {system.stated:.0%}."
    )
