"""What a rule is, and what it looks at; the words of all rules stand in `rules.csv`."""

from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from plasmapyro.quality.series import medians
from plasmapyro.radiation.bandsignal import BANDS
from plasmapyro.record import flags, onset
from plasmapyro.record.calibrated import halves
from plasmapyro.record.inputs import has_plasma, instruments
from plasmapyro.record.phases import phases
from plasmapyro.tables import rows

CONTRADICTION, DOUBT = SEVERITIES = "contradiction", "doubt"  # both cannot be true; it may be meant so


@dataclass(frozen=True)
class Case:
    """All that is known of a test or a calibration when its quality is judged; what is absent is None."""

    place: Path  # folder or file, for messages
    test: xr.Dataset | None = None
    files: dict = field(default_factory=dict)  # of the spectrometer, as readers.spectrometer gives them
    calibration: xr.Dataset | None = None
    response: xr.Dataset | None = None
    spectrometer_calibration: xr.Dataset | None = None
    radiometer_calibration: xr.Dataset | None = None
    result: xr.Dataset | None = None  # contract 'correction'
    estimate: xr.Dataset | None = None  # contract 'joint_estimate'
    points: xr.Dataset | None = None  # contract 'calibration_points'
    exposures: xr.Dataset | None = None  # contract 'spectrometer_exposures'
    sightline: xr.Dataset | None = None
    whole: "Case | None" = None  # with the other tests that stand in the same log, if there are any

    def without(self, others):
        """The case without samples of other tests: `others`, instrument -> axis and which (t,)."""
        kept, files = {axis: ~other for axis, other in others.values()}, self.files
        if (mask := kept.get("spectrum_time")) is not None:
            files = files | {
                name: [one for one, good in zip(files[name], mask, strict=True) if good]
                for name in ("names", "dates")
                if files.get(name)
            }
        return replace(self, test=self.test.isel(kept), files=files, whole=self)

    @cached_property
    def holds(self):
        """Names of what the rules may ask for."""
        held = {one.name for one in fields(self) if isinstance(getattr(self, one.name), xr.Dataset)}
        if "test" in held:
            held |= set(instruments(self.test))
            held |= {name for name in ("counts", "spectral_radiance") if name in self.test}
            held |= {"plasma"} if has_plasma(self.test) else set()
        if self.result is not None:
            held |= {f"result.{name}" for name in self.result.variables}
        dated = self.files.get("dates") and all(date is not None for date in self.files["dates"])
        return held | {name for name, value in self.files.items() if value} | ({"dated"} if dated else set())

    @cached_property
    def pair(self):
        """Signals (2, t) [A] of the pyrometer."""
        return np.stack([self.test[f"signal_{band}"].values for band in BANDS]).astype(float)

    @cached_property
    def net(self):
        """Light (S, W) of the spectra: radiances, or counts without the dark."""
        if "spectral_radiance" in self.test:
            return self.test.spectral_radiance.values.astype(float)
        return self.test.counts.values.astype(float) - self.test.background_counts.values

    @cached_property
    def light(self):
        """Mean light (S,) of the pixels that no spectrum lacks, without rays; NaN without such pixels.

        A spectrum that is lost as a whole is left out; its light is NaN.
        """
        slit = float(self.test.attrs["spectrometer_fwhm"])
        net = flags.without_rays(self.net, self.test.wavelength.values, slit)
        told = np.isfinite(net)
        good = told[told.any(axis=1)].all(axis=0)
        return net[:, good].mean(axis=1) if good.any() else np.full(len(net), np.nan)

    @cached_property
    def middle(self):
        """Median light (S,) of the pixels of each spectrum; NaN where all are lost."""
        return medians(self.net)

    @cached_property
    def window(self):
        """What the reference window holds (`onset.attributes`), and the names of the two bands that tell.

        Without a pyrometer the spectra are asked, two halves of their wavelengths; else a radiometer.
        """
        if "pyrometer" in self.holds:
            names, time, pair = [f"{band} band" for band in BANDS], self.test.time.values, self.pair
        elif "spectrometer" in self.holds:
            names = ["shorter wavelengths", "longer wavelengths"]
            time, pair = self.test.spectrum_time.values, halves(self.net)
        else:  # the outer bands of a radiometer
            kind = "signal" if "radiometer_signal" in self.test else "reading"
            names = [str(name) for name in self.test.band.values[[0, -1]]]
            time = self.test.radiometer_time.values
            pair = self.test[f"radiometer_{kind}"].values[:, [0, -1]].T
        attrs = self.test.attrs
        return onset.attributes(
            "seen", time, pair, attrs["reference_window"], attrs["plasma_off_time"]
        ), names

    @cached_property
    def exposure(self):
        """Length of an exposure [s]."""
        return float(self.test.attrs["spectrometer_integration_time"])

    def shining(self, axis):
        """Where the plasma shines on the sample, on the axis `time` or `spectrum_time`."""
        attrs = self.test.attrs
        return phases(self.test[axis].values, attrs["injection_time"], attrs["plasma_off_time"])[1]


