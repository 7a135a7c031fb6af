"""Every kind of probe, by the `kind` in a machine file. A new kind is one file and one entry
here."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from passo.probes.bltouch import BLTouch
from passo.probes.dock import DockProbe
from passo.probes.eddy import EddyProbe
from passo.probes.fixed import FixedProbe
from passo.probes.manual import ManualProbe
from passo.probes.nozzle import NozzleProbe
from passo.probes.servo import ServoProbe

AnyProbe = Annotated[
    FixedProbe | NozzleProbe | BLTouch | ServoProbe | DockProbe | EddyProbe | ManualProbe,
    Field(discriminator="kind"),
]
