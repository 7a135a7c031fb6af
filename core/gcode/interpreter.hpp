// Interprets G-code: reads lines and returns moves and events in the order of the program.
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

// Reads a program and, between its lines, the lines of a console. Both change the same modal state.
// Coordinates are machine coordinates of an axis slot in mm (base/types.hpp) unless stated
// otherwise.
class Interpreter {
 public:
  bool clamp = false;         // a target out of range is moved to the limit
  bool ignore_tools = false;  // the selection of a missing tool is an event, not an error
  uint8_t cold = 0;           // a bit for each slot whose filament is too cold to move
  std::shared_ptr<const Subprograms> subprograms;  // of the program; if null, M98 is an error
  bool ignore_calls = false;      // the call of a missing sub-program is an event, not an error
  bool calls_are_events = false;  // M98 and M99 are events for the caller
  bool plain = false;             // every code is the built-in command, never a macro
  LayerCounter layers;            // of the program
  // If a printing move leaves this range of Z in mm, the event TUNING_TOWER with the parameter Z
  // comes before the move. The event sets both bounds to infinity.
  double height_low = -kInfinity, height_high = kInfinity;

  Interpreter(const Machine& machine, std::vector<double> home, const LaserWords& laser);

  // ---- Reading ----

  // The program and the console have separate unread text. The source may change only when
  // at_boundary(). A console's macro counts as part of the line that calls it. Console lines may
  // run between the lines of a program's macro.
  void select(bool console) { source_ = console; }
  bool at_boundary() const {
    return !unfinished() && next_word_ == 0 && !(source_ && !frames_[1].empty());
  }
  void feed(const char* data, size_t n) { sources_[source_].feed(data, n); }
  void finish() { sources_[source_].finish(); }
  // Drops the unread text of the selected source. Its next line has the number `first`. If `first`
  // is 1, a new program starts: the layer count is 0 and the list of objects is empty.
  void restart(uint32_t first = 1);
  // Reads until it finds a move, an event or an error, or until the text ends.
  ParseResult next();
  const MoveRequest& move() const { return move_; }
  const Event& event() const { return event_; }
  const GcodeError& error() const { return error_; }
  // Number of bytes in the lines that were read from the selected source.
  uint64_t offset() const { return sources_[source_].offset(); }
  // Number of the last line that was read from the selected source. Lines of sub-programs do not
  // count.
  uint32_t line() const { return sources_[source_].number(); }
  // True if all text is read and the last line is a move without a line end: the line may be cut
  // short.
  bool ends_in_move() const { return lines().unended() && moved_line_ == number(); }
  // After ParseResult::macro: inserts the lines of macro `code` before the rest of the line that
  // calls it. If the macro replaces a built-in command, that command is the built-in one while
  // these lines run.
  void insert(std::string_view text, std::string_view code = {});
  // In the middle of a command: lines that are read before the rest of its line. At their end,
  // next() returns ParseResult::need_input until leave_apart().
  void insert_apart(std::string_view text);
  // Drops what is left of such lines, also after a failure.
  void leave_apart();
  // Depth of nested macros of the selected source.
  size_t macro_depth() const { return frames_of(FrameKind::macro); }
  // Depth of nested sub-programs of the selected source.
  size_t subprogram_depth() const { return frames_of(FrameKind::subprogram); }
  // Moves the unread rest of the program's macro to `mine`, where it becomes a macro of the
  // console.
  void hand_over_macro(Interpreter& mine);
  // Drops the rest of a console's macros.
  void forget_macros() { frames_[1].clear(); }
  // Records how line `line` of the program is interpreted; watched_line() returns the record.
  void watch_line(uint32_t line) { watched_ = line; }
  const WatchedLine& watched_line() const { return watched_line_; }
  // Number of commands read so far, including unknown ones.
  uint64_t commands() const { return commands_; }
  uint64_t arcs() const { return arcs_; }
  // Names of line types from the slicer's comments. MoveRequest::feature is an index into this
  // list.
  const std::vector<std::string>& features() const { return features_; }
  // How many targets of one slot were moved to the limit, and the error of the first one.
  struct Clamped {
    uint64_t times = 0;
    GcodeError first;
  };
  const Clamped& clamped(int j) const { return clamped_[j]; }

  // ---- Suspending and replacing the program ----

