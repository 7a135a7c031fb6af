"""
Native core of Passo: parse, plan, solve step times, compress, frame, virtual board.
"""

from collections.abc import Callable, Mapping, Sequence
import enum
from typing import Any


class HeatModel:
    """
    Thermal model of a heated mass and its sensor, each of first order. Units: °C, s. fan_loss is the fraction by which a fan at full speed increases the heat loss.
    """

    def __init__(self, rise_c: float, time_constant_s: float, sensor_lag_s: float, fan_loss: float = 0.0, ambient_c: float = 25.0) -> None: ...

    @property
    def rise_c(self) -> float: ...

    @property
    def time_constant_s(self) -> float: ...

    @property
    def sensor_lag_s(self) -> float: ...

    @property
    def fan_loss(self) -> float: ...

    @property
    def ambient_c(self) -> float: ...

    def __eq__(self, arg: HeatModel, /) -> bool: ...

class PidControl:
    """
    Gains in 1/255 of full power per °C, per °C·s and per °C/s, as in M301. drive_min and drive_max, fractions of full power, bound the integral. If the temperature is more than range_c from the target, the heater is fully on or off.
    """

    def __init__(self, kp: float, ki: float, kd: float, filter_s: float = 1.0, drive_min: float = 0.0, drive_max: float = 1.0, range_c: float = 10.0) -> None: ...

    @property
    def kp(self) -> float: ...

    @property
    def ki(self) -> float: ...

    @property
    def kd(self) -> float: ...

    @property
    def filter_s(self) -> float: ...

    @property
    def drive_min(self) -> float: ...

    @property
    def drive_max(self) -> float: ...

    @property
    def range_c(self) -> float: ...

    def __eq__(self, arg: PidControl, /) -> bool: ...

class OnOffControl:
    """
    Switches on when the temperature is below the target by the hysteresis, and off when it is above by the same. Two switchings are at least the interval apart.
    """

    def __init__(self, hysteresis_c: float = 1.0, interval_s: float = 0.0) -> None: ...

    @property
    def hysteresis_c(self) -> float: ...

    @property
    def interval_s(self) -> float: ...

    def __eq__(self, arg: OnOffControl, /) -> bool: ...

class ModelControl:
    """
    The power with which, according to the model, the temperature reaches the target within the horizon.
    """

    def __init__(self, model: HeatModel, horizon_s: float = 3.0) -> None: ...

    @property
    def model(self) -> HeatModel: ...

    @property
    def horizon_s(self) -> float: ...

    def __eq__(self, arg: ModelControl, /) -> bool: ...

class RelayControl:
    """Switches between two powers around the target, for autotuning."""

    def __init__(self, half_cycle_s: float = 5.0, band_c: float = 0.0) -> None:
        """
        It switches `band_c` above the target and as far below it, and not before the half cycle has passed.
        """

    @property
    def half_cycle_s(self) -> float: ...

    @property
    def band_c(self) -> float: ...

    def __eq__(self, arg: RelayControl, /) -> bool: ...

class FaultKind(enum.Enum):
    NONE = 0

    SENSOR_OPEN = 1

    SENSOR_SHORT = 2

    SENSOR_ERRATIC = 3

    MIN_TEMPERATURE = 4

    MAX_TEMPERATURE = 5

    HEATING_FAILED = 6

    RUNAWAY = 7

    STUCK_ON = 8

    MODEL_DEVIATION = 9

class HeatFault:
    """
    The fault, the reading of the sensor, the limit that was exceeded (°C; for a model deviation a fraction of power), and the board clock.
    """

    @property
    def kind(self) -> FaultKind: ...

    @property
    def celsius(self) -> float: ...

    @property
    def limit(self) -> float: ...

    @property
    def clock(self) -> int: ...

class ProtectionLimits:
    """
    The limits of a heater's protections. 0 switches a protection off, except min_c and max_c.
    """

    def __init__(self, min_c: float = 5.0, max_c: float = 280.0, jump_c: float = 10.0, watch_rise_c: float = 2.0, watch_s: float = 20.0, runaway_c: float = 4.0, runaway_s: float = 40.0, stuck_on_c: float = 10.0, stuck_on_s: float = 60.0, deviation: float = 0.25, deviation_s: float = 30.0) -> None: ...

    @property
    def min_c(self) -> float: ...

    @property
    def max_c(self) -> float: ...

    @property
    def jump_c(self) -> float: ...

    @property
    def watch_rise_c(self) -> float: ...

    @property
    def watch_s(self) -> float: ...

    @property
    def runaway_c(self) -> float: ...

    @property
    def runaway_s(self) -> float: ...

    @property
    def stuck_on_c(self) -> float: ...

    @property
    def stuck_on_s(self) -> float: ...

    @property
    def deviation(self) -> float: ...

    @property
    def deviation_s(self) -> float: ...

    def __eq__(self, arg: ProtectionLimits, /) -> bool: ...

class HeatTerms:
    """
    Error (°C) and fractions of full power. For a relay, p is the mean of its two powers, and d the difference of the present power from p.
    """

    def __init__(self, error: float = 0.0, p: float = 0.0, i: float = 0.0, d: float = 0.0, output: float = 0.0) -> None: ...

    @property
    def error(self) -> float: ...

    @property
    def p(self) -> float: ...

    @property
    def i(self) -> float: ...

    @property
    def d(self) -> float: ...

    @property
    def output(self) -> float: ...

class HeatSample:
    """One report of the sensor and the answer to it."""

    def __init__(self, clock: int, celsius: float, target: float, power: float, terms: HeatTerms) -> None: ...

    @property
    def clock(self) -> int: ...

    @property
    def celsius(self) -> float: ...

    @property
    def target(self) -> float: ...

    @property
    def power(self) -> float: ...

    @property
    def terms(self) -> HeatTerms: ...

class SensorQuery:
    """How the board samples a sensor; ticks and sums."""

    def __init__(self, sample_ticks: int, sample_count: int, rest_ticks: int, minimum: int, maximum: int, range_checks: int) -> None: ...

    @property
    def sample_ticks(self) -> int: ...

    @property
    def sample_count(self) -> int: ...

    @property
    def rest_ticks(self) -> int: ...

    @property
    def minimum(self) -> int: ...

    @property
    def maximum(self) -> int: ...

    @property
    def range_checks(self) -> int: ...

class Converter(enum.Enum):
    NONE = 0

    MAX31855 = 1

    MAX31856 = 2

    MAX31865 = 3

    MAX6675 = 4

class ConverterFault(enum.Enum):
    NONE = 0

    OPEN = 1

    SHORT_CIRCUIT = 2

    OUT_OF_RANGE = 3

    NO_ANSWER = 4

def read_converter(converter: Converter, word: int, faults: int = 0) -> tuple[float, ConverterFault]:
    """
    The reading of a converter: °C, or for a MAX31865 the fraction of its reference resistor; and its fault.
    """

def converter_full(converter: Converter) -> int:
    """Number of steps at full scale."""

def converter_share(converter: Converter, value: float) -> float:
    """The fraction of full scale for a reading of read_converter()."""

def converter_words(converter: Converter, low: float, high: float) -> tuple[int, int]:
    """The minimum and the maximum word between two fractions of full scale."""

class Arrival:
    """
    When a target is reached: after `seconds` within `window_c`. The time restarts if the temperature leaves `leaves_c`.
    """

    def __init__(self, window_c: float = 1.0, leaves_c: float = 3.0, seconds: float = 10.0) -> None: ...

    @property
    def window_c(self) -> float: ...

    @property
    def leaves_c(self) -> float: ...

    @property
    def seconds(self) -> float: ...

class HeaterOptions:
    def __init__(self, sensor_oid: int, output_oid: int, pwm: bool, full: int, adc_full: int, query: SensorQuery, longest_s: float, max_power: float, arrival: Arrival, celsius: Sequence[tuple[float, float]], low_share: float, high_share: float, open_is_high: bool, control: PidControl | OnOffControl | ModelControl | RelayControl, limits: ProtectionLimits, model: HeatModel | None, fan_target: int = -1, fan_full: float = 1.0, inverted: bool = False, converter: Converter = Converter.NONE, spi_oid: int = 0, clears_faults: bytes = ..., further: Sequence[tuple[int, bool]] = []) -> None:
        """
        longest_s: time after which the board switches the power off if it is not renewed.
        fan_target: index of the fan's output among the link's pins.
        further: oids of outputs that switch with the first one, and whether they are inverted.
        """

class Heater:
    """A heater loop that runs in the thread of the link."""

    @property
    def celsius(self) -> float: ...

    @property
    def fraction(self) -> float:
        """
        The sensor's last report as a fraction of the ADC's full scale; 0 before the first one.
        """

    @property
    def connected(self) -> bool:
        """The sensor has reported, and the link has not been lost since."""

    @property
    def reported(self) -> int | None:
        """Board clock of the sensor's last report; None before the first one."""

    @property
    def target(self) -> float: ...

    @target.setter
    def target(self, arg: float, /) -> None: ...

    @property
    def suspended(self) -> bool:
        """Nothing heats; the target is kept, and may change."""

    @suspended.setter
    def suspended(self, arg: bool, /) -> None: ...

    @property
    def power(self) -> float: ...

    @property
    def max_power(self) -> float: ...

    @property
    def reached(self) -> bool:
        """The heater has reached its target since the target was set."""

    @property
    def settled(self) -> bool:
        """The heater has been at its target for as long as `arrival` requires."""

    @property
    def arrival(self) -> Arrival: ...

    @property
    def terms(self) -> HeatTerms: ...

    @property
    def control(self) -> PidControl | OnOffControl | ModelControl | RelayControl: ...

    def set_control(self, control: PidControl | OnOffControl | ModelControl | RelayControl) -> None:
        """
        Sets the controller, which acts at once. The protections also use the model.
        """

    @property
    def model(self) -> HeatModel | None:
        """The thermal model that the protections use; None: they do without."""

    @model.setter
    def model(self, arg: HeatModel | None, /) -> None: ...

    @property
    def limits(self) -> ProtectionLimits: ...

    @limits.setter
    def limits(self, arg: ProtectionLimits, /) -> None: ...

    @property
    def fan(self) -> float:
        """Speed of the fan that cools this heater, 0 to 1, for its model."""

    @fan.setter
    def fan(self, arg: float, /) -> None: ...

    @property
    def fault(self) -> HeatFault | None:
        """
        The present fault, or None. During a fault the target is kept, but the heater is off.
        """

    def set_sensor(self, options: HeaterOptions) -> None:
        """
        Uses the table, the limits for a broken sensor and the query of these options, from the next report on.
        """

    def asked_anew(self) -> None:
        """
        The host has sent the query for the sensor's reports again, with the sensor's own range.
        """

    def rearm(self) -> None:
        """Clears the fault: the heater heats to the target that it has kept."""

    def take_samples(self) -> list[HeatSample]:
        """
        The samples since the last call, at most the newest 4096, oldest first.
        """

