"""The Python client, made from the table of operations: make reference."""

import builtins
import passo.job.live.runs
import passo.learn.explanation
import passo.learn.lesson
import passo.learn.views
import passo.printer.status
import passo.web.answers
import passo.web.bridge
import passo.web.endpoints.accounts
import passo.web.endpoints.calibration
import passo.web.endpoints.console
import passo.web.endpoints.files
import passo.web.endpoints.firmware
import passo.web.endpoints.history
import passo.web.endpoints.job
import passo.web.endpoints.logs
import passo.web.endpoints.machine
import passo.web.endpoints.machine_file
import passo.web.endpoints.pairing
import passo.web.endpoints.session
import passo.web.endpoints.status
import passo.web.files.metadata
import passo.web.firmware.builds
import passo.web.firmware.flashes
import passo.web.firmware.ports
import passo.web.machine.keys
import passo.web.summary
import typing

class RequestError(Exception):
    status: int
    fault: passo.web.answers.Fault
    def __init__(self, status: int, fault: passo.web.answers.Fault) -> None: ...

class Accounts:
    def list(
        self,
    ) -> builtins.list[passo.web.endpoints.accounts.AccountRecord]:
        """All accounts."""
        ...
    def add(
        self,
        name: str,
        password: str,
        role: typing.Literal['viewer', 'operator', 'admin'],
    ) -> passo.web.endpoints.accounts.AccountRecord:
        """Makes an account."""
        ...
    def change(
        self,
        name: str,
        password: str | None = ...,
        role: typing.Literal['viewer', 'operator', 'admin'] | None = ...,
    ) -> passo.web.endpoints.accounts.AccountRecord:
        """Changes the password or the role of an account, and ends its log-ins, except this
        one."""
        ...
    def remove(
        self,
        name: str,
    ) -> None:
        """Removes an account and ends its log-ins. One administrator stays."""
        ...

class Keys:
    def list(
        self,
    ) -> builtins.list[passo.web.endpoints.accounts.KeyRecord]:
        """All API keys, without their secrets."""
        ...
    def add(
        self,
        name: str,
        role: typing.Literal['viewer', 'operator', 'admin'] = ...,
    ) -> passo.web.endpoints.accounts.MadeKey:
        """Makes an API key for a slicer or a script, which sends it in the header `X-Api-
        Key`."""
        ...
    def revoke(
        self,
        id: str,
    ) -> None:
        """Makes a key invalid at once."""
        ...

class Calibration:
    def tune_heater(
        self,
        heater: str,
        celsius: float,
        method: typing.Literal['pid', 'model'] = ...,
    ) -> passo.web.endpoints.console.Answer:
        """Tunes a heater and applies the result (M303 with U1); `settings.store` stores it.
        This takes minutes; `console.end_wait` ends it. The heater is switched off before
        the answer."""
        ...
    def fit_thermistor(
        self,
        heater: str,
        readings: builtins.list[passo.web.endpoints.calibration.Reading],
    ) -> builtins.list[passo.web.endpoints.calibration.ThermistorFit]:
        """Fits the coefficients of a heater's thermistor to readings, by each method for
        which there are enough readings. The first entry is the current thermistor. Nothing
        is set."""
        ...
    def set_thermistor(
        self,
        heater: str,
        r25_ohm: float,
        beta_k: float,
        c_per_k: float = ...,
    ) -> None:
        """Sets the thermistor of a heater at once (M305), until `settings.store` stores
        it."""
        ...
    def measure_bed(
        self,
    ) -> passo.web.endpoints.console.Answer:
        """Homes all axes, measures the bed by the method of the machine file, and switches
        the correction on (G28, G29)."""
        ...
    def repeat_probe(
        self,
    ) -> passo.web.endpoints.console.Answer:
        """Homes all axes, and probes the bed ten times in one place (G28, M48)."""
        ...
    def level(
        self,
        procedure: typing.Literal['gantry', 'screws', 'delta'],
    ) -> passo.web.endpoints.console.Answer:
        """Homes all axes, and then levels the gantry by its motors (G34), reports how far
        to turn the bed screws (G35), or calibrates the geometry of a delta (G33).
        `calibration.bed` lists the procedures that the machine allows."""
        ...
    def measure_shaper(
        self,
        axis: typing.Literal['x', 'y', 'z'],
    ) -> passo.web.endpoints.console.Answer:
        """Homes all axes, vibrates an axis for about two minutes, chooses its input shaper,
        and uses it until `settings.store` stores it (G28, SHAPER_CALIBRATE). `machine.get`
        reports whether the machine has an accelerometer."""
        ...
    def find_stall(
        self,
        axis: str,
        repeats: float = ...,
    ) -> passo.web.endpoints.console.Answer:
        """Finds the threshold with which an axis homes by the stall of its motor, homes
        with it, and reports how exactly (STALL_CALIBRATE); `settings.store` stores it.
        Before, the axis must be in the middle of its travel. `machine.get` lists the axes
        that home by a stall."""
        ...
    def bed(
        self,
    ) -> passo.web.endpoints.calibration.BedMap:
        """The active map of the bed, or the last one that was measured."""
        ...

class Console:
    def run(
        self,
        script: str,
    ) -> passo.web.endpoints.console.Answer:
        """Executes lines of G-code, one after the other, and answers when the last line is
        done or planned. The first line that fails ends the script."""
        ...
    def end_wait(
        self,
    ) -> None:
        """Ends the current wait (M108): for a temperature, a calibration, or a measurement
        of the bed."""
        ...
    def history(
        self,
    ) -> builtins.list[passo.web.endpoints.console.Line]:
        """The last lines of all consoles, oldest first, without secrets."""
        ...
    def commands(
        self,
    ) -> builtins.list[passo.web.endpoints.console.Command]:
        """All commands of the printer."""
        ...

class Emergency:
    def stop(
        self,
    ) -> None:
        """Switches heaters, motors and fans off at once (M112). The print is lost, and axes
        are not homed any more."""
        ...
    def restart(
        self,
    ) -> None:
        """Restarts a halted printer (M999); answers when it runs."""
        ...

class Explain:
    def file(
        self,
        path: str,
        line: int,
    ) -> passo.learn.explanation.Explanation:
        """Explains a line of a file of the card, as `passo explain` shows it. A simulated
        board prints the file until the line is done, which takes seconds for a late line of
        a long file."""
        ...
    def line(
        self,
        line: str,
        before: str = ...,
        after: str = ...,
    ) -> passo.learn.explanation.Explanation:
        """Explains one line. All axes start at 0, before the lines of `before`. Nothing
        moves."""
        ...

