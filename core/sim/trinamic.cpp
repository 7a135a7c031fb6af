#include "sim/trinamic.hpp"

namespace passo::wire {

TrinamicChip::TrinamicChip(Kind kind, uint8_t address) : kind_(kind), address_(address) {
  power_on();
}

void TrinamicChip::power_on() {
  registers_.fill(0);
  registers_[kGstat] = 1;
  registers_[by_uart() ? 0x06 : 0x04] = version() << 24;
  if (by_uart()) registers_[0x00] = 0x101;
  if (kind_ == Kind::tmc2240) {
    registers_[0x0a] = 0;
    registers_[0x50] = 2466;  // 24 V
    registers_[0x51] = 2230;  // 25 C
    registers_[0x52] = 0x0b920f25;
  }
  registers_[0x6c] = by_uart() ? 0x10000053 : 0;
  last_ = 0;
  later_.reset();
}

Bytes TrinamicChip::datagram(const Bytes& in) {
  size_t size = in.size();
  if (!plugged || size < 4 || (in[0] & 0x0f) != 0x05 || in[1] != address_) return {};
  if (checksum(in.data(), size - 1) != in.back()) return {};
  bool write = in[2] & 0x80;
  uint8_t reg = in[2] & 0x7f;
  if (size == 8 && write) {
    this->write(reg, word(&in[3]));
    registers_[kIfcnt] = (registers_[kIfcnt] + 1) & 0xff;
    return {};
  }
  if (size != 4 || write) return {};
  Bytes out{0x05, 0xff, reg, 0, 0, 0, 0, 0};
  put(&out[3], readable(reg) ? fetch(reg) : 0);
  out[7] = checksum(out.data(), 7);
  if (damaged_answers > 0) --damaged_answers, out[5] ^= 0x10;
  return out;
}

Bytes TrinamicChip::answer() {
  Bytes out(5, plugged ? 0 : 0xff);
  if (!plugged) return out;
  if (by_short_spi()) {
    uint32_t value = fetch(uint8_t(kReadRsp + (registers_[kDrvConf] >> 4 & 3)));
    put(&out[0], value << 12);
    if (damaged_answers > 0) --damaged_answers, out[1] ^= 0x10;
    return out;
  }
  out[0] = uint8_t(registers_[kGstat] & 3);
  put(&out[1], last_);
  if (damaged_answers > 0) --damaged_answers, out[3] ^= 0x10;
  return out;
}

void TrinamicChip::take(const Bytes& in) {
  if (!plugged || in.size() != 5) return;
  if (by_short_spi()) return take20(in);
  uint8_t reg = in[0] & 0x7f;
  if (in[0] & 0x80) {
    last_ = word(&in[1]);
    write(reg, last_);
    return;
  }
  last_ = readable(reg) ? fetch(reg) : 0;
  if (reg == kGstat && kind_ == Kind::tmc2130) registers_[reg] = 0;
}

void TrinamicChip::take20(const Bytes& in) {
  uint32_t datagram = word(&in[1]) & 0xfffff;
  registers_[datagram >> 17] = datagram & 0x1ffff;
  if (datagram >> 18 == 0) registers_[0] = datagram;  // DRVCTRL has 18 bits
}

uint32_t TrinamicChip::fetch(uint8_t reg) {
  uint32_t value = registers_[reg];
  if (later_ && later_->first == reg) {
    registers_[reg] = later_->second;
    later_.reset();
  }
  return value;
}

uint8_t TrinamicChip::checksum(const uint8_t* bytes, size_t size) {
  uint8_t crc = 0;
  for (size_t i = 0; i < size; ++i)
    for (int bit = 0; bit < 8; ++bit) {
      bool one = (crc >> 7) != (bytes[i] >> bit & 1);
      crc = uint8_t((crc << 1) ^ (one ? 0x07 : 0));
    }
  return crc;
}

uint32_t TrinamicChip::version() const {
  switch (kind_) {
    case Kind::tmc2208:
    case Kind::tmc2225:
      return 0x20;
    case Kind::tmc2209:
    case Kind::tmc2226:
      return 0x21;
    case Kind::tmc2130:
      return 0x11;
    case Kind::tmc5160:
      return 0x30;
    case Kind::tmc2240:
      return 0x40;
    case Kind::tmc2660:
      break;
  }
  return 0;
}

bool TrinamicChip::readable(uint8_t reg) const {
  static constexpr uint8_t kAll[] = {0x00, 0x01, 0x6a, 0x6b, 0x6c, 0x6f};
  static constexpr uint8_t kUart[] = {0x02, 0x05, 0x06, 0x07, 0x12, 0x41, 0x70, 0x71, 0x72};
  static constexpr uint8_t kSpi[] = {0x04, 0x0c, 0x12, 0x2d, 0x71, 0x72, 0x73};
  static constexpr uint8_t k2240[] = {0x02, 0x03, 0x0a, 0x0b, 0x10, 0x50,
                                      0x51, 0x52, 0x70, 0x74, 0x75, 0x76};
  for (uint8_t r : kAll)
    if (r == reg) return true;
  if (by_uart()) {
    for (uint8_t r : kUart)
      if (r == reg) return true;
    return false;
  }
  for (uint8_t r : kSpi)
    if (r == reg) return true;
  if (kind_ == Kind::tmc2240)
    for (uint8_t r : k2240)
      if (r == reg) return true;
  return false;
}

void TrinamicChip::write(uint8_t reg, uint32_t value) {
  if (reg == kGstat) {
    if (kind_ != Kind::tmc2130) registers_[reg] &= ~value;
  } else if (reg != kIfcnt && reg != 0x04 && reg != 0x06 && reg != 0x6f) {
    registers_[reg] = value;
  }
}

uint32_t TrinamicChip::word(const uint8_t* b) {
  return uint32_t(b[0]) << 24 | uint32_t(b[1]) << 16 | uint32_t(b[2]) << 8 | b[3];
}

void TrinamicChip::put(uint8_t* b, uint32_t value) {
  for (int i = 0; i < 4; ++i) b[i] = uint8_t(value >> (24 - 8 * i));
}

}  // namespace passo::wire
