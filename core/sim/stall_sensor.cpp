#include "sim/stall_sensor.hpp"

#include <algorithm>
#include <cmath>

namespace passo::wire {

namespace {

constexpr uint8_t kGconf = 0x00, kGstat = 0x01, kScaler = 0x0b, kIholdIrun = 0x10, kTpwmthrs = 0x13,
                  kTcoolthrs = 0x14, kThigh = 0x15, kSgthrs = 0x40, kSgResult = 0x41,
                  kChopconf = 0x6c, kCoolconf = 0x6d, kDrvStatus = 0x6f;
constexpr double kTstepMost = 0xfffff;

uint32_t bits(uint32_t value, int low, int width = 1) { return value >> low & ((1u << width) - 1); }

int sgt(uint32_t coolconf) {
  const int value = int(bits(coolconf, 16, 7));
  return value < 64 ? value : value - 128;
}

}  // namespace

bool StallSensor::level() const {
  if (by_silent_mode()) return stuck || stalled_ || bits(chip_->read(kGstat), 1);
  const uint32_t gconf = chip_->read(kGconf);
  const bool active = stuck || (stalled_ && bits(gconf, 7 + output_));
  const bool pushes = bits(gconf, 12 + output_);
  return pushes == active;  // an open drain pulls the line low
}

void StallSensor::look(double microsteps, bool blocked) {
  moved_[next_++ % kWindow] = std::abs(microsteps);
  blocked_ |= blocked;
  const int resolution = 256 >> std::min(bits(chip_->read(kChopconf), 24, 4), 8u);
  double sum = 0;
  for (double by : moved_) sum += by;
  within_full_step_ += std::abs(microsteps) / resolution;
  rest_s_ += kSampleSeconds;
  if (within_full_step_ >= 1) {
    within_full_step_ = std::fmod(within_full_step_, 1);
    rest_s_ = 0;
    full_step(sum / resolution / (kWindow * kSampleSeconds));
    blocked_ = false;
  } else if (rest_s_ > kLatchSeconds) {
    stalled_ = false;
  }
}

void StallSensor::full_step(double full_steps_s) {
  const double turns = full_steps_s / kFullStepsPerTurn;
  const double load = blocked_ ? 1 : std::min(friction / current_share(), 1.0);
  const double free = turns * kRise / (turns * kRise + 1);
  const double share = free * (1 - load) * (1 + noise * random()) + 0.02 + 0.01 * random();
  const double tstep = std::min(clock_hz() / (256 * full_steps_s), kTstepMost);
  const bool was = stalled_;
  if (by_silent_mode()) {
    result_ = uint32_t(510 * share);
    chip_->set(kSgResult, result_);
    stalled_ = within_window(tstep) && result_ <= 2 * bits(chip_->read(kSgthrs), 0, 8);
  } else {
    const double value = 1000 * share - 300 + 20 * sgt(chip_->read(kCoolconf));
    result_ = uint32_t(std::clamp(value, 0.0, 1023.0));
    stalled_ = within_window(tstep) && result_ == 0;
    const uint32_t others = chip_->read(kDrvStatus) & ~0x010003ffu;
    chip_->set(kDrvStatus, others | result_ | uint32_t(stalled_) << 24);
  }
  if (stalled_ && !was) ++stalls_;
}

bool StallSensor::within_window(double tstep) const {
  const uint32_t gconf = chip_->read(kGconf), silent_above = chip_->read(kTpwmthrs);
  const bool slow = silent_above == 0 || tstep > silent_above;
  if (tstep > chip_->read(kTcoolthrs)) return false;
  if (by_silent_mode()) return !bits(gconf, 2) && slow;
  return tstep >= chip_->read(kThigh) && !(bits(gconf, 2) && slow);
}

double StallSensor::clock_hz() const {
  return chip_->kind() == Kind::tmc2130 ? 13.2e6 : chip_->kind() == Kind::tmc2240 ? 12.5e6 : 12e6;
}

double StallSensor::current_share() const {
  double share = (bits(chip_->read(kIholdIrun), 8, 5) + 1) / 32.0;
  if (chip_->kind() == Kind::tmc5160 || chip_->kind() == Kind::tmc2240) {
    const uint32_t scaler = bits(chip_->read(kScaler), 0, 8);
    return share * (scaler == 0 ? 256 : scaler) / 256;
  }
  return bits(chip_->read(kChopconf), 17) ? share * 0.18 / 0.32 : share;
}

double StallSensor::random() {
  random_ = random_ * 1664525u + 1013904223u;
  return double(random_) / 2147483648.0 - 1;
}

}  // namespace passo::wire
