// Serial devices of the virtual board: UARTs of motor drivers, SPI and I2C devices, converters,
// accelerometers and lights. They exchange whole datagrams.
#pragma once
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <utility>
#include <variant>

#include "sim/board_eddy.hpp"
#include "sim/board_protocol.hpp"
#include "sim/simulated_device.hpp"

namespace passo::wire {

inline constexpr uint32_t kMinPeriodTicks =
    100;                                  // a shorter period would keep the board busy all the time
inline constexpr size_t kUartBytes = 10;  // maximum of bits as bytes, in either direction

// A UART. Its answers come at the same time as those of the real firmware.
class BoardUart {
 public:
  BoardUart(uint32_t rx_pin, Ticks bit) : rx_pin_(rx_pin), bit_(bit) {}

  Ticks next() const { return due_; }
  // Returns false while the UART is busy.
  bool send(Ticks now, Ticks rest, const Bytes& bits, size_t read, Plant& plant);
  Bytes take();

 private:
  static constexpr int kTimeout = 68;  // bits, after the end of the request
  uint32_t rx_pin_;
  Ticks bit_, due_ = kNever;
  Bytes answer_;
};

// An SPI device with a select pin, or one that is always selected.
struct BoardSpi {
  std::optional<uint32_t> select_pin;
  bool has_bus = false;
  uint32_t to_device = 0, clock = 0;

  explicit BoardSpi(std::optional<uint32_t> pin) : select_pin(pin) {}
  static Ticks next() { return kNever; }
  Bytes transfer(Ticks now, const Bytes& data, Plant& plant) const;
};

// An I2C device with an address on two lines.
struct BoardI2c {
  I2cPins pins{};
  uint8_t address = 0;
  bool has_bus = false;

  static Ticks next() { return kNever; }
  I2cStatus transfer(Ticks now, const Bytes& out, Bytes& in, Plant& plant) const;
};

// A converter that is read every `rest` ticks. The board shuts down if `max_faults` words in a row
// are outside minimum…maximum or report a fault.
struct BoardThermocouple {
  // How a type of converter is read: the registers of its reading and its faults, if it has
  // registers; the number of bytes of the reading; and the bit of the reading that reports a fault,
  // if there is no fault register.
  struct Type {
    std::optional<uint8_t> word_register, fault_register;
    size_t bytes;
    uint32_t fault_bit;
  };
  uint32_t spi_oid;
  Type type;
  Ticks begin = kNever, rest = 0;
  uint32_t minimum = 0, maximum = 0, max_faults = 0, faults = 0;

  BoardThermocouple(uint32_t spi, uint32_t type) : spi_oid(spi), type(type_of(type)) {}
  Ticks next() const { return begin; }
  void watch(uint32_t word, bool fault);

 private:
  // `number` is a value of the enumeration `thermocouple_type`.
  static Type type_of(uint32_t number);
};

// An accelerometer on an SPI or I2C bus. The board empties its FIFO every `rest` ticks and reports
// the samples in blocks.
struct BoardAccelerometer {
  uint32_t bus_oid;
  bool lis2dw, on_i2c;
  Ticks begin = kNever, rest = 0;
  uint16_t sequence = 0, overflows = 0;
  Bytes data;

  BoardAccelerometer(uint32_t bus, bool lis, bool i2c) : bus_oid(bus), lis2dw(lis), on_i2c(i2c) {}
  Ticks next() const { return begin; }
  size_t sample_bytes() const { return lis2dw ? 6 : 5; }
  // Size of a full block, which fits into a frame.
  size_t block_bytes() const { return kBlockBytes / sample_bytes() * sample_bytes(); }
  // Takes one sample from the chip; over I2C as many as fit into the block. Returns whether the
  // chip may have more samples.
  bool take(const BoardSpi& spi, Ticks now, Plant& plant);
  bool take(const BoardI2c& i2c, Ticks now, Plant& plant);
  // Number of samples in the chip; nothing if the transfer was disturbed.
  std::optional<size_t> waiting(const BoardSpi& spi, Ticks now, Plant& plant);
  std::optional<size_t> waiting(const BoardI2c& i2c, Ticks now, Plant& plant);

  static constexpr size_t kFifo = 32;

 private:
  std::optional<size_t> lis_waiting(uint8_t state);
  static constexpr size_t kBlockBytes = 51;
};

// A chain of lights, whose bytes the host changes before they are sent.
struct BoardLights {
  static constexpr size_t kMax = 500;
  uint32_t pin;
  Bytes data;

  BoardLights(uint32_t pin_, size_t size) : pin(pin_), data(size) {}
  static Ticks next() { return kNever; }
};

// All serial devices of one board, by their oid.
class SerialParts {
 public:
  using Part = std::variant<BoardUart, BoardSpi, BoardI2c, BoardThermocouple, BoardAccelerometer,
                            BoardLights, BoardEddy, BoardFilter, BoardTrigger>;
  using Tell = std::function<void(Report, std::initializer_list<uint32_t>, const Bytes*)>;

  // Triggers a trsync with a reason.
  using Trip = std::function<void(uint32_t oid, uint32_t reason)>;

  SerialParts(Plant& plant, double clock_hz, Tell tell, Trip trip)
      : plant_(plant), clock_hz_(clock_hz), tell_(std::move(tell)), trip_(std::move(trip)) {}

  static bool knows(Command id) { return id >= Command::config_tmcuart; }
  bool has(uint32_t oid) const { return parts_.count(oid) > 0; }
  // The part that a config command creates; nothing for other commands.
  std::optional<Part> made(Command id, const uint32_t* a);
  void add(uint32_t oid, Part part) { parts_.emplace(oid, std::move(part)); }

  using Ahead = std::function<Ticks(uint32_t clock)>;
  // `ahead` converts a 32-bit clock, and checks that it is not in the past.
  void command(Command id, const uint32_t* a, const Bytes& data, Ticks now, const Ahead& ahead);

  Ticks next() const;
  void run(Ticks now);
  void shut_down();
  void clear() { parts_.clear(); }

 private:
  static constexpr double kUartRest = 200e-6;  // pause before a datagram, s
  Plant& plant_;
  double clock_hz_;
  Tell tell_;
  Trip trip_;
  std::map<uint32_t, Part> parts_;

  void empty(uint32_t oid, BoardAccelerometer& it, Ticks now);
  // Eddy current sensors and their triggers, in eddy_parts.cpp. made_eddy() and eddy_command() do
  // nothing for other commands.
  std::optional<Part> made_eddy(Command id, const uint32_t* a);
  bool eddy_command(Command id, const uint32_t* a, Ticks now, const Ahead& ahead);
  void read(uint32_t oid, BoardEddy& it, Ticks now);
  std::optional<uint32_t> eddy_register(const BoardEddy& it, uint8_t address, Ticks now);
  void check(BoardTrigger& it, uint32_t raw, Ticks now);
  void fail(BoardTrigger& it, uint32_t error);
  // Reads this number of bytes from a register, or from a converter without registers.
  uint32_t ask(const BoardThermocouple& it, std::optional<uint8_t> address, size_t bytes,
               Ticks now);
  template <class T>
  T& get(uint32_t oid);
};

template <class T>
T& SerialParts::get(uint32_t oid) {
  auto it = parts_.find(oid);
  T* part = it == parts_.end() ? nullptr : std::get_if<T>(&it->second);
  if (!part) throw Shutdown{Fault::invalid_oid};
  return *part;
}

}  // namespace passo::wire
