"""A simulated board spoken to frame by frame."""

from __future__ import annotations

from tests.oracles import wire
from tests.support.link_bench import PLANT, START, Kind, description

from passo import _core
from passo.board.dictionary import Dictionary
from passo.simulator import SimulatedBoard
from passo.simulator.dictionary import compressed_dictionary


class RawBoard:
    """Sends each command in a frame of its own; `tell` returns the reports that came back."""

    def __init__(self, move_count: int = 1024) -> None:
        self.simulated = SimulatedBoard(description(move_count), PLANT, START, Kind.firmware)
        self.device = self.simulated.device
        self.now = START
        self.sequence = 0
        self.compressed = compressed_dictionary(self.simulated.board, Kind.firmware)
        self.dictionary = Dictionary.parse(self.compressed)
        self.commands = _core.Formats(self.dictionary.commands)
        self.reports = _core.Formats(self.dictionary.reports)
        self.read()  # the firmware says that it is starting

    def feed(self, payload: bytes) -> list[tuple[str, dict]]:
        self.device.feed(wire.frame(payload, self.sequence), self.now)
        self.sequence += 1
        return self.read()

    def read(self) -> list[tuple[str, dict]]:
        frames = _core.FrameScanner().feed(self.device.poll(self.now))
        messages = [m for _, payload in frames for m in self.reports.decode(payload)]
        return [m for m in messages if m[0] != "stats"]

    def tell(self, text: str) -> list[tuple[str, dict]]:
        return self.feed(self.commands.encode(*self.dictionary.values(text)))

    def wait(self, ticks: int) -> list[tuple[str, dict]]:
        self.now += ticks
        return self.read()

    def clock(self, ticks: int) -> int:
        """The 32-bit clock so many ticks from now."""
        return self.now + ticks & 0xFFFFFFFF

    def configure(self) -> None:
        """oid 0 and 1 motors x and y, 2 fan (plain), 3 light (PWM), 4 sensor, 5 endstop, 6 trsync,
        7 heater (at most 2000 ticks on)."""
        for line in (
            "allocate_oids count=8",
            "config_stepper oid=0 step_pin=PF0 dir_pin=PF1 invert_step=0 step_pulse_ticks=32",
            "config_stepper oid=1 step_pin=PF6 dir_pin=PF7 invert_step=0 step_pulse_ticks=32",
            "config_digital_out oid=2 pin=PH6 value=0 default_value=0 max_duration=0",
            "config_pwm_out oid=3 pin=PH5 cycle_ticks=9 value=0 default_value=0 max_duration=0",
            "config_analog_in oid=4 pin=PK5",
            "config_endstop oid=5 pin=PE5 pull_up=1",
            "config_trsync oid=6",
            "config_digital_out oid=7 pin=PB4 value=0 default_value=0 max_duration=2000",
            "finalize_config crc=1",
        ):
            assert self.tell(line) == [], line
        for oid in (0, 1):
            self.tell(f"reset_step_clock oid={oid} clock={self.clock(0)}")