class HeatRun:
    """
    A heater loop and the heated mass, without a board. It predicts how long heating takes, as on a simulated printer.
    """

    def __init__(self, body: HeatModel, control: PidControl | OnOffControl | ModelControl | RelayControl, arrival: Arrival, max_power: float, limits: ProtectionLimits, model: HeatModel | None) -> None: ...

    def run(self, seconds: float) -> None:
        """Lets time pass."""

    def set_fan(self, speed: float) -> None:
        """Sets the speed of the fan that cools the heated mass, 0 to 1."""

    @property
    def heater(self) -> Heater: ...

def crc16(data: bytes) -> int:
    """CRC-16/MCRF4XX of the bytes."""

def encode_vlq(value: int) -> bytes:
    """Encodes a 32-bit value (modulo 2^32) in 1 to 5 bytes."""

def decode_vlq(data: bytes) -> tuple[int, int]:
    """Returns (signed value, bytes used). ValueError if cut short."""

def make_frame(payload: bytes, sequence: int) -> bytes: ...

def board_commands() -> list[tuple[int, str]]: ...

def board_reports() -> list[tuple[int, str]]: ...

def board_faults() -> list[str]:
    """Texts of the virtual board's shutdown reasons, by static_string_id."""

class FrameScanner:
    """Finds frames in a stream of bytes that may be split anywhere."""

    def __init__(self) -> None: ...

    def feed(self, data: bytes) -> list[tuple[int, bytes] | None]:
        """
        List with (sequence, payload) for each valid frame and None for each run of bytes that is not a frame.
        """

class Formats:
    """Messages of one direction, as a data dictionary declares them."""

    def __init__(self, formats: Sequence[tuple[int, str]]) -> None: ...

    def parameters(self, name: str) -> list[tuple[str, bool]]:
        """List of (parameter, is a blob). ValueError for an unknown message."""

    def names(self) -> list[str]: ...

    def encode(self, name: str, values: list[int | bytes]) -> bytes: ...

    def decode(self, payload: bytes) -> list[tuple[str, dict[str, int | bytes]]]:
        """
        List of (name, values) of a frame's payload. ValueError if it is malformed.
        """

class MessageKind(enum.Enum):
    QUEUE_STEP = 0

    SET_DIR = 1

    RESET_CLOCK = 2

    PIN = 3

    TAIL = 4

    COMMIT = 5

class MessageQueue:
    """Planned messages of one board, in the order in which they leave."""

    def __init__(self) -> None: ...

    def push(self, kind: MessageKind, target: int, clock: int, end_clock: int = 0, interval: int = 0, count: int = 0, add: int = 0, dir: bool = False) -> None: ...

    def clear(self) -> None: ...

    def __len__(self) -> int: ...

class PinKind(enum.Enum):
    DIGITAL = 0

    PWM = 1

class Cause(enum.Enum):
    """Why a frame did not arrive at the board earlier."""

    PLAN = 0
    """Its moves were planned late."""

    STALL = 1
    """The program did not run."""

    BYTES = 2
    """The link was saturated."""

    RETRANSMITS = 3
    """Bytes were lost."""

    SLOTS = 4
    """The board had no slot free."""

LATE_S: float = 0.06

class Slack:
    """
    The slack of a frame: how many ticks before the clock of its most urgent message it arrived; that clock; and what delayed the frame, and for how many ticks.
    """

    @property
    def known(self) -> bool: ...

    @property
    def slack(self) -> int: ...

    @property
    def clock(self) -> int: ...

    @property
    def held(self) -> int: ...

    @property
    def cause(self) -> Cause: ...

class Timeline:
    """The state that the links to the boards of one machine share."""

    def __init__(self) -> None: ...

    def arm(self, members: Sequence[tuple[int, int]], reason: int, expired: int, clock: float, patience: float, failed: int = 0) -> None:
        """
        These trsyncs, (number of the link, oid), trigger together: with `reason` when one has triggered, or with `expired` when one has not reported for `patience` ticks. Sixteen reasons from `failed` on, if it is not 0, are errors of a sensor.
        """

    def disarm(self) -> None: ...

    @property
    def halted(self) -> bool:
        """A board has stopped or is lost."""

class Link:
    """The host's end of the connection to a board; times in ticks."""

    def __init__(self, clock_hz: float) -> None: ...

    @property
    def hz(self) -> float: ...

    def set_dictionary(self, commands: Sequence[tuple[int, str]], reports: Sequence[tuple[int, str]], receive_window: int) -> None: ...

    def send(self, name: str, values: list[int | bytes]) -> None: ...

    def take_responses(self) -> list[tuple[str, dict[str, int | bytes]]]: ...

    def follow_clock(self, now: int) -> None: ...

    def set_byte_ticks(self, ticks: float) -> None:
        """Sets the ticks that a byte takes on a serial line."""

    @property
    def synchronous(self) -> bool: ...

    @property
    def lost(self) -> bool: ...

    @property
    def restarted(self) -> bool:
        """The board has restarted, after a reset or a power failure."""

    def clock_at(self, host_ticks: int) -> int: ...

    def host_at(self, clock: int) -> int: ...

    @property
    def clock_rate(self) -> float: ...

    def add_stepper(self, target: int, name: str, oid: int, invert: bool) -> None: ...

    def join(self, timeline: Timeline, main: bool, tolerance: float = 0.0) -> None:
        """
        The board is one of several: the main board, or a further one, which gets its steps in its own clock with `tolerance` more ticks.
        """

    @property
    def seat(self) -> int:
        """The number of this link among the links of the machine."""

    def own_clock(self, main_clock: int) -> int:
        """
        The clock of this board when the main board's clock reads `main_clock`.
        """

    def main_clock(self, own_clock: int) -> int: ...

    def set_apart(self, target: int, least: float, turning: float) -> None:
        """
        The minimum distance of a motor's steps in ticks: in one direction, and at a reversal.
        """

    def add_pin(self, target: int, name: str, oid: int, kind: PinKind, inverted_full: int = 0, longest: int = 0) -> None:
        """
        inverted_full: the value at full scale of a pin that is on when low. longest: ticks after which the board shuts down if the pin is on and not renewed; 0: it does not.
        """

    def set_kick(self, target: int, ticks: int, full: int, rise: int) -> None:
        """
        Kickstart: if the value of a pin rises from 0, or by more than `rise`, the pin is `full` for `ticks` first.
        """

    def set_slots(self, slots: int) -> None: ...

    def set_queue(self, queue: MessageQueue | None) -> None: ...

    def start_job(self, base_clock: int, main_hz: float) -> None:
        """
        Starts the job at this clock of the main board, whose clock frequency is `main_hz`.
        """

    @property
    def clock_jitter_s(self) -> float:
        """The usual delay of an answer beyond the fastest ones, in seconds."""

    def use_commits(self, horizon: int) -> None:
        """
        The job comes in commits, and its messages are sent `horizon` ticks ahead.
        """

    def begin_commits(self, on: bool) -> None:
        """
        Call it at standstill, after the command that arms the board (`on`) or disarms it. While the board is armed, motion comes in commits.
        """

    def reconnect(self) -> None:
        """
        The board has continued without this host: messages in transit are dropped, and the job is paused until resume().
        """

    @property
    def acknowledged(self) -> bool:
        """
        The board has all commands. Their immediate answers have been received, or are lost.
        """

    def unacknowledged_s(self, clock: int) -> float:
        """
        Age in seconds of the oldest message that the board has not acknowledged, when its clock reads `clock`; 0 if it has acknowledged all.
        """

    @property
    def delivered(self) -> bool:
        """The board has all messages of the job so far."""

    def resume(self) -> None: ...

    def stop_job(self) -> None: ...

    def add_heater(self, options: HeaterOptions) -> Heater: ...

    @property
    def shut_down(self) -> bool: ...

    @property
    def self_stopped(self) -> bool:
        """The board has stopped by itself."""

    @property
    def stopped_with_others(self) -> bool:
        """The board was shut down because another one of the machine had failed."""

    @property
    def shutdown_reason(self) -> int: ...

    def restart(self) -> None:
        """
        Call it when the board restarts: messages in transit are dropped, and its frame numbers are read again.
        """

    @property
    def wire_bytes(self) -> int: ...

    @property
    def frames(self) -> int: ...

    @property
    def retransmitted_bytes(self) -> int: ...

    def take_slack(self) -> Slack:
        """The minimum slack since the last call."""

    @property
    def min_slack(self) -> Slack: ...

    @property
    def late_frames(self) -> dict[Cause, int]:
        """
        The number of frames that arrived less than LATE_S before the board needed them, by cause.
        """

    @property
    def longest_stall(self) -> int:
        """The longest delay of a poll, in ticks."""

    @property
    def queue_steps(self) -> int: ...

    @property
    def messages(self) -> int: ...

    @property
    def stream_hash(self) -> int: ...

    def keep_record(self, bytes: int, parts: int) -> None:
        """
        Keeps the last bytes of both directions from now on. Both sizes are powers of two.
        """

    def recorded(self, since: int) -> list[tuple[int, int, bool, bytes]]:
        """
        The data sent and received since that host time, oldest first: host time, the board's clock (0 if not known), True if the board sent it, and the bytes.
        """

    def feed(self, data: bytes, now: int) -> None: ...

    def poll(self, now: int) -> tuple[bytes, int]:
        """(bytes to send, host time of the next call)"""

