/** What the API says of files. */

import type { Fault } from "./schema";

/** A file or folder. `size` is in bytes, 0 of a folder; `modified_s` is the time of its last
 * change, in seconds since 1970. */
export interface FileEntry {
  name: string;
  path: string;
  folder: boolean;
  size: number;
  modified_s: number;
}

/** A folder of the card and what is in it, by name; how many bytes the card has free. */
export interface Folder {
  path: string;
  free_bytes: number;
  entries: FileEntry[];
}

/** What is known of a file. While `state` is `pending` there is no plan yet; `refused`: the file
 * cannot be printed as it is, and `problems` are the reasons, such as what is out of range. */
export interface Metadata {
  path: string;
  state: "known" | "pending" | "refused";
  slicer: string;
  objects: string[];
  thumbnails: Picture[];
  plan?: Plan | null;
  problems: Fault[];
}

/** A thumbnail, to be had by its number, and its size in pixels. */
export interface Picture {
  number: number;
  width: number;
  height: number;
  type: string;
}

/** A file as this printer would print it. `total_s` is the sum of `moving_s`, `dwell_s` and
 * `heating_s`; `limits_s` tells for each limit of the machine how long it bounds the speed. */
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
