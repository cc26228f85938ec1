"""Subcommands of `plasmapyro`: each module adds its options to a parser and runs them."""
