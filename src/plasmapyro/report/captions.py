"""What each figure shows, in words: its caption and, for who cannot see it, its alternative text."""

# Beginning of the figure's file name -> (chapter, caption, alternative text). The longest match counts.
FIGURES = {
    "fig3a": (
        "Instrument",
        "Relative responses of the two bands of the pyrometer, modelled: layered silicon and an edge.",
        "Two curves over wavelength: the wide band from 0.75 and the narrow band from 0.96 micrometre, both"
        " falling off towards 1.15 micrometre.",
    ),
    "fig3b": (
        "Instrument",
        "Calibration: ratio of the two signals against the source temperature, with its interval.",
        "The signal ratio falls with source temperature; the points lie on the fitted curve.",
    ),
    "fig4b": (
        "Instrument",
        "Calibration factor of the spectrometer over wavelength.",
        "The factor rises steeply towards 1.03 micrometre, where the detector goes blind.",
    ),
    "fig5a": (
        "Flow",
        "Temperature of torch and jet, with the line of sight of the instruments.",
        "Section of torch, chamber and probe coloured by temperature; a line at 35 degrees from the probe"
        " through the jet.",
    ),
    "fig5b": (
        "Flow",
        "Temperature and pressure along the line of sight for each power, over the square root of the path.",
        "Steep rise within some millimetres from the probe, a hot core, and a fall to the cold chamber;"
        " higher for higher power.",
    ),
    "flow_": (
        "Flow",
        "Computed field: temperature with line of sight and streamlines, Joule heating, axial velocity.",
        "Two sections of torch, chamber and probe: a hot core with a recirculating ring near the back wall,"
        " heated in a shell under the coil.",
    ),
    "flow_convergence": (
        "Flow",
        "How each flow converged: velocity and temperature change and residual of every Newton step.",
        "Three panels of falling lines over the step number, one line per power.",
    ),
    "facility_pairs": (
        "Flow",
        "Heat flux against Pitot pressure: computed for walls of several recombination, and measured pairs.",
        "The computed curves rise together; measured pairs lie below and to the right of all but the lowest.",
    ),
    "flow_budgets": (
        "Flow",
        "Momentum and power through sections of torch and jet. Nearly all momentum stays in the cold sheath.",
        "Two panels over the axial position: momentum stays level while that of hot gas grows slowly;"
        " Joule heat and enthalpy rise under the coil, with a constant loss behind.",
    ),
    "flow_balances": (
        "Flow",
        "Where the power goes, and what the balances of energy and mass leave open. Parts too small to be"
        " seen are named with their size.",
        "Stacked bars per power: about 70 % leaves with the jet, the rest to back wall and probe; below them"
        " imbalances of some 0.1 %.",
    ),
    "fig6": (
        "Gas radiance",
        "Spectral radiance of the gas at each power beside that of the surface, with the two bands.",
        "Line spectra of the gas above smooth curves of the hot surface for several temperatures.",
    ),
    "fig7a": (
        "Errors",
        "Visibility factors of both bands against surface temperature.",
        "S-shaped curves from near zero at low to one at high temperature, one per power and band.",
    ),
    "fig7b": (
        "Errors",
        "Surface temperature from which a band sees 90 and 99 % surface, against power.",
        "Rising curves over power for two bands and two levels.",
    ),
    "fig8a": (
        "Errors",
        "Temperature that the pyrometer reads against the true one.",
        "The readings lie far above the true temperature when that is low and join it when it is high.",
    ),
    "fig8b": (
        "Errors",
        "Relative error of the reading against the true temperature.",
        "The error falls from large values to below one per cent, later for higher power.",
    ),
    "fig8c": (
        "Errors",
        "Surface temperature above which the gas adds less than 1 %, against emittance.",
        "One falling curve per power: worse for low emittance and high power.",
    ),
    "fig8d": (
        "Errors",
        "A heating surface as the pyrometer would read it through the gas.",
        "The reading starts far too high, falls, and joins the rising true temperature.",
    ),
    "design_bands": (
        "Design",
        "Spectrum of the gas and of hot surfaces, and below it the bands of designs and of pyrometers.",
        "The gas has windows near 900, 1060 and 1200 nanometre; the bands of good designs sit in them.",
    ),
    "design_trade_off": (
        "Design",
        "Sensitivity of pairs of bands against the temperature above which the gas shifts them by 1 %.",
        "A cloud of pairs with its Pareto front; the MR1SB lies some 250 kelvin above the front.",
    ),
    "design_error_maps": (
        "Design",
        "Curves of 1 % error over emittance and temperature: MR1SB, robust design, design of least error.",
        "Three panels; the curves of the designs lie at lower temperatures than those of the MR1SB.",
    ),
    "design_shelf": (
        "Design",
        "Temperature above which the gas shifts a pyrometer by less than 1 %, by power.",
        "A coloured table of pyrometers and powers; bands near 1.2 micrometre are the least disturbed.",
    ),
    "reflecting_samples": (
        "Design",
        "Curves of 1 % error of samples that reflect the gas, as read and corrected, and what neglect costs.",
        "Matt samples need several hundred kelvin more than mirrors, and more at low emittance.",
    ),
    "trust": (
        "Design",
        "Temperature from which each setup reads within the first level, against power.",
        "Curves rise with power; subtracting the reference after injection lowers them by some 400 kelvin.",
    ),
    "fig9b": (
        "Test",
        "Emittance assumed for the sample.",
        "Emittance over wavelength as one level line with its interval.",
    ),
    "fig10a": (
        "Test",
        "Signals of the two bands, as measured and after subtraction of the gas.",
        "Two signals over time: a plateau of gas before the surface shines, a rise, and the cooling.",
    ),
    "fig10b": (
        "Test",
        "Measured and corrected temperature, with the spread of the corrected one.",
        "The measured temperature is far too high while the sample heats; the corrected one rises smoothly.",
    ),
    "fig10c": (
        "Test",
        "Relative error of the measured temperature.",
        "The error falls from tens of per cent to below one as the surface outshines the gas.",
    ),
    "joint_estimate": (
        "Test",
        "Joint estimate of the surface temperature with its 95 % interval, beside the measured and the"
        " corrected one; below, the brightness of the gas over that at injection.",
        "The estimate begins at lower temperatures than the corrected one, passes through its scatter and"
        " follows the cooling to the end; the gas wanders slowly and vanishes with the plasma.",
    ),
    "fig11a": (
        "Test",
        "Reference spectrum of the gas beside simulated ones.",
        "A measured line spectrum and two computed ones with the same lines.",
    ),
    "fig11b": (
        "Test",
        "Spectra at several times, normalised, with the fitted Planck curves.",
        "Noisy lines fade and smooth Planck curves emerge as the sample heats.",
    ),
    "fig11c": (
        "Test",
        "Temperatures from pyrometer and spectrometer beside each other.",
        "Both rise together after the start and agree at the plateau.",
    ),
}


def describe(name):
    """Chapter, caption and alternative text of a figure.

    Parameters
    ----------
    name : str
        File name without suffix.

    Raises
    ------
    KeyError
        If no entry fits; the message says where to add one.
    """
    fitting = [start for start in FIGURES if name.startswith(start)]
    if not fitting:
        raise KeyError(f"figure '{name}' has no words yet; add it to FIGURES in {__name__}")
    chapter, caption, words = FIGURES[max(fitting, key=len)]
    return chapter, caption + (" Your own conditions." if name.endswith("_own") else ""), words
