// Python's interface to the transport between links and boards, in virtual time and in real time.
#include <nanobind/nanobind.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>

#include "base/cpu_clock.hpp"
#include "bind/bind_bytes.hpp"
#include "link/live_wire.hpp"
#include "link/pump.hpp"
#include "sim/live_board.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;
using namespace passo::wire;

void bind_wire(nb::module_& m) {
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
      .def_prop_ro("device_share", &Pump::device_share,
                   "The part of its processor time that the devices take, from a sample.")
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