class Fans:
    def list(
        self,
    ) -> dict[str, float]:
        """The last commanded speed of each fan, a fraction of full speed."""
        ...
    def set(
        self,
        name: str,
        speed: float,
    ) -> None:
        """Sets the speed of a fan at once. Fans that follow a heater or the boards cannot
        be set."""
        ...
    def set_target(
        self,
        name: str,
        celsius: float,
    ) -> None:
        """Sets the target of a fan with a thermostat (SET_TEMPERATURE_FAN_TARGET)."""
        ...

class Faults:
    def list(
        self,
    ) -> builtins.list[passo.printer.status.FaultStatus]:
        """Why the printer is halted, as errors of the catalogue; empty while it runs.
        `emergency.restart` starts it again."""
        ...

class Files:
    def list(
        self,
        folder: str = ...,
    ) -> passo.web.endpoints.files.Folder:
        """The files and folders in a folder of the card."""
        ...
    def metadata(
        self,
        path: str,
    ) -> passo.web.files.metadata.Metadata:
        """Facts about a file: slicer, objects, thumbnails, and the plan of this printer, as
        by `passo estimate`. Planning takes some seconds for a long file; until then `state`
        is `pending`."""
        ...
    def fits(
        self,
        path: str,
    ) -> passo.web.endpoints.files.FittingMachines:
        """Shipped machines that print a file, for one that this printer refuses. Planning
        takes some seconds for each, of a long file."""
        ...
    def toolpath(
        self,
        path: str,
    ) -> bytes:
        """The toolpath of a file, move by move, as this printer would print it; its format
        is in docs/reference/toolpath.md. The answer comes when the file is planned. A file
        that cannot be printed has no toolpath: `files.metadata` says why."""
        ...
    def thumbnail(
        self,
        path: str,
        number: int = ...,
    ) -> bytes:
        """A thumbnail of a file, as the slicer has made it: PNG, JPEG or QOI."""
        ...
    def download(
        self,
        path: str,
    ) -> bytes:
        """The bytes of a file, or the part that a `Range` header names."""
        ...
    def upload(
        self,
        data: bytes,
        path: str,
        sha256: str = ...,
    ) -> passo.web.endpoints.files.StoredFile:
        """Uploads a file to the card, and makes its folders. Once it is complete, it
        replaces a file of the same path. Characters that no name may have become `_`: the
        answer has the new path. If the connection is lost, the received bytes are kept for
        ten minutes: `files.kept` reports their number, and the client sends the rest with
        `Content-Range: bytes FIRST-LAST/TOTAL`. A client may send any file in such
        parts."""
        ...
    def kept(
        self,
        path: str,
    ) -> passo.web.endpoints.files.KeptUpload:
        """The offset from which an interrupted upload of a file continues."""
        ...
    def forget(
        self,
        path: str,
    ) -> None:
        """Discards an interrupted upload."""
        ...
    def remove(
        self,
        path: str,
    ) -> None:
        """Deletes a file, unless it is being printed."""
        ...
    def rename(
        self,
        path: str,
        to: str,
    ) -> None:
        """Renames or moves a file or folder, unless it is, or contains, the file that is
        being printed."""
        ...

class Folders:
    def make(
        self,
        path: str,
    ) -> None:
        """Makes a folder."""
        ...
    def remove(
        self,
        path: str,
    ) -> None:
        """Deletes an empty folder."""
        ...

class Firmware:
    def boards(
        self,
    ) -> passo.web.endpoints.firmware.Boards:
        """The boards of the machine, and all boards that come with Passo, with the steps
        that each needs."""
        ...
    def build(
        self,
        board: str | None = ...,
        text: str | None = ...,
    ) -> passo.web.firmware.builds.Build:
        """Starts a build of images in a separate process, one build at a time, while no
        board is being flashed. The feed sends each line of the log; `firmware.last` has the
        whole log."""
        ...
    def last(
        self,
    ) -> passo.web.firmware.builds.Build:
        """The current or the last build, with its log and the sizes of its images."""
        ...
    def cancel(
        self,
    ) -> None:
        """Ends the build that is running, if there is one."""
        ...
    def download(
        self,
    ) -> bytes:
        """The images of the last build with their descriptions (JSON) and its log, as one
        zip."""
        ...
    def ports(
        self,
    ) -> builtins.list[passo.web.firmware.ports.Port]:
        """The ports of the computer of the printer through which a board may be flashed."""
        ...
    def flash(
        self,
        image: str,
        port: str | None = ...,
    ) -> passo.web.firmware.flashes.Flash:
        """Starts to flash an image of the last build onto its board, in a separate process,
        one board at a time. `firmware.flashing` has the log, and the manual steps. If there
        are accounts, the password must have been entered within the last minutes."""
        ...
    def flashing(
        self,
    ) -> passo.web.firmware.flashes.Flash:
        """The board that is being flashed, or the last one, with the log."""
        ...
    def confirm(
        self,
    ) -> None:
        """Confirms that the manual step that `firmware.flashing` asks for is done."""
        ...
    def cancel_flash(
        self,
    ) -> None:
        """Cancels flashing while it waits for a manual step. Has no effect while the image
        is being written."""
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

class History:
    def temperatures(
        self,
        span_s: float = ...,
    ) -> passo.web.endpoints.history.Temperatures:
        """Temperatures, targets and power of all heaters, and other temperatures: one
        sample per second for the last 15 minutes, and one every 15 s for the day before."""
        ...

class Inputs:
    def enable_filament_sensor(
        self,
        name: str,
        enabled: bool,
    ) -> None:
        """Enables or disables a filament sensor (SET_FILAMENT_SENSOR)."""
        ...
    def endstops(
        self,
    ) -> dict[str, bool]:
        """Asks the boards whether each endstop is triggered."""
        ...

class Job:
    def start(
        self,
        path: str,
        allow: builtins.list[typing.Literal['unknown', 'levelling', 'clamp', 'ignore_tools']] = ...,
        run: str = ...,
    ) -> passo.web.endpoints.job.Started:
        """Prints a file of the card. With a run id it is printed at most once: the printer
        stores the run id before the print starts, and knows the last 100, also after a
        restart if it has a folder for them (`--state`)."""
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
    def cancel_object(
        self,
        number: int,
        cancelled: bool,
    ) -> None:
        """Cancels an object of the print, or prints it again. `number` is its number in the
        status."""
        ...
    def past(
        self,
        limit: int = ...,
    ) -> builtins.list[passo.web.bridge.PastPrint]:
        """The last finished prints, newest first."""
        ...

