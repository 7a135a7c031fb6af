// Links and devices in one process, in virtual time: from deadline to deadline, as fast as the
// computer can.
#pragma once
#include <cmath>
#include <vector>

#include "link/device.hpp"
#include "link/link.hpp"
#include "link/stop_reason.hpp"

namespace passo::wire {

class Pump {
 public:
  // Host time equals the first device's clock and begins at `start`.
  // `cpu_clock` gives CPU seconds, or is null.
  Pump(Link& link, Device& device, Ticks start, double (*cpu_clock)() = nullptr);
  // Adds a device, or another link to a device. Host time is the device's clock, in ticks of the
  // link's frequency.
  void attach(Link& link, Device& device);

  Ticks now() const { return now_; }
  double hz() const { return ends_[0].link->hz(); }
  // The clock of a link's board, as estimated.
  Ticks board_clock(const Link& link) const;
  // Cuts the cables: no byte arrives any more.
  void cut() { cut_ = true; }
  // The host does nothing until then; the boards continue.
  void sleep(Ticks until);
  // Runs until then, even if boards stop: boards that are shut down still measure temperatures.
  void stand_by(Ticks until);
  // The devices' part of run()'s CPU time, from one exchange in kSample.
  double device_share() const;
  // From now on records the bytes that the host sends to the first board, in frames.
  void record(bool on);
  Bytes& recorded() { return recorded_; }

  // Runs until virtual time reaches `until`; until all boards have stopped, or one has stopped so
  // long ago that the others should have stopped too; until a heater fails; or, if requested, until
  // no heater is still heating or cooling to its target. The queue of the job must already hold all
  // messages whose clock is below `until` plus the horizon.
  Stop run(Ticks until, bool until_heaters);

 private:
  struct End {
    Link* link;
    Device* device;
    double ratio;  // its ticks per tick of the first one
    Bytes down, up;

    Ticks own(Ticks host) const { return ratio == 1 ? host : Ticks(double(host) * ratio); }
    Ticks host(Ticks own) const {
      return ratio == 1 || own == kNever ? own : Ticks(std::ceil(double(own) / ratio));
    }
  };
  // The next time at which a link or a device has something to do, after all that is due now.
  Ticks next();
  // Lets time pass to `next`, or only to `until`: true if that is earlier.
  bool arrive(Ticks next, Ticks until);

  std::vector<End> ends_;
  Ticks now_;
  Bytes recorded_;
  bool recording_ = false, cut_ = false;
  static constexpr unsigned kSample = 101;
  static constexpr double kNewsSeconds = 0.05;
  double (*cpu_clock_)();
  unsigned exchanges_ = 0;
  double device_cpu_ = 0, link_cpu_ = 0;

  // Carries bytes until none move: a message on one link may cause a message to another board.
  // Returns the links' next deadline.
  Ticks exchange();
  Ticks exchange(End& end, bool& moved);
  double clock(bool sampled) const { return sampled ? cpu_clock_() : 0; }
};

}  // namespace passo::wire
