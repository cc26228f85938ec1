"""A number of the base model."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Parameter:
    """One number of the base model, 0 in the middle of its prior; those of a family share id and name.

    `instrument` that it is of, None for all; `calibrated` (2,): relative change of the signals of the two
    bands per unit that their calibration has taken up; `history`: times [s] and relative changes of the
    brightness of the gas at them per unit; `start` of a fit, the centre if None.
    """

    id: str
    name: str
    sigma: float
    unit: str = "1"
    centre: float = 0.0
    instrument: str | None = None
    calibrated: tuple = ()
    history: tuple = ()
    start: float | None = None

    @property
    def first(self):
        """Value that a fit starts from."""
        return self.centre if self.start is None else self.start