  // After a stop: drops the rest of the current line. The machine is at `position`, its extruders
  // are at `extruders`, and the program continues from there.
  void abandon(const double* position, const std::vector<double>& extruders);
  // Restores the program that `before` was reading, with its modes. The console's unread text
  // stays. Settings that the console has changed meanwhile stay.
  void resume(const Interpreter& before);
  // Copies the program's state from another interpreter of the same machine. This interpreter keeps
  // its unread text and its home positions.
  void adopt(const Interpreter& other);
  // Turns the laser off for later moves, until the program sets its energy again.
  void dark() { density_ = 0; }
  // G-code in mm, one command a line, that restores the modal state of this program.
  std::string modes() const;
  // G90, M82 and the feedrate in mm/s. The feedrate is infinite before the first F.
  struct Modal {
    bool absolute, absolute_e;
    double feed_mm_s;
  };
  Modal modal() const { return {absolute_, absolute_e_, feed_}; }

  // ---- Positions ----

  // Machine position of the last target; slot kE is the extruder in use.
  const double* position() const { return position_; }
  // Position in the program's coordinates; slot kE is the E of the program.
  double logical(int j) const { return j == kE ? logical_e_ : meant(j) - gap(j) - origin_[j]; }
  // Sets slot j to `position`. If `homed`, this is the axis' home position. The program's zero
  // stays.
  void set_axis(int j, double position, bool homed);
  // Corrects slot j to `position`, where the plan ends now, without motion. The
  // program's offsets stay. Call this only at a boundary between lines.
  void set_place(int j, double position) { position_[j] = position; }
  // Sets slot j to `position`. The next move of the axis also covers the distance to the program's
  // position.
  void put(int j, double position) {
    owe(j, due_[j] + position_[j] - position);
    position_[j] = position;
  }
  // The axes in `letters` (empty: all axes) are at home. Their program offsets are reset.
  void home(const std::string& letters);
  // Machine position at which each slot was homed last.
  const double* homed() const { return homed_; }
  // The position of a locked axis is unknown: its moves fail until it is homed or G92 sets its
  // position.
  void lock(int j, bool locked) {
    locked_ = uint8_t(locked ? locked_ | 1u << j : locked_ & ~(1u << j));
  }
  bool locked(int j) const { return locked_ >> j & 1; }
  // Whether slot j may be at position `at`. If not, sets `error`.
  bool in_range(int j, double at, GcodeError& error) const;
  // Moves the program's zero along slot j (X, Y or Z).
  void shift_zero(int j, double mm) { origin_[j] += mm; }
  // Moves the program's zero along slot j, and the moves that are read but not taken yet.
  void shift(int j, double mm);
  // The axis now includes an earlier shift of `mm`: the program's zero goes back by `mm` along slot
  // j. `position` stays.
  void absorb_shift(int j, double mm);
  // After each homing of slot j (X, Y or Z), the program's zero is `mm` further from the axis'
  // zero.
  void keep_offset(int j, double mm) { offset_[j] += mm; }
  // Removes a hop of `mm` that does not fit, from the last move taken and from the rest of its
  // line.
  void drop_hop(double mm);

  // ---- Tools and filament ----

