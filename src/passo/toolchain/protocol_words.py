"""Descriptions of the firmware's commands, reports and reasons for a shutdown, for the reference
page."""

from __future__ import annotations

COMMANDS = {
    "Board": {
        "identify": "Asks for `count` bytes (at most 48) of the compressed dictionary.",
        "get_clock": "Asks for the clock.",
        "get_uptime": "Asks for the clock in 64 bits.",
        "get_config": "Asks whether the board is configured, and for its move slots.",
        "allocate_oids": "Begins a configuration with so many objects.",
        "finalize_config": "Ends it: the rest of the memory becomes the move queue.",
        "emergency_stop": "Shuts down.",
        "clear_shutdown": "Resumes work; queued commands are lost.",
        "reset": "Restarts the chip, unconfigured.",
        "get_counters": "Asks how the link fares.",
        "debug_nop": "Does nothing.",
        "debug_ping": "Asks for the same bytes back.",
    },
    "Motors": {
        "config_stepper": (
            "A motor. Each step is a pulse of at least `step_pulse_ticks`, from high to low if"
            " `invert_step` is not 0; steps at both edges are not known."
        ),
        "set_next_step_dir": "Level of the direction pin for the moves that follow.",
        "queue_step": (
            "A move of `count` steps, the first `interval` after the end of what is queued; each"
            " further interval is `add` longer than the one before. Takes a slot."
        ),
        "reset_step_clock": "The next move counts from this clock. Only while the motor rests.",
        "stepper_get_position": "Asks for steps forward less steps backward.",
        "stepper_stop_on_trigger": "The motor stops when the group is triggered.",
    },
    "Groups that stop together": {
        "config_trsync": "A group of motors that one event stops.",
        "trsync_start": "Arms it, with a report every `report_ticks`; 0: none.",
        "trsync_set_timeout": "Triggers it with `expire_reason` at this clock.",
        "trsync_trigger": "Triggers it now, and asks for its state.",
    },
    "Endstops": {
        "config_endstop": "A switch.",
        "endstop_home": (
            "Looks from `clock` on every `rest_ticks`. After `sample_count` looks, `sample_ticks`"
            " apart, that find `pin_value`, triggers the group. `sample_count` 0: looks no more."
        ),
        "endstop_query_state": "Asks for its state.",
    },
    "Outputs": {
        "config_digital_out": (
            "A pin. It takes its default after a shutdown; staying off it for `max_duration` ticks"
            " without news is one (0: for ever)."
        ),
        "set_digital_out_pwm_cycle": "The pin is switched by software, in cycles of this length.",
        "queue_digital_out": "At `clock`: on for so many ticks of each cycle. Takes a slot.",
        "update_digital_out": "On or off, now.",
        "set_digital_out": "Sets a pin that no object has.",
        "config_pwm_out": "The same for a pin that the chip's hardware pulses.",
        "queue_pwm_out": "At `clock`: this value, of `PWM_MAX`. Takes a slot.",
        "set_pwm_out": "Pulses a pin that no object has.",
    },
    "Sensors": {
        "config_analog_in": "An analog input.",
        "query_analog_in": (
            "From `clock` on every `rest_ticks` a sum of `sample_count` samples, told in reports of"
            " `bytes_per_report`. So many sums in a row out of range: a shutdown."
        ),
        "config_thermocouple": "A converter on an SPI device.",
        "query_thermocouple": "Reads it from `clock` on every `rest_ticks`; 0: stops. The board"
        " shuts down at the `max_invalid_count`-th value in a row that is a fault or out of range.",
        "config_adxl345": "An accelerometer on an SPI device.",
        "query_adxl345": "Empties its FIFO every `rest_ticks`; 0: stops.",
        "query_adxl345_status": "Asks for the number of samples so far, with the clock.",
        "config_lis2dw": (
            "The same for a LIS2DW, on an SPI or an I2C device. What it does not acknowledge on I2C"
            " is read again later."
        ),
        "query_lis2dw": "As `query_adxl345`.",
        "query_lis2dw_status": "As `query_adxl345_status`.",
        "config_buttons": "Up to eight inputs that the board reports when they change.",
        "buttons_add": "One of them.",
        "buttons_query": (
            "Samples from `clock` on; reports again after so many samples without an"
            " acknowledgement."
        ),
        "buttons_ack": "The number of states that have arrived.",
        "config_counter": "An input whose edges are counted: a tachometer.",
        "query_counter": (
            "Samples it from `clock` on every `poll_ticks`, and reports the count every"
            " `sample_ticks`; `poll_ticks` 0: stops."
        ),
    },
    "Buses and drivers": {
        "config_spi": "A device with a select pin.",
        "config_spi_without_cs": "A device without.",
        "spi_set_sw_bus": "Its pins and pace.",
        "spi_send": "Sends bytes.",
        "spi_transfer": "Sends bytes, and asks for those that come back.",
        "config_spi_shutdown": "Bytes that are sent to it at a shutdown.",
        "config_i2c": "A device.",
        "i2c_set_sw_bus": "Its pins, pace and address.",
        "i2c_transfer": "Writes bytes, then reads so many; asks for the result.",
        "config_tmcuart": "The one-wire line of Trinamic's drivers.",
        "tmcuart_send": "Sends a datagram, and asks for an answer of so many bytes.",
        "config_neopixel": (
            "A chain of lights on one wire, of at most 500 bytes. The line rests for at least"
            " `reset_min_ticks` before a frame."
        ),
        "neopixel_update": "Changes bytes of the next frame.",
        "neopixel_send": (
            "Sends a frame, and asks for the result. A bit that takes more than `bit_max_ticks`"
            " ends the frame; interrupts are off only during the pulse of each bit."
        ),
    },
    "Surviving a lost link": {
        "survive_arm": "On; the machine rests.",
        "survive_home": "On, while axes home: steps that come too late stop all motors.",
        "survive_off": "Off: a board as without the extension.",
        "survive_tail": "A move of the motor's brake tail, which waits for its commit.",
        "survive_commit": (
            "All moves and tails since the last commit hold, until `clock`; if nothing newer has"
            " come shortly before, the tails run. `rest`: the motors are at standstill then in any"
            " case."
        ),
        "survive_output": "What an output keeps, for so many seconds, if it is not renewed.",
        "survive_query": "Asks for the state.",
    },
}

