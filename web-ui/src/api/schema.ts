/** The types of the API, made from its table of operations: make reference. Numbers that
 * are not finite, and what a merge patch has removed, are missing. */

/** The changes of an account; an omitted value stays. */
export interface AccountChange {
  password?: string | null;
  role?: "admin" | "operator" | "viewer" | null;
}

/** An account. */
export interface AccountRecord {
  name: string;
  role: "admin" | "operator" | "viewer";
}

/** The first account. `code` is the one-time code of `passo serve`, if `code_needed`. */
export interface Administrator {
  name: string;
  password: string;
  code?: string;
}

/** The pressure advance of an extruder, and the time over which it is smoothed. */
export interface AdvanceStatus {
  advance_s: number;
  smooth_s: number;
}

/** The lines of the printer's answer. */
export interface Answer {
  lines: string[];
}

/** The effect of writing the machine file. `live` are the changed keys that have taken effect;
 * `overridden` those that a stored setting or a command overrides; `restart` those that take
 * effect after `machine.restart`. `backup` is the path of a copy of the earlier file. */
export interface Applied {
  live: string[];
  overridden: string[];
  restart: string[];
  backup: string;
}

/** Axes to home; without any, all axes that have an endstop. */
export interface AxesToHome {
  axes?: string[];
}

/** An axis. `position_mm` is the plan's current position in program coordinates, `machine_mm` the
 * same in machine coordinates. If `homed`, the position is certain. Targets must be between
 * `min_mm` and `max_mm`, in machine coordinates. */
export interface AxisStatus {
  position_mm: number;
  machine_mm: number;
  homed: boolean;
  min_mm: number;
  max_mm: number;
  babystep_mm: number;
}

/** The distance, in mm, by which all remaining moves shift along an axis, in addition to earlier
 * shifts. */
export interface Babystep {
  axis: string;
  distance_mm: number;
}

/** The correction that is added to Z, in mm: `heights_mm[j][i]` at `xs_mm[i]`, `ys_mm[j]`; empty
 * before the bed is measured. `probe`: the machine has a probe. `method` comes from the machine
 * file; `procedures` are those that the machine allows. `measured` is the kind of correction: a
 * `mesh` has its own points, a `fit` is sampled over the bed. */
export interface BedMap {
  probe: boolean;
  method: string;
  procedures: ("delta" | "gantry" | "screws")[];
  measured: "fit" | "mesh" | "none";
  on: boolean;
  xs_mm: number[];
  ys_mm: number[];
  heights_mm: number[][];
}

/** A place of the bed and its measured height, mm. */
export interface BedPoint {
  x_mm: number;
  y_mm: number;
  height_mm: number;
}

/** The measurement and the correction of the bed. `method` and `probe` come from the machine file.
 * `on`: the correction is active. `profile` is the name of the active stored mesh, or empty;
 * `meshes` are all stored meshes; `mesh` is the active one. `points` are the last measured
 * points; `rms_mm` is their RMS deviation from their mean, `left_rms_mm` that from the
 * correction; both are None without points. `surface` is the correction itself, None without one;
 * `fade_mm` is the height at which it has faded out. `probe_offset_mm` and `trigger_height_mm`
 * are the values of M851. During a run, `measured` of `to_measure` points are done; otherwise
 * both are 0. `manual` is the paper test in progress. `triggered` is the state of the probe at
 * its last query. `holds_babysteps`: Z_OFFSET_APPLY_PROBE stores the babysteps of Z; else
 * Z_OFFSET_APPLY_ENDSTOP does. */
export interface BedStatus {
  method: string;
  on: boolean;
  profile: string;
  points: BedPoint[];
  rms_mm?: number | null;
  left_rms_mm?: number | null;
  surface?: BedSurface | null;
  fade_mm?: number | null;
  probe: string;
  probe_offset_mm: [number, number];
  trigger_height_mm: number;
  measured: number;
  to_measure: number;
  manual?: ManualProbeStatus | null;
  mesh?: Mesh | null;
  meshes: Record<string, StoredMesh>;
  triggered: boolean;
  holds_babysteps: boolean;
}

/** The heights that the correction adds to Z, in mm, on an even grid from one corner of the bed to
 * the opposite one: rows along X, the front row first. */
export interface BedSurface {
  from_mm: [number, number];
  to_mm: [number, number];
  rows_mm: number[][];
}

/** A board: its description, the program that flashes it (`flash`, null without one), and the
 * manual steps before and after. `state` is `ready`, or names what is missing. */
export interface BoardOfList {
  name: string;
  description: string;
  mcu: string;
  console: string;
  flash?: string | null;
  before: string[];
  after: string[];
  notes: string[];
  state: string;
}

/** A board. `firmware` is the version of its firmware; `bytes_sent` and `bytes_resent` count the
 * traffic of its link since the start; `simulated`: the board is software. `awake_s` is the busy
 * time of its firmware in the last 5 s; `task_s` and `task_deviation_s` are the mean and the
 * standard deviation of one pass of its main loop, in seconds. These are None until the board
 * reports them, and always for a simulated chip. */
export interface BoardStatus {
  firmware: string;
  mcu: string;
  clock_hz: number;
  simulated: boolean;
  bytes_sent: number;
  bytes_resent: number;
  awake_s?: number | null;
  task_s?: number | null;
  task_deviation_s?: number | null;
}

/** `machine` are the boards of the machine by name; the name of the main board is empty. `shipped`
 * are all boards that come with Passo. */
export interface Boards {
  machine: Record<string, BoardOfList>;
  shipped: BoardOfList[];
}

