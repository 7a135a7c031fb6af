// Decodes the readings of thermocouple and RTD interfaces by their data sheets.
#pragma once
#include <algorithm>
#include <cstdint>

namespace passo::heat {

enum class Converter : uint8_t { none, max31855, max31856, max31865, max6675 };
enum class ConverterFault : uint8_t { none, open, short_circuit, out_of_range, no_answer };

// The number in the data word of a converter: `bits` bits from bit `shift` on, in two's complement
// if `is_signed`. It counts in 1 / `per_unit` of a °C, or of the reference resistor. Like an ADC it
// has a full scale: `full` steps, `zero` of them below 0. An open sensor reads as full scale, a
// short-circuited one as 0.
struct ConverterScale {
  int32_t per_unit, full, zero;
  uint8_t bits, shift;
  bool is_signed;
};

inline constexpr ConverterScale scale_of(Converter converter) {
  switch (converter) {
    case Converter::max31856:
      return {128, 1 << 19, 1 << 18, 19, 5, true};
    case Converter::max31865:
      return {1 << 15, 1 << 15, 0, 15, 1, false};
    case Converter::max6675:
      return {4, 1 << 14, 1 << 13, 12, 3, false};
    default:
      return {4, 1 << 14, 1 << 13, 14, 18, true};
  }
}

struct ConverterReading {
  int32_t steps = 0;  // the converter's own number
  ConverterFault fault = ConverterFault::none;
};

// MAX31855 (Maxim 19-5793): D31-D18 signed quarters, D17 0, D16 any fault, D3 0, D2 short to the
// supply, D1 short to ground, D0 open. MAX6675 (Maxim 19-2235): D15 0, D14-D3 unsigned quarters, D2
// open, D1 0. If a bit is set that must be 0, no chip has answered.
//
// MAX31856 (Maxim 19-7534): D23-D5 signed 1/128 °C; of its faults bit 0 is open, 1 a voltage beyond
// the supply, 2 and 3 and 6 a thermocouple beyond its limits, 4 and 5 and 7 the chip itself.
// MAX31865 (Maxim 19-6478): D15-D1 share of the reference resistor, D0 any fault; of its faults bit
// 2 is a voltage beyond the supply, 3 and 4 a wire at ground, 5 an open wire, 6 and 7 a fraction of
// 0 and of 1.
inline ConverterReading read_converter(Converter converter, uint32_t word, uint32_t faults) {
  const ConverterScale scale = scale_of(converter);
  int32_t steps = int32_t(word >> scale.shift & ((1u << scale.bits) - 1));
  if (scale.is_signed && steps >> (scale.bits - 1)) steps -= 1 << scale.bits;
  auto is = [steps](ConverterFault fault) { return ConverterReading{steps, fault}; };
  switch (converter) {
    case Converter::max6675:
      if (word & 0x8002) return is(ConverterFault::no_answer);
      if (word & 0x0004) return is(ConverterFault::open);
      break;
    case Converter::max31856:
      if (faults == 0xff) return is(ConverterFault::no_answer);
      if (faults & 0x01) return is(ConverterFault::open);
      if (faults & 0x02) return is(ConverterFault::short_circuit);
      if (faults != 0) return is(ConverterFault::out_of_range);
      break;
    case Converter::max31865:
      if (faults == 0xff) return is(ConverterFault::no_answer);
      if (faults & 0xa0) return is(ConverterFault::open);
      if (faults & 0x5c) return is(ConverterFault::short_circuit);
      break;
    default:
      if (word & 0x00020008) return is(ConverterFault::no_answer);
      if (word & 1) return is(ConverterFault::open);
      if (word & 0x00010006) return is(ConverterFault::short_circuit);
  }
  return is(ConverterFault::none);
}

// The reading in steps of full scale. A converter with a fault of its own counts as an open sensor.
inline uint32_t converter_sum(Converter converter, uint32_t word, uint32_t faults) {
  constexpr uint32_t kOfChip = 0xb0;
  const ConverterScale scale = scale_of(converter);
  ConverterReading reading = read_converter(converter, word, faults);
  if (reading.fault == ConverterFault::short_circuit) return 0;
  bool known = reading.fault == ConverterFault::none ||
               (reading.fault == ConverterFault::out_of_range && !(faults & kOfChip));
  return uint32_t(known ? reading.steps + scale.zero : scale.full);
}

// The inverse: the data word for a number of steps, limited to the converter's range.
inline uint32_t converter_word(Converter converter, int32_t steps) {
  const ConverterScale scale = scale_of(converter);
  int32_t most = (1 << (scale.bits - scale.is_signed)) - 1;
  steps = std::clamp(steps, scale.is_signed ? -most - 1 : 0, most);
  return (uint32_t(steps) & ((1u << scale.bits) - 1)) << scale.shift;
}
// The number of steps for a fraction of full scale.
inline int32_t converter_steps(Converter converter, double share) {
  const ConverterScale scale = scale_of(converter);
  return int32_t(std::clamp(share, 0.0, 1.0) * scale.full + 0.5) - scale.zero;
}

}  // namespace passo::heat
