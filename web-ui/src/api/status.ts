/** What the printer is doing: the tree of `GET /api/v1/status`. A number may be missing where it is
 * not finite or not known. */

export type PrinterState = "I" | "B" | "P" | "A" | "H";

export interface Heater {
  celsius?: number | null;
  target_c: number;
  power: number;
  fault: string;
}

export interface PrintObject {
  number: number;
  name: string;
  cancelled: boolean;
}

export interface Job {
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
}

export interface Axis {
  position_mm: number;
  machine_mm: number;
  homed: boolean;
  min_mm: number;
  max_mm: number;
  babystep_mm: number;
}

export interface Motion {
  speed_mm_s: number;
  filament_mm_s: number;
  queued_s: number;
  max_speed_mm_s?: number | null;
  max_accel_mm_s2: number;
  absolute: boolean;
  absolute_e: boolean;
  feedrate_mm_s: number;
  motors_on: boolean;
}

export interface Board {
  firmware: string;
  mcu: string;
  clock_hz: number;
  simulated: boolean;
  bytes_sent: number;
  bytes_resent: number;
}

export interface Fault {
  code: string;
  part: string;
  text: string;
  action: string;
}

export interface Status {
  state: PrinterState;
  halted: string;
  time_s: number;
  position_mm: Record<string, number>;
  homed: string[];
  tool: number;
  heaters: Record<string, Heater>;
  fans: Record<string, number>;
  speed_factor: number;
  motion: Motion;
  axes: Record<string, Axis>;
  boards: Record<string, Board>;
  flow_factors: number[];
  faults: Fault[];
  link: string;
  message: string;
  power_supply: boolean;
  files: { mounted: boolean; selected: string };
  progress?: number | null;
  job?: Job | null;
  last_job: string;
}

export type PrinterEvent = { kind: string } & Record<string, unknown>;

export type FeedMessage =
  | { type: "status"; version: number; status: Status }
  | { type: "changes"; version: number; changes: Record<string, unknown> }
  | { type: "event"; event: PrinterEvent }
  | { type: "lost"; events: number };
