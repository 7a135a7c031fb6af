// The motion state of a G-code program: lines in, moves and events out, in order.
#pragma once
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/types.hpp"
#include "gcode/arc.hpp"
#include "gcode/cycle.hpp"
#include "gcode/exponents.hpp"
#include "gcode/layers.hpp"
#include "gcode/lexer.hpp"
#include "gcode/objects.hpp"
#include "gcode/parse_result.hpp"
#include "gcode/stray.hpp"
#include "gcode/subprograms.hpp"
#include "gcode/words.hpp"
#include "machine/machine.hpp"
#include "plan/extrusion_flow.hpp"

namespace passo {

class Interpreter {
 public:
  bool clamp = false;         // targets out of range go to the limit
  bool ignore_tools = false;  // a missing tool is left alone
  uint8_t cold = 0;           // a bit for each slot whose filament is too cold to move
  std::shared_ptr<const Subprograms> subprograms;  // of the program; null: M98 is an error
  bool ignore_calls = false;                       // of sub-programs that are missing: events
  bool calls_are_events = false;                   // M98 and M99 are not carried out
  bool plain = false;                              // macros are not called: all is built in
  LayerCounter layers;                             // of the program

  Interpreter(const Machine& machine, std::vector<double> home, const LaserWords& laser)
      : machine_(&machine), home_(std::move(home)), laser_(laser),
        extruder_(machine.extruders.size(), 0.0), filament_(machine.extruders.size()),
        diameter_(machine.extruders.size(), kUsualMm),
        change_(machine.extruders.size(), Change{100, 100}), drawn_(machine.extruders.size()),
        strands_(machine.extruders.size()) {
    std::fill(std::begin(letter_slot_), std::end(letter_slot_), int8_t(-1));
    for (size_t i = 0; i < machine.axes.size(); ++i)
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
      // Arms that move no Z may not reach the origin: their machine begins at home.
      if (machine.axes[i].by_arms && !machine.axes[size_t(kZ)].by_arms) position_[j] = home_[i];
      homed_[j] = home_[i];
    }
    measure_steps();
    features_.push_back("");
  }

