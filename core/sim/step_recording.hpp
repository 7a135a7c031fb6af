// The steps in a recorded stream for one board, as Klipper's batch mode writes it.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "link/dictionary.hpp"
#include "sim/simulated_device.hpp"

namespace passo::wire {

class StepRecording {
 public:
  struct Motor {
    uint32_t oid, step_pin;
    std::vector<StepRun> runs;  // in the order of their clocks
    int64_t steps = 0;
    // For the next command.
    Ticks clock = 0;
    int8_t dir = -1;
  };
  struct Range {
    int64_t net = 0, lowest = 0, highest = 0;  // steps, relative to the start
  };

  // Throws std::invalid_argument if the bytes are not a stream of these commands.
  StepRecording(const Formats& commands, const uint8_t* data, size_t size);

  const std::vector<Motor>& motors() const { return motors_; }
  // The last `steps` steps of a motor. range_of(): net steps and extremes of a series of steps.
  std::vector<StepRun> last(size_t motor, int64_t steps) const;
  // Commands of a motor that start at `clock` or later.
  std::vector<StepRun> since(size_t motor, Ticks clock) const;
  static Range range_of(const std::vector<StepRun>& runs);

 private:
  std::vector<Motor> motors_;
  Ticks latest_ = 0;

  void read(const Formats& commands, const uint8_t* payload, size_t size);
  Motor& motor(uint32_t oid);
  void queue(Motor& motor, uint32_t interval, uint16_t count, int16_t add);
};

}  // namespace passo::wire
