// A simulated Trinamic motor driver: its registers, which the board accesses by UART or SPI.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <utility>

#include "link/frame.hpp"

namespace passo::wire {

class TrinamicChip {
 public:
  enum class Kind : uint8_t {
    tmc2208,
    tmc2209,
    tmc2225,
    tmc2226,
    tmc2130,
    tmc5160,
    tmc2240,
    tmc2660
  };

  // Faults: the chip does not answer; this number of its next answers have a wrong bit.
  bool plugged = true;
  uint32_t damaged_answers = 0;

  explicit TrinamicChip(Kind kind, uint8_t address = 0);

  static constexpr int kShortBits = 20;  // of a TMC2660's datagram
  bool by_short_spi() const { return kind_ == Kind::tmc2660; }
  Kind kind() const { return kind_; }
  // The version is in a register of the UART.
  bool by_uart() const { return kind_ <= Kind::tmc2226; }
  uint32_t read(uint8_t reg) const { return registers_[reg & 0x7f]; }
  // Sets a status register, which a real chip sets itself.
  void set(uint8_t reg, uint32_t value) { registers_[reg & 0x7f] = value; }

  // A register gets this value after the next time it is read.
  void set_after_read(uint8_t reg, uint32_t value) { later_ = {reg, value}; }

  // Resets all settings, as after power-on.
  void power_on();

  // One UART datagram. Returns the answer, or nothing.
  Bytes datagram(const Bytes& in);

  // Number of bits from the end of a UART request to its answer (SENDDELAY).
  int answer_delay() const { return 8 * int(registers_[kSlaveconf] >> 8 & 0xe) + 8; }

  // SPI: answer() returns the five bytes that the chip sends while it receives those of take(). A
  // TMC2660 answers in 20 bits, and takes the last 20.
  Bytes answer();
  void take(const Bytes& in);

  // CRC with the polynomial x⁸ + x² + x + 1, lowest bit of each byte first (TMC2209 data sheet,
  // 4.2).
  static uint8_t checksum(const uint8_t* bytes, size_t size);

 private:
  static constexpr uint8_t kGstat = 0x01, kIfcnt = 0x02, kSlaveconf = 0x03;
  Kind kind_;
  uint8_t address_;
  std::array<uint32_t, 128> registers_{};
  uint32_t last_ = 0;  // answer of the next SPI datagram
  std::optional<std::pair<uint8_t, uint32_t>> later_;

  // A TMC2660's answers are at these addresses; RDSEL in DRVCONF selects one of them.
  static constexpr uint8_t kReadRsp = 0x10, kDrvConf = 0x07;
  uint32_t version() const;
  uint32_t fetch(uint8_t reg);
  bool readable(uint8_t reg) const;
  void write(uint8_t reg, uint32_t value);
  void take20(const Bytes& in);
  static uint32_t word(const uint8_t* b);
  static void put(uint8_t* b, uint32_t value);
};

}  // namespace passo::wire
