// Reads a line in any dialect, and splits it into commands and events.
#include <algorithm>
#include <cctype>
#include <cstring>

#include "gcode/exponents.hpp"
#include "gcode/interpreter.hpp"
#include "gcode/stray.hpp"
#include "gcode/utf8.hpp"
#include "gcode/word_grammar.hpp"

namespace passo {

void Interpreter::run_line(const char* p, const char* end) {
  if (watching()) watched_line_ = WatchedLine();  // a line of a sub-program may run again
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
  if ((*q == 'N' || *q == 'n') && text.size() > 1) {  // a console's line number and checksum
    double number;
    const char* after = q + 1;
    if (read_number(after, q + text.size(), number)) {
      size_t star = last_star(text);
      if (star == std::string::npos && begins_message(after)) star = text.rfind('*');
      if (star != std::string::npos) {
        uint8_t sum = 0;
        for (size_t i = 0; i < star; ++i) sum ^= uint8_t(text[i]);
        const char* s = text.data() + star + 1;
        double given;
        if (read_number(s, text.data() + text.size(), given) && given == sum && nothing_left(s)) {
          watched_line_.checked |= watching();
          text.resize(star);
          q = text.data();
          after = q + 1;
          read_number(after, q + text.size(), number);
        } else if (!takes_text(after)) {
          return fail(Fault::checksum, text.substr(star), sum, 0);
        }
      }
      if (watching()) watched_line_.number.assign(q + 1, after);
      text.erase(0, size_t(after - q));
      while (!text.empty() && std::isspace(uint8_t(text[0]))) text.erase(0, 1);
    }
  }
  if (const size_t code = object_code(text)) {
    std::string name = text.substr(0, code);
    for (char& c : name) c = char(std::toupper(uint8_t(c)));
    const std::string_view rest = without_comment(std::string_view(text).substr(code));
    note_command(name, nullptr, nullptr, rest);
    return run_objects(name, rest);
  }
  strip_comments(text, note);
  if (!note.empty() && text.empty()) return comment(note);
  text.erase(0, std::min(text.find_first_not_of(" \t"), text.size()));
  if (text.empty()) return;
  if (text[0] == '/')
    return pass_on("/", text.substr(1));  // block delete: the line is skipped if that is on
  if (has_name(text)) {
    size_t stop = 0;
    while (stop < text.size() &&
           (std::isalnum(uint8_t(text[stop])) || text[stop] == '_' || text[stop] == '.'))
      ++stop;
    std::string name = text.substr(0, stop);
    for (char& c : name) c = char(std::toupper(uint8_t(c)));
    return pass_on(name, text.substr(std::min(stop + 1, text.size())));
  }
  if (text[0] == '_' || text[0] == '$' || text[0] == '@') {  // $H of grbl, @pause of a host program
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

// Splits a line into commands. Each G or M word starts one, with the words up to the next G or M. A
// T word before any other command is a command too. Words before the first command belong to it; if
// they name axes or F, they are a modal move instead. The words after a move wait until next() has
// returned that move.
void Interpreter::run_words() {
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
    // A binary file has such a character in its first line.
    const bool text_begins = number() > 1 || character_at(text, w->begin).first >= 0;
    return text_begins ? fail_word(Fault::word, std::string(text.substr(w->begin, 20)), text)
                       : fail(Fault::garbage, "", 0, 0);
  }
  auto starts = [&](const Word& x) { return (x.letter == 'G' || x.letter == 'M') && x.number; };
  auto tool = [&](const Word& x) { return x.letter == 'T' && x.whole(); };
  // Whether the word starts a new command after a move.
  auto after_move = [&](const Word& x) {
    if (tool(x)) return x.value >= 0 && x.value < double(machine_->tools.size());
    return starts(x) && !(x.letter == 'M' && (!x.whole() || laser_.has('M')));
  };
  auto unknown = [&](const Word* next) {
    size_t to = next < end ? next->begin : text.size();
    pass_on(unknown_name(text, *w), text.substr(w->end, to - w->end));
  };
  if (begins && w->letter == 'O' &&
      letter_slot_['O' - 'A'] < 0) {  // number and name of the program
    Word* next = w + 1;
    while (next < end && !(starts(*next) && !std::isalpha(uint8_t(text[next->begin - 1])))) ++next;
    // In a file with sub-programs this is a label. In other files O words are control flow, which
    // Passo does not have.
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
      if (!motion && !begins) return;  // further words of the T command
      if (!motion) {
        if (w->letter == 'S' && w->number) {
          note_command("S", w, end);
          return emit('S', 0, 0, "", text);
        }
        std::string name = unknown_name(text, *w);
        if (std::strchr("GMST", w->letter) && (w->number || name.size() == 1))
          return fail_word(Fault::word, name, text);
        return unknown(end);
      }
      next = std::find_if(w, end, after_move);
      run_modal(w, next);
      if (next == end) return;
      w = next;
      first = w;
      if (waits()) return;
    } else {
      w = next;  // as in S12000 M3: the words belong to the command after them
    }
  }
  while (w < end) {
    if (tool(*w)) {
      const int number = code_of(*w).first;
      const std::string code = code_name('T', number);
      if (!w->built_in && is_macro(code)) {
        Word* next = std::find_if(w + 1, end, starts);
        const size_t to = next < end ? next->begin : text.size();
        note_command(code, w + 1, next);
        emit_macro('T', number, 0, "", text.substr(w->end, to - w->end));
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
      if (moving ? after_move(*next) : starts(*next) || (toolless(*w) && tool(*next))) break;
      moving = moving || (modal && moves(next, next + 1));
    }
    size_t to = next < end ? next->begin : text.size();
    size_t from = first < w ? first->begin : w->end;
    std::string args(first < w ? std::string(text.substr(from, w->begin - from)) +
                                     std::string(text.substr(w->end, to - w->end))
                               : std::string(text.substr(from, to - from)));
    std::rotate(first, w, w + 1);  // the words before it belong to it, too
    run_command(*first, first + 1, next, args);
    w = next;
    first = w;
    if (w < end && waits()) return;
  }
}

// Whether the text of the program has ended before this line. Zero bytes up to the end of the file
// end it: such a file was cut off. The Ctrl-Z of DOS ends it too; text after it may be anything but
// commands. If the text ends within this line, `end` becomes that place.
bool Interpreter::ends_text(const char* p, const char*& end) {
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

// Reads layers and line types from comments of slicers.
void Interpreter::comment(std::string_view text) {
  layers.comment(text);
  constexpr std::string_view kType = "TYPE:";
  if (text.substr(0, kType.size()) == kType) {
    text.remove_prefix(kType.size());
    while (!text.empty() && std::isspace(uint8_t(text.back()))) text.remove_suffix(1);
    std::string name = readable(text);
    auto at = std::find(features_.begin(), features_.end(), name);
    if (at == features_.end() && features_.size() < 1000) at = features_.insert(at, name);
    feature_ = at == features_.end() ? 0 : uint16_t(at - features_.begin());
  }
}

// Passes on a command that is not a letter and a number, or that is unknown.
void Interpreter::pass_on(std::string_view name, std::string_view text) {
  const Macros& macros = machine_->macros;
  if (macros.any()) {
    const std::string code(name);
    const std::string* original = macros.original(code);
    if (original) name = *original;
    if (!original && is_macro(code)) {
      note_command(name, nullptr, nullptr, text);
      return emit_macro(0, 0, 0, name, text);
    }
  }
  note_command(name, nullptr, nullptr, text);
  emit(0, 0, 0, name, text);
}

// Replaces codes by which a macro calls a built-in command with the code of that command.
void Interpreter::find_built_in() {
  if (machine_->macros.built_in.empty()) return;
  for (Word& w : words_) {
    if (w.letter != 'G' && w.letter != 'M' && !(w.letter == 'T' && &w == &words_.front())) continue;
    if (!w.number) continue;
    const auto [code, minor] = code_of(w);
    const std::string* original = machine_->macros.original(code_name(w.letter, code, minor));
    if (!original) continue;
    const char* p = original->c_str() + 1;
    read_number(p, original->c_str() + original->size(), w.value);
    w.letter = original->front();
    w.built_in = true;
  }
}

void Interpreter::note_command(std::string_view code, const Word* first, const Word* last,
                               std::string_view text) {
  ++commands_;
  if (!watching()) return;
  std::vector<std::string> words;
  for (; first < last; ++first)
    words.push_back(
        readable(std::string_view(text_).substr(first->begin, first->end - first->begin)));
  while (!text.empty() && std::isspace(uint8_t(text.front()))) text.remove_prefix(1);
  while (!text.empty() && std::isspace(uint8_t(text.back()))) text.remove_suffix(1);
  watched_line_.commands.push_back(
      {readable(code.substr(0, kMaxNameBytes)), std::move(words), readable(text)});
}

void Interpreter::emit(char letter, int number, int minor, std::string_view name,
                       std::string_view text) {
  Item item{};
  item.found = ParseResult::event;
  name = name.substr(0, kMaxNameBytes);
  item.event = {this->number(), letter, number, minor, readable(name), readable(text)};
  pending_.push_back(std::move(item));
}

// After this event the caller must insert() the lines of the macro.
void Interpreter::emit_macro(char letter, int number, int minor, std::string_view name,
                             std::string_view text) {
  while (!text.empty() && std::isspace(uint8_t(text.front()))) text.remove_prefix(1);
  while (!text.empty() && std::isspace(uint8_t(text.back()))) text.remove_suffix(1);
  emit(letter, number, minor, name, text);
  pending_.back().found = ParseResult::macro;
}

void Interpreter::fail(Fault fault, const std::string& word, double value, double limit) {
  Item item{};
  item.found = ParseResult::error;
  item.error = {number(), fault, readable(word), value, limit, {0, 0, 0}};
  pending_.push_back(std::move(item));
}

// Reports a word that cannot be read. If the text contains a character that is not G-code, the
// error names that character.
void Interpreter::fail_word(Fault fault, const std::string& word, std::string_view text) {
  const Stray stray = find_stray(text, true);
  if (stray.code == 0) return fail(fault, word, 0, 0);
  fail(Fault::stray, stray.token, double(stray.code), 0);
}

bool Interpreter::within(char letter, double value, double least, double most) {
  if (value >= least && value <= most) return true;
  fail(Fault::range, std::string(1, letter), value, most);
  pending_.back().error.point[0] = least;
  return false;
}

bool Interpreter::sound(const Word& word) {
  if (word.number && std::fabs(word.value) <= kLargestWord) return true;
  if (!word.number) {
    fail_word(Fault::number, std::string(1, word.letter), text_);
    return false;
  }
  fail(Fault::number, std::string(1, word.letter), word.value, kLargestWord);
  return false;
}

// Whether the letter is already among those `seen` in this command; if so, reports an error.
bool Interpreter::repeated(const Word& word, uint32_t& seen) {
  if (word.letter < 'A' || word.letter > 'Z') return false;
  const uint32_t bit = 1u << (word.letter - 'A');
  if ((seen & bit) != 0) fail(Fault::repeated, std::string(1, word.letter), 0, 0);
  return (std::exchange(seen, seen | bit) & bit) != 0;
}

void Interpreter::note_clamp(int j, double value, double limit) {
  if (clamped_[j].times++ == 0)
    clamped_[j].first = {number(), Fault::out_of_range, axis_name(j), value, limit, {}};
}

// Whether words without a motion command are a move: they contain an axis, F, I or J.
bool Interpreter::moves(const Word* w, const Word* end) const {
  return std::any_of(w, end, [this](const Word& x) {
    return x.letter == 'F' || x.letter == 'I' || x.letter == 'J' || names_axis(x);
  });
}

}  // namespace passo
