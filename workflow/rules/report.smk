TEMPERATURES = sorted([*((test, "temperature") for test in WORKED), *CORRECTIONS], key=lambda one: one[0])


# One page with all that a run found. Not part of the main job: `make report`, or ask for results/report.html.
rule report:
    input:
        figures=[figure for figure in FIGURES if figure.endswith(".png")],
        corrections=[f"results/experiment/{test}/{contract}.nc" for test, contract in TEMPERATURES],
        claims=[] if BANDS else "results/claims.nc",
        findings=expand("results/experiment/{test}/findings.json", test=WORKED),
        diagnoses=expand("results/diagnosis/{test}/index.html", test=DIAGNOSED),
        everything=RESULTS,
    output:
        "results/report.html",
    params:
        tests=[test for test, _ in TEMPERATURES],
        diagnosed=DIAGNOSED,
        rules=lambda wildcards: [rule.name for rule in workflow.rules],
        shown={"configuration": config, "without": LEFT_OUT},
    script:
        "../scripts/report.py"
