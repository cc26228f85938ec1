"""Terms of an extended model as text that a person may keep and edit, and back."""

from plasmapyro.diagnosis.catalogue import EFFECTS
from plasmapyro.diagnosis.model import Setting


def fragment(settings):
    """YAML text of terms with their fitted values, priors and bounds.

    Parameters
    ----------
    settings : iterable of Setting

    Returns
    -------
    str
    """
    lines = ["effects:"]
    for setting in settings:
        effect = EFFECTS[setting.id]
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


def settings_of(configuration):
    """Terms of a parsed fragment.

    Parameters
    ----------
    configuration : mapping with the list `effects`

    Returns
    -------
    tuple of Setting

    Raises
    ------
    ValueError
        Unknown effect or number, a missing amplitude, or an amplitude outside its bounds; all faults at once.
    """
    found, faults = [], []
    for entry in configuration.get("effects", []):
        identity = entry.get("id")
        if identity not in EFFECTS:
            faults.append(f"effect {identity!r} is not in the catalogue")
            continue
        effect, amplitude = EFFECTS[identity], entry.get("amplitude")
        if not isinstance(amplitude, int | float) or not effect.bounds[0] <= amplitude <= effect.bounds[1]:
            faults.append(f"{identity}: amplitude must lie in {list(effect.bounds)}; got {amplitude!r}")
            continue
        shape = entry.get("shape", {})
        known = set(effect.shape_bounds) | {name for one in effect.shapes for name in one}
        if set(shape) - known:
            faults.append(f"{identity}: unknown {', '.join(sorted(set(shape) - known))}")
            continue
        defaults = dict(effect.shapes[0]) | {name: float(value) for name, value in shape.items()}
        found.append(Setting(identity, float(amplitude), defaults))
    if faults:
        raise ValueError("effects: " + "; ".join(faults))
    return tuple(found)