  // Lines come from a program and from a console; one modal state serves both. Each keeps its own
  // unread text; the source may change only at a boundary between lines.
  void select(bool console) { source_ = console; }
  // A macro that a console calls is part of its line; of a program other lines may come between
  // those of a macro.
  bool at_boundary() const {
    return !unfinished() && next_word_ == 0 && !(source_ && !frames_[1].empty());
  }
  void feed(const char* data, size_t n) { sources_[source_].feed(data, n); }
  void finish() { sources_[source_].finish(); }
  // Forgets the unread text of the selected source; its lines count from `first` again, and the
  // layers too where that is the first line of all.
  void restart(uint32_t first = 1) {
    sources_[source_] = Lines(first);
    frames_[source_].clear();
    if (!source_) ended_line_ = 0;
    if (first == 1) layers = LayerCounter();
    if (first == 1 && !source_) forget_objects();
    dark();
  }
  // No move gets a laser's energy any more that does not ask for it again.
  void dark() { density_ = 0; }
  uint64_t offset() const { return sources_[source_].offset(); }
  // The machine is at `position`, its extruders where they are told to be: what the program still
  // meant to do in this line is forgotten, and its positions follow the machine's.
  void abandon(const double* position, const std::vector<double>& extruders) {
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
    // The move that was to carry out the tool's offset has not begun: the offset is still owed.
    if (owed_.line == number() && owed_.tool == tool_ &&
        std::equal(owed_.from, owed_.from + 3, position_))
      owe(owed_.mm);
  }
  // This tool is in use, if it has an extruder. Nothing where extruders are axes. No axis moves:
  // the next move of an axis carries out the difference of the offsets on all axes.
  void take_tool(size_t tool);
  // mm by which the next move of an axis moves slot j (X, Y or Z) for a change of tools, or of the
  // offset of the tool in use.
  double offset_due(int j) const { return due_[j]; }
  // The tool is where the machine is: no offset is to be carried out.
  void forget_offset() {
    constexpr double kNone[3] = {};
    owe(kNone);
  }
  // Takes up the program again as `before` left it, except for what the console has not said yet,
  // and for settings that it has changed, which modes are not.
  void resume(const Interpreter& before) {
    Interpreter mine = std::move(*this);
    *this = before;
    sources_[1] = std::move(mine.sources_[1]);
    frames_[1] = std::move(mine.frames_[1]);
    std::copy(std::begin(mine.saved_), std::end(mine.saved_), saved_);
    diameter_ = std::move(mine.diameter_);
    volumetric_ = mine.volumetric_;
    change_ = std::move(mine.change_);
    std::copy(std::begin(mine.homed_), std::end(mine.homed_), homed_);
    auto_retract_ = mine.auto_retract_;
    retraction_ = mine.retraction_;
  }
  // Takes the state that a program has in another interpreter of the same machine; what is unread
  // here, and which axes know where they are, stays.
  void adopt(const Interpreter& other) {
    Interpreter mine = std::move(*this);
    *this = other;
    machine_ = mine.machine_;
    sources_[0] = std::move(mine.sources_[0]);
    sources_[1] = std::move(mine.sources_[1]);
    source_ = mine.source_;
    locked_ = mine.locked_;
    std::copy(std::begin(mine.homed_), std::end(mine.homed_), homed_);
    cold = mine.cold;
    subprograms = std::move(mine.subprograms);
    ignore_calls = mine.ignore_calls;
    frames_[0].clear();
    frames_[1] = std::move(mine.frames_[1]);
  }
  // Axis slot j is at this machine position now, and at home there if it is `homed`; the program's
  // zero stays where it was.
  void set_axis(int j, double position, bool homed) {
    position_[j] = position;
    if (homed) homed_[j] = position;
    gap_[j] = 0;
    if (j < 3) origin_[j] = -tool_offset(j), owe(j, 0);
  }
  // The active tool's offset is about to become `mm` along axis slot j; the next move carries it
  // out.
  void shift_tool(int j, double mm) {
    origin_[j] -= mm - tool_offset(j);
    owe(j, due_[j] - (mm - tool_offset(j)));
  }
  // The program's zero moves by so much along slot j (X, Y or Z).
  void shift_zero(int j, double mm) { origin_[j] += mm; }
  // The machine lies so much further along slot j, and all that the program still does with it.
  void shift(int j, double mm) {
    origin_[j] += mm;
    position_[j] += mm;
    arc_.shift(j, mm);
    cycle_.shift(j, mm);
    cycle_level_ += j == kZ ? mm : 0;
    for (Item& item : pending_) item.move.target[j] += mm;
  }
  // There is no room for the hop behind the moves taken so far, the last of which has had `mm` of
  // it.
  void drop_hop(double mm) {
    position_[kZ] -= mm;
    arc_.shift(kZ, -mm);
    arc_hop_ = arc_move_.hop_mm = 0;
    for (Item& item : pending_) item.move.target[kZ] -= std::exchange(item.move.hop_mm, 0);
    hop_ = 0;
  }
  // An extruder stays `mm` behind what the program has moved it; the program does not notice.
  void leave_filament(size_t extruder, double mm) {
    extruder_[extruder] -= mm;
    if (extruder == active_) {
      position_[kE] -= mm;
      arc_.shift(kE, -mm);
    }
    for (Item& item : pending_)  // of the extruder in use: a change of tools comes after them
      if (item.found == Found::move && extruder == active_) item.move.target[kE] -= mm;
  }
  // mm of filament for a mm, or mm³, of the program's E.
  double e_scale() const {
    if (extruder_.empty()) return 1;
    double flow = filament_[active_].flow;
    if (!volumetric_) return flow;
    double r = 0.5 * diameter_[active_];
    return flow / (kPi * r * r);
  }
  // M221 of an extruder.
  double flow(size_t extruder) const { return filament_[extruder].flow; }
  void set_flow(size_t extruder, double flow) { filament_[extruder].flow = flow; }
  // The plan behind which the program goes on has been changed so, and what is left of a line
  // changes too.
  void change_flow(size_t extruder, FlowChange& change);
  // Nothing that was drawn back is to come back.
  void forget_retraction() {
    for (Filament& filament : filament_) filament.owed = 0;
    std::fill(drawn_.begin(), drawn_.end(), Drawn{});
    std::fill(strands_.begin(), strands_.end(), Strand{});
    std::fill(std::begin(axis_strands_), std::end(axis_strands_), Strand{});
    hop_ = 0;
  }
  // Whether axis slot j may be at this machine position; else what the error says.
  bool in_range(int j, double at, GcodeError& error) const {
    if ((at >= low_[j] - 1e-6 && at <= high_[j] + 1e-6) || at_home(j, at)) return true;
    error = {0, Fault::out_of_range, axis_name(j), at, at < low_[j] ? low_[j] : high_[j], {}};
    return false;
  }
  // M207 and M208.
  struct Retraction {
    double mm = 3, feed_mm_s = 45, hop_mm = 0, recover_mm = 0, recover_feed_mm_s = 0;
    double swap_mm = 13, swap_recover_mm = 0;
  };
  const Retraction& retraction() const { return retraction_; }
  // M200: E is a volume, of filament with this diameter for each extruder; and M209.
  bool volumetric() const { return volumetric_; }
  const std::vector<double>& diameters() const { return diameter_; }
  bool auto_retract() const { return auto_retract_; }
  // What a program begins with if it does not say so itself: commands for it, one a line, in mm.
  std::string modes() const {
    std::string lines = "G21\n";
    if (!machine_->tools.empty()) lines += "T" + std::to_string(tool_) + "\n";
    if (feed_ < kInfinity) lines += "G1 F" + std::to_string(feed_ * 60) + "\n";
    lines += "G" + std::to_string(plane_) + (absolute_ ? "\nG90\n" : "\nG91\n");
    return lines + (absolute_e_ ? "M82\n" : "M83\n") + (unit_ == 1 ? "G21" : "G20");
  }
  // G90, M82, and the feedrate, mm/s (infinite: none yet).
  struct Modal {
    bool absolute, absolute_e;
    double feed_mm_s;
  };
  Modal modal() const { return {absolute_, absolute_e_, feed_}; }
  static constexpr double kLoadMmS = 6, kUnloadMmS = 20;  // speeds of M701 and M702
  static constexpr double kLongestChange = 5000;          // mm that they move, at most
  struct Change {
    double load_mm, unload_mm;  // M603, of filament
  };
  const std::vector<Change>& changes() const { return change_; }
  // A locked axis does not know where it is: moves of it fail until it is homed or set by G92.
  void lock(int j, bool locked) {
    locked_ = uint8_t(locked ? locked_ | 1u << j : locked_ & ~(1u << j));
  }
  bool locked(int j) const { return locked_ >> j & 1; }
  // Where the machine is on slot j in the program's own coordinates; E as the program counts it.
  double logical(int j) const { return j == kE ? logical_e_ : meant(j) - gap(j) - origin_[j]; }
  // Objects of the program. Moves of those that are cancelled are not handed out; after them the
  // machine travels to where the next move is to begin.
  Objects& objects() { return *objects_; }
  const Objects& objects() const { return *objects_; }
  // The object that a line of the main program belongs to, of those read lately; -1: none.
  int object_of_line(uint32_t line) const { return object_lines_.at(line); }
  // Notes what becomes of the program's line of this number, see heard().
  void listen(uint32_t line) { listened_ = line; }
  const Heard& heard() const { return heard_; }
  // Commands so far, unknown ones too.
  uint64_t commands() const { return commands_; }
  // All was read, and the last line is a move without an end of line.
  bool ends_in_move() const { return lines().unended() && moved_line_ == number(); }
  const MoveRequest& move() const { return move_; }
  const Event& event() const { return event_; }
  const GcodeError& error() const { return error_; }
  // Of the program or console: not of a sub-program.
  uint32_t line() const { return sources_[source_].number(); }
  // After Found::macro: these lines are what the call means. They come before the rest of its line.
  void insert(std::string_view text);
  // How many macros are under way within each other.
  size_t macro_depth() const { return frames_of(FrameKind::macro); }
  // What a console's macros have not done yet is not done.
  void forget_macros() { frames_[1].clear(); }
  uint64_t arcs() const { return arcs_; }
  // The arc that is under way, or begins with the next move.
  const Arc& arc() const { return arc_; }
  void note_arc_reached() { arc_.note_reached(); }
  // The next chord of `rest`, a copy of it, as it will be a move's target.
  void take_chord(Arc& rest, double* target) const {
    rest.next(target);
    if (arc_hop_ > 0) target[kZ] = std::min(target[kZ], high_[kZ]);  // as there is room
  }
  // Targets of slot j that went to the limit instead, and the first one's error.
  struct Clamped {
    uint64_t times = 0;
    GcodeError first;
  };
  const Clamped& clamped(int j) const { return clamped_[j]; }
  const std::vector<std::string>& features() const { return features_; }
  const double* position() const { return position_; }
  size_t extruder() const { return active_; }
  size_t tool() const { return tool_; }

