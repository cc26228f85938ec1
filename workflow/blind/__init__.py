"""Blind tests of the diagnosis: effects are hidden in synthetic data and must be found without the truth.

`draw` makes cases from a seed given from outside, `bench` turns a case into the files of a laboratory,
`worker` (another process, which never sees the truth) diagnoses them, `score` compares afterwards and
`board` writes the scoreboard. Only the worker's process imports `plasmapyro`.
"""
