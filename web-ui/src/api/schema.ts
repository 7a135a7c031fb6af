/** The types of the API, made from its table of operations: make reference. Numbers that
 * are not finite, and what a merge patch has removed, are missing. */

/** What changes of an account; what is left out stays. */
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

/** The answer of the printer, a string a line. */
export interface Answer {
  lines: string[];
}

/** The effect of a machine file that was written. `live` are the changed keys that act now;
 * `overridden` those that a stored setting or a command overrides; `restart` those that act after
 * `machine.restart`. `backup` is the path of a copy of the file before. */
export interface Applied {
  live: string[];
  overridden: string[];
  restart: string[];
  backup: string;
}

/** Axes to home; without any, all that have an endstop. */
export interface AxesToHome {
  axes?: string[];
}

/** An axis. `position_mm` is the plan's current position, in the program's coordinates;
 * `machine_mm` the same in the machine's. `homed`: its position is certain. Targets are kept
 * between `min_mm` and `max_mm`, in machine coordinates. */
export interface AxisStatus {
  position_mm: number;
  machine_mm: number;
  homed: boolean;
  min_mm: number;
  max_mm: number;
  babystep_mm: number;
}

/** The distance by which all moves that are not done yet shift along an axis, in mm, in addition
 * to earlier shifts. */
export interface Babystep {
  axis: string;
  distance_mm: number;
}

/** What is added to Z to follow the bed, in mm: `heights_mm[j][i]` at `xs_mm[i]`, `ys_mm[j]`;
 * empty before the bed is measured. `probe`: the machine has one. `method` is that of the machine
 * file; `procedures` are those that the machine allows. `measured` is the kind of correction: a
 * `mesh` has its own points, a `fit` is sampled over the axes. */
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

/** A place of the bed, mm, and its height as it was measured. */
export interface BedPoint {
  x_mm: number;
  y_mm: number;
  height_mm: number;
}

/** How the bed is measured and corrected. `method` and `probe` are those of the machine file;
 * `on`: the correction is in force; `profile` is the stored mesh in use, or empty, and `meshes`
 * are all that are stored; `mesh` is the one in use. `points` are those that were measured last;
 * `rms_mm` is what they deviate from their mean, `left_rms_mm` from the correction; both are None
 * without any. `surface` is the correction itself, None without one; `fade_mm` the height at
 * which it has faded out. `probe_offset_mm` and `trigger_height_mm` are as M851 has set them.
 * `measured` of `to_measure` points are done in a run; both are 0 without one. `manual` is the
 * paper test under way; `triggered` is what the probe was when it was asked last. */
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
}

/** What the correction adds to Z, in mm, at even places from one corner of the bed to the opposite
 * one: rows along X, the front one first. */
export interface BedSurface {
  from_mm: [number, number];
  to_mm: [number, number];
  rows_mm: number[][];
}

/** A board: what it is, the program that flashes it (`flash`, null if there is none), and what the
 * user does by hand before and after. `state` is `ready`, or says what is missing. */
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
 * traffic of its link since the start; `simulated`: it is software. `awake_s` is how much of the
 * last 5 s its firmware had work; `task_s` and `task_deviation_s` are mean and standard deviation
 * of one pass of its work. None until it reports them, and for a simulated chip. */
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

/** A build. `of` is the name of the machine or board that it is for; `log` has its lines so far;
 * `seconds` is how long it has taken so far, or took. */
export interface Build {
  number: number;
  of: string;
  state: "cancelled" | "done" | "failed" | "running";
  log: string[];
  images: Image[];
  seconds: number;
}

/** The images to build: the image of the shipped board `board`; or the images for all boards of
 * the machine file `text`; or those of the printer's own machine file, if both are null. `board`
 * has priority if both are given. */
export interface BuildOrder {
  board?: string | null;
  text?: string | null;
}

/** The user confirms that no print is left on the bed. */
export interface ClearBed {
  bed_clear: boolean;
}

/** A command that the printer knows: its parameters, and what it does. */
export interface Command {
  code: string;
  parameters: string;
  text: string;
}