  Found next() {
    for (;;) {
      if (!pending_.empty()) {
        Item item = std::move(pending_.front());
        pending_.pop_front();
        if (item.found == Found::move) {
          if (item.joins ? take_now(item.move, false) : take(item.move)) return Found::move;
          continue;
        }
        if (item.found == Found::event || item.found == Found::macro)
          event_ = std::move(item.event);
        if (item.found == Found::error) error_ = std::move(item.error);
        return item.found;
      }
      if (arc_.active()) {
        if (next_chord()) return Found::move;
        continue;
      }
      if (cycle_.active()) {
        if (next_of_cycle()) return Found::move;
        continue;
      }
      if (next_word_ > 0) {
        run_words();
        continue;
      }
      const char *p, *end;
      if (!lines().next(p, end)) {
        if (!frames_[source_].empty()) {
          feed_frame();
          continue;
        }
        return lines().finished() ? Found::end : Found::need_input;
      }
      machine_zero_ = false;
      if (lines().too_long()) {
        if (ended_line_ != 0 && !source_) continue;
        fail(Fault::line_too_long, "", 0, 0);
        continue;
      }
      if (end - p > 3 && (p[0] == 'G') && (p[1] == '1' || p[1] == '0') && p[2] == ' ' &&
          !listening() && ended_line_ == 0) {
        Found found = fast_move(p + 3, end, p[1] == '0');
        if (found == Found::move) return found;
        if (found == Found::end) continue;
      }
      run_line(p, end);
    }
  }