@dataclass(frozen=True)
class Rule:
    """One entry of the table: what is looked at, which limit, why it, and what is said."""

    name: str
    looks_at: str  # in words, for the table
    needs: tuple  # of `Case.holds`
    limit: float
    unit: str
    reason: str  # of the limit
    says: str  # template, filled with what `find` saw
    remedy: str  # a template as well
    find: Callable  # (case, limit) -> mapping for `says`, or None
    severity: str
    misdates: bool = False  # spectra are of another moment than their times say
    silent_beside: tuple = ()  # names of rules that say why

    def __call__(self, case):
        """The finding about a case, or None."""
        if not case.holds.issuperset(self.needs):
            return None
        saw = self.find(case, self.limit)
        if saw is None:
            return None
        where = str(saw.pop("where", case.place))
        return Finding(self, where, self.says.format(**saw), self.remedy.format(**saw))


class Finding(NamedTuple):
    """What a rule said: of which file or folder, what it saw there, and what to do."""

    rule: Rule
    where: str
    saw: str
    remedy: str

    @property
    def words(self):
        """One sentence, as commands say it and files keep it."""
        return f"{self.where}: {self.saw}; {self.remedy} [{self.rule.name}]"

    @property
    def entry(self):
        """The same by names, as `diagnosis.json` and `findings.json` hold it."""
        kept = {"rule": self.rule.name, "severity": self.rule.severity}
        return kept | {name: getattr(self, name) for name in ("where", "saw", "remedy")}


REGISTER = {row["name"]: row for row in rows("quality/rules.csv")}


def rule(limit=None, **more):
    """Decorator that makes a `Rule` of the function which looks for the contradiction of its name.

    Words and limit stand in `rules.csv`; `limit` is one that another module decides, `more` what they lack.
    """

    def made(find):
        row = REGISTER[find.__name__]
        return Rule(
            name=row["name"],
            looks_at=row["looks at"],
            needs=tuple(row["needs"].split()),
            silent_beside=tuple((row["silent beside"] or "").split()),
            limit=float(row["limit"]) if limit is None else limit,
            find=find,
            **{name: row[name] for name in ("unit", "reason", "says", "remedy", "severity")},
            **more,
        )

    return made


def rules_of(*modules):
    """The rules that modules declare, in their order."""
    return tuple(value for module in modules for value in vars(module).values() if isinstance(value, Rule))


def look(case, rules):
    """Every finding of `rules` in a case: contradictions first, then doubts, in the order of the rules.

    What follows from another finding (`Rule.silent_beside`) is left out.
    """
    # Signals of zero and missing samples make ratios that the rules leave out.
    with np.errstate(divide="ignore", invalid="ignore"):
        said = [rule(case) for rule in rules]
    named = {one.rule.name for one in said if one is not None}
    found = [one for one in said if one is not None and named.isdisjoint(one.rule.silent_beside)]
    return sorted(found, key=lambda one: SEVERITIES.index(one.rule.severity))
