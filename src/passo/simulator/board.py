"""The simulated board: built from descriptions, and observed by the names of its parts."""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

from passo import _core
from passo.board.description import (
    BoardDescription,
    I2cPins,
    SpiPins,
    UartPins,
    bare,
    inverted,
)
from passo.simulator.dictionary import (
    ADC_MAX,
    PWM_MAX,
    Firmware,
    compressed_dictionary,
    firmware_faults,
    firmware_library,
    pin_numbers,
)
from passo.simulator.plant import Area, BedProbe, PlantDescription
from passo.simulator.sensor_chips import SensorChip, sensor_chip

_FLICKERS = 2  # of `force_switch`
_ELSEWHERE = 1 << 16  # no board has so many pins
_UNHEATED = _ELSEWHERE - 1  # in place of the pin of a heater
_IDENTITY = [(0.0, 0.0), (1.0, 1.0)]  # a table whose temperature is the reading
_COIL = _ELSEWHERE - 2  # in place of the pin of a probe
_AIR_S = 1.0  # of a body without a heater


class SimulatedBoard:
    """A board with simulated mechanics and heat. A connection uses `device`; all other members only
    observe, or inject faults. Clocks are board ticks.

    The board is a model (`firmware` "virtual"), or runs Passo's firmware ("passo"); both behave the
    same to the tick.
    """

    def __init__(
        self,
        board: BoardDescription,
        plant: PlantDescription | None = None,
        start_clock: int = 0,
        firmware: Firmware = "virtual",
    ) -> None:
        plant = plant or PlantDescription()
        self.board = board
        self._pins = pin_numbers(board)
        self._elsewhere: dict[str, int] = {}
        self._steppers = {s.name: s for s in board.steppers}
        self._outputs = {o.name: self._pins[bare(o.pin)] for o in board.outputs}
        self._sensors = {s.name: self._pins[bare(s.pin)] for s in board.sensors}
        self.device: _core.Bench
        if firmware == "passo":
            self.device = self._firmware_board(start_clock)
        else:
            self.device = _core.VirtualBoard(
                clock_hz=float(board.clock_hz),
                move_count=board.move_count,
                adc_max=ADC_MAX,
                pwm_max=PWM_MAX,
                identify=compressed_dictionary(board),
                start=start_clock,
            )
        self._add_plant(plant)
        self.drivers = dict(self._add_drivers())
        self.stalls = dict(self._add_stalls(plant))
        self.converters = dict(self._add_converters())
        self.accelerometers = list(self._add_accelerometers())
        self.led_chips = dict(self._add_lights())
        self.sensor_chips = dict(self._add_sensor_chips())
        self.widths = {part.name: part for part in plant.widths}
        self.eddies = dict(self._add_eddies())
        self.digipots = [
            _core.add_digipot(self.device, *(self._pins[bare(pin)] for pin in setting.spi.pins))
            for setting in board.settings
        ]

    def _add_drivers(self) -> Iterator[tuple[str, _core.TrinamicChip]]:
        """The chips of the drivers with registers, by their motors."""
        for driver in self.board.drivers:
            kind = getattr(_core.TrinamicKind, driver.settings.chip)
            chip = _core.TrinamicChip(kind, driver.address)
            pins = [self._pins[bare(pin)] for pin in driver.wire.pins]
            if isinstance(driver.wire, UartPins):
                _core.add_uart_driver(self.device, pins[0], pins[-1], chip)
            else:
                select, clock, mosi, miso = pins
                _core.add_spi_driver(self.device, select, clock, mosi, miso, chip)
            yield driver.stepper, chip

    def _add_stalls(self, plant: PlantDescription) -> Iterator[tuple[str, _core.StallSensor]]:
        """The stall detections of the drivers, by their motors, and the stops of the travel."""
        for stop in plant.stops:
            weights = [(self._felt_pin(stepper), weight) for stepper, weight in stop.weights]
            _core.add_travel_stop(self.device, weights, stop.position, stop.at_maximum)
        for part in plant.stall_pins:
            pins = self._step_pin(part.stepper), self._pins[bare(part.pin)]
            chip = self.drivers[part.stepper]
            yield part.stepper, _core.add_stall_sensor(self.device, chip, *pins, part.output)

    def _add_converters(self) -> Iterator[tuple[str, _core.ConverterChip]]:
        """The converters of sensors, by their names."""
        for sensor in self.board.sensors:
            if sensor.spi is not None:
                select, clock, mosi, miso = (self._pins[bare(pin)] for pin in sensor.spi.pins)
                yield (
                    sensor.name,
                    _core.add_converter(self.device, select, clock, mosi, miso, sensor.converter),
                )

    def _add_accelerometers(self) -> Iterator[_core.AccelerometerChip]:
        kinds = _core.AccelerometerKind
        for part in self.board.accelerometers:
            kind = kinds.ADXL345 if part.chip == "adxl345" else kinds.LIS2DW
            pins = [self._pins[bare(pin)] for pin in part.wire.pins]
            hz = float(self.board.clock_hz)
            if isinstance(part.wire, I2cPins):
                clock, data = pins
                yield _core.add_i2c_accelerometer(
                    self.device, clock, data, part.wire.address, kind, hz
                )
            else:
                select, clock, mosi, miso = pins
                yield _core.add_accelerometer(self.device, select, clock, mosi, miso, kind, hz)

    def _add_eddies(self) -> Iterator[tuple[str, _core.Ldc1612Chip]]:
        """The eddy current sensors, by the names of their endstops."""
        for part in self.board.eddies:
            clock, data = (self._pins[bare(pin)] for pin in part.wire.pins)
            where = clock, data, part.wire.address, _COIL
            chip = _core.add_ldc1612(self.device, *where, float(self.board.clock_hz))
            if self._probe:
                chip.celsius, chip.curve = self._probe.coil_c, list(self._probe.curve)
            yield part.name, chip

    def _firmware_board(self, start_clock: int) -> _core.FirmwareBoard:
        device = _core.FirmwareBoard(
            str(firmware_library()),
            clock_hz=self.board.clock_hz,
            move_count=self.board.move_count,
            adc_max=ADC_MAX,
            identify=compressed_dictionary(self.board, firmware="passo"),
            start=start_clock,
            faults=firmware_faults(),
        )
        for s in self.board.steppers:
            device.add_motor(
                self._step_pin(s.name), self._pins[bare(s.dir_pin)], inverted(s.step_pin)
            )
        return device

    def _add_plant(self, plant: PlantDescription) -> None:
        self._per_unit = {a.stepper: a.steps_per_unit for a in plant.actuators}
        for a in plant.actuators:
            per_step = self._sign(a.stepper) / a.steps_per_unit
            self.device.add_actuator(self._step_pin(a.stepper), a.start, per_step)
        endstops = {e.name: e for e in self.board.endstops}
        for s in plant.switches:
            pin = endstops[s.endstop].pin
            self.device.add_switch(
                self._pins[bare(pin)],
                [(self._felt_pin(stepper), weight) for stepper, weight in s.weights],
                s.position,
                s.at_maximum,
                not inverted(pin),
            )
        self._inputs = {i.name: i for i in plant.inputs}
        pins = {i.name: i.pin for i in self.board.inputs}
        for part in plant.inputs:
            pin = pins[part.name]
            self.device.add_switch(
                self._pins[bare(pin)],
                [(self._felt_pin(stepper), weight) for stepper, weight in part.weights],
                part.position,
                True,
                part.active != inverted(pin),
                part.edge_mm,
            )
        self._probe = plant.probe
        if plant.probe:
            self._add_probe(plant.probe)
        for output in self.board.outputs:
            if inverted(output.pin):
                self.device.invert_output(self._pins[bare(output.pin)])
        heaters = {h.name: h for h in self.board.heaters}
        tables = {s.name: s.table for s in self.board.sensors}
        for b in plant.bodies:
            heater = heaters[b.heater]
            self.device.add_body(
                self._outputs[heater.output],
                self._sensors[heater.sensor],
                b.ambient_c,
                b.rise_c,
                b.time_constant_s,
                b.sensor_time_constant_s,
                list(tables[heater.sensor]),
                self._outputs[b.fan] if b.fan else 0,
                b.fan_loss if b.fan else 0.0,
            )

        for rotor in plant.rotors:
            self.device.add_rotor(
                *(self._outputs[rotor.fan], self._counter_pin(rotor.counter)),
                *(rotor.full_rpm / 60, rotor.time_constant_s, float(rotor.pulses)),
            )
        for air in plant.airs:
            self.device.add_body(
                *(_UNHEATED, self._sensors[air.sensor], air.ambient_c, 0.0, _AIR_S, _AIR_S),
                list(tables[air.sensor]),
            )
        for entry in self.board.analog_inputs:
            self.device.add_body(
                *(_UNHEATED, self._pins[bare(entry.pin)], entry.rest, 0.0, _AIR_S, _AIR_S),
                _IDENTITY,
            )

    def _add_probe(self, probe: BedProbe) -> None:
        pin = self._probe_pin(probe)
        self.device.add_probe(
            pin,
            [self._felt_pin(stepper) for stepper in probe.motors],
            dict(probe.geometry),
            probe.bed.shape,
            probe.offset_mm,
            probe.trigger_mm,
            pin == _COIL or not inverted(self._pin_of(probe.endstop)),
            probe.hysteresis_mm,
            probe.noise_mm,
            probe.seed,
            probe.dead_areas,
            probe.touchy_areas,
            self._mechanism(probe),
        )
        lifts = [(self._felt_pin(lift.stepper), lift.weight) for lift in probe.lifts]
        self.device.carry_probe(pin, lifts)
        if pin != _COIL:
            self.force_switch(probe.endstop, probe.forced)

    def _probe_pin(self, probe: BedProbe) -> int:
        eddies = (part.name for part in self.board.eddies)
        return _COIL if probe.endstop in eddies else self._pins[bare(self._pin_of(probe.endstop))]

    def _mechanism(self, probe: BedProbe) -> _core.ProbeMechanism:
        of, kinds = probe.mechanism, _core.ProbeMechanism
        pin = self._outputs[probe.control] if probe.control else 0
        if of.kind == "servo":
            made = kinds.servo(pin, of.deploy_us, of.stow_us, of.stowed_reads)
        elif of.kind == "bltouch":
            made = kinds.bltouch(pin)
        elif of.kind == "dock":
            made = kinds.dock(of.dock_mm, of.leave_mm)
        else:
            made = kinds.fixed()
        made.jammed = probe.jammed
        return made

    def _pin_of(self, endstop: str) -> str:
        return next(e.pin for e in self.board.endstops if e.name == endstop)

    def spoil_probe(
        self,
        *,
        dead_areas: Sequence[Area] = (),
        touchy_areas: Sequence[Area] = (),
        noise_mm: float = 0.0,
        jammed: bool = False,
    ) -> None:
        """Injects faults of the probe from now on. Raises KeyError if it is not on this board."""
        if self._probe is None:
            raise KeyError("no probe")
        pin = self._probe_pin(self._probe)
        self.device.change_probe(pin, dead_areas, touchy_areas, noise_mm, jammed)

    def tilt_bed(self, rise_mm: float) -> None:
        """A fault: the bed rises by `rise_mm` more over its width than its description says; 0 ends
        it. Raises KeyError if the probe is not on this board."""
        if self._probe is None:
            raise KeyError("no probe")
        x_mm, y_mm = self._probe.bed.tilt_mm
        pin = self._probe_pin(self._probe)
        bed = replace(self._probe.bed, tilt_mm=(x_mm + rise_mm, y_mm))
        self.device.change_bed(pin, bed.shape)

    def _felt_pin(self, stepper: str) -> int:
        """The step pin of a motor, or a special number for a motor on another board."""
        if stepper in self._steppers:
            return self._step_pin(stepper)
        return self._elsewhere.setdefault(stepper, _ELSEWHERE + len(self._elsewhere))

    def feel(self, others: Iterable[SimulatedBoard]) -> None:
        """Lets endstops of this board depend on the positions of motors of the others."""
        for stepper, pin in self._elsewhere.items():
            for other in others:
                if stepper in other._steppers:
                    self.device.feel(pin, other.device, other._step_pin(stepper))

    def net_steps(self, stepper: str) -> int:
        """Steps that the motor has executed so far, forward minus backward. Raises KeyError if the
        host has not configured the motor yet."""
        return self._sign(stepper) * self.device.net_steps(self._step_pin(stepper))

    def steps(self, stepper: str) -> int:
        """Number of steps executed so far, in both directions."""
        return self.device.steps(self._step_pin(stepper))

    def position(self, stepper: str) -> float:
        """The position of the stepper's actuator now, mm or degrees."""
        return self.device.position(self._step_pin(stepper))

    def place(self, stepper: str, position: float) -> None:
        """Moves the stepper's actuator to `position` (mm or degrees), as if by hand."""
        self.device.place(self._step_pin(stepper), position)

    def temperature(self, sensor: str) -> float:
        """Temperature of the body that the sensor belongs to, °C."""
        return self.device.temperature(self._sensors[sensor])

    def force_sensor(self, sensor: str, ratio: float | None) -> None:
        """A fault: the ADC reads this fraction of full scale at any temperature; None ends it."""
        self.device.force_adc(self._sensors[sensor], -1.0 if ratio is None else ratio)

    def force_switch(self, endstop: str, pressed: bool | None) -> None:
        """A fault: the endstop is triggered or open at any position; None ends it."""
        pin = self._pin_of(endstop)
        self.device.force_switch(self._pins[bare(pin)], -1 if pressed is None else int(pressed))

    def force_input(self, name: str, active: bool | None) -> None:
        """The input has this level, whatever is wired to it; None ends it. A range of an analog
        input is active while its reading is in the middle of the range."""
        for entry in self.board.analog_inputs:
            for other, low, high in entry.ranges:
                if other == name:
                    self.force_reading(entry.name, (low + high) / 2 if active else None)
                    return
        pressed = -1 if active is None else int(active == self._inputs[name].active)
        self.device.force_switch(self._input_pin(name), pressed)

    def force_reading(self, name: str, share: float | None) -> None:
        """The analog input has this reading, of full scale; None ends it."""
        pin = next(a.pin for a in self.board.analog_inputs if a.name == name)
        self.device.force_adc(self._pins[bare(pin)], -1.0 if share is None else share)

    def force_width(self, name: str, diameter_mm: float | None) -> None:
        """The filament in a width sensor has this diameter; None: the nominal one."""
        part = self.widths[name]
        share = None if diameter_mm is None else part.share(diameter_mm)
        for entry in part.inputs:
            self.force_reading(entry, share)

    def flicker(self, name: str) -> None:
        """A fault: the level of the input changes every 5 ms, until `force_input`."""
        self.device.force_switch(self._input_pin(name), _FLICKERS)

    def _input_pin(self, name: str) -> int:
        return self._pins[bare(next(i.pin for i in self.board.inputs if i.name == name))]

    def _add_lights(self) -> Iterator[tuple[str, _core.LedChip]]:
        """The chips that set LEDs, by the names of the lights."""
        for light in self.board.lights:
            if isinstance(light.wire, I2cPins):
                clock, data = (self._pins[bare(pin)] for pin in light.wire.pins)
                yield light.name, _core.add_led_chip(self.device, clock, data, light.wire.address)
            elif isinstance(light.wire, SpiPins):
                clock = self._pins[bare(light.wire.clock_pin)]
                self.device.add_lights(self._light_pin(light.name), clock, light.count)
            else:
                self.device.add_lights(self._light_pin(light.name))

    def _add_sensor_chips(self) -> Iterator[tuple[str, SensorChip]]:
        """The sensor chips on I2C, by the names of their sensors."""
        for sensor in self.board.i2c_sensors:
            chip = sensor_chip(sensor.kind, float(self.board.clock_hz))
            chip.celsius = sensor.ambient_c
            clock, data = (self._pins[bare(pin)] for pin in sensor.wire.pins)
            calls = chip.begin, chip.take, chip.give
            _core.add_i2c_chip(self.device, clock, data, sensor.wire.address, *calls)
            yield sensor.name, chip

    def _counter_pin(self, counter: str) -> int:
        return self._pins[bare(next(c.pin for c in self.board.counters if c.name == counter))]

    def force_rotor(self, counter: str, *, stalled: bool = False, silent: bool = False) -> None:
        """Faults: the rotor of a fan does not turn, or its tachometer gives no pulses."""
        self.device.force_rotor(self._counter_pin(counter), stalled, silent)

    def rotor_rpm(self, counter: str) -> float:
        """The revolutions per minute of a fan."""
        return 60 * self.device.rotor_hz(self._counter_pin(counter))

    def _light_pin(self, light: str) -> int:
        wire = next(one.wire for one in self.board.lights if one.name == light)
        assert not isinstance(wire, I2cPins)
        return self._pins[bare(wire.mosi_pin if isinstance(wire, SpiPins) else wire)]

    def light(self, light: str) -> bytes:
        """The bytes that a chain of lights shows; none before its first frame."""
        return self.device.lights(self._light_pin(light))

    def trace_light(self, light: str) -> None:
        """Records, from now on, the frames of a chain, for `take_light`."""
        self.device.trace_lights(self._light_pin(light))

    def take_light(self, light: str) -> list[tuple[int, bytes]]:
        """(clock, bytes) of each frame since the last call."""
        return self.device.take_lights(self._light_pin(light))

    def fail_light(self, light: str, frames: int) -> None:
        """A fault: the board cannot send so many of the next frames in time."""
        self.device.fail_lights(self._light_pin(light), frames)

    def force_heater(self, sensor: str, power: float | None) -> None:
        """A fault: the heater of this sensor has this power, 0 to 1, independent of its pin; None
        ends it."""
        self.device.force_heater(self._sensors[sensor], -1.0 if power is None else power)

    def add_noise(self, sensor: str, share: float) -> None:
        """A fault: the ADC has noise of up to this fraction of full scale; 0 ends it."""
        self.device.add_noise(self._sensors[sensor], share)

    def drop_sensor(self, sensor: str, fallen: bool = True) -> None:
        """A fault: the sensor is detached and has room temperature; False ends it."""
        self.device.drop_sensor(self._sensors[sensor], fallen)

    def trace_steps(self, stepper: str, from_clock: int, to_clock: int) -> None:
        """Records, from now on, the commands with steps in from_clock…to_clock, for
        `take_steps`."""
        self.device.trace_steps(self._step_pin(stepper), from_clock, to_clock)

    def take_steps(self, stepper: str, from_clock: int, to_clock: int) -> tuple[bytes, bytes]:
        """Clocks (int64) and directions (int8, +1 forward) of the traced steps executed since the
        last call and within from_clock ≤ clock < to_clock."""
        rows = self.device.take_steps(self._step_pin(stepper))
        sign = self._sign(stepper)
        return (
            _core.expand_steps(rows, from_clock, to_clock),
            _core.expand_directions(rows, from_clock, to_clock, sign),
        )

    def take_commands(self, stepper: str) -> list[tuple[int, int, int, int, int]]:
        """(start clock, interval, count, add, direction ±1) of the traced commands executed since
        the last call; the first step comes `interval` after the start."""
        rows = array("q", self.device.take_steps(self._step_pin(stepper)))
        sign = self._sign(stepper)
        return [
            (rows[i], rows[i + 1], rows[i + 2], rows[i + 3], sign * rows[i + 4])
            for i in range(0, len(rows), 5)
        ]

    def motor(self, stepper: str) -> tuple[_core.Bench, int, float]:
        """The core's board of a stepper, its step pin there, and how far a step moves its actuator,
        mm or degrees."""
        per_step = self._sign(stepper) / self._per_unit[stepper]
        return self.device, self._step_pin(stepper), per_step

    def trace_output(self, output: str) -> None:
        """Records, from now on, the changes of an output, for `take_changes`."""
        self.device.trace_output(self._outputs[output])

    def take_changes(self, output: str) -> list[tuple[int, int]]:
        """(clock, value) of each change since the last call."""
        return self.device.take_changes(self._outputs[output])

    def output_value(self, output: str) -> int:
        """The output's value now."""
        return self.device.output_value(self._outputs[output])

    def _step_pin(self, stepper: str) -> int:
        return self._pins[bare(self._steppers[stepper].step_pin)]

    def _sign(self, stepper: str) -> int:
        s = self._steppers[stepper]
        return -1 if s.invert != inverted(s.dir_pin) else 1
