// The motion state of a G-code program: lines in, moves and events out, in order.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/types.hpp"
#include "gcode/arc.hpp"
#include "gcode/cycle.hpp"
#include "gcode/layers.hpp"
#include "gcode/lexer.hpp"
#include "gcode/objects.hpp"
#include "gcode/parse_result.hpp"
#include "gcode/subprograms.hpp"
#include "gcode/words.hpp"
#include "machine/machine.hpp"
#include "plan/extrusion_flow.hpp"

namespace passo {

// Reads a program and, between its lines, the lines of a console: one modal state serves both.
// Coordinates are machine mm of an axis slot (base/types.hpp) unless the text says otherwise.
class Interpreter {
 public:
  bool clamp = false;         // targets out of range go to the limit
  bool ignore_tools = false;  // selecting a missing tool is an event, not an error
  uint8_t cold = 0;           // a bit for each slot whose filament is too cold to move
  std::shared_ptr<const Subprograms> subprograms;  // of the program; null: M98 is an error
  bool ignore_calls = false;                       // calls of missing sub-programs are events
  bool calls_are_events = false;                   // M98 and M99 are not carried out
  bool plain = false;                              // macros are not called: all is built in
  LayerCounter layers;                             // of the program
  // Before a move prints at another height than these, mm, there is an event TUNING_TOWER with the
  // height as its word Z; then they become infinite.
  double height_low = -kInfinity, height_high = kInfinity;

  Interpreter(const Machine& machine, std::vector<double> home, const LaserWords& laser);

  // ---- Reading ----

  // Program and console have their own unread text. The source may change only at a boundary
  // between lines. A macro that a console calls is part of its line; between the lines of a
  // program's macro other lines may come.
  void select(bool console) { source_ = console; }
  bool at_boundary() const {
    return !unfinished() && next_word_ == 0 && !(source_ && !frames_[1].empty());
  }
  void feed(const char* data, size_t n) { sources_[source_].feed(data, n); }
  void finish() { sources_[source_].finish(); }
  // Drops the unread text of the selected source; its next line has the number `first`. With 1, a
  // new program begins: layers count from 0, and there are no objects.
  void restart(uint32_t first = 1);
  // Continues to read until there is a move, an event, an error, or no more text.
  Found next();
  const MoveRequest& move() const { return move_; }
  const Event& event() const { return event_; }
  const GcodeError& error() const { return error_; }
  // Bytes of the selected source in the lines that are read.
  uint64_t offset() const { return sources_[source_].offset(); }
  // The last line read of the selected source; never one of a sub-program.
  uint32_t line() const { return sources_[source_].number(); }
  // All text is read, and the last line is a move without an end of line.
  bool ends_in_move() const { return lines().unended() && moved_line_ == number(); }
  // After Found::macro: the lines that the call of macro `code` becomes. They come before the rest
  // of its line. While they run, the name of a macro that replaces a command is the command.
  void insert(std::string_view text, std::string_view code = {});
  // How many macros of the selected source run within each other.
  size_t macro_depth() const { return frames_of(FrameKind::macro); }
  // The same of sub-programs.
  size_t subprogram_depth() const { return frames_of(FrameKind::subprogram); }
  // Moves the unread rest of the program's macro to `mine`, as a macro of a console.
  void hand_over_macro(Interpreter& mine);
  // Drops the rest of a console's macros.
  void forget_macros() { frames_[1].clear(); }
  // Records how the program's line of this number is interpreted, see watched_line().
  void watch_line(uint32_t line) { watched_ = line; }
  const WatchedLine& watched_line() const { return watched_line_; }
  // Commands read so far, unknown ones too.
  uint64_t commands() const { return commands_; }
  uint64_t arcs() const { return arcs_; }
  // Names of the kinds of line that the slicer's comments give, by MoveRequest::feature.
  const std::vector<std::string>& features() const { return features_; }
  // Targets of one slot that went to the limit instead, and the first one's error.
  struct Clamped {
    uint64_t times = 0;
    GcodeError first;
  };
  const Clamped& clamped(int j) const { return clamped_[j]; }

