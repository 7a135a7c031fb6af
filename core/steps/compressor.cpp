#include "steps/compressor.hpp"

#include <cmath>
#include <stdexcept>

#include "steps/stabbing.hpp"
#include "steps/windows.hpp"

namespace passo {

Compressor::Compressor(const Machine& machine, const StepperSpec& spec, uint16_t target)
    : tolerance_(machine.tolerance),
      reversal_(double(spec.pulse + std::max(spec.pulse, spec.dir_hold + spec.dir_setup)) + 2),
      least_(std::max(2.0 * double(spec.pulse), std::ceil(machine.clock_hz / spec.max_rate))),
      longest_(kMaxSeconds * machine.clock_hz), lead_(kLeadSeconds * machine.clock_hz),
      margin_(std::max(reversal_, 4 * machine.widest_tolerance()) + 1), target_(target),
      stabbing_(std::make_unique<Stabbing>()) {
  steps_.ticks.push_back(-kNeverNear);  // in place of a step before the first one
}

Compressor::~Compressor() = default;

void Compressor::advance(double frontier, bool still, int64_t behind) {
  drop_close_reversals();
  behind_ = behind;
  if (crowded_ && steps_.ticks.size() > 1) set_apart();
  const size_t n = steps_.ticks.size();
  size_t known = n;
  if (!still) {
    double limit = frontier - margin_;
    while (known > 1 && steps_.ticks[known - 1] > limit) --known;
  }
  if (known > 1) forget(compress_all(known, frontier, still));
  // The next move may start at the clock of the last step, and reverse it.
  if (still) crowded_ = true;
}

double Compressor::next_clock(double frontier) const {
  double first = steps_.ticks.size() > 1 ? steps_.ticks[1] : frontier;
  return std::max(double(last_), std::floor(first) - 1 - lead_ - tolerance_);
}

void Compressor::renew(bool on) {
  renew_ = on;
  dir_ = 0;
}

int64_t Compressor::before_reset(int64_t clock) const {
  for (const Reset& r : resets_)
    if (r.at == clock) return r.before;
  throw std::logic_error("the clock was not set anew then");
}

void Compressor::forget_resets(int64_t clock) {
  while (!resets_.empty() && resets_.front().at < clock) resets_.pop_front();
}

int64_t Compressor::pending_net() const {
  int64_t net = 0;
  for (size_t r = 0; r < steps_.runs.size(); ++r) {
    size_t end = r + 1 < steps_.runs.size() ? steps_.runs[r + 1].first : steps_.ticks.size();
    net += steps_.runs[r].dir * int64_t(end - steps_.runs[r].first);
  }
  return net;
}

void Compressor::restart(int64_t last, const StepStatistics& revoked) {
  steps_.ticks.assign(1, double(last));
  steps_.runs.clear();
  steps_.widenings.clear();
  joined_ = 0;
  last_ = last;
  dir_ = 0;
  crowded_ = true;
  for (; !resets_.empty() && resets_.back().at >= last; resets_.pop_back())
    renew_ |= resets_.back().renewed;
  statistics_.steps -= revoked.steps;
  statistics_.net -= revoked.net;
  statistics_.commands -= revoked.commands;
}

inline void Compressor::drop_close_reversals() {
  auto& runs = steps_.runs;
  for (size_t r = std::max<size_t>(joined_, 1); r < runs.size();) {
    size_t at = runs[r].first, end = r + 1 < runs.size() ? runs[r + 1].first : steps_.ticks.size();
    size_t begin = runs[r - 1].first, pairs = 0;
    while (at + pairs < end && at - pairs > begin &&
           steps_.ticks[at + pairs] - steps_.ticks[at - pairs - 1] < reversal_)
      ++pairs;
    if (pairs == 0) {
      ++r;
      continue;
    }
    statistics_.dropped_pairs += int64_t(pairs);
    steps_.ticks.erase(steps_.ticks.begin() + long(at - pairs),
                       steps_.ticks.begin() + long(at + pairs));
    steps_.move_widenings(at - pairs, 2 * pairs);
    for (size_t q = r; q < runs.size(); ++q) runs[q].first -= q == r ? pairs : 2 * pairs;
    remove_empty(r);
    r = std::max<size_t>(r > 1 ? r - 1 : 1, 1);
  }
  joined_ = runs.empty() ? 0 : runs.size() - 1;
}

void Compressor::remove_empty(size_t r) {
  auto& runs = steps_.runs;
  auto empty = [&](size_t q) {
    return runs[q].first == (q + 1 < runs.size() ? runs[q + 1].first : steps_.ticks.size());
  };
  if (empty(r)) runs.erase(runs.begin() + long(r));
  if (empty(r - 1)) runs.erase(runs.begin() + long(r - 1));
  for (size_t q = 1; q < runs.size();) {
    if (runs[q].dir == runs[q - 1].dir)
      runs.erase(runs.begin() + long(q));
    else
      ++q;
  }
}

void Compressor::set_apart() {
  crowded_ = false;
  const double apart = this->apart();
  bool anew = resets(steps_.ticks[1]);
  double least = std::max(
      {double(last_), anew ? double(floor_) : steps_.ticks[0], double(behind_) - apart + 1});
  for (size_t k = 1; k < steps_.ticks.size() && steps_.ticks[k] < least + apart; ++k)
    steps_.ticks[k] = least += apart;
}

inline size_t Compressor::compress_all(size_t known, double frontier, bool still) {
  const size_t n = steps_.ticks.size();
  // After a stop the next step may be due at once. Then set_apart() delays it.
  steps_.ticks.push_back(still ? steps_.ticks.back() + apart() : 1e18);
  size_t done = 1;
  for (bool last = false; !last;) {
    size_t end = std::min(n, done + kBlock);
    last = known <= end;
    prepare(done, end);
    done = compress(done, std::min(known, end), last, frontier, still);
  }
  steps_.ticks.pop_back();
  return done;
}

inline void Compressor::prepare(size_t from, size_t to) {
  base_ = from;
  if (size_t n = to - from; lo_.size() < n + 3)
    for (auto* v : {&lo_, &hi_, &executed_}) v->resize(2 * (n + 3));
  double tolerance = tolerance_;
  auto fill = [&](size_t end) {
    if (end <= from) return;
    windows(steps_.ticks.data() + from, &lo_[from - base_], &hi_[from - base_], int(end - from),
            tolerance, least_);
    from = end;
  };
  for (const Steps::Widening& w : steps_.widenings) {
    fill(std::min(w.first, to));
    tolerance = std::max(tolerance_, w.tolerance);
  }
  fill(to);
  for (const Steps::Run& run : steps_.runs) {
    if (run.first < 2) continue;
    double half = half_turn(run.first);
    for (size_t k : {run.first - 1, run.first})
      if (k >= base_ && k < to) narrow(k, half);
  }
  for (size_t k = 0; k < to - base_ && lo_[k] <= double(behind_); ++k) lo_[k] = double(behind_) + 1;
}

inline double Compressor::half_turn(size_t b) const {
  return std::max(0.0, 0.5 * (steps_.ticks[b] - steps_.ticks[b - 1] - reversal_)) + 0.5;
}

inline void Compressor::narrow(size_t k, double half) {
  lo_[k - base_] = std::max(lo_[k - base_], steps_.ticks[k] - half);
  hi_[k - base_] = std::min(hi_[k - base_], steps_.ticks[k] + half);
}

inline size_t Compressor::compress(size_t i, size_t known, bool last, double frontier, bool still) {
  const double* t = steps_.ticks.data();
  const size_t size = steps_.ticks.size() - 1;
  double before = double(last_);  // local: each search depends on it
  for (size_t r = 0; r < steps_.runs.size() && i < known; ++r) {
    bool last_run = r + 1 == steps_.runs.size();
    size_t run_end = last_run ? size : steps_.runs[r + 1].first;
    size_t end = std::min(run_end, known);
    bool open = last && !still && (last_run || run_end > known);
    while (i < end) {
      if (!last && end == known && end - i < size_t(kMaxSteps)) return check(i);
      if (resets(t[i])) {
        reset_clock(t[i]);
        double& lo = lo_[i - base_];  // its window may start before the new clock, because the last
                                      // step was long ago
        before = double(last_);
        lo = std::max(lo, before + 1);
      }
      int left = int(std::min(end - i, size_t(kMaxSteps))), n = std::min(left, kLook);
      size_t k = i - base_;
      Command c = stabbing_->longest(&lo_[k], &hi_[k], n, before, &executed_[k]);
      if ((c.count == n && n < left) || t[i + size_t(c.count) - 1] - t[i] > longest_) {
        n = int(std::upper_bound(t + i, t + i + left, t[i] + longest_) - (t + i));
        c = stabbing_->longest(&lo_[k], &hi_[k], n, before, &executed_[k]);
      }
      if (open && i + size_t(c.count) == end && frontier - margin_ <= t[i] + longest_)
        return check(i);
      const double span = c.span();
      emit(steps_.runs[r].dir, i, c, int64_t(span));
      before += span;
      i += size_t(c.count);
    }
  }
  return check(i);
}

inline size_t Compressor::check(size_t done) {
  Errors e = stabbing_->errors(&steps_.ticks[base_], &lo_[0], &hi_[0], &executed_[0], done - base_);
  if (e.beyond > 1e-5) throw std::logic_error("a command left the window of its steps");
  statistics_.error_max = std::max(statistics_.error_max, e.largest);
  statistics_.error_square += e.square;
  return done;
}

inline int64_t Compressor::due(double first) const {
  return std::max({last_, floor_, int64_t(std::floor(first - lead_))});
}

inline void Compressor::reset_clock(double first) {
  int64_t before = last_;
  last_ = due(first);
  resets_.push_back({last_, before, renew_});
  renew_ = false;
  messages_.push({last_, last_, 0, 0, 0, target_, MessageKind::reset_clock, 0});
}

inline void Compressor::emit(int dir, size_t i, const Command& c, int64_t span) {
  const int64_t clock = due(steps_.ticks[i]), end = last_ + span, count = c.count;
  if (dir != dir_) {
    messages_.push({clock, clock, 0, 0, 0, target_, MessageKind::set_dir, uint8_t(dir > 0)});
    dir_ = dir;
  }
  messages_.push({clock, end, uint32_t(c.interval), uint16_t(count), int16_t(c.add), target_,
                  MessageKind::queue_step, uint8_t(dir > 0)});
  last_ = end;
  if (keeps_ideal_)
    ideal_.insert(ideal_.end(), steps_.ticks.begin() + long(i),
                  steps_.ticks.begin() + long(i) + count);
  statistics_.steps += count;
  statistics_.net += dir * count;
  ++statistics_.commands;
}

inline void Compressor::forget(size_t done) {
  if (done == 1) return;
  size_t shift = done - 1;
  steps_.ticks.erase(steps_.ticks.begin(), steps_.ticks.begin() + long(shift));
  auto& runs = steps_.runs;
  size_t keep = 0;
  while (keep + 1 < runs.size() && runs[keep + 1].first <= done) ++keep;
  runs.erase(runs.begin(), runs.begin() + long(keep));
  if (!runs.empty()) runs[0].first = std::max(runs[0].first, done);
  for (Steps::Run& run : runs) run.first -= shift;
  steps_.move_widenings(0, shift);
  joined_ = joined_ > keep ? joined_ - keep : 0;
}

}  // namespace passo