# Shutdown reasons that only Klipper's firmware for the same chips has.
LACKING = {
    "invert_step=-1 of config_stepper, STEPPER_STEP_BOTH_EDGE": "Steps at both edges.",
    "spi_set_bus, i2c_set_bus": "Buses of the chip's hardware: they are made on any pins.",
    "i2c_read, i2c_write": "The older words for `i2c_transfer`, of images for older hosts.",
    "debug_read, debug_write": "Looks into the chip's memory, and changes of it.",
    "config_hd44780, config_st7920 and their further words": "Displays.",
    "config_mpu9250, config_hx71x and all other sensors with bulk data": (
        "Further accelerometers, load cells, eddy current probes, angles."
    ),
    "trigger_analog, sos_filter_set_section and the like": "Filters and triggers on such data.",
}

REPORTS = {
    "identify_response": "A part of the dictionary.",
    "starting": "The board has started; it has no configuration.",
    "clock": "The clock, 32 bits of it.",
    "uptime": "The clock, all of it.",
    "config": "Configured or not, with which sum; shut down or not; move slots.",
    "stats": "Rounds of the main loop in 5 s, their ticks, and the sum of the squares of these.",
    "counters": "Frames accepted, frames refused, and reports for which there was no space.",
    "pong": "The bytes of `debug_ping`.",
    "shutdown": "It has shut down at this clock, for this reason.",
    "is_shutdown": "It is shut down, and ignores commands.",
    "stepper_position": "Where a motor is, in steps.",
    "trsync_state": "Whether a group is still armed; if not, why, and when that was.",
    "endstop_state": "Whether it still looks, when next, and the level.",
    "analog_in_state": "Sums, low byte first, and when the next one is due.",
    "thermocouple_result": "What a converter said, and whether it sees a fault.",
    "sensor_bulk_data": "A block of samples of an accelerometer, numbered.",
    "sensor_bulk_status": "The next block's number, the bytes not sent yet, and the clock of this.",
    "counter_state": "The count, the clock of its last change, and when it is reported next.",
    "neopixel_result": "Whether the whole frame was sent in time.",
    "buttons_state": "The inputs as they changed, one byte each time.",
    "spi_transfer_response": "What came back.",
    "i2c_response": "The bytes that were read, or the reason why not.",
    "tmcuart_response": "What a driver said; nothing if it was silent.",
    "survive_state": "The state, and serial number and clock of the last commit that holds.",
}