/** A build. `of` is the name of the machine or board; `log` has its lines so far; `seconds` is its
 * duration so far. */
export interface Build {
  number: number;
  of: string;
  state: "cancelled" | "done" | "failed" | "running";
  log: string[];
  images: Image[];
  seconds: number;
}

/** The images to build: for the shipped board `board`; or for all boards of the machine file
 * `text`; or for those of the printer's machine file if both are null. `board` has priority over
 * `text`. */
export interface BuildOrder {
  board?: string | null;
  text?: string | null;
}

/** The result of an answer: whether it is right, and what to read next. */
export interface Checked {
  right: boolean;
  text: string;
}

/** A value of a parameter that has only a few, with its name. */
export interface ChoiceView {
  value: number | string;
  text: string;
}

/** The user confirms that no print is left on the bed. */
export interface ClearBed {
  bed_clear: boolean;
}

/** A command of the printer: its effect and its parameters. */
export interface Command {
  code: string;
  text: string;
  parameters: Parameter[];
}

/** The path of the course, and the calculators. */
export interface CourseView {
  chapters: ListedChapter[];
  calculators: ListedCalculator[];
}

/** `changes` are the keys whose values differ from those of the running machine; values from files
 * that the text names are included. `text` is the difference from the machine file, in the format
 * of `diff -u`. */
export interface Difference {
  changes: KeyChange[];
  text: string;
}

/** A motor driver with registers. `run_a` and `hold_a` are its RMS currents; `mode` is stealthChop
 * or spreadCycle. `flags` are the fields of its status register that are not 0; None until it has
 * reported them, and while it does not answer. `temperature_c` and `supply_v` are None unless the
 * chip measures them. `findings` are its faults and warnings, each with the next action. */
export interface DriverStatus {
  chip: string;
  run_a: number;
  hold_a: number;
  microsteps: number;
  mode: string;
  flags?: Record<string, number> | null;
  temperature_c?: number | null;
  supply_v?: number | null;
  findings: FaultStatus[];
}

/** A finished print: its result (done, cancelled or failed), the reason of a failure, and its
 * progress. `problems` are the errors of the reason, if they are known. */
export interface EndedJob {
  outcome: string;
  reason: string;
  job: JobStatus;
  problems: FaultStatus[];
}

/** An experiment with its parameters, and its outcome with the defaults. */
export interface ExperimentView {
  name: string;
  title: string;
  about: string;
  parameters: ParameterView[];
  outcome: OutcomeView;
}

/** A command of the line: its effect, and its words as read by the lexer. `code` is empty for a
 * move without a G. */
export interface ExplainedCommand {
  code: string;
  text: string;
  words: string[];
}

/** The call of a macro, and the lines to which it was expanded. */
export interface ExplainedMacro {
  call: string;
  lines: string[];
}

/** A planned move: lengths in `unit`, mm or degrees; speeds in units/s, accelerations in units/s²,
 * times in seconds. `start_s` and `end_s` are print times. `start_mm` and `end_mm` are positions
 * of X, Y, Z and E. The `kind` of a wait is `dwell`. `shape` is trapezoid, triangle or constant
 * speed. `tolerance_us` is the maximum error of the step times, which is larger where the board's
 * budget requires it. */
export interface ExplainedMove {
  kind: string;
  unit: string;
  length: number;
  start_mm: number[];
  end_mm: number[];
  shape: string;
  start_speed: number;
  cruise_speed: number;
  speed_cap: number;
  end_speed: number;
  accelerate_length: number;
  accelerate_s: number;
  cruise_length: number;
  cruise_s: number;
  decelerate_length: number;
  decelerate_s: number;
  start_s: number;
  end_s: number;
  speed_limit: string;
  acceleration: number;
  accel_limit: string;
  tolerance_us: number;
}

/** The executed steps of a motor, with the print times of the first and the last step. */
export interface ExplainedSteps {
  motor: string;
  count: number;
  first_s?: number | null;
  last_s?: number | null;
}

/** The explanation of one line. `number` is its line number (N), empty without one; `checksum`: it
 * has a checksum. `planned` is the number of planned moves; `moves` has all of them, or the first
 * and the last. `junction_before` and `junction_after` describe the limit of the speed before and
 * after the moves; both are empty for a line without moves. `filters` describe the effects of the
 * motion filters. `sub_program`: the line calls a sub-program, whose lines contain the moves.
 * `wire` has the commands for boards with recorded bytes; `frame` is a frame with the first
 * command. `tick_ns` is the length of a clock tick, by board; the name of the main board is
 * empty. `unseen`: commands for other boards are missing in `wire`. */
export interface Explanation {
  place: string;
  line: string;
  number: string;
  checksum: boolean;
  commands: ExplainedCommand[];
  macros: ExplainedMacro[];
  planned: number;
  moves: ExplainedMove[];
  junction_before: string;
  junction_after: string;
  filters: string[];
  sub_program: boolean;
  steps: ExplainedSteps[];
  wire: WireCommand[];
  frame: string;
  tick_ns?: Record<string, number> | null;
  unseen: boolean;
}

/** The speed of a fan, as a fraction of full speed. */
export interface FanSpeed {
  speed: number;
}

/** The temperature below which a fan keeps its sensor, °C; 0 switches the fan off. */
export interface FanTarget {
  celsius: number;
}

/** An error of the catalogue. `message` says what is wrong and where, `action` what to do next;
 * `values` are those in the message. */
export interface Fault {
  code: string;
  part: string;
  message: string;
  action: string;
  values: Record<string, unknown>;
}