  size_t tool() const { return tool_; }
  size_t extruder() const { return active_; }
  // Selects a tool that has an extruder. No axis moves now: the next move of an axis also moves all
  // axes by the difference of the tool offsets. Does nothing if extruders are axes.
  void take_tool(size_t tool);
  // Changes the offset of the tool in use by `mm` along slot j. The next move of the axis includes
  // the change.
  void shift_tool(int j, double mm);
  // Distance in mm that the next move of an axis adds along slot j (X, Y or Z) because of a new
  // tool or offset.
  double offset_due(int j) const { return due_[j]; }
  // Drops the offset that is due: the machine is already at the tool's position.
  void forget_offset() {
    constexpr double kNone[3] = {};
    owe(kNone);
  }
  // A move of this extruder left out `mm`. The program's E counts them as extruded.
  void leave_filament(size_t extruder, double mm);
  // Filament in mm for each mm (with M200: mm³) of the program's E.
  double e_scale() const {
    if (extruder_.empty()) return 1;
    const double flow = filament_[active_].flow;
    if (!volumetric_) return flow;
    const double r = 0.5 * diameter_[active_];
    return flow / (kPi * r * r);
  }
  // Flow factor of M221, and that of the measured width.
  double flow(size_t extruder) const { return filament_[extruder].asked; }
  double width_factor(size_t extruder) const { return filament_[extruder].width; }
  void set_flow(size_t extruder, double flow) { set_factors(filament_[extruder], flow, 0); }
  void set_width_factor(size_t extruder, double width) {
    set_factors(filament_[extruder], 0, width);
  }
  // Applies `change`, which has already changed the planned moves, to moves that are read but not
  // taken.
  void change_flow(size_t extruder, FlowChange& change);
  // Cancels the retraction of an earlier G10, so that G11 does not return it.
  void forget_retraction();
  // M207 and M208.
  const Retraction& retraction() const { return retraction_; }
  bool auto_retract() const { return auto_retract_; }  // set by M209
  bool volumetric() const { return volumetric_; }      // set by M200
  const std::vector<double>& diameters() const {
    return diameter_;
  }  // filament of each extruder, set by M200
  static constexpr double kLoadMmS = 6, kUnloadMmS = 20;  // speeds of M701 and M702
  static constexpr double kMaxChangeMm = 5000;  // maximum length in M207, M208, M603, M701
  struct Change {
    double load_mm, unload_mm;  // filament lengths of M603
  };
  const std::vector<Change>& changes() const { return change_; }

  // ---- Objects of the print (M486) ----

  // Skips the moves of cancelled objects. Then a travel goes to where the next move starts.
  Objects& objects() { return *objects_; }
  const Objects& objects() const { return *objects_; }
  // Number of the object that a recent line of the main program belongs to; -1: none.
  int object_of_line(uint32_t line) const { return object_lines_.at(line); }

  // ---- Arcs ----

  // The arc whose chords are the next moves.
  const Arc& arc() const { return arc_; }
  void note_arc_reached() { arc_.note_reached(); }
  // Sets `target` to the end of the next chord of `rest`, which is a copy of arc().
  void take_chord(Arc& rest, double* target) const;

 private:
  static constexpr double kPi = 3.141592653589793;
  static constexpr double kReported = 0.5e-3;   // rounding of M114, mm
  static constexpr double kRounding = 1e-9;     // smaller differences are 0, mm
  static constexpr size_t kMaxNameBytes = 100;  // maximum length of a command's name
  static constexpr double kUsualMm = 1.75;      // usual diameter of filament
  static constexpr int kSaved = 2;              // number of positions of G60
  static constexpr int kMostSpecial = 2;        // largest number of G1 H
  static constexpr size_t kMaxDepth = 10;       // of nested sub-programs
  static constexpr uint32_t kMaxIdleCalls =
      100'000;  // maximum calls of sub-programs without a move

  struct Item {  // a result of the line that next() has not returned yet
    ParseResult found;
    bool joins = false;  // the move comes from join()
    MoveRequest move;
    Event event;
    GcodeError error;
  };
  struct Saved {
    bool valid = false;
    double at[kAxes];
  };
  struct Drawn {  // state of G10
    bool back = false, swapped = false;
    double mm = 0;
  };
  struct Strand {       // filament of an extruder, or of an axis that pushes filament
    double drawn = 0;   // retracted length, mm
    double excess = 0;  // part of `drawn` that the program has not commanded, mm
  };
  enum class FrameKind : uint8_t { subprogram, macro, rest };
  struct Frame {  // text that is read before the source: a sub-program, a macro, or the rest of the
                  // calling line
    FrameKind kind = FrameKind::subprogram;
    std::string code = {};  // name of the macro
    Subprograms::Label label{};
    Lines lines;
    size_t fed = 0;      // position in the text of the sub-programs
    int repeats = 1;     // remaining runs, including this one
    bool apart = false;  // of insert_apart
  };
  struct CycleWords {  // last values of R, Q, P and the bottom of the hole, in mm and s
    int code = 0, plane = 0;
    double value[4];
    bool given[4];
  };

  const Machine* machine_;
  std::vector<double> home_;
  double homed_[kAxes] = {}, home_step_[kAxes] = {};
  LaserWords laser_;
  double density_ = 0;  // laser energy, W·s/mm
  Lines sources_[2];    // of the program and of the console
  bool source_ = false;
  MoveRequest move_{};
  Event event_;
  GcodeError error_;
  std::deque<Item> pending_;
  int8_t letter_slot_[26];
  uint32_t filament_letters_ = 1u << ('E' - 'A');  // a bit for each letter
  uint8_t filament_slots_ = 1u << kE;
  double low_[kAxes], high_[kAxes];