class Lessons:
    def list(
        self,
        language: typing.Literal['en', 'it'] = ...,
    ) -> passo.learn.views.CourseView:
        """The path of the course, and the calculators."""
        ...
    def get(
        self,
        name: str,
        language: typing.Literal['en', 'it'] = ...,
    ) -> passo.learn.views.LessonView:
        """A lesson: its texts with the numbers of its experiment, its questions, and the
        code that it explains."""
        ...
    def run(
        self,
        name: str,
        language: typing.Literal['en', 'it'] = ...,
        values: dict[str, float | str] = ...,
    ) -> passo.learn.views.OutcomeView:
        """Runs the experiment of a lesson with other values."""
        ...
    def check(
        self,
        name: str,
        question: int,
        answer: float,
        language: typing.Literal['en', 'it'] = ...,
    ) -> passo.learn.lesson.Checked:
        """Checks the answer to a question, which is counted from 0. The text explains the
        right answer, or is the hint for the mistake that leads to a wrong one."""
        ...

class Calculators:
    def get(
        self,
        name: str,
        language: typing.Literal['en', 'it'] = ...,
    ) -> passo.learn.views.ExperimentView:
        """A calculator with its parameters, and its outcome with their defaults."""
        ...
    def run(
        self,
        name: str,
        language: typing.Literal['en', 'it'] = ...,
        values: dict[str, float | str] = ...,
    ) -> passo.learn.views.OutcomeView:
        """Calculates with other values."""
        ...

class Lights:
    def set(
        self,
        name: str,
        red: float = ...,
        green: float = ...,
        blue: float = ...,
        white: float = ...,
        led: float | None = ...,
    ) -> None:
        """Sets the colour of a light after the planned moves (SET_LED). An effect or a
        template of the light stays visible."""
        ...

class Logs:
    def list(
        self,
    ) -> builtins.list[passo.web.endpoints.logs.LogRecord]:
        """The log (`--log`), and the reports of halts."""
        ...
    def get(
        self,
        name: str,
    ) -> bytes:
        """One of these files, without passwords and keys."""
        ...

class Machine:
    def get(
        self,
    ) -> passo.web.endpoints.machine.Machine:
        """The parts of the machine. They do not change while the machine is served."""
        ...
    def file(
        self,
    ) -> passo.web.endpoints.machine_file.MachineFile:
        """The current machine file, which may differ from the running machine."""
        ...
    def keys(
        self,
    ) -> builtins.list[passo.web.machine.keys.KeyValue]:
        """All keys of the machine file with their values, the source of each value, and the
        setting that overrides it. Secrets are not shown."""
        ...
    def schema(
        self,
    ) -> dict[str, typing.Any]:
        """The JSON schema of the machine file: type, range, default and help of each key,
        its unit as `x-unit`, and, as `x-acts`, whether a change takes effect `live` or
        after a `restart`."""
        ...
    def validate(
        self,
        text: str,
    ) -> passo.web.endpoints.machine_file.Validation:
        """Checks a text like `passo check`, and reports all problems at once."""
        ...
    def diff(
        self,
        text: str,
    ) -> passo.web.endpoints.machine_file.Difference:
        """Compares a text with the running machine, and with its file."""
        ...
    def apply(
        self,
        text: str,
        replaces: str,
    ) -> passo.web.endpoints.machine_file.Applied:
        """Writes the machine file, completely or not at all, if the text has no errors. A
        copy of the earlier file is kept as FILE.toml.bak. Changes that commands can make
        take effect at once; the answer names those that need a restart."""
        ...
    def save(
        self,
        text: str,
    ) -> passo.web.endpoints.machine_file.SavedMachine:
        """Saves a text as the user's file in place of the shipped machine that is served,
        if the text has no errors. From the next `machine.restart` on, and at each later
        start with the same `--machine` and `--state`, the printer is that of this file."""
        ...
    def restart(
        self,
    ) -> None:
        """Ends the printer, and restarts it with the current machine file, with heaters off
        and axes not homed. The command RESTART does the same; FIRMWARE_RESTART and M999 do
        not read the machine file. Consoles and this connection are closed; connect again
        after some seconds. Log-ins stay valid if the printer has a folder for them
        (`--state`)."""
        ...
    def library(
        self,
    ) -> builtins.list[passo.web.endpoints.machine_file.ShippedMachine]:
        """The machines that come with Passo."""
        ...
    def shipped(
        self,
        name: str,
    ) -> passo.web.endpoints.machine_file.ShippedFile:
        """The file of a machine that comes with Passo."""
        ...

class Motion:
    def jog(
        self,
        distances_mm: dict[str, float],
        speed_mm_s: float,
    ) -> None:
        """Moves axes by a distance, after the planned moves. Modes such as G91 and G20 stay
        as they are, and do not affect the distances. The answer comes when the move is
        planned."""
        ...
    def home(
        self,
        axes: builtins.list[str] = ...,
    ) -> None:
        """Homes axes; answers when they are homed."""
        ...
    def turn_motor(
        self,
        motor: str,
    ) -> None:
        """Turns a motor 1 mm forth and back, ten times (STEPPER_BUZZ); its axis need not be
        homed. Answers when the motor is back."""
        ...
    def wait(
        self,
    ) -> None:
        """Waits until all planned moves are done (M400)."""
        ...
    def motors_off(
        self,
    ) -> None:
        """Switches the motors off at standstill; axes are not homed any more."""
        ...

class Outputs:
    def set(
        self,
        name: str,
        value: float,
    ) -> None:
        """Sets an output after the planned moves (SET_PIN)."""
        ...

class Pairing:
    def make_code(
        self,
    ) -> passo.web.endpoints.pairing.MadeCode:
        """Makes a one-time code, with which one program can pair (`pairing.pair`) within
        ten minutes. An earlier code becomes invalid."""
        ...
    def pair(
        self,
        code: str,
        name: str,
    ) -> passo.web.endpoints.pairing.Paired:
        """Makes an API key for a program that has a one-time code."""
        ...

