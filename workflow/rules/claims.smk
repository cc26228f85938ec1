if not BANDS:  # claims are of the paper's instrument
    RESULTS += ["results/claims.nc", "results/claims.md"]


rule claims:
    input:
        sightlines=expand("results/sightline/{condition}.nc", condition=PAPER),
        radiation=expand("results/radiation/{condition}.nc", condition=PAPER),
        surface="results/analysis/surface_radiance.nc",
        response="results/instrument/response.nc",
        visibility="results/analysis/visibility.nc",
        apparent_temperature="results/analysis/apparent_temperature.nc",
        error_map="results/analysis/error_map.nc",
        transient="results/analysis/transient.nc",
        gas="results/gas/air11.nc",
        # Not there if the flows are another program's.
        variations=[
            f"results/radiation_variations/{name}.nc"
            for name in {config["diagnosis"]["condition"]} & set(PAPER) & set(VARIED)
        ],
        reflection=["results/design/reflection.nc"][: len(DESIGNED)],
        designs=["results/design/band_design.nc"][: len(DESIGNED)],
        calibration="results/instrument/calibration.nc",
        pyrometer=f"results/experiment/{config['claims']['test']}/pyrometer_correction.nc",
        spectrometer=f"results/experiment/{config['claims']['test']}/spectrometer_correction.nc",
    output:
        table="results/claims.nc",
        text="results/claims.md",
    script:
        "../scripts/claims.py"
