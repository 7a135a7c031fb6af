// Hostile bytes at both ends of the wire. The first byte chooses the end and whether the rest is
// raw, or is cut into payloads that arrive in good frames.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "link/link.hpp"
#include "sim/virtual_board.hpp"

using namespace passo::wire;

namespace {

template <class Feed>
void deliver(const uint8_t* data, size_t size, bool framed, uint64_t sequence, Feed&& feed) {
  for (Ticks now = 0; size > 0; ++sequence, now += 1000) {
    size_t n = std::min<size_t>(size, 1 + data[0] % kPayloadMax);
    Bytes bytes;
    if (framed)
      append_frame(bytes, data, n, sequence);
    else
      bytes.assign(data, data + n);
    feed(bytes, now);
    data += n;
    size -= n;
  }
}

// One object of each kind, oids 0 to 5. Returns the number of frames that it took.
uint64_t configure(VirtualBoard& board) {
  const std::vector<std::pair<Command, std::vector<Value>>> lines = {
      {Command::allocate_oids, {6}},
      {Command::config_stepper, {0, 1, 2, 0, 32}},
      {Command::config_endstop, {1, 3, 1}},
      {Command::config_trsync, {2}},
      {Command::config_analog_in, {3, 4}},
      {Command::config_digital_out, {4, 5, 0, 0, 5000}},
      {Command::config_pwm_out, {5, 6, 9, 0, 0, 0}},
      {Command::finalize_config, {1}}};
  uint64_t sequence = 0;
  for (const auto& [command, values] : lines) {
    Bytes payload, bytes;
    for (const Declaration& d : kCommands)
      if (d.id == int32_t(command)) Format(d.id, d.text).encode(values, payload);
    append_frame(bytes, payload.data(), payload.size(), sequence++);
    board.feed(bytes.data(), bytes.size(), 0);
  }
  return sequence;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 2) return 0;
  const bool to_board = data[0] & 1, framed = data[0] & 2;
  if (to_board) {
    VirtualBoard board(VirtualBoard::Options{});
    deliver(data + 1, size - 1, framed, configure(board), [&](const Bytes& bytes, Ticks now) {
      Bytes out;
      board.feed(bytes.data(), bytes.size(), now);
      board.poll(now, out);
    });
    return 0;
  }
  Link link(16e6);
  Formats commands, reports;
  for (const Declaration& d : kCommands) commands.add(d.id, d.text);
  for (const Declaration& d : kReports) reports.add(d.id, d.text);
  link.set_dictionary(commands, reports, 192);
  link.follow_clock(0);
  deliver(data + 1, size - 1, framed, 0, [&](const Bytes& bytes, Ticks now) {
    Bytes out;
    link.poll(now, out);
    link.feed(bytes.data(), bytes.size(), now);
  });
  return 0;
}