class Queue:
    def get(
        self,
    ) -> passo.printer.status.Queue:
        """The queued prints, the next one first. The queue survives a restart if the
        printer has a folder for it (`--state`)."""
        ...
    def add(
        self,
        path: str,
    ) -> passo.printer.status.QueuedPrint:
        """Adds a file of the card at the end of the queue."""
        ...
    def remove(
        self,
        number: int,
    ) -> None:
        """Removes a print from the queue."""
        ...
    def move(
        self,
        number: int,
        place: int,
    ) -> None:
        """Moves a print to another position: 0 is the next print; a position beyond the end
        is the last."""
        ...
    def mode(
        self,
        automatic: bool,
    ) -> None:
        """Sets whether the next print starts without confirmation, or waits for
        `queue.start` (the default)."""
        ...
    def start(
        self,
        bed_clear: bool,
    ) -> None:
        """Starts the next print, and removes it from the queue."""
        ...

class Runs:
    def get(
        self,
        run: str,
    ) -> passo.job.live.runs.Run:
        """The state of the print that was started with a run id (`job.start`)."""
        ...

class Servos:
    def set(
        self,
        name: str,
        degrees: float | None,
    ) -> None:
        """Turns a servo after the planned moves (SET_SERVO)."""
        ...

class Session:
    def get(
        self,
    ) -> passo.web.endpoints.session.Identity:
        """The identity of the caller, and whether there is an administrator."""
        ...
    def set_up(
        self,
        name: str,
        password: str,
        code: str = ...,
    ) -> passo.web.endpoints.session.Identity:
        """Creates the administrator, once, and logs in. From another computer, this needs
        the one-time code that `passo serve` prints."""
        ...
    def log_in(
        self,
        name: str,
        password: str,
    ) -> passo.web.endpoints.session.Identity:
        """Logs in: the answer sets a cookie."""
        ...
    def log_out(
        self,
    ) -> None:
        """Ends the log-in of the cookie."""
        ...
    def confirm(
        self,
        password: str,
    ) -> None:
        """Confirms the password, which allows operations that need it for the next five
        minutes."""
        ...
    def change_password(
        self,
        old: str,
        new: str,
    ) -> None:
        """Changes the password of the caller's account, and ends its other log-ins."""
        ...
    def list(
        self,
    ) -> builtins.list[passo.web.endpoints.session.LogInRecord]:
        """The caller's log-ins; for an administrator, those of all accounts."""
        ...
    def revoke(
        self,
        id: str,
    ) -> None:
        """Ends a log-in of the caller at once; an administrator can end any log-in."""
        ...

class Settings:
    def list(
        self,
    ) -> builtins.list[passo.web.bridge.SettingValue]:
        """All settings. `source` is the source of the active value: `file` (the machine
        file or its defaults), `stored` (M500), or `command` (changed since)."""
        ...
    def set(
        self,
        command: str,
        word: str,
        value: float | str,
    ) -> None:
        """Sets a value until the printer is restarted, or until `settings.store` stores
        it."""
        ...
    def store(
        self,
    ) -> None:
        """Stores the values that differ from the machine file (M500), durably."""
        ...
    def load(
        self,
    ) -> None:
        """Restores the stored values (M501)."""
        ...
    def reset(
        self,
    ) -> None:
        """Restores the values of the machine file (M502); stored values stay stored."""
        ...

class Simulation:
    def parts(
        self,
    ) -> builtins.list[passo.web.bridge.SimulatedPart]:
        """The parts of the simulated printer that can have faults; empty if the boards are
        real."""
        ...
    def set_fault(
        self,
        part: str,
        fault: str,
    ) -> None:
        """Gives a part of the simulated printer a fault, or ends it, even while the printer
        is halted (SIMULATE_FAULT)."""
        ...

class Status:
    def get(
        self,
    ) -> passo.web.endpoints.status.StatusNow:
        """The current status: state, positions, heaters, fans, the print, faults. The
        WebSocket `/api/v1/feed` reports its changes. Numbers that are not finite are
        null."""
        ...
    def version(
        self,
    ) -> passo.web.endpoints.status.Version:
        """The version of Passo, and the name of its machine."""
        ...
    def places(
        self,
    ) -> builtins.list[str]:
        """The addresses for hosts, browsers and Moonraker, each with its kind."""
        ...

class Summary:
    def get(
        self,
    ) -> passo.web.summary.Summary:
        """The printer at a glance, for a page over many printers. The WebSocket
        `/api/v1/summary/feed` sends it at each change."""
        ...

class Tuning:
    def set_speed(
        self,
        factor: float,
    ) -> None:
        """Scales the speed; during a print, also that of planned moves (M220)."""
        ...
    def set_flow(
        self,
        tool: int,
        factor: float,
    ) -> None:
        """Scales the extrusion of a tool; during a print, also that of planned moves
        (M221)."""
        ...
    def babystep(
        self,
        axis: str,
        distance_mm: float,
    ) -> None:
        """Shifts all remaining moves along an axis, at once (M290)."""
        ...

class AsyncAccounts:
    async def list(
        self,
    ) -> builtins.list[passo.web.endpoints.accounts.AccountRecord]:
        """All accounts."""
        ...
    async def add(
        self,
        name: str,
        password: str,
        role: typing.Literal['viewer', 'operator', 'admin'],
    ) -> passo.web.endpoints.accounts.AccountRecord:
        """Makes an account."""
        ...
    async def change(
        self,
        name: str,
        password: str | None = ...,
        role: typing.Literal['viewer', 'operator', 'admin'] | None = ...,
    ) -> passo.web.endpoints.accounts.AccountRecord:
        """Changes the password or the role of an account, and ends its log-ins, except this
        one."""
        ...
    async def remove(
        self,
        name: str,
    ) -> None:
        """Removes an account and ends its log-ins. One administrator stays."""
        ...

class AsyncKeys:
    async def list(
        self,
    ) -> builtins.list[passo.web.endpoints.accounts.KeyRecord]:
        """All API keys, without their secrets."""
        ...
    async def add(
        self,
        name: str,
        role: typing.Literal['viewer', 'operator', 'admin'] = ...,
    ) -> passo.web.endpoints.accounts.MadeKey:
        """Makes an API key for a slicer or a script, which sends it in the header `X-Api-
        Key`."""
        ...
    async def revoke(
        self,
        id: str,
    ) -> None:
        """Makes a key invalid at once."""
        ...

