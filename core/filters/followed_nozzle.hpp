// The law of a motor of a nonlinear geometry: the geometry gives its position along the filtered
// path of the nozzle.
#pragma once
#include <deque>

#include "filters/phases.hpp"
#include "geometry/track.hpp"
#include "machine/machine.hpp"

namespace passo {

class FollowedNozzle {
 public:
  FollowedNozzle(const Machine& machine, const StepperSpec& spec, const Track& track)
      : machine_(machine), spec_(spec), track_(track) {}

  void start(double) {}  // always at the start of the track
  double t() const { return track_.t[track_.n]; }
  double q() const {
    const double at[3] = {track_.p[0][0], track_.p[1][0], track_.p[2][0]};
    return nearest_turn(*machine_.geometry, spec_.index, spec_.steps_per_unit,
                        machine_.geometry->inverse(spec_.index, at) * spec_.steps_per_unit, near_);
  }
  // A motor that turns without end has this step count.
  void keep_turns(double count) { near_ = count; }
  double earliest() const { return 0; }

  // Passes on the whole track by sink.bent, see law.hpp.
  template <class Sink>
  void advance(double, bool, Sink& sink) {
    fit(track_, near_, fit_);
    pass_on(track_, fit_, 0, sink);
    near_ = fit_.law.q[track_.n];
  }
  // This law has no phases of its own.
  size_t needed(const Phases*) const { return 0; }
  void dropped(const Phases*, size_t) {}

 private:
  static constexpr size_t kParts = 4, kDeepest = 20;
  // Quadratics with bends (see IntervalSolver) that approximate the motor's law, in steps and
  // ticks.
  struct Fit {
    Track track;  // parts of one interval
    Followed law;
    UnsetDoubles accel, odd, even;
  };
  const Machine& machine_;
  const StepperSpec& spec_;
  const Track& track_;
  Fit fit_;
  std::deque<Fit> parts_;  // buffers, by depth of division

  double near_ = 0;  // steps at the start of the track, within half a turn

  // Fits quadratics to the motor's law along a track, which starts near `near` steps.
  void fit(const Track& track, double near, Fit& to) const;
  // Passes on the quadratics. Divides intervals where the error is too large.
  template <class Sink>
  void pass_on(const Track& track, const Fit& fits, size_t depth, Sink& sink) {
    const Followed& law = fits.law;
    for (size_t i = 0; i < track.n; ++i) {
      // The error is not a number at a singular point, where smaller parts do not help.
      if (!(law.error[i] > 0) || depth == kDeepest) [[likely]] {
        sink.bent(track.t[i + 1], law.q[i + 1], law.v0[i], law.v1[i], fits.accel[i], fits.odd[i],
                  fits.even[i]);
        continue;
      }
      if (parts_.size() == depth) parts_.emplace_back();
      Fit& parts = parts_[depth];
      parts.track.divide(track, i, kParts);
      fit(parts.track, law.q[i], parts);
      pass_on(parts.track, parts, depth + 1, sink);
    }
  }
};

}  // namespace passo
