// Python interface of simulated boards and of the printer around them.
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "bind/bind_bytes.hpp"
#include "bind/bind_machine.hpp"
#include "sim/firmware_board.hpp"
#include "sim/imperfect_link.hpp"
#include "sim/virtual_board.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;
using namespace passo::wire;

namespace {

using Points = std::vector<std::pair<double, double>>;

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

using Dict = nb::typed<nb::dict, nb::str, nb::any>;
using Pair = std::array<double, 2>;
using Corners = std::array<double, 4>;

Bed bed_of(const Pair& center, const Pair& size, const Pair& tilt, double dome, double wave,
           const Pair& wave_length, double lift) {
  if (!(size[0] > 0 && size[1] > 0 && wave_length[0] > 0 && wave_length[1] > 0))
    throw nb::value_error("a bed needs a size, and waves a length");
  return {{center[0], center[1]},
          {size[0], size[1]},
          {tilt[0], tilt[1]},
          dome,
          wave,
          {wave_length[0], wave_length[1]},
          lift};
}

std::vector<Area> areas_of(const std::vector<Corners>& list) {
  std::vector<Area> areas;
  for (const Corners& c : list) areas.push_back({{c[0], c[1]}, {c[2], c[3]}});
  return areas;
}

// Calls `change` with the probe on a pin.
template <class Change>
void change_probe(Bench& b, uint32_t pin, const Change& change) {
  for (BedProbe& probe : b.plant().probes)
    if (probe.pin == pin) return change(probe);
  throw nb::key_error("no probe has this pin");
}

// The present state of the body on a heater pin.
HeatedBody& body_of(Bench& b, uint32_t sensor_pin) {
  b.plant().run_until(b.now());
  for (HeatedBody& body : b.plant().bodies)
    if (body.sensor_pin == sensor_pin) return body;
  throw nb::key_error("no body has this sensor");
}

// Sets a fault of a body.
template <auto Member, class Value>
void set_fault(Bench& b, uint32_t sensor_pin, Value value) {
  body_of(b, sensor_pin).*Member = value;
}

FanRotor& rotor_of(Bench& b, uint32_t tacho_pin) {
  b.plant().run_until(b.now());
  for (FanRotor& rotor : b.plant().rotors)
    if (rotor.tacho_pin == tacho_pin) return rotor;
  throw nb::key_error("no fan has this tachometer");
}

LightChain& lights_of(Bench& b, uint32_t pin) {
  for (LightChain& chain : b.plant().lights)
    if (chain.pin == pin) return chain;
  throw nb::key_error("no chain of lights has this pin");
}

std::vector<std::pair<Ticks, nb::bytes>> frames_of(LightChain& chain) {
  std::vector<std::pair<Ticks, nb::bytes>> frames;
  for (const auto& [clock, data] : chain.frames)
    frames.emplace_back(clock, to_bytes(data.data(), data.size()));
  chain.frames.clear();
  return frames;
}

}  // namespace

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
  nb::class_<Bed>(m, "Bed", "A simulated bed that is not flat; lengths in mm.")
      .def(
          "__init__",
          [](Bed* self, const Pair& center, const Pair& size, const Pair& tilt, double dome,
             double wave, const Pair& wave_length, double lift) {
            new (self) Bed(bed_of(center, size, tilt, dome, wave, wave_length, lift));
          },
          "center"_a, "size"_a, "tilt"_a, "dome"_a, "wave"_a, "wave_length"_a, "lift"_a,
          "Raises ValueError for a size or a wave length of 0.")
      .def("height", &Bed::height, "x"_a, "y"_a, "Height of the bed at X, Y.");
  nb::class_<ProbeMechanism>(m, "ProbeMechanism", "How a simulated probe is deployed.")
      .def_static(
          "fixed", [] { return ProbeMechanism(); }, "The probe is fixed to the head.")
      .def_static(
          "servo",
          [](uint32_t control_pin, double deploy_us, double stow_us, bool stowed_reads) {
            ProbeMechanism m;
            m.kind = ProbeMechanism::Kind::servo;
            m.control_pin = control_pin;
            m.deploy_us = deploy_us;
            m.stow_us = stow_us;
            m.stowed_reads = stowed_reads;
            return m;
          },
          "control_pin"_a, "deploy_us"_a, "stow_us"_a, "stowed_reads"_a,
          "A servo turns the probe down.")
      .def_static(
          "bltouch",
          [](uint32_t control_pin) {
            ProbeMechanism m;
            m.kind = ProbeMechanism::Kind::bltouch;
            m.control_pin = control_pin;
            return m;
          },
          "control_pin"_a, "The pin of a BLTouch.")
      .def_static(
          "dock",
          [](const std::array<double, 3>& dock, const Pair& leave) {
            ProbeMechanism m;
            m.kind = ProbeMechanism::Kind::dock;
            m.stowed_reads = true;
            for (int i = 0; i < 3; ++i) m.dock[i] = dock[size_t(i)];
            for (int i = 0; i < 2; ++i) m.leave[i] = leave[size_t(i)];
            return m;
          },
          "dock"_a, "leave"_a,
          "The head picks the probe up with the nozzle at `dock`, and returns it on the path to "
          "`leave`.")
      .def_prop_rw(
          "jammed", [](const ProbeMechanism& m) { return m.jammed; },
          [](ProbeMechanism& m, bool on) { m.jammed = on; }, "A fault: the probe never deploys.");
  nb::class_<Bench, Device>(
      m, "Bench", "A simulated board with the simulated printer around it; pins by number.")
      .def(
          "add_actuator",
          [](Bench& b, uint32_t step_pin, double start, double per_step) {
            b.plant().actuators.push_back({step_pin, start, per_step});
          },
          "step_pin"_a, "start"_a, "per_step"_a)
      .def(
          "add_switch",
          [](Bench& b, uint32_t pin, std::vector<std::pair<uint32_t, double>> weights,
             double position, bool at_maximum, bool pressed_level, double edge_mm) {
            Switch added{pin, std::move(weights), position, at_maximum, pressed_level};
            added.edge_mm = edge_mm;
            b.plant().switches.push_back(std::move(added));
          },
          "pin"_a, "weights"_a, "position"_a, "at_maximum"_a, "pressed_level"_a, "edge_mm"_a = 0.0,
          "Adds a switch that is triggered at or beyond `position`, the weighted sum of the "
          "actuators: (step pin, weight). With `edge_mm`, its level changes instead each time the "
          "sum has moved by this length.")
      .def(
          "add_probe",
          [](Bench& b, uint32_t pin, std::vector<uint32_t> motors, const Dict& geometry,
             const Bed& bed, const Pair& offset, double trigger, bool pressed_level,
             double hysteresis, double sigma, uint32_t seed, const std::vector<Corners>& dead,
             const std::vector<Corners>& touchy, const ProbeMechanism& mechanism) {
            auto kernel = geometry_of(geometry);
            if (int(motors.size()) != kernel->actuators())
              throw nb::value_error("a probe needs one motor for each actuator");
            BedProbe probe{pin,          std::move(motors),      std::move(kernel),
                           bed,          {offset[0], offset[1]}, trigger,
                           pressed_level};
            probe.hysteresis = hysteresis;
            probe.sigma = sigma;
            probe.noise = Noise(seed);
            probe.error = sigma > 0 ? probe.noise.next(sigma) : 0;
            probe.dead = areas_of(dead);
            probe.touchy = areas_of(touchy);
            probe.mechanism = mechanism;
            b.plant().add_probe(std::move(probe));
          },
          "pin"_a, "motors"_a, "geometry"_a, "bed"_a, "offset"_a, "trigger"_a, "pressed_level"_a,
          "hysteresis"_a, "sigma"_a, "seed"_a, "dead"_a, "touchy"_a, "mechanism"_a,
          "Adds a probe on the head, and the bed. `motors` are the step pins of the actuators.")
      .def(
          "carry_probe",
          [](Bench& b, uint32_t pin,
             const std::vector<std::pair<uint32_t, std::array<double, 4>>>& lifts) {
            change_probe(b, pin, [&](BedProbe& probe) {
              probe.lifts.clear();
              for (const auto& [motor, c] : lifts)
                probe.lifts.push_back({motor, {c[0], c[1], c[2], c[3]}});
            });
          },
          "pin"_a, "lifts"_a,
          "Several motors carry the gantry with the probe: the step pin of each, and the "
          "coefficients c of its weight c · (1, x, y, x y) at X, Y of the nozzle.")
      .def(
          "change_probe",
          [](Bench& b, uint32_t pin, const std::vector<Corners>& dead,
             const std::vector<Corners>& touchy, double sigma, bool jammed) {
            change_probe(b, pin, [&](BedProbe& probe) {
              probe.dead = areas_of(dead);
              probe.touchy = areas_of(touchy);
              probe.sigma = sigma;
              probe.mechanism.jammed = jammed;
            });
          },
          "pin"_a, "dead"_a, "touchy"_a, "sigma"_a, "jammed"_a,
          "Sets faults of a probe from now on.")
      .def(
          "change_bed",
          [](Bench& b, uint32_t pin, const Bed& bed) {
            change_probe(b, pin, [&](BedProbe& probe) { probe.bed = bed; });
          },
          "pin"_a, "bed"_a, "Changes the bed below a probe from now on.")
      .def("feel", &Bench::feel, "step_pin"_a, "board"_a, "its_step_pin"_a,
           "A motor on another board, which triggers the endstops of this board while that board "
           "exists.")
      .def("place", &Bench::place, "step_pin"_a, "position"_a,
           "Moves the motor's actuator, as if by hand.")
      .def(
          "force_switch",
          [](Bench& b, uint32_t pin, int pressed) {
            for (Switch& s : b.plant().switches)
              if (s.pin == pin) s.forced = pressed;
            for (BedProbe& probe : b.plant().probes)
              if (probe.pin == pin) probe.forced = pressed;
          },
          "pin"_a, "pressed"_a,
          "A fault: never triggered (0), always triggered (1), flickering (2); -1 ends it.")
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
          "pin"_a, "The device on this output pin is on when the pin is low.")
      .def("force_adc", &set_fault<&HeatedBody::forced_ratio, double>, "sensor_pin"_a, "ratio"_a,
           "A fault: the ADC reads this fraction of full scale; negative ends it.")
      .def("force_heater", &set_fault<&HeatedBody::forced_duty, double>, "sensor_pin"_a, "duty"_a,
           "A fault: the heater has this power, 0 to 1, whatever the level of its pin; negative "
           "ends it.")
      .def("add_noise", &set_fault<&HeatedBody::noise, double>, "sensor_pin"_a, "share"_a,
           "A fault: readings of the ADC have errors of up to this fraction of full scale.")
      .def("drop_sensor", &set_fault<&HeatedBody::fallen, bool>, "sensor_pin"_a, "fallen"_a,
           "A fault: the sensor measures the ambient temperature instead of the heated mass.")
      .def(
          "temperature",
          [](Bench& b, uint32_t sensor_pin) { return body_of(b, sensor_pin).body_c; },
          "sensor_pin"_a)
      .def(
          "add_rotor",
          [](Bench& b, uint32_t fan_pin, uint32_t tacho_pin, double full_hz, double time_constant_s,
             double pulses) {
            b.plant().add_rotor({fan_pin, tacho_pin, full_hz, time_constant_s, pulses});
          },
          "fan_pin"_a, "tacho_pin"_a, "full_hz"_a, "time_constant_s"_a, "pulses"_a,
          "Adds a fan with a tachometer: revolutions a second at full power, and pulses in a "
          "revolution.")
      .def(
          "force_rotor",
          [](Bench& b, uint32_t tacho_pin, bool stalled, bool silent) {
            FanRotor& rotor = rotor_of(b, tacho_pin);
            rotor.stalled = stalled;
            rotor.silent = silent;
          },
          "tacho_pin"_a, "stalled"_a, "silent"_a,
          "Faults: the rotor does not turn; the tachometer gives no pulses.")
      .def(
          "rotor_hz", [](Bench& b, uint32_t tacho_pin) { return rotor_of(b, tacho_pin).hz; },
          "tacho_pin"_a, "Revolutions a second.")
      .def(
          "add_lights",
          [](Bench& b, uint32_t pin, int64_t clock_pin, size_t count) {
            LightChain chain;
            chain.pin = pin;
            chain.clock_pin = clock_pin;
            chain.clocked = count;
            b.plant().lights.push_back(std::move(chain));
          },
          "pin"_a, "clock_pin"_a = -1, "count"_a = 0,
          "Adds a chain of lights on this data pin; one with a clock has so many LEDs.")
      .def(
          "lights",
          [](Bench& b, uint32_t pin) {
            const Bytes& shown = lights_of(b, pin).shown;
            return to_bytes(shown.data(), shown.size());
          },
          "pin"_a, "The bytes that a chain shows; none before its first frame.")
      .def(
          "trace_lights", [](Bench& b, uint32_t pin) { lights_of(b, pin).tracing = true; }, "pin"_a)
      .def(
          "take_lights", [](Bench& b, uint32_t pin) { return frames_of(lights_of(b, pin)); },
          "pin"_a, "The frames since the last call: clock and bytes.")
      .def(
          "fail_lights",
          [](Bench& b, uint32_t pin, uint32_t frames) { lights_of(b, pin).failures = frames; },
          "pin"_a, "frames"_a, "A fault: so many of the next frames are late.")
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
      .def_prop_ro("fault", &Bench::fault, "Why the board is shut down, or an empty string.")
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
      .def_prop_ro("peak_slots", &VirtualBoard::peak_slots);
  nb::class_<FirmwareBoard, Bench>(m, "FirmwareBoard",
                                   "A board that runs Passo's firmware, in virtual time.")
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
           "Adds a motor driver on these pins. Call it before the board moves the motor.")
      .def("trace_edges", &FirmwareBoard::trace_edges, "pin"_a)
      .def(
          "take_edges",
          [](FirmwareBoard& b, uint32_t pin) { return changes_of(b.take_edges(pin)); }, "pin"_a,
          "List of (clock, level) since the last call.");
  nb::class_<Distant, Device>(m, "Distant",
                              "A device with an imperfect clock and cable. Its clock starts at "
                              "`start` and is faster than host time by the fraction `drift`. Bytes "
                              "need `latency` to `latency` + `jitter` ticks in each direction.")
      .def(nb::init<Device&, Ticks, double, Ticks, Ticks, uint32_t>(), "device"_a, "start"_a = 0,
           "drift"_a = 0.0, "latency"_a = 0, "jitter"_a = 0, "seed"_a = 1, nb::keep_alive<1, 2>())
      .def_prop_ro("now", &Distant::now, "Host time.")
      .def("cut", &Distant::cut, "on"_a, "While it is set, all bytes in both directions are lost.")
      .def("spoil", &Distant::spoil, "share"_a, "frames"_a = 0.0,
           "Damages this fraction of all bytes in both directions (changed, lost, doubled or "
           "swapped), and this fraction of all frames (lost, doubled, swapped with the next, or "
           "late).")
      .def_prop_ro(
          "spoilt_frames",
          [](const Distant& d) {
            return std::vector<int>(d.spoilt_frames().begin(), d.spoilt_frames().end());
          },
          "The number of frames that were lost, doubled, swapped with the next, and late so far.")
      .def("clock_at", &Distant::clock_at, "host_ticks"_a)
      .def("host_at", &Distant::host_at, "clock"_a);
  m.def(
      "firmware_dictionary",
      [](const std::string& library) {
        Bytes dictionary = built_dictionary(library);
        return to_bytes(dictionary.data(), dictionary.size());
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
}
