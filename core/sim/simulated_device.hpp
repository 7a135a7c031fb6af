// The common interface of simulated boards for tests: a device with its simulated printer.
#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "link/device.hpp"
#include "sim/plant.hpp"

namespace passo::wire {

// Steps with regular times: step k, k = 1…count, is at start + k*interval + add*k*(k-1)/2.
struct StepRun {
  Ticks start, end;  // clock of the step before the first one; clock of the last step
  uint32_t interval;
  uint16_t count;
  int16_t add;
  int8_t dir;  // +1 or -1

  Ticks at(int64_t k) const { return start + k * int64_t(interval) + add * (k * (k - 1) / 2); }
  // Number of steps executed up to `clock`.
  int64_t done(Ticks clock) const {
    int64_t low = 0, high = count;
    while (low < high) {
      int64_t middle = (low + high + 1) / 2;
      if (at(middle) <= clock)
        low = middle;
      else
        high = middle - 1;
    }
    return low;
  }
  // The steps after number `from`, up to number `to`.
  StepRun part(int64_t from, int64_t to) const {
    return {at(from), at(to), uint32_t(int64_t(interval) + add * from), uint16_t(to - from),
            add,      dir};
  }
};

struct PinChange {
  Ticks clock;
  uint32_t value;
};

// The board has no motor or output on this pin.
struct UnknownPin : std::out_of_range {
  using std::out_of_range::out_of_range;
};

// Motors and outputs are named by their pins. Functions throw UnknownPin for other pins.
class Bench : public Device {
 public:
  Bench(double clock_hz, uint32_t adc_max, Ticks start)
      : plant_(clock_hz, adc_max, start), now_(start) {}
  // Parts of the plant may refer to this board; from here on their references are empty.
  ~Bench() override { self_.reset(); }

  Plant& plant() { return plant_; }
  Ticks now() const { return now_; }

  // fault(): reason of a shutdown, or "". frames(), naks(): number of frames executed and refused.
  virtual std::string fault() const = 0;
  virtual uint64_t frames() const = 0;
  virtual uint64_t naks() const = 0;

  // net_steps(): steps forward minus steps backward. steps(): all steps.
  virtual int64_t net_steps(uint32_t step_pin) = 0;
  virtual int64_t steps(uint32_t step_pin) = 0;
  // Keeps steps that are executed between `from` and `to`, for take_steps().
  virtual void trace_steps(uint32_t step_pin, Ticks from, Ticks to) = 0;
  virtual std::vector<StepRun> take_steps(uint32_t step_pin) = 0;
  // Starts or stops keeping executed steps for take_followed(). This is independent of tracing, and
  // continues after a reset of the board.
  virtual void follow_steps(uint32_t step_pin, bool on) = 0;
  // Steps executed from the last call up to `until`, which must not decrease from call to call.
  virtual std::vector<StepRun> take_followed(uint32_t step_pin, Ticks until) = 0;
  virtual uint32_t output_value(uint32_t pin) = 0;
  virtual void trace_output(uint32_t pin) = 0;
  virtual std::vector<PinChange> take_changes(uint32_t pin) = 0;

  // Position of a motor's actuator now, mm or degrees.
  double position(uint32_t step_pin) { return plant_.position(step_pin, net(step_pin)); }
  // Connects a motor of another board: its actuator triggers endstops of this board in place of
  // that of `step_pin`. When this board samples an endstop, the time of both boards must be equal
  // within one sampling interval. If the other board is removed, the connection ends.
  void feel(uint32_t step_pin, Bench& board, uint32_t its_step_pin);
  // A reference to this board. It is empty after the board is removed.
  std::weak_ptr<Bench*> handle() const { return self_; }
  // Moves a motor's actuator, as if by hand.
  void place(uint32_t step_pin, double position);
  // The height of the nozzle above the bed at the place of the probe on this pin, mm.
  double gap(uint32_t probe_pin) { return plant_.gap(probe_pin, felt_); }

 private:
  std::shared_ptr<Bench*> self_ = std::make_shared<Bench*>(this);
  std::map<uint32_t, std::pair<std::weak_ptr<Bench*>, uint32_t>> elsewhere_;
  double felt(uint32_t step_pin);
  const Plant::Position felt_ = [this](uint32_t step_pin) { return felt(step_pin); };

 protected:
  Plant plant_;
  Ticks now_;

  // Like net_steps(), but 0 for a motor that is not configured yet.
  virtual int64_t net(uint32_t step_pin) = 0;
  bool level(uint32_t pin, Ticks clock);
  void look() {
    if (plant_.next_look() <= now_) plant_.look(now_, felt_);
  }
};

}  // namespace passo::wire
