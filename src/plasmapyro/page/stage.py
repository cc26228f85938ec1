"""From the files of a diagnosis to its page."""

from importlib.resources import files

from plasmapyro.page import figures, tables
from plasmapyro.page.words import for_figures, kelvin, probability, text

OPEN = "Chi-squared by phase"  # the one table of the last part that shows at once
FORMAT = "plasmapyro-diagnosis-1"
STATUS = {  # status: (words, colour of the verdict's edge)
    "null": ("nothing wrong was found", "fine"),
    "named": ("a cause is named", "finding"),
    "one-of": ("one of several causes", "finding"),
    "named+unknown": ("a cause is named, and something else may be wrong", "open"),
    "unknown": ("something is wrong that no known cause explains", "open"),
    "not-adequate": ("no judgement: the base model does not follow the data", "open"),
}


def write_page(diagnosis, residual_map, temperature):
    """The page of a diagnosis: one HTML text that needs nothing else, verdict first.

    Parameters
    ----------
    diagnosis : dict
        As in diagnosis.json, format 'plasmapyro-diagnosis-1'.
    residual_map : Dataset, contract 'residual_map'
        Variables of an absent instrument may be absent.
    temperature : Dataset, contract 'diagnosis_temperature'

    Returns
    -------
    str
        HTML with its style and its figures (SVG) inside. Text of the user is escaped, folders of the machine
        are cut off; the same inputs give the same text.

    Raises
    ------
    ValueError
        If the format is another.
    """
    found = diagnosis.get("schema")
    if found != FORMAT:
        raise ValueError(f"diagnosis: schema must be {FORMAT!r}; got {found!r}; diagnose again")
    style = files("plasmapyro.page").joinpath("style.css").read_text(encoding="utf-8")
    title = text(diagnosis["dataset"]["title"])
    parts = [
        _head(diagnosis),
        _verdict(diagnosis),
        _key_numbers(diagnosis),
        _section("What it costs in kelvin", _cost(diagnosis, temperature)),
        _section("What the data say", _evidence(diagnosis)),
        _section("Where simulation and data part", _show(diagnosis, residual_map)),
        _section("What the extended model is worth", _worth(diagnosis)),
        _section(
            "What could still be wrong and not be seen here",
            "<p>Errors of the paper's corrected temperature that this data set would not reveal,"
            " the most expensive first.</p>" + tables.limits(diagnosis),
        ),
        _section("How it was judged", _method(diagnosis, residual_map)),
    ]
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>Diagnosis: {title}</title>\n<style>\n{style}</style>\n</head>\n<body>\n"
        + "\n".join(part for part in parts if part)
        + f"\n<footer><p>Made by plasmapyro {text(diagnosis['provenance']['version'])}"
        " from the files named above. This page loads nothing from elsewhere.</p></footer>"
        "\n</main>\n</body>\n</html>\n"
    )


def _head(report):
    dataset = report["dataset"]
    words = (
        f"Compared with the simulation {text(dataset['condition'])};"
        f" {text(' and '.join(dataset['instruments']))}; data: {text(dataset['origin'])}."
    )
    mark = ""
    if dataset["origin"] == "synthetic":
        mark = '<p class="synthetic">SYNTHETIC DATA: no measurement, made to test the method</p>'
    return f'<header><h1>{text(dataset["title"])}</h1><p class="data">{words}</p>{mark}</header>\n<main>'


def _verdict(report):
    verdict = report["verdict"]
    words, colour = STATUS.get(verdict["status"], (verdict["status"], "open"))
    sentences = "".join(f"<p>{text(sentence)}</p>" for sentence in verdict["sentences"])
    return (
        f'<section class="verdict {colour}" aria-label="Verdict"><span class="status">{text(words)}</span>'
        f"{sentences}</section>"
    )