  double position_[kAxes] = {};  // see position()
  double origin_[kAxes] = {};    // machine position of the program's zero
  double offset_[3] = {};        // program's zero after homing, without tool offset
  double due_[kAxes] = {};       // see offset_due(); always 0 for slots above Z
  bool any_due_ = false;
  struct {
    double from[3], mm[3];
    size_t tool;
    uint32_t line = 0;  // 0: no move yet
  } owed_;              // the last tool offset that a move has carried out, and the position before
  double logical_e_ = 0;          // E in the program's coordinates
  std::vector<double> extruder_;  // machine position of each extruder
  std::vector<Filament> filament_;
  std::vector<double> diameter_;  // filament of each extruder, mm
  bool volumetric_ = false;       // E is a volume in mm³
  std::vector<Change> change_;    // of each extruder
  size_t tool_ = 0, active_ = 0;
  double unit_ = 1, feed_ = kInfinity;
  bool absolute_ = true, absolute_e_ = true;
  // Modal motion: 0 to 3 for G0 to G3; -1: none yet. Any other code is stored as ten times its
  // number plus its decimal.
  int motion_ = -1;
  bool machine_zero_ = false;  // G53, valid until the line ends
  int plane_ = 17;
  Saved saved_[kSaved];       // positions of G60
  std::vector<Drawn> drawn_;  // of each extruder
  std::shared_ptr<Objects> objects_ = std::make_shared<Objects>();
  ObjectLines object_lines_;
  int object_ = -1;         // number of the current object; -1: none
  double gap_[kAxes] = {};  // from the machine's position to the program's, after skipped moves
  std::vector<Strand> strands_;  // of each extruder
  Strand axis_strands_[kAxes];
  bool apart_ = false;  // gap_ or an excess is not 0
  double skipped_feed_ = 0,
         skipped_strand_feed_ = 0;  // feedrates of the last skipped travel and retraction
  bool auto_retract_ = false;
  uint8_t locked_ = 0;  // a bit for each axis slot
  double hop_ = 0;      // height of the hop: Z is this much above the program's Z, mm
  Retraction retraction_;
  uint16_t feature_ = 0;
  std::vector<std::string> features_;
  uint64_t arcs_ = 0;
  Clamped clamped_[kAxes];
  uint32_t idle_noted_ = 0;  // letters that idles() has already reported
  uint8_t cut_ = 0;          // a bit for each slot whose target was moved to the limit
  Arc arc_;
  MoveRequest arc_move_{};  // the next chord as a move
  double arc_hop_ = 0;      // hop_ at the start of the arc
  std::string text_;        // the line without comments
  std::vector<Word> words_;
  uint32_t watched_ = 0, moved_line_ = 0;
  uint32_t ended_line_ = 0;  // number of the program's line where zero bytes or a Ctrl-Z end the
                             // text; 0: none not
  bool ended_by_zero_ = false;
  WatchedLine watched_line_;
  uint64_t commands_ = 0;
  std::vector<Frame> frames_[2];  // of the program and of the console
  uint32_t idle_calls_ = 0;
  CycleWords cycle_words_{};
  Cycle cycle_;
  double cycle_feed_ = 0;
  double cycle_level_ = 0;    // level of the drilling axis before the first of consecutive cycles
  bool cycle_begins_ = true;  // the next cycle is the first of consecutive ones
  bool to_level_ = true;      // G98: returns to cycle_level_; G99: returns to level R
  size_t next_word_ = 0;  // if not 0, the line continues with this word once its moves are taken

  Lines& lines() {
    auto& frames = frames_[source_];
    return frames.empty() ? sources_[source_] : frames.back().lines;
  }
  const Lines& lines() const { return const_cast<Interpreter*>(this)->lines(); }
  // Line number for moves, events and errors. Lines of a macro have the number of the calling line.
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
  // True while moves of the line are left: they come before its next word.
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
  // True while an object is cancelled: its moves are skipped, so that their targets may be out of
  // range.
  bool anywhere() const { return skips() && !clamp; }
  Strand& strand_of(int j) { return j == kE ? strands_[active_] : axis_strands_[j]; }