class AsyncCalibration:
    async def tune_heater(
        self,
        heater: str,
        celsius: float,
        method: typing.Literal['pid', 'model'] = ...,
    ) -> passo.web.endpoints.console.Answer:
        """Tunes a heater and applies the result (M303 with U1); `settings.store` stores it.
        This takes minutes; `console.end_wait` ends it. The heater is switched off before
        the answer."""
        ...
    async def fit_thermistor(
        self,
        heater: str,
        readings: builtins.list[passo.web.endpoints.calibration.Reading],
    ) -> builtins.list[passo.web.endpoints.calibration.ThermistorFit]:
        """Fits the coefficients of a heater's thermistor to readings, by each method for
        which there are enough readings. The first entry is the current thermistor. Nothing
        is set."""
        ...
    async def set_thermistor(
        self,
        heater: str,
        r25_ohm: float,
        beta_k: float,
        c_per_k: float = ...,
    ) -> None:
        """Sets the thermistor of a heater at once (M305), until `settings.store` stores
        it."""
        ...
    async def measure_bed(
        self,
    ) -> passo.web.endpoints.console.Answer:
        """Homes all axes, measures the bed by the method of the machine file, and switches
        the correction on (G28, G29)."""
        ...
    async def repeat_probe(
        self,
    ) -> passo.web.endpoints.console.Answer:
        """Homes all axes, and probes the bed ten times in one place (G28, M48)."""
        ...
    async def level(
        self,
        procedure: typing.Literal['gantry', 'screws', 'delta'],
    ) -> passo.web.endpoints.console.Answer:
        """Homes all axes, and then levels the gantry by its motors (G34), reports how far
        to turn the bed screws (G35), or calibrates the geometry of a delta (G33).
        `calibration.bed` lists the procedures that the machine allows."""
        ...
    async def measure_shaper(
        self,
        axis: typing.Literal['x', 'y', 'z'],
    ) -> passo.web.endpoints.console.Answer:
        """Homes all axes, vibrates an axis for about two minutes, chooses its input shaper,
        and uses it until `settings.store` stores it (G28, SHAPER_CALIBRATE). `machine.get`
        reports whether the machine has an accelerometer."""
        ...
    async def find_stall(
        self,
        axis: str,
        repeats: float = ...,
    ) -> passo.web.endpoints.console.Answer:
        """Finds the threshold with which an axis homes by the stall of its motor, homes
        with it, and reports how exactly (STALL_CALIBRATE); `settings.store` stores it.
        Before, the axis must be in the middle of its travel. `machine.get` lists the axes
        that home by a stall."""
        ...
    async def bed(
        self,
    ) -> passo.web.endpoints.calibration.BedMap:
        """The active map of the bed, or the last one that was measured."""
        ...

class AsyncConsole:
    async def run(
        self,
        script: str,
    ) -> passo.web.endpoints.console.Answer:
        """Executes lines of G-code, one after the other, and answers when the last line is
        done or planned. The first line that fails ends the script."""
        ...
    async def end_wait(
        self,
    ) -> None:
        """Ends the current wait (M108): for a temperature, a calibration, or a measurement
        of the bed."""
        ...
    async def history(
        self,
    ) -> builtins.list[passo.web.endpoints.console.Line]:
        """The last lines of all consoles, oldest first, without secrets."""
        ...
    async def commands(
        self,
    ) -> builtins.list[passo.web.endpoints.console.Command]:
        """All commands of the printer."""
        ...

class AsyncEmergency:
    async def stop(
        self,
    ) -> None:
        """Switches heaters, motors and fans off at once (M112). The print is lost, and axes
        are not homed any more."""
        ...
    async def restart(
        self,
    ) -> None:
        """Restarts a halted printer (M999); answers when it runs."""
        ...

class AsyncExplain:
    async def file(
        self,
        path: str,
        line: int,
    ) -> passo.learn.explanation.Explanation:
        """Explains a line of a file of the card, as `passo explain` shows it. A simulated
        board prints the file until the line is done, which takes seconds for a late line of
        a long file."""
        ...
    async def line(
        self,
        line: str,
        before: str = ...,
        after: str = ...,
    ) -> passo.learn.explanation.Explanation:
        """Explains one line. All axes start at 0, before the lines of `before`. Nothing
        moves."""
        ...

class AsyncFans:
    async def list(
        self,
    ) -> dict[str, float]:
        """The last commanded speed of each fan, a fraction of full speed."""
        ...
    async def set(
        self,
        name: str,
        speed: float,
    ) -> None:
        """Sets the speed of a fan at once. Fans that follow a heater or the boards cannot
        be set."""
        ...
    async def set_target(
        self,
        name: str,
        celsius: float,
    ) -> None:
        """Sets the target of a fan with a thermostat (SET_TEMPERATURE_FAN_TARGET)."""
        ...

class AsyncFaults:
    async def list(
        self,
    ) -> builtins.list[passo.printer.status.FaultStatus]:
        """Why the printer is halted, as errors of the catalogue; empty while it runs.
        `emergency.restart` starts it again."""
        ...

class AsyncFiles:
    async def list(
        self,
        folder: str = ...,
    ) -> passo.web.endpoints.files.Folder:
        """The files and folders in a folder of the card."""
        ...
    async def metadata(
        self,
        path: str,
    ) -> passo.web.files.metadata.Metadata:
        """Facts about a file: slicer, objects, thumbnails, and the plan of this printer, as
        by `passo estimate`. Planning takes some seconds for a long file; until then `state`
        is `pending`."""
        ...
    async def fits(
        self,
        path: str,
    ) -> passo.web.endpoints.files.FittingMachines:
        """Shipped machines that print a file, for one that this printer refuses. Planning
        takes some seconds for each, of a long file."""
        ...
    async def toolpath(
        self,
        path: str,
    ) -> bytes:
        """The toolpath of a file, move by move, as this printer would print it; its format
        is in docs/reference/toolpath.md. The answer comes when the file is planned. A file
        that cannot be printed has no toolpath: `files.metadata` says why."""
        ...
    async def thumbnail(
        self,
        path: str,
        number: int = ...,
    ) -> bytes:
        """A thumbnail of a file, as the slicer has made it: PNG, JPEG or QOI."""
        ...
    async def download(
        self,
        path: str,
    ) -> bytes:
        """The bytes of a file, or the part that a `Range` header names."""
        ...
    async def upload(
        self,
        data: bytes,
        path: str,
        sha256: str = ...,
    ) -> passo.web.endpoints.files.StoredFile:
        """Uploads a file to the card, and makes its folders. Once it is complete, it
        replaces a file of the same path. Characters that no name may have become `_`: the
        answer has the new path. If the connection is lost, the received bytes are kept for
        ten minutes: `files.kept` reports their number, and the client sends the rest with
        `Content-Range: bytes FIRST-LAST/TOTAL`. A client may send any file in such
        parts."""
        ...
    async def kept(
        self,
        path: str,
    ) -> passo.web.endpoints.files.KeptUpload:
        """The offset from which an interrupted upload of a file continues."""
        ...
    async def forget(
        self,
        path: str,
    ) -> None:
        """Discards an interrupted upload."""
        ...
    async def remove(
        self,
        path: str,
    ) -> None:
        """Deletes a file, unless it is being printed."""
        ...
    async def rename(
        self,
        path: str,
        to: str,
    ) -> None:
        """Renames or moves a file or folder, unless it is, or contains, the file that is
        being printed."""
        ...

