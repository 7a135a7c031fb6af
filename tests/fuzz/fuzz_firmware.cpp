// The firmware behind its wire: frames good and bad, commands in any order with any arguments, time
// that passes between them. Whatever happened, all that it says is in good frames, and it must
// answer and obey a reset.
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "declared.h"
#include "host.h"
#include "link/frame.hpp"

namespace {

using passo::wire::append_frame;
using passo::wire::Bytes;

const host_functions* firmware = passo_firmware();
int64_t now, reached;  // reached: what the firmware has lived through

void edge(void*, uint16_t, bool, int64_t clock) {
  if (clock < reached) std::abort();
}
void output(void*, uint16_t, uint32_t value, uint32_t full, int64_t clock) {
  if (value > full || clock < reached) std::abort();
}
bool level(void*, uint16_t pin, int64_t clock) { return (clock >> 14 ^ pin) & 1; }
uint16_t analog(void*, uint16_t pin, int64_t clock) { return uint16_t((clock >> 16) + pin) & 1023; }

bool lights(void*, uint16_t, const uint8_t*, uint16_t, int64_t clock) { return clock >> 20 & 1; }

// Listens; returns how many bytes the firmware has said.
size_t heard() {
  size_t size;
  const uint8_t* said = firmware->take(&size);
  passo::wire::Scanner().feed(
      said, size, [](uint8_t, const uint8_t*, size_t) {}, [] { std::abort(); });
  return size;
}

// Sends a payload in the frame that is expected next.
void tell(const uint8_t* payload, size_t size) {
  Bytes frame;
  append_frame(frame, payload, std::min(size, passo::wire::kPayloadMax), firmware->state().frames);
  firmware->feed(frame.data(), frame.size(), now);
}

// A configured board, so that most commands find their object.
void configure() {
  struct Line {
    uint32_t command;
    std::vector<uint32_t> values;
  };
  static const std::vector<Line> lines = {{COMMAND_ALLOCATE_OIDS, {17}},
                                          {COMMAND_CONFIG_STEPPER, {0, 1, 2, 0, 32}},
                                          {COMMAND_CONFIG_STEPPER, {1, 3, 4, 1, 0}},
                                          {COMMAND_CONFIG_DIGITAL_OUT, {2, 5, 0, 0, 0}},
                                          {COMMAND_CONFIG_DIGITAL_OUT, {3, 6, 0, 0, 200000}},
                                          {COMMAND_CONFIG_PWM_OUT, {4, 7, 1000, 0, 0, 300000}},
                                          {COMMAND_CONFIG_ANALOG_IN, {5, 8}},
                                          {COMMAND_CONFIG_ENDSTOP, {6, 9, 1}},
                                          {COMMAND_CONFIG_TRSYNC, {7}},
                                          {COMMAND_SET_DIGITAL_OUT_PWM_CYCLE, {3, 5000}},
                                          {COMMAND_STEPPER_STOP_ON_TRIGGER, {0, 7}},
                                          {COMMAND_CONFIG_BUTTONS, {8, 4}},
                                          {COMMAND_BUTTONS_ADD, {8, 0, 10, 1}},
                                          {COMMAND_CONFIG_SPI, {9, 11, 0}},
                                          {COMMAND_SPI_SET_SW_BUS, {9, 12, 13, 14, 3, 16}},
                                          {COMMAND_CONFIG_TMCUART, {10, 15, 1, 15, 400}},
                                          {COMMAND_CONFIG_TMCUART, {11, 16, 0, 17, 101}},
                                          {COMMAND_CONFIG_I2C, {12}},
                                          {COMMAND_I2C_SET_SW_BUS, {12, 18, 19, 16, 72}},
                                          {COMMAND_CONFIG_THERMOCOUPLE, {13, 9, 2}},
                                          {COMMAND_CONFIG_ADXL345, {14, 9}},
                                          {COMMAND_CONFIG_LIS2DW, {15, 9, 0, 0}},
                                          {COMMAND_CONFIG_LIS2DW, {16, 12, 1, 0}},
                                          {COMMAND_FINALIZE_CONFIG, {1}}};
  for (const Line& line : lines) {
    uint8_t payload[64], *end = passo::wire::put_vlq(payload, line.command);
    for (uint32_t v : line.values) end = passo::wire::put_vlq(end, v);
    tell(payload, size_t(end - payload));
  }
  if (firmware->state().reason != 0) std::abort();
}

}  // namespace

// Each piece begins with a byte: what it is, in the lower two bits, and how long, in the others.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const uint8_t dictionary[] = {1, 2, 3};
  const host_options options{16000000, 64, dictionary, sizeof dictionary, (1ll << 32) - 100000};
  const host_surroundings surroundings{nullptr, edge, output, level, analog, lights};
  now = reached = options.start;
  firmware->start(&options, &surroundings);
  if (size > 0 && data[0] & 0x80) configure();
  while (size > 0) {
    size_t n = std::min<size_t>(size - 1, data[0] >> 2);
    if ((data[0] & 3) == 0) {
      firmware->feed(data + 1, n, now);
    } else if ((data[0] & 3) == 1) {
      now += int64_t(n) << 12;
      firmware->run(now);
      reached = now;
    } else {
      tell(data + 1, n);
    }
    heard();
    if ((data[0] & 3) == 1) n = 0;
    data += n + 1;
    size -= n + 1;
  }
  Bytes syncs(64, passo::wire::kSync);
  firmware->feed(syncs.data(), syncs.size(), now);
  heard();
  const uint8_t question[] = {COMMAND_GET_CLOCK}, reset[] = {COMMAND_RESET};
  tell(question, 1);
  if (heard() <= passo::wire::kFrameMin) std::abort();
  tell(reset, 1);
  if (firmware->state().reason != 0 || firmware->state().frames != 0) std::abort();
  return 0;
}
