"""What a printer does when its filament ends, is stuck, or is inserted."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Coroutine
from typing import TYPE_CHECKING, Any, Literal

from passo.job.live.job_state import JobState

if TYPE_CHECKING:
    from passo.job.live.print_pause import PrintPause
    from passo.job.live.runner import Runner
    from passo.printer.background_gcode import BackgroundGcode
    from passo.printer.control import Control
    from passo.printer.inputs.filament_sensors import FilamentSensors, Sensor

_log = logging.getLogger(__name__)


class FilamentRunout:
    """Pauses the print of one printer when a sensor detects no filament, and runs the G-code of the
    sensor. A loss acts once, until the sensor has detected filament again: a print that is resumed
    without filament continues."""

    def __init__(
        self,
        control: Control,
        sensors: FilamentSensors,
        runner: Runner,
        pause: PrintPause,
        background: BackgroundGcode,
    ) -> None:
        self._control, self._sensors = control, sensors
        self._runner, self._pause, self._background = runner, pause, background
        self._loop = asyncio.get_running_loop()
        self._quiet_until_s: dict[str, float] = {}  # by sensor
        self._busy = set[str]()  # sensors whose events are being handled
        self._starts = False  # a print has just started
        self._printed = False  # a print was running at the last call
        if sensors.sensors:
            sensors.insert_listeners.append(self._inserted)
            runner.watchers.append(self._job_changed)
            control.lifetime.as_time_passes(self._time_passed)

    # -- when ---------------------------------------------------------------------------------

    def _job_changed(self, was: JobState, state: JobState) -> None:
        if state is not JobState.PRINTING:
            return
        self._starts = not was.active
        for sensor in self._sensors.sensors.values():
            if was.active and sensor.enabled and not (sensor.detected or sensor.acts):
                text = f"Filament sensor {sensor.name} detects no filament; the print continues"
                self._control.state.announce(_log, logging.WARNING, text)

    def _time_passed(self) -> None:
        state, prints = self._control.state, self._pause.prints
        was, self._printed = self._printed, prints
        if not prints or state.halted or state.host_paused:
            return
        if not was:
            self._sensors.compare_from_here()
        starts, self._starts = self._starts, False
        for sensor in self._sensors.lacking():
            if self._is_quiet(sensor) or not (starts or self._sensors.used_up(sensor)):
                continue
            if starts and sensor.config.on_runout == "none":
                continue
            sensor.acts = False
            self._begin(sensor, self._lost(sensor))

    def _is_quiet(self, sensor: Sensor) -> bool:
        quiet = self._loop.time() < self._quiet_until_s.get(sensor.name, 0.0)
        return quiet or sensor.name in self._busy

    # -- what ---------------------------------------------------------------------------------

    def _inserted(self, sensor: Sensor) -> None:
        busy = self._runner.state.prints or self._pause.prints
        if not sensor.enabled or busy or self._is_quiet(sensor):
            return
        text = f"Filament sensor {sensor.name}: filament is inserted"
        self._control.state.announce(_log, logging.INFO, text)
        self._begin(sensor, self._run(sensor, "insert_gcode"))

    async def _lost(self, sensor: Sensor) -> None:
        """Handles the loss of filament during a print."""
        stuck = " or is stuck" if sensor.moves else ""
        text = f"Filament sensor {sensor.name}: the filament has ended{stuck}"
        if sensor.config.on_runout == "pause":
            await self._pause.pause(text, "Load filament", self._words(sensor))
        else:
            self._control.state.announce(_log, logging.WARNING, text)
        await self._run(sensor, "runout_gcode")

    @staticmethod
    def _words(sensor: Sensor) -> dict[str, float]:
        """The words of M600 for this sensor."""
        words = {"U": sensor.config.unload_mm, "L": sensor.config.load_mm}
        return {letter: mm for letter, mm in words.items() if mm}

    async def _run(self, sensor: Sensor, key: Literal["insert_gcode", "runout_gcode"]) -> None:
        text: str = getattr(sensor.config, key)
        if text:
            await self._background.run(f"filament_sensors.{sensor.name}.{key}", text)

    def _begin(self, sensor: Sensor, work: Coroutine[Any, Any, None]) -> None:
        self._busy.add(sensor.name)
        self._background.spawn(self._to_its_end(sensor, work))

    async def _to_its_end(self, sensor: Sensor, work: Coroutine[Any, Any, None]) -> None:
        try:
            await work
        finally:
            self._busy.discard(sensor.name)
            self._quiet_until_s[sensor.name] = self._loop.time() + sensor.config.event_delay_s
