// Changes of tool, and the offsets that the next moves carry out.
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
  if (tool == 0 && machine_->tools.empty()) return;        // extruders are axes
  if (tool < 0) return pass_on(code_name('T', tool), "");  // it may mean none: no change
  hear(code_name('T', tool), nullptr, nullptr);
  if (size_t(tool) >= machine_->tools.size()) {
    if (!ignore_tools) return fail(Fault::missing_tool, "T", tool, double(machine_->tools.size()));
    return emit('T', tool, 1, "", "");
  }
  take_tool(size_t(tool));
  emit('T', tool, 0, "", "");
  // This extruder's G11 will not lower Z: without this it would print in the air.
  if (!extruder_.empty() && !drawn_[active_].back)
    queue_step(kZ, -std::exchange(hop_, 0), kInfinity);
}

void Interpreter::shift_tool(int j, double mm) {
  origin_[j] -= mm - tool_offset(j);
  owe(j, due_[j] - (mm - tool_offset(j)));
}

// Letters of axes that a move with axes `have` also moves: by the offset of a tool that no move has
// carried out yet. Not a move of filament alone, nor one in the machine's own coordinates; an axis
// that is not homed has no offset to keep.
uint32_t Interpreter::offset_letters(uint32_t have, bool arc) const {
  if (!any_due_ || machine_zero_ || (!arc && (have & ~filament_letters_) == 0)) return 0;
  uint32_t letters = 0;
  for (int j = 0; j < 3; ++j)
    if (due_[j] != 0 && !locked(j)) letters |= 1u << (machine_->axes[size_t(j)].letter - 'A');
  return letters & ~have;
}

// The move that has just got its target moves these slots: their offsets are done.
void Interpreter::carry_out(uint8_t moved) {
  for (int j = 0; j < 3; ++j) owed_.from[j] = position_[j], owed_.mm[j] = due_[j];
  owed_.tool = tool_;
  owed_.line = number();
  for (int j = 0; j < 3; ++j)
    if (moved >> j & 1) owe(j, 0);
}

// Where the machine is once it has carried out the offset that is due. Returns the slot of an axis
// for which that is beyond its limit, where `at` ends, or -1.
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

// Whether the target that move_ has now takes filament forward.
bool Interpreter::lays_filament() const {
  for (int j = 0; j < kAxes; ++j)
    if (is_filament(j) && move_.target[j] > position_[j]) return true;
  return false;
}

// A travel to `to`, from where a line of filament or an arc begins with the tool in use.
void Interpreter::queue_offset(const double* to, double feed) {
  Item item{};
  item.found = Found::move;
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
  m.rapid = true;  // no laser burns on it
  stamp(m);
  m.kind = MoveKind::travel;
  pending_.push_back(std::move(item));
}

}  // namespace passo
