// Converts messages of the timeline to the clock of one further board.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "link/time_map.hpp"
#include "steps/message_queue.hpp"

namespace passo {
class Stabbing;
}

namespace passo::wire {

// Step k of a message is due at a tick of the main board's clock. It gets the tick of its own
// board's clock at the same instant, rounded within a window as by the compressor. One message
// becomes one or more messages.
class Retimer {
 public:
  // The minimum distance of a motor's steps in ticks of this board: in one direction, and at a
  // reversal.
  struct Apart {
    double least = 1, turning = 1;
  };

  explicit Retimer(double tolerance);
  ~Retimer();

  TimeMap& map() { return map_; }
  void set_apart(size_t stepper, Apart apart);
  // The job begins; a tick of its clock is `ratio` ticks here, nominally.
  void start(double job_hz, double ratio);
  // The messages taken so far are void: all motors are at standstill, and their clocks are set
  // again.
  void restart();
  int64_t clock_of(int64_t clock) const;

  // Returns the messages for the board from those taken so far.
  MessageQueue& ready() { return ready_; }

  void retime(const Message& m);

 private:
  // Of a motor, up to its last step.
  struct Progress {
    int64_t planned = 0;  // clock of that step on the timeline
    int64_t last = 0;     // and on this board
    bool turning = false;
    uint8_t dir = 0;

    void reset(int64_t at, int64_t here) {
      planned = at;
      last = here;
    }
  };
  struct Motor {
    Apart apart;
    Progress progress{};
    // While a tail is being sent: its commit is always later, because revoked messages are later
    // than all messages taken so far.
    std::optional<Progress> tail{};

    Motor() = default;
    explicit Motor(Apart a) : apart(a) {}
  };

  double tolerance_;
  TimeMap map_;
  std::vector<Motor> motors_;
  MessageQueue ready_;
  std::unique_ptr<Stabbing> stabbing_;
  std::vector<double> times_, lo_, hi_, executed_;

  // A tail continues from the last step before it, and is sent at the clock of its commit. Without
  // steps it sets the motor's clock.
  void tail(const Message& m);

  void steps(const Message& m, Progress& motor);
};

}  // namespace passo::wire
