"""What to measure next: the kelvin that further measurements are expected to take from the uncertainty."""

import numpy as np

from plasmapyro import tables
from plasmapyro.constants import SECOND_RADIATION
from plasmapyro.diagnosis.fit.prior import posterior_of, prior_of, shared_rows
from plasmapyro.diagnosis.report.extended import HOT

TABLE = "diagnosis/next_measurements"
SHELF = 1.6e-6  # [m]
SHELF_EMITTANCE = 0.02  # [1] of a surface at `SHELF` over that in the bands of the test
AGAIN = {"gain_pyrometer": 0.005, "gain_spectrometer": 0.005, "emittance": 0.01}  # [1] from test to test
OTHER = {"gain_pyrometer": 0.005, "gain_spectrometer": 0.005, "emittance": np.inf}


class Following:
    """Further measurements of a fitted test, linear in what they observe, with normal errors."""

    def __init__(self, model, fit):
        self.model, self.fit = model, fit
        knots = fit.state.knots
        self.hot = knots > min(HOT, np.max(knots) - 1.0)
        self.names, rows = shared_rows(model)
        self.rows = np.zeros((len(rows), fit.covariance.shape[0]))
        self.rows[:, model.size : model.size + rows.shape[1]] = rows

    def kelvin(self, covariance):
        """Root mean square standard deviation [K] of the temperature where it is hot."""
        return float(np.sqrt(np.mean(np.diag(covariance)[: self.model.size][self.hot])))

    def observation(self, observes, uncertainty):
        """Rows (r, k) and their information (r, r), or None where the model has no such number."""
        if observes.startswith("repeat"):
            return self.rows, self._again(AGAIN if observes == "repeat" else OTHER)
        if observes == "temperature":
            row = np.zeros((1, self.fit.covariance.shape[0]))
            knots = self.fit.state.knots
            # d ln L = dT c2 / (lambda T^2) + d ln emittance, of the mean of the hot readings
            row[0, : self.model.size] = (
                np.where(self.hot, SECOND_RADIATION / (SHELF * knots**2), 0) / self.hot.sum()
            )
            row += self.rows[self.names.index("emittance")]
            hottest = np.max(knots)
            reading = uncertainty * SECOND_RADIATION / (SHELF * hottest)
            return row, np.array([[1 / (reading**2 + SHELF_EMITTANCE**2)]])
        if observes in self.model.index:
            row = np.zeros((1, self.fit.covariance.shape[0]))
            row[0, self.model.size + self.model.index[observes]] = 1.0
            one = self.model.parameters[self.model.index[observes]].instrument
            kinds = {instrument.kind for instrument in self.model.instruments}
            return (row, np.array([[uncertainty**-2.0]])) if one in (None, *kinds) else None
        mine = [place for place, name in enumerate(self.names) if name.startswith(f"{observes}_")]
        return (self.rows[mine], np.eye(len(mine)) * uncertainty**-2.0) if mine else None

    def _again(self, scatter):
        """Information (d, d) of a second test as good as this one, some numbers scattered or new in it."""
        after, before = posterior_of(self.model, self.fit), prior_of(self.model)
        matrix = np.linalg.inv(after.covariance) - np.linalg.inv(before.covariance)
        for place, name in enumerate(self.names):
            sigma = min(scatter.get(name, 0.0), before.sigma[place])  # a new number has its own prior
            if sigma:
                column = matrix[:, place].copy()
                matrix -= np.outer(column, column) / (column[place] + sigma**-2.0)
                if not np.isfinite(scatter[name]):
                    matrix[place], matrix[:, place] = 0.0, 0.0
        return matrix

    def after(self, covariance, parts):
        """Covariance after a measurement of several parts [(observes, uncertainty)]."""
        for observes, uncertainty in parts:
            found = self.observation(observes, uncertainty) if observes else None
            if found is not None:
                rows, information = found
                gained = covariance @ rows.T
                core = information @ np.linalg.inv(np.eye(len(rows)) + rows @ gained @ information)
                covariance = covariance - gained @ core @ gained.T
        return covariance


def measurements():
    """The table: {id: (words, [(observes, uncertainty)], ids of effects that it decides)}."""
    table, found = tables.load(TABLE), {}
    for name, words, observes, uncertainty, decides in zip(
        *(table[key] for key in ("measurement", "words", "observes", "uncertainty", "decides")), strict=True
    ):
        entry = found.setdefault(name, (words, [], set()))
        entry[1].append((observes, float(uncertainty)))
        entry[2].update(decides.split())
    return found


def following(model, fit, groups=(), apart=None):
    """Measurements ranked by the kelvin of uncertainty that each removes, and the best one after the first.

    Entries by the schema of `diagnosis.json`. `groups`: lists of ids of effects that the data do not tell
    apart; `apart`: id -> [K], how far the temperature moves by an effect; the spread in a group counts as
    uncertainty.
    """
    state, known = Following(model, fit), measurements()
    open_groups = [group for group in groups if len(group) > 1]

    def spread(decided):
        left = [group for group in open_groups if not set(group) & decided]
        return float(
            np.sqrt(sum(np.ptp([(apart or {}).get(one, 0.0) for one in group]) ** 2 for group in left))
        )

    def total(covariance, decided):
        return float(np.hypot(state.kelvin(covariance), spread(decided)))

    plain, rows = total(fit.covariance, set()), []
    changed = {name: state.after(fit.covariance, parts) for name, (_, parts, _) in known.items()}
    for name, (words, _, decides) in known.items():
        rows.append(
            {
                "id": name,
                "measurement": words,
                "kelvin_before": plain,
                "kelvin_after": total(changed[name], decides),
                "resolves": [list(group) for group in open_groups if set(group) & decides],
            }
        )
    rows.sort(key=lambda row: (row["kelvin_after"], -len(row["resolves"])))
    first = rows[0]["id"]
    for row in rows:
        both = known[first][2] | known[row["id"]][2]
        row["after_first"] = total(state.after(changed[first], known[row["id"]][1]), both)
    return rows
