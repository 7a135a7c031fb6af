// What converters of thermocouples say, in the words of their data sheets.
#pragma once
#include <cstdint>

namespace passo::heat {

enum class Converter : uint8_t { none, max31855, max6675 };
enum class ConverterFault : uint8_t { none, open, short_circuit, no_answer };

struct ConverterReading {
  int32_t quarters = 0;  // °C / 4
  ConverterFault fault = ConverterFault::none;
};

// As a share of full scale a reading is what an ADC would see: quarters of a °C from -2048 °C on;
// open at full scale, short-circuited at 0.
inline constexpr int32_t kConverterFull = 16384;

// MAX31855 (Maxim 19-5793): D31-D18 signed quarters, D17 0, D16 any fault, D3 0, D2 short to the
// supply, D1 short to ground, D0 open. MAX6675 (Maxim 19-2235): D15 0, D14-D3 unsigned quarters, D2
// open, D1 0. Where a bit is set that must be 0, nobody has answered.
inline ConverterReading read_converter(Converter converter, uint32_t word) {
  if (converter == Converter::max6675) {
    if (word & 0x8002) return {0, ConverterFault::no_answer};
    if (word & 0x0004) return {0, ConverterFault::open};
    return {int32_t(word >> 3 & 0xfff), ConverterFault::none};
  }
  if (word & 0x00020008) return {0, ConverterFault::no_answer};
  if (word & 1) return {0, ConverterFault::open};
  if (word & 0x00010006) return {0, ConverterFault::short_circuit};
  return {int32_t(word) >> 18, ConverterFault::none};
}

inline uint32_t converter_sum(Converter converter, uint32_t word) {
  ConverterReading reading = read_converter(converter, word);
  if (reading.fault == ConverterFault::short_circuit) return 0;
  if (reading.fault != ConverterFault::none) return kConverterFull;
  return uint32_t(reading.quarters + kConverterFull / 2);
}

// The word of a share of full scale: the way back, for what simulates a converter.
inline uint32_t converter_word(Converter converter, double share) {
  bool old = converter == Converter::max6675;
  if (share >= 1) return old ? 0x4 : 0x10001;
  if (share <= 0) return old ? 0x4 : 0x10002;
  int32_t quarters = int32_t(share * kConverterFull + 0.5) - kConverterFull / 2;
  if (old) return uint32_t(quarters < 0 ? 0 : quarters > 0xfff ? 0xfff : quarters) << 3;
  return uint32_t(quarters) << 18 | 25 << 8;  // the converter itself is at 25 °C
}

}  // namespace passo::heat