  // ---- Suspending and replacing the program ----

  // After a stop: drops the rest of the line. The machine is at `position` and its extruders at
  // `extruders`; the program's positions follow.
  void abandon(const double* position, const std::vector<double>& extruders);
  // Continues the program that `before` was reading. The console's unread text, and settings that
  // it has changed meanwhile, stay; modes go back.
  void resume(const Interpreter& before);
  // Takes over the program's state from another interpreter of the same machine. Unread text and
  // the homed positions of this one stay.
  void adopt(const Interpreter& other);
  // The laser is off in later moves until the program sets its energy again.
  void dark() { density_ = 0; }
  // G-code, one command a line and in mm, that sets a program's modal state to this one's.
  std::string modes() const;
  // G90, M82, and the feedrate in mm/s (infinite: none yet).
  struct Modal {
    bool absolute, absolute_e;
    double feed_mm_s;
  };
  Modal modal() const { return {absolute_, absolute_e_, feed_}; }

  // ---- Positions ----

  // Machine position of the last target; [kE]: of the extruder in use.
  const double* position() const { return position_; }
  // The same in the program's own coordinates; E as the program counts it.
  double logical(int j) const { return j == kE ? logical_e_ : meant(j) - gap(j) - origin_[j]; }
  // Axis slot j is at `position` now, and that is its home if `homed`; the program's zero stays.
  void set_axis(int j, double position, bool homed);
  // The plan of this axis now ends at `position`; its offsets stay. Only while no line is half
  // read.
  void set_place(int j, double position) { position_[j] = position; }
  // The machine is at this position; the next move also covers the distance to the program's
  // position.
  void put(int j, double position) {
    owe(j, due_[j] + position_[j] - position);
    position_[j] = position;
  }
  // The axes in `letters` (empty: all) are at home now, and their offsets end.
  void home(const std::string& letters);
  // Machine position of each slot at home, as it was when the axis was homed last.
  const double* homed() const { return homed_; }
  // Moves of a locked axis fail until it is homed or G92 sets it: its position is unknown.
  void lock(int j, bool locked) {
    locked_ = uint8_t(locked ? locked_ | 1u << j : locked_ & ~(1u << j));
  }
  bool locked(int j) const { return locked_ >> j & 1; }
  // Whether axis slot j may be at `at`; if not, fills `error`.
  bool in_range(int j, double at, GcodeError& error) const;
  // Moves the program's zero by `mm` along slot j (X, Y or Z).
  void shift_zero(int j, double mm) { origin_[j] += mm; }
  // Moves the program by `mm` along slot j: its zero, and the moves that are read but not taken.
  void shift(int j, double mm);
  // A shift of `mm` is part of the axis' own zero from now on: what the program means by each of
  // its coordinates is lower by `mm` along slot j. `position` stays.
  void absorb_shift(int j, double mm);
  // Whenever the axis of slot j (X, Y or Z) homes, the program's zero is `mm` further from that of
  // the axis.
  void keep_offset(int j, double mm) { offset_[j] += mm; }
  // There is no room for a hop of `mm`: removes it from the last move taken and from the rest of
  // its line.
  void drop_hop(double mm);

  // ---- Tools and filament ----