/** An error of the catalogue: its code, the affected part, the sentence, and the next action. */
export interface FaultStatus {
  code: string;
  part: string;
  text: string;
  action: string;
}

/** A filament sensor: whether it detects filament, whether it is enabled, and whether it measures
 * the motion of the filament. A width sensor has the diameter of the filament in it, its
 * `reading`, whether it measures, and the factor of the flow for the filament in the nozzle. */
export interface FilamentSensorStatus {
  detected: boolean;
  enabled: boolean;
  moves: boolean;
  diameter_mm?: number | null;
  reading: number;
  measures: boolean;
  flow_factor: number;
}

/** Whether a filament sensor is enabled. */
export interface FilamentSensorSwitch {
  enabled: boolean;
}

/** A file or folder. `size` is in bytes, 0 of a folder; `modified_s` is the time of its last
 * change, in seconds since 1970. */
export interface FileEntry {
  name: string;
  path: string;
  folder: boolean;
  size: number;
  modified_s: number;
}

/** The path of a file or folder from the root of the card; `/` separates names. */
export interface FilePath {
  path: string;
}

/** The path of a file on the card. `allow` is what the print may do in place of a failure, see
 * `Metadata`. `run` is a UUID that the client makes for this print: a request that is repeated
 * with it, for example because the answer was lost, starts nothing. */
export interface FileToPrint {
  path: string;
  allow?: ("clamp" | "ignore_tools" | "levelling" | "unknown")[];
  run?: string;
}

/** The card: whether it is mounted, the path of the file that is selected for printing, and the
 * folder of the card; each path may be empty. */
export interface FilesStatus {
  mounted: boolean;
  selected: string;
  folder: string;
}

/** The names of the first shipped machines that print a file, the smallest first. */
export interface FittingMachines {
  machines: string[];
}

/** The current or the last flashing of a board; its state is `idle` before the first one. The
 * state is `waiting` while the user has to do the manual step in `asks`. `log` has the lines so
 * far, including those of the flash program. */
export interface Flash {
  image: string;
  port: string;
  state: "cancelled" | "done" | "failed" | "idle" | "running" | "waiting";
  asks: string;
  log: string[];
}

/** An image of the last build by its file, and the port of the board, one of `firmware.ports`.
 * Boards that are flashed through a programmer need none. */
export interface FlashOrder {
  image: string;
  port?: string | null;
}

/** The factor of a tool's extrusion; 1 leaves it as in the file. */
export interface FlowFactor {
  factor: number;
}

/** A folder of the card and its content, by name; the free bytes of the card. */
export interface Folder {
  path: string;
  free_bytes: number;
  entries: FileEntry[];
}

/** The answer to a question of a lesson. */
export interface GivenAnswer {
  language?: "en" | "it";
  answer: number;
}

/** Lines of one unit over one axis, which `across` names. The vertical axis reaches `values`. */
export interface GraphView {
  title: string;
  across: string;
  unit: string;
  values: number[];
  curves: LineView[];
}

/** A heater. `max_c` is the temperature above which it is switched off. */
export interface HeaterOfMachine {
  kind: "bed" | "chamber" | "hotend";
  max_c: number;
}

/** The values of a heater, one for each time; null if the sensor had not reported. */
export interface HeaterPast {
  celsius: (number | null)[];
  target_c: (number | null)[];
  power: (number | null)[];
}

/** A heater. `celsius` is the last reading of its sensor, None before the first one; `age_s` is 0
 * while the board reports, otherwise the age of this reading in s. `target_c` is 0 while it is
 * off; `power` is a fraction of full power; `fault` is the kind of the protection that has
 * switched it off (its error is `heat.` and the kind), or empty. Below `min_extrude_c` a hotend
 * moves no filament; 0 means no limit (M302), or not a hotend. */
export interface HeaterStatus {
  celsius?: number | null;
  target_c: number;
  power: number;
  fault: string;
  min_extrude_c: number;
  age_s: number;
}

/** The target of a heater, in °C; 0 switches it off. */
export interface HeaterTarget {
  celsius: number;
}

/** A heater to tune at a temperature in °C. A relay oscillation gives PID gains. A rise at full
 * power gives the thermal model; for it, the heater must be cold. */
export interface HeaterTune {
  heater: string;
  celsius: number;
  method?: "model" | "pid";
}

/** The identity of the caller. `role` is `public` without a log-in. `set_up`: there is an
 * administrator. `code_needed`: to create the administrator, the one-time code is needed.
 * `fresh`: the password was entered within the last five minutes. */
export interface Identity {
  name: string;
  role: string;
  set_up: boolean;
  code_needed: boolean;
  fresh: boolean;
}

/** A built image: its file name in the zip, its sizes in bytes, and the memory sizes of the chip. */
export interface Image {
  file: string;
  board: string;
  mcu: string;
  flash_bytes: number;
  flash_size: number;
  ram_bytes: number;
  ram_size: number;
  sha256: string;
}

/** The input of a filament sensor or a button on its pin. `part` is the name of the part in the
 * machine file; `length_mm` is that of a motion sensor: at most this much filament passes between
 * two pulses. */
export interface InputOfMachine {
  kind: "button" | "motion" | "switch";
  part: string;
  pin: string;
  length_mm?: number | null;
}

/** An input of a filament sensor or a button as its board reports it, without debouncing. `active`
 * is None until the first report; `changes` counts the changes since the start, which are the
 * pulses of a motion sensor. */
export interface InputStatus {
  active?: boolean | null;
  changes: number;
}