def _key_numbers(report):
    verdict, base = report["verdict"], report["base"]
    extended = report["extended"]
    best = max(verdict["probability"].items(), key=lambda pair: pair[1], default=None)
    boxes = []
    if best:
        boxes.append(
            (probability(best[1]), f"probability: {text(tables.names(report).get(best[0], best[0]))}")
        )
    boxes.append((kelvin(verdict["temperature_shift"]), "change of temperature by the named cause, at worst"))
    ratio = tables.ratio(base) + (f" → {tables.ratio(extended)}" if extended else "")
    boxes.append((ratio, "χ² per degree of freedom"))
    boxes.append((probability(verdict["p_base"]), "probability of such a misfit if nothing were wrong"))
    hidden = [row for row in report["limits"] if row["invisible"]]
    if hidden:
        worst = max(hidden, key=lambda row: abs(row["temperature_prior"]))
        size = kelvin(worst["temperature_prior"], signed=False)
        boxes.append((size, f"possible and invisible: {text(worst['name'])}"))
    return (
        '<div class="key">'
        + "".join(f"<div><b>{one}</b><span>{what}</span></div>" for one, what in boxes)
        + "</div>"
    )


def _section(title, content):
    return f"<section><h2>{text(title)}</h2>\n{content}</section>" if content else ""


def _figure(svg, title, caption, alternative):
    """A figure with a caption in HTML and an alternative text for those who do not see it."""
    labelled = svg.replace("<svg", f'<svg role="img" aria-label="{text(alternative)}"', 1)
    return f"<figure>{labelled}<figcaption><b>{text(title)}.</b> {text(caption)}</figcaption></figure>"


def _gallery(entries):
    return (
        '<div class="figures">' + "\n".join(entry for entry in entries if entry) + "</div>"
        if any(entries)
        else ""
    )


def _cost(report, temperature):
    plain = for_figures(report)
    rows = report["candidates"]
    extended = report["extended"] and report["extended"]["applied"]
    methods = "the paper's correction, the base model" + (" and the extended model" if extended else "")
    pictures = [
        _figure(
            figures.temperature(plain, temperature),
            "Surface temperature",
            f"By {methods}; bands: 95 % intervals; phases shaded.",
            "Surface temperature over time by three methods",
        ),
        _figure(
            figures.temperature_difference(plain, temperature),
            "The same as differences",
            "From the base model's temperature, so that kelvin can be read.",
            "Differences of the temperatures from that of the base model over time",
        ),
        _figure(
            figures.impact(plain),
            "Kelvin per cause",
            "What each cause would change at its fitted amplitude; named causes in bold.",
            "Bars: change of temperature by each candidate cause",
        )
        if rows
        else "",
    ]
    ranking = ""
    if rows:
        ranking = (
            "<p>Candidates, the most expensive first among those the data support. ★ marks what is named.</p>"
            + tables.candidates(report)
        )
    return _gallery(pictures) + ranking


def _evidence(report):
    plain = for_figures(report)
    pictures = [
        _figure(
            figures.evidence(plain),
            "Answers",
            "Probability of each answer, 'nothing' and 'something unknown' among them.",
            "Bars: probability of each answer on a logarithmic scale",
        )
        if report["verdict"]["probability"]
        else "",
        _figure(
            figures.profile(plain),
            "How well the amplitude is known",
            "Everything else fitted again at each amplitude; below the dotted line: 95 %.",
            "Profile of chi-squared against the amplitude of the named cause",
        )
        if report["show"]["profile"]
        else "",
    ]
    sets = [group for group in report["verdict"]["set"] if len(group) > 1]
    words = ""
    if sets:
        known = tables.names(report)
        items = "".join(f"<li>{text(', '.join(known.get(one, one) for one in group))}</li>" for group in sets)
        words = f"<p>These data cannot tell apart:</p><ul>{items}</ul>"
    missing = tables.ambiguity(report)
    if missing:
        words += "<p>Measurements that would decide:</p>" + missing
    return _gallery(pictures) + words


