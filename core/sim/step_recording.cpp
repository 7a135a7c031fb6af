#include "sim/step_recording.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace passo::wire {

StepRecording::StepRecording(const Formats& commands, const uint8_t* data, size_t size) {
  Scanner scanner;
  size_t bad = 0, good = 0;
  scanner.feed(
      data, size,
      [&](uint8_t, const uint8_t* payload, size_t n) {
        ++good;
        read(commands, payload, n);
      },
      [&] { ++bad; });
  if (good == 0) throw std::invalid_argument("it has no frames");
  if (bad > 0) throw std::invalid_argument(std::to_string(bad) + " pieces of it are no frames");
}

std::vector<StepRun> StepRecording::last(size_t motor, int64_t steps) const {
  const std::vector<StepRun>& all = motors_.at(motor).runs;
  std::vector<StepRun> found;
  for (auto run = all.rbegin(); run != all.rend() && steps > 0; ++run) {
    const int64_t taken = std::min<int64_t>(steps, run->count);
    found.push_back(run->part(run->count - taken, run->count));
    steps -= taken;
  }
  std::reverse(found.begin(), found.end());
  return found;
}

std::vector<StepRun> StepRecording::since(size_t motor, Ticks clock) const {
  const std::vector<StepRun>& all = motors_.at(motor).runs;
  auto first = std::find_if(all.begin(), all.end(),
                            [clock](const StepRun& run) { return run.start >= clock; });
  return {first, all.end()};
}

StepRecording::Range StepRecording::range_of(const std::vector<StepRun>& runs) {
  Range range;
  for (const StepRun& run : runs) {
    range.net += run.dir * int64_t(run.count);
    range.lowest = std::min(range.lowest, range.net);
    range.highest = std::max(range.highest, range.net);
  }
  return range;
}

void StepRecording::read(const Formats& commands, const uint8_t* payload, size_t size) {
  Reader in{payload, payload + size};
  std::vector<Value> values;
  while (in.more()) {
    const Format* format = commands.find(int32_t(in.vlq()));
    if (!format) throw std::invalid_argument("it has a command that the dictionary lacks");
    format->decode(in, values);
    if (!in.ok) throw std::invalid_argument(format->name + " is cut short");
    auto value = [&](size_t i) {
      const int64_t* number = i < values.size() ? std::get_if<int64_t>(&values[i]) : nullptr;
      if (!number) throw std::invalid_argument(format->name + " has other words than Klipper's");
      return uint32_t(*number);
    };
    if (format->name == "queue_step")
      queue(motor(value(0)), value(1), uint16_t(value(2)), int16_t(value(3)));
    else if (format->name == "set_next_step_dir")
      motor(value(0)).dir = value(1) ? 1 : -1;
    else if (format->name == "reset_step_clock")
      motor(value(0)).clock = latest_ + int32_t(value(1) - uint32_t(uint64_t(latest_)));
    else if (format->name == "config_stepper")
      motors_.push_back({value(0), value(1), {}});
  }
}

StepRecording::Motor& StepRecording::motor(uint32_t oid) {
  for (Motor& motor : motors_)
    if (motor.oid == oid) return motor;
  throw std::invalid_argument("it moves a motor that it has not configured");
}

void StepRecording::queue(Motor& motor, uint32_t interval, uint16_t count, int16_t add) {
  if (count == 0) throw std::invalid_argument("a command has no steps");
  StepRun run{motor.clock, 0, interval, count, add, motor.dir};
  run.end = run.at(count);
  motor.runs.push_back(run);
  motor.steps += count;
  motor.clock = run.end;
  latest_ = std::max(latest_, run.end);
}

}  // namespace passo::wire