  // Machine position of each slot at home, as it was when the axis was homed last.
  const double* homed() const { return homed_; }

  // Homing: the axes named (all if none) are at home now, their offsets are gone.
  void home(const std::string& letters) {
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
      origin_[j] = j < 3 ? -tool_offset(j) : 0;
      owe(j, 0);
      double c[3];
      if (j == kZ || !machine_->geometry->linear(kZ, c)) hop_ = 0;  // all arms home together
    }
  }

 private:
  static constexpr double kPi = 3.141592653589793;
  static constexpr double kReported = 0.5e-3;                      // mm, rounding of M114
  static constexpr double kNowhere = 1e-9;                         // mm: no way but a rounding
  static constexpr double kLeastRetract = 0.1, kMostRetract = 10;  // mm, of M209
  static constexpr size_t kLongestName = 100;                      // bytes, of a command
  static constexpr double kThinnest = 0.1, kThickest = 10;         // mm, of filament
  struct Item {
    Found found;
    bool joins = false;  // see take_apart: its target is where the machine goes
    MoveRequest move;
    Event event;
    GcodeError error;
  };
  const Machine* machine_;
  std::vector<double> home_;
  double homed_[kAxes] = {}, home_step_[kAxes] = {};
  LaserWords laser_;
  double density_ = 0;  // W·s/mm
  Lines sources_[2];    // the program, the console
  bool source_ = false;
  MoveRequest move_{};
  Event event_;
  GcodeError error_;
  std::deque<Item> pending_;
  int8_t letter_slot_[26];
  uint32_t filament_letters_ = 1u << ('E' - 'A');  // a bit for each
  uint8_t filament_slots_ = 1u << kE;
  double low_[kAxes], high_[kAxes];

  double position_[kAxes] =
      {};  // machine position of the last target, mm; [kE]: of the active extruder
  double origin_[kAxes] = {};  // machine position of the program's zero
  double due_[kAxes] = {};     // see offset_due; 0 beyond Z
  bool any_due_ = false;
  struct {
    double from[3], mm[3];
    size_t tool;
    uint32_t line = 0;    // 0: none yet
  } owed_;                // the offset that the last move to carry one out has taken, and where
  double logical_e_ = 0;  // the program's E
  std::vector<double> extruder_;  // machine position of each extruder
  std::vector<Filament> filament_;
  static constexpr double kUsualMm = 1.75;
  std::vector<double> diameter_;  // of each extruder's filament, mm
  bool volumetric_ = false;       // E is mm³
  std::vector<Change> change_;    // of each extruder
  size_t tool_ = 0, active_ = 0;
  double unit_ = 1, feed_ = kInfinity;
  bool absolute_ = true, absolute_e_ = true;
  // Modal G0…G3; -1: none given yet; another one that is not known: ten times its code, and its
  // decimal.
  int motion_ = -1;
  bool machine_zero_ = false;  // G53: for the rest of the line
  int plane_ = 17;
  static constexpr int kSaved = 2;
  struct Saved {
    bool valid = false;
    double at[kAxes];
  };
  Saved saved_[kSaved];  // machine positions of G60
  struct Drawn {         // by G10, not yet given back
    bool back = false, swapped = false;
    double mm = 0;
  };
  std::vector<Drawn> drawn_;  // of each extruder
  std::shared_ptr<Objects> objects_ = std::make_shared<Objects>();
  ObjectLines object_lines_;
  int object_ = -1;         // that the program is in; -1: none
  double gap_[kAxes] = {};  // from the machine to where the program, that was skipped, has gone
  struct Strand {           // the filament of an extruder, or of an axis that pushes it
    double drawn = 0;       // mm by which it is drawn back
    double behind = 0;      // mm by which that is more than the program means
  };
  std::vector<Strand> strands_;  // of each extruder
  Strand axis_strands_[kAxes];
  bool apart_ = false;  // a gap, or a strand's difference, is not 0
  double skipped_feed_ = 0,
         skipped_strand_feed_ = 0;  // of the last travel, and the last retraction
  bool auto_retract_ = false;
  uint8_t locked_ = 0;  // a bit for each axis slot
  double hop_ = 0;      // mm by which Z is above what the program means
  Retraction retraction_;
  uint16_t feature_ = 0;
  std::vector<std::string> features_;
  uint64_t arcs_ = 0;
  Clamped clamped_[kAxes];
  uint8_t cut_ = 0;  // a bit for each slot that is at a limit instead of where the program means
  Arc arc_;
  MoveRequest arc_move_{};  // its chord
  double arc_hop_ = 0;      // hop_ where it begins
  std::string text_;        // of the line, comments removed
  std::vector<Word> words_;
  uint32_t listened_ = 0, moved_line_ = 0;
  uint32_t ended_line_ = 0;  // of the program: zero bytes or a Ctrl-Z end its text here; 0: no
  bool ended_by_zero_ = false;
  Heard heard_;
  uint64_t commands_ = 0;
  enum class FrameKind : uint8_t { subprogram, macro, rest };
  struct Frame {  // lines of a sub-program, of a macro, or the rest of a line that called one
    FrameKind kind = FrameKind::subprogram;
    Subprograms::Label label{};
    Lines lines;
    size_t fed = 0;   // of its text, up to here
    int repeats = 1;  // this one, and those that follow it
  };
  static constexpr size_t kDeepest = 10;               // sub-programs within each other
  static constexpr uint32_t kMostIdleCalls = 100'000;  // without a move
  std::vector<Frame> frames_[2];                       // of the program, of the console
  uint32_t idle_calls_ = 0;
  struct CycleWords {  // R, Q, P and the end of the hole, mm and s, as the last line of it has them
    int code = 0, plane = 0;
    double value[4];
    bool given[4];
  };
  CycleWords cycle_words_{};
  Cycle cycle_;
  double cycle_feed_ = 0;
  double cycle_level_ = 0;    // of the hole's axis before the first of cycles in a row
  bool cycle_begins_ = true;  // the next cycle is the first
  bool to_level_ = true;      // G98: back to there; G99: to R
  size_t next_word_ = 0;      // not 0: from here on the line waits until its moves so far are taken

  Lines& lines() {
    auto& frames = frames_[source_];
    return frames.empty() ? sources_[source_] : frames.back().lines;
  }
  const Lines& lines() const { return const_cast<Interpreter*>(this)->lines(); }
  // Of the line, as moves, events and errors have it: lines of a macro have that of its call.
  uint32_t number() const {
    const auto& frames = frames_[source_];
    for (size_t i = frames.size(); i-- > 0;)
      if (frames[i].kind == FrameKind::subprogram) return frames[i].lines.number();
    return sources_[source_].number();
  }
  bool in_macro() const {
    const auto& frames = frames_[source_];
    return !frames.empty() && frames.back().kind == FrameKind::macro;
  }
  void note_moved() { moved_line_ = in_macro() ? 0 : number(); }
  size_t frames_of(FrameKind kind) const {
    const auto& frames = frames_[source_];
    return size_t(std::count_if(frames.begin(), frames.end(),
                                [kind](const Frame& frame) { return frame.kind == kind; }));
  }
  // Moves of the line are to be taken before its next word.
  bool unfinished() const { return !pending_.empty() || arc_.active() || cycle_.active(); }
  // Of the program; 0 where a console has sent it.
  void stamp(MoveRequest& m) const {
    m.line = source_ ? 0 : number();
    m.main_line = source_ ? 0 : sources_[0].number();
    m.layer = uint16_t(std::min(layers.count(), 65535u));
    m.feature = feature_;
  }
  const std::string& axis_name(int j) const {
    return machine_->axes[size_t(j < 3 ? j : j - kExtra + 3)].name;
  }
  // Where the tool's nozzle is, from the first tool's: the machine stands so much the other way.
  double tool_offset(int j) const {
    return machine_->tools.empty() ? 0 : machine_->tools[tool_].offset[j];
  }

  bool names_axis(const Word& x) const {
    return x.letter >= 'A' && x.letter <= 'Z' && letter_slot_[x.letter - 'A'] >= 0;
  }
  // Whether words without a motion command are a move: they name an axis, F, I or J.
  bool moves(const Word* w, const Word* end) const {
    return std::any_of(w, end, [this](const Word& x) {
      return x.letter == 'F' || x.letter == 'I' || x.letter == 'J' || names_axis(x);
    });
  }
  bool listening() const { return number() == listened_ && !source_ && !in_macro(); }
  // A command begins, with these words of its line, or with a text that is none.
  void hear(std::string_view code, const Word* first, const Word* last, std::string_view text = "");
  void fail(Fault fault, const std::string& word, double value, double limit) {
    Item item{};
    item.found = Found::error;
    item.error = {number(), fault, readable(word), value, limit, {0, 0, 0}};
    pending_.push_back(std::move(item));
  }
  // Whether a word's value is within the least and the most; else the line fails.
  bool within(char letter, double value, double least, double most);
  void emit(char letter, int number, int minor, std::string_view name, std::string_view text);
  bool is_macro(const std::string& code) const { return !plain && machine_->macros.has(code); }
  // The caller is to say what these words become.
  void emit_macro(char letter, int number, int minor, std::string_view name, std::string_view text);
  // Commands by which macros reach built-in ones become these.
  void find_built_in();
  void note_clamp(int j, double value, double limit) {
    if (clamped_[j].times++ == 0)
      clamped_[j].first = {number(), Fault::out_of_range, axis_name(j), value, limit, {}};
  }
  // A word of the line is none; a character that is not G-code is the reason, if there is one.
  void fail_word(Fault fault, const std::string& word, std::string_view text) {
    const Stray stray = find_stray(text, true);
    if (stray.code == 0) return fail(fault, word, 0, 0);
    fail(Fault::stray, stray.token, double(stray.code), 0);
  }
  bool sound(const Word& word) {
    if (word.number && std::fabs(word.value) <= kLargestWord) return true;
    if (!word.number) {
      fail_word(Fault::number, std::string(1, word.letter), text_);
      return false;
    }
    fail(Fault::number, std::string(1, word.letter), word.value, kLargestWord);
    return false;
  }

  // Whether a word's letter is among those `seen` in its command, which fails then.
  bool repeated(const Word& word, uint32_t& seen) {
    if (word.letter < 'A' || word.letter > 'Z') return false;
    const uint32_t bit = 1u << (word.letter - 'A');
    if ((seen & bit) != 0) fail(Fault::repeated, std::string(1, word.letter), 0, 0);
    return (std::exchange(seen, seen | bit) & bit) != 0;
  }

  // mm of filament that the program's E counts already, of moves that have not been taken.
  double meant_mm() const;
  // The program's E counts so much filament no more.
  void take_back(double mm) { logical_e_ -= mm / e_scale(); }

  // Where the program means slot j to be, in machine coordinates.
  double meant(int j) const { return position_[j] + gap(j) - (j == kZ ? hop_ : 0) + due_[j]; }
  // How far the program is from the machine, by moves that were skipped; nothing for a console.
  double gap(int j) const { return source_ ? 0 : gap_[j]; }
  // Where the program has left the machine, by moves that were skipped, too.
  void here(double* at) const {
    for (int j = 0; j < kAxes; ++j) at[j] = position_[j] + gap(j);
  }
  bool skips() const { return object_ >= 0 && !source_ && objects_->cancelled(object_); }
  void owe(int j, double mm) {
    due_[j] = std::fabs(mm) > kNowhere ? mm : 0;
    any_due_ = due_[kX] != 0 || due_[kY] != 0 || due_[kZ] != 0;
  }
  void owe(const double* mm) {
    for (int j = 0; j < 3; ++j) owe(j, mm[j]);
  }
  bool is_filament(int j) const { return filament_slots_ >> j & 1; }
  // Letters whose words count from where they are.
  uint32_t relative() const {
    return (absolute_ || machine_zero_ ? 0 : ~0u) |
           (absolute_ && absolute_e_ ? 0 : filament_letters_);
  }

  // The common line: upper case axis letters, E and F, each with a number. Found::end: done, no
  // move; Found::error: the line needs the general way.
  Found fast_move(const char* p, const char* end, bool rapid) {
    if (any_due_) return Found::error;
    double value[26];
    uint32_t have = 0;
    for (;;) {
      while (p < end && (*p == ' ' || *p == '\t')) ++p;
      if (p == end || *p == ';') break;
      unsigned k = unsigned(*p - 'A');
      if (k >= 26 || (letter_slot_[k] < 0 && k != 5)) return Found::error;
      ++p;
      if (!read_number(p, end, value[k]) || looks_like_exponent(p, end)) return Found::error;
      if (std::fabs(value[k]) > kLargestWord || (have >> k & 1)) return Found::error;
      have |= 1u << k;
    }
    if (have >> 5 & 1) {
      if (!(value[5] > 0)) return Found::error;
      feed_ = value[5] * unit_ / 60;
    }
    motion_ = rapid ? 0 : 1;
    ++commands_;
    note_moved();
    return straight(value, have & ~(1u << 5), feed_, 0, rapid) ? Found::move : Found::end;
  }

  // Resolves the target of the letters in `have`; false if nothing moves. `move_` is the result.
  bool straight(const double* value, uint32_t have, double feed, double duration, bool rapid) {
    if (!target(value, have, relative(), 0) || retracts(have)) return false;
    move_.feed_mm_s = feed;
    move_.duration_s = duration;
    move_.radius_mm = kInfinity;
    move_.arc_inner = false;
    move_.rapid = rapid;
    move_.energy_ws = 0;
    return ready();
  }

  // M209: a move of filament alone is what a slicer knows of retraction. The program believes in
  // its E; what moves is what M207 and M208 say.
  bool retracts(uint32_t have) {
    double mm = move_.target[kE] - position_[kE];
    if (!auto_retract_ || have != 1u << ('E' - 'A')) return false;
    if (std::fabs(mm) < kLeastRetract || std::fabs(mm) > kMostRetract) return false;
    if (drawn_[active_].back == (mm < 0)) return false;  // neither a retraction nor its end
    run_retract(mm < 0);
    return true;
  }

  // Whether slot j is at home there, as exactly as motors stop and reports say it.
  bool at_home(int j, double at) const {
    return std::fabs(at - homed_[j]) <= home_step_[j] + kReported;
  }
  // How far a step of each motor moves an axis at home.
  void measure_steps() {
    const Geometry& geometry = *machine_->geometry;
    double step[3] = {}, q[3], p[3];
    for (const StepperSpec& s : machine_->steppers) {
      if (s.drive == Drive::extruder) continue;
      double& mm = s.drive == Drive::axis ? home_step_[slot_of_axis(s.index)] : step[s.index];
      mm = std::max(mm, 1 / s.steps_per_unit);
    }
    for (int i = 0; i < geometry.actuators(); ++i) {
      for (int k = 0; k < 3; ++k) q[k] = geometry.inverse(k, homed_) + (k == i ? step[k] : 0);
      if (!geometry.forward(q, p)) continue;
      for (int j = 0; j < 3; ++j)
        if (const double mm = std::fabs(p[j] - homed_[j]); mm < kInfinity) home_step_[j] += mm;
    }
  }

  // Whether a move may not bring axis slot j there. From a switch that lies beyond the limits there
  // is a way back, and to there, but not to places between it and the limit.
  bool beyond(int j, double at) const { return beyond(j, at, position_[j]); }
  bool beyond(int j, double at, double from) const {
    return (at < std::min(low_[j], from) - 1e-6 || at > std::max(high_[j], from) + 1e-6) &&
           !at_home(j, at);
  }

  // Letters of axes that a move which names `have` moves too: by the offset of a tool that no move
  // has carried out yet. Not a move of filament alone, nor one in the machine's own coordinates; an
  // axis that is not homed has no offset to keep.
  uint32_t offset_letters(uint32_t have, bool arc = false) const {
    if (!any_due_ || machine_zero_ || (!arc && (have & ~filament_letters_) == 0)) return 0;
    uint32_t letters = 0;
    for (int j = 0; j < 3; ++j)
      if (due_[j] != 0 && !locked(j)) letters |= 1u << (machine_->axes[size_t(j)].letter - 'A');
    return letters & ~have;
  }

  // `relative`: a bit for each letter that counts from where it is. `offset`: letters that stay
  // where the program means them to be, see offset_letters.
  bool target(const double* value, uint32_t have, uint32_t relative, uint32_t offset) {
    here(move_.target);
    uint8_t moved = 0;
    const double e_before = logical_e_;
    double hop = hop_;
    uint8_t cut = cut_;
    for (uint32_t left = have | offset; left; left &= left - 1) {
      int k = __builtin_ctz(left), j = letter_slot_[k];
      moved |= uint8_t(1u << j);
      const bool stays = offset >> k & 1;
      double v = stays ? 0 : value[k] * unit_;
      bool absolute = !stays && (relative >> k & 1) == 0;
      if (j == kE) {
        double delta = absolute ? v - logical_e_ : v;
        logical_e_ = absolute ? v : logical_e_ + v;
        if (std::fabs(delta) > kNowhere)
          move_.target[kE] = position_[kE] + filament_[active_].length(delta, e_scale());
        continue;
      }
      double t = !absolute ? meant(j) + v : machine_zero_ ? v : v + origin_[j];
      if (beyond(j, t)) {
        double limit = t < low_[j] ? low_[j] : high_[j];
        if (!clamp && !locked(j)) {
          logical_e_ = e_before;
          fail(Fault::out_of_range, axis_name(j), t, limit);
          return false;
        }
        if (clamp) note_clamp(j, t, limit);  // else the axis is not homed, as is said below
        t = limit;
        cut |= uint8_t(1u << j);
      } else if (absolute) {
        cut &= uint8_t(~(1u << j));
      }
      if (j == kZ) {  // of the hop as much as there is room for
        hop = std::clamp(high_[j] - t, 0.0, hop_);
        t += hop;
      }
      if (std::fabs(t - move_.target[j]) > kNowhere) move_.target[j] = t;
    }
    if (moved & locked_) {
      logical_e_ = e_before;
      fail(Fault::not_homed, axis_name(__builtin_ctz(unsigned(moved & locked_))), 0, 0);
      return false;
    }
    for (uint32_t left = skips() ? 0 : cold & moved; left; left &= left - 1) {
      int j = __builtin_ctz(left);
      if (move_.target[j] == position_[j]) continue;
      logical_e_ = e_before;
      fail(Fault::cold, j == kE ? "E" : axis_name(j), 0, 0);
      return false;
    }
    hop_ = move_.hop_mm = hop;
    cut_ = cut;
    if (any_due_) carry_out(moved);
    move_.moved = moved;
    move_.flow = extruder_.empty() ? 0 : filament_[active_].flow;
    return true;
  }

  // Fills what does not depend on the command and takes the move; false if it goes nowhere.
  bool ready() {
    stamp(move_);
    return take(move_);
  }
  bool take(MoveRequest& m) {
    if ((apart_ || object_ >= 0) && (apart_ || skips()) && !source_) return take_apart(m);
    return take_now(m, true);
  }
  // `follows`: how far filament is drawn back follows the move; a move that joins has done so.
  bool take_now(MoveRequest& m, bool follows) {
    if (m.kind == MoveKind::dwell && m.duration_s > 0) {
      std::copy(position_, position_ + kAxes, m.target);
      m.hop_mm = hop_;
      m.extruder = uint16_t(active_);
      m.tool = uint16_t(tool_);
      m.beam = m.energy_ws / (m.duration_s * laser_.full_w);
      move_ = m;
      move_.kind = MoveKind::dwell;
      return true;
    }
    bool travels = false, forward = false, back = false;
    for (int j = 0; j < kAxes; ++j) {
      double mm = m.target[j] - position_[j];
      if (!is_filament(j)) {
        travels |= mm != 0;
      } else if (mm != 0) {
        forward |= mm > 0, back |= mm < 0;
        if (follows) strand_of(j).drawn = owed_after(strand_of(j).drawn, mm);
      }
    }
    if (!travels && !forward && !back) return false;
    m.kind = !travels ? MoveKind::extrude : forward ? MoveKind::print : MoveKind::travel;
    if (m.kind == MoveKind::print &&
        (m.target[kX] != position_[kX] || m.target[kY] != position_[kY])) {
      const double program_z = tool_offset(kZ) - m.hop_mm;  // from the machine's
      layers.extrude(position_[kZ] + program_z, m.target[kZ] + program_z);
    }
    m.layer = uint16_t(std::min(layers.count(), 65535u));
    m.feature = feature_;
    m.extruder = uint16_t(active_);
    m.tool = uint16_t(tool_);
    idle_calls_ = 0;
    if (laser_.any()) shine(m);
    if (!extruder_.empty()) {
      m.owed_mm = filament_[active_].owed;
      if (m.flow > 0) filament_[active_].moved(m.target[kE] - position_[kE], e_scale());
    }
    std::copy(m.target, m.target + kAxes, position_);
    if (!extruder_.empty()) extruder_[active_] = position_[kE];
    if (&m != &move_) move_ = m;
    move_.kind = m.kind;
    return true;
  }

  void shine(MoveRequest& m) const;
  void comment(std::string_view text);
  void pass_on(std::string_view name, std::string_view text);
  bool ends_text(const char* p, const char*& end);
  void run_line(const char* p, const char* end);
  void run_words();
  void run_command(const Word& command, const Word* first, const Word* last, std::string_view text);
  void run_modal(const Word* first, const Word* last);
  void run_motion(int code, const Word* first, const Word* last);
  void run_arc(bool clockwise, const double* value, uint32_t have, int turns);
  void run_saved(bool save, const Word* first, const Word* last);
  void queue_straight(double feed, double duration, bool rapid, double energy_ws = 0);
  bool run_filament(int code, const Word* first, const Word* last);
  void queue_step(int j, double by, double feed);
  void carry_out(uint8_t moved);
  int place_of_tool(double* at) const;
  bool lays_filament() const;
  void queue_offset(const double* to, double feed);
  void run_retract(bool in, bool swap = false);
  void queue_return(const double* to);
  void select_tool(const Word& word);
  bool arc_in_range(const double* start, int u, int v, GcodeError& error) const;
  bool next_chord();
  void emit_power(double power);
  void run_cycle(int code, const Word* first, const Word* last);
  bool next_of_cycle();
  void run_call(std::string_view text);
  bool run_return(std::string_view text);
  void begin_frame();
  void feed_frame();
  void fail_call(CallFault fault, const std::string& call);
  Strand& strand_of(int j) { return j == kE ? strands_[active_] : axis_strands_[j]; }
  void run_objects(std::string_view code, std::string_view text);
  void obey(const ObjectOrder& order);
  void forget_objects();
  bool take_apart(MoveRequest& m);
  void skip(const MoveRequest& m);
  bool join(const MoveRequest& m);
  void pass_filament(int j, double mm);
  void look_apart();
};

}  // namespace passo

#include "gcode/interpreter_calls.hpp"
#include "gcode/interpreter_cycles.hpp"
#include "gcode/interpreter_filament.hpp"
#include "gcode/interpreter_objects.hpp"
#include "gcode/interpreter_run.hpp"
#include "gcode/interpreter_steps.hpp"
