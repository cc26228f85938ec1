"""Blind tests of the diagnosis: draw cases, hide effects, diagnose without the truth, score.

    python workflow/blind/run.py --seed WORD --null 400 --single 1000 --out results/blind
    python workflow/blind/run.py --out results/blind --board-only

Finished cases are kept: the same command goes on where it was stopped. Needs the results of the main job.
"""

import argparse
import contextlib
import json
import os
import selectors
import shutil
import subprocess
import sys
import time
from collections import defaultdict
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import xarray as xr
from twin import campaign

from blind import bench, board, page, second
from blind.draw import KINDS, LABORATORIES, SECOND_KINDS, SNR_LADDER, WORLDS, draw, number
from blind.make import BeyondRange, make
from blind.score import score

TIME_LIMIT = 900.0  # [s] per case


class Analyser:
    """The other process; restarted after a case that takes too long."""

    def __init__(self, log):
        self.log, self.process = Path(log), None

    def ask(self, order, limit=TIME_LIMIT):
        """The answer to one order; a dict with ok False if the process dies or the time is over."""
        if self.process is None:
            with self.log.open("a") as log:
                self.process = subprocess.Popen(
                    [sys.executable, str(Path(__file__).with_name("worker.py"))],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    stderr=log,
                    text=True,
                )
        try:
            self.process.stdin.write(json.dumps(order) + "\n")
            self.process.stdin.flush()
            with selectors.DefaultSelector() as selector:
                selector.register(self.process.stdout, selectors.EVENT_READ)
                line = self.process.stdout.readline() if selector.select(limit) else ""
        except BrokenPipeError:
            line = ""
        if line:
            return json.loads(line)
        self.close()
        return {"ok": False, "fault": f"no answer within {limit:g} s, or the process died"}

    def close(self):
        """End the process."""
        if self.process is not None:
            self.process.kill()
            self.process.stdout.close()
            with contextlib.suppress(BrokenPipeError):
                self.process.stdin.close()
            self.process.wait()
            self.process = None


def laboratories(out, results, workbench, seed, analyser, world="first"):
    """Folders with the calibration files of each laboratory of a world."""
    folders = []
    for index in range(LABORATORIES):
        name = str(index) if world == "first" else f"{world}-{index}"
        folder = out / "laboratories" / name
        if not folder.is_dir():
            part = folder.with_name(f"{name}-{os.getpid()}")  # other shares may be at it
            if world == "first":
                own = number(seed, "laboratory", index) % 2**32
                points = campaign.calibration_points(workbench.response, own)
                campaign.write(points, part / "calibration_points.nc")
                counts = campaign.spectrometer_counts(own, spectrometer=bench.spectrometer())
                campaign.write(counts, part / "spectrometer_counts.nc")
                shutil.copy(Path(results) / "instrument/response.nc", part / "response.nc")
            else:
                second.calibration_files(workbench.laboratories[index], results, part)
            _asked(analyser, {"do": "prepare", "laboratory": str(part.resolve())})
            _handed_over(part, folder)
        folders.append(folder)
    return folders


def spectra(made, workbench, out, results, analyser):
    """Folder of the spectra with which a case of the second laboratory is compared, and what they are.

    Those that are not there yet are made, see `second.simulations`.
    """
    kind = second.simulations(workbench)[made.base.world]
    folder = out / "simulations" / f"{made.base.pressure:.0f}Pa"
    if kind != "own":
        return Path(results) / "radiation", kind
    if not folder.is_dir():
        part = folder.with_name(f"{folder.name}-{os.getpid()}")  # other shares may be at it
        order = {"results": str(Path(results).resolve()), "folder": str(part.resolve())}
        _asked(analyser, order | {"do": "simulate", "pressure": made.base.pressure})
        _handed_over(part, folder)
    return folder / "radiation", kind


def _asked(analyser, order):
    answer = analyser.ask(order)
    if not answer["ok"]:
        raise RuntimeError(f"{order['do']}: {answer['fault']}\n{answer.get('trace', '')}")


def _handed_over(part, folder):
    with contextlib.suppress(OSError):  # another share was faster
        part.rename(folder)
    shutil.rmtree(part, ignore_errors=True)


def run_case(case, workbench, folders, out, results, analyser):
    """Make, diagnose and score one case; the truth stays here until the diagnosis is written."""
    record = {"case": case.name, "kind": case.kind, "noise": case.noise, "drawn": case.as_dict()}
    record["world"] = case.world
    try:
        made = (make if case.world == "first" else second.make)(case, workbench)
    except BeyondRange as reason:
        return record | {"outcome": "beyond range", "reason": str(reason)}
    record["effects"] = list(made.effects)
    radiance = Path(results) / "radiation"
    if case.world != "first":
        radiance, record["simulation"] = spectra(made, workbench, out, results, analyser)
    folder = out / "cases" / case.name
    shutil.rmtree(folder, ignore_errors=True)
    (campaign.write if case.world == "first" else second.write)(made.test, folder / "data" / "test.nc")
    order = {
        "do": "diagnose",
        "data": str((folder / "data").resolve()),
        "out": str((folder / "out").resolve()),
        "radiance": str(radiance.resolve()),
        "laboratory": str(folders[made.base.laboratory].resolve()),
        "without": list(case.without),
        "sabotage": case.sabotage,
    }
    answer = analyser.ask(order)
    (folder / "truth.json").write_text(json.dumps(made.truth(), indent=1), encoding="utf-8")
    if not answer["ok"]:
        return record | {"outcome": "failed", "reason": answer["fault"], "trace": answer.get("trace")}
    report = json.loads((folder / "out/diagnosis.json").read_text(encoding="utf-8"))
    with xr.open_dataset(folder / "out/temperature.nc") as temperature:
        scored = score(made, report, temperature.load(), made.angle)
    (folder / "data/test.nc").unlink(missing_ok=True)  # 0.6 MB; made again from the seed
    cost = {name: answer[name] for name in ("wall", "processor")}
    return record | {"outcome": "scored", "score": scored, "cost": cost}


