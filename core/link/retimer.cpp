#include "link/retimer.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "steps/stabbing.hpp"
#include "steps/windows.hpp"

namespace passo::wire {

Retimer::Retimer(double tolerance)
    : tolerance_(tolerance), stabbing_(std::make_unique<Stabbing>()) {}

Retimer::~Retimer() = default;

void Retimer::set_apart(size_t stepper, Apart apart) {
  if (motors_.size() <= stepper) motors_.resize(stepper + 1);
  motors_[stepper].apart = apart;
}

void Retimer::start(double job_hz, double ratio) {
  map_.start(job_hz, ratio);
  restart();
}

void Retimer::restart() {
  for (Motor& motor : motors_) motor = Motor(motor.apart);
  ready_.clear();
}

int64_t Retimer::clock_of(int64_t clock) const {
  return int64_t(std::floor(map_.at(double(clock)) + 0.5));
}

void Retimer::retime(const Message& m) {
  if (m.kind == MessageKind::tail) return tail(m);
  map_.use(double(m.end_clock));
  if (m.kind == MessageKind::queue_step) return steps(m, motors_[m.target].progress);
  Message mapped = m;
  mapped.clock = mapped.end_clock = clock_of(m.clock);
  if (m.kind == MessageKind::set_dir) motors_[m.target].progress.turning = true;
  if (m.kind == MessageKind::reset_clock) motors_[m.target].progress.reset(m.clock, mapped.clock);
  if (m.kind == MessageKind::commit)
    for (Motor& motor : motors_) motor.tail.reset();
  ready_.push(mapped);
}

void Retimer::tail(const Message& m) {
  Motor& motor = motors_[m.target];
  if (!motor.tail) motor.tail = motor.progress;
  Progress& progress = *motor.tail;
  Message moved = m;
  if (m.count == 0) {
    int64_t clock = m.clock + int32_t(m.interval - uint32_t(m.clock));
    progress.reset(clock, clock_of(clock));
    moved.interval = uint32_t(progress.last);
    moved.clock = moved.end_clock = clock_of(m.clock);
    return ready_.push(moved);
  }
  progress.turning |= progress.dir != m.dir;
  moved.end_clock = progress.planned + m.span(m.count);
  steps(moved, progress);
}

void Retimer::steps(const Message& m, Progress& motor) {
  const Apart& apart_of = motors_[m.target].apart;
  const bool moves = m.kind == MessageKind::queue_step;
  const int64_t count = m.count, start = m.start();
  motor.planned = m.end_clock;
  motor.dir = m.dir;
  if (map_.whole() && motor.last == clock_of(start)) {
    Message same = m;
    motor.last = clock_of(m.end_clock);
    motor.turning = false;
    same.clock = clock_of(m.clock);
    same.end_clock = moves ? motor.last : same.clock;
    return ready_.push(same);
  }
  const size_t n = size_t(count);
  if (times_.size() < n + 8)
    for (auto* v : {&times_, &lo_, &hi_, &executed_}) v->resize(2 * (n + 8));
  // Rounding may bring a step too close to the next one: the next step is then later.
  double* t = times_.data() + 1;
  double apart = motor.turning ? apart_of.turning : apart_of.least;
  t[-1] = double(motor.last);
  int64_t at = start, interval = m.interval;
  for (size_t k = 0; k < n; ++k) {
    at += interval;
    interval += m.add;
    t[k] = std::max(map_.at(double(at)), t[k - 1] + apart);
    apart = apart_of.least;
  }
  t[n] = t[n - 1] + kNeverNear;
  windows(t, lo_.data(), hi_.data(), int(n), tolerance_, apart_of.least);
  if (motor.turning) lo_[0] = std::max(lo_[0], double(motor.last) + apart_of.turning - 0.5);
  motor.turning = false;
  int64_t due = clock_of(m.clock);
  for (size_t i = 0; i < n;) {
    Command c = stabbing_->longest(&lo_[i], &hi_[i], int(std::min(n - i, size_t(kMaxSteps))),
                                   double(motor.last), &executed_[i]);
    motor.last += int64_t(c.span());
    // All parts may leave when the message might, because later messages must not wait for them.
    ready_.push({due, moves ? motor.last : due, uint32_t(c.interval), uint16_t(c.count),
                 int16_t(c.add), m.target, m.kind, m.dir});
    i += size_t(c.count);
  }
}

}  // namespace passo::wire