class Device:
    """The far end of a link, in virtual time."""

    def feed(self, data: bytes, now: int) -> None: ...

    def poll(self, now: int) -> bytes: ...

    @property
    def next_deadline(self) -> int: ...

    @property
    def stopped(self) -> bool: ...

class Bed:
    """A simulated bed that is not flat; lengths in mm."""

    def __init__(self, center: Sequence[float], size: Sequence[float], tilt: Sequence[float], dome: float, wave: float, wave_length: Sequence[float], lift: float) -> None:
        """Raises ValueError for a size or a wave length of 0."""

    def height(self, x: float, y: float) -> float:
        """Height of the bed at X, Y."""

class ProbeMechanism:
    """How a simulated probe is deployed."""

    @staticmethod
    def fixed() -> ProbeMechanism:
        """The probe is fixed to the head."""

    @staticmethod
    def servo(control_pin: int, deploy_us: float, stow_us: float, stowed_reads: bool) -> ProbeMechanism:
        """A servo turns the probe down."""

    @staticmethod
    def bltouch(control_pin: int) -> ProbeMechanism:
        """The pin of a BLTouch."""

    @staticmethod
    def dock(dock: Sequence[float], leave: Sequence[float]) -> ProbeMechanism:
        """
        The head picks the probe up with the nozzle at `dock`, and returns it on the path to `leave`.
        """

    @property
    def jammed(self) -> bool:
        """A fault: the probe never deploys."""

    @jammed.setter
    def jammed(self, arg: bool, /) -> None: ...

class Bench(Device):
    """
    A simulated board with the simulated printer around it; pins by number.
    """

    def add_actuator(self, step_pin: int, start: float, per_step: float) -> None: ...

    def add_switch(self, pin: int, weights: Sequence[tuple[int, float]], position: float, at_maximum: bool, pressed_level: bool, edge_mm: float = 0.0) -> None:
        """
        Adds a switch that is triggered at or beyond `position`, the weighted sum of the actuators: (step pin, weight). With `edge_mm`, its level changes instead each time the sum has moved by this length.
        """

    def add_probe(self, pin: int, motors: Sequence[int], geometry: dict[str, Any], bed: Bed, offset: Sequence[float], trigger: float, pressed_level: bool, hysteresis: float, sigma: float, seed: int, dead: Sequence[Sequence[float]], touchy: Sequence[Sequence[float]], mechanism: ProbeMechanism) -> None:
        """
        Adds a probe on the head, and the bed. `motors` are the step pins of the actuators.
        """

    def carry_probe(self, pin: int, lifts: Sequence[tuple[int, Sequence[float]]]) -> None:
        """
        Several motors carry the gantry with the probe: the step pin of each, and the coefficients c of its weight c · (1, x, y, x y) at X, Y of the nozzle.
        """

    def change_probe(self, pin: int, dead: Sequence[Sequence[float]], touchy: Sequence[Sequence[float]], sigma: float, jammed: bool) -> None:
        """Sets faults of a probe from now on."""

    def change_bed(self, pin: int, bed: Bed) -> None:
        """Changes the bed below a probe from now on."""

    def feel(self, step_pin: int, board: Bench, its_step_pin: int) -> None:
        """
        A motor on another board, which triggers the endstops of this board while that board exists.
        """

    def place(self, step_pin: int, position: float) -> None:
        """Moves the motor's actuator, as if by hand."""

    def force_switch(self, pin: int, pressed: int) -> None:
        """
        A fault: never triggered (0), always triggered (1), flickering (2); -1 ends it.
        """

    def add_body(self, heater_pin: int, sensor_pin: int, ambient_c: float, rise_c: float, time_constant_s: float, sensor_time_constant_s: float, adc_ratio: Sequence[tuple[float, float]], fan_pin: int = 0, fan_loss: float = 0.0) -> None: ...

    def invert_output(self, pin: int) -> None:
        """The device on this output pin is on when the pin is low."""

    def force_adc(self, sensor_pin: int, ratio: float) -> None:
        """A fault: the ADC reads this fraction of full scale; negative ends it."""

    def force_heater(self, sensor_pin: int, duty: float) -> None:
        """
        A fault: the heater has this power, 0 to 1, whatever the level of its pin; negative ends it.
        """

    def add_noise(self, sensor_pin: int, share: float) -> None:
        """
        A fault: readings of the ADC have errors of up to this fraction of full scale.
        """

    def drop_sensor(self, sensor_pin: int, fallen: bool) -> None:
        """
        A fault: the sensor measures the ambient temperature instead of the heated mass.
        """

    def temperature(self, sensor_pin: int) -> float: ...

    def add_rotor(self, fan_pin: int, tacho_pin: int, full_hz: float, time_constant_s: float, pulses: float) -> None:
        """
        Adds a fan with a tachometer: revolutions a second at full power, and pulses in a revolution.
        """

    def force_rotor(self, tacho_pin: int, stalled: bool, silent: bool) -> None:
        """Faults: the rotor does not turn; the tachometer gives no pulses."""

    def rotor_hz(self, tacho_pin: int) -> float:
        """Revolutions a second."""

    def add_lights(self, pin: int, clock_pin: int = -1, count: int = 0) -> None:
        """
        Adds a chain of lights on this data pin; one with a clock has so many LEDs.
        """

    def lights(self, pin: int) -> bytes:
        """The bytes that a chain shows; none before its first frame."""

    def trace_lights(self, pin: int) -> None: ...

    def take_lights(self, pin: int) -> list[tuple[int, bytes]]:
        """The frames since the last call: clock and bytes."""

    def fail_lights(self, pin: int, frames: int) -> None:
        """A fault: so many of the next frames are late."""

    def net_steps(self, step_pin: int) -> int: ...

    def steps(self, step_pin: int) -> int: ...

    def position(self, step_pin: int) -> float: ...

    def trace_steps(self, step_pin: int, from_clock: int, to_clock: int) -> None: ...

    def take_steps(self, step_pin: int) -> bytes:
        """
        Traced steps done so far, as int64 rows (start, interval, count, add, direction).
        """

    def output_value(self, pin: int) -> int: ...

    def trace_output(self, pin: int) -> None: ...

    def take_changes(self, pin: int) -> list[tuple[int, int]]:
        """List of (clock, value) since the last call."""

    @property
    def fault(self) -> str:
        """Why the board is shut down, or an empty string."""

    @property
    def frames(self) -> int: ...

    @property
    def naks(self) -> int: ...

    @property
    def now(self) -> int: ...

class VirtualBoard(Bench):
    """A complete board in virtual time; pins by number."""

    def __init__(self, clock_hz: float, move_count: int, adc_max: int, pwm_max: int, identify: bytes, start: int = 0) -> None: ...

    @property
    def peak_slots(self) -> int: ...

class FirmwareBoard(Bench):
    """A board that runs Passo's firmware, in virtual time."""

    def __init__(self, library: str, clock_hz: int, move_count: int, adc_max: int, identify: bytes, start: int, faults: Mapping[int, str]) -> None: ...

    def add_motor(self, step_pin: int, dir_pin: int, step_inverted: bool) -> None:
        """
        Adds a motor driver on these pins. Call it before the board moves the motor.
        """

    def trace_edges(self, pin: int) -> None: ...

    def take_edges(self, pin: int) -> list[tuple[int, int]]:
        """List of (clock, level) since the last call."""

class Distant(Device):
    """
    A device with an imperfect clock and cable. Its clock starts at `start` and is faster than host time by the fraction `drift`. Bytes need `latency` to `latency` + `jitter` ticks in each direction.
    """

    def __init__(self, device: Device, start: int = 0, drift: float = 0.0, latency: int = 0, jitter: int = 0, seed: int = 1) -> None: ...

    @property
    def now(self) -> int:
        """Host time."""

    def cut(self, on: bool) -> None:
        """While it is set, all bytes in both directions are lost."""

    def spoil(self, share: float, frames: float = 0.0) -> None:
        """
        Damages this fraction of all bytes in both directions (changed, lost, doubled or swapped), and this fraction of all frames (lost, doubled, swapped with the next, or late).
        """

    @property
    def spoilt_frames(self) -> list[int]:
        """
        The number of frames that were lost, doubled, swapped with the next, and late so far.
        """

    def clock_at(self, host_ticks: int) -> int: ...

    def host_at(self, clock: int) -> int: ...

def firmware_dictionary(library: str) -> bytes:
    """The dictionary that was built into a firmware library, compressed."""

def expand_steps(rows: bytes, from_clock: int, to_clock: int) -> bytes:
    """int64 clocks of all steps of take_steps() within from…to."""

def expand_directions(rows: bytes, from_clock: int, to_clock: int, sign: int) -> bytes:
    """int8 directions of the steps of expand_steps(), times sign (+1 or -1)."""

class NozzleGap:
    """
    The distance of the nozzle from the simulated bed in mm while a job extrudes in its first layer, from executed steps.
    """

    def __init__(self, clock_hz: float, geometry: dict, bed: Bed, motors: Sequence[tuple[Bench, int, float, float, float]], lifts: Sequence[tuple[int, Sequence[float]]]) -> None:
        """
        Records the steps of `motors` until the layer is over. The first motors are those of the actuators of the geometry, one each. Each entry has the board, the step pin, the mm or degrees per step, the main board's ticks per tick of the board, and the main board's clock when the board's clock is 0. `lifts` has, for each motor that carries the gantry, its index in `motors` and its weight as for carry_probe.
        """

    def begin(self, job: Job, base: float) -> None:
        """Call this when the job begins, with the clock of the main board."""

    def place(self, ticks: float, positions: Sequence[float]) -> None:
        """
        Sets the positions of the motors at this clock of the job, at standstill.
        """

    def follow(self, job: Job) -> bool:
        """
        Samples the motion that the boards have executed; False once the layer is over.
        """

    def end(self, job: Job) -> None:
        """Stops recording steps."""

    @property
    def samples(self) -> int: ...

    @property
    def mean(self) -> float: ...

    @property
    def lowest(self) -> tuple[float, float, float]:
        """The smallest distance, and X and Y there."""

    @property
    def highest(self) -> tuple[float, float, float]:
        """The largest distance, and X and Y there."""

    @property
    def cells(self) -> list[tuple[float, int]]:
        """
        The mean distance and the number of samples in each cell of the bed, in rows from the front.
        """

