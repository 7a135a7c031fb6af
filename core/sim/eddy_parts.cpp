#include "sim/board_eddy.hpp"
#include "sim/board_serial.hpp"

namespace passo::wire {

namespace {

// Registers of the LDC1612 (Texas Instruments, SNOSCY9).
constexpr uint8_t kHigh = 0x00, kLow = 0x01, kStatus = 0x18;
constexpr uint32_t kUnread = 1 << 3, kErrors = 0xe0000000, kValue = 0x0fffffff;

}  // namespace

std::optional<SerialParts::Part> SerialParts::made_eddy(Command id, const uint32_t* a) {
  if (id == Command::config_ldc1612 || id == Command::config_ldc1612_with_intb) {
    get<BoardI2c>(a[1]);
    return BoardEddy(a[1]);  // it asks for the status, also with the interrupt line
  }
  if (id == Command::config_sos_filter) return BoardFilter();
  if (id == Command::config_trigger_analog) {
    get<BoardFilter>(a[1]);
    return BoardTrigger(a[1]);
  }
  return {};
}

bool SerialParts::eddy_command(Command id, const uint32_t* a, Ticks now, const Ahead& ahead) {
  switch (id) {
    case Command::query_ldc1612: {
      auto& it = get<BoardEddy>(a[0]);
      it.begin = kNever;
      if (a[1] == 0) return true;
      if (a[1] < kMinPeriodTicks) throw Shutdown{Fault::period_too_short};
      it.rest = a[1];
      it.begin = now + it.rest;
      it.sequence = 0;
      it.data.clear();
      return true;
    }
    case Command::query_status_ldc1612: {
      auto& it = get<BoardEddy>(a[0]);
      const auto status = eddy_register(it, kStatus, now);
      if (!status) return true;  // the host asks again
      const size_t waiting = *status & kUnread ? BoardEddy::kSampleBytes : 0;
      tell_(Report::sensor_bulk_status,
            {a[0], uint32_t(now), 0, it.sequence, uint32_t(it.data.size() + waiting), 0}, nullptr);
      return true;
    }
    case Command::ldc1612_attach_trigger_analog:
      get<BoardTrigger>(a[1]);
      get<BoardEddy>(a[0]).trigger_oid = a[1];
      return true;
    case Command::sos_filter_set_offset_scale: {
      auto& it = get<BoardFilter>(a[0]);
      it.offset = int32_t(a[1]);
      it.scale = int32_t(a[2]);
      it.fraction_bits = a[3] & 0x3f;
      return true;
    }
    case Command::trigger_analog_set_raw_range: {
      auto& it = get<BoardTrigger>(a[0]);
      it.minimum = int32_t(a[1]);
      it.maximum = int32_t(a[2]);
      return true;
    }
    case Command::trigger_analog_set_trigger: {
      auto& it = get<BoardTrigger>(a[0]);
      it.type = a[1];
      it.threshold = int32_t(a[2]);
      return true;
    }
    case Command::trigger_analog_home: {
      auto& it = get<BoardTrigger>(a[0]);
      it.disarm();
      if (a[5] == 0) return true;
      if (a[5] < kMinPeriodTicks) throw Shutdown{Fault::period_too_short};
      it.trsync = a[1];
      it.reason = a[2];
      it.error_reason = a[3];
      it.from = it.due = ahead(a[4]);
      it.every = a[5];
      it.patience = a[6];
      it.silent = 0;
      it.armed = true;
      return true;
    }
    case Command::trigger_analog_query_state: {
      const auto& it = get<BoardTrigger>(a[0]);
      tell_(Report::trigger_analog_state, {a[0], it.armed, uint32_t(it.from)}, nullptr);
      return true;
    }
    default:
      return false;
  }
}

std::optional<uint32_t> SerialParts::eddy_register(const BoardEddy& it, uint8_t address,
                                                   Ticks now) {
  Bytes in(2);
  if (get<BoardI2c>(it.i2c_oid).transfer(now, {address}, in, plant_) != I2cStatus::success)
    return {};
  return uint32_t(in[0]) << 8 | in[1];
}

void SerialParts::read(uint32_t oid, BoardEddy& it, Ticks now) {
  it.begin += it.rest;
  BoardTrigger* trigger =
      it.trigger_oid < 0 ? nullptr : &get<BoardTrigger>(uint32_t(it.trigger_oid));
  const auto status = eddy_register(it, kStatus, now);
  if (status && !(*status & kUnread)) return;
  const auto high = status ? eddy_register(it, kHigh, now) : std::nullopt;
  const auto low = high ? eddy_register(it, kLow, now) : std::nullopt;
  uint32_t value;
  if (!low || *high == 0xffff) {
    const uint8_t error = !status ? BoardEddy::kStatus
                          : low   ? BoardEddy::kInvalid
                                  : BoardEddy::kData;
    value = 0xffff0000 | error;
    if (trigger) fail(*trigger, BoardTrigger::kSensor + error);
  } else {
    value = *high << 16 | *low;
    if (trigger && value & kErrors)
      fail(*trigger, BoardTrigger::kSensor + BoardEddy::kSensor);
    else if (trigger)
      check(*trigger, value & kValue, now);
  }
  for (int shift : {24, 16, 8, 0}) it.data.push_back(uint8_t(value >> shift));
  if (it.data.size() < BoardEddy::kBlockBytes) return;
  tell_(Report::sensor_bulk_data, {oid, it.sequence++}, &it.data);
  it.data.clear();
}

void SerialParts::check(BoardTrigger& it, uint32_t raw, Ticks now) {
  if (!it.armed || now < it.from) return;
  it.silent = 0;
  const auto value = int32_t(raw);
  if (value < it.minimum || value > it.maximum) return fail(it, BoardTrigger::kRange);
  if (it.type != BoardTrigger::kGreater ||
      get<BoardFilter>(it.filter_oid).apply(value) <= it.threshold)
    return;
  it.disarm();
  it.from = now;
  trip_(it.trsync, it.reason);
}

void SerialParts::fail(BoardTrigger& it, uint32_t error) {
  if (!it.armed) return;
  it.disarm();
  trip_(it.trsync, it.error_reason + error);
}

}  // namespace passo::wire