/** `changes` are the keys whose values differ from those of the running machine; values from files
 * that the text names are included. `text` is the difference from the machine file, as `diff -u`
 * shows it. */
export interface Difference {
  changes: KeyChange[];
  text: string;
}

/** A print that is over: done, cancelled or failed, why it failed, and its progress. */
export interface EndedJob {
  outcome: string;
  reason: string;
  job: JobStatus;
}

/** A command of the line: its effect, and its words as the lexer reads them. `code` is empty for a
 * move without a G. */
export interface ExplainedCommand {
  code: string;
  text: string;
  words: string[];
}

/** The call of a macro, and the lines that it became. */
export interface ExplainedMacro {
  call: string;
  lines: string[];
}

/** A planned move: lengths in `unit`, mm or degrees; speeds in units/s, accelerations in units/s²,
 * times in seconds. `start_s` and `end_s` are print times. `start_mm` and `end_mm` are positions
 * of X, Y, Z and E. `kind` of a wait is `dwell`. `shape` is trapezoid, triangle or constant
 * speed. `tolerance_us` is the maximum error of its step times, which may be larger to keep
 * within the board's budget. */
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

/** The steps of a motor as the board executed them; print times of the first and the last. */
export interface ExplainedSteps {
  motor: string;
  count: number;
  first_s?: number | null;
  last_s?: number | null;
}

/** The explanation of one line. `number` is its line number (N), empty without one; `checksum`: it
 * has a checksum. `planned` is the number of planned moves; `moves` has all of them, or the first
 * and the last. `junction_before` and `junction_after` say what limits the speed there; both are
 * empty if the line moves nothing. `sub_program`: it calls a sub-program, whose lines move.
 * `wire` has the commands of boards whose bytes are known; `frame` is a frame with the first
 * command. `tick_ns` is the length of a clock tick by board; the name of the main board is empty.
 * `unseen`: commands of other boards are missing in `wire`. */
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

/** An error of the catalogue. `message` says what is wrong and where, `action` what to do next;
 * `values` are those in the message. */
export interface Fault {
  code: string;
  part: string;
  message: string;
  action: string;
  values: Record<string, unknown>;
}

/** An error of the catalogue: its code, the part that it concerns, the sentence, and the next
 * action. */
export interface FaultStatus {
  code: string;
  part: string;
  text: string;
  action: string;
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

/** The path of a file or folder on the card, from its root; names have `/` between them. */
export interface FilePath {
  path: string;
}

/** The path of a file on the card. */
export interface FileToPrint {
  path: string;
}

/** The card: whether it is mounted, the path of the file that is selected to print, or empty, and
 * the folder that is the card, or empty. */
export interface FilesStatus {
  mounted: boolean;
  selected: string;
  folder: string;
}

/** The factor of a tool's extrusion; 1 is that of the file. */
export interface FlowFactor {
  factor: number;
}

/** A folder of the card and its content, by name; the free bytes of the card. */
export interface Folder {
  path: string;
  free_bytes: number;
  entries: FileEntry[];
}

/** A heater. `max_c` is the temperature above which it is switched off. */
export interface HeaterOfMachine {
  kind: "bed" | "chamber" | "hotend";
  max_c: number;
}

/** A value for each time; null where the sensor had not reported. */
export interface HeaterPast {
  celsius: (number | null)[];
  target_c: (number | null)[];
  power: (number | null)[];
}

/** A heater. `celsius` is None until its sensor has reported; `target_c` is 0 while it is off;
 * `power` is a fraction of full power; `fault` is the sentence of a protection, or empty. Below
 * `min_extrude_c` a hotend moves no filament; 0: it does at any temperature (M302), or it is not
 * a hotend. */
export interface HeaterStatus {
  celsius?: number | null;
  target_c: number;
  power: number;
  fault: string;
  min_extrude_c: number;
}

/** The target of a heater, in °C; 0 switches it off. */
export interface HeaterTarget {
  celsius: number;
}

/** A heater to tune at a temperature in °C: the gains of PID by relay oscillation, or its model
 * from the rise with full power, which needs a cold heater. */
export interface HeaterTune {
  heater: string;
  celsius: number;
  method?: "model" | "pid";
}

/** The identity of the caller. `role` is `public` without a log-in; `set_up`: there is an
 * administrator; `code_needed`: creating it takes the one-time code; `fresh`: the password was
 * entered within the last five minutes. */
export interface Identity {
  name: string;
  role: string;
  set_up: boolean;
  code_needed: boolean;
  fresh: boolean;
}

/** An image that was built: its file in the zip; sizes in bytes, with those of the chip. */
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

/** The file that is printed. `fraction` is the part of its time that is done, or of its bytes
 * while its time is not known yet, 0 to 1; `line` and `layer` are those of the current move (0:
 * none yet); `printed_s` is the print time so far, without pauses; `left_s` is the time that the
 * rest of its moves takes, without heating. `layers` and `left_s` are None while they are not
 * known. `current_object` is the number, among `objects`, of the one that is printed now. `path`
 * is its path on the card; `offset` of its `size` bytes are read and planned; `elapsed_s` is host
 * time since the start, with pauses; `filament_mm` is the filament that all extruders have pushed
 * for it, without pauses; `extruding_s` is the part of `printed_s` since the first extrusion, or
 * all of it on a machine without filament. */
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
}