GAP_CELLS: int = 24

class BeltMass:
    """A mass on a belt that a motor moves in steps; exact between them."""

    def __init__(self, frequency_hz: float, damping: float) -> None:
        """
        `damping` is a fraction of the critical one. Raises ValueError outside of 0 to 1.
        """

    def run(self, seconds: float) -> None:
        """Lets time pass without a step."""

    def step(self, mm: float) -> None:
        """The motor moves, at once."""

    @property
    def deviation(self) -> float:
        """Position of the mass minus that of the motor, mm."""

    @property
    def velocity(self) -> float:
        """mm/s."""

    @property
    def acceleration(self) -> float:
        """mm/s²."""

    @property
    def ringing(self) -> float:
        """The amplitude of the vibration while the motor is at standstill, mm."""

class NozzlePressure:
    """
    A nozzle whose flow follows the extruder's speed as a first-order system; exact between steps.
    """

    def __init__(self, time_constant_s: float) -> None:
        """Raises ValueError for a time constant that is not above 0."""

    def run(self, seconds: float) -> None:
        """Lets time pass without a step."""

    def step(self, mm: float) -> None:
        """The extruder moves, at once."""

    @property
    def flow(self) -> float:
        """Filament that leaves the nozzle, mm/s."""

class HeadDynamics:
    """
    The real motion of the head of a simulated printer, and the flow of its nozzles, from executed steps alone. Clocks are those of the main board and do not decrease.
    """

    def __init__(self, clock_hz: float, geometry: dict, masses: Sequence[tuple[float, float]], nozzles: Sequence[float], motors: Sequence[tuple[Bench, int, float, float, float]]) -> None:
        """
        `masses` has the frequency in Hz and the damping ratio of X, Y and Z, `nozzles` the time constant in s of each extruder. `motors` are as for NozzleGap: first those of the actuators of the geometry, then those of the extruders.
        """

    @property
    def last_step(self) -> float:
        """The clock of the last step that was made."""

    def follow(self, on: bool) -> None:
        """
        Begins to follow the motors from their positions, all at rest; or ends it.
        """

    def place(self, clock: float, positions: Sequence[float]) -> None:
        """
        Sets the positions of the motors of the actuators at this clock, at standstill.
        """

    def run(self, clock: float) -> None:
        """Moves everything up to a clock that the boards have reached."""

    @property
    def motor_mm(self) -> list[float]:
        """Where the motors hold X, Y and Z."""

    @property
    def mm(self) -> list[float]:
        """Where X, Y and Z really are."""

    @property
    def ringing(self) -> list[float]:
        """
        The amplitudes of the vibration of X, Y and Z, mm, while the motors are at standstill.
        """

class PrintQuality:
    """
    Measures how the head of a simulated printer follows the path of a file, and how wide its lines are. Clocks are those of the main board.
    """

    def __init__(self, clock_hz: float, head: HeadDynamics) -> None: ...

    def begin(self, job: Job, clock: float) -> None:
        """Call this when the job begins, at standstill."""

    def run(self, job: Job, clock: float) -> None:
        """Measures up to a clock that the boards have reached."""

    def end(self, job: Job) -> None:
        """Call this at the end of the print."""

    def keep_path(self) -> None:
        """Keeps the path, for `StepRecording.measure`. Call it before `begin`."""

    def show(self, corner: int) -> None:
        """
        The corner of `shown`; without a call, the one with the largest ringing.
        """

    @property
    def shown(self) -> tuple[int, int, tuple[float, float], tuple[float, float], tuple[float, float], list[tuple[float, float, float, float, float, float, float]]]:
        """
        A corner: its number, its line in the file, X and Y, the directions of its lines in X and Y, and samples: seconds since the motors have passed it, X and Y of the head, X and Y of the motors, the head's deviation across its line in mm, the width of the line as a fraction.
        """

    @property
    def corners(self) -> int:
        """Number of sharp corners of printed lines."""

    @property
    def printed_mm(self) -> float: ...

    @property
    def ringing_mm(self) -> tuple[float, float]:
        """
        Deviation across the line for 0.1 s after corners: root mean square, and the largest.
        """

    @property
    def rounding_mm(self) -> tuple[float, float]:
        """Distance of the head's way from corners: mean and largest."""

    @property
    def off_path_mm(self) -> tuple[float, float]:
        """
        Distance of the head from printed lines: root mean square, and the largest.
        """

    @property
    def width_error(self) -> float:
        """Mean error of the width of printed lines, as a fraction."""

    @property
    def lost(self) -> float:
        """
        Fraction of the time in which the motors were more than 2 mm from the path.
        """

def actuator_ranges(quality: PrintQuality, geometry: dict[str, Any]) -> list[list[float]]:
    """
    For each actuator, on a path that was kept: first and last, lowest and highest position, mm or degrees.
    """

class StepRecording:
    """The steps of a recorded stream of commands for one board."""

    def __init__(self, commands: Formats, data: bytes) -> None:
        """Raises ValueError if `data` is not a stream of `commands`."""

    @property
    def motors(self) -> list[tuple[int, int]]:
        """
        The step pin and the number of steps of each motor, in the order of their configuration.
        """

    def range(self, motor: int, steps: int) -> tuple[int, int, int]:
        """
        Net steps, lowest and highest count within the last `steps` steps of a motor, from where these begin.
        """

    def measure(self, quality: PrintQuality, clock_hz: float, geometry: dict[str, Any], masses: Sequence[tuple[float, float]], nozzles: Sequence[float], motors: Sequence[tuple[int, int, float, float]], corner: int | None) -> tuple[PrintQuality, float, int]:
        """
        Plays the stream on a printer without boards, and measures it by the path that `quality` has kept. `motors` are those of the actuators and then those of the extruders: index, number of last steps that count, mm or degrees per step, position before these; an extruder counts from 1 s before the actuators on. Returns the measurement, the duration in s, and the number of commands.
        """

class Stop(enum.Enum):
    """Why time stopped passing."""

    TIME = 0

    SHUTDOWN = 1

    HEATERS = 2

    FAULT = 3

    CLOSED = 4

class Pump:
    """Runs links and devices in virtual time."""

    def __init__(self, link: Link, device: Device, start: int = 0) -> None: ...

    def attach(self, link: Link, device: Device) -> None:
        """
        Adds a further device, or another link to a device that is attached already.
        """

    @property
    def now(self) -> int: ...

    @property
    def hz(self) -> float:
        """Ticks per second of its clock."""

    def board_clock(self, link: Link) -> int:
        """The estimated clock of this link's board."""

    def sleep(self, until: int) -> None:
        """The host does nothing until that time; boards continue to run."""

    def stand_by(self, until: int) -> None:
        """Runs until that time, even if boards are shut down."""

    def cut(self) -> None:
        """Cuts the cables: no byte arrives any more."""

    @property
    def device_share(self) -> float:
        """
        The fraction of its processor time that the devices take, from a sample.
        """

    def record(self, on: bool) -> None: ...

    def take_recorded(self) -> bytes: ...

    def run(self, until: int, until_heaters: bool = False) -> Stop: ...

class LiveWire:
    """
    Runs a link over a file descriptor in real time, in a separate thread. Owns the file descriptor.
    """

    def __init__(self, link: Link, fd: int) -> None: ...

    @property
    def now(self) -> int: ...

    @property
    def failure(self) -> str:
        """
        The reason why the connection ended, if it was not the cable; otherwise empty.
        """

    @property
    def hz(self) -> float:
        """Ticks per second of its clock."""

    def board_clock(self, link: Link) -> int:
        """The estimated clock of the board."""

    def use_board_clock(self) -> None:
        """
        From here on `now` is the board's clock. Call it once the link is synchronous.
        """

    def join(self, timeline: Timeline) -> None:
        """
        The thread wakes whenever another link of the machine has a message for this one.
        """

    def stop(self) -> None:
        """Stops the thread: no more bytes are sent or received."""

    def run(self, until: int, until_heaters: bool = False) -> Stop: ...

class LiveBoard:
    """
    Connects a device to a file descriptor in real time, in a separate thread. Owns the file descriptor. Use the device only in `look`, or after `stop`.
    """

    def __init__(self, device: Device, fd: int, clock_hz: float, start: int = 0) -> None: ...

    def look(self, at: Callable) -> object:
        """Calls the function, which may use the device, and returns its result."""

    def stop(self) -> None: ...

class TrinamicKind(enum.Enum):
    TMC2208 = 0

    TMC2209 = 1

    TMC2225 = 2

    TMC2226 = 3

    TMC2130 = 4

    TMC5160 = 5

    TMC2240 = 6

    TMC2660 = 7

class TrinamicChip:
    """A simulated motor driver with registers."""

    def __init__(self, kind: TrinamicKind, address: int = 0) -> None: ...

    def read(self, register: int) -> int: ...

    def set(self, register: int, value: int) -> None:
        """Sets the status flags that the chip detects itself."""

    def set_after_read(self, register: int, value: int) -> None:
        """A register gets this value after the next time it is read."""

    def power_on(self) -> None:
        """Simulates a power failure: the chip loses its settings."""

    @property
    def plugged(self) -> bool: ...

    @plugged.setter
    def plugged(self, arg: bool, /) -> None: ...

    @property
    def damaged_answers(self) -> int:
        """This number of its next answers has a wrong bit."""

    @damaged_answers.setter
    def damaged_answers(self, arg: int, /) -> None: ...

def add_uart_driver(bench: Bench, rx_pin: int, tx_pin: int, chip: TrinamicChip) -> None:
    """
    Connects a driver to the UART on these pins. Several drivers may share them.
    """

def add_spi_driver(bench: Bench, select_pin: int, clock_pin: int, to_device: int, from_device: int, chip: TrinamicChip) -> None:
    """Connects a driver to the SPI bus on these pins."""

