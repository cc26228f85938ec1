"""How much of the data unknown structures explain: log Bayes factors over the base model."""

import numpy as np
from scipy.linalg import eigh

from plasmapyro.diagnosis.select.screen import LEAST_LEFT, gain

SCALES = (3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2, 0.1)  # [1] relative size of an unknown structure


class Unknowns:
    """Log Bayes factors of the classes of unknown structures, for one or many scores."""

    def __init__(self, screen):
        self.parts = []
        for structure in screen.structures:
            place = slice(screen.count + structure.columns.start, screen.count + structure.columns.stop)
            if structure.basis is not None:
                kept = structure.basis * (screen.left[place] > LEAST_LEFT)[:, None]
                value = np.einsum("cb,cd,db->b", kept, screen.information[place, place], kept)
                self.parts.append((place, value, kept, True))
            elif structure.single:
                value = np.where(screen.left[place] > LEAST_LEFT, np.diag(screen.information)[place], 0.0)
                self.parts.append((place, value, None, True))
            else:
                value, vector = eigh(screen.information[place, place])
                good = value > 1e-10 * max(value.max(), 1e-300)
                self.parts.append((place, value[good], vector[:, good], False))

    def __call__(self, scores):
        """Log Bayes factors (..., classes) of scores (..., m): the best scale, less the price of trying."""
        result = []
        for place, value, vector, single in self.parts:
            q = scores[..., place] if vector is None else scores[..., place] @ vector
            best = np.full(scores.shape[:-1], -np.inf)
            for scale in SCALES:
                loss, won = np.log1p(scale**2 * value), q**2 / (value + scale**-2)
                if single:
                    log_bayes = 0.5 * np.max(np.where(value > 0, won - loss, 0.0), axis=-1) - np.log(
                        value.size
                    )
                else:
                    log_bayes = 0.5 * np.sum(won, axis=-1) - 0.5 * np.sum(loss)
                best = np.maximum(best, log_bayes)
            result.append(best - np.log(len(SCALES)))
        return np.stack(result, axis=-1)

    def gains_beside(self, screen, which):
        """Chi-squared gained by each candidate (candidates,) when the unknown structure `which` is there too.

        A structure with a Gaussian prior of its best scale joins the covariance; of a class of single columns
        the best column does.
        """
        score, value, inverse, columns = self.most_likely(screen, which)
        cross = screen.information[: screen.count, self.parts[which][0]] @ columns
        own = np.diag(screen.information)[: screen.count]
        less = own - np.sum(cross**2 / (value + inverse), axis=1)
        rest = screen.score[: screen.count] - cross @ (score / (value + inverse))
        share = screen.left[: screen.count] * less / np.where(own > 0, own, np.inf)
        return gain(rest, less, share)

    def shift(self, screen, which):
        """Change (K,) [K] of the fitted knots if the unknown structure `which` were in the model."""
        score, value, inverse, columns = self.most_likely(screen, which)
        place = self.parts[which][0]
        return screen.shift[:, screen.count :][:, place.start - screen.count : place.stop - screen.count] @ (
            columns @ (score / (value + inverse))
        )

    def most_likely(self, screen, which):
        """Score and information (k,) of a structure along k independent columns, its inverse variance at the
        best scale, and these columns (m, k); of a class of single columns the best one."""
        place, value, vector, single = self.parts[which]
        vector = np.eye(place.stop - place.start) if vector is None else vector
        score, worth = vector.T @ screen.score[place], []
        for scale in SCALES:
            each = 0.5 * (score**2 / (value + scale**-2) - np.log1p(scale**2 * value))
            each = np.where(value > 0, each, 0.0)
            worth.append(each.max() if single else each.sum())
        inverse = SCALES[int(np.argmax(worth))] ** -2.0
        if single:
            kept = [int(np.argmax(np.where(value > 0, score**2 / (value + inverse), 0.0)))]
            score, value, vector = score[kept], value[kept], vector[:, kept]
        return score, value, inverse, vector
