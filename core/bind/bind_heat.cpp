// Python interface of heaters: control, protections and readings.
#include <nanobind/nanobind.h>
#include <nanobind/operators.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

#include "link/heater.hpp"
#include "sim/heat_run.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;
using namespace passo::heat;
using namespace passo::wire;

namespace {

using Points = std::vector<std::pair<double, double>>;

void bind_controls(nb::module_& m) {
  nb::class_<HeatModel>(
      m, "HeatModel",
      "Thermal model of a heated mass and its sensor, each of first order. Units: °C, s. fan_loss "
      "is the fraction by which a fan at full speed increases the heat loss.")
      .def(nb::init<double, double, double, double, double>(), "rise_c"_a, "time_constant_s"_a,
           "sensor_lag_s"_a, "fan_loss"_a = 0.0, "ambient_c"_a = 25.0)
      .def_ro("rise_c", &HeatModel::rise_c)
      .def_ro("time_constant_s", &HeatModel::time_constant_s)
      .def_ro("sensor_lag_s", &HeatModel::sensor_lag_s)
      .def_ro("fan_loss", &HeatModel::fan_loss)
      .def_ro("ambient_c", &HeatModel::ambient_c)
      .def(nb::self == nb::self);
  nb::class_<PidControl>(
      m, "PidControl",
      "Gains in 1/255 of full power per °C, per °C·s and per °C/s, as in M301. drive_min and "
      "drive_max, fractions of full power, bound the integral. If the temperature is more than "
      "range_c from the target, the heater is fully on or off.")
      .def(nb::init<double, double, double, double, double, double, double>(), "kp"_a, "ki"_a,
           "kd"_a, "filter_s"_a = 1.0, "drive_min"_a = 0.0, "drive_max"_a = 1.0, "range_c"_a = 10.0)
      .def_ro("kp", &PidControl::kp)
      .def_ro("ki", &PidControl::ki)
      .def_ro("kd", &PidControl::kd)
      .def_ro("filter_s", &PidControl::filter_s)
      .def_ro("drive_min", &PidControl::drive_min)
      .def_ro("drive_max", &PidControl::drive_max)
      .def_ro("range_c", &PidControl::range_c)
      .def(nb::self == nb::self);
  nb::class_<OnOffControl>(
      m, "OnOffControl",
      "Switches on when the temperature is below the target by the hysteresis, and off when it is "
      "above by the same. Two switchings are at least the interval apart.")
      .def(nb::init<double, double>(), "hysteresis_c"_a = 1.0, "interval_s"_a = 0.0)
      .def_ro("hysteresis_c", &OnOffControl::hysteresis_c)
      .def_ro("interval_s", &OnOffControl::interval_s)
      .def(nb::self == nb::self);
  nb::class_<ModelControl>(m, "ModelControl",
                           "The power with which, according to the model, the temperature reaches "
                           "the target within the horizon.")
      .def(nb::init<HeatModel, double>(), "model"_a, "horizon_s"_a = 3.0)
      .def_ro("model", &ModelControl::model)
      .def_ro("horizon_s", &ModelControl::horizon_s)
      .def(nb::self == nb::self);
  nb::class_<RelayControl>(m, "RelayControl",
                           "Switches between two powers around the target, for autotuning.")
      .def(nb::init<double, double>(), "half_cycle_s"_a = 5.0, "band_c"_a = 0.0,
           "It switches `band_c` above the target and as far below it, and not before the half "
           "cycle has passed.")
      .def_ro("half_cycle_s", &RelayControl::half_cycle_s)
      .def_ro("band_c", &RelayControl::band_c)
      .def(nb::self == nb::self);
}

void bind_protections(nb::module_& m) {
  nb::enum_<FaultKind>(m, "FaultKind")
      .value("NONE", FaultKind::none)
      .value("SENSOR_OPEN", FaultKind::sensor_open)
      .value("SENSOR_SHORT", FaultKind::sensor_short)
      .value("SENSOR_ERRATIC", FaultKind::sensor_erratic)
      .value("MIN_TEMPERATURE", FaultKind::min_temperature)
      .value("MAX_TEMPERATURE", FaultKind::max_temperature)
      .value("HEATING_FAILED", FaultKind::heating_failed)
      .value("RUNAWAY", FaultKind::runaway)
      .value("STUCK_ON", FaultKind::stuck_on)
      .value("MODEL_DEVIATION", FaultKind::model_deviation);
  nb::class_<Fault>(m, "HeatFault",
                    "The fault, the reading of the sensor, the limit that was exceeded (°C; for a "
                    "model deviation a fraction of power), and the board clock.")
      .def_ro("kind", &Fault::kind)
      .def_ro("celsius", &Fault::celsius)
      .def_ro("limit", &Fault::limit)
      .def_ro("clock", &Fault::clock);
  nb::class_<ProtectionLimits>(
      m, "ProtectionLimits",
      "The limits of a heater's protections. 0 switches a protection off, except min_c and max_c.")
      .def(
          "__init__",
          [](ProtectionLimits* self, double min_c, double max_c, double jump_c, double watch_rise_c,
             double watch_s, double runaway_c, double runaway_s, double stuck_on_c,
             double stuck_on_s, double deviation, double deviation_s) {
            new (self) ProtectionLimits{min_c,      max_c,     jump_c,     watch_rise_c,
                                        watch_s,    runaway_c, runaway_s,  stuck_on_c,
                                        stuck_on_s, deviation, deviation_s};
          },
          "min_c"_a = 5.0, "max_c"_a = 280.0, "jump_c"_a = 10.0, "watch_rise_c"_a = 2.0,
          "watch_s"_a = 20.0, "runaway_c"_a = 4.0, "runaway_s"_a = 40.0, "stuck_on_c"_a = 10.0,
          "stuck_on_s"_a = 60.0, "deviation"_a = 0.25, "deviation_s"_a = 30.0)
      .def_ro("min_c", &ProtectionLimits::min_c)
      .def_ro("max_c", &ProtectionLimits::max_c)
      .def_ro("jump_c", &ProtectionLimits::jump_c)
      .def_ro("watch_rise_c", &ProtectionLimits::watch_rise_c)
      .def_ro("watch_s", &ProtectionLimits::watch_s)
      .def_ro("runaway_c", &ProtectionLimits::runaway_c)
      .def_ro("runaway_s", &ProtectionLimits::runaway_s)
      .def_ro("stuck_on_c", &ProtectionLimits::stuck_on_c)
      .def_ro("stuck_on_s", &ProtectionLimits::stuck_on_s)
      .def_ro("deviation", &ProtectionLimits::deviation)
      .def_ro("deviation_s", &ProtectionLimits::deviation_s)
      .def(nb::self == nb::self);
}

// Binds a function of a heater that the link's thread may be using: the call takes the link's lock.
template <auto F, class... A>
auto held(Heater& heater, A... arguments) {
  std::lock_guard lock(heater.guard());
  return (heater.*F)(arguments...);
}

void bind_heater(nb::module_& m) {
  nb::class_<Terms>(m, "HeatTerms",
                    "Error (°C) and fractions of full power. For a relay, p is the mean of its two "
                    "powers, and d the difference of the present power from p.")
      .def(
          "__init__",
          [](Terms* self, double error, double p, double i, double d, double output) {
            new (self) Terms{error, p, i, d, output};
          },
          "error"_a = 0.0, "p"_a = 0.0, "i"_a = 0.0, "d"_a = 0.0, "output"_a = 0.0)
      .def_ro("error", &Terms::error)
      .def_ro("p", &Terms::p)
      .def_ro("i", &Terms::i)
      .def_ro("d", &Terms::d)
      .def_ro("output", &Terms::output);
  nb::class_<HeatSample>(m, "HeatSample", "One report of the sensor and the answer to it.")
      .def(
          "__init__",
          [](HeatSample* self, Ticks clock, double celsius, double target, double power,
             const Terms& terms) { new (self) HeatSample{clock, celsius, target, power, terms}; },
          "clock"_a, "celsius"_a, "target"_a, "power"_a, "terms"_a)
      .def_ro("clock", &HeatSample::clock)
      .def_ro("celsius", &HeatSample::celsius)
      .def_ro("target", &HeatSample::target)
      .def_ro("power", &HeatSample::power)
      .def_ro("terms", &HeatSample::terms);
  nb::class_<SensorQuery>(m, "SensorQuery", "How the board samples a sensor; ticks and sums.")
      .def(nb::init<uint32_t, uint32_t, uint32_t, uint32_t, uint32_t, uint32_t>(), "sample_ticks"_a,
           "sample_count"_a, "rest_ticks"_a, "minimum"_a, "maximum"_a, "range_checks"_a)
      .def_ro("sample_ticks", &SensorQuery::sample_ticks)
      .def_ro("sample_count", &SensorQuery::sample_count)
      .def_ro("rest_ticks", &SensorQuery::rest_ticks)
      .def_ro("minimum", &SensorQuery::minimum)
      .def_ro("maximum", &SensorQuery::maximum)
      .def_ro("range_checks", &SensorQuery::range_checks);
  nb::enum_<heat::Converter>(m, "Converter")
      .value("NONE", heat::Converter::none)
      .value("MAX31855", heat::Converter::max31855)
      .value("MAX31856", heat::Converter::max31856)
      .value("MAX31865", heat::Converter::max31865)
      .value("MAX6675", heat::Converter::max6675);
  nb::enum_<heat::ConverterFault>(m, "ConverterFault")
      .value("NONE", heat::ConverterFault::none)
      .value("OPEN", heat::ConverterFault::open)
      .value("SHORT_CIRCUIT", heat::ConverterFault::short_circuit)
      .value("OUT_OF_RANGE", heat::ConverterFault::out_of_range)
      .value("NO_ANSWER", heat::ConverterFault::no_answer);
  m.def(
      "read_converter",
      [](heat::Converter converter, uint32_t word, uint32_t faults) {
        heat::ConverterReading reading = heat::read_converter(converter, word, faults);
        return std::pair(double(reading.steps) / heat::scale_of(converter).per_unit, reading.fault);
      },
      "converter"_a, "word"_a, "faults"_a = 0,
      "The reading of a converter: °C, or for a MAX31865 the fraction of its reference resistor; "
      "and its fault.");
  m.def(
      "converter_full", [](heat::Converter converter) { return heat::scale_of(converter).full; },
      "converter"_a, "Number of steps at full scale.");
  m.def(
      "converter_share",
      [](heat::Converter converter, double value) {
        heat::ConverterScale scale = heat::scale_of(converter);
        return (value * scale.per_unit + scale.zero) / scale.full;
      },
      "converter"_a, "value"_a, "The fraction of full scale for a reading of read_converter().");
  m.def(
      "converter_words",
      [](heat::Converter converter, double low, double high) {
        auto word = [&](double share) {
          return heat::converter_word(converter,
                                      std::max(heat::converter_steps(converter, share), 0));
        };
        uint32_t rest = (1u << heat::scale_of(converter).shift) - 1;
        return std::pair(word(low), word(high) | rest);
      },
      "converter"_a, "low"_a, "high"_a,
      "The minimum and the maximum word between two fractions of full scale.");
  nb::class_<Arrival>(m, "Arrival",
                      "When a target is reached: after `seconds` within `window_c`. The time "
                      "restarts if the temperature leaves `leaves_c`.")
      .def(
          "__init__",
          [](Arrival* self, double window_c, double leaves_c, double seconds) {
            new (self) Arrival{window_c, leaves_c, seconds};
          },
          "window_c"_a = 1.0, "leaves_c"_a = 3.0, "seconds"_a = 10.0)
      .def_ro("window_c", &Arrival::window_c)
      .def_ro("leaves_c", &Arrival::leaves_c)
      .def_ro("seconds", &Arrival::seconds);
  nb::class_<HeaterOptions>(m, "HeaterOptions")
      .def(
          "__init__",
          [](HeaterOptions* self, uint32_t sensor_oid, uint32_t output_oid, bool pwm, uint32_t full,
             uint32_t adc_full, const SensorQuery& query, double longest_s, double max_power,
             const Arrival& arrival, const Points& celsius, double low_share, double high_share,
             bool open_is_high, const Control& control, const ProtectionLimits& limits,
             const std::optional<HeatModel>& model, int32_t fan_target, double fan_full,
             bool inverted, heat::Converter converter, uint32_t spi_oid,
             const nb::bytes& clears_faults,
             const std::vector<std::pair<uint32_t, bool>>& further) {
            const auto* clears = reinterpret_cast<const uint8_t*>(clears_faults.c_str());
            new (self)
                HeaterOptions{sensor_oid,   output_oid,
                              pwm,          full,
                              adc_full,     query,
                              longest_s,    max_power,
                              arrival,      heat::Curve(celsius),
                              low_share,    high_share,
                              open_is_high, control,
                              limits,       model,
                              fan_target,   fan_full,
                              inverted,     converter,
                              spi_oid,      wire::Bytes(clears, clears + clears_faults.size()),
                              further};
          },
          "sensor_oid"_a, "output_oid"_a, "pwm"_a, "full"_a, "adc_full"_a, "query"_a, "longest_s"_a,
          "max_power"_a, "arrival"_a, "celsius"_a, "low_share"_a, "high_share"_a, "open_is_high"_a,
          "control"_a, "limits"_a, "model"_a.none(), "fan_target"_a = -1, "fan_full"_a = 1.0,
          "inverted"_a = false, "converter"_a = heat::Converter::none, "spi_oid"_a = 0,
          "clears_faults"_a = nb::bytes(""), "further"_a = nb::list(),
          "longest_s: time after which the board switches the power off if it is not "
          "renewed.\nfan_target: index of the fan's output among the link's pins.\n"
          "further: oids of outputs that switch with the first one, and whether they are "
          "inverted.");
  nb::class_<Heater>(m, "Heater", "A heater loop that runs in the thread of the link.")
      .def_prop_ro("celsius", &held<&Heater::celsius>)
      .def_prop_ro("fraction", &held<&Heater::fraction>,
                   "The sensor's last report as a fraction of the ADC's full scale; 0 before the "
                   "first one.")
      .def_prop_ro("connected", &held<&Heater::connected>,
                   "The sensor has reported, and the link has not been lost since.")
      .def_prop_ro("reported", &held<&Heater::reported>,
                   "Board clock of the sensor's last report; None before the first one.")
      .def_prop_rw("target", &held<&Heater::target>, &held<&Heater::set_target, double>)
      .def_prop_rw("suspended", &held<&Heater::suspended>, &held<&Heater::set_suspended, bool>,
                   "Nothing heats; the target is kept, and may change.")
      .def_prop_ro("power", &held<&Heater::power>)
      .def_prop_ro("max_power", [](const Heater& h) { return h.options().max_power; })
      .def_prop_ro("reached", &held<&Heater::reached>,
                   "The heater has reached its target since the target was set.")
      .def_prop_ro("settled", &held<&Heater::settled>,
                   "The heater has been at its target for as long as `arrival` requires.")
      .def_prop_ro("arrival", [](const Heater& h) { return h.options().arrival; })
      .def_prop_ro("terms", &held<&Heater::terms>)
      .def_prop_ro("control", &held<&Heater::control>)
      .def("set_control", &held<&Heater::set_control, const Control&>, "control"_a,
           "Sets the controller, which acts at once. The protections also use the model.")
      .def_prop_rw(
          "model",
          [](Heater& h) {
            std::lock_guard lock(h.guard());
            return h.body() ? std::optional(h.body()->model()) : std::nullopt;
          },
          &held<&Heater::set_model, const std::optional<HeatModel>&>, nb::arg().none(),
          "The thermal model that the protections use; None: they do without.")
      .def_prop_rw("limits", &held<&Heater::limits>,
                   &held<&Heater::set_limits, const heat::ProtectionLimits&>)
      .def_prop_rw("fan", &held<&Heater::fan>, &held<&Heater::set_fan, double>,
                   "Speed of the fan that cools this heater, 0 to 1, for its model.")
      .def_prop_ro(
          "fault",
          [](Heater& h) {
            std::lock_guard lock(h.guard());
            return h.faulty() ? std::optional(h.fault()) : std::nullopt;
          },
          "The present fault, or None. During a fault the target is kept, but the heater is off.")
      .def("set_sensor", &held<&Heater::set_sensor, const HeaterOptions&>, "options"_a,
           "Uses the table, the limits for a broken sensor and the query of these options, from "
           "the next report on.")
      .def("asked_anew", &held<&Heater::asked_anew>,
           "The host has sent the query for the sensor's reports again, with the sensor's own "
           "range.")
      .def("rearm", &held<&Heater::rearm>,
           "Clears the fault: the heater heats to the target that it has kept.")
      .def(
          "take_samples",
          [](Heater& h) {
            std::lock_guard lock(h.guard());
            std::vector<HeatSample> taken(h.samples().begin(), h.samples().end());
            h.samples().clear();
            return taken;
          },
          "The samples since the last call, at most the newest 4096, oldest first.");
}

// A heater and its body without a board. Readings are exact to a thousandth of a degree.
void bind_heat_run(nb::module_& m) {
  nb::class_<HeatRun>(m, "HeatRun",
                      "A heater loop and the heated mass, without a board. It predicts how long "
                      "heating takes, as on a simulated printer.")
      .def(
          "__init__",
          [](HeatRun* self, const HeatModel& body, const Control& control, const Arrival& arrival,
             double max_power, const ProtectionLimits& limits,
             const std::optional<HeatModel>& model) {
            constexpr double kLow = -273, kHigh = 1727;  // °C
            constexpr uint32_t kFull = 2'000'000;
            Points celsius{{0.0, kLow}, {1.0, kHigh}}, shares{{kLow, 0.0}, {kHigh, 1.0}};
            HeaterOptions options{.sensor_oid = 0,
                                  .output_oid = 0,
                                  .pwm = true,
                                  .full = 255,
                                  .adc_full = kFull,
                                  .query = {},
                                  .longest_s = 3,
                                  .max_power = max_power,
                                  .arrival = arrival,
                                  .celsius = heat::Curve(celsius),
                                  .low_share = 0,
                                  .high_share = 1,
                                  .open_is_high = true,
                                  .control = control,
                                  .limits = limits,
                                  .model = model};
            HeatedBody plant{.heater_pin = 0,
                             .sensor_pin = 0,
                             .ambient_c = body.ambient_c,
                             .rise_c = body.rise_c,
                             .time_constant_s = body.time_constant_s,
                             .sensor_time_constant_s = body.sensor_lag_s,
                             .adc_ratio = heat::Curve(shares)};
            plant.fan_loss = body.fan_loss;
            new (self) HeatRun(std::move(options), std::move(plant));
          },
          "body"_a, "control"_a, "arrival"_a, "max_power"_a, "limits"_a, "model"_a.none())
      .def("run", &HeatRun::run, "seconds"_a, "Lets time pass.")
      .def("set_fan", &HeatRun::set_fan, "speed"_a,
           "Sets the speed of the fan that cools the heated mass, 0 to 1.")
      .def_prop_ro("heater", &HeatRun::heater, nb::rv_policy::reference_internal);
}

}  // namespace

void bind_heat(nb::module_& m) {
  bind_controls(m);
  bind_protections(m);
  bind_heater(m);
  bind_heat_run(m);
}