class StallSensor:
    """The stall detection of a simulated motor driver."""

    @property
    def result(self) -> int:
        """The load value; it falls as the load rises."""

    @property
    def stalls(self) -> int:
        """How often the DIAG pin has shown a stall."""

    @property
    def friction(self) -> float:
        """
        The load of free travel, as a fraction of the torque with full current.
        """

    @friction.setter
    def friction(self, arg: float, /) -> None: ...

    @property
    def noise(self) -> float:
        """The noise of the load value, as a fraction."""

    @noise.setter
    def noise(self, arg: float, /) -> None: ...

    @property
    def stuck(self) -> bool:
        """A fault: the pin shows a stall all the time."""

    @stuck.setter
    def stuck(self, arg: bool, /) -> None: ...

def add_stall_sensor(bench: Bench, chip: TrinamicChip, step_pin: int, diag_pin: int, output: int) -> StallSensor:
    """
    Connects a DIAG pin of a driver, DIAG0 or DIAG1, whose motor has its actuator already.
    """

def add_travel_stop(bench: Bench, weights: Sequence[tuple[int, float]], position: float, at_maximum: bool) -> None:
    """
    Adds a mechanical stop at the weighted sum of actuators: (step pin, weight).
    """

class Digipot:
    """A simulated digital potentiometer that sets motor currents."""

    def wiper(self, channel: int) -> int:
        """0 to 255."""

def add_digipot(bench: Bench, select_pin: int, clock_pin: int, to_device: int, from_device: int) -> Digipot:
    """Connects a digital potentiometer to the SPI bus on these pins."""

class ConverterChip:
    """A simulated thermocouple or RTD converter."""

    def setting(self, address: int) -> int:
        """
        A configuration register: of a MAX31856 the modes (0) and the thermocouple type (1), of a MAX31865 the modes (0).
        """

def add_converter(bench: Bench, select_pin: int, clock_pin: int, to_device: int, from_device: int, converter: Converter) -> ConverterChip:
    """
    Connects a converter to the SPI bus on these pins. It measures the heated mass whose sensor is on the select pin.
    """

class AccelerometerKind(enum.Enum):
    ADXL345 = 0

    LIS2DW = 1

class AccelerometerChip:
    """A simulated accelerometer."""

    def ride(self, head: HeadDynamics, ratio: float, offset: float) -> None:
        """
        The chip moves with this head, which follows its motors while the chip measures. `ratio` is the length of a tick of the chip's board in ticks of the main board, and `offset` the main board's clock when that of the chip's board is 0.
        """

    def put_down(self) -> None:
        """The chip lies still."""

    @property
    def plugged(self) -> bool: ...

    @plugged.setter
    def plugged(self, arg: bool, /) -> None: ...

    @property
    def nacks(self) -> int:
        """This number of its next addresses on I2C is not acknowledged."""

    @nacks.setter
    def nacks(self, arg: int, /) -> None: ...

    @property
    def rate_error(self) -> float:
        """The deviation of its sample rate, as a fraction."""

    @rate_error.setter
    def rate_error(self, arg: float, /) -> None: ...

def add_accelerometer(bench: Bench, select_pin: int, clock_pin: int, to_device: int, from_device: int, kind: AccelerometerKind, clock_hz: float) -> AccelerometerChip:
    """
    Connects an accelerometer, which lies still, to the SPI bus on these pins.
    """

class LedChip:
    """A simulated chip that sets LEDs."""

    def register(self, at: int) -> int:
        """The value of one of its 16 registers."""

def add_i2c_accelerometer(bench: Bench, clock_pin: int, data_pin: int, address: int, kind: AccelerometerKind, clock_hz: float) -> AccelerometerChip:
    """
    Connects an accelerometer, which lies still, to the I2C bus on these pins.
    """

class Ldc1612Chip:
    """A simulated LDC1612 with a coil above the bed."""

    def frequency(self, mm: float) -> float:
        """The frequency of the coil at a distance from the bed, Hz."""

    @property
    def plugged(self) -> bool: ...

    @plugged.setter
    def plugged(self, arg: bool, /) -> None: ...

    @property
    def open(self) -> bool:
        """The coil is broken."""

    @open.setter
    def open(self, arg: bool, /) -> None: ...

    @property
    def celsius(self) -> float:
        """The temperature of the coil."""

    @celsius.setter
    def celsius(self, arg: float, /) -> None: ...

    @property
    def noise_hz(self) -> float: ...

    @noise_hz.setter
    def noise_hz(self, arg: float, /) -> None: ...

    @property
    def curve(self) -> list[tuple[float, float]]:
        """Heights in mm, rising, and frequencies in Hz."""

    @curve.setter
    def curve(self, arg: Sequence[tuple[float, float]], /) -> None: ...

def add_ldc1612(bench: Bench, clock_pin: int, data_pin: int, address: int, probe_pin: int, clock_hz: float) -> Ldc1612Chip:
    """
    Connects an LDC1612 to the I2C bus on these pins. Its coil is the probe on `probe_pin`.
    """

def add_led_chip(bench: Bench, clock_pin: int, data_pin: int, address: int) -> LedChip:
    """Connects a chip that sets LEDs to the I2C bus on these pins."""

def add_i2c_chip(bench: Bench, clock_pin: int, data_pin: int, address: int, begin: Callable[[bool, int], bool], take: Callable[[int, int], bool], give: Callable[[int], int]) -> None:
    """
    Connects a chip in Python to the I2C bus on these pins. It is addressed by `begin`, for a write or, if True, for a read; it receives a byte by `take`; both return whether it acknowledges. It sends a byte by `give`. Each call has the clock.
    """

def sincos(x: float) -> tuple[float, float]: ...

def atan2(y: float, x: float) -> float: ...

class Geometry:
    """A geometry kernel: Cartesian mm to actuator mm or degrees, and back."""

    def __init__(self, spec: dict) -> None: ...

    @property
    def actuators(self) -> int: ...

    def inverse(self, actuator: int, point: tuple[float, float, float]) -> float:
        """Position of an actuator; NaN if it cannot reach the point."""

    def forward(self, positions: Sequence[float]) -> tuple[float, float, float]:
        """Nozzle position. Raises ValueError if no position fits."""

    def linear(self, actuator: int) -> tuple[float, float, float] | None:
        """
        The distance that an actuator moves per mm of X, Y and Z; None if it depends on the position.
        """

    def slopes(self, actuator: int, start: tuple[float, float, float], end: tuple[float, float, float], s: float) -> tuple[float, float]:
        """First and second derivative by path length at s mm."""

    def crossings(self, actuator: int, start: tuple[float, float, float], end: tuple[float, float, float], steps_per_unit: float) -> tuple[list[float], list[int]]:
        """
        Path positions and directions of all steps of a nonlinear actuator along a line.
        """

class Move:
    """
    A planned move: a line with a trapezoid of speed. Speeds are of the path measure.
    """

    @property
    def start_mm(self) -> tuple[float, float, float, float, float, float, float, float]:
        """X, Y, Z, E and further axes"""

    @property
    def end_mm(self) -> tuple[float, float, float, float, float, float, float, float]: ...

    @property
    def length(self) -> float:
        """path measure, usually mm"""

    @property
    def start_speed(self) -> float: ...

    @property
    def cruise_speed(self) -> float: ...

    @property
    def end_speed(self) -> float: ...

    @property
    def acceleration(self) -> float:
        """of the first phase, signed"""

    @property
    def deceleration(self) -> float:
        """of the last phase, positive"""

    @property
    def speed_cap(self) -> float: ...

    @property
    def advance_s(self) -> float:
        """pressure advance of its filament"""

    @property
    def advance_binds(self) -> bool:
        """
        The speed at its start is bound by what the advance asks of the extruder.
        """

    @property
    def start_cap(self) -> float:
        """junction's speed limit"""

    @property
    def accelerate_length(self) -> float: ...

    @property
    def cruise_length(self) -> float: ...

    @property
    def start_ticks(self) -> float: ...

    @property
    def accelerate_ticks(self) -> float: ...

    @property
    def cruise_ticks(self) -> float: ...

    @property
    def decelerate_ticks(self) -> float: ...

    @property
    def end_ticks(self) -> float: ...

    @property
    def line(self) -> int: ...

    @property
    def layer(self) -> int: ...

    @property
    def feature(self) -> int: ...

    @property
    def extruder(self) -> int: ...

    @property
    def inner(self) -> bool:
        """continues the path of the move before it"""

    @property
    def tolerance_ticks(self) -> float:
        """by which its steps may miss their ideal times; 0: the board's own"""

    @property
    def speed_limit(self) -> int:
        """index in the names of limits"""

    @property
    def accel_limit(self) -> int: ...

    @property
    def kind(self) -> str: ...