/** A print that a power cut, a halt or the end of the program has interrupted, and that M1000
 * resumes. `path` is its path on the card, `line` the line where it stopped (0: before its first
 * move). `way` continues the sentence "M1000 resumes it": from where, and what to do by hand
 * first. */
export interface InterruptedPrint {
  path: string;
  line: number;
  way: string;
}

/** The file that is being printed. `fraction`, 0 to 1, is the part of its print time that is done,
 * or of its bytes while its print time is unknown; `line` and `layer` are those of the current
 * move (0: none yet); `printed_s` is the print time so far, without pauses; `left_s` is the
 * duration of its remaining moves, without heating. `layers` and `left_s` are None while they are
 * unknown. `current_object` is the number of the object that is being printed, one of `objects`.
 * `path` is its path on the card; `offset` of its `size` bytes are read and planned; `elapsed_s`
 * is host time since the start, with pauses; `filament_mm` is the filament of all extruders for
 * this print, without moves in pauses; `extruding_s` is the part of `printed_s` since the first
 * extrusion, or `printed_s` on a machine without filament. `slicer_layer` and `slicer_layers` are
 * those of SET_PRINT_STATS_INFO; None without it. `run` is the run id with which the print was
 * started, or empty. */
export interface JobStatus {
  file: string;
  fraction: number;
  line: number;
  layer: number;
  layers?: number | null;
  printed_s: number;
  left_s?: number | null;
  objects: PrintObject[];
  current_object?: number | null;
  path: string;
  size: number;
  offset: number;
  elapsed_s: number;
  filament_mm: number;
  extruding_s: number;
  slicer_layer?: number | null;
  slicer_layers?: number | null;
  run: string;
}

/** The distances of axes, or of the extruder `e`, from the end of the last move, in mm, and the
 * speed. */
export interface Jog {
  distances_mm: Record<string, number>;
  speed_mm_s: number;
}

/** An interrupted upload: the client may send the bytes from `offset` on within ten minutes. */
export interface KeptUpload {
  path: string;
  offset: number;
  total: number;
}

/** A key whose value differs; a value is null if the key is missing. `acts` is the time when the
 * change takes effect: at once (`live`) or after a `restart`. */
export interface KeyChange {
  key: string;
  before: unknown;
  after: unknown;
  acts: "live" | "restart";
}

/** An API key, without its secret; `made_s` is in seconds since 1970. */
export interface KeyRecord {
  id: string;
  name: string;
  role: "admin" | "operator" | "viewer";
  made_s: number;
}

/** A key with its value. `source` is `file` (then `line` is its line), `board` (the file of a
 * board or sensor that the machine file names), or `default`. `setting` is the command with the
 * word that also sets the value; it is empty for most keys. `setting_value` is the active value,
 * and `setting_source` its source: `file`, `stored` (M500), or `command`. */
export interface KeyValue {
  key: string;
  value: unknown;
  source: "board" | "default" | "file";
  line?: number | null;
  setting: string;
  setting_value: string;
  setting_source: string;
}

/** The newest finished print of the history, from the card or by a host. `number` identifies it;
 * `run` is the run id with which it was started, or empty; `reason` says why it has failed. An
 * interrupted print has failed. */
export interface LastPrint {
  number: number;
  file: string;
  run: string;
  result: "cancelled" | "done" | "failed";
  reason: string;
}

/** A lesson. `before` and `after` are the names of its neighbours on the path, or empty. */
export interface LessonView {
  name: string;
  chapter: string;
  title: string;
  goal: string;
  minutes: number;
  paragraphs: string[];
  experiment: ExperimentView;
  questions: QuestionView[];
  source: SourceView;
  printer: OwnPrinterView;
  links: LinkView[];
  before: string;
  after: string;
}

/** A levelling procedure that uses the probe. */
export interface Levelling {
  procedure: "delta" | "gantry" | "screws";
}

/** A colour, as fractions of full brightness, of one LED of a light, from 1; without `led`, of
 * all. */
export interface LightColor {
  red?: number;
  green?: number;
  blue?: number;
  white?: number;
  led?: number | null;
}

/** A coloured light: the number of its LEDs, and its `colors`, some of R, G, B and W. */
export interface LightOfMachine {
  count: number;
  colors: string;
}

/** A line of a console. Consoles are numbered from 1; 0 means all consoles. `received`: the line
 * went from a host to the printer. */
export interface Line {
  console: number;
  received: boolean;
  text: string;
}

/** A line of a graph: its points, and the index of its colour. */
export interface LineView {
  name: string;
  colour: number;
  dashed: boolean;
  t: number[];
  v: number[];
}

/** Further reading: a part of the page, or a document of the repository. */
export interface LinkView {
  text: string;
  page: string;
  document: string;
}

/** A calculator. */
export interface ListedCalculator {
  name: string;
  title: string;
}

/** A part of the path, with its lessons in order. */
export interface ListedChapter {
  title: string;
  lessons: ListedLesson[];
}

/** A lesson of the path; `questions` is their number. */
export interface ListedLesson {
  name: string;
  title: string;
  goal: string;
  minutes: number;
  questions: number;
}

/** A name and its password. */
export interface LogIn {
  name: string;
  password: string;
}

/** A log-in of an account, with times in seconds since 1970. `own`: it is the caller's. */
export interface LogInRecord {
  id: string;
  account: string;
  started_s: number;
  used_s: number;
  own: boolean;
}

/** A file for download: its size in bytes, and the time of its last change, in seconds since 1970. */
export interface LogRecord {
  name: string;
  size: number;
  changed_s: number;
}