  // Position of slot j that the program has commanded, in machine coordinates.
  double meant(int j) const { return position_[j] + gap(j) - (j == kZ ? hop_ : 0) + due_[j]; }
  // Distance from the machine's position to the program's after skipped moves; 0 for a console.
  double gap(int j) const { return source_ ? 0 : gap_[j]; }
  // The current position, including skipped moves.
  void here(double* at) const {
    for (int j = 0; j < kAxes; ++j) at[j] = position_[j] + gap(j);
  }
  // Offset of this tool's nozzle from the first tool's. The machine moves by the opposite amount.
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
  // Whether slot j may not move to `at`. If the home position is beyond the limits, a move may
  // start there or end there. It may not end between home and the limit.
  bool beyond(int j, double at) const { return beyond(j, at, position_[j]); }
  bool beyond(int j, double at, double from) const {
    return (at < std::min(low_[j], from) - 1e-6 || at > std::max(high_[j], from) + 1e-6) &&
           !at_home(j, at);
  }
  // Whether `at` is the home position of slot j, within a motor step and the rounding of reports.
  bool at_home(int j, double at) const {
    return std::fabs(at - homed_[j]) <= home_step_[j] + kReported;
  }
  // Letters whose words are distances, not positions.
  uint32_t relative() const {
    return (absolute_ || machine_zero_ ? 0 : ~0u) |
           (absolute_ && absolute_e_ ? 0 : filament_letters_);
  }

  // interpreter.cpp: the fast path, and what all moves have in common
  ParseResult fast_move(const char* p, const char* end, bool rapid);
  bool straight(const double* value, uint32_t have, double feed, double duration, bool rapid);
  bool target(const double* value, uint32_t have, uint32_t relative, uint32_t offset);
  bool take(MoveRequest& m);
  bool take_now(MoveRequest& m, bool follows);
  // Whether the event TUNING_TOWER comes first; then the move waits in `pending_`.
  bool waits_for_height(const MoveRequest& m, bool follows);
  void stamp(MoveRequest& m) const;
  void shine(MoveRequest& m) const;

  // interpreter_lines.cpp: lines with any words, and events
  void run_line(const char* p, const char* end);
  void run_words();
  bool ends_text(const char* p, const char*& end);
  void comment(std::string_view text);
  void pass_on(std::string_view name, std::string_view text);
  void note_command(std::string_view code, const Word* first, const Word* last,
                    std::string_view text = "");
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

  // interpreter_commands.cpp: commands that change the motion state
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

  // interpreter_motion.cpp: G0 to G3 with all their words, and saved positions
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

  // interpreter_cycles.cpp: G73, G81, G82, G83
  void run_cycle(int code, const Word* first, const Word* last);
  bool next_of_cycle();

  // interpreter_tools.cpp: tool changes and tool offsets
  void select_tool(const Word& word);
  uint32_t offset_letters(uint32_t have, bool arc = false) const;
  void carry_out(uint8_t moved);
  int tool_position(double* at) const;
  bool lays_filament() const;
  void queue_offset(const double* to, double feed);

  // Sets the factors that are above 0.
  static void set_factors(Filament& filament, double asked, double width) {
    if (asked > 0) filament.asked = asked;
    if (width > 0) filament.width = width;
    filament.flow = filament.asked * filament.width;
  }

  // interpreter_filament.cpp: retraction, filament changes, flow
  bool run_filament(int code, const Arguments& a);
  void run_retract(bool in, bool swap = false);
  bool retracts(uint32_t have);
  double meant_mm() const;
  void take_back(double mm) { logical_e_ -= mm / e_scale(); }

  // interpreter_calls.cpp: M98, M99 and macros
  void run_call(std::string_view text);
  bool run_return(std::string_view text);
  void begin_frame();
  void feed_frame();
  void fail_call(CallFault fault, const std::string& call);

  // interpreter_objects.cpp: M486, and moves of cancelled objects
  void run_objects(std::string_view code, std::string_view text);
  void obey(const ObjectOrder& order);
  void forget_objects();
  bool take_apart(MoveRequest& m);
  void skip(const MoveRequest& m);
  bool join(const MoveRequest& m);
  void pass_filament(int j, double mm);
  void look_apart();

  // interpreter_state.cpp: homing, stops, and state from another interpreter
  void measure_steps();
};

}  // namespace passo
