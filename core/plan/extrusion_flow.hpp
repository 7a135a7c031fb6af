// How filament follows the program's E: the flow of an extruder (M221, times the factor of its
// measured width), the filament that a retraction still has to give back, and a change of the flow
// in moves that are planned already.
#pragma once
#include <algorithm>

namespace passo {

// mm by which filament is still drawn back after a move by `mm`, with `owed` before it. More than a
// retraction is an unloading: nothing is given back.
inline double owed_after(double owed, double mm) {
  constexpr double kNone = 1e-9, kMaxRetracted = 20;  // mm
  owed -= mm;
  return owed > kNone && owed <= kMaxRetracted ? owed : 0;
}

// For one extruder. A retraction is returned with the same length even if the flow has changed, so
// it leaves neither a gap nor a blob.
struct Filament {
  double asked = 1;  // M221
  double width = 1;  // factor of the measured width
  double flow = 1;   // mm that move for a mm that the program means: the product of both
  double owed = 0;   // mm that the program has drawn back
  double scale = 1;  // mm drawn back for a unit of the program's E

  // mm for `delta` of the program's E, of which a unit is `now` mm.
  double length(double delta, double now) const {
    if (!(delta > 0) || owed == 0 || scale == now) return delta * now;
    double back = owed / scale;
    return delta <= back ? delta * scale : owed + (delta - back) * now;
  }
  // The filament has moved by `mm`; a unit of the program's E is `now` mm.
  void moved(double mm, double now) {
    double after = owed_after(owed, mm);
    if (mm < 0) scale = owed == 0 || scale == now ? now : (owed - mm) / (owed / scale - mm / now);
    owed = after;
  }
};

// Changes the flow of an extruder within a plan: to the same value in all moves, or by the same
// factor. Moves go through `apply` in their order; positions after them go through `position`.
class FlowChange {
 public:
  explicit FlowChange(double flow) : flow_(flow) {}
  static FlowChange by(double factor) {
    FlowChange change(factor);
    change.relative_ = true;
    return change;
  }

  // The new position of filament that was planned to be at `at` after the moves changed so far.
  double position(double at) const { return at == old_ ? new_ : at + (new_ - old_); }
  // The filament in mm that is still drawn back there; `owed` before the change.
  double owed(double owed) const { return begun_ && owed > 0 ? owed_ : owed; }

  // Changes a move of filament that was planned with `flow` (0: not a program's, its length stays)
  // and starts drawn back by `owed`.
  void apply(double& from, double& to, double& flow, double& owed) {
    double start = position(from), mm = to - from, length = scaled(mm, flow, owed);
    old_ = to;
    if (start != from || length != mm) to = length == 0 ? start : start + length;
    from = start;
    new_ = to;
  }

 private:
  double flow_;
  bool relative_ = false;
  double old_ = 0, new_ = 0;  // end of the last move, before and after the change
  bool begun_ = false;
  double owed_ = 0;  // after it

  double scaled(double mm, double& flow, double& owed) {
    if (flow == 0) return mm;
    double before = owed, after = relative_ ? flow * flow_ : flow_, ratio = after / flow;
    if (!begun_ || before == 0) owed_ = before;
    begun_ = true;
    owed = owed_;
    flow = after;
    double length = mm;
    if (mm < 0) {
      length = mm * ratio;
    } else if (ratio != 1 || owed_ != before) {
      double back = std::min(mm, before);
      length = (before > 0 ? back * (owed_ / before) : 0) + (mm - back) * ratio;
    }
    owed_ = owed_after(owed_, length);
    return length;
  }
};

}  // namespace passo
