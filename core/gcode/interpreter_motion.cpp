// G0 to G3 with all their words, saved positions, and the return after G28 B.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "gcode/interpreter.hpp"
#include "gcode/word_grammar.hpp"

namespace passo {

void Interpreter::run_motion(int code, const Word* w, const Word* end) {
  if (w == end) return;
  const auto is_g43 = [](const Word& x) { return x.letter == 'G' && x.number && x.value == 43; };
  double value[26] = {}, feed = feed_, duration = 0, laser = 0, energy = 0;
  uint32_t have = 0, seen = 0;
  uint32_t relative = this->relative();
  bool keeps_feed = true, has_laser = false, timed = false, no_feed = false;
  // After G43, H is the number of a tool, also in a line with G0.
  const Word* first = words_.data() + (words_.front().letter == 'N');
  const bool leads = code < 2 && w == first + 1 && first->letter == 'G' && first->value == code;
  const Word* motor = nullptr;  // the first word of `motors` that is not 0, else the first one
  int turns = 0, special = 0;
  std::string motors;
  for (const Word* x = w; x < end; ++x) {
    std::string shown(1, x->letter);
    int slot = x->letter >= 'A' && x->letter <= 'Z' ? letter_slot_[x->letter - 'A'] : -1;
    if (x->letter == 'R' &&
        code < 2) {  // all words are positions, except the letters directly after R
      if (x->number) return fail_letter(*x, code);
      relative = 0;
      keeps_feed = false;
      for (; x + 1 < end && !x[1].number && x[1].begin == x->end; ++x) {
        if (x[1].letter < 'A' || x[1].letter > 'Z') break;
        relative |= 1u << (x[1].letter - 'A');
        keeps_feed |= x[1].letter == 'F';
      }
      continue;
    }
    if (x->letter < 'A' || x->letter > 'Z') return fail_word(Fault::word, shown, text_);
    if (!sound(*x) || repeated(*x, seen)) return;
    if (laser_.has(x->letter)) {
      (x->letter == laser_.energy ? energy : density_) = std::max(0.0, x->value);
    } else if (slot >= 0) {
      value[x->letter - 'A'] = x->value;
      have |= 1u << (x->letter - 'A');
    } else if (x->letter == 'F') {
      if (!(x->value >= 0)) return fail(Fault::feedrate, "F", x->value, 0);
      no_feed = x->value == 0;
      if (!no_feed) feed = x->value * unit_ / 60;
    } else if (x->letter == 'T') {
      if (!within('T', x->value, 0, kLargestWord)) return;
      duration = x->value;
      timed = true;
    } else if (x->letter == 'S') {
      laser = x->value;
      has_laser = true;
    } else if (code >= 2 &&
               (x->letter == 'I' || x->letter == 'J' || x->letter == 'K' || x->letter == 'R')) {
      value[x->letter - 'A'] = x->value;
      have |= 1u << (x->letter - 'A');
    } else if (code >= 2 && x->letter == 'P') {
      if (!within('P', x->value, 0, kLargestWord)) return;
      turns = std::max(0, int(x->value) - 1);
    } else if (leads && x->letter == 'H') {
      if (!within('H', x->value, 0, kMostSpecial)) return;
      special = int(x->value);
    } else if (leads && machine_->motor_letters.find(x->letter) != std::string::npos) {
      motors += x->letter + std::to_string(x->value) + " ";
      if (motor == nullptr || motor->value == 0) motor = x;
    } else if (!(x->letter == 'H' && std::any_of(first, end, is_g43)) && !idles(*x, code)) {
      return;
    }
  }
  if (no_feed && (have != 0 || !motors.empty())) return fail(Fault::feedrate, "F", 0, 0);
  if (keeps_feed) feed_ = feed;
  const bool only_motors = !motors.empty() && (have & ~filament_letters_) == 0;
  if (motor != nullptr && special == 0 && !only_motors && !idles(*motor, code)) return;
  if (special != 0 || only_motors) return emit_special(special, value, have, relative, motors);
  if (has_laser) {
    emit_power(laser);
  }
  uint32_t axes = 0;
  for (int k = 0; k < 26; ++k)
    if ((have >> k & 1) && letter_slot_[k] >= 0) axes |= 1u << k;
  if (code >= 2) {
    move_.feed_mm_s = feed;
    move_.energy_ws = 0;  // an arc has energy per mm only
    return run_arc(code == 2, value, have, turns);
  }
  double begin[kAxes];
  const bool begins = tool_position(begin) < 0;
  if (!target(value, axes, relative, offset_letters(axes)) || retracts(axes)) return;
  // A line of filament or an arc starts where the tool in use should be. A travel goes there first.
  if (begins && (axes & ~filament_letters_) != 0 && lays_filament()) queue_offset(begin, feed);
  queue_straight(timed ? kInfinity : feed, duration, code == 0, energy);  // T is given instead of F
}

// Reports a move of single motors, or a move to an endstop (H), as an event with words in mm and
// degrees. R1: the words are distances.
void Interpreter::emit_special(int kind, const double* value, uint32_t have, uint32_t relative,
                               std::string words) {
  for (int k = 0; k < 26; ++k)
    if (have >> k & 1) words += char('A' + k) + std::to_string(value[k] * unit_) + " ";
  if (feed_ < kInfinity) words += "F" + std::to_string(feed_ * 60) + " ";
  if ((relative & ~filament_letters_) != 0) words += "R1 ";
  emit(0, 0, 0, kind == 0 ? "G1 A" : "G1 H" + std::to_string(kind), words);
}

// Whether a word that names no axis may be ignored; if not, reports an error.
bool Interpreter::idles(const Word& word, int code) {
  if (word.number && word.value == 0 && idle_letter(word.letter, code)) {
    const uint32_t bit = 1u << (word.letter - 'A');
    if (source_ || (idle_noted_ & bit) == 0) emit(0, 0, 0, "G1 A0", "");
    if (!source_) idle_noted_ |= bit;
    return true;
  }
  fail_letter(word, code);
  return false;
}

// The error's `word` is the command, the letter, and the letters of all axes.
void Interpreter::fail_letter(const Word& word, int code) {
  std::string axes;
  for (const char* letter = "XYZABCDEHIJKUVWFGLMNOPQRST"; *letter != 0; ++letter)
    if (letter_slot_[*letter - 'A'] >= 0) (axes += ' ') += *letter;
  fail(Fault::letter, code_name('G', code) + " " + word.letter + axes, 0, 0);
}

// Queues a straight move to the target that move_ has now.
void Interpreter::queue_straight(double feed, double duration, bool rapid, double energy_ws) {
  move_.energy_ws = energy_ws;
  move_.feed_mm_s = feed;
  move_.duration_s = duration;
  move_.radius_mm = kInfinity;
  move_.arc_inner = false;
  move_.rapid = rapid;
  stamp(move_);
  Item item{};
  item.found = ParseResult::move;
  item.move = move_;
  item.move.kind = MoveKind::travel;
  pending_.push_back(std::move(item));
}

// Queues a move of slot j by the distance `by`. The program's coordinates stay.
void Interpreter::queue_step(int j, double by, double feed) {
  if (by == 0) return;
  Item item{};
  item.found = ParseResult::move;
  MoveRequest& m = item.move;
  double start[kAxes];
  here(start);
  const double* from = start;
  for (const Item& x : pending_)
    if (x.found == ParseResult::move) from = x.move.target;
  std::copy(from, from + kAxes, m.target);
  m.target[j] += by;
  m.hop_mm = hop_;
  m.feed_mm_s = feed;
  m.radius_mm = kInfinity;
  stamp(m);
  m.kind = MoveKind::travel;
  m.moved = uint8_t(1u << j);
  pending_.push_back(std::move(item));
}

// G28 B: returns to machine position `to`, X and Y first, then Z. If arms move Z too, all axes move
// together: at home the arms have no room to the side.
void Interpreter::queue_return(const double* to) {
  here(move_.target);
  const bool together = machine_->axes[size_t(kZ)].by_arms;
  for (int j = 0; j < kAxes; ++j)
    if (j != kE && (j != kZ || together)) move_.target[j] = to[j];
  move_.moved = 0;
  move_.hop_mm = hop_;
  queue_straight(kInfinity, 0, true);
  move_.target[kZ] = to[kZ];
  queue_straight(kInfinity, 0, true);
}

// G60 saves the program's position in slot S. G61 returns to it along the axes that it names, or
// along X, Y and Z if it names none. A word's value is added to the saved position. F applies to
// this move only.
void Interpreter::run_saved(bool save, const Word* w, const Word* end) {
  double value[26] = {}, feed = kInfinity, slot = 0;
  uint32_t have = 0;
  for (const Word* x = w; x < end; ++x) {
    int k = x->letter - 'A';
    if (x->letter == 'S' && x->number) slot = x->value;
    if (x->letter == 'F' && x->number && x->value > 0) feed = x->value * unit_ / 60;
    if (x->letter == 'S' || x->letter == 'F') continue;
    if (letter_slot_[k] < 0) {
      if (!idles(*x, save ? 60 : 61)) return;
      continue;
    }
    have |= 1u << k;
    value[k] = x->number ? x->value * unit_ : 0;
  }
  if (!within('S', slot, 0, kSaved - 1)) return;
  if (slot != std::floor(slot)) return fail(Fault::number, "S", slot, kSaved - 1);
  Saved& saved = saved_[int(slot)];
  if (save) {
    saved.valid = true;
    for (int j = 0; j < kAxes; ++j) saved.at[j] = meant(j);
    return emit('G', 60, 0, "", code_name('S', int(slot)));
  }
  if (!saved.valid) return fail(Fault::unsaved, "S", slot, 0);
  if (have == 0) have = 1u << ('X' - 'A') | 1u << ('Y' - 'A') | 1u << ('Z' - 'A');
  for (int k = 0; k < 26; ++k) {  // as distances
    if ((have >> k & 1) == 0) continue;
    int j = letter_slot_[k];
    double by = saved.at[j] + value[k] - meant(j);
    value[k] = (j == kE ? by / e_scale() : by) / unit_;
  }
  if (target(value, have, ~0u, offset_letters(have))) queue_straight(feed, 0, false);
}

// Reports the S word of a move, the power of a laser or spindle.
void Interpreter::emit_power(double power) {
  char text[40];
  std::snprintf(text, sizeof text, "S%.6g", power);
  emit('S', 0, 0, "", text);
}

}  // namespace passo
