// A complete board in virtual time: it receives, checks and executes frames, and answers like a
// real board.
#pragma once
#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "link/dictionary.hpp"
#include "link/frame.hpp"
#include "sim/board_buttons.hpp"
#include "sim/board_counter.hpp"
#include "sim/board_io.hpp"
#include "sim/board_motor.hpp"
#include "sim/board_protocol.hpp"
#include "sim/board_serial.hpp"
#include "sim/simulated_device.hpp"

namespace passo::wire {

class VirtualBoard : public Bench {
 public:
  struct Options {
    double clock_hz = 16e6;
    uint32_t move_count = 1024;
    uint32_t adc_max = 1023, pwm_max = 255;
    Bytes identify;   // zlib-compressed dictionary
    Ticks start = 0;  // clock at power-on
  };

  explicit VirtualBoard(Options options);

  uint32_t crc() const { return crc_; }
  std::string fault() const override { return kFaults[size_t(fault_)]; }
  bool stopped() const override { return fault_ != Fault::none; }
  // The maximum number of move queue entries in use, whenever they were counted.
  size_t peak_slots() const { return peak_slots_; }
  uint64_t frames() const override { return frames_; }
  uint64_t naks() const override { return naks_; }

  void feed(const uint8_t* data, size_t n, Ticks now) override;
  void poll(Ticks now, Bytes& out) override;
  Ticks next_deadline() const override { return next_; }

  int64_t net_steps(uint32_t step_pin) override { return motor(step_pin).net_at(now_); }
  int64_t steps(uint32_t step_pin) override { return motor(step_pin).steps_at(now_); }
  void trace_steps(uint32_t step_pin, Ticks from, Ticks to) override;
  std::vector<StepRun> take_steps(uint32_t step_pin) override;
  void follow_steps(uint32_t step_pin, bool on) override;
  std::vector<StepRun> take_followed(uint32_t step_pin, Ticks until) override;
  uint32_t output_value(uint32_t pin) override { return output_on(pin).value(); }
  void trace_output(uint32_t pin) override { output_on(pin).trace(); }
  std::vector<PinChange> take_changes(uint32_t pin) override;

 private:
  using Part = std::variant<BoardMotor, BoardOutput, BoardAnalogIn, BoardEndstop, BoardTrsync,
                            BoardButtons, BoardCounter>;
  static constexpr size_t kParametersMax = 10;
  struct Shape {
    bool known, in_shutdown;
    uint8_t parameters;
    uint8_t blob;                   // number of the parameter that is bytes
    uint32_t most[kParametersMax];  // maximum of each parameter
  };

  const Options options_;
  Scanner scanner_;
  Bytes out_;
  Shape shapes_[size_t(Command::end_)] = {};
  std::map<uint32_t, Part> parts_;  // by oid
  SerialParts serial_;
  struct Timed {
    uint32_t oid;
    Part* part;
  };
  std::vector<Timed> timed_;         // all parts except motors, which are calculated in closed form
  std::vector<BoardMotor*> motors_;  // by oid; null if it is not a motor
  std::vector<BoardOutput*> outputs_;
  std::set<uint32_t> followed_;  // by step pin
  uint64_t sequence_ = 0, frames_ = 0, naks_ = 0;
  Ticks next_ = kNever;
  std::optional<uint32_t> oids_;
  bool finalized_ = false;
  uint32_t crc_ = 0;
  Fault fault_ = Fault::none;
  size_t slots_ = 0, peak_slots_ = 0;  // slots_: upper bound of the entries in use

  // ---- time

  void schedule();
  static Ticks next_of(const Part& part);
  void run_until(Ticks now);
  void run(uint32_t oid, Part& part);

  // ---- commands

  void execute(const uint8_t* payload, size_t size);
  void command(Command id, const uint32_t* a, const Bytes& blob);
  void part_command(Command id, const uint32_t* a);
  void motion_command(Command id, const uint32_t* a);
  // Carries out a command about buttons. Returns false for other commands.
  bool buttons_command(Command id, const uint32_t* a);
  // The same for those of counters.
  bool counter_command(Command id, const uint32_t* a);

  // ---- parts

  void check_oid(uint32_t oid) const;
  template <class T>
  T& configure(uint32_t oid, T part);
  template <class T>
  T& get(uint32_t oid);
  BoardOutput& output(uint32_t oid, bool pwm);
  void queue_output(const uint32_t* a, bool pwm);
  // Takes a move queue entry. The exact number is counted only if the upper bound reaches the
  // limit, because counting is slow.
  void take_slot();
  // Converts a 32-bit clock to a full one. A timer must not be in the past.
  Ticks ahead(uint32_t clock) const;
  // Rejects a period at which a real board would do nothing else, or miss its timers.
  static void check_period(uint32_t ticks);
  void trigger(uint32_t oid, uint32_t reason);
  void report_trsync(uint32_t oid, const BoardTrsync& group);
  int64_t net(uint32_t step_pin) override;
  BoardMotor* find_motor(uint32_t step_pin);
  BoardMotor& motor(uint32_t step_pin);
  BoardOutput& output_on(uint32_t pin);

  // ---- state

  void shut_down(Fault fault);
  void reset();
  void identify(uint32_t offset, uint32_t count);
  Ticks ticks(double seconds) const { return Ticks(seconds * options_.clock_hz); }
  Ticks unwrap(uint32_t clock) const { return now_ + int32_t(clock - uint32_t(uint64_t(now_))); }

  void report(Report id, std::initializer_list<uint32_t> values, const Bytes* blob = nullptr);
};

}  // namespace passo::wire
