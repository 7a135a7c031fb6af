#include "sim/virtual_board.hpp"

#include <algorithm>
#include <initializer_list>
#include <type_traits>

namespace passo::wire {

template <class T>
T& VirtualBoard::configure(uint32_t oid, T part) {
  check_oid(oid);
  Part& kept = parts_.emplace(oid, std::move(part)).first->second;
  T& made = std::get<T>(kept);
  if constexpr (std::is_same_v<T, BoardMotor>) {
    if (motors_.size() <= oid) motors_.resize(oid + 1);
    motors_[oid] = &made;
    if (followed_.count(made.step_pin)) made.follow(now_, true);
  } else {
    timed_.push_back({oid, &kept});
  }
  if constexpr (std::is_same_v<T, BoardOutput>) outputs_.push_back(&made);
  return made;
}

template <class T>
T& VirtualBoard::get(uint32_t oid) {
  auto it = parts_.find(oid);
  T* part = it == parts_.end() ? nullptr : std::get_if<T>(&it->second);
  if (!part) throw Shutdown{Fault::invalid_oid};
  return *part;
}

VirtualBoard::VirtualBoard(Options options)
    : Bench(options.clock_hz, options.adc_max, options.start), options_(std::move(options)),
      serial_(
          plant_, options_.clock_hz,
          [this](Report id, std::initializer_list<uint32_t> values, const Bytes* blob) {
            report(id, values, blob);
          },
          [this](uint32_t oid, uint32_t reason) { trigger(oid, reason); }) {
  for (const Declaration& d : kCommands) {
    Format format(d.id, d.text);
    Shape& shape = shapes_[size_t(d.id)];
    shape = {true, d.in_shutdown, uint8_t(format.parameters.size()), kParametersMax, {}};
    for (size_t i = 0; i < format.parameters.size(); ++i) {
      Type type = format.parameters[i].type;
      if (type == Type::blob) shape.blob = uint8_t(i);
      shape.most[i] = type == Type::byte ? 0xff : type == Type::unsigned_word ? 0xffff : 0xffffffff;
    }
  }
}

void VirtualBoard::feed(const uint8_t* data, size_t n, Ticks now) {
  run_until(now);
  scanner_.feed(
      data, n,
      [&](uint8_t sequence, const uint8_t* payload, size_t size) {
        if (sequence == (sequence_ & kSequenceMask)) {
          ++sequence_;
          ++frames_;
          execute(payload, size);
        } else {
          ++naks_;
        }
        append_frame(out_, nullptr, 0, sequence_);
      },
      [&] {
        ++naks_;
        append_frame(out_, nullptr, 0, sequence_);
      });
  schedule();
}

void VirtualBoard::poll(Ticks now, Bytes& out) {
  if (next_ <= now) run_until(now);
  now_ = std::max(now_, now);
  out.insert(out.end(), out_.begin(), out_.end());
  out_.clear();
}

void VirtualBoard::trace_steps(uint32_t step_pin, Ticks from, Ticks to) {
  motor(step_pin).trace(from, to);
}

std::vector<StepRun> VirtualBoard::take_steps(uint32_t step_pin) {
  motor(step_pin).retire(now_);
  return std::exchange(motor(step_pin).traced(), {});
}

void VirtualBoard::follow_steps(uint32_t step_pin, bool on) {
  if (on)
    followed_.insert(step_pin);
  else
    followed_.erase(step_pin);
  if (BoardMotor* found = find_motor(step_pin)) found->follow(now_, on);
}

std::vector<StepRun> VirtualBoard::take_followed(uint32_t step_pin, Ticks until) {
  BoardMotor* found = find_motor(step_pin);
  return found ? found->take_followed(until) : std::vector<StepRun>();
}

std::vector<PinChange> VirtualBoard::take_changes(uint32_t pin) {
  return std::exchange(output_on(pin).traced(), {});
}

void VirtualBoard::schedule() {
  next_ = std::min(serial_.next(), plant_.next_look());
  for (const Timed& timed : timed_) next_ = std::min(next_, next_of(*timed.part));
}

Ticks VirtualBoard::next_of(const Part& part) {
  return std::visit(
      [](const auto& p) -> Ticks {
        if constexpr (std::is_same_v<std::decay_t<decltype(p)>, BoardMotor>)
          return kNever;
        else
          return p.next();
      },
      part);
}

void VirtualBoard::run_until(Ticks now) {
  while (next_ <= now) {
    now_ = std::max(now_, next_);
    look();
    for (const auto& [oid, part] : timed_) {
      if (next_of(*part) > now_) continue;
      try {
        run(oid, *part);
      } catch (const Shutdown& s) {
        shut_down(s.fault);
      }
    }
    try {
      serial_.run(now_);
    } catch (const Shutdown& s) {
      shut_down(s.fault);
    }
    schedule();
  }
  now_ = std::max(now_, now);
}

void VirtualBoard::run(uint32_t oid, Part& part) {
  if (auto* output = std::get_if<BoardOutput>(&part)) {
    output->run(now_, plant_);
  } else if (auto* analog = std::get_if<BoardAnalogIn>(&part)) {
    bool fault = analog->run(plant_);
    if (analog->values.size() >= analog->report_size) {
      report(Report::analog_in_state, {oid, uint32_t(analog->begin)}, &analog->values);
      analog->values.clear();
    }
    if (fault) throw Shutdown{Fault::adc_range};
  } else if (auto* endstop = std::get_if<BoardEndstop>(&part)) {
    if (endstop->run(level(endstop->pin, now_))) trigger(endstop->trsync, endstop->reason);
  } else if (auto* group = std::get_if<BoardTrsync>(&part)) {
    if (group->timeout <= now_) {
      group->timeout = kNever;
      trigger(oid, group->expire_reason);
    }
    if (group->report <= now_) {
      group->report += group->report_ticks;
      report_trsync(oid, *group);
    }
  } else if (auto* buttons = std::get_if<BoardButtons>(&part)) {
    if (buttons->run([this](uint32_t pin) { return level(pin, now_); }))
      report(Report::buttons_state, {oid, buttons->acknowledged}, &buttons->states);
  } else if (auto* counter = std::get_if<BoardCounter>(&part)) {
    if (counter->run(level(counter->pin, now_)))
      report(Report::counter_state,
             {oid, uint32_t(counter->report_at), counter->count, uint32_t(counter->counted_at)});
  }
}

void VirtualBoard::execute(const uint8_t* payload, size_t size) {
  Reader in{payload, payload + size};
  try {
    while (in.more()) {
      uint32_t id = in.vlq();
      if (id == uint32_t(Command::queue_step)) {
        uint32_t oid = in.vlq(), interval = in.vlq(), count = in.vlq(), add = in.vlq();
        if (!in.ok) throw Shutdown{Fault::bad_command};
        if (fault_ != Fault::none) {
          report(Report::is_shutdown, {uint32_t(fault_)});
          continue;
        }
        if (oid >= motors_.size() || !motors_[oid]) throw Shutdown{Fault::invalid_oid};
        take_slot();
        motors_[oid]->queue(now_, interval, uint16_t(count), int16_t(uint16_t(add)));
        continue;
      }
      if (!in.ok || id >= uint32_t(Command::end_) || !shapes_[id].known)
        throw Shutdown{Fault::bad_command};
      const Shape& shape = shapes_[id];
      uint32_t a[kParametersMax] = {};
      const uint8_t* blob = nullptr;
      size_t blob_size = 0;
      for (size_t i = 0; i < shape.parameters; ++i) {
        if (i == shape.blob) {
          blob = in.blob(blob_size);
          continue;
        }
        a[i] = in.vlq();
        in.ok &= a[i] <= shape.most[i];
      }
      if (!in.ok) throw Shutdown{Fault::bad_command};
      if (fault_ != Fault::none && !shape.in_shutdown) {
        report(Report::is_shutdown, {uint32_t(fault_)});
        continue;
      }
      command(Command(id), a, Bytes(blob, blob + blob_size));
    }
  } catch (const Shutdown& s) {
    shut_down(s.fault);
  }
}

void VirtualBoard::command(Command id, const uint32_t* a, const Bytes& blob) {
  switch (id) {
    case Command::identify:
      identify(a[0], a[1]);
      break;
    case Command::get_clock:
      report(Report::clock, {uint32_t(now_)});
      break;
    case Command::get_uptime:
      report(Report::uptime, {uint32_t(uint64_t(now_) >> 32), uint32_t(now_)});
      break;
    case Command::get_config:
      report(Report::config,
             {finalized_, crc_, fault_ != Fault::none, finalized_ ? options_.move_count : 0});
      break;
    case Command::allocate_oids:
      if (oids_) throw Shutdown{Fault::oid_taken};
      oids_ = a[0];
      break;
    case Command::finalize_config:
      if (finalized_ || !oids_) throw Shutdown{Fault::already_finalized};
      finalized_ = true;
      crc_ = a[0];
      break;
    case Command::emergency_stop:
      throw Shutdown{Fault::emergency_stop};
    case Command::clear_shutdown:
      fault_ = Fault::none;
      break;
    case Command::reset:
      reset();
      break;
    case Command::debug_nop:
      break;
    case Command::debug_ping:
      report(Report::pong, {}, &blob);
      break;
    default:
      if (!SerialParts::knows(id)) {
        part_command(id, a);
      } else if (auto part = serial_.made(id, a)) {
        check_oid(a[0]);
        serial_.add(a[0], *part);
      } else {
        serial_.command(id, a, blob, now_, [this](uint32_t clock) { return ahead(clock); });
      }
  }
}

void VirtualBoard::part_command(Command id, const uint32_t* a) {
  if (buttons_command(id, a) || counter_command(id, a)) return;
  switch (id) {
    case Command::config_stepper:
      configure(a[0], BoardMotor(a[1], a[2])).set_late_limit(ticks(0.001));
      break;
    case Command::config_endstop:
      configure(a[0], BoardEndstop(a[1]));
      break;
    case Command::config_trsync:
      configure(a[0], BoardTrsync());
      break;
    case Command::config_analog_in:
      configure(a[0], BoardAnalogIn(a[1]));
      break;
    case Command::config_digital_out:
      configure(a[0], BoardOutput(a[1], false, 1, a[2] != 0, a[3] != 0, a[4]));
      plant_.set_output(a[1], now_, a[2] != 0);
      break;
    case Command::config_pwm_out:
      configure(a[0], BoardOutput(a[1], true, options_.pwm_max, a[3], a[4], a[5]));
      plant_.set_output(a[1], now_, double(a[3]) / options_.pwm_max);
      break;
    case Command::set_digital_out:
      plant_.set_output(a[0], now_, a[1] != 0);
      break;
    case Command::set_pwm_out:
      plant_.set_output(a[0], now_, double(std::min(a[2], options_.pwm_max)) / options_.pwm_max);
      break;
    default:
      if (!finalized_) {
        // These commands are also allowed before finalize_config.
        if (id != Command::set_digital_out_pwm_cycle && id != Command::stepper_stop_on_trigger &&
            id != Command::stepper_get_position && id != Command::endstop_query_state &&
            id != Command::query_analog_in)
          throw Shutdown{Fault::not_finalized};
      }
      motion_command(id, a);
  }
}

bool VirtualBoard::buttons_command(Command id, const uint32_t* a) {
  switch (id) {
    case Command::config_buttons:
      if (a[1] > BoardButtons::kMax) throw Shutdown{Fault::too_many_buttons};
      configure(a[0], BoardButtons(a[1]));
      return true;
    case Command::buttons_add: {
      BoardButtons& buttons = get<BoardButtons>(a[0]);
      if (a[1] >= buttons.pins.size()) throw Shutdown{Fault::no_such_button};
      buttons.pins[a[1]] = a[2];
      return true;
    }
    case Command::buttons_query: {
      BoardButtons& buttons = get<BoardButtons>(a[0]);
      if (!finalized_) throw Shutdown{Fault::not_finalized};
      if (a[2] != 0) check_period(a[2]);
      buttons.query(a[2] != 0 ? ahead(a[1]) : kNever, a[2], uint8_t(a[3]), uint8_t(a[4]));
      return true;
    }
    case Command::buttons_ack:
      get<BoardButtons>(a[0]).acknowledge(a[1]);
      return true;
    default:
      return false;
  }
}

bool VirtualBoard::counter_command(Command id, const uint32_t* a) {
  if (id == Command::config_counter) {
    configure(a[0], BoardCounter(a[1]));
    return true;
  }
  if (id != Command::query_counter) return false;
  BoardCounter& counter = get<BoardCounter>(a[0]);
  if (!finalized_) throw Shutdown{Fault::not_finalized};
  if (a[2] != 0) check_period(a[2]);
  counter.query(a[2] != 0 ? ahead(a[1]) : kNever, a[2], a[3], level(counter.pin, now_));
  return true;
}

void VirtualBoard::motion_command(Command id, const uint32_t* a) {
  switch (id) {
    case Command::set_next_step_dir:
      get<BoardMotor>(a[0]).set_direction(a[1] != 0);
      break;
    case Command::reset_step_clock:
      get<BoardMotor>(a[0]).reset_clock(now_, unwrap(a[1]));
      break;
    case Command::stepper_get_position:
      report(Report::stepper_position, {a[0], uint32_t(get<BoardMotor>(a[0]).net_at(now_))});
      break;
    case Command::stepper_stop_on_trigger: {
      BoardMotor& motor = get<BoardMotor>(a[0]);
      BoardTrsync& group = get<BoardTrsync>(a[1]);
      if (motor.trsync != int64_t(a[1])) group.motors.push_back(a[0]);
      motor.trsync = a[1];
      break;
    }
    case Command::queue_digital_out:
      queue_output(a, false);
      break;
    case Command::queue_pwm_out:
      queue_output(a, true);
      break;
    case Command::update_digital_out:
      output(a[0], false).update(now_, a[1] != 0, plant_);
      break;
    case Command::set_digital_out_pwm_cycle:
      output(a[0], false).set_cycle(std::max(a[1], 1u));
      break;
    case Command::query_analog_in: {
      BoardAnalogIn& in = get<BoardAnalogIn>(a[0]);
      Ticks begin = kNever;
      if (a[3] != 0) {
        check_period(a[4]);
        begin = ahead(a[1]);
      }
      in.begin = begin;
      in.sample = a[2];
      in.count = a[3];
      in.rest = a[4];
      in.report_size = std::clamp<size_t>(a[5], 2, 48);
      in.minimum = a[6];
      in.maximum = a[7];
      in.range_checks = a[8];
      in.outside = in.taken = in.sum = 0;
      in.values.clear();
      break;
    }
    case Command::endstop_home: {
      BoardEndstop& e = get<BoardEndstop>(a[0]);
      e.armed = false;
      if (a[3] == 0) break;
      get<BoardTrsync>(a[6]);
      check_period(a[4]);
      if (a[3] > 1) check_period(a[2]);
      e.next_sample = ahead(a[1]);
      e.armed = true;
      e.sample = a[2];
      e.count = a[3];
      e.rest = a[4];
      e.wanted = a[5] != 0;
      e.trsync = a[6];
      e.reason = a[7];
      e.hits = 0;
      break;
    }
    case Command::endstop_query_state: {
      BoardEndstop& e = get<BoardEndstop>(a[0]);
      Ticks clock = e.hits > 0 ? e.first_hit + e.rest : e.next_sample;
      report(Report::endstop_state, {a[0], e.armed, uint32_t(clock), level(e.pin, now_)});
      break;
    }
    case Command::trsync_start: {
      BoardTrsync& group = get<BoardTrsync>(a[0]);
      Ticks report = kNever;
      if (a[2] != 0) {
        check_period(a[2]);
        report = ahead(a[1]);
      }
      for (size_t motor : group.motors) get<BoardMotor>(uint32_t(motor)).trsync = -1;
      group = BoardTrsync();
      group.report = report;
      group.armed = true;
      group.report_ticks = a[2];
      group.expire_reason = a[3];
      break;
    }
    case Command::trsync_set_timeout: {
      BoardTrsync& group = get<BoardTrsync>(a[0]);
      if (group.armed) group.timeout = ahead(a[1]);
      break;
    }
    case Command::trsync_trigger: {
      BoardTrsync& group = get<BoardTrsync>(a[0]);
      bool armed = group.armed;
      if (armed) trigger(a[0], a[1]);
      group.report = kNever;
      if (!armed) report_trsync(a[0], group);
      break;
    }
    default:
      throw Shutdown{Fault::bad_command};
  }
}

void VirtualBoard::check_oid(uint32_t oid) const {
  if (!oids_ || oid >= *oids_ || finalized_ || parts_.count(oid) || serial_.has(oid))
    throw Shutdown{Fault::oid_taken};
}

BoardOutput& VirtualBoard::output(uint32_t oid, bool pwm) {
  BoardOutput& output = get<BoardOutput>(oid);
  if (output.is_pwm() != pwm) throw Shutdown{Fault::invalid_oid};
  return output;
}

void VirtualBoard::queue_output(const uint32_t* a, bool pwm) {
  take_slot();
  output(a[0], pwm).queue(now_, unwrap(a[1]), a[2]);
}

void VirtualBoard::take_slot() {
  if (!finalized_) throw Shutdown{Fault::not_finalized};
  if (slots_ >= options_.move_count) {
    slots_ = 0;
    for (BoardMotor* motor : motors_)
      if (motor) slots_ += motor->slots(now_);
    for (BoardOutput* output : outputs_) slots_ += output->slots();
    peak_slots_ = std::max(peak_slots_, slots_);
    if (slots_ >= options_.move_count) throw Shutdown{Fault::slots_exhausted};
  }
  ++slots_;
}

Ticks VirtualBoard::ahead(uint32_t clock) const {
  Ticks at = unwrap(clock);
  if (at < now_) throw Shutdown{Fault::timer_too_close};
  return at;
}

void VirtualBoard::check_period(uint32_t ticks) {
  if (ticks < kMinPeriodTicks) throw Shutdown{Fault::period_too_short};
}

void VirtualBoard::trigger(uint32_t oid, uint32_t reason) {
  BoardTrsync& group = get<BoardTrsync>(oid);
  if (!group.armed) return;
  group.armed = false;
  group.reason = reason;
  group.timeout = kNever;
  for (size_t motor : group.motors) get<BoardMotor>(uint32_t(motor)).stop(now_);
  report_trsync(oid, group);
}

void VirtualBoard::report_trsync(uint32_t oid, const BoardTrsync& group) {
  report(Report::trsync_state, {oid, group.armed, group.reason, uint32_t(now_)});
}

int64_t VirtualBoard::net(uint32_t step_pin) {
  BoardMotor* found = find_motor(step_pin);
  return found ? found->net_at(now_) : 0;
}

BoardMotor* VirtualBoard::find_motor(uint32_t step_pin) {
  for (auto& [oid, part] : parts_)
    if (auto* motor = std::get_if<BoardMotor>(&part))
      if (motor->step_pin == step_pin) return motor;
  return nullptr;
}

BoardMotor& VirtualBoard::motor(uint32_t step_pin) {
  BoardMotor* found = find_motor(step_pin);
  if (!found) throw UnknownPin("no stepper is configured on this pin");
  return *found;
}

BoardOutput& VirtualBoard::output_on(uint32_t pin) {
  for (BoardOutput* output : outputs_)
    if (output->pin() == pin) return *output;
  throw UnknownPin("no output is configured on this pin");
}

void VirtualBoard::shut_down(Fault fault) {
  if (fault_ != Fault::none) return;
  fault_ = fault;
  for (auto& [oid, part] : parts_) {
    if (auto* motor = std::get_if<BoardMotor>(&part)) motor->stop(now_);
    if (auto* output = std::get_if<BoardOutput>(&part)) output->shut_down(now_, plant_);
    if (auto* endstop = std::get_if<BoardEndstop>(&part)) endstop->armed = false;
    if (auto* group = std::get_if<BoardTrsync>(&part)) *group = BoardTrsync();
    if (auto* buttons = std::get_if<BoardButtons>(&part)) buttons->due = kNever;
    if (auto* counter = std::get_if<BoardCounter>(&part)) counter->due = kNever;
  }
  serial_.shut_down();
  report(Report::shutdown, {uint32_t(now_), uint32_t(fault)});
}

void VirtualBoard::reset() {
  for (auto& [oid, part] : parts_) {
    if (auto* output = std::get_if<BoardOutput>(&part)) output->shut_down(now_, plant_);
    if (auto* motor = std::get_if<BoardMotor>(&part)) {
      motor->stop(now_);
      plant_.rebase(motor->step_pin, motor->net_at(now_));
    }
  }
  timed_.clear();
  parts_.clear();
  serial_.clear();
  motors_.clear();
  outputs_.clear();
  oids_.reset();
  finalized_ = false;
  crc_ = 0;
  fault_ = Fault::none;
  slots_ = 0;
  sequence_ = 0;
  report(Report::starting, {});
}

void VirtualBoard::identify(uint32_t offset, uint32_t count) {
  const Bytes& all = options_.identify;
  size_t begin = std::min<size_t>(offset, all.size());
  size_t size = std::min<size_t>({size_t(count), all.size() - begin, size_t(48)});
  Bytes part(all.begin() + long(begin), all.begin() + long(begin + size));
  report(Report::identify_response, {offset}, &part);
}

void VirtualBoard::report(Report id, std::initializer_list<uint32_t> values, const Bytes* blob) {
  uint8_t payload[kFrameMax + 32];
  uint8_t* p = put_vlq(payload, uint32_t(id));
  for (uint32_t v : values) p = put_vlq(p, v);
  if (blob) {
    *p++ = uint8_t(blob->size());
    p = std::copy(blob->begin(), blob->end(), p);
  }
  append_frame(out_, payload, size_t(p - payload), sequence_);
}

}  // namespace passo::wire
