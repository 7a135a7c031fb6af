// Commands that change the motion state.
#include <algorithm>
#include <iterator>

#include "gcode/interpreter.hpp"
#include "gcode/stray.hpp"
#include "gcode/word_grammar.hpp"

namespace passo {

namespace {

constexpr double kMinFilamentMm = 0.1, kMaxFilamentMm = 10;  // of filament: diameter

}  // namespace

void Interpreter::run_command(const Word& command, const Word* w, const Word* end,
                              std::string_view text) {
  if (!sound(command)) return;
  const auto [code, minor] = code_of(command);
  const std::string name = code_name(command.letter, code, minor);
  if (!command.built_in && is_macro(name)) {
    note_command(name, w, end, text);
    return emit_macro(command.letter, code, minor, "", text);
  }
  const bool modal = before_axes(command.letter, code, minor) && moves(w, end);
  if (modal || before_modal(command.letter, code, minor))
    note_command(name, w, w);
  else
    note_command(name, w, end, text);
  if (modal) {
    emit(command.letter, code, minor, "", "");
    return run_modal(w, end);
  }
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  if (command.letter == 'G' && code > 3 && !wordless(command)) {
    if (const Stray stray = find_stray(text, false); stray.code != 0)
      return fail(Fault::stray, stray.token, double(stray.code), 0);
  }
  uint32_t seen = 0;
  for (const Word* x = w; own_command(command.letter, code, minor) && x < end; ++x) {
    if (x->letter < 'A' || x->letter > 'Z')
      return fail_word(Fault::word, std::string(1, x->letter), text_);
    if (repeated(*x, seen)) return;
    if (!x->number && may_stand_alone(command.letter, code, x->letter)) continue;
    if (!sound(*x)) return;
    bool as_m207 = code == 208 && command.letter == 'M' && x->value == 0;
    if (x->letter == 'F' && !(x->value > 0) && !as_m207)
      return fail(Fault::feedrate, "F", x->value, 0);
  }
  const Arguments arguments{w, end, text};
  if (command.letter == 'G' && minor == 0 && run_g(code, arguments)) return;
  if (command.letter == 'M' && minor == 0 && run_m(code, arguments)) return;
  if (command.letter == 'M' && code == 5) dark();
  emit(command.letter, code, minor, "", text);
  std::vector<Word> move;
  if (moves_otherwise(command.letter, code) && moves(w, end)) motion_ = 10 * code + minor;
  if (beside_axes(command.letter, code, minor))
    std::copy_if(w, end, std::back_inserter(move),
                 [this](const Word& x) { return names_axis(x) || x.letter == 'F'; });
  if (!move.empty()) run_modal(move.data(), move.data() + move.size());
}

// Returns false if the caller must carry out the command.
bool Interpreter::run_g(int code, const Arguments& a) {
  switch (code) {
    case 0:
    case 1:
    case 2:
    case 3:
      motion_ = code;
      note_moved();
      run_motion(code, a.first, a.last);
      return true;
    case 4:
      run_dwell(a);
      return true;
    case 10:
      for (const Word* x = a.first; x < a.last; ++x)
        if (x->letter ==
            'L') {  // L: coordinate systems and tool lengths, which Passo does not have
          emit(0, 0, 0, "G10 " + unknown_name(text_, *x), a.text);
          return true;
        }
      if (a.has('P')) return false;
      run_retract(true, a.has('S') && a.value('S', 0) != 0);
      return true;
    case 11:
      run_retract(false);
      return true;
    case 28:
      run_home(a);
      return true;
    case 60:
    case 61:
      run_saved(code == 60, a.first, a.last);
      return true;
    case 73:
    case 81:
    case 82:
    case 83:
      cycle_begins_ = cycle_begins_ || !canned(motion_);
      motion_ = 10 * code;
      run_cycle(code, a.first, a.last);
      return true;
    case 80: {
      const bool cycle = motion_ > 3;
      if (cycle) motion_ = -1;
      // On a printer G80 is bed levelling, as in Prusa's firmware, with its own parameters.
      if (machine_->prints()) return cycle;
      if (cycle && moves(a.first, a.last)) {
        fail(Fault::word, "G80", 0, 0);
        return true;
      }
      break;
    }
    case 92:
      run_set_position(a);
      return true;
    case 17:
    case 18:
    case 19:
      plane_ = code;
      break;
    case 20:
      unit_ = 25.4;
      break;
    case 21:
      unit_ = 1;
      break;
    case 53:
      machine_zero_ = true;
      break;
    case 90:
      absolute_ = true;
      break;
    case 91:
      absolute_ = false;
      break;
    case 98:
    case 99:
      to_level_ = code == 98;
      break;
    default:
      return false;
  }
  run_modal(a.first, a.last);
  return true;
}

// Returns false if the caller must carry out the command.
bool Interpreter::run_m(int code, const Arguments& a) {
  switch (code) {
    case 82:
      absolute_e_ = true;
      return true;
    case 83:
      absolute_e_ = false;
      return true;
    case 98:
      run_call(a.text);
      return true;
    case 99:
      return run_return(a.text);
    case 200:
      return run_diameter(a);
    case 207:
      set_retraction(a);
      return true;
    case 208:
      set_recovery(a);
      return true;
    case 209:
      if (!a.has('S')) return false;  // a query
      auto_retract_ = a.value('S', 0) != 0;
      return true;
    case 486:
      run_objects("M486", a.text);
      return true;
    case 603:
    case 701:
    case 702:
      return run_filament(code, a);
    default:
      return false;
  }
}

void Interpreter::run_dwell(const Arguments& a) {
  MoveRequest m{};
  m.kind = MoveKind::dwell;
  m.duration_s = a.has('S') ? a.value('S', 0) : a.value('P', 0) / 1000;
  stamp(m);
  m.radius_mm = m.feed_mm_s = kInfinity;
  if (!(a.has('S') ? within('S', m.duration_s, 0, kMaxMoveS)
                   : within('P', m.duration_s * 1000, 0, kMaxMoveS * 1000)))
    return;
  if (laser_.energy) m.energy_ws = std::max(0.0, a.value(laser_.energy, 0));
  if (!within(laser_.energy, m.energy_ws, 0, kMaxMoveS * laser_.most_w)) return;
  m.duration_s = std::max(m.duration_s, m.energy_ws / laser_.most_w);
  if (m.duration_s > 0) {
    Item item{};
    item.found = ParseResult::move;
    item.move = m;
    pending_.push_back(item);
  }
}

// G28. With O, the caller homes only the axes that are not homed. With B, a travel returns to the
// position before homing.
void Interpreter::run_home(const Arguments& a) {
  std::string letters;
  for (const Word* x = a.first; x < a.last; ++x)
    if (x->letter >= 'A' && x->letter <= 'Z' && letter_slot_[x->letter - 'A'] >= 0 &&
        !(filament_letters_ >> (x->letter - 'A') & 1))
      letters += x->letter;
  const bool back = a.has('B') && letter_slot_['B' - 'A'] < 0;
  double before[kAxes];
  const double hop = hop_;
  if (tool_position(before) >= 0) here(before);
  if (a.has('O') && letter_slot_['O' - 'A'] < 0)
    letters += 'O';
  else
    home(letters);
  if (locked(kZ)) hop_ = 0;
  if (back && locked_ == 0) hop_ = hop;  // the earlier position includes the hop
  emit('G', 28, 0, "", back ? letters + 'B' : letters);
  if (back) queue_return(before);
}

// G92. If an axis is not homed, the caller sets its position. Otherwise only the program's zero
// moves.
void Interpreter::run_set_position(const Arguments& a) {
  bool any = false;
  std::string positions, actuators;
  auto set = [&](char letter, int j, double value) {
    if (j == kE) {
      logical_e_ = value;
    } else if (locked(j)) {
      if (j == kZ) hop_ = 0;
      positions += letter + std::to_string(value - (j < 3 ? tool_offset(j) : 0)) + " ";
    } else {
      origin_[j] = meant(j) - value;
    }
  };
  for (const Word* x = a.first; x < a.last; ++x)
    if (!names_axis(*x) && x->letter != 'F' &&
        machine_->motor_letters.find(x->letter) == std::string::npos && !idles(*x, 92))
      return;
  for (const Word* x = a.first; x < a.last; ++x) {
    const int j = letter_slot_[x->letter - 'A'];
    any = true;
    if (j < 0) {
      if (machine_->motor_letters.find(x->letter) == std::string::npos) continue;
      actuators += x->letter + std::to_string(x->value) + " ";
      continue;
    }
    set(x->letter, j, x->value * unit_);
  }
  for (char letter = 'A'; !any && letter <= 'Z'; ++letter)
    if (letter_slot_[letter - 'A'] >= 0) set(letter, letter_slot_[letter - 'A'], 0);
  if (!positions.empty()) emit('G', 92, 0, "", positions);
  if (!actuators.empty()) emit('G', 92, 1, "", actuators);
}

// M200: E is the volume of filament with diameter D. Returns false for a query.
bool Interpreter::run_diameter(const Arguments& a) {
  if (a.empty()) return false;
  const double tool = a.value('T', double(tool_)), mm = a.value('D', 1);
  if (tool == 0 && machine_->tools.empty()) return true;  // extruders are axes
  if (!(tool >= 0 && tool < double(machine_->tools.size()))) {
    fail(Fault::missing_tool, "T", tool, double(machine_->tools.size()));
    return true;
  }
  if (mm != 0 && !within('D', mm, kMinFilamentMm, kMaxFilamentMm)) return true;
  const int extruder = machine_->tools[size_t(tool)].extruder;
  if (a.has('D') && mm > 0 && extruder >= 0) diameter_[size_t(extruder)] = mm;
  volumetric_ = mm > 0 && a.value('S', 1) != 0;
  return true;
}

void Interpreter::set_retraction(const Arguments& a) {
  for (char letter : {'S', 'Z', 'W'})
    if (!within(letter, a.value(letter, 0), 0, kMaxChangeMm)) return;
  if (!within('R', a.value('R', 0), -kMaxChangeMm, kMaxChangeMm)) return;
  retraction_.mm = a.value('S', retraction_.mm);
  if (a.has('F')) retraction_.feed_mm_s = a.value('F', 0) / 60;
  retraction_.hop_mm = a.value('Z', retraction_.hop_mm);
  retraction_.recover_mm = a.value('R', retraction_.recover_mm);
  retraction_.swap_mm = a.value('W', retraction_.swap_mm);
}

void Interpreter::set_recovery(const Arguments& a) {
  for (char letter : {'S', 'W'})
    if (!within(letter, a.value(letter, 0), -kMaxChangeMm, kMaxChangeMm)) return;
  retraction_.recover_mm = a.value('S', retraction_.recover_mm);
  retraction_.swap_recover_mm = a.value('W', retraction_.swap_recover_mm);
  if (a.has('F')) retraction_.recover_feed_mm_s = a.value('F', 0) / 60;
}

// Runs words that come without a motion command: the modal motion command applies.
void Interpreter::run_modal(const Word* w, const Word* end) {
  if (motion_ < 0) motion_ = 1;
  if (w == end) return;
  if (motion_ > 3) {  // an unsupported motion: one event for each of its lines
    if (canned(motion_)) {
      note_command("", w, end);
      return run_cycle(motion_ / 10, w, end);
    }
    std::string_view text = std::string_view(text_).substr(w->begin, end[-1].end - w->begin);
    note_command(code_name('G', motion_ / 10, motion_ % 10), w, end, text);
    return emit('G', motion_ / 10, motion_ % 10, "", text);
  }
  note_moved();
  note_command("", w, end);
  run_motion(motion_, w, end);
}

}  // namespace passo
