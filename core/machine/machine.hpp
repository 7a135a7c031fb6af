// A machine as numbers for the core. It is created once from the validated configuration.
#pragma once
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "base/types.hpp"
#include "geometry/geometry.hpp"
#include "machine/filters.hpp"
#include "machine/height_map.hpp"

namespace passo {

enum class JunctionLaw : uint8_t { deviation, square_corner, cornering_distance, jerk };

struct Axis {  // X, Y, Z and further linear axes
  std::string name;
  char letter;
  double min, max;         // mm
  double speed, accel;     // mm/s, mm/s²
  double jerk;             // change of speed that the junction law `jerk` allows, mm/s
  double cornering_steps;  // for the junction law `cornering_distance`
  bool filament = false;   // an axis that pushes filament: it is not homed and has no limits
  bool by_arms = false;    // homed together with all other axes that arms move
};

struct Extruder {  // one motor that pushes filament
  std::string name;
  double speed, accel, jerk;
  double cornering_steps = 40;
  double advance_s = 0;  // pressure advance
};

struct Tool {
  int extruder;
  double offset[3];
};

// Boards whose loads are calculated separately. Further boards share the last budget.
constexpr size_t kBudgets = 4;
constexpr uint8_t kNoBudget = 255;

enum class Drive : uint8_t { actuator, axis, extruder };

struct StepperSpec {
  std::string name;
  Drive drive;
  int index;                           // number of the actuator, axis or extruder
  double steps_per_unit;               // unit: mm, or degrees for rotary actuators
  int64_t pulse, dir_setup, dir_hold;  // ticks
  double max_rate;                     // steps per second
  double speed, accel, min, max;       // in units; infinite without a limit
  uint16_t board = 0;                  // 0: main board
  uint8_t budget = 0;                  // index in Machine::budgets, or kNoBudget
};

struct Limits {
  double print_accel, travel_accel, retract_accel, speed;
  JunctionLaw junction;
  double junction_deviation;
  double square_corner;  // speed in a corner of 90°, mm/s
  double minimum_cruise_ratio;
  double least_speed_gain;  // a move accelerates only if its speed rises by this fraction over the
                            // faster end
};

// The capacity of a board and its link for all motors together. Infinite if not configured.
struct Budget {
  double step_rate = kInfinity;     // steps per second
  double command_rate = kInfinity;  // commands per second
  double burst = 0;                 // commands that may exceed that rate for a moment
  bool by_link = false;             // command_rate is a limit of the link, else of the processor
  double commits = 0;  // commits per second, each with the commands of a stop of all motors
};

// Commands that the machine file defines: names of macros, and codes by which a macro calls the
// built-in command that it replaces.
struct Macros {
  std::unordered_set<std::string> names;
  std::unordered_map<std::string, std::string> built_in;

  bool any() const { return !names.empty(); }
  bool has(const std::string& code) const { return any() && names.count(code) > 0; }
  // Whether `code` is also a built-in command.
  bool replaces(const std::string& code) const {
    return std::any_of(built_in.begin(), built_in.end(),
                       [&](const auto& pair) { return pair.second == code; });
  }
  // The built-in command that a macro calls by this code, or null.
  const std::string* original(const std::string& code) const {
    if (built_in.empty()) return nullptr;
    const auto at = built_in.find(code);
    return at == built_in.end() ? nullptr : &at->second;
  }
};

// Retraction by G10 and G11, until M207 and M208 change it: lengths of filament, speeds, and the
// hop. A recover speed of 0 means the speed of the retraction. `swap_mm` is the length for a tool
// change.
struct Retraction {
  double mm = 3, feed_mm_s = 45, hop_mm = 0, recover_mm = 0, recover_feed_mm_s = 0;
  double swap_mm = 13, swap_recover_mm = 0;
};

struct Machine {
  std::string name;
  double clock_hz;
  double tolerance;  // maximum error of a step in either direction, ticks
  std::vector<Axis> axes;
  std::vector<Extruder> extruders;
  std::vector<Tool> tools;
  std::vector<StepperSpec> steppers;
  Limits limits;
  std::vector<Budget> budgets;  // of boards with motors, at most kBudgets
  size_t boards = 1;
  std::vector<uint16_t>
      output_boards;  // board of each output; outputs after the end are on the main board
  std::shared_ptr<const Geometry> geometry;
  std::shared_ptr<const HeightMap> height_map;  // null: the bed is flat
  Filters filters;
  Macros macros;
  Retraction retraction;
  std::string motor_letters;  // letters of actuators that are not axes, but which G1 can move
  bool joints = false;  // during homing: X, Y and Z are positions of the first three actuators

  // Whether the machine has filament, in extruders or moved by axes.
  bool prints() const {
    return !extruders.empty() ||
           std::any_of(axes.begin(), axes.end(), [](const Axis& axis) { return axis.filament; });
  }
  bool pushes_filament(const StepperSpec& s) const {
    return s.drive == Drive::extruder || (s.drive == Drive::axis && axes[size_t(s.index)].filament);
  }

  // The height of the nozzle for the geometry: planned Z plus bed correction.
  double raised(const double* p) const {
    return height_map ? p[2] + height_map->at(p[0], p[1], p[2]) : p[2];
  }

  // The planned Z at X, Y if the nozzle is at `height`.
  double plan_z(double x, double y, double height) const {
    return height_map ? height_map->plan_z(x, y, height) : height;
  }

  // Maximum error of a step, in ticks, if the budget of a board requires a larger one than usual.
  double widest_tolerance() const {
    const bool bounded = std::any_of(budgets.begin(), budgets.end(),
                                     [](const Budget& b) { return b.command_rate < kInfinity; });
    return bounded ? std::max(tolerance, 25e-6 * clock_hz) : tolerance;
  }
};

// Index in MoveRequest::target of axis number i of Machine::axes.
inline int slot_of_axis(int i) { return i < 3 ? i : kExtra + i - 3; }

}  // namespace passo