/** The distances of axes, or of the extruder `e`, from the end of the last move, in mm, and the
 * speed. */
export interface Jog {
  distances_mm: Record<string, number>;
  speed_mm_s: number;
}

/** An upload that was interrupted: the bytes from `offset` on may be sent within some minutes. */
export interface KeptUpload {
  path: string;
  offset: number;
  total: number;
}

/** A key whose value differs; a value is null if the key is missing. `acts` says when the change
 * has an effect: at once (`live`), or after a `restart`. */
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
 * board or sensor that the machine file names), or `default`. `setting` is the command and the
 * word that also set the value; it is empty for most keys. `setting_value` is the value in force,
 * and `setting_source` is its source: `file`, `stored` (M500), or `command`. */
export interface KeyValue {
  key: string;
  value: unknown;
  source: "board" | "default" | "file";
  line?: number | null;
  setting: string;
  setting_value: string;
  setting_source: string;
}

/** A procedure that levels by what the probe measures. */
export interface Levelling {
  procedure: "delta" | "gantry" | "screws";
}

/** A line of a console, which counts from 1, or is 0 for all consoles. `received`: from a host to
 * the printer. */
export interface Line {
  console: number;
  received: boolean;
  text: string;
}

/** A name and its password. */
export interface LogIn {
  name: string;
  password: string;
}

/** A log-in of an account, with times in seconds since 1970; `own` is that of the caller. */
export interface LogInRecord {
  id: string;
  account: string;
  started_s: number;
  used_s: number;
  own: boolean;
}

/** A file that can be downloaded, its bytes, and when it was changed, in seconds since 1970. */
export interface LogRecord {
  name: string;
  size: number;
  changed_s: number;
}

/** A machine as its file describes it. `fans` are those that commands set; `tools` are what T0,
 * T1, … select. */
export interface Machine {
  name: string;
  description: string;
  axes: string[];
  heaters: Record<string, HeaterOfMachine>;
  fans: string[];
  tools: ToolOfMachine[];
}

/** The text of the machine file. `path` is null if there is no file that may be changed: for a
 * shipped machine, or one that a program made. `sha256` is the SHA-256 of the text;
 * `machine.apply` needs it. */
export interface MachineFile {
  path?: string | null;
  text: string;
  sha256: string;
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

/** The text of a machine file, in TOML. Relative paths in it, of data dictionaries and tables of
 * sensors, begin at the folder of the printer's own machine file. */
export interface MachineText {
  text: string;
}

/** A key that was just made. `key` is shown only this once. */
export interface MadeKey {
  record: KeyRecord;
  key: string;
}

/** A paper test: point `number` of `count`, Z of the nozzle, and the nearest heights that were
 * tried below and above it, mm. */
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

/** Facts about a file. While `state` is `pending` there is no plan yet; `refused`: the file cannot
 * be printed as it is, and `problems` are the reasons, for example moves out of range. */
export interface Metadata {
  path: string;
  state: "known" | "pending" | "refused";
  slicer: string;
  objects: string[];
  thumbnails: Picture[];
  plan?: Plan | null;
  problems: Fault[];
}

/** The motion of the machine. `speed_mm_s` is that of the nozzle now, `filament_mm_s` that of the
 * filament; `queued_s` is the duration of the planned motion. `max_speed_mm_s`,
 * `max_accel_mm_s2`, `minimum_cruise_ratio` and `junction_deviation_mm` are the limits of the
 * path; the first is None if the axes alone limit it. `absolute`, `absolute_e` and
 * `feedrate_mm_s` hold for the next move of the program. It begins at `end_mm` of the machine, X,
 * Y, Z and filament, which is `program_end_mm` of the program. */
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
}

