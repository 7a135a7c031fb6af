#include "link/heater.hpp"

#include <cmath>
#include <variant>

namespace passo::wire {

Heater::Heater(HeaterOptions options)
    : o_(std::move(options)), controller_(o_.control), protection_(o_.limits) {
  if (o_.model) body_.emplace(*o_.model);
  set_control(o_.control);
}

bool Heater::settled() const {
  return (near_s_ && *near_s_ >= o_.arrival.seconds) || about_s_ >= Arrival::kTimeout;
}

void Heater::set_target(double celsius) {
  double wanted = celsius > 0 ? celsius : 0;  // a target that is not a number means off, too
  if (wanted != target_) leave();
  target_ = wanted;
}

void Heater::set_sensor(const HeaterOptions& other) {
  o_.celsius = other.celsius;
  o_.low_share = other.low_share;
  o_.high_share = other.high_share;
  o_.open_is_high = other.open_is_high;
  o_.query = other.query;
  new_net_ = true;
  protection_.restart();
}

void Heater::set_control(const heat::Control& control) {
  controller_.set(control);
  if (const auto* predictive = std::get_if<heat::ModelControl>(&control))
    set_model(predictive->model);
}

void Heater::set_model(const std::optional<heat::HeatModel>& model) {
  if (!model)
    body_.reset();
  else if (body_)
    body_->set(*model);
  else
    body_.emplace(*model);
}

void Heater::follow_fan(uint32_t value) {
  if (value != fan_value_) set_fan(value / o_.fan_full);
  fan_value_ = value;
}

void Heater::rearm() {
  fault_ = {};
  leave();
  protection_.restart();
  if (body_) body_->restart();  // the model received readings of a broken sensor
}

void Heater::interrupted() {
  clock_.reset();
  leave();
  protection_.interrupted();
  if (body_) body_->restart();
}

bool Heater::report(uint32_t sum, Ticks clock, double clock_hz, uint32_t& value) {
  double dt = clock_ ? double(clock - *clock_) / clock_hz : 0;
  if (dt > o_.longest_s) {  // the power since the last report is unknown
    dt = o_.longest_s;
    if (body_) body_->restart();
  }
  double share = double(sum) / o_.adc_full;
  bool above = share > o_.high_share, below = share < o_.low_share;
  clock_ = reported_ = clock;
  fraction_ = share;
  celsius_ = o_.celsius.at(share);
  if (body_) body_->update(celsius_, power_, fan_, dt);
  bool failed = false;
  if (!faulty()) {
    bool open = o_.open_is_high ? above : below, shorted = o_.open_is_high ? below : above;
    bool full = power_ >= kFullShare * o_.max_power;
    fault_ = protection_.check({celsius_, heating_target(), power_, dt, full, open, shorted,
                                body_ ? body_->unexplained() : 0});
    fault_.clock = clock;
    failed = news_ = faulty();
  }
  double target = faulty() || suspended_ ? 0 : target_;
  double power =
      controller_.update({celsius_, target, dt, o_.max_power, body_ ? &*body_ : nullptr});
  arrive(target, dt);
  keeping_ = reached_ ? keeping_ + (power - keeping_) * std::min(1.0, dt / kKeepingSeconds) : 0;
  bool send = power > 0 || power_ > 0 || failed;  // a heater that is on must be renewed
  power_ = power;
  value = uint32_t(power * o_.full + 0.5);
  if (samples_.size() == kSamplesMax) samples_.pop_front();
  samples_.push_back({clock, celsius_, target_, power, controller_.terms()});
  return send;
}

bool Heater::change_net(bool& wide) {
  wide = faulty();
  bool changed = std::exchange(wide_, wide) != wide;
  return std::exchange(new_net_, false) || changed;
}

void Heater::leave() {
  reached_ = false;
  near_s_.reset();
  about_s_ = off_ = 0;
}

void Heater::arrive(double target, double dt) {
  if (target <= 0) return leave();
  double off = celsius_ - target, away = std::fabs(off);
  bool crossed = off * std::exchange(off_, off) < 0;  // a coarse sensor skips the window
  about_s_ = away > o_.arrival.leaves_c ? 0 : about_s_ + dt;
  if (about_s_ >= Arrival::kTimeout) reached_ = true;
  if (away > o_.arrival.leaves_c) {
    near_s_.reset();
  } else if (near_s_) {
    *near_s_ += dt;
  } else if (away <= o_.arrival.window_c || crossed) {
    near_s_ = 0;
    reached_ = true;
  }
}

double Heater::heating_target() const {
  if (suspended_) return 0;
  bool tuning = std::holds_alternative<heat::RelayControl>(control());
  return tuning && terms().d < 0 ? 0 : target_;
}

}  // namespace passo::wire
