// The fastest corner of a print with filters: how X, Y and the filament move there, as planned and
// as filtered.
#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "filters/backlash.hpp"
#include "machine/machine.hpp"
#include "plan/move.hpp"

namespace passo {

// Keeps the moves around one corner. Among corners between two printed lines it is the first one
// with the largest change of the cruise speed in X and Y. If there are none, it is a corner between
// two other moves, else the start of a move.
class FastestCorner {
 public:
  explicit FastestCorner(const Machine& machine) : machine_(machine), hz_(machine.clock_hz) {}

  // Takes a settled move before its steps are solved. lead(i): the backlash compensation of motor i
  // at present, in steps.
  void add(const Move& m, const std::function<int64_t(size_t)>& lead);

  bool found() const { return corner_.has_value(); }
  uint32_t line() const { return corner_->line; }      // line number of the move after the corner
  const double* at_mm() const { return corner_->at; }  // position, X and Y
  // clock(): when the motors pass the corner. from() and to(): clocks of the part around it, which
  // includes the deceleration before, the acceleration after, and the filters' memory on both
  // sides.
  double clock() const { return corner_->clock + corner_->filters.delay(hz_); }
  double from() const;
  double to() const;

  // A part of a law: a cubic of time.
  struct Part {
    double start, ticks;
    double q, v, a, j;  // at the start, in mm and ticks
  };
  // The law of a slot (kX, kY or kE) between from() and to(), in parts without gaps: with filters,
  // or only delayed. The filament is that of the move after the corner. The filtered law includes
  // backlash compensation if the axis has a motor of its own.
  std::vector<Part> law(int slot, bool filtered) const;

 private:
  static constexpr double kLongestRamp = 0.25, kLeastMargin = 0.02;  // s
  struct Corner {
    int rank;       // 2: between printed lines, 1: between moves, 0: start
    double change;  // of the cruise speed, mm/s
    double clock;   // clock of the plan
    double at[2];   // X and Y
    uint32_t line;
    int extruder;
    Filters filters;
    bool rests;  // everything stops after the last move
    std::vector<Move> moves;
    std::array<Backlash, 2> gaps;  // state before the first move

    bool is_less(int than, double change_than) const {
      return rank != than ? rank < than : change * (1 + 1e-9) < change_than;
    }
  };
  const Machine& machine_;
  double hz_;
  std::deque<Move> recent_;
  std::array<Backlash, 2> gaps_;  // state of X and Y before the recent moves
  std::optional<Corner> corner_;
  bool open_ = false;  // the corner needs more moves

  double margin(const Filters& filters) const;
  void begin(const Move& m, const std::function<int64_t(size_t)>& lead);
  void forget(double before);
  void consider(const Move* before, const Move& after);
  // The motor that moves only this axis, or null.
  const StepperSpec* own_motor(int axis) const;
};

}  // namespace passo
