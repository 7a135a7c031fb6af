// The fastest corner of a print with filters, and what X, Y and the filament do around it: as
// planned, and as the filters let them.
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

// Keeps the moves around one corner: of those between two printed lines, the first one with the
// greatest change of the speed that X and Y have at cruise. Without such a corner it is one between
// two other moves, and else a start.
class FastestCorner {
 public:
  explicit FastestCorner(const Machine& machine) : machine_(machine), hz_(machine.clock_hz) {}

  // A settled move, before its steps are solved. lead(i): steps by which motor i is beyond its
  // position at rest.
  void add(const Move& m, const std::function<int64_t(size_t)>& lead);

  bool found() const { return corner_.has_value(); }
  uint32_t line() const { return corner_->line; }      // of the move after it
  const double* at_mm() const { return corner_->at; }  // X and Y
  // Clocks at which the motors pass it in the middle, and of the stretch around it: from a ramp and
  // the filters' memory before it, to a ramp and their memory after it.
  double clock() const { return corner_->clock + corner_->filters.delay(hz_); }
  double from() const;
  double to() const;

  // A part of a law, a cubic of time.
  struct Part {
    double start, ticks;
    double q, v, a, j;  // at its start: mm and derivatives by ticks
  };
  // The law in a slot, kX, kY or kE, from from() to to(), each part from the end of the one before
  // it: as filtered, or as planned and then only delayed. The filament is that of the move after
  // the corner. A filtered axis that has a motor of its own takes up the gap of its drive.
  std::vector<Part> law(int slot, bool filtered) const;

 private:
  static constexpr double kLongestRamp = 0.25, kLeastMargin = 0.02;  // s
  struct Corner {
    int rank;       // 2: between printed lines, 1: between moves, 0: start
    double change;  // mm/s
    double clock;   // of the plan
    double at[2];   // X, Y
    uint32_t line;
    int extruder;
    Filters filters;
    bool rests;  // after the last move
    std::vector<Move> moves;
    std::array<Backlash, 2> gaps;  // before the first move

    bool is_less(int than, double change_than) const {
      return rank != than ? rank < than : change * (1 + 1e-9) < change_than;
    }
  };
  const Machine& machine_;
  double hz_;
  std::deque<Move> recent_;
  std::array<Backlash, 2> gaps_;  // of X and Y, before the recent moves
  std::optional<Corner> corner_;
  bool open_ = false;  // the corner still takes moves

  double margin(const Filters& filters) const;
  void begin(const Move& m, const std::function<int64_t(size_t)>& lead);
  void forget(double before);
  void consider(const Move* before, const Move& after);
  // The motor that moves nothing but an axis; null: none.
  const StepperSpec* own_motor(int axis) const;
};

}  // namespace passo
