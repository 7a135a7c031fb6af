#include "sim/board_serial.hpp"

#include <algorithm>
#include <iterator>
#include <tuple>

namespace passo::wire {

namespace {
constexpr size_t kI2cHead = 4;  // bytes of an I2C report before the data
}

bool BoardUart::send(Ticks now, Ticks rest, const Bytes& bits, size_t read, Plant& plant) {
  if (due_ != kNever) return false;
  if (bits.size() > kUartBytes || read > kUartBytes) throw Shutdown{Fault::uart_too_long};
  int delay = 0;
  answer_.clear();
  if (UartLine* line = plant.uart(rx_pin_)) std::tie(answer_, delay) = line->exchange(bits);
  due_ = now + rest + Ticks(8 * bits.size()) * bit_;
  if (read == 0) {
    answer_.clear();
    return true;
  }
  if (delay >= kTimeout) answer_.clear();
  Ticks look = bit_ / 4;  // four samples per bit, from the fourth bit on
  Ticks looks = answer_.empty() ? 257 : ((delay - 4) * bit_ + look - 1) / look + 1;
  due_ += 4 * bit_ + (looks - 1) * look;
  // Without an answer, the transfer ends with the last sample. Otherwise the bits are read from the
  // next sample on.
  if (!answer_.empty()) due_ += look + Ticks(8 * read - 1) * bit_;
  return true;
}

Bytes BoardUart::take() {
  due_ = kNever;
  return std::exchange(answer_, {});
}

Bytes BoardSpi::transfer(Ticks now, const Bytes& data, Plant& plant) const {
  if (!has_bus) throw Shutdown{Fault::spi_without_bus};
  if (!select_pin) {
    plant.clock_lights(to_device, clock, data, now);
    return Bytes(data.size(), 0xff);
  }
  SpiDevice* device = plant.spi_device(*select_pin);
  return device ? device->exchange(data, now) : Bytes(data.size(), 0xff);
}

I2cStatus BoardI2c::transfer(Ticks now, const Bytes& out, Bytes& in, Plant& plant) const {
  if (!has_bus) throw Shutdown{Fault::i2c_without_bus};
  I2cDevice* device = plant.i2c_device(pins, address);
  if (device) return device->exchange(out, in, now);
  return out.empty() && !in.empty() ? I2cStatus::start_read_nack : I2cStatus::start_nack;
}

void BoardThermocouple::watch(uint32_t word, bool fault) {
  if (minimum == 0 && maximum == UINT32_MAX) return;
  bool outside = word < minimum || word > maximum;
  if (!outside && !fault && !(word & type.fault_bit))
    faults = 0;
  else if (++faults >= max_faults)
    throw Shutdown{outside ? Fault::thermocouple_range : Fault::thermocouple_fault};
}

BoardThermocouple::Type BoardThermocouple::type_of(uint32_t number) {
  static const Type types[] = {
      {{}, {}, 4, 0x10000}, {0x0c, 0x0f, 3, 0}, {0x01, 0x07, 2, 0}, {{}, {}, 2, 4}};
  if (number >= std::size(types)) throw Shutdown{Fault::thermocouple_type};
  return types[number];
}

bool BoardAccelerometer::take(const BoardSpi& spi, Ticks now, Plant& plant) {
  if (lis2dw) {
    Bytes in = spi.transfer(now, {0xa8, 0, 0, 0, 0, 0, 0}, plant);
    data.insert(data.end(), in.begin() + 1, in.end());
    return waiting(spi, now, plant) != 0;
  }
  Bytes in = spi.transfer(now, {0xf2, 0, 0, 0, 0, 0, 0, 0, 0}, plant);
  size_t left = in[8] & 0x7f;
  auto extended = [&](size_t i) { return (in[i] & 0xf0) == 0 || (in[i] & 0xf0) == 0xf0; };
  if (!extended(2) || !extended(4) || !extended(6) || in[7] != 0x90 || left > kFifo) {
    data.insert(data.end(), sample_bytes(), 0xff);  // the transfer was disturbed
    return false;
  }
  data.insert(data.end(), {in[1], in[3], in[5], uint8_t((in[2] & 0x1f) | in[6] << 5),
                           uint8_t((in[4] & 0x1f) | (in[6] << 2 & 0x60))});
  if (left >= kFifo - 1) ++overflows;
  return left > 1;
}

bool BoardAccelerometer::take(const BoardI2c& i2c, Ticks now, Plant& plant) {
  const size_t count = waiting(i2c, now, plant).value_or(0);
  if (count == 0) return false;
  const size_t room = (block_bytes() - data.size()) / sample_bytes();
  Bytes in(std::min(count, room) * sample_bytes());
  if (i2c.transfer(now, {0x28}, in, plant) != I2cStatus::success) return false;
  data.insert(data.end(), in.begin(), in.end());
  return count > room;
}

std::optional<size_t> BoardAccelerometer::waiting(const BoardSpi& spi, Ticks now, Plant& plant) {
  if (lis2dw) return lis_waiting(spi.transfer(now, {0xaf, 0}, plant)[1]);
  const size_t samples = spi.transfer(now, {0xb9, 0}, plant)[1] & 0x7f;
  return samples > kFifo ? std::nullopt : std::optional(samples);
}

std::optional<size_t> BoardAccelerometer::waiting(const BoardI2c& i2c, Ticks now, Plant& plant) {
  Bytes in(1);
  if (i2c.transfer(now, {0x2f}, in, plant) != I2cStatus::success) return {};
  return lis_waiting(in[0]);
}

std::optional<size_t> BoardAccelerometer::lis_waiting(uint8_t state) {
  const size_t samples = state & 0x3f;
  if (samples > kFifo) return {};
  if (state & 0x40) ++overflows;
  return samples;
}

std::optional<SerialParts::Part> SerialParts::made(Command id, const uint32_t* a) {
  if (id == Command::config_tmcuart) return BoardUart(a[1], a[4]);
  if (id == Command::config_spi) return BoardSpi(a[1]);
  if (id == Command::config_spi_without_cs) return BoardSpi(std::nullopt);
  if (id == Command::config_thermocouple) {
    get<BoardSpi>(a[1]);
    return BoardThermocouple(a[1], a[2]);
  }
  if (id == Command::config_i2c) return BoardI2c();
  if (id == Command::config_adxl345) {
    get<BoardSpi>(a[1]);
    return BoardAccelerometer(a[1], false, false);
  }
  if (id == Command::config_lis2dw) {
    if (a[2] > 1 || a[3] != 0) throw Shutdown{Fault::accelerometer_type};
    if (a[2] == 0)
      get<BoardSpi>(a[1]);
    else
      get<BoardI2c>(a[1]);
    return BoardAccelerometer(a[1], true, a[2] != 0);
  }
  if (id == Command::config_neopixel) {
    if (a[2] > BoardLights::kMax) throw Shutdown{Fault::neopixel_size};
    return BoardLights(a[1], a[2]);
  }
  return made_eddy(id, a);
}

Ticks SerialParts::next() const {
  Ticks next = kNever;
  for (auto& [oid, part] : parts_)
    next = std::min(next, std::visit([](const auto& p) { return p.next(); }, part));
  return next;
}

void SerialParts::run(Ticks now) {
  for (auto& [oid, part] : parts_) {
    if (auto* uart = std::get_if<BoardUart>(&part); uart && uart->next() <= now) {
      Bytes answer = uart->take();
      tell_(Report::tmcuart_response, {oid}, &answer);
    }
    if (auto* part_of = std::get_if<BoardAccelerometer>(&part); part_of && part_of->next() <= now)
      empty(oid, *part_of, now);
    if (auto* eddy = std::get_if<BoardEddy>(&part); eddy && eddy->next() <= now)
      read(oid, *eddy, now);
    if (auto* trigger = std::get_if<BoardTrigger>(&part); trigger && trigger->next() <= now)
      if (trigger->watch()) fail(*trigger, BoardTrigger::kSilent);
    auto* it = std::get_if<BoardThermocouple>(&part);
    if (!it || it->next() > now) continue;
    it->begin += it->rest;
    const BoardThermocouple::Type& type = it->type;
    uint32_t word = ask(*it, type.word_register, type.bytes, now);
    uint32_t fault = type.fault_register ? ask(*it, type.fault_register, 1, now) : 0;
    tell_(Report::thermocouple_result, {oid, uint32_t(it->begin), word, fault}, nullptr);
    it->watch(word, fault != 0);
  }
}

void SerialParts::shut_down() {
  for (auto& [oid, part] : parts_) {
    if (auto* uart = std::get_if<BoardUart>(&part)) uart->take();
    if (auto* it = std::get_if<BoardAccelerometer>(&part)) it->begin = kNever;
    if (auto* it = std::get_if<BoardEddy>(&part)) it->begin = kNever;
    if (auto* it = std::get_if<BoardTrigger>(&part)) it->disarm();
  }
}

void SerialParts::empty(uint32_t oid, BoardAccelerometer& it, Ticks now) {
  bool more = true;
  // Limits the loop to the size of the FIFO, in case the answers are not those of the chip.
  for (size_t taken = 0; more && taken < BoardAccelerometer::kFifo; ++taken) {
    more = it.on_i2c ? it.take(get<BoardI2c>(it.bus_oid), now, plant_)
                     : it.take(get<BoardSpi>(it.bus_oid), now, plant_);
    if (it.data.size() < it.block_bytes()) continue;
    tell_(Report::sensor_bulk_data, {oid, it.sequence++}, &it.data);
    it.data.clear();
  }
  it.begin = now + it.rest;
}

uint32_t SerialParts::ask(const BoardThermocouple& it, std::optional<uint8_t> address, size_t bytes,
                          Ticks now) {
  Bytes data(bytes + address.has_value());
  if (address) data[0] = *address;
  data = get<BoardSpi>(it.spi_oid).transfer(now, data, plant_);
  uint32_t word = 0;
  for (size_t i = address.has_value(); i < data.size(); ++i) word = word << 8 | data[i];
  return word;
}

void SerialParts::command(Command id, const uint32_t* a, const Bytes& data, Ticks now,
                          const Ahead& ahead) {
  if (eddy_command(id, a, now, ahead)) return;
  switch (id) {
    case Command::tmcuart_send:
      get<BoardUart>(a[0]).send(now, Ticks(kUartRest * clock_hz_), data, a[2], plant_);
      break;
    case Command::spi_set_sw_bus: {
      auto& it = get<BoardSpi>(a[0]);
      it.has_bus = true;
      it.to_device = a[2];
      it.clock = a[3];
      break;
    }
    case Command::spi_transfer: {
      Bytes response = get<BoardSpi>(a[0]).transfer(now, data, plant_);
      tell_(Report::spi_transfer_response, {a[0]}, &response);
      break;
    }
    case Command::spi_send:
      get<BoardSpi>(a[0]).transfer(now, data, plant_);
      break;
    case Command::i2c_set_sw_bus: {
      auto& it = get<BoardI2c>(a[0]);
      it.pins = {a[1], a[2]};
      it.address = uint8_t(a[4] & 0x7f);
      it.has_bus = true;
      break;
    }
    case Command::i2c_transfer: {
      if (a[2] > kFrameMax) throw Shutdown{Fault::i2c_too_long};
      Bytes in(a[2]);
      I2cStatus status = get<BoardI2c>(a[0]).transfer(now, data, in, plant_);
      in.resize(std::min(in.size(), kPayloadMax - kI2cHead));
      tell_(Report::i2c_response, {a[0], uint32_t(status)}, &in);
      break;
    }
    case Command::neopixel_update: {
      Bytes& kept = get<BoardLights>(a[0]).data;
      if (a[1] + data.size() > kept.size()) throw Shutdown{Fault::neopixel_update};
      std::copy(data.begin(), data.end(), kept.begin() + long(a[1]));
      break;
    }
    case Command::neopixel_send: {
      const auto& it = get<BoardLights>(a[0]);
      tell_(Report::neopixel_result, {a[0], plant_.show_lights(it.pin, it.data, now)}, nullptr);
      break;
    }
    case Command::query_adxl345:
    case Command::query_lis2dw: {
      auto& it = get<BoardAccelerometer>(a[0]);
      it = BoardAccelerometer(it.bus_oid, it.lis2dw, it.on_i2c);
      it.rest = a[1];
      if (a[1] == 0) break;
      if (a[1] < kMinPeriodTicks) throw Shutdown{Fault::period_too_short};
      it.begin = now + it.rest;
      break;
    }
    case Command::query_adxl345_status:
    case Command::query_lis2dw_status: {
      auto& it = get<BoardAccelerometer>(a[0]);
      const auto waiting = it.on_i2c ? it.waiting(get<BoardI2c>(it.bus_oid), now, plant_)
                                     : it.waiting(get<BoardSpi>(it.bus_oid), now, plant_);
      if (!waiting) break;  // the transfer was disturbed; the host asks again
      auto buffered = uint32_t(it.data.size() + *waiting * it.sample_bytes());
      tell_(Report::sensor_bulk_status,
            {a[0], uint32_t(now), 0, it.sequence, buffered, it.overflows}, nullptr);
      break;
    }
    default: {
      auto& it = get<BoardThermocouple>(a[0]);
      it.begin = a[2] != 0 ? ahead(a[1]) : kNever;
      it.rest = a[2];
      it.minimum = a[3];
      it.maximum = a[4];
      it.max_faults = a[5];
      it.faults = 0;
    }
  }
}

}  // namespace passo::wire
