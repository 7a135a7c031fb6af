#include "sim/converter_chip.hpp"

namespace passo::wire {

bool ConverterChip::has_registers() const {
  return kind_ == heat::Converter::max31856 || kind_ == heat::Converter::max31865;
}

Bytes ConverterChip::word(double share) const {
  bool open = share >= 1, shorted = share <= 0;
  if (kind_ == heat::Converter::max6675) return bytes(open || shorted ? 4 : of(share), 2);
  uint32_t fault = open ? 0x10001 : 0x10002;
  return bytes(open || shorted ? fault : of(share) | kOwnTemperature, 4);
}

Bytes ConverterChip::read(uint8_t address, double share) {
  const bool platinum = kind_ == heat::Converter::max31865;
  measure(share);
  if (address == (platinum ? 0x01 : 0x0c))
    return bytes(word_ << (platinum ? 0 : 8) | (platinum ? faults_ != 0 : faults_),
                 platinum ? 2 : 4);
  if (address == (platinum ? 0x07 : 0x0f)) return {uint8_t(faults_)};
  return {settings_[address % settings_.size()]};
}

void ConverterChip::take(const Bytes& in) {
  if (!has_registers() || in.size() < 2 || !(in[0] & 0x80)) return;
  for (size_t i = 1; i < in.size(); ++i) settings_[((in[0] & 0x7f) + i - 1) & 1] = in[i];
  if (kind_ == heat::Converter::max31865 && in[0] == 0x80 && (in[1] & 0x2e) == 0x02) faults_ = 0;
}

uint32_t ConverterChip::of(double share) const {
  return heat::converter_word(kind_, heat::converter_steps(kind_, share));
}

Bytes ConverterChip::bytes(uint32_t word, int size) {
  Bytes out;
  for (int shift = 8 * (size - 1); shift >= 0; shift -= 8) out.push_back(uint8_t(word >> shift));
  return out;
}

void ConverterChip::measure(double share) {
  if (kind_ == heat::Converter::max31856) {
    if ((settings_[0] & 0x90) != 0x90) return;
    word_ = of(share);
    faults_ = share >= 1 ? 0x01 : share <= 0 ? 0x02 : 0;
  } else {
    if ((settings_[0] & 0xc0) != 0xc0) return;
    word_ = of(share);
    faults_ |= share >= 1 ? 0x80 : share <= 0 ? 0x40 : 0;  // stays until the host clears it
  }
}

}  // namespace passo::wire
