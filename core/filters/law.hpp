// The motion of one motor, or of one axis of the nozzle, in time, after all filters.
#pragma once
#include <variant>

#include "filters/advance.hpp"
#include "filters/followed_nozzle.hpp"
#include "filters/planned_laws.hpp"
#include "filters/raised_nozzle.hpp"
#include "filters/smooth_law.hpp"
#include "filters/taps.hpp"
#include "geometry/track.hpp"
#include "machine/machine.hpp"
#include "plan/move.hpp"

namespace passo {

// The kind of motion between two breakpoints.
enum class PartKind { quadratics, cubics, pieces };

// A law has the first of these forms that is exact for its filters:
//
//   form            parts                    of
//   Taps            quadratics               shapers, or a delay alone
//   Advance         cubics                   an advance that no shaper changes
//   SmoothLaw       cubics                   a limit of jerk, an advance that is shaped
//   FollowedNozzle  quadratics with bends    a motor of a delta or an arm
//   RaisedNozzle    pieces                   a motor that corrects an uneven bed
//
// A sink has a function for each kind of part. The form calls it once for each interval:
//
//   add(end clock, end position, speed at begin and end, acceleration)
//   bent(the same, odd, even): IntervalSolver::add
//   cubic(begin clock, ticks, position, speed, acceleration, jerk, end position, end speed)
//   counted(begin clock, ticks, c0, c1, c2, end, net steps): CubicSolver::cubic
//   piece(Piece)
//
// The form is looked up once for each call of `advance`, not for each part.
class Law {
 public:
  explicit Law(double hz) : planned_(hz), hz_(hz) {}
  Law(const Law&) = delete;
  Law& operator=(const Law&) = delete;

  // Sets which motor the law describes. Call this only at standstill. `nozzle`: the path of the
  // nozzle, for motors that are not a fixed sum of axes.
  void follow(const Machine& machine, const StepperSpec& spec, const Track& nozzle);
  // The law describes X, Y or Z of the nozzle, in mm. Call this only at standstill.
  void follow_axis(const Filters& filters, int slot);

  PartKind parts() const {
    return std::visit([](const auto& form) { return parts_of(form); }, form_);
  }
  // Whether the parts are calculated from the path of the nozzle.
  bool follows_nozzle() const { return planned_.all().empty(); }

  // These four act as in PlannedLaws.
  void begin(const Move& m) { planned_.begin(m); }
  void add(const Move& m, double until) { planned_.add(m, until); }
  void resume(double clock) { planned_.resume(clock); }
  void stand() { planned_.stand(); }

  // Restarts the law at this clock.
  void start(double clock) {
    std::visit([&](auto& form) { form.start(clock); }, form_);
  }
  double t() const {
    return std::visit([](const auto& form) { return form.t(); }, form_);
  }
  double q() const {
    return std::visit([](const auto& form) { return form.q(); }, form_);
  }
  // Of a motor that turns without end: its step count at the start of the law. Call this after
  // start().
  void keep_turns(double count) {
    if (FollowedNozzle* form = std::get_if<FollowedNozzle>(&form_)) form->keep_turns(count);
  }
  // Ticks by which the law is known beyond the end of the plan.
  double earliest() const {
    return std::visit([](const auto& form) { return form.earliest(); }, form_);
  }
  // Passes on the parts up to the clock `limit`, which is at most earliest() after the end of the
  // plan. With `last` no move follows, and all parts are passed on.
  template <class Sink>
  void advance(double limit, bool last, Sink& sink) {
    std::visit(
        [&](auto& form) {
          form.advance(last ? kAllTicks : limit, last, sink);
          for (Phases& p : planned_.all()) form.dropped(&p, p.drop(form.needed(&p)));
        },
        form_);
  }

 private:
  PlannedLaws planned_;
  double hz_;
  std::variant<Taps, Advance, SmoothLaw, FollowedNozzle, RaisedNozzle> form_;

  // Selects the first form that is exact for the kernels of the planned laws.
  void choose(double delay);

  static PartKind parts_of(const Taps&) { return PartKind::quadratics; }
  static PartKind parts_of(const Advance&) { return PartKind::cubics; }
  static PartKind parts_of(const SmoothLaw&) { return PartKind::cubics; }
  static PartKind parts_of(const FollowedNozzle&) { return PartKind::quadratics; }
  static PartKind parts_of(const RaisedNozzle&) { return PartKind::pieces; }
};

}  // namespace passo