  size_t tool() const { return tool_; }
  size_t extruder() const { return active_; }
  // Selects a tool that has an extruder. No axis moves: the next move of an axis carries out the
  // difference of the offsets on all axes. Does nothing where extruders are axes.
  void take_tool(size_t tool);
  // The offset of the tool in use becomes `mm` along slot j; the next move of the axis carries it
  // out.
  void shift_tool(int j, double mm);
  // mm by which the next move of an axis moves slot j (X, Y or Z) for a new tool or offset.
  double offset_due(int j) const { return due_[j]; }
  // The tool is where the machine is: no offset is due.
  void forget_offset() {
    constexpr double kNone[3] = {};
    owe(kNone);
  }
  // `mm` of a move of this extruder did not take place; the program's E counts it all the same.
  void leave_filament(size_t extruder, double mm);
  // mm of filament for a mm (M200: mm³) of the program's E.
  double e_scale() const {
    if (extruder_.empty()) return 1;
    const double flow = filament_[active_].flow;
    if (!volumetric_) return flow;
    const double r = 0.5 * diameter_[active_];
    return flow / (kPi * r * r);
  }
  // M221, a factor.
  double flow(size_t extruder) const { return filament_[extruder].flow; }
  void set_flow(size_t extruder, double flow) { filament_[extruder].flow = flow; }
  // Continues `change`, which has changed the planned moves, in the moves that are read but not
  // taken.
  void change_flow(size_t extruder, FlowChange& change);
  // G11 will not return the filament that G10 has retracted before.
  void forget_retraction();
  // M207 and M208.
  const Retraction& retraction() const { return retraction_; }
  bool auto_retract() const { return auto_retract_; }                 // M209
  bool volumetric() const { return volumetric_; }                     // M200
  const std::vector<double>& diameters() const { return diameter_; }  // M200, of each extruder
  static constexpr double kLoadMmS = 6, kUnloadMmS = 20;              // speeds of M701 and M702
  static constexpr double kMaxChangeMm = 5000;                        // in M207, M208, M603, M701
  struct Change {
    double load_mm, unload_mm;  // M603, of filament
  };
  const std::vector<Change>& changes() const { return change_; }

  // ---- Objects of the print (M486) ----

  // Moves of cancelled objects are not handed out. After them the machine travels to where the next
  // move begins.
  Objects& objects() { return *objects_; }
  const Objects& objects() const { return *objects_; }
  // The object of a recent line of the main program; -1: none.
  int object_of_line(uint32_t line) const { return object_lines_.at(line); }

  // ---- Arcs ----

  // The arc that the next moves are chords of.
  const Arc& arc() const { return arc_; }
  void note_arc_reached() { arc_.note_reached(); }
  // The target of the next chord of `rest`, a copy of arc().
  void take_chord(Arc& rest, double* target) const;

 private:
  static constexpr double kPi = 3.141592653589793;
  static constexpr double kReported = 0.5e-3;         // mm, rounding of M114
  static constexpr double kRounding = 1e-9;           // mm: smaller differences do not count
  static constexpr size_t kMaxNameBytes = 100;        // length of a command's name
  static constexpr double kUsualMm = 1.75;            // usual diameter of filament
  static constexpr int kSaved = 2;                    // number of positions of G60
  static constexpr int kMostSpecial = 2;              // of G1 H
  static constexpr size_t kMaxDepth = 10;             // sub-programs within each other
  static constexpr uint32_t kMaxIdleCalls = 100'000;  // of sub-programs, without a move

  struct Item {  // found in the line, not handed out yet
    Found found;
    bool joins = false;  // see join(): its target is a machine position
    MoveRequest move;
    Event event;
    GcodeError error;
  };
  struct Saved {
    bool valid = false;
    double at[kAxes];
  };
  struct Drawn {  // by G10, not returned yet
    bool back = false, swapped = false;
    double mm = 0;
  };
  struct Strand {       // the filament of an extruder, or of an axis that pushes it
    double drawn = 0;   // mm by which it is retracted
    double excess = 0;  // mm by which that is more than the program has commanded
  };
  enum class FrameKind : uint8_t { subprogram, macro, rest };
  struct Frame {  // lines of a sub-program, of a macro, or the rest of a line that called one
    FrameKind kind = FrameKind::subprogram;
    std::string code = {};  // of a macro
    Subprograms::Label label{};
    Lines lines;
    size_t fed = 0;   // bytes of the sub-programs' text, up to here
    int repeats = 1;  // this one, and those that follow it
  };
  struct CycleWords {  // R, Q, P and the end of the hole, mm and s, as its last line has them
    int code = 0, plane = 0;
    double value[4];
    bool given[4];
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

