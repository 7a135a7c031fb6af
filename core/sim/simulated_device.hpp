// A simulated board on a test bench: a device with its surroundings, and the interface of tests to
// it.
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

// Steps that come at regular times: step k at start + k*interval + add*k*(k-1)/2, k = 1…count.
struct StepRun {
  Ticks start, end;  // clock of the step before the first, and of the last
  uint32_t interval;
  uint16_t count;
  int16_t add;
  int8_t dir;  // +1 or -1

  Ticks at(int64_t k) const { return start + k * int64_t(interval) + add * (k * (k - 1) / 2); }
  // Number of steps done at `clock`.
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
  // Its steps after the first `from`, up to step `to`.
  StepRun part(int64_t from, int64_t to) const {
    return {at(from), at(to), uint32_t(int64_t(interval) + add * from), uint16_t(to - from),
            add,      dir};
  }
};

struct PinChange {
  Ticks clock;
  uint32_t value;
};

// The board has no such motor or output.
struct UnknownPin : std::out_of_range {
  using std::out_of_range::out_of_range;
};

// Motors and outputs by the numbers of their pins; throws UnknownPin.
class Bench : public Device {
 public:
  Bench(double clock_hz, uint32_t adc_max, Ticks start)
      : plant_(clock_hz, adc_max, start), now_(start) {}
  // Parts of the plant may hold what follows motors of this board, which are gone by now.
  ~Bench() override { self_.reset(); }

  Plant& plant() { return plant_; }
  Ticks now() const { return now_; }

  // Why it is shut down, or "". Frames executed and refused.
  virtual std::string fault() const = 0;
  virtual uint64_t frames() const = 0;
  virtual uint64_t naks() const = 0;

  // Steps forward minus steps backward until now, and steps both ways.
  virtual int64_t net_steps(uint32_t step_pin) = 0;
  virtual int64_t steps(uint32_t step_pin) = 0;
  // Keeps the steps that are executed within from…to, for take_steps().
  virtual void trace_steps(uint32_t step_pin, Ticks from, Ticks to) = 0;
  virtual std::vector<StepRun> take_steps(uint32_t step_pin) = 0;
  // Keeps executed steps from now on for take_followed(), or ends that; independent of tracing, and
  // a reset of the board does not end it.
  virtual void follow_steps(uint32_t step_pin, bool on) = 0;
  // Steps executed since the last call up to a clock, to the step. Clocks do not decrease.
  virtual std::vector<StepRun> take_followed(uint32_t step_pin, Ticks until) = 0;
  virtual uint32_t output_value(uint32_t pin) = 0;
  virtual void trace_output(uint32_t pin) = 0;
  virtual std::vector<PinChange> take_changes(uint32_t pin) = 0;

  // Actuator position of a motor (mm or degrees) now.
  double position(uint32_t step_pin) { return plant_.position(step_pin, net(step_pin)); }
  // A motor on another board, whose actuator triggers the endstops of this board like that of
  // `step_pin`. Whenever this board samples an endstop, both boards are at the same time, to within
  // one sampling interval. A motor of a removed board has no effect any more.
  void feel(uint32_t step_pin, Bench& board, uint32_t its_step_pin);
  // Empty once the board is removed.
  std::weak_ptr<Bench*> handle() const { return self_; }
  // Moves a motor's actuator, as if by hand.
  void place(uint32_t step_pin, double position);

 private:
  std::shared_ptr<Bench*> self_ = std::make_shared<Bench*>(this);
  std::map<uint32_t, std::pair<std::weak_ptr<Bench*>, uint32_t>> elsewhere_;
  double felt(uint32_t step_pin);
  const Plant::Position felt_ = [this](uint32_t step_pin) { return felt(step_pin); };

 protected:
  Plant plant_;
  Ticks now_;

  // As net_steps(); 0 for a motor that is not configured yet.
  virtual int64_t net(uint32_t step_pin) = 0;
  bool level(uint32_t pin, Ticks clock);
  void look() {
    if (plant_.next_look() <= now_) plant_.look(now_, felt_);
  }
};

}  // namespace passo::wire
