"""Whether what a diagnosis says of a test agrees with itself."""

ANSWERS = {"null": "none", "unknown": "unknown"}
OPENINGS = {  # how the first sentence begins: of names of the thermometer, of the gas alone, of none, of both
    "thermometer": "The data reject the base model",
    "gas": "Surface, path and instruments agree",
    "null": "The data agree with the base model",
    "unknown": "Something is wrong",
    "gas and unknown": "The gas differs from the simulated one as if by",
    "not-adequate": "The base model does not fit",
}
UNKNOWN = ("unknown", "named+unknown")
SURE = 3.0  # standard errors of held-out gain


def contradictions(report):
    """Sentences about what parts of a diagnosis.json, such as status and names, say against each other."""
    verdict, extended = report["verdict"], report["extended"]
    status, named, probability = verdict["status"], verdict["named"], verdict["probability"]
    terms = [term["id"] for term in extended["terms"]] if extended else []
    first = max(probability, key=probability.get) if probability else None
    checks = {
        f"{status} with the names {named}": (status in ("named", "one-of", "named+unknown")) == bool(named),
        f"{status}, and {first} is likeliest": first
        == (None if status == "not-adequate" else ANSWERS.get(status, named[0] if named else None)),
        f"{terms} in the model, {named} in the verdict": status == "not-adequate" or set(terms) <= set(named),
        "sets of other causes than those named": [group[0] for group in verdict["set"]] == named,
        "a name without an entry": set(named) <= {row["id"] for row in report["candidates"]},
        "something unknown without an axis": status not in UNKNOWN or verdict["unknown"] is not None,
        "an axis of nothing": status in (*UNKNOWN, "not-adequate") or verdict["unknown"] is None,
        f"{status} of {report['discrepancy']['class']}": status not in ("null", "named", "one-of")
        or report["discrepancy"]["class"] is None,
        f"not-adequate, and adequate {report['base']['adequate']}": (status == "not-adequate")
        != report["base"]["adequate"],
        f"{status} {named}: {verdict['sentences'][0]}": verdict["sentences"][0].startswith(
            OPENINGS[_opening(status, terms)]
        ),
    }
    checks |= _of_extension(report, first, terms)
    for row in report["candidates"]:
        other = abs(row["probability"] - probability.get(row["id"], 0.0))
        checks[f"{row['id']}: two probabilities"] = other < 1e-9
    return [sentence for sentence, holds in checks.items() if not holds]


def _opening(status, terms):
    if status in OPENINGS:
        return status
    if terms:
        return "thermometer"
    return "gas and unknown" if status == "named+unknown" else "gas"


def _of_extension(report, first, terms):
    """What an extension that is applied asks for."""
    extended, gain = report["extended"], report["gain"]
    if not (extended and extended["applied"]):
        return {}
    enough = gain["heldout_log_score"] > SURE * gain["heldout_standard_error"]
    return {
        f"applied, and {first} is likeliest": first in terms,
        "applied without three standard errors of held-out gain": enough,
        "applied, and held-out data are said not to be better": any(
            "are foretold better with it" in sentence for sentence in report["verdict"]["sentences"]
        ),
    }
