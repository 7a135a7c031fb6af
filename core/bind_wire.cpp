// Python's view of frames, the link, the virtual board and the pump between them.
#include <nanobind/nanobind.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <stdexcept>

#include "cpu_clock.hpp"
#include "message_queue.hpp"
#include "wire/distant.hpp"
#include "wire/firmware_board.hpp"
#include "wire/live_board.hpp"
#include "wire/live_wire.hpp"
#include "wire/pump.hpp"
#include "wire/virtual_board.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;
using namespace passo::wire;

namespace {

using FormatList = std::vector<std::pair<int32_t, std::string>>;
using Points = std::vector<std::pair<double, double>>;
using NameValue = std::pair<std::string, nb::dict>;

const uint8_t* data_of(const nb::bytes& b) { return reinterpret_cast<const uint8_t*>(b.c_str()); }
nb::bytes to_bytes(const void* data, size_t size) {
  return nb::bytes(static_cast<const char*>(data), size);
}
Bytes from_bytes(const nb::bytes& b) { return Bytes(data_of(b), data_of(b) + b.size()); }

Formats make_formats(const FormatList& list) {
  Formats formats;
  for (const auto& [id, text] : list) formats.add(id, text);
  return formats;
}
std::vector<Value> to_values(const nb::list& list) {
  std::vector<Value> values;
  for (nb::handle item : list) {
    if (nb::isinstance<nb::bytes>(item)) {
      auto blob = nb::cast<nb::bytes>(item);
      values.emplace_back(std::string(blob.c_str(), blob.size()));
    } else {
      values.emplace_back(nb::cast<int64_t>(item));
    }
  }
  return values;
}
nb::dict to_dict(const Format& format, const std::vector<Value>& values) {
  nb::dict dict;
  for (size_t i = 0; i < values.size(); ++i) {
    const auto& name = format.parameters[i].name;
    if (const auto* number = std::get_if<int64_t>(&values[i]))
      dict[name.c_str()] = *number;
    else
      dict[name.c_str()] = to_bytes(std::get<std::string>(values[i]).data(),
                                    std::get<std::string>(values[i]).size());
  }
  return dict;
}

FormatList declarations(const Declaration* begin, const Declaration* end) {
  FormatList list;
  for (; begin != end; ++begin) list.emplace_back(begin->id, begin->text);
  return list;
}

nb::bytes vlq(int64_t value) {
  uint8_t plain[kVlqMax], any[kVlqRoom];
  uint8_t *end = put_vlq(plain, uint32_t(value)), *same = put_vlq_any(any, uint32_t(value));
  if (!std::equal(plain, end, any, same)) throw std::logic_error("two encodings of one integer");
  return to_bytes(plain, size_t(end - plain));
}
std::pair<int64_t, size_t> read_vlq(const nb::bytes& data) {
  Reader in{data_of(data), data_of(data) + data.size()};
  uint32_t value = in.vlq();
  if (!in.ok) throw nb::value_error("no complete variable length quantity");
  return {int64_t(int32_t(value)), size_t(in.p - data_of(data))};
}
nb::bytes make_frame(const nb::bytes& payload, uint64_t sequence) {
  if (payload.size() > kPayloadMax) throw nb::value_error("a payload has at most 59 bytes");
  Bytes out;
  append_frame(out, data_of(payload), payload.size(), sequence);
  return to_bytes(out.data(), out.size());
}
nb::list scan(Scanner& scanner, const nb::bytes& data) {
  nb::list frames;
  scanner.feed(
      data_of(data), data.size(),
      [&](uint8_t sequence, const uint8_t* payload, size_t size) {
        frames.append(nb::make_tuple(int(sequence), to_bytes(payload, size)));
      },
      [&] { frames.append(nb::none()); });
  return frames;
}
nb::list decode_payload(const Formats& formats, const nb::bytes& payload) {
  nb::list messages;
  Reader in{data_of(payload), data_of(payload) + payload.size()};
  while (in.more()) {
    const Format* format = formats.find(int32_t(in.vlq()));
    if (!format) throw nb::value_error("unknown message id");
    std::vector<Value> values;
    format->decode(in, values);
    if (!in.ok) throw nb::value_error("message cut short");
    messages.append(nb::make_tuple(format->name, to_dict(*format, values)));
  }
  return messages;
}

void bind_frames(nb::module_& m) {
  m.def(
      "crc16", [](const nb::bytes& data) { return Crc16::of(data_of(data), data.size()); },
      "data"_a, "CRC-16/MCRF4XX of the bytes.");
  m.def("encode_vlq", &vlq, "value"_a, "Encodes a 32-bit value (modulo 2^32) in 1 to 5 bytes.");
  m.def("decode_vlq", &read_vlq, "data"_a,
        "Returns (signed value, bytes used). ValueError if cut short.");
  m.def("make_frame", &make_frame, "payload"_a, "sequence"_a);
  m.def("board_commands", [] { return declarations(std::begin(kCommands), std::end(kCommands)); });
  m.def("board_reports", [] { return declarations(std::begin(kReports), std::end(kReports)); });
  m.def(
      "board_faults",
      [] { return std::vector<std::string>(std::begin(kFaults), std::end(kFaults)); },
      "Texts of the virtual board's shutdown reasons, by static_string_id.");
  nb::class_<Scanner>(m, "FrameScanner", "Finds frames in bytes cut anywhere.")
      .def(nb::init<>())
      .def("feed", &scan, "data"_a,
           nb::sig("def feed(self, data: bytes) -> list[tuple[int, bytes] | None]"),
           "List of (sequence, payload) for each good frame and None for each stretch that is "
           "none.");
  nb::class_<Formats>(m, "Formats",
                      "Messages of one direction, as a data dictionary declares them.")
      .def(
          "__init__",
          [](Formats* self, const FormatList& list) { new (self) Formats(make_formats(list)); },
          "formats"_a)
      .def(
          "parameters",
          [](const Formats& f, const std::string& name) {
            std::vector<std::pair<std::string, bool>> list;
            for (const Parameter& p : f.at(name).parameters)
              list.emplace_back(p.name, p.type == Type::blob);
            return list;
          },
          "name"_a, "List of (parameter, is a blob). ValueError for an unknown message.")
      .def("names",
           [](const Formats& f) {
             std::vector<std::string> names;
             for (const Format& format : f.all()) names.push_back(format.name);
             return names;
           })
      .def(
          "encode",
          [](const Formats& f, const std::string& name, const nb::list& values) {
            Bytes out;
            f.at(name).encode(to_values(values), out);
            return to_bytes(out.data(), out.size());
          },
          "name"_a, "values"_a,
          nb::sig("def encode(self, name: str, values: list[int | bytes]) -> bytes"))
      .def("decode", &decode_payload, "payload"_a,
           nb::sig("def decode(self, payload: bytes) -> list[tuple[str, dict[str, int | bytes]]]"),
           "List of (name, values) of a frame's payload. ValueError if it is malformed.");
}

// A call of a link whose thread may be using it.
template <auto F, class... A>
auto held(Link& link, A... arguments) {
  std::lock_guard lock(link.guard());
  return (link.*F)(arguments...);
}

void bind_link(nb::module_& m) {
  nb::enum_<MessageKind>(m, "MessageKind")
      .value("QUEUE_STEP", MessageKind::queue_step)
      .value("SET_DIR", MessageKind::set_dir)
      .value("RESET_CLOCK", MessageKind::reset_clock)
      .value("PIN", MessageKind::pin)
      .value("TAIL", MessageKind::tail)
      .value("COMMIT", MessageKind::commit);
  nb::class_<MessageQueue>(m, "MessageQueue",
                           "Planned messages of one board, in the order of their clocks.")
      .def(nb::init<>())
      .def(
          "push",
          [](MessageQueue& q, MessageKind kind, uint16_t target, int64_t clock, int64_t end_clock,
             uint32_t interval, uint16_t count, int16_t add, bool dir) {
            auto held = q.hold();
            q.push({clock, end_clock, interval, count, add, target, kind, uint8_t(dir)});
          },
          "kind"_a, "target"_a, "clock"_a, "end_clock"_a = 0, "interval"_a = 0, "count"_a = 0,
          "add"_a = 0, "dir"_a = false)
      .def("clear",
           [](MessageQueue& q) {
             auto held = q.hold();
             q.clear();
           })
      .def("__len__", [](MessageQueue& q) {
        auto held = q.hold();
        return q.size();
      });
  nb::enum_<PinKind>(m, "PinKind").value("DIGITAL", PinKind::digital).value("PWM", PinKind::pwm);
  nb::enum_<Cause>(m, "Cause", "Why a frame was not at the board sooner.")
      .value("PLAN", Cause::plan, "Its moves were planned late.")
      .value("STALL", Cause::stall, "The program did not run.")
      .value("BYTES", Cause::bytes, "The link carries no more bytes.")
      .value("RETRANSMITS", Cause::retransmits, "Bytes got lost.")
      .value("SLOTS", Cause::slots, "The board had no slot free.");
  m.attr("LATE_S") = Lateness::kLateSeconds;
  nb::class_<Slack>(m, "Slack",
                    "Of a frame: ticks before the clock of its most urgent message at which the "
                    "board had it, that clock, and what held it up for how long.")
      .def_prop_ro("known", [](const Slack& s) { return s.slack != kNever; })
      .def_ro("slack", &Slack::slack)
      .def_ro("clock", &Slack::clock)
      .def_ro("held", &Slack::held)
      .def_ro("cause", &Slack::cause);
  nb::class_<Timeline>(m, "Timeline", "What the links to the boards of one machine share.")
      .def(nb::init<>())
      .def(
          "arm",
          [](Timeline& t, const std::vector<std::pair<size_t, uint32_t>>& members, uint32_t reason,
             uint32_t expired, double clock, double patience) {
            std::vector<Timeline::Member> list;
            for (auto [seat, oid] : members) list.push_back({seat, oid});
            t.arm(std::move(list), reason, expired, clock, patience);
          },
          "members"_a, "reason"_a, "expired"_a, "clock"_a, "patience"_a,
          "These trsyncs, (seat of the link, oid), trigger together, for one of two reasons; and "
          "by themselves when one of them was not heard of for so many ticks.")
      .def("disarm", &Timeline::disarm)
      .def_prop_ro("halted", &Timeline::halted, "A board has stopped or is lost.");
  nb::class_<Link>(m, "Link", "The host's end of a board's wire; times in ticks.")
      .def(nb::init<double>(), "clock_hz"_a)
      .def_prop_ro("hz", &Link::hz)
      .def(
          "set_dictionary",
          [](Link& l, const FormatList& commands, const FormatList& reports,
             size_t receive_window) {
            std::lock_guard lock(l.guard());
            l.set_dictionary(make_formats(commands), make_formats(reports), receive_window);
          },
          "commands"_a, "reports"_a, "receive_window"_a)
      .def(
          "send",
          [](Link& l, const std::string& name, const nb::list& values) {
            std::lock_guard lock(l.guard());
            l.send(name, to_values(values));
          },
          "name"_a, "values"_a,
          nb::sig("def send(self, name: str, values: list[int | bytes]) -> None"))
      .def(
          "take_responses",
          [](Link& l) {
            std::lock_guard lock(l.guard());
            nb::list list;
            for (const Response& r : l.inbox())
              list.append(nb::make_tuple(r.format->name, to_dict(*r.format, r.values)));
            l.inbox().clear();
            return list;
          },
          nb::sig("def take_responses(self) -> list[tuple[str, dict[str, int | bytes]]]"))
      .def("follow_clock", &held<&Link::follow_clock, Ticks>, "now"_a)
      .def("set_byte_ticks", &held<&Link::set_byte_ticks, double>, "ticks"_a,
           "What a byte takes on a serial line.")
      .def_prop_ro("synchronous", &held<&Link::synchronous>)
      .def_prop_ro("lost", &held<&Link::lost>)
      .def(
          "clock_at",
          [](Link& l, Ticks host) {
            std::lock_guard lock(l.guard());
            return l.clock().clock_at(host);
          },
          "host_ticks"_a)
      .def(
          "host_at",
          [](Link& l, Ticks clock) {
            std::lock_guard lock(l.guard());
            return l.clock().host_at(clock);
          },
          "clock"_a)
      .def_prop_ro("clock_rate",
                   [](Link& l) {
                     std::lock_guard lock(l.guard());
                     return l.clock().rate();
                   })
      .def(
          "add_stepper",
          [](Link& l, size_t target, const std::string& name, uint32_t oid, bool invert) {
            std::lock_guard lock(l.guard());
            l.job().add_stepper(l.commands(), target, name, oid, invert);
          },
          "target"_a, "name"_a, "oid"_a, "invert"_a)
      .def(
          "join",
          [](Link& l, const std::shared_ptr<Timeline>& timeline, bool main, double tolerance) {
            std::lock_guard lock(l.guard());
            l.join(timeline, main, tolerance);
          },
          "timeline"_a, "main"_a, "tolerance"_a = 0.0,
          "The board is one of several: the main one, or one whose steps are told in its own "
          "clock, within so many ticks.")
      .def_prop_ro("seat", &held<&Link::seat>, "Its number among the links of the machine.")
      .def("own_clock", &held<&Link::own_clock, Ticks>, "main_clock"_a,
           "What this board's clock reads when the main one's reads so much.")
      .def("main_clock", &held<&Link::main_clock, Ticks>, "own_clock"_a)
      .def(
          "set_apart",
          [](Link& l, size_t target, double least, double turning) {
            std::lock_guard lock(l.guard());
            if (Retimer* retimer = l.job().retimer()) retimer->set_apart(target, {least, turning});
          },
          "target"_a, "least"_a, "turning"_a,
          "How close steps of a motor may come, in ticks, one way and where it turns.")
      .def(
          "add_pin",
          [](Link& l, size_t target, const std::string& name, uint32_t oid, PinKind kind,
             uint32_t inverted_full, Ticks longest) {
            std::lock_guard lock(l.guard());
            l.job().add_pin(l.commands(), target, name, oid, kind, inverted_full, longest);
          },
          "target"_a, "name"_a, "oid"_a, "kind"_a, "inverted_full"_a = 0, "longest"_a = 0,
          "inverted_full: the value at full scale of a pin that is on when low; longest: ticks "
          "that "
          "the board lets it be on without a word.")
      .def(
          "set_slots",
          [](Link& l, size_t slots) {
            std::lock_guard lock(l.guard());
            l.job().set_slots(slots);
          },
          "slots"_a)
      .def(
          "set_queue",
          [](Link& l, MessageQueue* q) {
            std::lock_guard lock(l.guard());
            l.set_queue(q);
          },
          "queue"_a.none(), nb::keep_alive<1, 2>())
      .def("start_job", &held<&Link::start_job, Ticks, double>, "base_clock"_a, "main_hz"_a,
           "Both are the main board's.")
      .def_prop_ro(
          "clock_jitter_s",
          [](Link& l) {
            std::lock_guard lock(l.guard());
            return l.clock().jitter_s();
          },
          "What answers usually take longer than the quickest ones, seconds.")
      .def("use_commits", &held<&Link::use_commits, Ticks>, "horizon"_a,
           "The job comes in commits, and leaves so many ticks ahead.")
      .def(
          "begin_commits",
          [](Link& l, bool on) {
            std::lock_guard lock(l.guard());
            l.begin_commits(on);
          },
          "on"_a,
          "The machine stands, and what moves it comes in commits from here on, for the board is "
          "armed; or it does no more.")
      .def("reconnect", &held<&Link::reconnect>,
           "The board has gone on without this host: what was on its way is forgotten, and the job "
           "stands until go_on().")
      .def_prop_ro("delivered", &held<&Link::delivered>,
                   "Everything of the job so far is at the board.")
      .def("go_on", &held<&Link::go_on>)
      .def("stop_job",
           [](Link& l) {
             std::lock_guard lock(l.guard());
             l.job().stop();
           })
      .def(
          "add_heater",
          [](Link& l, const HeaterOptions& options) -> Heater& {
            std::lock_guard lock(l.guard());
            return l.add_heater(options);
          },
          "options"_a, nb::rv_policy::reference_internal)
      .def_prop_ro("shut_down", &held<&Link::shut_down>)
      .def_prop_ro("alone", &held<&Link::alone>, "The board has stopped by itself.")
      .def_prop_ro("stopped_with_others", &held<&Link::stopped_with_others>,
                   "The board was shut down because another one of the machine had failed.")
      .def_prop_ro("shutdown_reason", &held<&Link::shutdown_reason>)
      .def(
          "restart", &held<&Link::restart>,
          "The board begins anew: what was on its way is forgotten, its numbering is learnt again.")
      .def_prop_ro("wire_bytes", &held<&Link::wire_bytes>)
      .def_prop_ro("frames", &held<&Link::frames>)
      .def_prop_ro("retransmitted_bytes", &held<&Link::retransmitted_bytes>)
      .def_prop_ro("bad_frames", &held<&Link::bad_frames>)
      .def(
          "take_slack",
          [](Link& l) {
            std::lock_guard lock(l.guard());
            return l.lateness().take_recent();
          },
          "The least since this was last asked.")
      .def_prop_ro("least_slack",
                   [](Link& l) {
                     std::lock_guard lock(l.guard());
                     return l.lateness().least();
                   })
      .def_prop_ro(
          "late_frames",
          [](Link& l) {
            std::lock_guard lock(l.guard());
            std::map<Cause, uint64_t> frames;
            for (size_t i = 0; i < kCauses; ++i) frames[Cause(i)] = l.lateness().late_frames()[i];
            return frames;
          },
          "How many frames were at the board less than LATE_S before it needed them, by cause.")
      .def_prop_ro(
          "longest_stall",
          [](Link& l) {
            std::lock_guard lock(l.guard());
            return l.lateness().longest_stall();
          },
          "The most that it was looked after too late, ticks.")
      .def_prop_ro("queue_steps",
                   [](Link& l) {
                     std::lock_guard lock(l.guard());
                     return l.job().queue_steps();
                   })
      .def_prop_ro("messages",
                   [](Link& l) {
                     std::lock_guard lock(l.guard());
                     return l.job().messages();
                   })
      .def_prop_ro("stream_hash",
                   [](Link& l) {
                     std::lock_guard lock(l.guard());
                     return l.job().hash();
                   })
      .def(
          "feed",
          [](Link& l, const nb::bytes& data, Ticks now) {
            std::lock_guard lock(l.guard());
            l.feed(data_of(data), data.size(), now);
          },
          "data"_a, "now"_a)
      .def(
          "poll",
          [](Link& l, Ticks now) {
            std::lock_guard lock(l.guard());
            Bytes out;
            Ticks next = l.poll(now, out);
            return nb::make_tuple(to_bytes(out.data(), out.size()), next);
          },
          nb::sig("def poll(self, now: int) -> tuple[bytes, int]"), "now"_a,
          "(bytes to send, host time of the next call)");
}

nb::bytes runs_of(const std::vector<StepRun>& runs) {
  std::vector<int64_t> words;
  for (const StepRun& r : runs) {
    words.push_back(r.start);
    words.push_back(r.interval);
    words.push_back(r.count);
    words.push_back(r.add);
    words.push_back(r.dir);
  }
  return to_bytes(words.data(), words.size() * sizeof(int64_t));
}
nb::bytes steps_of(const nb::bytes& packed, Ticks from, Ticks to, int sign) {
  std::vector<int64_t> ticks;
  std::vector<int8_t> dirs;
  const auto* w = reinterpret_cast<const int64_t*>(packed.c_str());
  for (size_t i = 0; i + 5 <= packed.size() / sizeof(int64_t); i += 5) {
    StepRun run{
        w[i], 0, uint32_t(w[i + 1]), uint16_t(w[i + 2]), int16_t(w[i + 3]), int8_t(w[i + 4])};
    for (int64_t k = 1; k <= run.count; ++k) {
      Ticks at = run.at(k);
      if (at < from || at >= to) continue;
      if (sign != 0)
        dirs.push_back(int8_t(run.dir * sign));
      else
        ticks.push_back(at);
    }
  }
  return sign != 0 ? to_bytes(dirs.data(), dirs.size())
                   : to_bytes(ticks.data(), ticks.size() * sizeof(int64_t));
}

std::vector<std::pair<int64_t, uint32_t>> changes_of(const std::vector<PinChange>& list) {
  std::vector<std::pair<int64_t, uint32_t>> changes;
  for (const PinChange& c : list) changes.emplace_back(c.clock, c.value);
  return changes;
}

// The body as it is now.
HeatedBody& body_of(Bench& b, uint32_t sensor_pin) {
  b.plant().run_until(b.now());
  for (HeatedBody& body : b.plant().bodies)
    if (body.sensor_pin == sensor_pin) return body;
  throw nb::key_error("no body has this sensor");
}

void bind_board(nb::module_& m) {
  nb::register_exception_translator([](const std::exception_ptr& p, void*) {
    try {
      std::rethrow_exception(p);
    } catch (const UnknownPin& e) {
      PyErr_SetString(PyExc_KeyError, e.what());
    }
  });
  nb::class_<Device>(m, "Device", "The far end of a link, in virtual time.")
      .def(
          "feed",
          [](Device& d, const nb::bytes& data, Ticks now) {
            d.feed(data_of(data), data.size(), now);
          },
          "data"_a, "now"_a)
      .def(
          "poll",
          [](Device& d, Ticks now) {
            Bytes out;
            d.poll(now, out);
            return to_bytes(out.data(), out.size());
          },
          "now"_a)
      .def_prop_ro("next_deadline", &Device::next_deadline)
      .def_prop_ro("stopped", &Device::stopped);
  nb::class_<Bench, Device>(m, "Bench",
                            "A simulated board with the plant around it; pins by number.")
      .def(
          "add_actuator",
          [](Bench& b, uint32_t step_pin, double start, double per_step) {
            b.plant().actuators.push_back({step_pin, start, per_step});
          },
          "step_pin"_a, "start"_a, "per_step"_a)
      .def(
          "add_switch",
          [](Bench& b, uint32_t pin, std::vector<std::pair<uint32_t, double>> weights,
             double position, bool at_maximum, bool pressed_level) {
            b.plant().switches.push_back(
                {pin, std::move(weights), position, at_maximum, pressed_level});
          },
          "pin"_a, "weights"_a, "position"_a, "at_maximum"_a, "pressed_level"_a,
          "Pressed at or beyond `position` of the weighted sum of actuators: (step pin, weight).")
      .def("feel", &Bench::feel, "step_pin"_a, "board"_a, "its_step_pin"_a, nb::keep_alive<1, 3>(),
           "A motor on another board, as the switches of this one feel it.")
      .def("place", &Bench::place, "step_pin"_a, "position"_a,
           "Somebody moves the motor's actuator by hand.")
      .def(
          "force_switch",
          [](Bench& b, uint32_t pin, int pressed) {
            for (Switch& s : b.plant().switches)
              if (s.pin == pin) s.forced = pressed;
          },
          "pin"_a, "pressed"_a, "A fault: never pressed (0), always (1); -1 ends it.")
      .def(
          "add_body",
          [](Bench& b, uint32_t heater_pin, uint32_t sensor_pin, double ambient_c, double rise_c,
             double time_constant_s, double sensor_time_constant_s, const Points& adc_ratio,
             uint32_t fan_pin, double fan_loss) {
            HeatedBody body{heater_pin,
                            sensor_pin,
                            ambient_c,
                            rise_c,
                            time_constant_s,
                            sensor_time_constant_s,
                            heat::Curve(adc_ratio),
                            fan_pin,
                            fan_loss};
            b.plant().add_body(std::move(body));
          },
          "heater_pin"_a, "sensor_pin"_a, "ambient_c"_a, "rise_c"_a, "time_constant_s"_a,
          "sensor_time_constant_s"_a, "adc_ratio"_a, "fan_pin"_a = 0, "fan_loss"_a = 0.0)
      .def(
          "invert_output", [](Bench& b, uint32_t pin) { b.plant().low_is_on.push_back(pin); },
          "pin"_a, "What hangs on this output pin is on when the pin is low.")
      .def(
          "force_adc",
          [](Bench& b, uint32_t sensor_pin, double ratio) {
            body_of(b, sensor_pin).forced_ratio = ratio;
          },
          "sensor_pin"_a, "ratio"_a,
          "A fault: the ADC sees this share of full scale; negative ends it.")
      .def(
          "force_heater",
          [](Bench& b, uint32_t sensor_pin, double duty) {
            body_of(b, sensor_pin).forced_duty = duty;
          },
          "sensor_pin"_a, "duty"_a,
          "A fault: the heater does this whatever its pin says; negative ends it.")
      .def(
          "add_noise",
          [](Bench& b, uint32_t sensor_pin, double share) { body_of(b, sensor_pin).noise = share; },
          "sensor_pin"_a, "share"_a, "A fault: the ADC errs by up to this share of full scale.")
      .def(
          "drop_sensor",
          [](Bench& b, uint32_t sensor_pin, bool fallen) {
            body_of(b, sensor_pin).fallen = fallen;
          },
          "sensor_pin"_a, "fallen"_a, "A fault: the sensor feels the room instead of its body.")
      .def(
          "temperature",
          [](Bench& b, uint32_t sensor_pin) { return body_of(b, sensor_pin).body_c; },
          "sensor_pin"_a)
      .def("net_steps", &Bench::net_steps, "step_pin"_a)
      .def("steps", &Bench::steps, "step_pin"_a)
      .def("position", &Bench::position, "step_pin"_a)
      .def("trace_steps", &Bench::trace_steps, "step_pin"_a, "from_clock"_a, "to_clock"_a)
      .def(
          "take_steps", [](Bench& b, uint32_t pin) { return runs_of(b.take_steps(pin)); },
          "step_pin"_a,
          "Traced steps done so far, as int64 rows (start, interval, count, add, direction).")
      .def("output_value", &Bench::output_value, "pin"_a)
      .def("trace_output", &Bench::trace_output, "pin"_a)
      .def(
          "take_changes", [](Bench& b, uint32_t pin) { return changes_of(b.take_changes(pin)); },
          "pin"_a, "List of (clock, value) since the last call.")
      .def_prop_ro("fault", &Bench::fault, "Why it is shut down, or an empty string.")
      .def_prop_ro("frames", &Bench::frames)
      .def_prop_ro("naks", &Bench::naks)
      .def_prop_ro("now", &Bench::now);
  nb::class_<VirtualBoard, Bench>(m, "VirtualBoard",
                                  "A complete board in virtual time; pins by number.")
      .def(
          "__init__",
          [](VirtualBoard* self, double clock_hz, uint32_t move_count, uint32_t adc_max,
             uint32_t pwm_max, const nb::bytes& identify, Ticks start) {
            new (self)
                VirtualBoard({clock_hz, move_count, adc_max, pwm_max, from_bytes(identify), start});
          },
          "clock_hz"_a, "move_count"_a, "adc_max"_a, "pwm_max"_a, "identify"_a, "start"_a = 0)
      .def("last_step", &VirtualBoard::last_step, "step_pin"_a)
      .def_prop_ro("peak_slots", &VirtualBoard::peak_slots);
  nb::class_<FirmwareBoard, Bench>(m, "FirmwareBoard",
                                   "A board run by the firmware itself, in virtual time.")
      .def(
          "__init__",
          [](FirmwareBoard* self, const std::string& library, uint32_t clock_hz,
             uint16_t move_count, uint32_t adc_max, const nb::bytes& identify, Ticks start,
             std::map<int, std::string> faults) {
            new (self) FirmwareBoard(library, {clock_hz, move_count, adc_max, from_bytes(identify),
                                               start, std::move(faults)});
          },
          "library"_a, "clock_hz"_a, "move_count"_a, "adc_max"_a, "identify"_a, "start"_a,
          "faults"_a)
      .def("add_motor", &FirmwareBoard::add_motor, "step_pin"_a, "dir_pin"_a, "step_inverted"_a,
           "A motor driver on these pins; to be told before the board moves it.")
      .def("trace_edges", &FirmwareBoard::trace_edges, "pin"_a)
      .def(
          "take_edges",
          [](FirmwareBoard& b, uint32_t pin) { return changes_of(b.take_edges(pin)); }, "pin"_a,
          "List of (clock, level) since the last call.");
  nb::class_<Distant, Device>(m, "Distant",
                              "A device with a clock and a cable that are not perfect: its clock "
                              "begins at `start` and is a share of `drift` faster than host time; "
                              "bytes travel `latency` to `latency` + `jitter` ticks each way.")
      .def(nb::init<Device&, Ticks, double, Ticks, Ticks, uint32_t>(), "device"_a, "start"_a = 0,
           "drift"_a = 0.0, "latency"_a = 0, "jitter"_a = 0, "seed"_a = 1, nb::keep_alive<1, 2>())
      .def_prop_ro("now", &Distant::now, "Host time.")
      .def("cut", &Distant::cut, "on"_a, "What is sent either way is lost.")
      .def("spoil", &Distant::spoil, "share"_a,
           "So many of all bytes, either way, arrive as others, not at all, twice, or elsewhere.")
      .def("clock_at", &Distant::clock_at, "host_ticks"_a)
      .def("host_at", &Distant::host_at, "clock"_a);
  m.def(
      "firmware_dictionary",
      [](const std::string& library) {
        FirmwareLibrary firmware(library);
        size_t size;
        const uint8_t* data = firmware->built_dictionary(&size);
        return to_bytes(data, size);
      },
      "library"_a, "The dictionary that was built into a firmware library, compressed.");
  m.def(
      "expand_steps",
      [](const nb::bytes& rows, Ticks from, Ticks to) { return steps_of(rows, from, to, 0); },
      "rows"_a, "from_clock"_a, "to_clock"_a,
      "int64 clocks of all steps of take_steps() within from…to.");
  m.def(
      "expand_directions",
      [](const nb::bytes& rows, Ticks from, Ticks to, int sign) {
        return steps_of(rows, from, to, sign);
      },
      "rows"_a, "from_clock"_a, "to_clock"_a, "sign"_a,
      "int8 directions of the steps of expand_steps(), times sign (+1 or -1).");
  nb::enum_<Stop>(m, "Stop", "Why time stopped passing.")
      .value("TIME", Stop::time)
      .value("SHUTDOWN", Stop::shutdown)
      .value("HEATERS", Stop::heaters)
      .value("FAULT", Stop::fault)
      .value("CLOSED", Stop::closed);
  nb::class_<Pump>(m, "Pump", "Runs a link and a device in virtual time.")
      .def(
          "__init__",
          [](Pump* self, Link& link, Device& device, Ticks start) {
            new (self) Pump(link, device, start, thread_cpu_s);
          },
          "link"_a, "device"_a, "start"_a = 0, nb::keep_alive<1, 2>(), nb::keep_alive<1, 3>())
      .def("attach", &Pump::attach, "link"_a, "device"_a, nb::keep_alive<1, 2>(),
           nb::keep_alive<1, 3>(), "A further device, or another link to one that is here.")
      .def_prop_ro("now", &Pump::now)
      .def_prop_ro("hz", &Pump::hz, "Ticks of its time in a second.")
      .def("board_clock", &Pump::board_clock, "link"_a,
           "What the clock of this link's board reads, as far as it is known.")
      .def("sleep", &Pump::sleep, "until"_a, "The host does nothing until then; boards live on.")
      .def("cut", &Pump::cut, "Takes the cable away.")
      .def_prop_ro("device_cpu_s", &Pump::device_cpu)
      .def("record", &Pump::record, "on"_a)
      .def("take_recorded",
           [](Pump& p) {
             nb::bytes all = to_bytes(p.recorded().data(), p.recorded().size());
             p.recorded().clear();
             return all;
           })
      .def("run", &Pump::run, "until"_a, "until_heaters"_a = false,
           nb::call_guard<nb::gil_scoped_release>());
  nb::class_<LiveWire>(m, "LiveWire",
                       "Drives a link over a file descriptor, which it owns, in real time and a "
                       "thread of its own.")
      .def(nb::init<Link&, int>(), "link"_a, "fd"_a, nb::keep_alive<1, 2>())
      .def_prop_ro("now", &LiveWire::now)
      .def_prop_ro("failure", &LiveWire::failure,
                   "What ended the connection, if it was not the cable.")
      .def_prop_ro("hz", &LiveWire::hz, "Ticks of its time in a second.")
      .def(
          "board_clock", [](LiveWire& w, const Link&) { return w.now(); }, "link"_a,
          "What the board's clock reads, as far as it is known.")
      .def("use_board_clock", &LiveWire::use_board_clock,
           "Once the link is synchronous: `now` is the board's clock from here on.")
      .def("join", &LiveWire::join, "timeline"_a,
           "The link looks up whenever others of its machine have news for it.")
      .def("stop", &LiveWire::stop, "No byte moves any more.",
           nb::call_guard<nb::gil_scoped_release>())
      .def("run", &LiveWire::run, "until"_a, "until_heaters"_a = false,
           nb::call_guard<nb::gil_scoped_release>());
  nb::class_<LiveBoard>(m, "LiveBoard",
                        "Lets a device answer on a file descriptor, which it owns, in real time "
                        "and a thread of its own; look at the device in `look`, or after `stop`.")
      .def(nb::init<Device&, int, double, Ticks>(), "device"_a, "fd"_a, "clock_hz"_a, "start"_a = 0,
           nb::keep_alive<1, 2>())
      .def(
          "look",
          [](LiveBoard& b, const nb::callable& at) {
            std::unique_lock lock(b.guard(), std::defer_lock);
            {
              nb::gil_scoped_release released;
              lock.lock();
            }
            return at();
          },
          "at"_a, "What the function returns, which may use the device.")
      .def("stop", &LiveBoard::stop, nb::call_guard<nb::gil_scoped_release>());
}

}  // namespace

void bind_wire(nb::module_& m) {
  bind_frames(m);
  bind_link(m);
  bind_board(m);
}
