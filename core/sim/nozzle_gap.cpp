#include "sim/nozzle_gap.hpp"

#include <algorithm>
#include <cmath>

namespace passo::wire {

NozzleGap::NozzleGap(double clock_hz, std::shared_ptr<const Geometry> geometry, const Bed& bed,
                     const std::vector<TrackedMotor>& motors, std::vector<Lift> lifts)
    : hz_(clock_hz), geometry_(std::move(geometry)), bed_(bed), lifts_(std::move(lifts)),
      cells_(size_t(kCells) * kCells) {
  for (const TrackedMotor& motor : motors) tracks_.emplace_back(motor);
}

void NozzleGap::add_steps(size_t motor, const std::vector<StepRun>& runs, int64_t all, Ticks now) {
  Track& track = tracks_.at(motor);
  track.add(runs);
  for (const StepRun& run : runs) track.traced += run.count;
  const Ticks until = track.traced == all ? now : runs.empty() ? 0 : runs.back().end;
  track.known = std::max(track.known, track.main_clock(until));
}

void NozzleGap::advance() {
  double known = kInfinity;
  for (const Track& track : tracks_) known = std::min(known, track.known);
  sample_until(known);
}

void NozzleGap::sample_until(double clock) {
  while (!spans_.empty()) {
    const auto [from, to, offset] = spans_.front();
    if (!within_) at_ = from;
    within_ = true;
    for (; at_ < to; at_ += kSampleSeconds * hz_) {
      if (at_ >= clock) return run(clock);
      sample(at_, offset);
    }
    if (to >= clock) return run(clock);
    sample(to, offset);
    spans_.pop_front();
    within_ = false;
  }
  run(clock);
}

void NozzleGap::run(double clock) {
  while (!places_.empty() && places_.front().clock <= clock) {
    const Set set = std::move(places_.front());
    places_.pop_front();
    for (size_t i = 0; i < tracks_.size(); ++i) {
      tracks_[i].run(set.clock);
      tracks_[i].position = set.positions[i];
    }
  }
  for (Track& track : tracks_) track.run(clock);
}

void NozzleGap::sample(double clock, const std::array<double, 3>& offset) {
  run(clock);
  double q[Geometry::kMostActuators], p[3];
  for (int i = 0; i < geometry_->actuators(); ++i) q[i] = tracks_[size_t(i)].position;
  if (!geometry_->forward(q, p)) return;
  double z = p[2];
  if (!lifts_.empty()) {
    z = 0;
    for (Lift& lift : lifts_) {
      lift.position = tracks_[lift.motor].position;
      z += lift.share(p[0], p[1]);
    }
  }
  const double x = p[0] + offset[0], y = p[1] + offset[1];
  const Place here{z + offset[2] - bed_.height(x, y), x, y};
  if (samples_ == 0 || here.gap < lowest_.gap) lowest_ = here;
  if (samples_ == 0 || here.gap > highest_.gap) highest_ = here;
  ++samples_;
  sum_ += here.gap;
  auto index = [](double at, double center, double size) {
    return size_t(std::clamp(std::floor(((at - center) / size + 0.5) * kCells), 0.0, kCells - 1.0));
  };
  Cell& cell = cells_[index(y, bed_.center[1], bed_.size[1]) * kCells +
                      index(x, bed_.center[0], bed_.size[0])];
  cell.sum += here.gap;
  ++cell.samples;
}

}  // namespace passo::wire