  double position_[kAxes] = {};  // see position()
  double origin_[kAxes] = {};    // machine position of the program's zero
  double offset_[3] = {};        // the same after homing, without a tool's offset
  double due_[kAxes] = {};       // see offset_due(); 0 beyond Z
  bool any_due_ = false;
  struct {
    double from[3], mm[3];
    size_t tool;
    uint32_t line = 0;            // 0: none yet
  } owed_;                        // the offset that a move has carried out last, and where
  double logical_e_ = 0;          // the program's E
  std::vector<double> extruder_;  // machine position of each extruder
  std::vector<Filament> filament_;
  std::vector<double> diameter_;  // of each extruder's filament, mm
  bool volumetric_ = false;       // E is mm³
  std::vector<Change> change_;    // of each extruder
  size_t tool_ = 0, active_ = 0;
  double unit_ = 1, feed_ = kInfinity;
  bool absolute_ = true, absolute_e_ = true;
  // Modal G0…G3; -1: none yet; any other: ten times its code, and its decimal.
  int motion_ = -1;
  bool machine_zero_ = false;  // G53: for the rest of the line
  int plane_ = 17;
  Saved saved_[kSaved];       // G60
  std::vector<Drawn> drawn_;  // of each extruder
  std::shared_ptr<Objects> objects_ = std::make_shared<Objects>();
  ObjectLines object_lines_;
  int object_ = -1;              // that the program is in; -1: none
  double gap_[kAxes] = {};       // from the machine to the program, whose moves were skipped
  std::vector<Strand> strands_;  // of each extruder
  Strand axis_strands_[kAxes];
  bool apart_ = false;                                 // a gap, or a strand's excess, is not 0
  double skipped_feed_ = 0, skipped_strand_feed_ = 0;  // of the last travel and retraction
  bool auto_retract_ = false;
  uint8_t locked_ = 0;  // a bit for each axis slot
  double hop_ = 0;      // mm by which Z is above the program's Z
  Retraction retraction_;
  uint16_t feature_ = 0;
  std::vector<std::string> features_;
  uint64_t arcs_ = 0;
  Clamped clamped_[kAxes];
  uint32_t idle_noted_ = 0;  // letters of the program that idles() has reported
  uint8_t cut_ = 0;  // a bit for each slot that is at a limit instead of the commanded position
  Arc arc_;
  MoveRequest arc_move_{};  // its chord
  double arc_hop_ = 0;      // hop_ where it begins
  std::string text_;        // of the line, comments removed
  std::vector<Word> words_;
  uint32_t watched_ = 0, moved_line_ = 0;
  uint32_t ended_line_ = 0;  // of the program: zero bytes or a Ctrl-Z end its text here; 0: they do
                             // not
  bool ended_by_zero_ = false;
  WatchedLine watched_line_;
  uint64_t commands_ = 0;
  std::vector<Frame> frames_[2];  // of the program, of the console
  uint32_t idle_calls_ = 0;
  CycleWords cycle_words_{};
  Cycle cycle_;
  double cycle_feed_ = 0;
  double cycle_level_ = 0;    // of the hole's axis before the first of cycles in a row
  bool cycle_begins_ = true;  // the next cycle is the first
  bool to_level_ = true;      // G98: back to cycle_level_; G99: to R
  size_t next_word_ = 0;      // not 0: the line continues here once its moves are taken