/** The machine as described by its file. `fans` are those that commands set; `tools` are those
 * that T0, T1, … select; `accelerometer`: it has one, which measures resonances. `inputs` have
 * the names of the status; `stall_axes` are those that home by the stall of a motor. */
export interface Machine {
  name: string;
  description: string;
  axes: string[];
  heaters: Record<string, HeaterOfMachine>;
  fans: string[];
  tools: ToolOfMachine[];
  accelerometer: boolean;
  outputs: Record<string, OutputOfMachine>;
  inputs: Record<string, InputOfMachine>;
  lights: Record<string, LightOfMachine>;
  servos: Record<string, ServoOfMachine>;
  stall_axes: string[];
}

/** The text of the machine file. `path` is null if there is no file to change: for a shipped
 * machine, or for a machine that a program has made. `machine.apply` needs `sha256`, the SHA-256
 * of the text. `own_path` is where `machine.save` writes the user's file of a shipped machine;
 * null for other machines, and without a folder for it (`--state`). */
export interface MachineFile {
  path?: string | null;
  text: string;
  sha256: string;
  own_path?: string | null;
}

/** A problem of a machine file: `line` is 1 if the line is not known; `key` is empty if the text
 * is not TOML; `action` is what to do next. */
export interface MachineProblem {
  code: string;
  key: string;
  line: number;
  message: string;
  action: string;
}

/** The text of a machine file, in TOML. Relative paths in it, such as those of data dictionaries
 * and sensor tables, are relative to the folder of the printer's machine file. */
export interface MachineText {
  text: string;
}

/** A one-time code, and the seconds for which it is valid. */
export interface MadeCode {
  code: string;
  expires_s: number;
}

/** A new key. `key` is shown only this once. */
export interface MadeKey {
  record: KeyRecord;
  key: string;
}

/** A paper test: point `number` of `count`, the Z of the nozzle, and the nearest tried heights
 * below and above it, mm. */
export interface ManualProbeStatus {
  number: number;
  count: number;
  z_mm: number;
  below_mm?: number | null;
  above_mm?: number | null;
}

/** `heights[j][i]`, mm, is the height of the bed at (xs[i], ys[j]). Each axis has at least two
 * points, ascending in even steps. Raises CommandError otherwise. */
export interface Mesh {
  xs: number[];
  ys: number[];
  heights: number[][];
}

/** Facts about a file. `state` is `pending` until the plan is computed. It is `refused` if a print
 * of the file as it is fails; then `problems` has the reasons, for example moves out of range.
 * `allow` is what `job.start` must allow so that the file can be printed in spite of them: to
 * skip `unknown` commands that may move the machine, to skip the `levelling` of the bed, to
 * `clamp` moves to the limits of the machine, to `ignore_tools` that are missing. `plan` is the
 * plan of that print. An empty `allow` of a refused file: it cannot be printed. */
export interface Metadata {
  path: string;
  state: "known" | "pending" | "refused";
  slicer: string;
  objects: string[];
  thumbnails: Picture[];
  plan?: Plan | null;
  problems: Fault[];
  allow: ("clamp" | "ignore_tools" | "levelling" | "unknown")[];
}

/** The motion of the machine. `speed_mm_s` is the current speed of the nozzle, `filament_mm_s`
 * that of the filament; `queued_s` is the duration of the planned motion. `max_speed_mm_s`,
 * `max_accel_mm_s2`, `minimum_cruise_ratio`, `junction_deviation_mm` and `square_corner_mm_s` are
 * the limits of the path; the first is None if only the axes limit the speed, and the law of
 * corners uses at most one of the last two. `absolute`, `absolute_e` and `feedrate_mm_s` apply to
 * the next move of the program. That move begins at `end_mm` (X, Y, Z and filament in machine
 * coordinates), which is `program_end_mm` in program coordinates. */
export interface MotionStatus {
  speed_mm_s: number;
  filament_mm_s: number;
  queued_s: number;
  max_speed_mm_s?: number | null;
  max_accel_mm_s2: number;
  absolute: boolean;
  absolute_e: boolean;
  feedrate_mm_s: number;
  motors_on: boolean;
  end_mm: [number, number, number, number];
  program_end_mm: [number, number, number, number];
  minimum_cruise_ratio: number;
  junction_deviation_mm: number;
  square_corner_mm_s: number;
}

/** A motor, by its name in the machine file. */
export interface MotorToTurn {
  motor: string;
}

/** An account to make. */
export interface NewAccount {
  name: string;
  password: string;
  role: "admin" | "operator" | "viewer";
}

/** An API key to make; `name` describes its purpose. */
export interface NewKey {
  name: string;
  role?: "admin" | "operator" | "viewer";
}

/** The text to write. `replaces` is the `sha256` that `machine.file` gave for the text before the
 * edit. A file that has changed since then is not overwritten. */
export interface NewMachineFile {
  text: string;
  replaces: string;
}

/** The file or folder to rename, and its new path, which may be in another folder. */
export interface NewName {
  path: string;
  to: string;
}

/** A value to set; `settings.list` gives `command` and `word`. The value is a number, or a name
 * such as that of an input shaper. */
export interface NewValue {
  command: string;
  word: string;
  value: number | string;
}

/** A result: the figure or the words as a text, and its unit. */
export interface NumberView {
  name: string;
  label: string;
  text: string;
  unit: string;
}

/** Whether an object is cancelled. */
export interface ObjectState {
  cancelled: boolean;
}

/** A possible answer of a question: the number to send, and its text. */
export interface OptionView {
  value: number;
  text: string;
}

