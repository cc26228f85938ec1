"""`python -m plasmapyro`: the command line."""

import sys

from plasmapyro.cli import main

sys.exit(main())
