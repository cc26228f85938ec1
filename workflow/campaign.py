"""Make, diagnose and put together the synthetic campaign of config/campaign.yaml; read its last test with it.

    python workflow/campaign.py [--results results] [--seed 1] [--drawn 60]

needs the results of the main job; about two minutes. Tests, truths and diagnoses go to RESULTS/campaign_runs,
laws and prior to RESULTS/campaign, what was hidden beside what was found to RESULTS/campaign_runs/found.md.
The prior for the last test is that of the tests before it. Drawn campaigns (`twin.drawn`) see what these
diagnoses see, linearised.
"""

import argparse
import sys
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from powers import ladder
from twin import campaign as files
from twin import drawn, runs

from plasmapyro import io
from plasmapyro.campaign.hierarchy import Campaign
from plasmapyro.campaign.stage import campaign, law_of, temperature, tests_of
from plasmapyro.commands.campaign import plan_of, report_of, until, write
from plasmapyro.diagnosis import command

HOT = 1000.0  # [K]


def main():
    """Run the whole chain."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--results", type=Path, default=Path("results"))
    parser.add_argument("--plan", type=Path, default=Path("config/campaign.yaml"))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--drawn", type=int, default=60)
    options = parser.parse_args()
    plan, results = plan_of(options.plan), options.results
    inputs = command.load_inputs(results / "radiation", results / "instrument")
    gas = {power: io.read(path, "radiation") for power, path in ladder(results / "radiation").items()}
    truths = runs.truth(plan, options.seed)
    for place, (entry, true) in enumerate(zip(plan["tests"], truths, strict=True)):
        scene = runs.scene(entry, true)
        light = [(1.0, runs.gas(gas, true["power"]))]
        test, truth = files.record(scene, inputs.response, light, 100 * options.seed + place)
        folder = Path(entry["diagnosis"]).parent
        files.write(test, folder.parent / "test.nc")
        files.write(truth, folder.parent / "truth.nc")
        command.write_all(command.diagnose_test(folder.parent / "test.nc", inputs), folder)
        sys.stdout.write(f"{entry['name']} diagnosed\n")
    write(plan, results / "campaign")
    alone, lines = last_test(plan, inputs)
    lines = [*compared_laws(plan, truths), "", *lines, "", *drawn_campaigns(plan, alone, options.drawn)]
    Path(plan["tests"][0]["diagnosis"]).parents[2].joinpath("found.md").write_text("\n".join(lines) + "\n")
    sys.stdout.write("\n".join(lines) + "\n")


def found_in(plan):
    """What the campaign of a plan finds."""
    reports = {one["name"]: report_of(one["diagnosis"]) for one in plan["tests"]}
    return campaign(tests_of(plan, reports), 1e3 * plan["reference_power_kw"])


def compared_laws(plan, truths):
    """Table of the hidden law beside the one found."""
    found = found_in(plan)
    hidden = {
        "efficiency": np.log(runs.EFFICIENCY),
        "exponent": runs.EXPONENT,
        "fouling gain_pyrometer": runs.LOSS["pyrometer"],
        "fouling gain_spectrometer": runs.LOSS["spectrometer"],
        "ratio": truths[0]["instrument"]["ratio"],
        **{f"emittance of {name}": np.log(one) for name, one in truths[0]["instrument"]["emittance"].items()},
        **{
            f"power {one['name']}": np.log(true["power"])
            for one, true in zip(plan["tests"], truths, strict=True)
        },
    }
    yield f"does not belong: {', '.join(' '.join(pair) for pair in found.joint.odd) or 'none'}"
    yield ""
    yield "| number | hidden | found | off, standard deviations |"
    yield "|---|---|---|---|"
    for name, value in hidden.items():
        mean, sigma = found.joint.number(name)
        yield f"| {name} | {value:.4f} | {mean:.4f} ± {sigma:.4f} | {(mean - value) / sigma:+.1f} |"


def last_test(plan, inputs):
    """Posteriors of the last test {instruments: by the schema}, and a table of its errors [K], with and
    without its spectra, with and without the campaign."""
    last = plan["tests"][-1]
    folder = Path(last["diagnosis"]).parents[1]
    known = found_in(until(plan, last["name"])).next
    truth, whole = (io.read(folder / f"{name}.nc", name) for name in ("truth", "test"))
    found, lines = (
        {},
        [
            "| last test | error, K (rms) | stated, K | with the campaign: error, K | stated, K |",
            "|---|---|---|---|---|",
        ],
    )
    for name, test in (("both instruments", whole), ("pyrometer alone", runs.without_spectra(whole))):
        cells = []
        for law in (known, None):
            posterior = command.diagnose_test(test, inputs, known=law).report["posterior"]
            told = posterior["temperature"]
            true = np.interp(told["time"], truth.time, truth.surface_temperature)
            hot = true > HOT
            error = np.sqrt(np.mean((np.array(told["value"]) - true)[hot] ** 2))
            cells = [f"{error:.2f}", f"{np.mean(np.array(told['sigma'])[hot]):.2f}", *cells]
        found[name] = posterior
        lines.append(f"| {name} | {' | '.join(cells)} |")
    return found, lines


def drawn_campaigns(plan, alone, count):
    """Table of coverages and of errors [K] of the last of the tests, over drawn campaigns."""
    seen = [
        (
            1e3 * one["electric_power_kw"],
            one["material"],
            drawn.Seen(report_of(one["diagnosis"])["posterior"]),
        )
        for one in plan["tests"]
    ]
    yield (
        f"| {count} drawn campaigns, last test | 95 % intervals of laws hold | error alone, K (rms) |"
        " with the campaign, K | times less | interval of T holds | a sound test left out |"
    )
    yield "|---|---|---|---|---|---|---|"
    for name, posterior in alone.items():
        told = [drawn_campaign(seen, seed, drawn.Seen(posterior)) for seed in range(count)]
        inside, before, after, held, odd = (np.concatenate(part) for part in zip(*told, strict=True))
        rms = [np.sqrt(np.mean(np.square(part))) for part in (before, after)]
        yield (
            f"| {name} | {100 * inside.mean():.1f} % | {rms[0]:.2f} | {rms[1]:.2f} | {rms[0] / rms[1]:.2f} |"
            f" {100 * held.mean():.1f} % | {odd.sum():.0f} of {count} |"
        )


def drawn_campaign(seen, seed, last):
    """Of one drawn campaign: whether laws lie in their intervals, errors [K] of the last temperature where
    it is hot, alone and with the campaign, whether they lie in its interval, whether a test is left out."""
    truth, made = drawn.campaign(seen, seed, last=last)
    tests = tests_of(*drawn.plan_and_reports(made))
    whole = Campaign(tests, drawn.REFERENCE)
    joint = whole.joint(whole.odd_ones())
    test, true = tests[-2], truth.pop("temperature")
    value, sigma = temperature(test, law_of(joint, test.name, test.after.names))
    hot = true > HOT
    error = (value - true)[hot]
    law = np.array([joint.number(name) for name in truth])
    return (
        np.abs(law[:, 0] - list(truth.values())) < 1.96 * law[:, 1],
        (test.temperature["value"] - true)[hot],
        error,
        np.abs(error) < 1.96 * sigma[hot],
        [bool(joint.odd)],
    )


if __name__ == "__main__":
    main()
