// The heaters of one board, for its link: they receive the reports of the sensors and send
// commands.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "link/clock_sync.hpp"
#include "link/device.hpp"
#include "link/dictionary.hpp"
#include "link/heater.hpp"
#include "link/job_stream.hpp"

namespace passo::wire {

class Heaters {
 public:
  using Send = std::function<void(const std::string&, const std::vector<Value>&)>;

  // The heaters only read the state of the link.
  Heaters(double clock_hz, const Formats& commands, const ClockSync& sync, const JobStream& job,
          Send send)
      : hz_(clock_hz), commands_(commands), sync_(sync), job_(job), send_(std::move(send)) {}

  Heater& add(HeaterOptions options);
  // No heater is still heating or cooling to its target.
  bool reached() const;
  // From now on the board gets the power that keeps each heater warm, in case the host stops
  // sending.
  void keep();
  void tell_kept_again();
  // There were no reports for a time.
  void interrupted();
  // Returns true once after faults.
  bool take_fault() { return std::exchange(fault_, false); }
  // analog_in_state oid next_clock values: next_clock is that of the next report; the newest of the
  // values (16 bits each) counts. Boards with older firmware send one value, as a number.
  // thermocouple_result oid next_clock value fault: a word of a converter.
  bool take(const std::vector<Value>& values, Ticks now);

 private:
  static constexpr double kLeadSeconds = 0.1;  // from a report to the power that it causes
  static constexpr double kKeptStep = 0.02;  // fraction of full power: minimum change that is sent
  static constexpr int64_t kKeptSeconds = 60;

  double hz_;
  const Formats& commands_;
  const ClockSync& sync_;
  const JobStream& job_;
  Send send_;
  std::vector<std::unique_ptr<Heater>> heaters_;
  bool keeps_ = false;
  std::vector<int64_t> kept_;        // values that the board keeps if the host stops sending
  std::vector<Ticks> heater_clock_;  // of the last update sent
  bool fault_ = false;

  uint32_t read_converter(const HeaterOptions& o, uint32_t word, uint32_t faults);
  // Queries the reports of the sensor again; the next one is due at `clock`.
  void query(const HeaterOptions& o, Ticks clock, bool wide, Ticks now);
  void tell_keeping(size_t i, int64_t value);
  void set_power(size_t i, uint32_t value, Ticks now);
  // The parameters of a command, for the oid of an output and its value on the wire.
  using Values = std::function<std::vector<Value>(int64_t, int64_t)>;
  // Sends a command to each output of a heater.
  void send_all(const HeaterOptions& o, const std::string& command, uint32_t value,
                const Values& values);
};

}  // namespace passo::wire
