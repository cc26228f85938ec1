"""The extended model: its effects, and what it is worth on data that the fit has not seen."""

import numpy as np

from plasmapyro.diagnosis.fit.setting import free_numbers
from plasmapyro.diagnosis.report import show

HOT = 1000.0  # [K] from which the uncertainty of a temperature is given


def extension(findings):
    """Entry of the extended model, None where nothing is named."""
    final = findings.final
    if not final.settings:
        return None
    free = free_numbers(final.settings)
    errors = np.sqrt(np.maximum(np.diag(final.covariance)[findings.size :], 0))
    entries = []
    for place, setting in enumerate(final.settings):
        own = [j for j, number in enumerate(free) if number.place == place]
        values = {"amplitude": setting.amplitude} | setting.shape
        names = {j: free[j].name or "amplitude" for j in own}
        entries.append(
            {
                "id": setting.id,
                "parameters": {names[j]: float(values[names[j]]) for j in own},
                "standard_errors": {names[j]: float(errors[j]) for j in own},
            }
        )
    gained = findings.gained
    better = "improve" if gained.improves else "do not improve significantly"
    if gained.improves and not findings.applied:
        better = "improve, but nothing being wrong is likelier"
    return {
        "configuration": fragment(final.settings),
        "terms": entries,
        "chi2": float(final.chi2),
        "dof": float(final.count - findings.fitted - len(free)),
        "applied": findings.applied,
        "why": f"held-out data {better}: log score {gained.total:+.1f} ± {gained.standard_error:.1f}",
    }


def worth(findings, shift):
    """Entry of what the extension gains, None without one; `shift` [K] of the temperature at worst."""
    gained, base, final = findings.gained, findings.base.solution, findings.final
    if gained is None:
        return None
    return {
        "heldout_log_score": gained.total,
        "heldout_standard_error": gained.standard_error,
        "calibration": gained.calibration,
        "blocks": [{"start": a, "end": b, "difference": d} for a, b, d in gained.blocks],
        "cross_instrument": gained.cross_instrument,
        "cross_condition": findings.crossed,
        "kappa_before": _mean_step(findings, base),
        "kappa_after": _mean_step(findings, final),
        "temperature_shift": shift,
        "temperature_sigma_base": _sigma(findings, base),
        "temperature_sigma_extended": _sigma(findings, final),
    }


def _sigma(findings, solution):
    """Median standard deviation [K] of the temperature, where it is hot and has settled, if anywhere."""
    knots, (first, last) = findings.model.history.knots, findings.span
    hot = (solution.state.knots > HOT) & (knots >= first) & (knots <= last)
    sigma = np.sqrt(np.diag(solution.covariance)[: knots.size])
    return float(np.median(sigma[hot] if hot.any() else sigma))


def _mean_step(findings, solution):
    """Weighted mean over the channels of the step at the end of the plasma over the gas before it."""
    step = show.kappa(findings.model, findings.base.fitter, solution)
    pairs = [(k, e) for k, e in zip(step["kappa"], step["error"], strict=True) if k is not None and e]
    if not pairs:
        return None
    values, errors = np.array(pairs).T
    return float(np.sum(values / errors**2) / np.sum(1 / errors**2))


def fragment(settings):
    """YAML text of settings with their fitted values, priors and bounds.

    Parameters
    ----------
    settings : iterable of Setting

    Returns
    -------
    str
    """
    lines = ["effects:"]
    for setting in settings:
        effect = setting.effect
        low, high = effect.bounds
        lines += [
            f"  - id: {setting.id}  # {effect.name}",
            f"    amplitude: {setting.amplitude:.6g}  # {effect.amplitude} [{effect.unit}]",
            f"    prior: [normal, 0, {effect.sigma:g}]",
            f"    bounds: [{low:g}, {high:g}]",
        ]
        if setting.shape:
            lines.append("    shape:")
            lines += [f"      {name}: {value:.6g}" for name, value in setting.shape.items()]
    return "\n".join(lines) + "\n"
