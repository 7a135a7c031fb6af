// A simulated converter for a thermocouple or a platinum resistor, according to its data sheet.
#pragma once
#include <array>
#include <cstdint>

#include "heat/converter.hpp"
#include "link/device.hpp"

namespace passo::wire {

// MAX31855 and MAX6675 answer with a data word. MAX31856 and MAX31865 have registers: the first
// byte of a transfer is an address, and its highest bit means a write. They measure only after a
// command starts the conversion.
class ConverterChip {
 public:
  explicit ConverterChip(heat::Converter kind) : kind_(kind) {}

  bool has_registers() const;
  int spi_mode() const { return has_registers() ? 1 : 0; }
  // word(): the answer of a chip without registers, if its sensor reads this fraction of full
  // scale. 1 is an open sensor, 0 a short circuit. read(): the bytes after the address, for a chip
  // with registers.
  Bytes word(double share) const;
  Bytes read(uint8_t address, double share);
  void take(const Bytes& in);
  // The registers that were written: settings and thermocouple type of a MAX31856, settings of a
  // MAX31865.
  uint8_t setting(size_t address) const { return settings_.at(address); }

 private:
  static constexpr uint32_t kOwnTemperature = 25 << 8;  // of a MAX31855, °C
  heat::Converter kind_;
  std::array<uint8_t, 2> settings_{};
  uint32_t word_ = 0, faults_ = 0;

  uint32_t of(double share) const;
  static Bytes bytes(uint32_t word, int size);
  // Measures if continuous conversion is on. A MAX31856 also needs the detection of open wires, a
  // MAX31865 the bias voltage.
  void measure(double share);
};

}  // namespace passo::wire
