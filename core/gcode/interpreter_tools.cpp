// Tool changes, and tool offsets that the next moves carry out.
#include <algorithm>
#include <utility>

#include "gcode/interpreter.hpp"

namespace passo {

void Interpreter::take_tool(size_t tool) {
  if (machine_->tools.empty() || machine_->tools[tool].extruder < 0) return;
  for (int j = 0; j < 3; ++j) {
    const double mm = machine_->tools[tool].offset[j] - tool_offset(j);
    origin_[j] -= mm;
    owe(j, due_[j] - mm);
  }
  tool_ = tool;
  active_ = size_t(machine_->tools[tool].extruder);
  position_[kE] = extruder_[active_];
}

void Interpreter::select_tool(const Word& word) {
  if (!sound(word)) return;
  int tool = int(word.value);
  if (tool == 0 && machine_->tools.empty()) return;  // extruders are axes
  if (tool < 0)
    return pass_on(code_name('T', tool), "");  // T-1 may mean no tool: the caller decides
  note_command(code_name('T', tool), nullptr, nullptr);
  if (size_t(tool) >= machine_->tools.size()) {
    if (!ignore_tools) return fail(Fault::missing_tool, "T", tool, double(machine_->tools.size()));
    return emit('T', tool, 1, "", "");
  }
  take_tool(size_t(tool));
  emit('T', tool, 0, "", "");
  // The G11 of the new extruder will not lower Z, so the hop ends now. Otherwise the tool would
  // print in the air.
  if (!extruder_.empty() && !drawn_[active_].back)
    queue_step(kZ, -std::exchange(hop_, 0), kInfinity);
}

void Interpreter::shift_tool(int j, double mm) {
  origin_[j] -= mm - tool_offset(j);
  owe(j, due_[j] - (mm - tool_offset(j)));
}

// Letters of further axes that a move of the axes `have` also moves, because a tool offset is due.
// There are none for a move of filament alone or in machine coordinates (G53), and none for axes
// that are not homed.
uint32_t Interpreter::offset_letters(uint32_t have, bool arc) const {
  if (!any_due_ || machine_zero_ || (!arc && (have & ~filament_letters_) == 0)) return 0;
  uint32_t letters = 0;
  for (int j = 0; j < 3; ++j)
    if (due_[j] != 0 && !locked(j)) letters |= 1u << (machine_->axes[size_t(j)].letter - 'A');
  return letters & ~have;
}

// The move whose target was just calculated carries out the offsets of the slots `moved`.
void Interpreter::carry_out(uint8_t moved) {
  for (int j = 0; j < 3; ++j) owed_.from[j] = position_[j], owed_.mm[j] = due_[j];
  owed_.tool = tool_;
  owed_.line = number();
  for (int j = 0; j < 3; ++j)
    if (moved >> j & 1) owe(j, 0);
}

// Sets `at` to the machine's position after the pending change of the tool offset. If this moved an
// axis beyond its limit, `at` ends at the limit and the slot of the axis is returned; else -1.
int Interpreter::tool_position(double* at) const {
  here(at);
  int out = -1;
  for (int j = 0; any_due_ && !machine_zero_ && j < 3; ++j) {
    if (due_[j] == 0 || locked(j)) continue;
    double t = meant(j);
    if (beyond(j, t)) {
      t = t < low_[j] ? low_[j] : high_[j];
      out = j;
    }
    at[j] = t + (j == kZ ? std::clamp(high_[j] - t, 0.0, hop_) : 0);
  }
  return out;
}

// Whether the target of move_ extrudes filament.
bool Interpreter::lays_filament() const {
  for (int j = 0; j < kAxes; ++j)
    if (is_filament(j) && move_.target[j] > position_[j]) return true;
  return false;
}

// Queues a travel to `to`, where a line of filament or an arc starts with the tool in use.
void Interpreter::queue_offset(const double* to, double feed) {
  Item item{};
  item.found = ParseResult::move;
  MoveRequest& m = item.move;
  std::copy(to, to + kAxes, m.target);
  double from[kAxes];
  here(from);
  for (int j = 0; j < 3; ++j)
    if (to[j] != from[j]) m.moved |= uint8_t(1u << j);
  if (m.moved == 0) return;
  m.hop_mm = hop_;
  m.feed_mm_s = feed;
  m.radius_mm = kInfinity;
  m.rapid = true;  // the laser is off
  stamp(m);
  m.kind = MoveKind::travel;
  pending_.push_back(std::move(item));
}

}  // namespace passo
