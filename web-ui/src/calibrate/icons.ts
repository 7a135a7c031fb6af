/** The icon of each task. */

import type { IconName } from "../parts/icons";
import type { TaskName } from "../state/calibration.svelte";

export const ICONS_OF: Record<TaskName, IconName> = {
  heater: "flame",
  thermistor: "thermometer",
  steps: "motor",
  paper: "down",
  bed: "bed",
  shaper: "wave",
  advance: "drop",
};
