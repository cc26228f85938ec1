"""One printed number or statement of the paper beside what this chain gives."""

from dataclasses import dataclass
from math import inf, isnan, nan


@dataclass(frozen=True)
class Claim:
    """A claim and our value for it.

    Parameters
    ----------
    key : short name, unique
    section : where the paper says it
    statement : what it says, in one sentence
    value : float, what this chain gives; NaN if it gives nothing
    unit : of value and range
    low, high : range that counts as the printed value: its printed digits, or the stated reading of words
        such as 'about'
    remark : one line on how it was measured here, and why it may differ
    basis : 'simulation', or 'synthetic' if the value rests on the synthetic twin, or 'untestable'
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


UNTESTABLE = nan