class Motion:
    """Plans moves, solves and compresses their steps. Not thread-safe."""

    def __init__(self, spec: dict, with_steps: bool = True) -> None: ...

    def push(self, target: Sequence[float], feed_mm_s: float, kind: str = 'travel', extruder: int = 0, duration_s: float = 0.0, radius_mm: float = float('inf'), inner: bool = False, line: int = 0, flow: float = 1.0) -> None:
        """
        Adds a move to the absolute target: one number for each axis, then E. `flow` is the factor that has scaled E; 0: E is never scaled. Raises ValueError.
        """

    def set_height_map(self, first: tuple[float, float], spacing: tuple[float, float], heights: Sequence[Sequence[float]], fade: tuple[float, float, float] | None = None) -> None:
        """
        Sets the bed correction: heights in mm on an even grid. Rows are along X; the first row is at the Y of `first`. Between the points the height is bilinear; beyond the grid it continues level. With a `fade` of start, end and target in mm, the correction acts in full up to Z start, and changes linearly to the target at Z end. Without rows the bed is flat. No motor moves, but Z of the plan changes. Call it only while nothing is queued. Raises ValueError.
        """

    def add_pieces(self, pieces: Sequence[tuple[float, Sequence[Sequence[float]]]], end: Sequence[float] | None = None, extruder: int = 0) -> None:
        """
        Adds motion that is planned already, after the moves pushed so far. Each piece has its duration in s and, for each axis, then E, up to six coefficients of a polynomial of time: mm, mm/s, mm/s^2 and so on. Pieces must join to 1e-6 mm. `end` is the exact end of the last piece; by default, the end of its polynomials. Raises ValueError.
        """

    def record(self, target: int, value: int) -> None:
        """A timed record, due when the moves pushed so far are done."""

    def set_position(self, position: Sequence[float]) -> None:
        """
        Sets the position of the machine, without motion. Call it only while nothing is queued.
        """

    def flush(self) -> None:
        """Settles all moves, for a stop at the end."""

    def wait_until(self, ticks: float) -> None: ...

    def replan_from(self, ticks: float) -> float:
        """
        Plans again from this clock on with the present limits. Returns the clock of the cut.
        """

    def shift_from(self, ticks: float, axis: int, mm: float) -> float:
        """
        Shifts all motion from this clock on by `mm` along an axis. Returns the clock of the cut.
        """

    def change_flow_from(self, ticks: float, flow: float, extruder: int = 0) -> float:
        """
        Changes the flow of an extruder after this clock. Returns the clock of the cut.
        """

    def skip_dwell_from(self, ticks: float) -> float | None:
        """
        Ends the dwell at this clock. Returns the clock of the cut, or None if there is no dwell.
        """

    def hold_from(self, ticks: float) -> float:
        """
        Brakes to a stop on the path from this clock on. Returns the clock of the cut.
        """

    def release(self) -> None:
        """Continues the moves that hold_from has stopped."""

    def use_commits(self, period: int, most: int) -> None:
        """
        From now on messages come in commits of at most this many ticks and messages. Call it only after flush().
        """

    def set_speed_factor(self, factor: float, live: bool = True) -> None:
        """
        M220: the speed factor of later moves; with `live`, also of moves that are planned again.
        """

    def set_accel(self, accel: float, live: bool = True) -> None: ...

    def set_advance(self, extruder: int, seconds: float) -> None:
        """Sets the pressure advance of later moves."""

    @property
    def clock(self) -> float:
        """End of the last settled move, ticks."""

    def take_moves(self) -> list[Move]:
        """Moves settled since the last call, in order."""

    def take_messages(self, before: float = float('inf')) -> list[tuple[str, int, int, int, int, int, int, int]]:
        """
        Takes (kind, target, clock, end_clock, interval, count, add, dir) of all messages due before a clock.
        """

    def counts(self) -> list[int]:
        """Step count of every motor after all solved moves."""

    def dropped_pairs(self, arg: int, /) -> int: ...

    def ideal_ticks(self, move: Move, stepper: int, count: int) -> tuple[list[float], int]:
        """Unrounded step times of one motor in one move, and its count after it."""

    def ideal_piece_ticks(self, seconds: float, coefficients: Sequence[Sequence[float]], stepper: int, count: int, extruder: int = 0) -> tuple[list[float], int]:
        """The same for one piece that starts at tick 0."""

class Fault(enum.Enum):
    NUMBER = 0

    RANGE = 1

    WORD = 2

    CHECKSUM = 5

    LINE_TOO_LONG = 6

    FEEDRATE = 7

    ARC = 8

    CENTRE = 9

    RADII = 10

    REPEATED = 3

    LETTER = 4

    OUT_OF_RANGE = 11

    MISSING_TOOL = 12

    NOT_HOMED = 13

    COLD = 14

    GARBAGE = 15

    UNSAVED = 16

    UNREACHABLE = 17

    ACTUATOR = 18

    TOO_LONG = 19

    TOO_SLOW = 20

    STRAY = 21

    UTF_16 = 22

    HOLE = 23

    AFTER_END = 24

    MISSING_WORD = 25

    CALL = 26

class CallFault(enum.IntEnum):
    """Why M98 or M99 cannot be carried out."""

    UNREADABLE = 1

    MISSING = 2

    NESTED = 3

    UNENDED = 4

    IDLE = 5

    NO_FILE = 6

def without_exponents(text: str) -> str:
    """
    The command of a line with decimal numbers instead of numbers with exponents, as a job on a machine with an E axis reads it.
    """

def split_text(text: str) -> list[tuple[str, float | None, str | None]]:
    """
    The words of a command's text, in order: the letter in upper case, or another character that begins no word; its number (NaN for `nan`) or None; the number as it is written, or the quoted text. Comments in parentheses are left out.
    """

def find_stray(text: str, any: bool) -> tuple[str, int]:
    """
    The first character of a command's text that is not G-code: the text around it, and its code (0 without one; below 0: a byte that is not UTF-8). Without `any`, only a character that changes the meaning of the text.
    """

class ObjectAction(enum.Enum):
    """The action of a command on the objects of a print."""

    COUNT = 0
    """There are so many."""

    DEFINE = 1
    """One of this name."""

    BEGIN = 2
    """What follows belongs to this one."""

    NAME = 3
    """Of the one that has begun."""

    END = 4
    """What follows belongs to none."""

    CANCEL = 5
    """This one, by number or name."""

    CANCEL_CURRENT = 6
    """The one that is printed."""

    RESTORE = 7
    """This one, by number or name."""

    RESTORE_ALL = 8

def object_orders(code: str, text: str) -> list[tuple[ObjectAction, int, str]]:
    """
    (action, number, name) of M486 or EXCLUDE_OBJECT…, from the text after the code. The number is -1 if the command names the object. Parts that cannot be read are left out.
    """

class Survey:
    """The commands of a program, found before it runs."""

    def __init__(self, spec: dict) -> None: ...

    def feed(self, data: bytes) -> None: ...

    def finish(self) -> None:
        """Ends the input."""

    @property
    def commands(self) -> list[tuple[int, str, int, int, str, str]]:
        """
        (line, letter, number, minor, name, text) of each command that is not a move, once for each code.
        """

    @property
    def bad_calls(self) -> list[tuple[int, str, CallFault]]:
        """
        (line, text, fault) of each M98 that cannot be carried out, once it is finished.
        """

    @property
    def moves(self) -> bool:
        """The program moves the machine."""

LOAD_MM_S: float = 6.0

UNLOAD_MM_S: float = 20.0

LONGEST_CHANGE_MM: float = 5000.0

class JobStatus(enum.Enum):
    NEED_INPUT = 0

    EVENT = 1

    MACRO = 2

    ERROR = 3

    FULL = 4

    END = 5

class Within(enum.Enum):
    """The limits of a move outside of any program."""

    LIMITS = 0
    """The machine's limits."""

    REACH = 1
    """What its actuators reach: it has been there."""

    ANYTHING = 2
    """Nothing: it does not know where it is."""

class Job:
    """Runs a G-code program on one machine. Not thread-safe."""

    def __init__(self, spec: dict, with_steps: bool = True, clamp: bool = False, ignore_tools: bool = False) -> None: ...

    def advance(self, horizon: float = float('inf'), most: int = 1048576, to_boundary: bool = False) -> JobStatus:
        """
        Reads and plans until the caller must act, or the plan reaches a clock or a number of messages; with `to_boundary`, only the rest of the current line.
        """

    def adopt(self, other: Job) -> None:
        """
        Takes over the state of a program that another job has read up to the position of this machine.
        """

    @property
    def messages(self) -> MessageQueue:
        """The messages of the main board."""

    def messages_of(self, board: int) -> MessageQueue:
        """The messages of a board, by number."""

    def feed(self, data: bytes) -> None:
        """Adds text to the selected source, in pieces of any length."""

    def finish(self) -> None:
        """Ends the input."""

    @property
    def event(self) -> tuple[int, str, int, int, str, str]:
        """
        (line, letter, number, minor, name, text) of the event or the macro that advance stopped at.
        """

    @property
    def error(self) -> tuple[int, Fault, str, float, float, tuple[float, float, float]]:
        """
        (line, fault, word, value, limit, point) of the error that advance stopped at.
        """

    def abandon(self) -> None:
        """
        After an error: drops the rest of the line and continues at the end of the plan.
        """

    @property
    def line(self) -> int:
        """The number of the line that was read last."""

    @property
    def tool(self) -> int:
        """The tool in use."""

    @property
    def clock(self) -> float:
        """End of the settled plan, ticks."""

    def flush(self) -> None:
        """Settles all moves, for a stop at the end."""

    @property
    def machine_position(self) -> list[float]:
        """
        End of the plan: X, Y, Z, E of the tool in use and further axes, in machine mm.
        """

    @property
    def program_position(self) -> list[float]:
        """The position of the program in its own coordinates: the axes, then E."""

    @property
    def locked_axes(self) -> list[int]:
        """The axes, by number, whose position is unknown."""

    @property
    def program(self) -> JobProgram:
        """
        The text that a job reads: the program's or a console's lines, and their macros.
        """

    @property
    def options(self) -> JobOptions:
        """How a job treats lines that the machine cannot carry out."""

    @property
    def modes(self) -> JobModes:
        """
        The modal state of the program: units, positioning, retraction, offsets of coordinates.
        """

    @property
    def objects(self) -> JobObjects:
        """The objects of the program, which can be cancelled one by one."""

    @property
    def plan(self) -> JobPlan:
        """
        The plan: moves from outside of the program, and changes after a clock.
        """

    @property
    def stops(self) -> JobStops:
        """Stops on the path, and the suspension of the rest of the plan."""

    @property
    def commits(self) -> JobCommits:
        """The commits of boards that stop by themselves when their link is lost."""

    @property
    def outputs(self) -> JobOutputs:
        """Timed events of outputs, of the laser and of the host."""

    @property
    def axes(self) -> JobAxes:
        """The positions of the axes, set without motion."""

    @property
    def history(self) -> JobHistory:
        """Lines and positions at a clock of about the last second."""

    @property
    def motors(self) -> JobMotors:
        """The motors, by their number in the machine."""

    @property
    def tools(self) -> JobTools:
        """The tools and their offsets."""

    @property
    def bed(self) -> JobBed:
        """The bed correction."""

    @property
    def filters(self) -> JobFilters:
        """The motion filters."""

    @property
    def filament(self) -> JobFilament:
        """What scales and limits the motion of filament."""

    @property
    def limits(self) -> JobLimits:
        """The limits of moves, and the speed factor."""

    @property
    def results(self) -> JobResults:
        """Records of the plan, and statistics."""

