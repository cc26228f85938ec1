"""Subcommands of `plasmapyro`: a module with `run` each, options in options.csv, words of help in words/."""
