"""One printed number or statement of the paper beside what this chain gives; the register is `claims.csv`."""

from dataclasses import dataclass, replace
from math import inf, isnan, nan

from plasmapyro.tables import rows


@dataclass(frozen=True)
class Claim:
    """A claim and our value for it.

    `section`: where the paper says it; `statement`: what it says, in one sentence; `value`: what this chain
    gives, NaN if nothing; `low`, `high`: range that counts as the printed value, its printed digits or the
    stated reading of words such as 'about'; `remark`: how it was measured here, and why it may differ;
    `basis`: 'simulation', or 'synthetic' if the value rests on the synthetic twin, or 'untestable'.
    """

    key: str
    section: str
    statement: str
    value: float
    unit: str
    low: float = -inf
    high: float = inf
    remark: str = ""
    basis: str = "simulation"

    @property
    def verdict(self):
        """'reproduced', 'differs by ...', 'no value here' or 'not testable here'; marked if synthetic."""
        if self.basis == "untestable":
            return "not testable here"
        if isnan(self.value):
            return "no value here"
        mark = " (synthetic data)" if self.basis == "synthetic" else ""
        excess = max(self.value - self.high, 0.0) - max(self.low - self.value, 0.0)
        if excess == 0:
            return "reproduced" + mark
        return f"differs by {excess:+.3g} {self.unit}".removesuffix(" 1") + mark

    @property
    def printed(self):
        """The accepted range as text."""
        if self.low == -inf and self.high == inf:
            return "–"
        if self.low == -inf:
            return f"≤ {self.high:g} {self.unit}"
        if self.high == inf:
            return f"≥ {self.low:g} {self.unit}"
        if self.low == self.high:
            return f"{self.low:g} {self.unit}"
        return f"{self.low:g} to {self.high:g} {self.unit}"


REGISTER = {row["key"]: row for row in rows("claims/claims.csv")}


def claim(key, value, data=None, of=None, **seen):
    """The claim of a row `key` of `claims.csv` with our value, in the unit of that row.

    `data`: the test that the value comes from; what is synthetic makes the claim so. `of`: the condition,
    where each has a claim of its own. `seen`: what fills the braces of statement and remark.
    """
    row = REGISTER[key]
    synthetic = data is not None and data.attrs.get("origin") == "synthetic"
    return Claim(
        f"{key}_{of}" if of else key,
        row["section"],
        row["statement"].format(of=of, **seen),
        float(value),
        row["unit"],
        float(row["low"] or -inf),
        float(row["high"] or inf),
        row["remark"].format(of=of, **seen),
        "synthetic" if synthetic else "simulation",
    )


def untestable_claims():
    """Claims that rest on data which are not public."""
    rows = [row for row in REGISTER.values() if row["testable"] == "no"]
    return [replace(claim(row["key"], nan), basis="untestable") for row in rows]
