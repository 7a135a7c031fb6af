"""`python -m passo.toolchain DIRECTORY SOURCE…`: the tables of a firmware whose dictionary needs
only the declarations of its sources. The build of the package uses it before the package exists."""

import sys
from pathlib import Path

from passo.toolchain.declarations import gather
from passo.toolchain.tables import dictionary, write_tables
from passo.version import __version__

found = gather(sorted(map(Path, sys.argv[2:])))
write_tables(found, dictionary(found, version=__version__), Path(sys.argv[1]))
