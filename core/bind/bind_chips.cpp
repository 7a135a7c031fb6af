// Python interface of chips around a simulated board: drivers, converters, accelerometers, probes.
#include <nanobind/nanobind.h>
#include <nanobind/stl/function.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/vector.h>

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "bind/bind_numbers.hpp"
#include "sim/accelerometer_chip.hpp"
#include "sim/converter_chip.hpp"
#include "sim/digipot.hpp"
#include "sim/head_dynamics.hpp"
#include "sim/ldc1612_chip.hpp"
#include "sim/simulated_device.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo::wire;

void bind_chips(nb::module_& m) {
  nb::enum_<TrinamicChip::Kind>(m, "TrinamicKind")
      .value("TMC2208", TrinamicChip::Kind::tmc2208)
      .value("TMC2209", TrinamicChip::Kind::tmc2209)
      .value("TMC2225", TrinamicChip::Kind::tmc2225)
      .value("TMC2226", TrinamicChip::Kind::tmc2226)
      .value("TMC2130", TrinamicChip::Kind::tmc2130)
      .value("TMC5160", TrinamicChip::Kind::tmc5160)
      .value("TMC2240", TrinamicChip::Kind::tmc2240)
      .value("TMC2660", TrinamicChip::Kind::tmc2660);
  nb::class_<TrinamicChip>(m, "TrinamicChip", "A simulated motor driver with registers.")
      .def(nb::init<TrinamicChip::Kind, uint8_t>(), "kind"_a, "address"_a = 0)
      .def("read", &TrinamicChip::read, "register"_a)
      .def("set", &TrinamicChip::set, "register"_a, "value"_a,
           "Sets the status flags that the chip detects itself.")
      .def("set_after_read", &TrinamicChip::set_after_read, "register"_a, "value"_a,
           "A register gets this value after the next time it is read.")
      .def("power_on", &TrinamicChip::power_on,
           "Simulates a power failure: the chip loses its settings.")
      .def_rw("plugged", &TrinamicChip::plugged)
      .def_rw("damaged_answers", &TrinamicChip::damaged_answers,
              "This number of its next answers has a wrong bit.");
  m.def(
      "add_uart_driver",
      [](Bench& bench, uint32_t rx_pin, uint32_t tx_pin, std::shared_ptr<TrinamicChip> chip) {
        Plant& plant = bench.plant();
        if (!plant.uart(rx_pin)) plant.uarts.emplace_back(rx_pin, tx_pin);
        plant.uart(rx_pin)->chips.push_back(std::move(chip));
      },
      "bench"_a, "rx_pin"_a, "tx_pin"_a, "chip"_a,
      "Connects a driver to the UART on these pins. Several drivers may share them.");
  m.def(
      "add_spi_driver",
      [](Bench& bench, uint32_t select_pin, uint32_t clock_pin, uint32_t to_device,
         uint32_t from_device, std::shared_ptr<TrinamicChip> chip) {
        bench.plant().spi_devices.emplace_back(
            SpiPins{select_pin, clock_pin, to_device, from_device}, 3,
            [chip](Ticks) { return chip->answer(); }, [chip](const Bytes& in) { chip->take(in); },
            nullptr, chip->by_short_spi() ? TrinamicChip::kShortBits : 0);
      },
      "bench"_a, "select_pin"_a, "clock_pin"_a, "to_device"_a, "from_device"_a, "chip"_a,
      "Connects a driver to the SPI bus on these pins.");
  nb::class_<StallSensor>(m, "StallSensor", "The stall detection of a simulated motor driver.")
      .def_prop_ro("result", &StallSensor::result, "The load value; it falls as the load rises.")
      .def_prop_ro("stalls", &StallSensor::stalls, "How often the DIAG pin has shown a stall.")
      .def_rw("friction", &StallSensor::friction,
              "The load of free travel, as a fraction of the torque with full current.")
      .def_rw("noise", &StallSensor::noise, "The noise of the load value, as a fraction.")
      .def_rw("stuck", &StallSensor::stuck, "A fault: the pin shows a stall all the time.");
  m.def(
      "add_stall_sensor",
      [](Bench& bench, std::shared_ptr<TrinamicChip> chip, uint32_t step_pin, uint32_t diag_pin,
         int output) {
        auto sensor = std::make_shared<StallSensor>(std::move(chip), step_pin, diag_pin, output);
        bench.plant().add_stall_sensor(sensor);
        return sensor;
      },
      "bench"_a, "chip"_a, "step_pin"_a, "diag_pin"_a, "output"_a,
      "Connects a DIAG pin of a driver, DIAG0 or DIAG1, whose motor has its actuator already.");
  m.def(
      "add_travel_stop",
      [](Bench& bench, std::vector<std::pair<uint32_t, double>> weights, double position,
         bool at_maximum) {
        bench.plant().stops.push_back({std::move(weights), position, at_maximum});
      },
      "bench"_a, "weights"_a, "position"_a, "at_maximum"_a,
      "Adds a mechanical stop at the weighted sum of actuators: (step pin, weight).");
  nb::class_<Digipot>(m, "Digipot", "A simulated digital potentiometer that sets motor currents.")
      .def("wiper", &Digipot::wiper, "channel"_a, "0 to 255.");
  m.def(
      "add_digipot",
      [](Bench& bench, uint32_t select_pin, uint32_t clock_pin, uint32_t to_device,
         uint32_t from_device) {
        auto chip = std::make_shared<Digipot>();
        bench.plant().spi_devices.emplace_back(
            SpiPins{select_pin, clock_pin, to_device, from_device}, 0,
            [](Ticks) { return Bytes(); }, [chip](const Bytes& in) { chip->take(in); });
        return chip;
      },
      "bench"_a, "select_pin"_a, "clock_pin"_a, "to_device"_a, "from_device"_a,
      "Connects a digital potentiometer to the SPI bus on these pins.");
  nb::class_<ConverterChip>(m, "ConverterChip", "A simulated thermocouple or RTD converter.")
      .def("setting", &ConverterChip::setting, "address"_a,
           "A configuration register: of a MAX31856 the modes (0) and the thermocouple type (1), "
           "of a MAX31865 the modes (0).");
  m.def(
      "add_converter",
      [](Bench& bench, uint32_t select_pin, uint32_t clock_pin, uint32_t to_device,
         uint32_t from_device, passo::heat::Converter converter) {
        Plant& plant = bench.plant();
        auto chip = std::make_shared<ConverterChip>(converter);
        auto share = [&plant, select_pin](Ticks clock) { return plant.share(select_pin, clock); };
        SpiPins pins{select_pin, clock_pin, to_device, from_device};
        auto take = [chip](const Bytes& in) { chip->take(in); };
        if (chip->has_registers())
          plant.spi_devices.emplace_back(
              pins, chip->spi_mode(), [](Ticks) { return Bytes{0xff}; }, take,
              [chip, share](uint8_t address, Ticks clock) {
                return chip->read(address, share(clock));
              });
        else
          plant.spi_devices.emplace_back(
              pins, chip->spi_mode(),
              [chip, share](Ticks clock) { return chip->word(share(clock)); }, take);
        return chip;
      },
      "bench"_a, "select_pin"_a, "clock_pin"_a, "to_device"_a, "from_device"_a, "converter"_a,
      "Connects a converter to the SPI bus on these pins. It measures the heated mass whose sensor "
      "is on the select pin.");
  nb::enum_<AccelerometerChip::Kind>(m, "AccelerometerKind")
      .value("ADXL345", AccelerometerChip::Kind::adxl345)
      .value("LIS2DW", AccelerometerChip::Kind::lis2dw);
  nb::class_<AccelerometerChip>(m, "AccelerometerChip", "A simulated accelerometer.")
      .def(
          "ride",
          [](AccelerometerChip& chip, std::shared_ptr<HeadDynamics> head, double ratio,
             double offset) {
            passo::positive(ratio, "ratio"), passo::finite(offset, "offset");
            chip.place(
                [head, ratio, offset](Ticks clock) {
                  head->run(double(clock) * ratio + offset);
                  return std::array{head->mass(0).velocity(), head->mass(1).velocity(),
                                    head->mass(2).velocity()};
                },
                [head](bool on) { head->follow(on); });
          },
          "head"_a, "ratio"_a, "offset"_a,
          "The chip moves with this head, which follows its motors while the chip measures. "
          "`ratio` "
          "is the length of a tick of the chip's board in ticks of the main board, and `offset` "
          "the "
          "main board's clock when that of the chip's board is 0.")
      .def(
          "put_down",
          [](AccelerometerChip& chip) {
            chip.place([](Ticks) { return std::array<double, 3>{}; }, [](bool) {});
          },
          "The chip lies still.")
      .def_rw("plugged", &AccelerometerChip::plugged)
      .def_rw("nacks", &AccelerometerChip::nacks,
              "This number of its next addresses on I2C is not acknowledged.")
      .def_rw("rate_error", &AccelerometerChip::rate_error,
              "The deviation of its sample rate, as a fraction.");
  m.def(
      "add_accelerometer",
      [](Bench& bench, uint32_t select_pin, uint32_t clock_pin, uint32_t to_device,
         uint32_t from_device, AccelerometerChip::Kind kind, double clock_hz) {
        auto chip = std::make_shared<AccelerometerChip>(kind, clock_hz);
        bench.plant().spi_devices.emplace_back(
            SpiPins{select_pin, clock_pin, to_device, from_device}, 3,
            [chip](Ticks clock) { return chip->answer(clock); },
            [chip](const Bytes& in) { chip->take(in); },
            [chip](uint8_t address, Ticks clock) { return chip->read(address, clock); });
        return chip;
      },
      "bench"_a, "select_pin"_a, "clock_pin"_a, "to_device"_a, "from_device"_a, "kind"_a,
      "clock_hz"_a, "Connects an accelerometer, which lies still, to the SPI bus on these pins.");
  nb::class_<LedChip>(m, "LedChip", "A simulated chip that sets LEDs.")
      .def(
          "register", [](const LedChip& chip, size_t at) { return chip.registers.at(at); }, "at"_a,
          "The value of one of its 16 registers.");
  m.def(
      "add_i2c_accelerometer",
      [](Bench& bench, uint32_t clock_pin, uint32_t data_pin, uint8_t address,
         AccelerometerChip::Kind kind, double clock_hz) {
        auto chip = std::make_shared<AccelerometerChip>(kind, clock_hz);
        bench.plant().i2c_devices.emplace_back(I2cPins{clock_pin, data_pin}, address,
                                               AccelerometerChip::on_i2c(chip));
        return chip;
      },
      "bench"_a, "clock_pin"_a, "data_pin"_a, "address"_a, "kind"_a, "clock_hz"_a,
      "Connects an accelerometer, which lies still, to the I2C bus on these pins.");
  nb::class_<Ldc1612Chip>(m, "Ldc1612Chip", "A simulated LDC1612 with a coil above the bed.")
      .def("frequency", &Ldc1612Chip::frequency, "mm"_a,
           "The frequency of the coil at a distance from the bed, Hz.")
      .def_rw("plugged", &Ldc1612Chip::plugged)
      .def_rw("open", &Ldc1612Chip::open, "The coil is broken.")
      .def_rw("celsius", &Ldc1612Chip::celsius, "The temperature of the coil.")
      .def_rw("noise_hz", &Ldc1612Chip::noise_hz)
      .def_rw("curve", &Ldc1612Chip::curve, "Heights in mm, rising, and frequencies in Hz.");
  m.def(
      "add_ldc1612",
      [](Bench& bench, uint32_t clock_pin, uint32_t data_pin, uint8_t address, uint32_t probe_pin,
         double clock_hz) {
        auto chip = std::make_shared<Ldc1612Chip>(
            clock_hz, [&bench, probe_pin] { return bench.gap(probe_pin); });
        bench.plant().i2c_devices.emplace_back(I2cPins{clock_pin, data_pin}, address,
                                               Ldc1612Chip::on_i2c(chip));
        return chip;
      },
      "bench"_a, "clock_pin"_a, "data_pin"_a, "address"_a, "probe_pin"_a, "clock_hz"_a,
      "Connects an LDC1612 to the I2C bus on these pins. Its coil is the probe on `probe_pin`.");
  m.def(
      "add_led_chip",
      [](Bench& bench, uint32_t clock_pin, uint32_t data_pin, uint8_t address) {
        auto chip = std::make_shared<LedChip>();
        bench.plant().i2c_devices.emplace_back(
            I2cPins{clock_pin, data_pin}, address,
            I2cChip{[chip](bool, Ticks) { return chip->begin(); },
                    [chip](uint8_t byte, Ticks) { return chip->take(byte); },
                    [](Ticks) { return uint8_t(0); }});
        return chip;
      },
      "bench"_a, "clock_pin"_a, "data_pin"_a, "address"_a,
      "Connects a chip that sets LEDs to the I2C bus on these pins.");
  m.def(
      "add_i2c_chip",
      [](Bench& bench, uint32_t clock_pin, uint32_t data_pin, uint8_t address,
         std::function<bool(bool, Ticks)> begin, std::function<bool(uint8_t, Ticks)> take,
         std::function<uint8_t(Ticks)> give) {
        bench.plant().i2c_devices.emplace_back(
            I2cPins{clock_pin, data_pin}, address,
            I2cChip{std::move(begin), std::move(take), std::move(give)});
      },
      "bench"_a, "clock_pin"_a, "data_pin"_a, "address"_a, "begin"_a, "take"_a, "give"_a,
      "Connects a chip in Python to the I2C bus on these pins. It is addressed by `begin`, for a "
      "write or, if True, for a read; it receives a byte by `take`; both return whether it "
      "acknowledges. It sends a byte by `give`. Each call has the clock.");
}
