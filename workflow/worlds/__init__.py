"""The second laboratory of the blind tests: its own gas, samples, instruments, noises and faults, from
literature.

Nothing here imports `plasmapyro` or `twin`, nor takes a number from them: what is common are the laws of
physics, the files of a test folder and, as the profile of the gas, a sight line. It is never adjusted to
agree with the package: a difference is reported and stays, unless a cited source shows which side is wrong.

`gas` composition of air, `atoms`, `molecules`, `continuum` its light, `engine` the light along a path with
the scatter of published accuracies; `sample` histories of a surface, `laboratory` instruments and what they
record, `faults` what may be hidden, `case` draws all of it, `measure` says how large an effect is in
standard deviations.
"""
