#include "link/heaters.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <variant>

namespace passo::wire {

Heater& Heaters::add(HeaterOptions options) {
  heaters_.push_back(std::make_unique<Heater>(std::move(options)));
  heater_clock_.push_back(0);
  kept_.push_back(0);
  return *heaters_.back();
}

bool Heaters::reached() const {
  return std::all_of(heaters_.begin(), heaters_.end(), [](const auto& heater) {
    std::lock_guard lock(heater->guard());
    return heater->target() <= 0 || heater->reached() || heater->faulty();
  });
}

void Heaters::keep() {
  keeps_ = true;
  for (size_t i = 0; i < heaters_.size(); ++i) tell_keeping(i, 0);
}

void Heaters::tell_kept_again() {
  for (size_t i = 0; keeps_ && i < heaters_.size(); ++i) tell_keeping(i, kept_[i]);
}

void Heaters::interrupted() {
  for (const auto& heater : heaters_) {
    std::lock_guard lock(heater->guard());
    heater->interrupted();
  }
}

bool Heaters::take(const std::vector<Value>& values, Ticks now) {
  if (values.size() < 3) return false;
  bool taken = false;
  for (size_t i = 0; i < heaters_.size(); ++i) {
    Heater& heater = *heaters_[i];
    std::lock_guard lock(heater.guard());
    if (int64_t(heater.options().sensor_oid) != std::get<int64_t>(values[0])) continue;
    uint32_t sum, value;
    if (const auto* data = std::get_if<std::string>(&values[2])) {
      if (data->size() < 2) return true;
      sum = uint8_t(data->end()[-2]) | uint32_t(uint8_t(data->end()[-1])) << 8;
    } else {
      sum = uint32_t(std::get<int64_t>(values[2]));
    }
    if (heater.options().converter != heat::Converter::none)
      sum = read_converter(heater.options(), sum, uint32_t(std::get<int64_t>(values.at(3))));
    if (!sync_.ready()) return true;
    taken = true;
    Ticks next = sync_.unwrap(uint32_t(std::get<int64_t>(values[1])));
    Ticks clock = next - Ticks(heater.options().query.rest_ticks);
    int32_t fan = heater.options().fan_target;
    if (fan >= 0) heater.follow_fan(job_.pin_value(size_t(fan)));
    if (heater.report(sum, clock, hz_, value)) set_power(i, value, now);
    auto keeping = int64_t(heater.keeping() * heater.options().full);
    if (keeps_ && std::fabs(double(keeping - kept_[i])) > kKeptStep * heater.options().full)
      tell_keeping(i, keeping);
    fault_ |= heater.take_news();
    if (bool wide; heater.change_net(wide)) query(heater.options(), next, wide, now);
  }
  return taken;
}

uint32_t Heaters::read_converter(const HeaterOptions& o, uint32_t word, uint32_t faults) {
  if (faults != 0 && !o.clears_faults.empty())
    send_("spi_send",
          {int64_t(o.spi_oid), std::string(o.clears_faults.begin(), o.clears_faults.end())});
  return heat::converter_sum(o.converter, word, faults);
}

void Heaters::query(const HeaterOptions& o, Ticks clock, bool wide, Ticks now) {
  const SensorQuery& q = o.query;
  Ticks due = std::max(clock, sync_.clock_at(now) + Ticks(kLeadSeconds * hz_));
  if (o.converter != heat::Converter::none) {
    std::vector<Value> words = {int64_t(o.sensor_oid), int64_t(uint32_t(due)),
                                int64_t(q.rest_ticks), int64_t(wide ? 0 : q.minimum),
                                int64_t(wide ? UINT32_MAX : q.maximum)};
    // Firmware of Klipper before v0.11 has no such parameter.
    if (commands_.at("query_thermocouple").parameters.size() == 6)
      words.push_back(int64_t(q.range_checks));
    send_("query_thermocouple", words);
    return;
  }
  std::vector<Value> values = {int64_t(o.sensor_oid), int64_t(uint32_t(due)),
                               int64_t(q.sample_ticks), int64_t(q.sample_count),
                               int64_t(q.rest_ticks)};
  // Older firmware has no parameter for the bytes of a report.
  if (commands_.at("query_analog_in").parameters.size() == 9) values.push_back(int64_t(2));
  values.push_back(int64_t(wide ? 0 : q.minimum));
  values.push_back(int64_t(wide ? o.adc_full : q.maximum));
  values.push_back(int64_t(q.range_checks));
  send_("query_analog_in", values);
}

void Heaters::tell_keeping(size_t i, int64_t value) {
  kept_[i] = value;
  send_all(heaters_[i]->options(), "survive_output", uint32_t(value),
           [](int64_t oid, int64_t own) { return std::vector<Value>{oid, own, kKeptSeconds}; });
}

void Heaters::set_power(size_t i, uint32_t value, Ticks now) {
  const HeaterOptions& o = heaters_[i]->options();
  Ticks due = sync_.clock_at(now) + Ticks(kLeadSeconds * hz_);
  heater_clock_[i] = std::max(due, heater_clock_[i] + 1);
  send_all(o, o.pwm ? "queue_pwm_out" : "queue_digital_out", value,
           [clock = int64_t(uint32_t(heater_clock_[i]))](int64_t oid, int64_t own) {
             return std::vector<Value>{oid, clock, own};
           });
}

void Heaters::send_all(const HeaterOptions& o, const std::string& command, uint32_t value,
                       const Values& values) {
  auto send_to = [&](uint32_t oid, bool inverted) {
    send_(command, values(oid, JobStream::on_wire(value, inverted ? o.full : 0)));
  };
  send_to(o.output_oid, o.inverted);
  for (auto [oid, inverted] : o.further) send_to(oid, inverted);
}

}  // namespace passo::wire
