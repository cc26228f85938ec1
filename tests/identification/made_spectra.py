"""Spectra of our own making: lines typed from tables, other profile and noise than the package assumes."""

import numpy as np

# air wavelength [nm], strength as in arcs (persistent lines, CRC Handbook of Chemistry and Physics)
SODIUM = [(588.995, 1000), (589.592, 520), (818.326, 90), (819.482, 160), (568.821, 25), (568.263, 14)]
POTASSIUM = [(766.490, 900), (769.896, 470), (691.108, 6), (693.876, 11), (404.414, 12), (404.721, 6)]
LITHIUM = [(670.776, 1000), (610.362, 260), (460.286, 30), (812.644, 80)]
COPPER = [(324.754, 900), (327.396, 480), (510.554, 150), (515.324, 300), (521.820, 430), (570.024, 40)]
COPPER += [(578.213, 110), (793.313, 90), (809.263, 170)]
CALCIUM = [(422.673, 900), (445.478, 160), (443.496, 100), (442.544, 55), (643.907, 150), (646.257, 110)]
CALCIUM += [(649.378, 80), (616.217, 120), (612.222, 80), (610.272, 35), (558.876, 110), (559.447, 90)]
CALCIUM += [(526.556, 60), (527.027, 80), (671.768, 40), (714.815, 60)]
NEON = [(585.249, 200), (588.190, 100), (594.483, 100), (597.553, 60), (603.000, 100), (607.434, 100)]
NEON += [(609.616, 70), (614.306, 100), (616.359, 100), (621.728, 100), (626.650, 100), (633.443, 100)]
NEON += [(638.299, 100), (640.225, 200), (650.653, 150), (667.828, 50), (692.947, 100), (703.241, 80)]
OXYGEN = [(777.194, 400), (777.417, 290), (777.539, 170), (844.636, 180), (844.676, 100)]


def spectrum(lines, seed=1, offset=0.0, peak=5000.0, low=300.0, high=950.0):
    """Axis [m] and counts: Lorentz profiles of 0.3 nm, an offset [nm] of the scale, a hump, Poisson noise, a
    response that falls to a third at both ends."""
    axis = np.arange(low, high, 0.1)
    light = np.zeros(axis.size)
    strongest = max(strength for _, strength in lines)
    for place, strength in lines:
        light += strength / strongest / (1 + ((axis - place - offset) / 0.15) ** 2)
    light *= peak * np.exp(-(((axis - 620.0) / 310.0) ** 2))
    light += 300 + 150 * np.exp(-(((axis - 550.0) / 120.0) ** 2))
    return axis * 1e-9, np.random.default_rng(seed).poisson(light).astype(float)
