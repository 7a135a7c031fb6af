// Changes of the state from outside: homing, stops, and the state of another program.
#include <algorithm>
#include <iterator>
#include <utility>

#include "gcode/interpreter.hpp"

namespace passo {

Interpreter::Interpreter(const Machine& machine, std::vector<double> home, const LaserWords& laser)
    : machine_(&machine), home_(std::move(home)), laser_(laser),
      extruder_(machine.extruders.size(), 0.0), filament_(machine.extruders.size()),
      diameter_(machine.extruders.size(), kUsualMm),
      change_(machine.extruders.size(), Change{100, 100}), drawn_(machine.extruders.size()),
      strands_(machine.extruders.size()), retraction_(machine.retraction) {
  std::fill(std::begin(letter_slot_), std::end(letter_slot_), int8_t(-1));
  // Without actuators no motor moves X, Y and Z: such a machine does not have their letters.
  for (size_t i = machine.geometry->actuators() > 0 ? 0 : 3; i < machine.axes.size(); ++i)
    letter_slot_[machine.axes[i].letter - 'A'] = int8_t(slot_of_axis(int(i)));
  if (!machine.extruders.empty()) letter_slot_['E' - 'A'] = kE;
  for (int j = 0; j < kAxes; ++j) low_[j] = -kInfinity, high_[j] = kInfinity;
  for (size_t i = 0; i < machine.axes.size(); ++i) {
    if (machine.axes[i].filament) {
      filament_letters_ |= 1u << (machine.axes[i].letter - 'A');
      filament_slots_ |= uint8_t(1u << slot_of_axis(int(i)));
      continue;
    }
    const int j = slot_of_axis(int(i));
    low_[j] = machine.axes[i].min;
    high_[j] = machine.axes[i].max;
    // Arms that do not move Z may not reach the origin: such a machine starts at home.
    if (machine.axes[i].by_arms && !machine.axes[size_t(kZ)].by_arms) position_[j] = home_[i];
    homed_[j] = home_[i];
  }
  measure_steps();
  features_.push_back("");
}

// Measures how far one motor step moves each axis at the home position.
void Interpreter::measure_steps() {
  const Geometry& geometry = *machine_->geometry;
  double step[Geometry::kMostActuators] = {}, q[Geometry::kMostActuators], p[3];
  for (const StepperSpec& s : machine_->steppers) {
    if (s.drive == Drive::extruder) continue;
    double& mm = s.drive == Drive::axis ? home_step_[slot_of_axis(s.index)] : step[s.index];
    mm = std::max(mm, 1 / s.steps_per_unit);
  }
  for (int i = 0; i < geometry.actuators(); ++i) {
    for (int k = 0; k < geometry.actuators(); ++k)
      q[k] = geometry.inverse(k, homed_) + (k == i ? step[k] : 0);
    if (!geometry.forward(q, p)) continue;
    for (int j = 0; j < 3; ++j)
      if (const double mm = std::fabs(p[j] - homed_[j]); mm < kInfinity) home_step_[j] += mm;
  }
}

void Interpreter::restart(uint32_t first) {
  sources_[source_] = Lines(first);
  frames_[source_].clear();
  if (!source_) {
    ended_line_ = 0;
    object_lines_.clear();  // its line numbers must increase
  }
  if (first == 1) layers = LayerCounter();
  if (first == 1 && !source_) {
    forget_objects();
    std::fill(std::begin(clamped_), std::end(clamped_), Clamped());
    idle_noted_ = 0;
  }
  dark();
}

void Interpreter::abandon(const double* position, const std::vector<double>& extruders) {
  take_back(meant_mm());
  pending_.clear();
  arc_ = Arc();
  cycle_ = Cycle();
  next_word_ = 0;
  for (size_t i = 0; i < extruders.size(); ++i)
    logical_e_ += (extruders[i] - extruder_[i]) / e_scale();
  extruder_ = extruders;
  std::copy(position, position + kAxes, position_);
  if (!extruder_.empty()) position_[kE] = extruder_[active_];
  // The move that included the tool's offset has not started: the offset is due again.
  if (owed_.line == number() && owed_.tool == tool_ &&
      std::equal(owed_.from, owed_.from + 3, position_))
    owe(owed_.mm);
}

void Interpreter::resume(const Interpreter& before) {
  Interpreter mine = std::move(*this);
  *this = before;
  sources_[1] = std::move(mine.sources_[1]);
  frames_[1] = std::move(mine.frames_[1]);
  std::copy(std::begin(mine.saved_), std::end(mine.saved_), saved_);
  diameter_ = std::move(mine.diameter_);
  volumetric_ = mine.volumetric_;
  change_ = std::move(mine.change_);
  std::copy(std::begin(mine.homed_), std::end(mine.homed_), homed_);
  std::copy(std::begin(mine.offset_), std::end(mine.offset_), offset_);
  clamp = mine.clamp;
  ignore_tools = mine.ignore_tools;
  auto_retract_ = mine.auto_retract_;
  retraction_ = mine.retraction_;
}

void Interpreter::adopt(const Interpreter& other) {
  Interpreter mine = std::move(*this);
  *this = other;
  machine_ = mine.machine_;
  sources_[0] = std::move(mine.sources_[0]);
  sources_[1] = std::move(mine.sources_[1]);
  source_ = mine.source_;
  locked_ = mine.locked_;
  std::copy(std::begin(mine.homed_), std::end(mine.homed_), homed_);
  cold = mine.cold;
  clamp = mine.clamp;
  ignore_tools = mine.ignore_tools;
  subprograms = std::move(mine.subprograms);
  ignore_calls = mine.ignore_calls;
  frames_[0].clear();
  frames_[1] = std::move(mine.frames_[1]);
}

std::string Interpreter::modes() const {
  std::string lines = "G21\n";
  if (!machine_->tools.empty()) (lines += code_name('T', int(tool_))) += '\n';
  if (feed_ < kInfinity) ((lines += "G1 F") += std::to_string(feed_ * 60)) += '\n';
  lines += code_name('G', plane_);
  lines += absolute_ ? "\nG90\n" : "\nG91\n";
  lines += absolute_e_ ? "M82\n" : "M83\n";
  return lines += unit_ == 1 ? "G21" : "G20";
}

void Interpreter::set_axis(int j, double position, bool homed) {
  position_[j] = position;
  if (homed) homed_[j] = position;
  gap_[j] = 0;
  if (j >= 3) return;
  origin_[j] = (homed ? offset_[j] : 0) - tool_offset(j);
  owe(j, 0);
}

void Interpreter::home(const std::string& letters) {
  auto named = [&](const Axis& axis) { return letters.find(axis.letter) != std::string::npos; };
  const bool arms = std::any_of(machine_->axes.begin(), machine_->axes.end(),
                                [&](const Axis& axis) { return axis.by_arms && named(axis); });
  for (size_t i = 0; i < machine_->axes.size(); ++i) {
    const Axis& axis = machine_->axes[i];
    int j = slot_of_axis(int(i));
    if (is_filament(j)) continue;
    if (!letters.empty() && !named(axis) && !(arms && axis.by_arms)) continue;
    position_[j] = homed_[j] = home_[i];
    gap_[j] = 0;
    cut_ &= uint8_t(~(1u << j));
    origin_[j] = j < 3 ? offset_[j] - tool_offset(j) : 0;
    owe(j, 0);
    double c[3];
    if (j == kZ || !machine_->geometry->linear(kZ, c))
      hop_ = 0;  // arms that move Z are all at home now
  }
}

bool Interpreter::in_range(int j, double at, GcodeError& error) const {
  if ((at >= low_[j] - 1e-6 && at <= high_[j] + 1e-6) || at_home(j, at)) return true;
  error = {0, Fault::out_of_range, axis_name(j), at, at < low_[j] ? low_[j] : high_[j], {}};
  return false;
}

void Interpreter::shift(int j, double mm) {
  origin_[j] += mm;
  position_[j] += mm;
  arc_.shift(j, mm);
  cycle_.shift(j, mm);
  cycle_level_ += j == kZ ? mm : 0;
  for (Item& item : pending_) item.move.target[j] += mm;
}

void Interpreter::absorb_shift(int j, double mm) {
  const double at = position_[j];
  shift(j, -mm);
  position_[j] = at;
  for (Saved& saved : saved_) saved.at[j] -= mm;
}

void Interpreter::drop_hop(double mm) {
  position_[kZ] -= mm;
  arc_.shift(kZ, -mm);
  arc_hop_ = arc_move_.hop_mm = 0;
  for (Item& item : pending_) item.move.target[kZ] -= std::exchange(item.move.hop_mm, 0);
  hop_ = 0;
}

}  // namespace passo