class AsyncFolders:
    async def make(
        self,
        path: str,
    ) -> None:
        """Makes a folder."""
        ...
    async def remove(
        self,
        path: str,
    ) -> None:
        """Deletes an empty folder."""
        ...

class AsyncFirmware:
    async def boards(
        self,
    ) -> passo.web.endpoints.firmware.Boards:
        """The boards of the machine, and all boards that come with Passo, with the steps
        that each needs."""
        ...
    async def build(
        self,
        board: str | None = ...,
        text: str | None = ...,
    ) -> passo.web.firmware.builds.Build:
        """Starts a build of images in a separate process, one build at a time, while no
        board is being flashed. The feed sends each line of the log; `firmware.last` has the
        whole log."""
        ...
    async def last(
        self,
    ) -> passo.web.firmware.builds.Build:
        """The current or the last build, with its log and the sizes of its images."""
        ...
    async def cancel(
        self,
    ) -> None:
        """Ends the build that is running, if there is one."""
        ...
    async def download(
        self,
    ) -> bytes:
        """The images of the last build with their descriptions (JSON) and its log, as one
        zip."""
        ...
    async def ports(
        self,
    ) -> builtins.list[passo.web.firmware.ports.Port]:
        """The ports of the computer of the printer through which a board may be flashed."""
        ...
    async def flash(
        self,
        image: str,
        port: str | None = ...,
    ) -> passo.web.firmware.flashes.Flash:
        """Starts to flash an image of the last build onto its board, in a separate process,
        one board at a time. `firmware.flashing` has the log, and the manual steps. If there
        are accounts, the password must have been entered within the last minutes."""
        ...
    async def flashing(
        self,
    ) -> passo.web.firmware.flashes.Flash:
        """The board that is being flashed, or the last one, with the log."""
        ...
    async def confirm(
        self,
    ) -> None:
        """Confirms that the manual step that `firmware.flashing` asks for is done."""
        ...
    async def cancel_flash(
        self,
    ) -> None:
        """Cancels flashing while it waits for a manual step. Has no effect while the image
        is being written."""
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

class AsyncHistory:
    async def temperatures(
        self,
        span_s: float = ...,
    ) -> passo.web.endpoints.history.Temperatures:
        """Temperatures, targets and power of all heaters, and other temperatures: one
        sample per second for the last 15 minutes, and one every 15 s for the day before."""
        ...

class AsyncInputs:
    async def enable_filament_sensor(
        self,
        name: str,
        enabled: bool,
    ) -> None:
        """Enables or disables a filament sensor (SET_FILAMENT_SENSOR)."""
        ...
    async def endstops(
        self,
    ) -> dict[str, bool]:
        """Asks the boards whether each endstop is triggered."""
        ...

class AsyncJob:
    async def start(
        self,
        path: str,
        allow: builtins.list[typing.Literal['unknown', 'levelling', 'clamp', 'ignore_tools']] = ...,
        run: str = ...,
    ) -> passo.web.endpoints.job.Started:
        """Prints a file of the card. With a run id it is printed at most once: the printer
        stores the run id before the print starts, and knows the last 100, also after a
        restart if it has a folder for them (`--state`)."""
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
    async def cancel_object(
        self,
        number: int,
        cancelled: bool,
    ) -> None:
        """Cancels an object of the print, or prints it again. `number` is its number in the
        status."""
        ...
    async def past(
        self,
        limit: int = ...,
    ) -> builtins.list[passo.web.bridge.PastPrint]:
        """The last finished prints, newest first."""
        ...

class AsyncLessons:
    async def list(
        self,
        language: typing.Literal['en', 'it'] = ...,
    ) -> passo.learn.views.CourseView:
        """The path of the course, and the calculators."""
        ...
    async def get(
        self,
        name: str,
        language: typing.Literal['en', 'it'] = ...,
    ) -> passo.learn.views.LessonView:
        """A lesson: its texts with the numbers of its experiment, its questions, and the
        code that it explains."""
        ...
    async def run(
        self,
        name: str,
        language: typing.Literal['en', 'it'] = ...,
        values: dict[str, float | str] = ...,
    ) -> passo.learn.views.OutcomeView:
        """Runs the experiment of a lesson with other values."""
        ...
    async def check(
        self,
        name: str,
        question: int,
        answer: float,
        language: typing.Literal['en', 'it'] = ...,
    ) -> passo.learn.lesson.Checked:
        """Checks the answer to a question, which is counted from 0. The text explains the
        right answer, or is the hint for the mistake that leads to a wrong one."""
        ...

class AsyncCalculators:
    async def get(
        self,
        name: str,
        language: typing.Literal['en', 'it'] = ...,
    ) -> passo.learn.views.ExperimentView:
        """A calculator with its parameters, and its outcome with their defaults."""
        ...
    async def run(
        self,
        name: str,
        language: typing.Literal['en', 'it'] = ...,
        values: dict[str, float | str] = ...,
    ) -> passo.learn.views.OutcomeView:
        """Calculates with other values."""
        ...

class AsyncLights:
    async def set(
        self,
        name: str,
        red: float = ...,
        green: float = ...,
        blue: float = ...,
        white: float = ...,
        led: float | None = ...,
    ) -> None:
        """Sets the colour of a light after the planned moves (SET_LED). An effect or a
        template of the light stays visible."""
        ...

class AsyncLogs:
    async def list(
        self,
    ) -> builtins.list[passo.web.endpoints.logs.LogRecord]:
        """The log (`--log`), and the reports of halts."""
        ...
    async def get(
        self,
        name: str,
    ) -> bytes:
        """One of these files, without passwords and keys."""
        ...

