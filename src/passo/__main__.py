"""`python -m passo` is the passo command."""

import sys

from passo.cli.main import main

sys.exit(main())
