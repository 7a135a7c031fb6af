"""Each command that Klipper's clients are told of, on a whole printer in virtual time."""

import asyncio
from contextlib import suppress

import passo
from passo.errors import PassoError
from passo.web.klippy.objects import PrinterObjects

# They end the printer or what follows on the console; other tests send them.
LEFT_OUT = {"M112", "M28", "M928", "M932", "EOF", "RESTART", "FIRMWARE_RESTART"}


def test_each_command_runs_or_reports_why_not(tmp_path):
    wrong: list[str] = []

    async def main():
        async with passo.Printer("i3", card=str(tmp_path)) as printer:
            bridge = printer._bridge
            known = PrinterObjects(bridge).lookup()("gcode")["commands"]
            assert {"G28", "PAUSE", "SAVE_GCODE_STATE", "SET_HEATER_TEMPERATURE"} <= known.keys()
            for code in sorted(known.keys() - LEFT_OUT):
                with suppress(PassoError, TimeoutError):  # a wait for the user is ended
                    await asyncio.wait_for(bridge.run(code), 2)
                if printer.status.halted:
                    wrong.append(f"{code}: {printer.status.halted}")
                    await bridge.restart()

    passo.run(main(), clock="virtual")
    assert wrong == []