class AsyncMachine:
    async def get(
        self,
    ) -> passo.web.endpoints.machine.Machine:
        """The parts of the machine. They do not change while the machine is served."""
        ...
    async def file(
        self,
    ) -> passo.web.endpoints.machine_file.MachineFile:
        """The current machine file, which may differ from the running machine."""
        ...
    async def keys(
        self,
    ) -> builtins.list[passo.web.machine.keys.KeyValue]:
        """All keys of the machine file with their values, the source of each value, and the
        setting that overrides it. Secrets are not shown."""
        ...
    async def schema(
        self,
    ) -> dict[str, typing.Any]:
        """The JSON schema of the machine file: type, range, default and help of each key,
        its unit as `x-unit`, and, as `x-acts`, whether a change takes effect `live` or
        after a `restart`."""
        ...
    async def validate(
        self,
        text: str,
    ) -> passo.web.endpoints.machine_file.Validation:
        """Checks a text like `passo check`, and reports all problems at once."""
        ...
    async def diff(
        self,
        text: str,
    ) -> passo.web.endpoints.machine_file.Difference:
        """Compares a text with the running machine, and with its file."""
        ...
    async def apply(
        self,
        text: str,
        replaces: str,
    ) -> passo.web.endpoints.machine_file.Applied:
        """Writes the machine file, completely or not at all, if the text has no errors. A
        copy of the earlier file is kept as FILE.toml.bak. Changes that commands can make
        take effect at once; the answer names those that need a restart."""
        ...
    async def save(
        self,
        text: str,
    ) -> passo.web.endpoints.machine_file.SavedMachine:
        """Saves a text as the user's file in place of the shipped machine that is served,
        if the text has no errors. From the next `machine.restart` on, and at each later
        start with the same `--machine` and `--state`, the printer is that of this file."""
        ...
    async def restart(
        self,
    ) -> None:
        """Ends the printer, and restarts it with the current machine file, with heaters off
        and axes not homed. The command RESTART does the same; FIRMWARE_RESTART and M999 do
        not read the machine file. Consoles and this connection are closed; connect again
        after some seconds. Log-ins stay valid if the printer has a folder for them
        (`--state`)."""
        ...
    async def library(
        self,
    ) -> builtins.list[passo.web.endpoints.machine_file.ShippedMachine]:
        """The machines that come with Passo."""
        ...
    async def shipped(
        self,
        name: str,
    ) -> passo.web.endpoints.machine_file.ShippedFile:
        """The file of a machine that comes with Passo."""
        ...

class AsyncMotion:
    async def jog(
        self,
        distances_mm: dict[str, float],
        speed_mm_s: float,
    ) -> None:
        """Moves axes by a distance, after the planned moves. Modes such as G91 and G20 stay
        as they are, and do not affect the distances. The answer comes when the move is
        planned."""
        ...
    async def home(
        self,
        axes: builtins.list[str] = ...,
    ) -> None:
        """Homes axes; answers when they are homed."""
        ...
    async def turn_motor(
        self,
        motor: str,
    ) -> None:
        """Turns a motor 1 mm forth and back, ten times (STEPPER_BUZZ); its axis need not be
        homed. Answers when the motor is back."""
        ...
    async def wait(
        self,
    ) -> None:
        """Waits until all planned moves are done (M400)."""
        ...
    async def motors_off(
        self,
    ) -> None:
        """Switches the motors off at standstill; axes are not homed any more."""
        ...

class AsyncOutputs:
    async def set(
        self,
        name: str,
        value: float,
    ) -> None:
        """Sets an output after the planned moves (SET_PIN)."""
        ...

class AsyncPairing:
    async def make_code(
        self,
    ) -> passo.web.endpoints.pairing.MadeCode:
        """Makes a one-time code, with which one program can pair (`pairing.pair`) within
        ten minutes. An earlier code becomes invalid."""
        ...
    async def pair(
        self,
        code: str,
        name: str,
    ) -> passo.web.endpoints.pairing.Paired:
        """Makes an API key for a program that has a one-time code."""
        ...

class AsyncQueue:
    async def get(
        self,
    ) -> passo.printer.status.Queue:
        """The queued prints, the next one first. The queue survives a restart if the
        printer has a folder for it (`--state`)."""
        ...
    async def add(
        self,
        path: str,
    ) -> passo.printer.status.QueuedPrint:
        """Adds a file of the card at the end of the queue."""
        ...
    async def remove(
        self,
        number: int,
    ) -> None:
        """Removes a print from the queue."""
        ...
    async def move(
        self,
        number: int,
        place: int,
    ) -> None:
        """Moves a print to another position: 0 is the next print; a position beyond the end
        is the last."""
        ...
    async def mode(
        self,
        automatic: bool,
    ) -> None:
        """Sets whether the next print starts without confirmation, or waits for
        `queue.start` (the default)."""
        ...
    async def start(
        self,
        bed_clear: bool,
    ) -> None:
        """Starts the next print, and removes it from the queue."""
        ...

class AsyncRuns:
    async def get(
        self,
        run: str,
    ) -> passo.job.live.runs.Run:
        """The state of the print that was started with a run id (`job.start`)."""
        ...

class AsyncServos:
    async def set(
        self,
        name: str,
        degrees: float | None,
    ) -> None:
        """Turns a servo after the planned moves (SET_SERVO)."""
        ...

class AsyncSession:
    async def get(
        self,
    ) -> passo.web.endpoints.session.Identity:
        """The identity of the caller, and whether there is an administrator."""
        ...
    async def set_up(
        self,
        name: str,
        password: str,
        code: str = ...,
    ) -> passo.web.endpoints.session.Identity:
        """Creates the administrator, once, and logs in. From another computer, this needs
        the one-time code that `passo serve` prints."""
        ...
    async def log_in(
        self,
        name: str,
        password: str,
    ) -> passo.web.endpoints.session.Identity:
        """Logs in: the answer sets a cookie."""
        ...
    async def log_out(
        self,
    ) -> None:
        """Ends the log-in of the cookie."""
        ...
    async def confirm(
        self,
        password: str,
    ) -> None:
        """Confirms the password, which allows operations that need it for the next five
        minutes."""
        ...
    async def change_password(
        self,
        old: str,
        new: str,
    ) -> None:
        """Changes the password of the caller's account, and ends its other log-ins."""
        ...
    async def list(
        self,
    ) -> builtins.list[passo.web.endpoints.session.LogInRecord]:
        """The caller's log-ins; for an administrator, those of all accounts."""
        ...
    async def revoke(
        self,
        id: str,
    ) -> None:
        """Ends a log-in of the caller at once; an administrator can end any log-in."""
        ...

