// Stall detection of simulated motor drivers: the load value of a chip depends on the speed of its
// motor, the load, the current and noise, and the DIAG pin shows when it falls below the threshold.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "link/device.hpp"
#include "sim/trinamic.hpp"

namespace passo::wire {

// A mechanical stop for the weighted sum of some actuators' positions. A motor that pushes against
// it makes no way: it loses steps.
struct TravelStop {
  std::vector<std::pair<uint32_t, double>> weights;  // step pin, weight
  double position;
  bool at_maximum;
};

class StallSensor {
 public:
  static constexpr double kSampleSeconds = 0.001;
  // The flag stays after the last full step, for so long.
  static constexpr double kLatchSeconds = 2.0;

  // The load of free travel, as a fraction of the torque with full current, and the noise of the
  // load value, as a fraction.
  double friction = 0.06, noise = 0.04;
  // A fault: the pin shows a stall all the time.
  bool stuck = false;

  // `output`: which of the chip's DIAG pins, 0 or 1; a chip with one has no number.
  StallSensor(std::shared_ptr<TrinamicChip> chip, uint32_t step_pin, uint32_t diag_pin, int output)
      : chip_(std::move(chip)), step_pin_(step_pin), diag_pin_(diag_pin), output_(output) {}

  uint32_t step_pin() const { return step_pin_; }
  uint32_t diag_pin() const { return diag_pin_; }
  bool level() const;
  uint32_t result() const { return result_; }
  uint32_t stalls() const { return stalls_; }

  // The motor has moved by these microsteps since the last sample; `blocked`: against a stop.
  void look(double microsteps, bool blocked);

 private:
  static constexpr size_t kWindow = 16;  // samples of the speed
  static constexpr double kFullStepsPerTurn = 200;
  // The load value rises with the speed v, in turns/s, as v k / (v k + 1).
  static constexpr double kRise = 3;

  std::shared_ptr<TrinamicChip> chip_;
  uint32_t step_pin_, diag_pin_;
  int output_;
  std::array<double, kWindow> moved_{};
  size_t next_ = 0;
  double within_full_step_ = 0, rest_s_ = 0;
  bool blocked_ = false, stalled_ = false;
  uint32_t result_ = 0, stalls_ = 0, random_ = 1;

  using Kind = TrinamicChip::Kind;
  bool by_silent_mode() const {
    return chip_->kind() == Kind::tmc2209 || chip_->kind() == Kind::tmc2226;
  }
  double clock_hz() const;
  double current_share() const;
  double random();
  void full_step(double full_steps_s);
  bool within_window(double tstep) const;
};

}  // namespace passo::wire