  Lines& lines() {
    auto& frames = frames_[source_];
    return frames.empty() ? sources_[source_] : frames.back().lines;
  }
  const Lines& lines() const { return const_cast<Interpreter*>(this)->lines(); }
  // Of the line, for moves, events and errors: lines of a macro have the number of its call.
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
  // Moves of the line must be taken before its next word.
  bool unfinished() const { return !pending_.empty() || arc_.active() || cycle_.active(); }
  bool watching() const { return number() == watched_ && !source_ && !in_macro(); }
  const std::string& axis_name(int j) const {
    return machine_->axes[size_t(j < 3 ? j : j - kExtra + 3)].name;
  }
  bool names_axis(const Word& x) const {
    return x.letter >= 'A' && x.letter <= 'Z' && letter_slot_[x.letter - 'A'] >= 0;
  }
  bool is_filament(int j) const { return filament_slots_ >> j & 1; }
  bool skips() const { return object_ >= 0 && !source_ && objects_->cancelled(object_); }
  // Whether targets may be out of range: moves of a cancelled object do not take place.
  bool anywhere() const { return skips() && !clamp; }
  Strand& strand_of(int j) { return j == kE ? strands_[active_] : axis_strands_[j]; }

  // The position that the program has commanded for slot j, in machine coordinates.
  double meant(int j) const { return position_[j] + gap(j) - (j == kZ ? hop_ : 0) + due_[j]; }
  // The distance from the machine to the program's position, after skipped moves; 0 for a console.
  double gap(int j) const { return source_ ? 0 : gap_[j]; }
  // The position that the program has commanded, skipped moves included.
  void here(double* at) const {
    for (int j = 0; j < kAxes; ++j) at[j] = position_[j] + gap(j);
  }
  // The position of the tool's nozzle relative to the first tool's; the machine moves by it the
  // other way.
  double tool_offset(int j) const {
    return machine_->tools.empty() ? 0 : machine_->tools[tool_].offset[j];
  }
  void owe(int j, double mm) {
    due_[j] = std::fabs(mm) > kRounding ? mm : 0;
    any_due_ = due_[kX] != 0 || due_[kY] != 0 || due_[kZ] != 0;
  }
  void owe(const double* mm) {
    for (int j = 0; j < 3; ++j) owe(j, mm[j]);
  }
  // Whether a move may not bring axis slot j to `at`. If the endstop is beyond the limits, a move
  // may go back from it, or to it, but not to positions between it and the limit.
  bool beyond(int j, double at) const { return beyond(j, at, position_[j]); }
  bool beyond(int j, double at, double from) const {
    return (at < std::min(low_[j], from) - 1e-6 || at > std::max(high_[j], from) + 1e-6) &&
           !at_home(j, at);
  }
  // Whether slot j is at home there, within a motor step and the rounding of reports.
  bool at_home(int j, double at) const {
    return std::fabs(at - homed_[j]) <= home_step_[j] + kReported;
  }
  // Letters whose words are relative.
  uint32_t relative() const {
    return (absolute_ || machine_zero_ ? 0 : ~0u) |
           (absolute_ && absolute_e_ ? 0 : filament_letters_);
  }

  // interpreter.cpp: the common line, and the steps that are common to all moves.
  Found fast_move(const char* p, const char* end, bool rapid);
  bool straight(const double* value, uint32_t have, double feed, double duration, bool rapid);
  bool target(const double* value, uint32_t have, uint32_t relative, uint32_t offset);
  bool take(MoveRequest& m);
  bool take_now(MoveRequest& m, bool follows);
  // Whether an event about its height comes before the move, which waits after it.
  bool waits_for_height(const MoveRequest& m, bool follows);
  void stamp(MoveRequest& m) const;
  void shine(MoveRequest& m) const;

