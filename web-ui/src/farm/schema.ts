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

/** The attention of a printer is dealt with. `started` answers whether the run has started, if
 * that was unknown. */
export interface Attended {
  started?: boolean | null;
}

/** The user confirms that no print is left on the bed. */
export interface BedClear {
  bed_clear: boolean;
}

/** The whole farm, the first message of the hub's feed. */
export interface Farm {
  printers: PrinterView[];
  jobs: JobView[];
  groups: PowerGroup[];
  queue_paused: boolean;
}

/** A line of the log of the farm. `who` is a user, or `hub`. */
export interface FarmEvent {
  number: number;
  time_s: number;
  who: string;
  what: string;
  printer: string;
  job: string;
  run: string;
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

/** A file of the hub: its content never changes. `materials`, `nozzle_mm` and `print_s` come from
 * the slicer's comments, empty or None if it says nothing. */
export interface FileView {
  sha256: string;
  name: string;
  size: number;
  added_s: number;
  materials: string[];
  nozzle_mm?: number | null;
  print_s?: number | null;
  filament_mm?: number | null;
  has_picture: boolean;
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

/** Changes of a job; an omitted value stays. `quantity` is at least the number of runs that are
 * done or running. `due_s` null removes the time. */
export interface JobChange {
  quantity?: number;
  priority?: number;
  needs?: Loaded;
  tags?: string[];
  due_s?: number | null;
  retries?: number;
  paused?: boolean;
}

/** A job: `quantity` prints of a file. `waiting`, `running`, `done`, `failed` count its runs;
 * `retries` failed runs are repeated on other printers. `each` are printers that print it once
 * each, in place of a free choice; `tags` limit the choice. `why` says why nothing of it starts
 * now, or is empty. A greater `priority` comes first. */
export interface JobView {
  id: string;
  file: string;
  name: string;
  quantity: number;
  priority: number;
  needs: Loaded;
  tags: string[];
  each: string[];
  due_s?: number | null;
  retries: number;
  paused: boolean;
  added_s: number;
  added_by: string;
  waiting: number;
  running: number;
  done: number;
  failed: number;
  cancelled: number;
  why: string;
}

/** An API key, without its secret; `made_s` is in seconds since 1970. */
export interface KeyRecord {
  id: string;
  name: string;
  role: "admin" | "operator" | "viewer";
  made_s: number;
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

/** The limit of an account, or of an API key as `key NAME`: the tags of its printers. */
export interface Limit {
  subject: string;
  tags: string[];
}

/** The tags of the printers of an account; none: all printers. */
export interface LimitTags {
  tags: string[];
}

/** What a printer has, or what a job needs; an empty text or None: not said, or any. */
export interface Loaded {
  material: string;
  colour: string;
  nozzle_mm?: number | null;
  plate: string;
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

/** A new key. `key` is shown only this once. */
export interface MadeKey {
  record: KeyRecord;
  key: string;
}

/** An account to make. */
export interface NewAccount {
  name: string;
  password: string;
  role: "admin" | "operator" | "viewer";
}

/** A job to add. `each` are ids of printers that print it once each; `quantity` is then their
 * number. `retries` failed runs are repeated on other printers. */
export interface NewJob {
  file: string;
  quantity?: number;
  priority?: number;
  needs?: Loaded;
  tags?: string[];
  each?: string[];
  due_s?: number | null;
  retries?: number;
}

/** An API key to make; `name` describes its purpose. */
export interface NewKey {
  name: string;
  role?: "admin" | "operator" | "viewer";
}

/** A printer to add. `code` is a one-time code of a Passo printer, `key` an API key in its place.
 * `name` is the printer's own unless it is given. */
export interface NewPrinter {
  url: string;
  kind?: "moonraker" | "passo";
  code?: string;
  key?: string;
  name?: string;
  tags?: string[];
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

/** Printers on one fuse: the heating printers of it stay below `limit_w` in sum. */
export interface PowerGroup {
  name: string;
  limit_w: number;
  used_w: number;
}

/** The greatest power of the heating printers of a group, W. */
export interface PowerLimit {
  limit_w: number;
}

/** Changes of a printer; an omitted value stays. An empty `power_group` is none. */
export interface PrinterChange {
  name?: string;
  url?: string;
  tags?: string[];
  loaded?: Loaded;
  power_group?: string;
  heating_w?: number;
  service?: boolean;
  clears_itself?: boolean;
}

/** Whether a file fits a printer, null while it is being planned; `why` not. `print_s` is its
 * estimate on this machine, null if it is not known. */
export interface PrinterFit {
  printer: string;
  fits?: boolean | null;
  why: string;
  print_s?: number | null;
}

/** The hub's runs on a printer. */
export interface PrinterStatistics {
  printer: string;
  done: number;
  failed: number;
  cancelled: number;
  printed_s: number;
  filament_mm: number;
}

/** A printer of the farm. `bed_clear`: `cleared_by` has said at `cleared_s` that its bed is empty,
 * and nothing has printed on it since. `attention` is what a user must look at before the next
 * run, or empty. `start_unknown`: it is unknown whether its run has started, and a user must
 * answer. `run` is the id of the hub's run on it, or empty. `last_word_s` is when it was last
 * heard of, while it is unreachable. `power_group` limits heating printers; `heating_w` is its
 * power while it heats. `service`: nothing starts on it. `clears_itself`: its bed counts as clear
 * after each print that is done. `printed_s`, `filament_mm` and `prints` are totals of the hub's
 * runs; `service_due` are the maintenance items that are due. */
export interface PrinterView {
  id: string;
  name: string;
  url: string;
  kind: "moonraker" | "passo";
  condition: "busy" | "connecting" | "halted" | "idle" | "paused" | "printing" | "unreachable";
  bed_clear: boolean;
  tags: string[];
  loaded: Loaded;
  attention: string;
  run: string;
  power_group: string;
  heating_w: number;
  service: boolean;
  clears_itself: boolean;
  seen?: Summary | null;
  prints: number;
  printed_s: number;
  filament_mm: number;
  service_due: string[];
  cleared_by: string;
  cleared_s?: number | null;
  last_word_s?: number | null;
  start_unknown: boolean;
}

/** A printer that announces itself and is not in the farm. */
export interface ProposedPrinter {
  id: string;
  name: string;
  url: string;
}

/** Whether nothing starts. */
export interface QueueState {
  paused: boolean;
}

/** The reason why a request was refused. `others` are further problems of the request. */
export interface Refusal {
  error: Fault;
  others: Fault[];
}

/** One print of a job on one printer. `state` is one of `RunState`; `attempt` counts from 1;
 * `reason` says why it failed. */
export interface RunView {
  id: string;
  job: string;
  file: string;
  name: string;
  printer: string;
  state: string;
  attempt: number;
  assigned_s: number;
  started_s?: number | null;
  ended_s?: number | null;
  filament_mm: number;
  printed_s: number;
  reason: string;
}

/** When a maintenance item is due: after hours of printing, prints or mm of filament, whichever
 * comes first. `done`: it has just been done, so that it counts from now. */
export interface ServiceInterval {
  every_h?: number | null;
  every_prints?: number | null;
  every_mm?: number | null;
  done?: boolean;
}

/** A maintenance item of a printer: its interval, what has been printed since it was done, and
 * when and by whom it was done. */
export interface ServiceItem {
  item: string;
  every_h?: number | null;
  every_prints?: number | null;
  every_mm?: number | null;
  hours: number;
  prints: number;
  filament_mm: number;
  due: boolean;
  done_s?: number | null;
  done_by: string;
}

/** The hub's runs with one material, or for one user; an empty name is an unknown one. */
export interface Share {
  name: string;
  done: number;
  failed: number;
  cancelled: number;
  printed_s: number;
  filament_mm: number;
}

/** The hub's runs: all, of each printer, with each material, for each user. */
export interface Statistics {
  done: number;
  failed: number;
  cancelled: number;
  printed_s: number;
  filament_mm: number;
  printers: PrinterStatistics[];
  materials: Share[];
  users: Share[];
}

/** What became of an emergency stop of a printer. `reason` says why it failed. */
export interface Stopped {
  printer: string;
  result: "done" | "refused" | "unreachable";
  reason: string;
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
