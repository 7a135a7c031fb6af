"""The Python client, made from the table of operations: make reference."""

import passo.printer.status
import passo.web.answers
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

class Client:
    """A printer that is served somewhere."""

    def __init__(
        self, url: str = ..., *, key: str | None = None, timeout_s: float = ...
    ) -> None: ...

    @property
    def status(self) -> Status: ...
    @property
    def heaters(self) -> Heaters: ...
    @property
    def fans(self) -> Fans: ...

class AsyncClient:
    """As `Client`, with calls to await."""

    def __init__(
        self, url: str = ..., *, key: str | None = None, timeout_s: float = ...
    ) -> None: ...

    @property
    def status(self) -> AsyncStatus: ...
    @property
    def heaters(self) -> AsyncHeaters: ...
    @property
    def fans(self) -> AsyncFans: ...
