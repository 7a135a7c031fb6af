// A machine as the core sees it: plain numbers, compiled once from the validated configuration.
#pragma once
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/geometry.hpp"
#include "types.hpp"

namespace passo {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

enum class JunctionLaw : uint8_t { deviation, cornering_distance, jerk };

struct Axis {  // X, Y, Z and further linear axes
  std::string name;
  char letter;
  double min, max;         // mm
  double speed, accel;     // mm/s, mm/s²
  double jerk;             // mm/s, change of speed allowed at a junction (law `jerk`)
  double cornering_steps;  // law `cornering_distance`
};

struct Extruder {  // one motor that pushes filament
  std::string name;
  double speed, accel, jerk;
  double cornering_steps = 40;
};

struct Tool {
  int extruder;
  double offset[3];
};

enum class Drive : uint8_t { actuator, axis, extruder };

struct StepperSpec {
  std::string name;
  Drive drive;
  int index;                           // of the actuator, the axis or the extruder
  double steps_per_unit;               // unit: mm, or degree on rotary actuators
  int64_t pulse, dir_setup, dir_hold;  // ticks
  double max_rate;                     // steps per second
  double speed, accel, min, max;       // units; infinite where there is no limit
};

struct Limits {
  double print_accel, travel_accel, retract_accel, speed;
  JunctionLaw junction;
  double junction_deviation;
  double minimum_cruise_ratio;
};

struct Machine {
  std::string name;
  double clock_hz;
  double tolerance;  // ticks, two-sided bound of the compressor
  std::vector<Axis> axes;
  std::vector<Extruder> extruders;
  std::vector<Tool> tools;
  std::vector<StepperSpec> steppers;
  Limits limits;
  std::shared_ptr<const Geometry> geometry;
  bool joints = false;  // X, Y, Z of positions are the first three actuators' own, for homing
};

// Index in MoveRequest::target of axis number i of Machine::axes.
inline int slot_of_axis(int i) { return i < 3 ? i : kExtra + i - 3; }

}  // namespace passo