def mixed(cases):
    """The cases in an order in which every beginning holds all kinds in proportion."""
    groups = defaultdict(list)
    for case in cases:
        groups[case.world, case.kind].append(case)
    placed = [
        ((index + 0.5) / len(group), case.name, case)
        for group in groups.values()
        for index, case in enumerate(group)
    ]
    return [case for _, _, case in sorted(placed, key=lambda one: one[:2])]


def finished(out):
    """Records of the cases done so far."""
    files = sorted((Path(out) / "records").glob("*.json"))
    return [json.loads(path.read_text(encoding="utf-8")) for path in files]


def publish(out, heading, notes, targets):
    """Write the scoreboard next to the records, and to the targets (paths without suffix)."""
    summary = board.summary(finished(out))
    for target in (Path(out) / "scoreboard", *map(Path, targets)):
        target.parent.mkdir(parents=True, exist_ok=True)
        target.with_suffix(".json").write_text(page.data(summary), encoding="utf-8")
        target.with_suffix(".md").write_text(page.text(summary, heading, notes), encoding="utf-8")
        page.figure(summary, target.with_suffix(".png"))
    return summary


def parser():
    """The argument parser."""
    top = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    top.add_argument("--seed", default="blind", help="any word: a commit, a date (default: %(default)s)")
    top.add_argument("--results", default="results", help="folder of the main job (default: %(default)s)")
    top.add_argument(
        "--out", default="results/blind", help="where cases and records go (default: %(default)s)"
    )
    for kind in KINDS:
        top.add_argument(
            f"--{kind}", type=int, default=0, metavar="N", help=f"number of cases of kind '{kind}'"
        )
    top.add_argument(
        "--world", choices=[*WORLDS, "both"], default="first", help="whose laboratory (default: %(default)s)"
    )
    top.add_argument("--ladder", type=float, nargs="+", default=SNR_LADDER, metavar="SNR", help="rungs")
    top.add_argument("--share", default="1/1", metavar="I/N", help="run only every N-th case, from the I-th")
    top.add_argument("--minutes", type=float, default=1e9, help="start no case after so many minutes")
    top.add_argument("--heading", default="", help="first sentence of the scoreboard")
    top.add_argument(
        "--note", action="append", default=[], help="a paragraph of the scoreboard; may be repeated"
    )
    top.add_argument(
        "--publish", nargs="*", default=[], help="also write the scoreboard to these paths, without suffix"
    )
    top.add_argument("--board-only", action="store_true", help="only summarise finished cases")
    return top


def main(arguments=None):
    """Run what is asked for."""
    options = parser().parse_args(arguments)
    out = Path(options.out)
    begin = time.monotonic()
    if not options.board_only:
        first, step = (int(word) for word in options.share.split("/"))
        cases = mixed(_drawn(options))
        waiting = [
            case for case in cases[first - 1 :: step] if not (out / "records" / f"{case.name}.json").is_file()
        ]
        analyser = Analyser(_log(out))
        try:
            ready = {}
            for case in waiting:
                if time.monotonic() - begin > 60 * options.minutes:
                    break
                if case.world not in ready:
                    ready[case.world] = _ready(options, out, analyser, case.world)
                record = run_case(case, *ready[case.world], out, options.results, analyser)
                _store(out, record)
        finally:
            analyser.close()
    summary = publish(out, options.heading or f"Seed `{options.seed}`.", options.note, options.publish)
    for row in summary["bars"]:
        sys.stdout.write(f"{row['bar']}: {row['value']} ({row['rule']}) {row['held']}\n")


def _drawn(options):
    """Cases of one world or of both, each kind that a world has."""
    counts = {kind: getattr(options, kind) for kind in KINDS}
    cases = []
    if options.world != "second":
        cases += draw(options.seed, counts, tuple(options.ladder))
    if options.world != "first":
        own = {kind: counts[kind] for kind in SECOND_KINDS}
        cases += draw(options.seed, own, tuple(options.ladder), "second")
    return cases


def _ready(options, out, analyser, world):
    """Bench and folders of the laboratories of a world."""
    if world == "first":
        workbench = bench.load(options.results, out / "spectra.npz")
    else:
        workbench = second.bench(options.results, options.seed)
    return workbench, laboratories(out, options.results, workbench, options.seed, analyser, world)


def _log(out):
    (out / "records").mkdir(parents=True, exist_ok=True)
    return out / "analyser.log"


def _store(out, record):
    path = out / "records" / f"{record['case']}.json"
    part = path.with_suffix(".part")
    part.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    part.replace(path)
    line = record.get("score", {})
    hidden = ", ".join(f"{e['effect']}@{e['snr']}" for e in record.get("effects", ()))
    sys.stdout.write(
        f"{record['case']} [{hidden}] {record['outcome']} {line.get('status', record.get('reason', ''))}"
        f" {line.get('named', '')} {record.get('cost', {}).get('wall', 0):.1f} s\n"
    )
    sys.stdout.flush()


if __name__ == "__main__":
    main()