/** What follows from the values of the parameters. */
export interface OutcomeView {
  values: Record<string, number | string>;
  numbers: NumberView[];
  graphs: GraphView[];
  planes: PlaneView[];
  tables: TableView[];
}

/** An output that commands set; with `pwm` it also takes values between off and on. */
export interface OutputOfMachine {
  pwm: boolean;
}

/** The value of an output, as a fraction of fully on. An output without PWM takes 0 or 1. */
export interface OutputValue {
  value: number;
}

/** What to do on one's own printer: a command, or a part of the page. */
export interface OwnPrinterView {
  text: string;
  command: string;
  page: string;
}

/** The id and the name of the printer, and the API key, with the role operator. The key is shown
 * only this once. */
export interface Paired {
  id: string;
  name: string;
  key: string;
}

/** The one-time code, and the name of the program: its key has this name. While there is no
 * administrator, programs of this computer need no code if no other computer can reach the
 * printer: any text will do. */
export interface PairingRequest {
  code: string;
  name: string;
}

/** One or several parameters of a command: letters or keys. `kind` is number, whole number, flag
 * (which needs no number), text, or rest (the rest of the line is a text). `usage` is the names
 * with unit, range and default. `choices` are the valid texts; empty: each is valid. */
export interface Parameter {
  names: string[];
  kind: string;
  usage: string;
  text: string;
  unit: string;
  low?: number | null;
  high?: number | null;
  default?: number | null;
  choices: string[];
}

/** A value to change: from `low` to `high` in steps of `step`, or one of `choices` if there are
 * some. */
export interface ParameterView {
  name: string;
  label: string;
  unit: string;
  default: number | string;
  low: number;
  high: number;
  step: number;
  choices: ChoiceView[];
}

/** The new fault of a part; `none` ends a fault. `noise` may have an amount, as in `noise:0.05`. */
export interface PartFault {
  fault: string;
}

/** The password of the log-in. */
export interface Password {
  password: string;
}

/** The present password, and the new one. */
export interface PasswordChange {
  old: string;
  new: string;
}

/** A finished print. `number` identifies it; `run` is the run id of its start, or empty;
 * `started_s` is the wall clock in seconds since 1970, None if unknown; `ended` is done,
 * cancelled, failed or interrupted; `print_s` is print time without pauses; `note` is a remark
 * about a problem, or empty. */
export interface PastPrint {
  file: string;
  size: number;
  started_s?: number | null;
  ended: string;
  print_s: number;
  filament_mm: number;
  note: string;
  run: string;
  number: number;
}

/** A thumbnail: the number by which it can be requested, and its size in pixels. */
export interface Picture {
  number: number;
  width: number;
  height: number;
  type: string;
}

/** A file as this printer would print it. `total_s` is the sum of `moving_s`, `dwell_s` and
 * `heating_s`; `limits_s` has, for each limit of the machine, the time for which it limits the
 * speed. */
export interface Plan {
  total_s: number;
  moving_s: number;
  dwell_s: number;
  heating_s: number;
  layers: number;
  moves: number;
  filament_mm: Record<string, number>;
  limits_s: Record<string, number>;
  warnings: string[];
}

/** A picture to scale, as SVG that has no style of its own. */
export interface PlaneView {
  title: string;
  svg: string;
}

/** A serial port, or the folder of a chip's drive to which the image is copied. `name` is the name
 * of the device in the operating system, or empty. `used` is True if this printer uses the port. */
export interface Port {
  path: string;
  name: string;
  used: boolean;
}

/** An object that the file labels. `number` is the number in M486, or its index in the file;
 * `name` is empty if the file has none. `centre_mm` and `outline_mm`, X and Y, come from
 * EXCLUDE_OBJECT_DEFINE; without it they are None and empty. */
export interface PrintObject {
  number: number;
  name: string;
  cancelled: boolean;
  centre_mm?: [number, number] | null;
  outline_mm: [number, number][];
}

/** The state of a printer; the values are the letters of M408. */
export type PrinterState = "A" | "B" | "H" | "I" | "P";

/** A question; with `options` the answer is one of them, otherwise a number in `unit`. */
export interface QuestionView {
  ask: string;
  unit: string;
  options: OptionView[];
}

/** The queued prints, the next one first. With `automatic`, the next print starts without
 * confirmation after a successful print; otherwise a user must confirm that the bed is clear. */
export interface Queue {
  prints: QueuedPrint[];
  automatic: boolean;
}

/** A file of the card. */
export interface QueueFile {
  path: string;
}

/** Whether the next print starts without confirmation after a successful print. Only for a printer
 * that clears its bed itself. */
export interface QueueMode {
  automatic: boolean;
}

/** A queued file of the card; `number` identifies it while it waits. */
export interface QueuedPrint {
  number: number;
  path: string;
}

/** A temperature that the printer shows, and the true temperature by a thermometer, in °C. */
export interface Reading {
  shown_c: number;
  true_c: number;
}

/** Readings of a heater's thermistor. */
export interface Readings {
  heater: string;
  readings: Reading[];
}

/** The reason why a request was refused. `others` are further problems of the request. */
export interface Refusal {
  error: Fault;
  others: Fault[];
}

/** An axis to measure with the accelerometer. */
export interface Resonance {
  axis: "x" | "y" | "z";
}

/** The retraction of G10 and G11: the length and its speed, the length that G11 returns in
 * addition, and the speed of G11. */
export interface RetractionStatus {
  length_mm: number;
  speed_mm_s: number;
  extra_mm: number;
  return_mm_s: number;
}

