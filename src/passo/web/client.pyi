"""The Python client, made from the table of operations: make reference."""

import builtins
import passo.printer.status
import passo.web.answers
import passo.web.endpoints.console
import passo.web.endpoints.history
import passo.web.endpoints.machine
import passo.web.endpoints.status

class RequestError(Exception):
    status: int
    fault: passo.web.answers.Fault
    def __init__(self, status: int, fault: passo.web.answers.Fault) -> None: ...

class Status:
    def get(
        self,
    ) -> passo.web.endpoints.status.StatusNow:
        """The printer now: state, positions, heaters, fans, the print, faults. The
        WebSocket `/api/v1/feed` tells the same as it changes. Numbers that are not finite
        are null."""
        ...
    def version(
        self,
    ) -> passo.web.endpoints.status.Version:
        """Which version of Passo serves which machine."""
        ...

class Machine:
    def get(
        self,
    ) -> passo.web.endpoints.machine.Machine:
        """The parts of the machine, which stay the same while it is served."""
        ...

class Emergency:
    def stop(
        self,
    ) -> None:
        """Switches heaters, motors and fans off at once (M112). The print is lost, and
        positions are not certain any more."""
        ...
    def restart(
        self,
    ) -> None:
        """Starts a halted printer again (M999); answers when it runs."""
        ...

class Console:
    def run(
        self,
        script: str,
    ) -> passo.web.endpoints.console.Answer:
        """Carries out lines of G-code, one after the other, and answers when the last one
        is done or planned. The first line that fails ends the script."""
        ...
    def history(
        self,
    ) -> builtins.list[passo.web.endpoints.console.Line]:
        """The last lines of all consoles, oldest first, without secrets."""
        ...
    def commands(
        self,
    ) -> builtins.list[passo.web.endpoints.console.Command]:
        """Each command that the printer knows."""
        ...

class Job:
    def start(
        self,
        path: str,
    ) -> None:
        """Prints a file of the card."""
        ...
    def pause(
        self,
    ) -> None:
        """Pauses the print: the machine brakes and parks."""
        ...
    def resume(
        self,
    ) -> None:
        """Resumes a paused print."""
        ...
    def cancel(
        self,
    ) -> None:
        """Ends the print; heaters and fans go off."""
        ...

class Heaters:
    def list(
        self,
    ) -> dict[str, passo.printer.status.HeaterStatus]:
        """All heaters by name."""
        ...
    def set(
        self,
        name: str,
        celsius: float,
    ) -> None:
        """Sets the target of a heater at once, and does not wait until it is reached."""
        ...

class Fans:
    def list(
        self,
    ) -> dict[str, float]:
        """The speed of each fan as last set, a fraction of full speed."""
        ...
    def set(
        self,
        name: str,
        speed: float,
    ) -> None:
        """Sets the speed of a fan at once. Fans that follow a heater or the boards cannot
        be set."""
        ...

class History:
    def temperatures(
        self,
        span_s: float = ...,
    ) -> passo.web.endpoints.history.Temperatures:
        """Temperatures, targets and power of all heaters: one sample a second of the last
        15 minutes, one each 15 s of the day before."""
        ...

class AsyncStatus:
    async def get(
        self,
    ) -> passo.web.endpoints.status.StatusNow:
        """The printer now: state, positions, heaters, fans, the print, faults. The
        WebSocket `/api/v1/feed` tells the same as it changes. Numbers that are not finite
        are null."""
        ...
    async def version(
        self,
    ) -> passo.web.endpoints.status.Version:
        """Which version of Passo serves which machine."""
        ...

class AsyncMachine:
    async def get(
        self,
    ) -> passo.web.endpoints.machine.Machine:
        """The parts of the machine, which stay the same while it is served."""
        ...

class AsyncEmergency:
    async def stop(
        self,
    ) -> None:
        """Switches heaters, motors and fans off at once (M112). The print is lost, and
        positions are not certain any more."""
        ...
    async def restart(
        self,
    ) -> None:
        """Starts a halted printer again (M999); answers when it runs."""
        ...

class AsyncConsole:
    async def run(
        self,
        script: str,
    ) -> passo.web.endpoints.console.Answer:
        """Carries out lines of G-code, one after the other, and answers when the last one
        is done or planned. The first line that fails ends the script."""
        ...
    async def history(
        self,
    ) -> builtins.list[passo.web.endpoints.console.Line]:
        """The last lines of all consoles, oldest first, without secrets."""
        ...
    async def commands(
        self,
    ) -> builtins.list[passo.web.endpoints.console.Command]:
        """Each command that the printer knows."""
        ...

class AsyncJob:
    async def start(
        self,
        path: str,
    ) -> None:
        """Prints a file of the card."""
        ...
    async def pause(
        self,
    ) -> None:
        """Pauses the print: the machine brakes and parks."""
        ...
    async def resume(
        self,
    ) -> None:
        """Resumes a paused print."""
        ...
    async def cancel(
        self,
    ) -> None:
        """Ends the print; heaters and fans go off."""
        ...

class AsyncHeaters:
    async def list(
        self,
    ) -> dict[str, passo.printer.status.HeaterStatus]:
        """All heaters by name."""
        ...
    async def set(
        self,
        name: str,
        celsius: float,
    ) -> None:
        """Sets the target of a heater at once, and does not wait until it is reached."""
        ...

class AsyncFans:
    async def list(
        self,
    ) -> dict[str, float]:
        """The speed of each fan as last set, a fraction of full speed."""
        ...
    async def set(
        self,
        name: str,
        speed: float,
    ) -> None:
        """Sets the speed of a fan at once. Fans that follow a heater or the boards cannot
        be set."""
        ...

class AsyncHistory:
    async def temperatures(
        self,
        span_s: float = ...,
    ) -> passo.web.endpoints.history.Temperatures:
        """Temperatures, targets and power of all heaters: one sample a second of the last
        15 minutes, one each 15 s of the day before."""
        ...

class Client:
    """A printer that is served somewhere."""

    def __init__(
        self, url: str = ..., *, key: str | None = None, timeout_s: float = ...
    ) -> None: ...

    @property
    def status(self) -> Status: ...
    @property
    def machine(self) -> Machine: ...
    @property
    def emergency(self) -> Emergency: ...
    @property
    def console(self) -> Console: ...
    @property
    def job(self) -> Job: ...
    @property
    def heaters(self) -> Heaters: ...
    @property
    def fans(self) -> Fans: ...
    @property
    def history(self) -> History: ...

class AsyncClient:
    """As `Client`, with calls to await."""

    def __init__(
        self, url: str = ..., *, key: str | None = None, timeout_s: float = ...
    ) -> None: ...

    @property
    def status(self) -> AsyncStatus: ...
    @property
    def machine(self) -> AsyncMachine: ...
    @property
    def emergency(self) -> AsyncEmergency: ...
    @property
    def console(self) -> AsyncConsole: ...
    @property
    def job(self) -> AsyncJob: ...
    @property
    def heaters(self) -> AsyncHeaters: ...
    @property
    def fans(self) -> AsyncFans: ...
    @property
    def history(self) -> AsyncHistory: ...