SHUTDOWNS = {
    "EMERGENCY_STOP": "the host asked for it",
    "BAD_COMMAND": "a command that is unknown, cut short, or out of its type's range",
    "TIMER_TOO_CLOSE": "a command has arrived after its time",
    "OVERLOADED": "the chip does not keep up with its scheduled events",
    "OID_TAKEN": "an object's number is used twice, or was not allocated",
    "INVALID_OID": "no object of this kind has the number",
    "ARENA_FULL": "the objects do not fit the memory",
    "NOT_FINALIZED": "",
    "FINALIZED": "",
    "SLOTS_EXHAUSTED": "the host sent more moves than there are slots",
    "STEP_TOO_LATE": "a motor's first step has come after its time",
    "COUNT_ZERO": "a move of no step",
    "NEOPIXEL_SIZE": "a chain of lights has more than 500 bytes",
    "NEOPIXEL_PIN": "the pin of a chain of lights cannot be an output",
    "NEOPIXEL_UPDATE": "bytes after the end of a chain of lights",
    "STEPPER_ACTIVE": "",
    "STEPPER_PINS": "a pin cannot do it, a pulse would be longer than 30 µs, or there are too many"
    " motors that the image was not built for: with other pins, or with long pulses",
    "PERIOD_TOO_SHORT": "looks or reports that leave the chip no time",
    "INPUT_PIN": "",
    "OUTPUT_PIN": "",
    "PWM_PIN": "",
    "ADC_PIN": "",
    "PIN_CONFIGURED": "a command for a pin without object names one with",
    "OUTPUT_BUSY": "",
    "MISSED_DIGITAL": "an output was not renewed within its maximum duration",
    "MISSED_PWM": "the same for a pin that hardware pulses",
    "DURATION_TOO_LONG": "",
    "NOT_AT_DEFAULT": "",
    "ADC_RANGE": "a sensor is cut, short, or too hot",
    "ADC_SILENT": "the converter gives no value, so the heat would not be monitored",
    "THERMOCOUPLE_TYPE": "",
    "THERMOCOUPLE_RANGE": "a thermocouple is too hot or too cold",
    "THERMOCOUPLE_FAULT": "a thermocouple is cut or short, or its converter silent",
    "ACCELEROMETER_TYPE": "",
    "TOO_MANY_BUTTONS": "",
    "NO_SUCH_BUTTON": "",
    "SPI_PINS": "",
    "SPI_NO_BUS": "",
    "SPI_TOO_SLOW": "",
    "I2C_PINS": "",
    "I2C_NO_BUS": "",
    "I2C_TOO_SLOW": "",
    "I2C_TOO_LONG": "",
    "TMCUART_TOO_LONG": "",
    "TMCUART_PINS": "",
    "SURVIVE_TOO_LONG": "more than `SURVIVE_OUTPUT_S`",
    "SURVIVE_UNWATCHED": "no analog input with limits is being asked",
}

CONSTANTS = {
    "ADC_MAX": "what an analog input reads at full scale",
    "CLOCK_FREQ": "ticks of the clock a second",
    "MCU": "the chip",
    "PWM_MAX": "the value of a pulsed output that is fully on",
    "RECEIVE_WINDOW": "bytes that may be on their way to the board",
    "RESERVE_PINS_serial": "pins of the console",
    "SERIAL_BAUD": "of the console",
    "STATS_SUMSQ_BASE": "unit of the squares in `stats`",
    "SURVIVE": "version of the extension",
    "SURVIVE_GUARD_MS": "how long before a commit's clock the board decides whether to brake",
    "SURVIVE_OUTPUT_S": "how long an output may be kept at most",
}

ENUMERATIONS = {
    "bus_oid_type": "the bus of a LIS2DW",
    "i2c_bus_status": "how an I2C transfer ended",
    "lis_chip_type": "chips of this family",
    "survive": "the state of the extension",
    "thermocouple_type": "converters",
}
