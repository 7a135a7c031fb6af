// How filament follows the program's E: the flow (M221) of an extruder, what a retraction is owed,
// and a change of the flow let into moves that were planned with another one.
#pragma once
#include <algorithm>

namespace passo {

// mm by which filament is still drawn back after it has moved by `mm`, and was by `owed` before.
// More than a retraction is an unloading, to which nothing is owed.
inline double owed_after(double owed, double mm) {
  constexpr double kNone = 1e-9, kMostRetracted = 20;  // mm
  owed -= mm;
  return owed > kNone && owed <= kMostRetracted ? owed : 0;
}

// Of one extruder. What was drawn back comes back by the same length, whatever the flow is then:
// a change in between leaves neither a gap nor a blob.
struct Filament {
  double flow = 1;   // mm that move for a mm that the program means
  double owed = 0;   // mm that the program has drawn back
  double scale = 1;  // mm drawn back for a unit of the program's E

  // mm for `delta` of the program's E, of which a unit is `now` mm.
  double length(double delta, double now) const {
    if (!(delta > 0) || owed == 0 || scale == now) return delta * now;
    double back = owed / scale;
    return delta <= back ? delta * scale : owed + (delta - back) * now;
  }
  // It has moved by `mm`; a unit of the program's E is `now` mm.
  void moved(double mm, double now) {
    double after = owed_after(owed, mm);
    if (mm < 0) scale = owed == 0 || scale == now ? now : (owed - mm) / (owed / scale - mm / now);
    owed = after;
  }
};

// One extruder's flow becomes another in the midst of a plan. Moves go through `apply` in their
// order; places that follow them, through `place`.
class FlowChange {
 public:
  explicit FlowChange(double flow) : flow_(flow) {}

  double flow() const { return flow_; }
  // Where the filament is now that was to be at `at` behind all changed moves so far.
  double place(double at) const { return at == old_ ? new_ : at + (new_ - old_); }
  // Its debt there, of `owed` mm before.
  double owed(double owed) const { return begun_ && owed > 0 ? owed_ : owed; }

  // Changes a move of filament from one place to another, made with `flow` (0: not a program's, it
  // keeps its length), before which the filament was drawn back by `owed`.
  void apply(double& from, double& to, double& flow, double& owed) {
    double start = place(from), mm = to - from, length = scaled(mm, flow, owed);
    old_ = to;
    if (start != from || length != mm) to = length == 0 ? start : start + length;
    from = start;
    new_ = to;
  }

 private:
  double flow_;
  double old_ = 0, new_ = 0;  // where the last move has ended, and ends
  bool begun_ = false;
  double owed_ = 0;  // behind it

  double scaled(double mm, double& flow, double& owed) {
    if (flow == 0) return mm;
    double before = owed, ratio = flow_ / flow;
    if (!begun_ || before == 0) owed_ = before;
    begun_ = true;
    owed = owed_;
    flow = flow_;
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