def _show(report, residual_map):
    plain = for_figures(report)
    show, pictures = report["show"], []
    has_spectra = residual_map is not None and "radiance_residual" in residual_map
    has_signals = residual_map is not None and "signal_residual" in residual_map
    if show["signals"]["time"] and has_signals:
        pictures.append(
            _figure(
                figures.signals(plain),
                "Signals",
                "Both bands as measured and as the base model gives them.",
                "Signals of both bands over time, measured and modelled",
            )
        )
        pictures.append(
            _figure(
                figures.signal_residuals(plain, residual_map),
                "What is left of the signals",
                "In standard deviations of the noise; a right model leaves noise between -2 and 2.",
                "Residuals of both bands over time",
            )
        )
    if has_spectra:
        after = "base and extended model on one scale" if report["extended"] else "base model"
        pictures.append(
            _figure(
                figures.residual_maps(plain, residual_map),
                "What is left of the spectra",
                f"Measured minus modelled radiance in standard deviations, {after}; white is right.",
                "Map of residuals over time and wavelength",
            )
        )
    if show["kappa"] and show["kappa"]["wavelength"]:
        pictures.append(
            _figure(
                figures.step(plain),
                "The step when the plasma ends",
                "Drop of the signal at shut-down over the gas signal in the reference window:"
                " 1 if the gas stayed the same.",
                "Step at plasma-off over the reference, by wavelength",
            )
        )
    if show["emittance_loop"] and show["emittance_loop"]["temperature"]:
        pictures.append(
            _figure(
                figures.emittance_loop(plain),
                "Apparent emittance",
                "Absolute level over that of a black body at the ratio temperature: flat if grey and"
                " constant, a loop if something changed for good.",
                "Apparent emittance against temperature, heating and cooling",
            )
        )
    if show["line_hump"]:
        closest = tables.names(report).get(show["line_hump"]["closest"], show["line_hump"]["closest"])
        pictures.append(
            _figure(
                figures.line_hump(plain),
                "Lines against smooth light of the gas",
                "Each track is one explanation of more or less light; closest over the whole spectrum, with"
                f" power and strengths free within their priors: {closest}.",
                "Line factor against hump factor with tracks of the explanations and the measured point",
            )
        )
    if show["gas_monitor"] and show["gas_monitor"]["time"]:
        pictures.append(
            _figure(
                figures.gas_monitor(plain),
                "The gas through the test",
                "Brightness of the O I line at 777 nm with the tunnel's own channels.",
                "Brightness of the gas over time with the tunnel's channels",
            )
        )
    return _gallery(pictures)


def _worth(report):
    if not report["gain"]:
        return ""
    extended, content = report["extended"], tables.gain(report)
    if extended:
        decision = (
            "The extended temperature is used" if extended["applied"] else "The base temperature is kept"
        )
        content = f"<p>{decision}: {text(extended['why'])}.</p>" + content
        content += (
            "<p>To keep these terms in the model, put this into the test's configuration:</p>"
            f"<pre>{text(extended['configuration'])}</pre>"
        )
    return content


def _method(report, residual_map):
    plain = for_figures(report)
    show, pictures = report["show"], []
    for index, entry in enumerate(show["components"][:2]):
        known = tables.names(report)
        like = ", ".join(
            f"{known.get(one['id'], one['id'])} ({one['cosine']:.2f})" for one in entry["resembles"][:3]
        )
        pictures.append(
            _figure(
                figures.component(entry, index),
                f"Leading pattern of the residuals, {entry['instrument']}",
                f"Singular value {entry['singular_value']:.3g};"
                f" noise alone would give {entry['expected']:.3g}."
                + (f" Resembles (cosine): {like}." if like else ""),
                "History and spectrum of the leading pattern of the residuals",
            )
        )
    if show["autocorrelation"] or show["quantiles"]:
        pictures.append(
            _figure(
                figures.whiteness(plain),
                "Is what is left noise?",
                "Autocorrelation (grey: what noise does) and quantiles against a normal law.",
                "Autocorrelation and quantiles of the residuals",
            )
        )
    if len(show["angles"]["ids"]) > 1:
        pictures.append(
            _figure(
                figures.angles(plain),
                "Which causes look alike here",
                "Angle between signatures after the base model is projected out;"
                " below 15 degrees they are one class.",
                "Matrix of angles between the candidates",
            )
        )
    why = report["base"]["why"]
    adequacy = (
        f"<p>The base model is not adequate: {text(why)}.</p>" if not report["base"]["adequate"] else ""
    )
    assumed = "".join(f"<li>{text(one)}</li>" for one in report["assumptions"])
    folded = (
        (OPEN, tables.phases(report) if report["base"]["by_phase"] else ""),
        ("Tests", tables.tests(report)),
        ("Parameters of the base model", tables.pulls(report)),
        ("Structures without a name", tables.unknown(report)),
        ("Noise", tables.noise(report)),
        ("What was assumed", f"<ul>{assumed}</ul>" if assumed else ""),
        ("Where it comes from", tables.provenance(report)),
    )
    return (
        adequacy
        + _gallery(pictures)
        + "".join(
            f"<details{' open' if title == OPEN else ''}><summary>{text(title)}</summary>{content}</details>"
            for title, content in folded
            if content
        )
    )
