// A link with a job, a simulated board, and a cable between them on which bytes are lost, spoilt
// and added, while time passes, the link is opened anew and further commands are sent. As long as
// the cable is good every step is made; afterwards nothing but an orderly end may come of it.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <utility>
#include <vector>

#include "link/link.hpp"
#include "sim/virtual_board.hpp"

using namespace passo;
using namespace passo::wire;

namespace {

constexpr double kHz = 16e6;
constexpr Ticks kStart = (Ticks(1) << 32) - Ticks(kHz);  // its 32 bits overflow after a second
constexpr Ticks kLead = Ticks(0.4 * kHz), kMoment = Ticks(0.002 * kHz);
constexpr uint32_t kStepPin[] = {1, 3};
constexpr size_t kSlots = 64;

template <size_t n>
Formats formats(const Declaration (&list)[n]) {
  Formats all;
  for (const Declaration& d : list) all.add(d.id, d.text);
  return all;
}

struct Setup {
  VirtualBoard board{{kHz, kSlots, 1023, 255, {1, 2, 3}, kStart}};
  Link link{kHz};
  MessageQueue queue;
  Ticks now = kStart, base = 0, last[2] = {0, 0};
  int64_t net[2] = {0, 0};
  bool good = true;  // the cable so far
  Bytes spoil_down, spoil_up;

  Setup() {
    link.set_dictionary(formats(kCommands), formats(kReports), 192);
    const std::vector<std::pair<const char*, std::vector<Value>>> lines = {
        {"allocate_oids", {6}},
        {"config_stepper", {0, 1, 2, 0, 32}},
        {"config_stepper", {1, 3, 4, 0, 32}},
        {"config_digital_out", {2, 5, 0, 0, 0}},
        {"config_analog_in", {3, 6}},
        {"config_endstop", {4, 7, 1}},
        {"config_trsync", {5}},
        {"finalize_config", {1}}};
    for (const auto& [name, values] : lines) link.send(name, values);
    link.follow_clock(now);
    run(kLead);
    for (size_t i = 0; i < 2; ++i)
      link.job().add_stepper(link.commands(), i, i ? "y" : "x", uint32_t(i), false);
    link.job().add_pin(link.commands(), 0, "fan", 2, PinKind::digital, 0, 0);
    link.job().set_slots(kSlots);
    link.set_queue(&queue);
    base = now + kLead;
    link.start_job(base, kHz);
    run(kMoment);
    if (board.stopped()) std::abort();
  }

  // Carries bytes until so many ticks have passed.
  void run(Ticks ticks) {
    const Ticks until = now + ticks;
    for (;;) {
      Bytes down, up;
      Ticks next = link.poll(now, down);
      spoil(down, spoil_down);
      if (!down.empty()) board.feed(down.data(), down.size(), now);
      board.poll(now, up);
      spoil(up, spoil_up);
      if (!up.empty()) {
        link.feed(up.data(), up.size(), now);
        continue;
      }
      next = std::min(next, board.next_deadline());
      if (next <= now) next = now + 1;
      if (now == until) break;
      now = std::min(next, until);
    }
  }
  // Every byte of `by` that is not 0 changes one, or takes it away.
  void spoil(Bytes& bytes, Bytes& by) {
    if (bytes.empty() || by.empty()) return;
    Bytes out;
    for (size_t i = 0; i < bytes.size(); ++i) {
      uint8_t change = i < by.size() ? by[i] : 0;
      good = good && change == 0;
      if (change != 0xff) out.push_back(bytes[i] ^ change);
    }
    bytes = std::move(out);
    by.clear();
  }
  void move(size_t motor, bool forward, uint32_t interval, uint16_t count) {
    // A motor that is due later would have to wait in the queue for one that is due sooner.
    Ticks start = std::max({last[0], last[1], now - base + kLead});
    Ticks gap = start - last[motor];
    push(motor, forward, uint32_t(gap), 1);
    push(motor, forward, interval, count);
  }

 private:
  void push(size_t motor, bool forward, uint32_t interval, uint16_t count) {
    Ticks begin = last[motor], end = begin + Ticks(interval) * count;
    Ticks due = begin + interval - kLead / 4;
    due = std::max(due, queue.empty() ? due : queue[queue.size() - 1].clock);
    auto target = uint16_t(motor);
    queue.push({due, due, 0, 0, 0, target, MessageKind::set_dir, forward});
    queue.push({due, end, interval, count, 0, target, MessageKind::queue_step, forward});
    last[motor] = end;
    net[motor] += forward ? count : -int64_t(count);
  }
};

}  // namespace

// Each piece begins with a byte: what it is, in the lower three bits, and how much, in the others.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  Setup s;
  bool whole = true;  // nothing but moves and time so far
  try {
    for (size_t moves = 0; size > 0;) {
      const uint8_t what = data[0] & 7, much = data[0] >> 3;
      ++data, --size;
      const size_t n = std::min<size_t>(size, much);
      size_t used = 0;
      if (what <= 1) {
        s.run(kMoment << (much >> 2));
      } else if (what == 2) {
        if (++moves <= kSlots / 8)
          s.move(much & 1, much & 2, 2000 + 500 * much, uint16_t(1 + much));
      } else if (what == 3) {
        s.spoil_down.assign(data, data + (used = n));
      } else if (what == 4) {
        s.spoil_up.assign(data, data + (used = n));
      } else if (what == 5) {
        whole = false;
        s.link.feed(data, used = n, s.now);
      } else if (what == 6) {
        whole = false;
        s.board.feed(data, used = n, s.now);
      } else {
        whole = false;
        if (much & 1)
          s.link.reconnect(), s.link.resume();
        else
          s.link.send("update_digital_out", {2, int64_t(much & 2)});
      }
      data += used;
      size -= used;
    }
    s.run(std::max(s.last[0], s.last[1]) + s.base - s.now + kLead);
  } catch (const std::runtime_error&) {
    return 0;  // a report that cannot be used
  }
  if (whole && s.good) {
    if (s.board.stopped() || s.link.lost() || !s.link.delivered()) std::abort();
    for (size_t i = 0; i < 2; ++i)
      if (s.board.net_steps(kStepPin[i]) != s.net[i]) std::abort();
  }
  return 0;
}