  // interpreter_lines.cpp: lines in every dialect, and their events.
  void run_line(const char* p, const char* end);
  void run_words();
  bool ends_text(const char* p, const char*& end);
  void comment(std::string_view text);
  void pass_on(std::string_view name, std::string_view text);
  void hear(std::string_view code, const Word* first, const Word* last, std::string_view text = "");
  void emit(char letter, int number, int minor, std::string_view name, std::string_view text);
  bool is_macro(const std::string& code) const {
    return !plain && machine_->macros.has(code) &&
           !(machine_->macros.replaces(code) && runs_within(code));
  }
  bool runs_within(const std::string& code) const {
    const auto& frames = frames_[source_];
    return std::any_of(frames.begin(), frames.end(), [&](const Frame& frame) {
      return frame.kind == FrameKind::macro && frame.code == code;
    });
  }
  void emit_macro(char letter, int number, int minor, std::string_view name, std::string_view text);
  void find_built_in();
  void fail(Fault fault, const std::string& word, double value, double limit);
  void fail_word(Fault fault, const std::string& word, std::string_view text);
  bool within(char letter, double value, double least, double most);
  bool sound(const Word& word);
  bool repeated(const Word& word, uint32_t& seen);
  void fail_letter(const Word& word, int code);
  void note_clamp(int j, double value, double limit);
  bool moves(const Word* w, const Word* end) const;

  // interpreter_commands.cpp: commands that belong to the motion state.
  void run_command(const Word& command, const Word* first, const Word* last, std::string_view text);
  bool run_g(int code, const Arguments& a);
  bool run_m(int code, const Arguments& a);
  void run_dwell(const Arguments& a);
  void run_home(const Arguments& a);
  void run_set_position(const Arguments& a);
  bool run_diameter(const Arguments& a);
  void set_retraction(const Arguments& a);
  void set_recovery(const Arguments& a);
  void run_modal(const Word* first, const Word* last);

  // interpreter_motion.cpp: G0 to G3 with their words, and saved positions.
  void run_motion(int code, const Word* first, const Word* last);
  void emit_special(int kind, const double* value, uint32_t have, uint32_t relative,
                    std::string words);
  bool idles(const Word& word, int code);
  void queue_straight(double feed, double duration, bool rapid, double energy_ws = 0);
  void queue_step(int j, double by, double feed);
  void queue_return(const double* to);
  void run_saved(bool save, const Word* first, const Word* last);
  void emit_power(double power);

  // interpreter_arcs.cpp
  void run_arc(bool clockwise, const double* value, uint32_t have, int turns);
  bool arc_in_range(const double* start, int u, int v, GcodeError& error) const;
  bool next_chord();

  // interpreter_cycles.cpp: G73, G81, G82, G83.
  void run_cycle(int code, const Word* first, const Word* last);
  bool next_of_cycle();

  // interpreter_tools.cpp: changes of tool, and offsets that are due.
  void select_tool(const Word& word);
  uint32_t offset_letters(uint32_t have, bool arc = false) const;
  void carry_out(uint8_t moved);
  int tool_position(double* at) const;
  bool lays_filament() const;
  void queue_offset(const double* to, double feed);

  // interpreter_filament.cpp: retraction, filament changes, flow.
  bool run_filament(int code, const Arguments& a);
  void run_retract(bool in, bool swap = false);
  bool retracts(uint32_t have);
  double meant_mm() const;
  void take_back(double mm) { logical_e_ -= mm / e_scale(); }

  // interpreter_calls.cpp: M98 and M99, and the lines of macros.
  void run_call(std::string_view text);
  bool run_return(std::string_view text);
  void begin_frame();
  void feed_frame();
  void fail_call(CallFault fault, const std::string& call);

  // interpreter_objects.cpp: M486, and moves of cancelled objects.
  void run_objects(std::string_view code, std::string_view text);
  void obey(const ObjectOrder& order);
  void forget_objects();
  bool take_apart(MoveRequest& m);
  void skip(const MoveRequest& m);
  bool join(const MoveRequest& m);
  void pass_filament(int j, double mm);
  void look_apart();

  // interpreter_state.cpp
  void measure_steps();
};

}  // namespace passo