class AsyncSettings:
    async def list(
        self,
    ) -> builtins.list[passo.web.bridge.SettingValue]:
        """All settings. `source` is the source of the active value: `file` (the machine
        file or its defaults), `stored` (M500), or `command` (changed since)."""
        ...
    async def set(
        self,
        command: str,
        word: str,
        value: float | str,
    ) -> None:
        """Sets a value until the printer is restarted, or until `settings.store` stores
        it."""
        ...
    async def store(
        self,
    ) -> None:
        """Stores the values that differ from the machine file (M500), durably."""
        ...
    async def load(
        self,
    ) -> None:
        """Restores the stored values (M501)."""
        ...
    async def reset(
        self,
    ) -> None:
        """Restores the values of the machine file (M502); stored values stay stored."""
        ...

class AsyncSimulation:
    async def parts(
        self,
    ) -> builtins.list[passo.web.bridge.SimulatedPart]:
        """The parts of the simulated printer that can have faults; empty if the boards are
        real."""
        ...
    async def set_fault(
        self,
        part: str,
        fault: str,
    ) -> None:
        """Gives a part of the simulated printer a fault, or ends it, even while the printer
        is halted (SIMULATE_FAULT)."""
        ...

class AsyncStatus:
    async def get(
        self,
    ) -> passo.web.endpoints.status.StatusNow:
        """The current status: state, positions, heaters, fans, the print, faults. The
        WebSocket `/api/v1/feed` reports its changes. Numbers that are not finite are
        null."""
        ...
    async def version(
        self,
    ) -> passo.web.endpoints.status.Version:
        """The version of Passo, and the name of its machine."""
        ...
    async def places(
        self,
    ) -> builtins.list[str]:
        """The addresses for hosts, browsers and Moonraker, each with its kind."""
        ...

class AsyncSummary:
    async def get(
        self,
    ) -> passo.web.summary.Summary:
        """The printer at a glance, for a page over many printers. The WebSocket
        `/api/v1/summary/feed` sends it at each change."""
        ...

class AsyncTuning:
    async def set_speed(
        self,
        factor: float,
    ) -> None:
        """Scales the speed; during a print, also that of planned moves (M220)."""
        ...
    async def set_flow(
        self,
        tool: int,
        factor: float,
    ) -> None:
        """Scales the extrusion of a tool; during a print, also that of planned moves
        (M221)."""
        ...
    async def babystep(
        self,
        axis: str,
        distance_mm: float,
    ) -> None:
        """Shifts all remaining moves along an axis, at once (M290)."""
        ...

class Client:
    """A printer that is served somewhere."""

    def __init__(
        self, url: str = ..., *, key: str | None = None, timeout_s: float = ...
    ) -> None: ...

    @property
    def accounts(self) -> Accounts: ...
    @property
    def keys(self) -> Keys: ...
    @property
    def calibration(self) -> Calibration: ...
    @property
    def console(self) -> Console: ...
    @property
    def emergency(self) -> Emergency: ...
    @property
    def explain(self) -> Explain: ...
    @property
    def fans(self) -> Fans: ...
    @property
    def faults(self) -> Faults: ...
    @property
    def files(self) -> Files: ...
    @property
    def folders(self) -> Folders: ...
    @property
    def firmware(self) -> Firmware: ...
    @property
    def heaters(self) -> Heaters: ...
    @property
    def history(self) -> History: ...
    @property
    def inputs(self) -> Inputs: ...
    @property
    def job(self) -> Job: ...
    @property
    def lessons(self) -> Lessons: ...
    @property
    def calculators(self) -> Calculators: ...
    @property
    def lights(self) -> Lights: ...
    @property
    def logs(self) -> Logs: ...
    @property
    def machine(self) -> Machine: ...
    @property
    def motion(self) -> Motion: ...
    @property
    def outputs(self) -> Outputs: ...
    @property
    def pairing(self) -> Pairing: ...
    @property
    def queue(self) -> Queue: ...
    @property
    def runs(self) -> Runs: ...
    @property
    def servos(self) -> Servos: ...
    @property
    def session(self) -> Session: ...
    @property
    def settings(self) -> Settings: ...
    @property
    def simulation(self) -> Simulation: ...
    @property
    def status(self) -> Status: ...
    @property
    def summary(self) -> Summary: ...
    @property
    def tuning(self) -> Tuning: ...

class AsyncClient:
    """As `Client`, with calls to await."""

    def __init__(
        self, url: str = ..., *, key: str | None = None, timeout_s: float = ...
    ) -> None: ...

    @property
    def accounts(self) -> AsyncAccounts: ...
    @property
    def keys(self) -> AsyncKeys: ...
    @property
    def calibration(self) -> AsyncCalibration: ...
    @property
    def console(self) -> AsyncConsole: ...
    @property
    def emergency(self) -> AsyncEmergency: ...
    @property
    def explain(self) -> AsyncExplain: ...
    @property
    def fans(self) -> AsyncFans: ...
    @property
    def faults(self) -> AsyncFaults: ...
    @property
    def files(self) -> AsyncFiles: ...
    @property
    def folders(self) -> AsyncFolders: ...
    @property
    def firmware(self) -> AsyncFirmware: ...
    @property
    def heaters(self) -> AsyncHeaters: ...
    @property
    def history(self) -> AsyncHistory: ...
    @property
    def inputs(self) -> AsyncInputs: ...
    @property
    def job(self) -> AsyncJob: ...
    @property
    def lessons(self) -> AsyncLessons: ...
    @property
    def calculators(self) -> AsyncCalculators: ...
    @property
    def lights(self) -> AsyncLights: ...
    @property
    def logs(self) -> AsyncLogs: ...
    @property
    def machine(self) -> AsyncMachine: ...
    @property
    def motion(self) -> AsyncMotion: ...
    @property
    def outputs(self) -> AsyncOutputs: ...
    @property
    def pairing(self) -> AsyncPairing: ...
    @property
    def queue(self) -> AsyncQueue: ...
    @property
    def runs(self) -> AsyncRuns: ...
    @property
    def servos(self) -> AsyncServos: ...
    @property
    def session(self) -> AsyncSession: ...
    @property
    def settings(self) -> AsyncSettings: ...
    @property
    def simulation(self) -> AsyncSimulation: ...
    @property
    def status(self) -> AsyncStatus: ...
    @property
    def summary(self) -> AsyncSummary: ...
    @property
    def tuning(self) -> AsyncTuning: ...
