// Python interface of a link, of the messages of a job, and of the state that links share.
#include <nanobind/nanobind.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include <functional>

#include "bind/bind_bytes.hpp"
#include "link/link.hpp"
#include "link/retimer.hpp"
#include "steps/message_queue.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;
using namespace passo::wire;

namespace {

// Binds function F of a link that a thread may be using: the call takes the link's lock.
template <auto F, class... A>
auto held(Link& link, A... arguments) {
  std::lock_guard lock(link.guard());
  return std::invoke(F, link, arguments...);
}

}  // namespace

void bind_link(nb::module_& m) {
  nb::enum_<MessageKind>(m, "MessageKind")
      .value("QUEUE_STEP", MessageKind::queue_step)
      .value("SET_DIR", MessageKind::set_dir)
      .value("RESET_CLOCK", MessageKind::reset_clock)
      .value("PIN", MessageKind::pin)
      .value("TAIL", MessageKind::tail)
      .value("COMMIT", MessageKind::commit);
  nb::class_<MessageQueue>(m, "MessageQueue",
                           "Planned messages of one board, in the order in which they leave.")
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
  nb::enum_<Cause>(m, "Cause", "Why a frame did not arrive at the board earlier.")
      .value("PLAN", Cause::plan, "Its moves were planned late.")
      .value("STALL", Cause::stall, "The program did not run.")
      .value("BYTES", Cause::bytes, "The link was saturated.")
      .value("RETRANSMITS", Cause::retransmits, "Bytes were lost.")
      .value("SLOTS", Cause::slots, "The board had no slot free.");
  m.attr("LATE_S") = Lateness::kLateSeconds;
  nb::class_<Slack>(
      m, "Slack",
      "The slack of a frame: how many ticks before the clock of its most urgent message it "
      "arrived; that clock; and what delayed the frame, and for how many ticks.")
      .def_prop_ro("known", [](const Slack& s) { return s.slack != kNever; })
      .def_ro("slack", &Slack::slack)
      .def_ro("clock", &Slack::clock)
      .def_ro("held", &Slack::held)
      .def_ro("cause", &Slack::cause);
  nb::class_<Timeline>(m, "Timeline",
                       "The state that the links to the boards of one machine share.")
      .def(nb::init<>())
      .def(
          "arm",
          [](Timeline& t, const std::vector<std::pair<size_t, uint32_t>>& members, uint32_t reason,
             uint32_t expired, double clock, double patience, uint32_t failed) {
            std::vector<Timeline::Member> list;
            for (auto [seat, oid] : members) list.push_back({seat, oid});
            t.arm(std::move(list), reason, expired, clock, patience, failed);
          },
          "members"_a, "reason"_a, "expired"_a, "clock"_a, "patience"_a, "failed"_a = 0,
          "These trsyncs, (number of the link, oid), trigger together: with `reason` when one has "
          "triggered, or with `expired` when one has not reported for `patience` ticks. Sixteen "
          "reasons from `failed` on, if it is not 0, are errors of a sensor.")
      .def("disarm", &Timeline::disarm)
      .def_prop_ro("halted", &Timeline::halted, "A board has stopped or is lost.");
  nb::class_<Link>(m, "Link", "The host's end of the connection to a board; times in ticks.")
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
           "Sets the ticks that a byte takes on a serial line.")
      .def_prop_ro("synchronous", &held<&Link::synchronous>)
      .def_prop_ro("lost", &held<&Link::lost>)
      .def_prop_ro("restarted", &held<&Link::restarted>,
                   "The board has restarted, after a reset or a power failure.")
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
      .def_prop_ro("clock_rate", &held<[](Link& l) { return l.clock().rate(); }>)
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
          "The board is one of several: the main board, or a further one, which gets its steps in "
          "its own clock with `tolerance` more ticks.")
      .def_prop_ro("seat", &held<&Link::seat>,
                   "The number of this link among the links of the machine.")
      .def("own_clock", &held<&Link::own_clock, Ticks>, "main_clock"_a,
           "The clock of this board when the main board's clock reads `main_clock`.")
      .def("main_clock", &held<&Link::main_clock, Ticks>, "own_clock"_a)
      .def(
          "set_apart",
          [](Link& l, size_t target, double least, double turning) {
            std::lock_guard lock(l.guard());
            if (Retimer* retimer = l.job().retimer()) retimer->set_apart(target, {least, turning});
          },
          "target"_a, "least"_a, "turning"_a,
          "The minimum distance of a motor's steps in ticks: in one direction, and at a reversal.")
      .def(
          "add_pin",
          [](Link& l, size_t target, const std::string& name, uint32_t oid, PinKind kind,
             uint32_t inverted_full, Ticks longest) {
            std::lock_guard lock(l.guard());
            l.job().add_pin(l.commands(), target, name, oid, kind, inverted_full, longest);
          },
          "target"_a, "name"_a, "oid"_a, "kind"_a, "inverted_full"_a = 0, "longest"_a = 0,
          "inverted_full: the value at full scale of a pin that is on when low. longest: ticks "
          "after which the board shuts down if the pin is on and not renewed; 0: it does not.")
      .def(
          "set_kick",
          [](Link& l, size_t target, Ticks ticks, uint32_t full, uint32_t rise) {
            std::lock_guard lock(l.guard());
            l.job().set_kick(target, {ticks, full, rise});
          },
          "target"_a, "ticks"_a, "full"_a, "rise"_a,
          "Kickstart: if the value of a pin rises from 0, or by more than `rise`, the pin is "
          "`full` for `ticks` first.")
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
           "Starts the job at this clock of the main board, whose clock frequency is `main_hz`.")
      .def_prop_ro("clock_jitter_s", &held<[](Link& l) { return l.clock().jitter_s(); }>,
                   "The usual delay of an answer beyond the fastest ones, in seconds.")
      .def("use_commits", &held<&Link::use_commits, Ticks>, "horizon"_a,
           "The job comes in commits, and its messages are sent `horizon` ticks ahead.")
      .def(
          "begin_commits",
          [](Link& l, bool on) {
            std::lock_guard lock(l.guard());
            l.begin_commits(on);
          },
          "on"_a,
          "Call it at standstill, after the command that arms the board (`on`) or disarms it. "
          "While "
          "the board is armed, motion comes in commits.")
      .def("reconnect", &held<&Link::reconnect>,
           "The board has continued without this host: messages in transit are dropped, and the "
           "job is paused until resume().")
      .def_prop_ro(
          "acknowledged", &held<&Link::acknowledged>,
          "The board has all commands. Their immediate answers have been received, or are lost.")
      .def("unacknowledged_s", &held<&Link::unacknowledged_s, Ticks>, "clock"_a,
           "Age in seconds of the oldest message that the board has not acknowledged, when its "
           "clock reads `clock`; 0 if it has acknowledged all.")
      .def_prop_ro("delivered", &held<&Link::delivered>,
                   "The board has all messages of the job so far.")
      .def("resume", &held<&Link::resume>)
      .def("stop_job", &held<[](Link& l) { l.job().stop(); }>)
      .def(
          "add_heater",
          [](Link& l, const HeaterOptions& options) -> Heater& {
            std::lock_guard lock(l.guard());
            return l.add_heater(options);
          },
          "options"_a, nb::rv_policy::reference_internal)
      .def_prop_ro("shut_down", &held<&Link::shut_down>)
      .def_prop_ro("self_stopped", &held<&Link::self_stopped>, "The board has stopped by itself.")
      .def_prop_ro("stopped_with_others", &held<&Link::stopped_with_others>,
                   "The board was shut down because another one of the machine had failed.")
      .def_prop_ro("shutdown_reason", &held<&Link::shutdown_reason>)
      .def("restart", &held<&Link::restart>,
           "Call it when the board restarts: messages in transit are dropped, and its frame "
           "numbers are read again.")
      .def_prop_ro("wire_bytes", &held<&Link::wire_bytes>)
      .def_prop_ro("frames", &held<&Link::frames>)
      .def_prop_ro("retransmitted_bytes", &held<&Link::retransmitted_bytes>)
      .def("take_slack", &held<[](Link& l) { return l.lateness().take_recent(); }>,
           "The minimum slack since the last call.")
      .def_prop_ro("min_slack", &held<[](Link& l) { return l.lateness().least(); }>)
      .def_prop_ro(
          "late_frames",
          [](Link& l) {
            std::lock_guard lock(l.guard());
            std::map<Cause, uint64_t> frames;
            for (size_t i = 0; i < kCauses; ++i) frames[Cause(i)] = l.lateness().late_frames()[i];
            return frames;
          },
          "The number of frames that arrived less than LATE_S before the board needed them, by "
          "cause.")
      .def_prop_ro("longest_stall", &held<[](Link& l) { return l.lateness().longest_stall(); }>,
                   "The longest delay of a poll, in ticks.")
      .def_prop_ro("queue_steps", &held<[](Link& l) { return l.job().queue_steps(); }>)
      .def_prop_ro("messages", &held<[](Link& l) { return l.job().messages(); }>)
      .def_prop_ro("stream_hash", &held<[](Link& l) { return l.job().hash(); }>)
      .def(
          "keep_record",
          [](Link& l, size_t bytes, size_t parts) {
            std::lock_guard lock(l.guard());
            l.record().keep(bytes, parts);
          },
          "bytes"_a, "parts"_a,
          "Keeps the last bytes of both directions from now on. Both sizes are powers of two.")
      .def(
          "recorded",
          [](Link& l, Ticks since) {
            nb::list list;
            std::lock_guard lock(l.guard());
            l.record().each([&](const FrameRecord::Part& part, const Bytes& bytes) {
              if (part.host < since) return;
              list.append(nb::make_tuple(part.host, part.clock, part.from_board,
                                         to_bytes(bytes.data(), bytes.size())));
            });
            return list;
          },
          nb::sig("def recorded(self, since: int) -> list[tuple[int, int, bool, bytes]]"),
          "since"_a,
          "The data sent and received since that host time, oldest first: host time, the board's "
          "clock (0 if not known), True if the board sent it, and the bytes.")
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
