// Python interface of the connections between links and boards, in virtual and in real time.
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
  nb::class_<Pump>(m, "Pump", "Runs links and devices in virtual time.")
      .def(
          "__init__",
          [](Pump* self, Link& link, Device& device, Ticks start) {
            new (self) Pump(link, device, start, thread_cpu_s);
          },
          "link"_a, "device"_a, "start"_a = 0, nb::keep_alive<1, 2>(), nb::keep_alive<1, 3>())
      .def("attach", &Pump::attach, "link"_a, "device"_a, nb::keep_alive<1, 2>(),
           nb::keep_alive<1, 3>(),
           "Adds a further device, or another link to a device that is attached already.")
      .def_prop_ro("now", &Pump::now)
      .def_prop_ro("hz", &Pump::hz, "Ticks per second of its clock.")
      .def("board_clock", &Pump::board_clock, "link"_a, "The estimated clock of this link's board.")
      .def("sleep", &Pump::sleep, "until"_a,
           "The host does nothing until that time; boards continue to run.")
      .def("stand_by", &Pump::stand_by, "until"_a, nb::call_guard<nb::gil_scoped_release>(),
           "Runs until that time, even if boards are shut down.")
      .def("cut", &Pump::cut, "Cuts the cables: no byte arrives any more.")
      .def_prop_ro("device_share", &Pump::device_share,
                   "The fraction of its processor time that the devices take, from a sample.")
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
                       "Runs a link over a file descriptor in real time, in a separate thread. "
                       "Owns the file descriptor.")
      .def(nb::init<Link&, int>(), "link"_a, "fd"_a, nb::keep_alive<1, 2>())
      .def_prop_ro("now", &LiveWire::now)
      .def_prop_ro("failure", &LiveWire::failure,
                   "The reason why the connection ended, if it was not the cable; otherwise empty.")
      .def_prop_ro("hz", &LiveWire::hz, "Ticks per second of its clock.")
      .def(
          "board_clock", [](LiveWire& w, const Link&) { return w.now(); }, "link"_a,
          "The estimated clock of the board.")
      .def("use_board_clock", &LiveWire::use_board_clock,
           "From here on `now` is the board's clock. Call it once the link is synchronous.")
      .def("join", &LiveWire::join, "timeline"_a,
           "The thread wakes whenever another link of the machine has a message for this one.")
      .def("stop", &LiveWire::stop, "Stops the thread: no more bytes are sent or received.",
           nb::call_guard<nb::gil_scoped_release>())
      .def("run", &LiveWire::run, "until"_a, "until_heaters"_a = false,
           nb::call_guard<nb::gil_scoped_release>());
  nb::class_<LiveBoard>(
      m, "LiveBoard",
      "Connects a device to a file descriptor in real time, in a separate thread. Owns the file "
      "descriptor. Use the device only in `look`, or after `stop`.")
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
          "at"_a, "Calls the function, which may use the device, and returns its result.")
      .def("stop", &LiveBoard::stop, nb::call_guard<nb::gil_scoped_release>());
}