/** A print that was started with a run id. `file` is its path on the card; `reason` says why it
 * has failed. A print that has never begun has failed. */
export interface Run {
  run: string;
  file: string;
  state: "cancelled" | "done" | "failed" | "paused" | "printing";
  reason: string;
}

/** The path of the new machine file. */
export interface SavedMachine {
  path: string;
}

/** The last measurement of a bed screw. `height_mm` is the height of the bed at the screw.
 * `adjust` is how to turn it: `CW` or `CCW`, and turns as `full:minutes`, where 60 minutes are
 * one turn. `base` marks the reference screw, which is not turned. */
export interface ScrewStatus {
  name: string;
  height_mm: number;
  adjust: string;
  base: boolean;
}

/** Lines of G-code. */
export interface Script {
  script: string;
}

/** A temperature sensor without a heater. `celsius` is its last reading, None before the first one
 * and while the sensor is broken; `lowest_c` and `highest_c` are its extremes since the start.
 * `fault` is `open`, `short`, `silent`, `garbled`, `other-chip` or `apart` for a broken sensor,
 * `low` or `high` beyond its range, or empty. `age_s` is 0 while the board reports, otherwise the
 * age of the reading in s. `humidity`, %, and `pressure_hpa` are None if the sensor does not
 * measure them. */
export interface SensorStatus {
  celsius?: number | null;
  lowest_c?: number | null;
  highest_c?: number | null;
  fault: string;
  age_s: number;
  humidity?: number | null;
  pressure_hpa?: number | null;
}

/** The angle of a servo; null switches its signal off. */
export interface ServoAngle {
  degrees?: number | null;
}

/** A servo: its largest angle, and the lengths of its pulses at 0° and at `max_deg`. */
export interface ServoOfMachine {
  max_deg: number;
  min_pulse_us: number;
  max_pulse_us: number;
}

/** A value that a command can set: `command` with `word` and the value. `value` is the active
 * value, `file` that of the machine file, and `stored` the value that M500 has stored; each of
 * the last two may be None. `source` is the source of the active value: `file`, `stored` or
 * `command`. */
export interface SettingValue {
  group: string;
  command: string;
  word: string;
  value: string;
  file?: string | null;
  stored?: string | null;
  source: string;
}

/** The input shaper of an axis; 0 Hz: the axis is not shaped. */
export interface ShaperStatus {
  type: string;
  frequency_hz: number;
  damping: number;
}

/** The machine file of a shipped machine. Copy it as a start for your own. */
export interface ShippedFile {
  name: string;
  text: string;
}

/** A machine that comes with Passo. */
export interface ShippedMachine {
  name: string;
  description: string;
  geometry: string;
  size_mm: number[];
  steppers: string[];
  board: string;
}

/** A part of the simulated printer: its possible faults, `none` first, and its current fault. */
export interface SimulatedPart {
  part: string;
  faults: string[];
  active: string;
}

/** The place in the code: `line` is 0, and `code` empty, if this installation lacks the file. */
export interface SourceView {
  file: string;
  symbol: string;
  line: number;
  code: string;
}

/** The factor of all feedrates; 1 leaves them as in the file. */
export interface SpeedFactor {
  factor: number;
}

/** An axis that homes by the stall of its motor, and how often it homes to measure how exactly. */
export interface StallAxis {
  axis: string;
  repeats?: number;
}

/** `known`: the run id was used before, and nothing has started. */
export interface Started {
  known: boolean;
}

/** The status of a printer at one moment. Positions are the current position in program
 * coordinates, in mm, by axis and `e`; `homed` are the axes with a certain position; fans are
 * fractions of full speed; `time_s` is print time since the start; `halted` is the reason why the
 * printer is halted, or empty, and `faults` has the same as errors of the catalogue; `link` is a
 * name of `LinkState` in lower case; `message` is the text of M117; `question` is the question
 * that waits for an answer of the user (M0, a pause), or empty: M876 S0 answers it; `progress` is
 * the fraction of the print that is done; for a print by a host, the host reports it (M73, M532).
 * `job` is None while no file is printed; `ended` is the last print, until another file is
 * selected; `last_print` is the newest row of the history; `interrupted` is the print that M1000
 * resumes, None without one; `queue` are the prints that wait; `started`: the boards have started
 * at least once; `macros` are the variables of the macros, by name. Below `min_extrude_c` the
 * hotend of `tool` moves no filament; 0 means no limit (M302). `unsaved` are the settings that
 * M500 would change, as commands with their values, by headings, without those that files and
 * pages change for a while; `saved_variables` are the variables of SAVE_VARIABLE. `bed` is None
 * on a machine without a probe. `moving_s` is the print time for which the machine has printed or
 * moved without a break. `gantry_level`: the Z motors have levelled the gantry, and have been on
 * since then; None on a machine that cannot do this. `skew_profile` is the name of the active
 * saved skew, or empty; None without skew and profiles. `screws` are the last measurements of the
 * bed screws; `screws_limit_mm` is their allowed difference, if it is exceeded. `shapers` are the
 * input shapers by axis, `advances` the pressure advance of each extruder; `retraction` is None
 * on a machine without filament. `cooled_c` are the targets of the heaters that a long pause or a
 * fault has switched off, °C by name: they warm up before the print resumes. `buttons` are the
 * buttons by name, with True while they are pressed. `outputs` are fractions of fully on, without
 * outputs that are fixed; `sensors` are those without a heater; `fan_targets_c` are the targets
 * of the fans with a thermostat, 0 while they are off. `inputs` are those of filament sensors
 * (`filament-` and the name) and buttons (`button-` and the name). */
