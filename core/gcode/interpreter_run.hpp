// The general way of a line: every dialect, every command that belongs to the motion state.
#pragma once
#include <cstring>
#include <iterator>

#include "gcode/exponents.hpp"
#include "gcode/interpreter.hpp"
#include "gcode/word_grammar.hpp"

namespace passo {

inline void Interpreter::emit(char letter, int number, int minor, std::string_view name,
                              std::string_view text) {
  Item item{};
  item.found = Found::event;
  name = name.substr(0, kLongestName);
  item.event = {this->number(), letter, number, minor, readable(name), readable(text)};
  pending_.push_back(std::move(item));
}

inline void Interpreter::emit_macro(char letter, int number, int minor, std::string_view name,
                                    std::string_view text) {
  while (!text.empty() && std::isspace(uint8_t(text.front()))) text.remove_prefix(1);
  emit(letter, number, minor, name, text);
  pending_.back().found = Found::macro;
}

inline bool Interpreter::within(char letter, double value, double least, double most) {
  if (value >= least && value <= most) return true;
  fail(Fault::range, std::string(1, letter), value, most);
  pending_.back().error.point[0] = least;
  return false;
}

inline void Interpreter::hear(std::string_view code, const Word* first, const Word* last,
                              std::string_view text) {
  ++commands_;
  if (!listening()) return;
  std::vector<std::string> words;
  for (; first < last; ++first)
    words.push_back(
        readable(std::string_view(text_).substr(first->begin, first->end - first->begin)));
  while (!text.empty() && std::isspace(uint8_t(text.front()))) text.remove_prefix(1);
  while (!text.empty() && std::isspace(uint8_t(text.back()))) text.remove_suffix(1);
  heard_.commands.push_back(
      {readable(code.substr(0, kLongestName)), std::move(words), readable(text)});
}

// A command that is no letter and number, or that nobody knows.
inline void Interpreter::pass_on(std::string_view name, std::string_view text) {
  const Macros& macros = machine_->macros;
  if (macros.any()) {
    const std::string code(name);
    const std::string* original = macros.original(code);
    if (original) name = *original;
    if (!original && is_macro(code)) {
      hear(name, nullptr, nullptr, text);
      return emit_macro(0, 0, 0, name, text);
    }
  }
  hear(name, nullptr, nullptr, text);
  emit(0, 0, 0, name, text);
}

inline void Interpreter::find_built_in() {
  if (machine_->macros.built_in.empty()) return;
  for (Word& w : words_) {
    if (w.letter != 'G' && w.letter != 'M' && !(w.letter == 'T' && &w == &words_.front())) continue;
    if (!w.number) continue;
    const auto [code, minor] = code_of(w);
    std::string name = w.letter + std::to_string(code);
    if (minor != 0) name += "." + std::to_string(minor);
    const std::string* original = machine_->macros.original(name);
    if (!original) continue;
    const char* p = original->c_str() + 1;
    read_number(p, original->c_str() + original->size(), w.value);
    w.letter = original->front();
    w.built_in = true;
  }
}

// Whether the program's text is over: by zero bytes up to the end of the file, as a file that was
// cut off has them, or by the Ctrl-Z of DOS, after which anything may stand but commands. `end`
// moves to before them.
inline bool Interpreter::ends_text(const char* p, const char*& end) {
  constexpr char kCtrlZ = 0x1a;
  auto padding = [](char c) { return c == 0 || c == kCtrlZ || std::isspace(uint8_t(c)) != 0; };
  while (p < end && std::isspace(uint8_t(*p))) ++p;
  if (ended_line_ != 0) {
    if (std::all_of(p, end, padding)) return true;
    if (utf_16(std::string_view(p, size_t(end - p)))) return false;
    const bool command =
        *p != 0 && std::strchr("GMTNgmtn", *p) && end - p > 1 && std::isdigit(uint8_t(p[1]));
    if (ended_by_zero_ || command)
      fail(ended_by_zero_ ? Fault::hole : Fault::after_end, "", ended_line_, 0);
    return true;
  }
  const char* stop = std::find_if(p, end, [](char c) { return c == 0 || c == kCtrlZ; });
  if (stop == end) return false;
  const bool tail = std::all_of(stop, end, padding);
  if (!tail && (*stop == 0 || *p == ';')) return false;
  ended_line_ = number();
  ended_by_zero_ = *stop == 0;
  end = stop;
  return false;
}

inline void Interpreter::run_line(const char* p, const char* end) {
  if (listening()) heard_ = Heard();  // a line of a sub-program may come again
  if (!source_ && frames_[0].empty() && ends_text(p, end)) return;
  while (p < end && std::isspace(uint8_t(*p))) ++p;
  while (end > p && std::isspace(uint8_t(end[-1]))) --end;
  if (p == end || *p == '%') return;
  if (*p == ';') return comment(std::string_view(p + 1, size_t(end - p - 1)));
  std::string text(p, end), note;
  size_t printable = 0;
  for (char c : text) printable += uint8_t(c) >= 32 || c == '\t';
  if (printable != text.size() || utf_16(text))
    return fail(utf_16(text) ? Fault::utf_16 : Fault::garbage, "", 0, 0);
  const char* q = text.data();
  if ((*q == 'N' || *q == 'n') && text.size() > 1) {  // line number and checksum of a console
    double number;
    const char* after = q + 1;
    if (read_number(after, q + text.size(), number)) {
      size_t star = last_star(text);
      if (star != std::string::npos) {
        uint8_t sum = 0;
        for (size_t i = 0; i < star; ++i) sum ^= uint8_t(text[i]);
        const char* s = text.data() + star + 1;
        double given;
        if (read_number(s, text.data() + text.size(), given) && given == sum && nothing_left(s)) {
          heard_.checked |= listening();
          text.resize(star);
          q = text.data();
          after = q + 1;
          read_number(after, q + text.size(), number);
        } else if (!takes_text(after)) {
          return fail(Fault::checksum, text.substr(star), sum, 0);
        }
      }
      if (listening()) heard_.number.assign(q + 1, after);
      text.erase(0, size_t(after - q));
      while (!text.empty() && std::isspace(uint8_t(text[0]))) text.erase(0, 1);
    }
  }
  if (const size_t code = object_code(text)) {
    std::string name = text.substr(0, code);
    for (char& c : name) c = char(std::toupper(uint8_t(c)));
    const std::string_view rest = without_comment(std::string_view(text).substr(code));
    hear(name, nullptr, nullptr, rest);
    return run_objects(name, rest);
  }
  strip_comments(text, note);
  if (!note.empty() && text.empty()) return comment(note);
  text.erase(0, std::min(text.find_first_not_of(" \t"), text.size()));
  if (text.empty()) return;
  if (text[0] == '/') return pass_on("/", text.substr(1));  // left out where this is set
  if (text.size() > 1 && (std::isalpha(uint8_t(text[0])) != 0 || text[0] == '_') &&
      (std::isalpha(uint8_t(text[1])) || text[1] == '_')) {
    size_t stop = 0;
    while (stop < text.size() &&
           (std::isalnum(uint8_t(text[stop])) || text[stop] == '_' || text[stop] == '.'))
      ++stop;
    std::string name = text.substr(0, stop);
    for (char& c : name) c = char(std::toupper(uint8_t(c)));
    return pass_on(name, text.substr(std::min(stop + 1, text.size())));
  }
  if (text[0] == '_' || text[0] == '$' || text[0] == '@') {  // $H of grbl, @pause of a host
    size_t stop = text.find(' ');
    return pass_on(text.substr(0, stop), stop == std::string::npos ? "" : text.substr(stop + 1));
  }
  text_.swap(text);
  split_words(text_, words_);
  const bool moves_have_e = letter_slot_['E' - 'A'] >= 0 || laser_.has('E');
  if (std::string plain = Exponents(text_, words_, moves_have_e).expand(); !plain.empty()) {
    text_.swap(plain);
    split_words(text_, words_);
  }
  find_built_in();
  run_words();
}

// Commands of one line: each G or M word with the words up to the next one; a T word that stands
// before any other command is one; words before the first command belong to it, unless they name
// axes or F: then they are a move in the modal way. What follows a move waits until that is taken.
inline void Interpreter::run_words() {
  std::string_view text = text_;
  Word *w = words_.data() + next_word_, *end = words_.data() + words_.size();
  bool begins = next_word_ == 0;
  next_word_ = 0;
  auto waits = [&] {
    if (!unfinished()) return false;
    next_word_ = size_t(w - words_.data());
    return true;
  };
  if (!std::isalpha(uint8_t(w->letter))) {
    // A binary begins so.
    const bool text_begins = number() > 1 || character_at(text, w->begin).first >= 0;
    return text_begins ? fail_word(Fault::word, std::string(text.substr(w->begin, 20)), text)
                       : fail(Fault::garbage, "", 0, 0);
  }
  auto starts = [&](const Word& x) { return (x.letter == 'G' || x.letter == 'M') && x.number; };
  auto tool = [&](const Word& x) { return x.letter == 'T' && x.whole(); };
  // Whether this begins a command, behind a move.
  auto behind_move = [&](const Word& x) {
    if (tool(x)) return x.value >= 0 && x.value < double(machine_->tools.size());
    return starts(x) && !(x.letter == 'M' && (!x.whole() || laser_.has('M')));
  };
  auto unknown = [&](const Word* next) {
    size_t to = next < end ? next->begin : text.size();
    pass_on(unknown_name(text, *w), text.substr(w->end, to - w->end));
  };
  if (begins && w->letter == 'O' && letter_slot_['O' - 'A'] < 0) {  // the program's number and name
    Word* next = w + 1;
    while (next < end && !(starts(*next) && !std::isalpha(uint8_t(text[next->begin - 1])))) ++next;
    // Of a file with sub-programs it is known; what controls the flow of others is not.
    const bool text_follows = w + 1 < next && std::isalpha(uint8_t(text[w[1].begin])) != 0;
    if (!subprograms || subprograms->labels.empty() || text_follows) unknown(next);
    next_word_ = next < end ? size_t(next - words_.data()) : 0;
    return;
  }
  Word* first = w;
  if (!starts(*w) && !tool(*w)) {
    Word* next = w;
    while (next < end && !starts(*next)) ++next;
    const bool motion = moves(w, next);
    if (motion || next == end) {
      if (!motion && !begins) return;  // further words of a tool
      if (!motion) {
        if (w->letter == 'S' && w->number) {
          hear("S", w, end);
          return emit('S', 0, 0, "", text);
        }
        std::string name = unknown_name(text, *w);
        if (std::strchr("GMST", w->letter) && (w->number || name.size() == 1))
          return fail_word(Fault::word, name, text);
        return unknown(end);
      }
      next = std::find_if(w, end, behind_move);
      run_modal(w, next);
      if (next == end) return;
      w = next;
      first = w;
      if (waits()) return;
    } else {
      w = next;  // S12000 M3: the words before belong to the command
    }
  }
  while (w < end) {
    if (tool(*w)) {
      const std::string code = "T" + std::to_string(int(w->value));
      if (!w->built_in && is_macro(code)) {
        Word* next = std::find_if(w + 1, end, starts);
        const size_t to = next < end ? next->begin : text.size();
        hear(code, w + 1, next);
        emit_macro('T', int(w->value), 0, "", text.substr(w->end, to - w->end));
        next_word_ = next < end ? size_t(next - words_.data()) : 0;
        return;
      }
      select_tool(*w++);
      next_word_ = w < end ? size_t(w - words_.data()) : 0;
      return;
    }
    if (text_command(*w)) return run_command(*w, w + 1, w + 1, text.substr(w->end));
    const bool motion = w->letter == 'G' && w->value >= 0 && w->value <= 3 && w->whole();
    const bool modal = modal_follows(*w);
    Word* next = w + 1;
    for (bool moving = motion; next < end; ++next) {
      if (moving ? behind_move(*next) : starts(*next) || (toolless(*w) && tool(*next))) break;
      moving = moving || (modal && moves(next, next + 1));
    }
    size_t to = next < end ? next->begin : text.size();
    size_t from = first < w ? first->begin : w->end;
    std::string args(first < w ? std::string(text.substr(from, w->begin - from)) +
                                     std::string(text.substr(w->end, to - w->end))
                               : std::string(text.substr(from, to - from)));
    std::rotate(first, w, w + 1);  // words before it are its own, too
    run_command(*first, first + 1, next, args);
    w = next;
    first = w;
    if (w < end && waits()) return;
  }
}

inline void Interpreter::run_command(const Word& command, const Word* w, const Word* end,
                                     std::string_view text) {
  if (!sound(command)) return;
  const auto whole = code_of(command);
  const int code = whole.first, minor = whole.second;
  std::string name = command.letter + std::to_string(code);
  if (minor != 0) name += "." + std::to_string(minor);
  if (!command.built_in && is_macro(name)) {
    hear(name, w, end, text);
    return emit_macro(command.letter, code, minor, "", text);
  }
  const bool modal = before_axes(command.letter, code, minor) && moves(w, end);
  if (modal || before_modal(command.letter, code, minor))
    hear(name, w, w);
  else
    hear(name, w, end, text);
  if (modal) {
    emit(command.letter, code, minor, "", "");
    return run_modal(w, end);
  }
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  auto value_of = [&](char letter, double otherwise) {
    for (const Word* x = w; x < end; ++x)
      if (x->letter == letter && x->number) return x->value;
    return otherwise;
  };
  auto has = [&](char letter) {
    return std::any_of(w, end, [&](const Word& x) { return x.letter == letter; });
  };
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
  if (command.letter == 'G' && minor == 0) {
    switch (code) {
      case 0:
      case 1:
      case 2:
      case 3:
        motion_ = code;
        note_moved();
        return run_motion(code, w, end);
      case 4: {
        MoveRequest m{};
        m.kind = MoveKind::dwell;
        m.duration_s = has('S') ? value_of('S', 0) : value_of('P', 0) / 1000;
        stamp(m);
        m.radius_mm = m.feed_mm_s = kInfinity;
        if (!(has('S') ? within('S', m.duration_s, 0, kLongestMove)
                       : within('P', m.duration_s * 1000, 0, kLongestMove * 1000)))
          return;
        if (laser_.energy) m.energy_ws = std::max(0.0, value_of(laser_.energy, 0));
        if (!within(laser_.energy, m.energy_ws, 0, kLongestMove * laser_.most_w)) return;
        m.duration_s = std::max(m.duration_s, m.energy_ws / laser_.most_w);
        if (m.duration_s > 0) {
          Item item{};
          item.found = Found::move;
          item.move = m;
          pending_.push_back(item);
        }
        return;
      }
      case 10:
        for (const Word* x = w; x < end; ++x)  // zeros of coordinate systems, lengths of tools
          if (x->letter == 'L') return emit(0, 0, 0, "G10 " + unknown_name(text_, *x), text);
        if (has('P')) break;
        run_retract(true, has('S') && value_of('S', 0) != 0);
        return;
      case 11:
        run_retract(false);
        return;
      case 17:
      case 18:
      case 19:
        plane_ = code;
        return run_modal(w, end);
      case 20:
        unit_ = 25.4;
        return run_modal(w, end);
      case 21:
        unit_ = 1;
        return run_modal(w, end);
      case 28: {
        std::string letters;
        for (const Word* x = w; x < end; ++x)
          if (x->letter >= 'A' && x->letter <= 'Z' && letter_slot_[x->letter - 'A'] >= 0 &&
              !(filament_letters_ >> (x->letter - 'A') & 1))
            letters += x->letter;
        // O: only what does not know where it is, which the caller must find out.
        bool back = has('B') && letter_slot_['B' - 'A'] < 0;
        double before[kAxes], hop = hop_;
        if (place_of_tool(before) >= 0) here(before);
        if (has('O') && letter_slot_['O' - 'A'] < 0)
          letters += 'O';
        else
          home(letters);
        if (locked(kZ)) hop_ = 0;
        if (back && locked_ == 0) hop_ = hop;  // it goes back to where it was
        emit('G', 28, 0, "", back ? letters + 'B' : letters);
        if (back) queue_return(before);
        return;
      }
      case 73:
      case 81:
      case 82:
      case 83:
        cycle_begins_ = cycle_begins_ || !canned(motion_);
        motion_ = 10 * code;
        return run_cycle(code, w, end);
      case 80: {
        const bool cycle = motion_ > 3;
        if (cycle) motion_ = -1;
        // Where filament is printed it asks for bed levelling, as Prusa has it, with words of its
        // own.
        if (machine_->prints()) {
          if (cycle) return;
          break;
        }
        if (cycle && moves(w, end)) return fail(Fault::word, name, 0, 0);
        return run_modal(w, end);
      }
      case 98:
      case 99:
        to_level_ = code == 98;
        return run_modal(w, end);
      case 53:
        machine_zero_ = true;
        return run_modal(w, end);
      case 60:
      case 61:
        return run_saved(code == 60, w, end);
      case 90:
        absolute_ = true;
        return run_modal(w, end);
      case 91:
        absolute_ = false;
        return run_modal(w, end);
      case 92: {
        // An axis that does not know where it is learns it; of others only the zero moves.
        bool any = false;
        std::string learned, actuators;
        auto set = [&](char letter, int j, double value) {
          if (j == kE) {
            logical_e_ = value;
          } else if (locked(j)) {
            if (j == kZ) hop_ = 0;
            learned += letter + std::to_string(value - (j < 3 ? tool_offset(j) : 0)) + " ";
          } else {
            origin_[j] = meant(j) - value;
          }
        };
        for (const Word* x = w; x < end; ++x) {
          int j = x->letter >= 'A' && x->letter <= 'Z' ? letter_slot_[x->letter - 'A'] : -1;
          any = true;
          if (j < 0) {
            actuators += x->letter + std::to_string(x->value) + " ";
            continue;
          }
          set(x->letter, j, x->value * unit_);
        }
        for (char letter = 'A'; !any && letter <= 'Z'; ++letter)
          if (letter_slot_[letter - 'A'] >= 0) set(letter, letter_slot_[letter - 'A'], 0);
        if (!learned.empty()) emit('G', 92, 0, "", learned);
        if (!actuators.empty()) emit('G', 92, 1, "", actuators);
        return;
      }
      default:
        break;
    }
  }
  if (command.letter == 'M' && minor == 0) {
    switch (code) {
      case 98:
        return run_call(text);
      case 99:
        if (run_return(text)) return;
        break;
      case 82:
        absolute_e_ = true;
        return;
      case 83:
        absolute_e_ = false;
        return;
      case 200: {
        if (w == end) break;  // a question
        double tool = value_of('T', double(tool_)), mm = value_of('D', 1);
        if (tool == 0 && machine_->tools.empty()) return;  // extruders are axes
        if (!(tool >= 0 && tool < double(machine_->tools.size())))
          return fail(Fault::missing_tool, "T", tool, double(machine_->tools.size()));
        if (mm != 0 && !within('D', mm, kThinnest, kThickest)) return;
        int extruder = machine_->tools[size_t(tool)].extruder;
        if (has('D') && mm > 0 && extruder >= 0) diameter_[size_t(extruder)] = mm;
        volumetric_ = mm > 0 && value_of('S', 1) != 0;
        return;
      }
      case 209:
        if (!has('S')) break;  // a question
        auto_retract_ = value_of('S', 0) != 0;
        return;
      case 603:
      case 701:
      case 702:
        if (run_filament(code, w, end)) return;
        break;
      case 486:
        return run_objects("M486", text);
      case 207:
        for (char letter : {'S', 'Z', 'W'})
          if (!within(letter, value_of(letter, 0), 0, kLongestChange)) return;
        if (!within('R', value_of('R', 0), -kLongestChange, kLongestChange)) return;
        retraction_.mm = value_of('S', retraction_.mm);
        retraction_.feed_mm_s = has('F') ? value_of('F', 0) / 60 : retraction_.feed_mm_s;
        retraction_.hop_mm = value_of('Z', retraction_.hop_mm);
        retraction_.recover_mm = value_of('R', retraction_.recover_mm);
        retraction_.swap_mm = value_of('W', retraction_.swap_mm);
        return;
      case 208:
        for (char letter : {'S', 'W'})
          if (!within(letter, value_of(letter, 0), -kLongestChange, kLongestChange)) return;
        retraction_.recover_mm = value_of('S', retraction_.recover_mm);
        retraction_.swap_recover_mm = value_of('W', retraction_.swap_recover_mm);
        retraction_.recover_feed_mm_s =
            has('F') ? value_of('F', 0) / 60 : retraction_.recover_feed_mm_s;
        return;
      default:
        break;
    }
  }
  if (command.letter == 'M' && code == 5) dark();
  emit(command.letter, code, minor, "", text);
  std::vector<Word> way;
  if (moves_otherwise(command.letter, code) && moves(w, end)) motion_ = 10 * code + minor;
  if (beside_axes(command.letter, code, minor))
    std::copy_if(w, end, std::back_inserter(way),
                 [this](const Word& x) { return names_axis(x) || x.letter == 'F'; });
  if (!way.empty()) run_modal(way.data(), way.data() + way.size());
}

// Words without a motion command of their own.
inline void Interpreter::run_modal(const Word* w, const Word* end) {
  if (motion_ < 0) motion_ = 1;
  if (w == end) return;
  if (motion_ > 3) {  // as often as it would move
    if (canned(motion_)) {
      hear("", w, end);
      return run_cycle(motion_ / 10, w, end);
    }
    std::string_view text = std::string_view(text_).substr(w->begin, end[-1].end - w->begin);
    std::string name = "G" + std::to_string(motion_ / 10);
    if (motion_ % 10 != 0) name += "." + std::to_string(motion_ % 10);
    hear(name, w, end, text);
    return emit('G', motion_ / 10, motion_ % 10, "", text);
  }
  note_moved();
  hear("", w, end);
  run_motion(motion_, w, end);
}

// A laser's or spindle's power, of a move's S word.
inline void Interpreter::emit_power(double power) {
  char text[40];
  std::snprintf(text, sizeof text, "S%.6g", power);
  emit('S', 0, 0, "", text);
}

inline void Interpreter::run_motion(int code, const Word* w, const Word* end) {
  if (w == end) return;
  double value[26] = {}, feed = feed_, duration = 0, laser = 0, energy = 0;
  uint32_t have = 0, seen = 0;
  uint32_t relative = this->relative();
  bool keeps_feed = true, has_laser = false, timed = false;
  int turns = 0;
  for (const Word* x = w; x < end; ++x) {
    std::string shown(1, x->letter);
    int slot = x->letter >= 'A' && x->letter <= 'Z' ? letter_slot_[x->letter - 'A'] : -1;
    if (x->letter == 'R' && code < 2) {  // all are absolute but those right behind it
      if (x->number) continue;
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
      if (!(x->value > 0)) return fail(Fault::feedrate, "F", x->value, 0);
      feed = x->value * unit_ / 60;
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
    }
  }
  if (keeps_feed) feed_ = feed;
  if (has_laser) {
    emit_power(laser);
  }
  uint32_t axes = 0;
  for (int k = 0; k < 26; ++k)
    if ((have >> k & 1) && letter_slot_[k] >= 0) axes |= 1u << k;
  if (code >= 2) {
    move_.feed_mm_s = feed;
    move_.energy_ws = 0;  // an arc knows only a density
    return run_arc(code == 2, value, have, turns);
  }
  double begin[kAxes];
  const bool begins = place_of_tool(begin) < 0;
  if (!target(value, axes, relative, offset_letters(axes)) || retracts(axes)) return;
  // Filament is laid from where the tool in use was meant to be, not on the way to there.
  if (begins && (axes & ~filament_letters_) != 0 && lays_filament()) queue_offset(begin, feed);
  queue_straight(timed ? kInfinity : feed, duration, code == 0, energy);  // T in place of F
}

// The target that move_ has now.
inline void Interpreter::queue_straight(double feed, double duration, bool rapid,
                                        double energy_ws) {
  move_.energy_ws = energy_ws;
  move_.feed_mm_s = feed;
  move_.duration_s = duration;
  move_.radius_mm = kInfinity;
  move_.arc_inner = false;
  move_.rapid = rapid;
  stamp(move_);
  Item item{};
  item.found = Found::move;
  item.move = move_;
  item.move.kind = MoveKind::travel;
  pending_.push_back(std::move(item));
}

inline void Interpreter::run_arc(bool clockwise, const double* value, uint32_t have, int turns) {
  double radius = (have >> ('R' - 'A') & 1) ? value['R' - 'A'] * unit_ : 0;
  static constexpr int kPlane[3][2] = {{0, 1}, {2, 0}, {1, 2}};  // G17 XY, G18 ZX, G19 YZ
  static constexpr char kCentre[3][2] = {{'I', 'J'}, {'K', 'I'}, {'J', 'K'}};
  static constexpr const char* kWords[3] = {"I, J and R", "K, I and R", "J, K and R"};
  int u = kPlane[plane_ - 17][0], v = kPlane[plane_ - 17][1];
  uint32_t axes = 0;
  for (int k = 0; k < 26; ++k)
    if ((have >> k & 1) && letter_slot_[k] >= 0) axes |= 1u << k;
  double feed = move_.feed_mm_s, e_before = logical_e_, start[kAxes];
  arc_hop_ = hop_;
  uint8_t cut = cut_;
  if (const int j = place_of_tool(start); j >= 0) {
    const double limit = meant(j) < low_[j] ? low_[j] : high_[j];
    if (!clamp) return fail(Fault::out_of_range, axis_name(j), meant(j), limit);
    note_clamp(j, meant(j), limit);
    cut |= uint8_t(1u << j);
  }
  const double due[3] = {due_[kX], due_[kY], due_[kZ]};
  const uint8_t cut_before = cut_;
  if (!target(value, axes, relative(), offset_letters(axes, true))) return;
  cut |= cut_;
  const bool whole = (cut & (1u << u | 1u << v)) == 0;  // both ends are where the program means
  double end[kAxes];
  std::copy(move_.target, move_.target + kAxes, end);
  auto none = [&](Fault fault, const std::string& word, double value, double limit) {
    arc_ = Arc();
    logical_e_ = e_before;
    hop_ = arc_hop_;
    cut_ = cut_before;
    owe(due);
    fail(fault, word, value, limit);
  };
  auto straight = [&] {
    queue_offset(start, feed);
    queue_straight(feed, 0, false);
  };
  auto given = [&](char letter) { return (have >> (letter - 'A') & 1) != 0; };
  double du = end[u] - start[u], dv = end[v] - start[v], d2 = du * du + dv * dv, cu, cv;
  if (radius != 0) {
    double h2 = radius * radius - d2 / 4;
    const bool apart = h2 < -1e-3 * radius * radius;
    if (d2 == 0 ? !whole : apart && Arc::tiny(std::sqrt(d2))) return straight();
    if (whole && (d2 == 0 || apart)) return none(Fault::arc, "R", radius, std::sqrt(d2) / 2);
    double h = std::sqrt(std::max(0.0, h2) / d2) * ((clockwise == (radius > 0)) ? 1 : -1);
    cu = start[u] + du / 2 + dv * h;
    cv = start[v] + dv / 2 - du * h;
  } else {
    auto centre = [&](char letter) { return given(letter) ? value[letter - 'A'] * unit_ : 0.0; };
    double i = centre(kCentre[plane_ - 17][0]), j = centre(kCentre[plane_ - 17][1]);
    if (i == 0 && j == 0) {  // no more than the ends may be off a circle, or no arc
      const bool circle = given('R') ? d2 > 0 : given('I') || given('J') || given('K');
      if (circle && Arc::tiny(std::sqrt(d2))) return straight();
      return none(Fault::centre, kWords[plane_ - 17], 0, 0);
    }
    cu = start[u] + i;
    cv = start[v] + j;
  }
  if (!arc_.begin(start, end, u, v, cu, cv, clockwise, turns))
    return none(Fault::range, "P", turns + 1.0, arc_.most_turns());
  if (2 * arc_.radius() <= Arc::kChordError) {  // a line is as near to it as its chords may be
    arc_ = Arc();
    return straight();
  }
  if (whole && !arc_.round()) return none(Fault::radii, "", arc_.start_radius(), arc_.end_radius());
  GcodeError out;
  if (!clamp && !arc_in_range(start, u, v, out))
    return none(out.fault, out.word, out.value, out.limit);
  ++arcs_;
  arc_move_ = move_;
  arc_move_.feed_mm_s = feed;
  arc_move_.duration_s = 0;
  arc_move_.rapid = false;
  arc_move_.radius_mm = arc_.radius();
  arc_move_.arc_axis = arc_.axis();
  stamp(arc_move_);
  queue_offset(start, feed);
}

// Whether no chord of the arc, which begins at `start`, ends beyond a limit of the slots of its
// plane, where target() has looked at its ends alone; else fills `error` with how far it goes.
inline bool Interpreter::arc_in_range(const double* start, int u, int v, GcodeError& error) const {
  auto hop = [this](int j) { return j == kZ ? arc_hop_ : 0; };
  auto round = [&](int j) {
    return arc_.lowest(j) - hop(j) >= low_[j] && arc_.highest(j) - hop(j) <= high_[j];
  };
  if (round(u) && round(v)) return true;
  int out = -1;
  double from[3] = {start[kX], start[kY], start[kZ]}, to[kAxes];
  for (Arc rest = arc_; rest.active(); std::copy(to, to + 3, from)) {
    rest.next(to);
    for (int j : {u, v}) {
      const double at = to[j] - hop(j);
      if (hop(j) > 0) to[j] = std::min(to[j], high_[j]);
      if (!beyond(j, at, from[j]) || (out >= 0 && out != j)) continue;
      const double limit = at < low_[j] ? low_[j] : high_[j];
      if (out == j && std::fabs(at - limit) <= std::fabs(error.value - error.limit)) continue;
      out = j;
      error.fault = Fault::out_of_range;
      error.word = axis_name(j);
      error.value = at;
      error.limit = limit;
    }
  }
  return out < 0;
}

inline bool Interpreter::next_chord() {
  arc_.next(arc_move_.target);
  for (int j = 0; j < 3; ++j) {
    const double hop = j == kZ ? arc_hop_ : 0, at = arc_move_.target[j] - hop;
    if (beyond(j, at)) {
      const double limit = at < low_[j] ? low_[j] : high_[j];
      if (!clamp) {
        fail(Fault::out_of_range, machine_->axes[size_t(j)].name, at, limit);
        take_back(arc_move_.target[kE] - position_[kE] + arc_.left(kE));
        arc_ = Arc();
        return false;
      }
      note_clamp(j, at, limit);
      arc_move_.target[j] = limit + hop;
    }
    if (hop > 0) arc_move_.target[j] = std::min(arc_move_.target[j], high_[j]);  // as there is room
  }
  arc_move_.arc_inner = !arc_.first();
  return take(arc_move_);
}

inline void Interpreter::take_tool(size_t tool) {
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

inline void Interpreter::select_tool(const Word& word) {
  if (!sound(word)) return;
  int tool = int(word.value);
  if (tool == 0 && machine_->tools.empty()) return;              // extruders are axes
  if (tool < 0) return pass_on("T" + std::to_string(tool), "");  // it may mean none: no change
  hear("T" + std::to_string(tool), nullptr, nullptr);
  if (size_t(tool) >= machine_->tools.size()) {
    if (!ignore_tools) return fail(Fault::missing_tool, "T", tool, double(machine_->tools.size()));
    return emit('T', tool, 1, "", "");
  }
  take_tool(size_t(tool));
  emit('T', tool, 0, "", "");
  // It has no G11 to come, and would print in the air.
  if (!extruder_.empty() && !drawn_[active_].back)
    queue_step(kZ, -std::exchange(hop_, 0), kInfinity);
}

}  // namespace passo