/** An account to make. */
export interface NewAccount {
  name: string;
  password: string;
  role: "admin" | "operator" | "viewer";
}

/** An API key to make; `name` says what it is for. */
export interface NewKey {
  name: string;
  role?: "admin" | "operator" | "viewer";
}

/** The text to write. `replaces` is the `sha256` that `machine.file` gave for the text before the
 * edit: a file that has changed since then is not overwritten. */
export interface NewMachineFile {
  text: string;
  replaces: string;
}

/** The file or folder to rename, and its new path, which may be in another folder. */
export interface NewName {
  path: string;
  to: string;
}

/** A value to set: `command` and `word` as `settings.list` names them. */
export interface NewValue {
  command: string;
  word: string;
  value: number;
}

/** Whether an object is left out. */
export interface ObjectState {
  cancelled: boolean;
}

/** The fault that a part has from now on; `none` ends it. `noise` may have an amount, as in
 * `noise:0.05`. */
export interface PartFault {
  fault: string;
}

/** The password of the log-in. */
export interface Password {
  password: string;
}

/** The password of the log-in, and the one that replaces it. */
export interface PasswordChange {
  old: string;
  new: string;
}

/** A print that is over. `started_s` is the wall clock in seconds since 1970, None if that is not
 * known; `ended` is done, cancelled, failed or interrupted; `print_s` is print time without
 * pauses; `note` is a remark about a problem, or empty. */
export interface PastPrint {
  file: string;
  size: number;
  started_s?: number | null;
  ended: string;
  print_s: number;
  filament_mm: number;
  note: string;
}

/** A thumbnail, which can be requested by its number, and its size in pixels. */
export interface Picture {
  number: number;
  width: number;
  height: number;
  type: string;
}

/** A file as this printer would print it. `total_s` is the sum of `moving_s`, `dwell_s` and
 * `heating_s`; `limits_s` gives for each limit of the machine how long it limits the speed. */
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

/** An object that the file labels. `number` is the one of M486, or its index in the file; `name`
 * is empty if the file has none. `centre_mm` and `outline_mm`, X and Y, are those of
 * EXCLUDE_OBJECT_DEFINE, else None and empty. */
export interface PrintObject {
  number: number;
  name: string;
  cancelled: boolean;
  centre_mm?: [number, number] | null;
  outline_mm: [number, number][];
}

/** The state of a printer; the values are the letters of M408. */
export type PrinterState = "A" | "B" | "H" | "I" | "P";

/** The prints that wait, the next one first. With `automatic` the next one starts without
 * confirmation after one that has succeeded; otherwise it waits until a user confirms that the
 * bed is clear. */
export interface Queue {
  prints: QueuedPrint[];
  automatic: boolean;
}

/** A file of the card. */
export interface QueueFile {
  path: string;
}

/** Whether the next print starts without confirmation after one that has succeeded. Only for a
 * printer that clears its bed itself. */
export interface QueueMode {
  automatic: boolean;
}

/** A file of the card that is to be printed; `number` stays the same while it waits. */
export interface QueuedPrint {
  number: number;
  path: string;
}

/** A temperature that the printer shows, and the true one that a thermometer shows, in °C. */
export interface Reading {
  shown_c: number;
  true_c: number;
}

/** Readings of a heater's thermistor. */
export interface Readings {
  heater: string;
  readings: Reading[];
}