class JobProgram:
    """
    The text that a job reads: the program's or a console's lines, and their macros.
    """

    def select(self, console: bool) -> None:
        """
        Selects the console's lines or the program's. Call it only at a boundary between lines.
        """

    @property
    def at_boundary(self) -> bool:
        """The job is between two lines."""

    def restart(self, first_line: int = 1) -> None:
        """
        Drops the unread text of the selected source. Its next line has this number.
        """

    @property
    def offset(self) -> int:
        """Number of bytes of the selected source that were read."""

    def insert(self, text: bytes, code: str = '') -> None:
        """
        After MACRO: the lines that the call of the macro `code` becomes. They are read next, with the line number of the call, and then the rest of its line. While they run, also in macros that they call, the name of a macro that replaces a built-in command is that of the command.
        """

    def insert_apart(self, text: bytes) -> None:
        """
        In the middle of a command: lines that are read before the rest of its line. At their end, `advance` returns NEED_INPUT until `leave_apart`.
        """

    def leave_apart(self) -> None:
        """Drops what is left of the lines of `insert_apart`."""

    @property
    def commands(self) -> int:
        """The number of commands read, including unknown ones."""

    @property
    def layer(self) -> int:
        """The layer of the line that was read last; 0: before the first layer."""

    @property
    def macro_depth(self) -> int:
        """The nesting depth of the running macros of the selected source."""

    @property
    def subprogram_depth(self) -> int:
        """The nesting depth of the running sub-programs of the selected source."""

    def forget_macros(self) -> None:
        """Drops the unread lines of a console's macros."""

    def watch_line(self, line: int) -> None:
        """
        Records the commands of this line of the program, see `watched_line`. Call it before the line is read.
        """

    @property
    def watched_line(self) -> tuple[str, bool, list[tuple[str, list[str], str]]]:
        """
        (number, whether it had a checksum, [(code, words, text), …]) of the line given to watch_line. The code is empty for a move with the modal code of the last one. The text is what follows the code.
        """

    @property
    def ends_in_move(self) -> bool:
        """All text was read, and the last line is a move without an end of line."""

    def use_survey(self, survey: Survey) -> None:
        """
        Sets the sub-programs, the objects and the comments that mark layers for the next program.
        """

    @property
    def has_calls(self) -> bool:
        """The program has sub-programs."""

    def watch_height(self, low_mm: float, high_mm: float) -> None:
        """
        Before a move that prints below or above these heights, `advance` stops once at an event TUNING_TOWER with the height as its word Z. Infinite without a tower.
        """

    @property
    def feature_names(self) -> list[str]:
        """The kinds of lines that the comments of the file name."""

class JobOptions:
    """How a job treats lines that the machine cannot carry out."""

    @property
    def clamp(self) -> bool:
        """
        Targets out of range go to the limit, and moves that the machine cannot reach are left out. It concerns the lines that are read while it is set.
        """

    @clamp.setter
    def clamp(self, arg: bool, /) -> None: ...

    @property
    def clamped(self) -> list[tuple[tuple[int, Fault, str, float, float, tuple[float, float, float]], int]]:
        """
        The effects of `clamp`: for each axis, the first target that was moved to the limit, in the form of `error`, and the number of such targets; then the same for skipped moves.
        """

    @property
    def ignore_tools(self) -> bool:
        """Selecting a missing tool is an event, not an error."""

    @ignore_tools.setter
    def ignore_tools(self, arg: bool, /) -> None: ...

    @property
    def ignore_calls(self) -> bool:
        """M98 of a sub-program that is missing is an event, not an error."""

    @ignore_calls.setter
    def ignore_calls(self, arg: bool, /) -> None: ...

    @property
    def plain(self) -> bool:
        """
        While it is set, no macro is called: the replaced built-in commands run.
        """

    @plain.setter
    def plain(self, arg: bool, /) -> None: ...

class JobModes:
    """
    The modal state of the program: units, positioning, retraction, offsets of coordinates.
    """

    @property
    def now(self) -> tuple[bool, bool, float]:
        """
        (G90, M82, feedrate in mm/s): the modal state of the selected source. The feedrate is infinite until one is given.
        """

    @property
    def gcode(self) -> str:
        """
        G-code, one command a line, that sets tool, feedrate, plane, absolute or relative positions, and last the units.
        """

    @property
    def retraction(self) -> tuple[float, float, float, float, float, float, float]:
        """
        (mm, mm/s, hop mm, extra mm, mm/s back or 0, mm and extra mm of G10 S1) of M207 and M208.
        """

    @property
    def auto_retract(self) -> bool:
        """The state of M209: moves of E alone retract like G10."""

    def shift_zero(self, axis: int, mm: float) -> None:
        """
        Moves the program's zero (X, Y, Z) without motion: the next move of the axis carries it out.
        """

    def keep_offset(self, axis: int, mm: float) -> None:
        """
        Whenever the axis (X, Y, Z) homes, the program's zero is `mm` further from that of the axis. Calls add up. Now nothing changes.
        """

class JobObjects:
    """The objects of the program, which can be cancelled one by one."""

    @property
    def all(self) -> list[tuple[str, bool, str, str]]:
        """
        (name, cancelled, centre, outline) of each object of the program, by number. Centre and outline are as in the file, or empty.
        """

    @property
    def version(self) -> int:
        """
        A number that changes with each change of `all`, and with each program.
        """

    def of_line(self, line: int) -> int:
        """
        The object that a recent line of the main program belongs to; -1: none.
        """

    def find(self, name: str) -> list[int]:
        """Numbers of the objects of this name, in upper or lower case."""

    def cancel(self, number: int, cancelled: bool = True) -> None:
        """
        Skips the moves of the object that are read from now on, or no longer skips them.
        """

class JobPlan:
    """
    The plan: moves from outside of the program, and changes after a clock.
    """

    @property
    def queued(self) -> int:
        """Moves that are not settled."""

    @property
    def queued_ticks(self) -> float:
        """The minimum duration of these moves in ticks."""

    def move_to(self, target: Sequence[float], feed_mm_s: float, within: Within = Within.LIMITS) -> bool:
        """
        A straight move in machine coordinates (NaN: the axis does not move). If the move takes too long, or is not within the limits of `within`, returns False and changes nothing, see error.
        """

    def add_pieces(self, pieces: Sequence[tuple[float, Sequence[Sequence[float]]]], end: Sequence[float] | None = None) -> None:
        """
        Adds motion that is planned already, after the moves pushed so far. Each piece has its duration in s and, for each axis, then E, up to six coefficients of a polynomial of time: mm, mm/s, mm/s^2 and so on. Pieces must join to 1e-6 mm. `end` is the exact end of the last piece; by default, the end of its polynomials. Raises ValueError.
        """

    def wait_until(self, ticks: float) -> None:
        """The machine is idle until this clock. Call it only after flush."""

    def replan_from(self, ticks: float) -> float:
        """
        Plans again from this clock on with the present limits. Returns the clock of the cut.
        """

    def skip_dwell_from(self, ticks: float) -> float | None:
        """
        Ends the dwell at this clock. Returns the clock of the cut, or None if there is no dwell.
        """

    def shift_from(self, ticks: float, axis: int, mm: float) -> float | None:
        """
        Shifts all motion from this clock on by `mm` along an axis. Returns the clock of the cut, or None if an end would be out of range, see error.
        """

    def shift(self, axis: int, mm: float) -> bool:
        """
        Shifts all motion after the moves read so far. False if an end would be out of range, see error.
        """

    def absorb_shift(self, axis: int, mm: float) -> None:
        """
        Earlier shifts of `mm` are part of the height map or of the axis' zero from now on. Call it at standstill, after a call of `axes.set_position` or `bed.set_height_map`: no coordinate of the program changes, and suspended moves end where they did.
        """

    def passed(self, ticks: float) -> None:
        """
        Nothing before this clock will be planned again, for example because it has passed.
        """

    @property
    def rests(self) -> bool:
        """The settled plan ends at standstill, so queued moves may begin later."""

    @property
    def handed_out(self) -> int:
        """Clock of the last message, ticks."""

class JobStops:
    """Stops on the path, and the suspension of the rest of the plan."""

    def hold_from(self, ticks: float) -> float:
        """
        Brakes to a stop on the path from this clock on. Returns the clock of the cut.
        """

    @property
    def holds(self) -> bool:
        """Moves wait for `release`."""

    @property
    def held(self) -> int:
        """The number of moves that wait for `release`."""

    def release(self) -> None:
        """Continues the moves that hold_from has stopped."""

    def stop_from(self, ticks: float, program: bool = True) -> float:
        """
        Brakes to a stop from this clock on and drops later moves. Returns the clock of the cut.
        """

    def suspend(self, hand_over_macro: bool = False) -> None:
        """
        Call it after `hold_from`. Until `resume`, other moves are possible. With `hand_over_macro`, the rest of the macro that the program has called is read as if a console had called it.
        """

    @property
    def suspended(self) -> bool:
        """A plan is suspended."""

    def resume(self) -> None:
        """Resumes the suspended plan; the machine must be back at `position`."""

    def forget_suspended(self) -> None:
        """Drops the suspended plan."""

    @property
    def position(self) -> list[float]:
        """
        The position at which a suspended job resumes: X, Y, Z, E and further axes, in machine mm.
        """

class JobCommits:
    """The commits of boards that stop by themselves when their link is lost."""

    def use(self, period: int, most: int) -> None:
        """
        From now on messages come in commits of at most this many ticks and messages. Call it only while the machine is idle.
        """

    def stop(self) -> None:
        """
        From now on messages do not come in commits. Call it only at standstill.
        """

    def recover_from(self, serial: int) -> float | None:
        """
        The boards have stopped by themselves after this commit: the moves after it are held until `release`. Returns the clock of the commit. If the commit is not known any more, returns None and changes nothing.
        """

    def between_stops(self, serial: int, next: int) -> list[int] | None:
        """
        For each motor, the net steps from the stop after commit `serial` to the stop after the following commit `next`. None if the commits are not known, or not consecutive.
        """

