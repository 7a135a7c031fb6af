// The speed and acceleration limits of a machine as rows: |row · direction| * speed ≤ limit.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "machine/machine.hpp"

namespace passo {

using LimitId = uint16_t;

// Names of the limits that can determine the speed of a move. All machines have these first ones.
enum FixedLimit : LimitId {
  kFeedrate,
  kDuration,
  kArc,
  kPathSpeed,
  kPrintAccel,
  kTravelAccel,
  kRetractAccel,
  kJunction,
  kBoard,
  kLink,
  kLaserPower,
  kAdvance,
  kAdvanceJunction,
  kBacklash,
};

struct Row {
  double c[kAxes];      // position of the limited part as a factor for each axis
  int axis;             // if ≥ 0: c is 1 for this axis and 0 for all others
  double speed, accel;  // units/s, units/s²
  LimitId speed_id, accel_id;
  double jerk = kInfinity;  // change of speed that is allowed at once, units/s
};

inline constexpr double kRounded = 1e-9;  // rounding of limits in M503, as a fraction

struct Constraints {
  std::vector<std::string> names{"feedrate",
                                 "duration",
                                 "arc",
                                 "path speed",
                                 "print acceleration",
                                 "travel acceleration",
                                 "retract acceleration",
                                 "junction",
                                 "board",
                                 "link",
                                 "laser power",
                                 "pressure advance",
                                 "pressure advance at junctions",
                                 "backlash"};
  std::vector<Row> rows;       // for X, Y, Z and further axes
  std::vector<Row> extruders;  // for each extruder
  std::vector<Row> actuators;  // limits of each actuator of a nonlinear geometry; c is unused

  // True if the soft limits of the axes do not keep the actuators within their limits, so that the
  // path of each move must be checked.
  bool checks_reach() const { return checks_reach_; }

  // Lowers a limit of an axis or extruder, or raises it again, at most to the machine's own limit.
  void set(const Machine& m, const std::string& axis, double Row::* limit, double value);

  // The limits after a change of the motors' steps or of the geometry's parameters. Limits that
  // were not lowered below the machine's own limits (`before`) become the new own limits.
  Constraints rescaled(const Constraints& before, const Machine& m) const;

  explicit Constraints(const Machine& m);

 private:
  bool checks_reach_ = false;

  template <typename Part>  // Axis or Extruder
  Row single(int axis, const Part& part) {
    LimitId speed = add_name(part.name + " speed"), accel = add_name(part.name + " acceleration");
    Row row{{}, axis, part.speed, part.accel, speed, accel, part.jerk};
    row.c[axis] = 1;
    return row;
  }
  LimitId add_name(const std::string& name);
  // `share`: fraction of the maximum step rate that may be used.
  void tighten(Row& row, const StepperSpec& s, double share = 1);
  void add_stepper(const Machine& m, const StepperSpec& s, bool linear);
};

}  // namespace passo