/** Why a request was not carried out. `others` are further problems that were found. */
export interface Refusal {
  error: Fault;
  others: Fault[];
}

/** A screw of the bed as it was measured last: the height of the bed there, mm, and what to turn:
 * `adjust` are turns and minutes of a clock, `CW` or `CCW` before them. `base`: it stays. */
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

/** A value that commands set: `command` with `word` and a value sets it. `value` is in force,
 * `file` is that of the machine file (None: it has none), `stored` the one that M500 has stored
 * (None: none is). `source` says which of them is in force: `file`, `stored` or `command`. */
export interface SettingValue {
  group: string;
  command: string;
  word: string;
  value: string;
  file?: string | null;
  stored?: string | null;
  source: string;
}

/** The machine file of a shipped machine; copy it to begin your own. */
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

/** A part of the simulated printer: the faults that it can have, `none` first, and the one that it
 * has now. */
export interface SimulatedPart {
  part: string;
  faults: string[];
  active: string;
}

/** The factor of all feedrates; 1 is that of the file. */
export interface SpeedFactor {
  factor: number;
}

/** A printer at one moment. Positions are the program's coordinates of where the machine is, in
 * mm, by axis and `e`; `homed` are the axes whose position is certain; fans are fractions of full
 * speed; `time_s` is print time since the start; `halted` says why nothing moves or heats, or is
 * empty, and `faults` the same as errors of the catalogue; `link` is a name of `LinkState` in
 * lower case; `message` is the text of M117; `progress` is the fraction of a print that is done,
 * also of a host's that reports it (M73, M532); `job` is None while no file is printed; `ended`
 * is the last print, until another file is selected; `started`: the boards have started at least
 * once; `macros` are the variables of the macros, by name. Below `min_extrude_c` the hotend of
 * `tool` moves no filament; 0: it does at any temperature (M302). `unsaved` are the settings that
 * M500 would change on its medium, as commands with their values, by headings; `saved_variables`
 * are those of SAVE_VARIABLE. `bed` is None on a machine without a probe. `moving_s` is the print
 * time for which the machine has printed or moved without a rest. `gantry_level`: the motors of Z
 * have levelled the gantry, and were on since then; None where they cannot. `screws` are those of
 * the bed as they were measured last, `screws_limit_mm` what they may differ by, if they differ
 * by more. */
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
  power_supply: boolean;
  files: FilesStatus;
  progress?: number | null;
  job?: JobStatus | null;
  ended?: EndedJob | null;
  started: boolean;
  macros: Record<string, Record<string, unknown>>;
  min_extrude_c: number;
  unsaved: Record<string, Record<string, string>>;
  saved_variables: Record<string, unknown>;
  moving_s: number;
  bed?: BedStatus | null;
  gantry_level?: boolean | null;
  screws: ScrewStatus[];
  screws_limit_mm?: number | null;
}

/** The status, and a number that increases with each change of it. */
export interface StatusNow {
  version: number;
  status: Status;
}

/** The number of bytes of a file that have come, and whether it is on the card now. */
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

/** `ages_s` are the times of the samples, in seconds before the answer, oldest first. */
export interface Temperatures {
  ages_s: number[];
  heaters: Record<string, HeaterPast>;
}

/** The coefficients of a heater's thermistor: its resistance at 25 °C, β, and C of the equation
 * 1/T = A + B·ln R + C·(ln R)³ with B = 1/β. */
export interface Thermistor {
  heater: string;
  r25_ohm: number;
  beta_k: number;
  c_per_k?: number;
}

/** A thermistor by a method. `residuals_c` is what it would show above each true temperature, in
 * °C; `rms_c` is their root mean square. */
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

/** One line of G-code, and lines that are carried out before and after it, such as `M204` and
 * moves that it joins. */
export interface TypedLine {
  line: string;
  before?: string;
  after?: string;
}

/** Whether a text is a valid machine file. `questions` are values that are allowed but are
 * probably wrong; `notes` are facts about the machine that its owner should know. */
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

/** A command on the wire: its text, and its bytes in hexadecimal digits. */
export interface WireCommand {
  board: string;
  motor: string;
  text: string;
  payload: string;
}