class JobOutputs:
    """Timed events of outputs, of the laser and of the host."""

    def record(self, target: int, value: int) -> None:
        """
        A timed record for output `target`, due between the moves before and after.
        """

    def record_at(self, ticks: float, target: int, value: int) -> None:
        """
        A record for output `target` at this clock, independent of planned moves. It cannot be revoked.
        """

    def mark(self, target: int, value: int) -> None:
        """A timed record for the host itself, see next_mark."""

    @property
    def next_mark(self) -> tuple[int, int, int] | None:
        """
        (clock, target, value) of the earliest mark with a known clock, or None. If the plan is cut before a mark, its clock changes.
        """

    def pop_mark(self) -> None:
        """Removes the next mark, if there is one. The caller carries it out."""

    def set_laser(self, target: int, full: int) -> None:
        """This output is a laser, fully on at `full`."""

    def follow_speed(self, share: float) -> None:
        """
        The laser's fraction of full power at the feedrate of later moves. The power decreases in proportion where they are slower, and is 0 at standstill. 0: only records set the power.
        """

class JobAxes:
    """The positions of the axes, set without motion."""

    def settle(self) -> None:
        """
        After homing: ends the plan, and sets the position of the machine to that of the program.
        """

    def set(self, places: Sequence[tuple[int, float]], homed: bool = False, triggered: bool = False) -> None:
        """
        Sets the positions of these axes, by number, in mm, without motion. With `homed`, they are homed there. `triggered`: an endstop has found the positions, so the gap of the drives is taken up in the direction of the last steps.
        """

    def set_position(self, places: Sequence[tuple[int, float]]) -> None:
        """
        Sets the position of the machine (slots, machine mm), without motion. The program's offsets stay.
        """

    def lock(self, axis: int, locked: bool) -> None:
        """
        The position of a locked axis is unknown: its moves are errors until the position is set.
        """

    def use_joints(self, on: bool) -> None:
        """
        From now on X, Y and Z are the first three actuators of a nonlinear geometry, or the axes again. Call it only at standstill; `axes.set` must follow.
        """

    def set_geometry(self, spec: dict[str, Any]) -> None:
        """
        Changes the parameters of the machine's geometry. Call it only at standstill. No motor moves; `axes.set` must follow.
        """

class JobHistory:
    """Lines and positions at a clock of about the last second."""

    def line_at(self, ticks: float) -> int:
        """
        Line of the program's move at a clock, or of the last one before (0: none). The clock must not be before that of the last call.
        """

    def line_near(self, ticks: float) -> int:
        """
        As line_at, for any clock from a second before the last call of line_at on.
        """

    def layer_near(self, ticks: float) -> int:
        """
        The layer of the move that line_near means (0: before the first layer).
        """

    def position_at(self, ticks: float) -> list[float] | None:
        """
        The planned position at a clock of about the last second, as machine_position; None if the clock is too long ago.
        """

    def tool_at(self, ticks: float) -> int | None:
        """
        The tool of the move at a clock of about the last second, or else of the next one; None if no move follows.
        """

    def filament_at(self, ticks: float, extruder: int) -> float:
        """
        Net filament that an extruder has pushed until a clock of about the last second, mm, without pressure advance. It grows over the whole job, whatever G92 sets.
        """

class JobMotors:
    """The motors, by their number in the machine."""

    def set_steps_per_unit(self, stepper: int, value: float) -> None:
        """Changes the steps per unit of a motor. Call it only at standstill."""

    def leave_out(self, steppers: Sequence[int]) -> None:
        """
        These motors, by number, make no steps for later moves; all others do. Call it only at standstill. After moves without a motor, `axes.set` must follow.
        """

    def renew(self, steppers: Sequence[int]) -> None:
        """
        An endstop has stopped these motors: their clocks are sent again before the next step.
        """

    def statistics(self) -> list[dict[str, Any]]:
        """Totals of the steps of each motor by name."""

class JobTools:
    """The tools and their offsets."""

    def use(self, tool: int) -> None:
        """
        Selects this tool with its offset, as if the program had selected it. Nothing moves. Tool 0 is valid on a machine without tools, too.
        """

    def set_offset(self, tool: int, axis: int, mm: float) -> None:
        """M218: the offset of a tool along X, Y or Z."""

    @property
    def offsets(self) -> list[list[float]]:
        """The offsets of each tool in mm: X, Y, Z."""

    @property
    def offset_due(self) -> list[float]:
        """
        The additional distance in mm that the next move of an axis makes in X, Y and Z, because of a tool change or a changed tool offset.
        """

class JobBed:
    """The bed correction."""

    def set_height_map(self, first: tuple[float, float], spacing: tuple[float, float], heights: Sequence[Sequence[float]], fade: tuple[float, float, float] | None = None) -> None:
        """
        Sets the bed correction: heights in mm on an even grid. Rows are along X; the first row is at the Y of `first`. Between the points the height is bilinear; beyond the grid it continues level. With a `fade` of start, end and target in mm, the correction acts in full up to Z start, and changes linearly to the target at Z end. Without rows the bed is flat. No motor moves, but Z of the plan changes. Call it only while nothing is queued. Raises ValueError.
        """

    def follow_tool(self) -> None:
        """
        The correction of Z is that at the place of the tool in use, from standstill on; the next move goes to the Z that the program means.
        """

    @property
    def is_apart(self) -> bool:
        """Whether the correction of Z is that at the place of another tool."""

    def plan_z(self, x: float, y: float, height: float) -> float:
        """
        The Z of the plan, in mm, at which the corrected nozzle is at this height.
        """

    def nozzle_height(self, x: float, y: float, z: float) -> float:
        """The Z of the plan plus the bed correction there, in mm."""

class JobFilters:
    """The motion filters."""

    def set(self, name: str, index: int, numbers: Sequence[float]) -> None:
        """
        Changes a setting of a motion filter (core/machine/filters/) for one axis or extruder, 0 for a setting of the machine: its name and numbers, as in the machine's description, without brackets between them. Call it only at standstill.
        """

    def use(self, on: bool) -> None:
        """Switches all motion filters on or off. Call it only at standstill."""

    def set_advance(self, extruder: int, seconds: float) -> None:
        """Sets the pressure advance of later moves."""

    def advance(self, extruder: int) -> float:
        """The pressure advance of an extruder, s."""

    @property
    def delay_s(self) -> float:
        """The delay of all motors relative to the plan, s, in whole ticks."""

class JobFilament:
    """What scales and limits the motion of filament."""

    @property
    def cold(self) -> bool:
        """While it is set, moves of the tool's filament are errors."""

    @cold.setter
    def cold(self, arg: bool, /) -> None: ...

    def set_cold_axis(self, axis: int, cold: bool) -> None:
        """The same for an axis, by number, that moves filament."""

    @property
    def scale(self) -> float:
        """
        mm of filament of the tool in use for a mm, or mm3, of the program's E.
        """

    @property
    def flows(self) -> list[float]:
        """M221 of each extruder, as a factor."""

    def set_flow(self, extruder: int, flow: float) -> None:
        """M221, a factor above 0, for moves that are read from now on."""

    def scale_flow_from(self, ticks: float, extruder: int, flow: float) -> float:
        """
        M221, a factor above 0, for all moves after this clock, planned or not yet read. Returns the clock of the cut.
        """

    @property
    def width_factors(self) -> list[float]:
        """The factor of the measured width of each filament."""

    def scale_width_from(self, ticks: float, extruder: int, width: float) -> float:
        """
        The factor of the measured width of the filament, above 0, like scale_flow_from. The flow is the product of this factor and that of M221.
        """

    @property
    def diameters(self) -> list[float] | None:
        """
        The filament diameter of each extruder in mm if E is a volume (M200); otherwise None.
        """

    @property
    def changes(self) -> list[tuple[float, float]]:
        """The lengths in mm that M701 loads and M702 unloads, of each extruder."""

class JobLimits:
    """The limits of moves, and the speed factor."""

    def value(self, name: str) -> float:
        """The value of a limit, named as in `set`."""

    def set(self, name: str, value: float, live: bool = False) -> None:
        """
        Changes a limit for later moves; with `live`, also for moves that are planned again.
        """

    def of_axis(self, axis: str, what: str) -> float:
        """The `speed`, `accel` or `jerk` of an axis or extruder now."""

    def set_of_axis(self, axis: str, what: str, value: float, live: bool = False) -> None:
        """
        Changes the `speed`, `accel` or `jerk` of an axis like `set`, at most to the machine's own limit.
        """

    @property
    def names(self) -> list[str]:
        """The names of all limits of a move, in the order of their numbers."""

    @property
    def speed_factor(self) -> float:
        """M220, as a factor."""

    def set_speed_factor(self, factor: float, live: bool = False) -> None:
        """
        M220 for later moves; with `live`, also for moves that are planned again from now on.
        """

class JobResults:
    """Records of the plan, and statistics."""

    def keep_moves(self, on: bool) -> None:
        """With `on`, records the settled moves, see take_moves."""

    def take_moves(self) -> list[Move]:
        """Returns the moves settled since the last call, in order."""

    def keep_toolpath(self) -> None:
        """From now on records the path of all moves."""

    def take_toolpath(self) -> tuple[int, list[float], float, float, list[tuple[int, float, float, int]], bytes] | None:
        """
        Returns the recorded path in the format of toolpath.py, or None without one. Ends the recording.
        """

    def keep_corner(self) -> None:
        """
        From now on keeps the moves around the fastest corner of filtered motion.
        """

    @property
    def corner(self) -> tuple[int, float, float, float] | None:
        """
        That corner, at the end of the job: the line in the file of the move after it, X and Y in mm, and the print time in s at which the motors pass it. None if no motion was filtered.
        """

    def corner_law(self, slot: int, filtered: bool) -> list[tuple[float, float, float, float, float, float]]:
        """
        The position of X (0), Y (1) or E (3) around that corner, with the filters or as planned and then delayed like all motors: parts without gaps, each its start and duration in s, and at its start position, speed, acceleration and jerk in mm and s. The jerk of a part is constant.
        """

    def keep_ideal(self, on: bool) -> None:
        """From now on records the ideal time of every step, see take_ideal."""

    def take_ideal(self, stepper: int) -> bytes:
        """
        Ideal ticks (float64) of the steps made into commands since the last call.
        """

    def statistics(self) -> dict[str, Any]:
        """Totals of the plan by name."""

    def cpu(self) -> dict[str, float]:
        """Processor time in s of each part of the planning."""
