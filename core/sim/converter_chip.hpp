// A simulated converter of a thermocouple or a platinum resistor, as its data sheet has it.
#pragma once
#include <array>
#include <cstdint>

#include "heat/converter.hpp"
#include "link/device.hpp"

namespace passo::wire {

// MAX31855 and MAX6675 answer with their word. MAX31856 and MAX31865 have registers: the first byte
// of a transfer is an address, with its highest bit set to write; they measure nothing until they
// are told to.
class ConverterChip {
 public:
  explicit ConverterChip(heat::Converter kind) : kind_(kind) {}

  bool has_registers() const;
  int spi_mode() const { return has_registers() ? 1 : 0; }
  // What comes back, and of a chip with registers behind the first byte, when its sensor shows this
  // share of full scale: all of it is open, nothing is short-circuited.
  Bytes word(double share) const;
  Bytes read(uint8_t address, double share);
  void take(const Bytes& in);
  // What has been written: of a MAX31856 the settings and the type, of a MAX31865 the settings.
  uint8_t setting(size_t address) const { return settings_.at(address); }

 private:
  static constexpr uint32_t kOwnTemperature = 25 << 8;  // °C, of a MAX31855
  heat::Converter kind_;
  std::array<uint8_t, 2> settings_{};
  uint32_t word_ = 0, faults_ = 0;

  uint32_t of(double share) const;
  static Bytes bytes(uint32_t word, int size);
  // Continuous conversion is on, and with it what looks for open wires, or the resistor's supply.
  void measure(double share);
};

}  // namespace passo::wire