export interface Status {
  state: PrinterState;
  halted: string;
  time_s: number;
  position_mm: Record<string, number>;
  homed: string[];
  tool: number;
  heaters: Record<string, HeaterStatus>;
  fans: Record<string, number>;
  speed_factor: number;
  motion: MotionStatus;
  axes: Record<string, AxisStatus>;
  boards: Record<string, BoardStatus>;
  flow_factors: number[];
  faults: FaultStatus[];
  link: string;
  message: string;
  question: string;
  power_supply: boolean;
  files: FilesStatus;
  progress?: number | null;
  job?: JobStatus | null;
  ended?: EndedJob | null;
  last_print?: LastPrint | null;
  interrupted?: InterruptedPrint | null;
  queue: Queue;
  started: boolean;
  macros: Record<string, Record<string, unknown>>;
  min_extrude_c: number;
  unsaved: Record<string, Record<string, string>>;
  saved_variables: Record<string, unknown>;
  moving_s: number;
  bed?: BedStatus | null;
  skew_profile?: string | null;
  gantry_level?: boolean | null;
  screws: ScrewStatus[];
  screws_limit_mm?: number | null;
  shapers: Record<string, ShaperStatus>;
  advances: AdvanceStatus[];
  retraction?: RetractionStatus | null;
  cooled_c: Record<string, number>;
  outputs: Record<string, number>;
  fan_targets_c: Record<string, number>;
  servos_us: Record<string, number>;
  fan_rpm: Record<string, number | null>;
  lights: Record<string, [number, number, number, number][]>;
  sensors: Record<string, SensorStatus>;
  filament_sensors: Record<string, FilamentSensorStatus>;
  buttons: Record<string, boolean>;
  inputs: Record<string, InputStatus>;
  drivers: Record<string, DriverStatus>;
}

/** The status, and a number that increases with each change of it. */
export interface StatusNow {
  version: number;
  status: Status;
}

/** The number of received bytes of a file, and whether the file is on the card. */
export interface StoredFile {
  path: string;
  size: number;
  complete: boolean;
}

/** A mesh and the conditions of its measurement: `date` as text, the temperature of the bed
 * `bed_c` in °C, and `reference`, the source of Z 0. A value that the file does not have is empty
 * or None. */
export interface StoredMesh {
  name: string;
  mesh: Mesh;
  date: string;
  bed_c?: number | null;
  reference: string;
  interpolation: "bicubic" | "bilinear";
}

/** One printer. `id` is a UUID that stays when its name or its address changes. */
export interface Summary {
  id: string;
  name: string;
  version: string;
  state: "busy" | "halted" | "idle" | "paused" | "printing";
  job?: SummaryJob | null;
  last_print?: LastPrint | null;
  heaters: SummaryHeater[];
  fault?: FaultStatus | null;
}

/** A heater in whole degrees. `celsius` is None while its sensor does not report; `target_c` is 0
 * while it is off. */
export interface SummaryHeater {
  name: string;
  celsius?: number | null;
  target_c: number;
}

/** The running print. `file` is its path on the card; `run` is the run id that came with its
 * start, or empty. `fraction` is 0 to 1 in thousandths; `left_s` and `layers` are None while they
 * are unknown. */
export interface SummaryJob {
  file: string;
  run: string;
  fraction: number;
  left_s?: number | null;
  printed_s: number;
  layer: number;
  layers?: number | null;
  filament_mm: number;
}

/** A table with a heading for each column. */
export interface TableView {
  title: string;
  columns: string[];
  rows: string[][];
}

/** `ages_s` are the times of the samples, in seconds before the answer, oldest first; `sensors`
 * are the temperatures of the sensors without a heater, °C. */
export interface Temperatures {
  ages_s: number[];
  heaters: Record<string, HeaterPast>;
  sensors: Record<string, (number | null)[]>;
}

/** The coefficients of a heater's thermistor: its resistance at 25 °C, β, and C of the equation
 * 1/T = A + B·ln R + C·(ln R)³ with B = 1/β. */
export interface Thermistor {
  heater: string;
  r25_ohm: number;
  beta_k: number;
  c_per_k?: number;
}

/** A thermistor that a method has found. `residuals_c` are its errors at the readings, in °C;
 * `rms_c` is their root mean square. */
export interface ThermistorFit {
  method: "beta" | "now" | "steinhart-hart";
  r25_ohm: number;
  beta_k: number;
  c_per_k: number;
  residuals_c: number[];
  rms_c: number;
}

/** A tool: its extruder and its heater, null without one. */
export interface ToolOfMachine {
  extruder?: string | null;
  heater?: string | null;
}

/** Values of parameters, by name; the others keep their defaults. */
export interface Trial {
  language?: "en" | "it";
  values?: Record<string, number | string>;
}

/** One line of G-code, with lines to execute before and after it, such as `M204` and adjacent
 * moves. */
export interface TypedLine {
  line: string;
  before?: string;
  after?: string;
}

/** The result of a check of a machine file. `questions` are allowed values that are probably
 * wrong; `notes` are facts about the machine that its owner should know. */
export interface Validation {
  ok: boolean;
  problems: MachineProblem[];
  questions: MachineProblem[];
  notes: string[];
}

/** The version of Passo, and the name of the machine. */
export interface Version {
  passo: string;
  machine: string;
}

/** A command on the link: its text, and its bytes in hexadecimal digits. */
export interface WireCommand {
  board: string;
  motor: string;
  text: string;
  payload: string;
}
