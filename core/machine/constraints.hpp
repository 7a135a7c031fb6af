// The speed and acceleration limits of a machine as rows: |row · direction| * speed ≤ limit.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "machine/machine.hpp"

namespace passo {

using LimitId = uint16_t;

// Names of the limits that can bind a move; the first ones are fixed.
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
  double c[kAxes];      // position of the limited part by axis position
  int axis;             // ≥ 0: c is 1 there and 0 elsewhere
  double speed, accel;  // units/s, units/s²
  LimitId speed_id, accel_id;
  double jerk = kInfinity;  // units/s by which the speed may change at once
};

inline constexpr double kRounded = 1e-9;  // fraction by which limits in M503 may be lower

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
  std::vector<Row> rows;       // for XYZ and further axes
  std::vector<Row> extruders;  // one per extruder
  std::vector<Row> actuators;  // nonlinear geometries: limits of each actuator, c unused

  // Soft limits of the axes do not bound the actuators: lines must be checked.
  bool checks_reach() const { return checks_reach_; }

  // Lowers or restores a limit of an axis or extruder, within the machine's own.
  void set(const Machine& m, const std::string& axis, double Row::* limit, double value);

  // The limits of a machine whose motors have other scales now, or whose geometry is another one of
  // the same kind: limits that were as high as `before`, the machine's own, are raised to the new
  // ones.
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
  // `share`: the fraction of the highest step rate that no interval may exceed.
  void tighten(Row& row, const StepperSpec& s, double share = 1);
  void add_stepper(const Machine& m, const StepperSpec& s, bool linear);
};

}  // namespace passo
