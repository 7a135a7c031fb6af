// passo._core.HeadDynamics: motion and extrusion of the head of a simulated printer.
#include "bind/bind_head_dynamics.hpp"

#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <tuple>
#include <utility>
#include <vector>

#include "bind/bind_machine.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;
using namespace passo::wire;

namespace {

using Three = std::array<double, 3>;
using HeadMotor = std::tuple<Bench*, uint32_t, double, double, double>;

std::shared_ptr<HeadDynamics> head_of(double clock_hz, const nb::dict& geometry,
                                      const std::array<MassPair, 3>& masses,
                                      const std::vector<double>& nozzles,
                                      const std::vector<HeadMotor>& motors) {
  std::vector<TrackedMotor> tracked;
  for (const auto& [board, pin, per_step, ratio, offset] : motors) {
    if (board == nullptr) throw nb::value_error("a motor has no board");
    tracked.push_back(motor_of(per_step, ratio, offset));
  }
  auto head = std::make_shared<HeadDynamics>(positive(clock_hz, "clock_hz"), geometry_of(geometry),
                                             masses_of(masses), nozzles_of(nozzles), tracked);
  for (size_t i = 0; i < motors.size(); ++i)
    head->connect(i, *std::get<0>(motors[i]), std::get<1>(motors[i]));
  return head;
}

template <class Read>
auto of_axes(Read read) {
  return [read](const HeadDynamics& h) { return Three{read(h, 0), read(h, 1), read(h, 2)}; };
}

}  // namespace

void bind_head_dynamics(nb::module_& m) {
  nb::class_<BeltMass>(m, "BeltMass",
                       "A mass on a belt that a motor moves in steps; exact between them.")
      .def(
          "__init__",
          [](BeltMass* self, double frequency_hz, double damping) {
            new (self) BeltMass(mass_of({frequency_hz, damping}));
          },
          "frequency_hz"_a, "damping"_a,
          "`damping` is a fraction of the critical one. Raises ValueError outside of 0 to 1.")
      .def(
          "run", [](BeltMass& mass, double s) { mass.run(finite(s, "seconds")); }, "seconds"_a,
          "Lets time pass without a step.")
      .def(
          "step", [](BeltMass& mass, double mm) { mass.step(finite(mm, "mm")); }, "mm"_a,
          "The motor moves, at once.")
      .def_prop_ro("deviation", &BeltMass::deviation,
                   "Position of the mass minus that of the motor, mm.")
      .def_prop_ro("velocity", &BeltMass::velocity, "mm/s.")
      .def_prop_ro("acceleration", &BeltMass::acceleration, "mm/s\u00b2.")
      .def_prop_ro("ringing", &BeltMass::ringing,
                   "The amplitude of the vibration while the motor is at standstill, mm.");
  nb::class_<NozzlePressure>(m, "NozzlePressure",
                             "A nozzle whose flow follows the extruder's speed as a first-order "
                             "system; exact between steps.")
      .def(
          "__init__",
          [](NozzlePressure* self, double time_constant_s) {
            new (self) NozzlePressure(nozzle_of(time_constant_s));
          },
          "time_constant_s"_a, "Raises ValueError for a time constant that is not above 0.")
      .def(
          "run", [](NozzlePressure& nozzle, double s) { nozzle.run(finite(s, "seconds")); },
          "seconds"_a, "Lets time pass without a step.")
      .def(
          "step", [](NozzlePressure& nozzle, double mm) { nozzle.step(finite(mm, "mm")); }, "mm"_a,
          "The extruder moves, at once.")
      .def_prop_ro("flow", &NozzlePressure::flow, "Filament that leaves the nozzle, mm/s.");
  nb::class_<HeadDynamics>(m, "HeadDynamics",
                           "The real motion of the head of a simulated printer, and the flow of "
                           "its nozzles, from executed steps alone. Clocks are those of the main "
                           "board and do not decrease.")
      .def(nb::new_(&head_of), "clock_hz"_a, "geometry"_a, "masses"_a, "nozzles"_a, "motors"_a,
           "`masses` has the frequency in Hz and the damping ratio of X, Y and Z, `nozzles` the "
           "time constant in s of each extruder. `motors` are as for NozzleGap: first those of "
           "the actuators of the geometry, then those of the extruders.")
      .def_prop_ro("last_step", &HeadDynamics::last_step,
                   "The clock of the last step that was made.")
      .def("follow", &HeadDynamics::follow, "on"_a,
           "Begins to follow the motors from their positions, all at rest; or ends it.")
      .def(
          "place",
          [](HeadDynamics& h, double clock, const std::vector<double>& positions) {
            if (positions.size() != h.actuators())
              throw nb::value_error("one position for each actuator");
            for (double position : positions) finite(position, "a position");
            h.place(finite(clock, "clock"), positions);
          },
          "clock"_a, "positions"_a,
          "Sets the positions of the motors of the actuators at this clock, at standstill.")
      .def(
          "run",
          [](HeadDynamics& h, double clock) {
            finite(clock, "clock");
            nb::gil_scoped_release released;
            h.run(clock);
          },
          "clock"_a, "Moves everything up to a clock that the boards have reached.")
      .def_prop_ro("motor_mm", of_axes([](auto& h, int i) { return h.motor_mm(i); }),
                   "Where the motors hold X, Y and Z.")
      .def_prop_ro("mm", of_axes([](auto& h, int i) { return h.mm(i); }),
                   "Where X, Y and Z really are.")
      .def_prop_ro("ringing", of_axes([](auto& h, int i) { return h.mass(i).ringing(); }),
                   "The amplitudes of the vibration of X, Y and Z, mm, while the motors are at "
                   "standstill.");
}
