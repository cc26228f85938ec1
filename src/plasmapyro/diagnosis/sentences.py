"""The verdict in words."""


def verdict_sentences(status, candidates, terms, p_value, unknown_name, gained, limits, unsure):
    """Sentences of a verdict; the first stands alone.

    Parameters
    ----------
    status : str
    candidates : mapping id -> entry of the report
    terms : list of ids
    p_value : float
    unknown_name : str or None
        Of the structure that remains.
    gained : Gain or None
    limits : list of entries of the report, worst first
    unsure : list of str
        Why the base fit is not adequate, why names are not certain, or parameters far from their priors.
    """
    p = f"p < {10**-3}" if p_value < 1e-3 else f"p = {p_value:.2g}"
    lines = []
    if status == "null":
        lines.append("The data agree with the base model: nothing that the program knows of is needed.")
    elif status == "not-adequate":
        lines.append("The base model does not fit well enough to judge single causes.")
    elif status == "unknown":
        lines.append(
            f"Something is wrong ({p}) that no single cause of the catalogue explains: {unknown_name}."
        )
    else:
        names = " and ".join(candidates[identity]["name"] for identity in terms)
        lines.append(f"The data reject the base model ({p}); the best explanation: {names}.")
        for identity in terms:
            lines.append(candidates[identity]["sentence"])
        if status == "named+unknown" and unknown_name:
            lines.append(f"Something else remains that the catalogue does not explain: {unknown_name}.")
    lines += unsure
    if gained is not None:
        word = "better" if gained.improves else "not significantly better"
        lines.append(
            f"Held-out data are predicted {word} with it: log score {gained.total:+.0f}"
            f" ± {gained.standard_error:.0f}."
        )
    hidden = [row for row in limits if row["invisible"]][:3]
    if hidden:
        named = ", ".join(f"{row['name']} ({abs(row['temperature_prior']):.0f} K)" for row in hidden)
        lines.append(f"What could still be wrong and would not be seen in these data: {named}.")
    return lines


def candidate_sentence(entry):
    """One sentence about a candidate: how large, and what it costs."""
    unit = "" if entry["unit"] == "1" else f" {entry['unit']}"
    size = f"{entry['amplitude']:.3g} ± {entry['standard_error']:.1g}{unit}"
    shift = entry["temperature_shift"]
    return (
        f"{entry['name'][0].upper()}{entry['name'][1:]}: {entry['amplitude_name']} {size};"
        f" left out, it shifts the corrected temperature of the paper by {shift['paper']:+.1f} K"
        f" and the fitted one by {shift['base']:+.1f} K where it is worst."
    )
