#include "link/link.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <stdexcept>
#include <variant>

#include "link/retimer.hpp"

namespace passo::wire {

Link::Link(double clock_hz)
    : hz_(clock_hz), window_(clock_hz), sync_(clock_hz), job_(clock_hz), lateness_(clock_hz),
      heaters_(clock_hz, commands_, sync_, job_,
               [this](const std::string& name, const std::vector<Value>& values) {
                 if (!shut_down_) send(name, values);  // during this time the board only measures
               }) {
  reports_.add(0, "identify_response offset=%u data=%.*s");
  commands_.add(1, "identify offset=%u count=%c");
}

void Link::set_dictionary(Formats commands, Formats reports, size_t receive_window) {
  inbox_.clear();
  commands_ = std::move(commands);
  reports_ = std::move(reports);
  window_.set_receive_window(receive_window);
  clock_id_ = id_of("clock");
  uptime_id_ = id_of("uptime");
  analog_id_ = id_of("analog_in_state");
  converter_id_ = id_of("thermocouple_result");
  shutdown_id_ = id_of("shutdown");
  is_shutdown_id_ = id_of("is_shutdown");
  survive_id_ = id_of("survive_state");
  trsync_id_ = id_of("trsync_state");
  starting_id_ = id_of("starting");
}

void Link::send(const std::string& name, const std::vector<Value>& values) {
  Bytes payload;
  commands_.at(name).encode(values, payload);
  if (payload.size() > kPayloadMax) throw std::invalid_argument(name + ": too long for a frame");
  if (name != "emergency_stop") return now_queue_.push_back({std::move(payload), Asks::nothing});
  stop_ = std::move(payload);
  job_.stop();
  holds_question_ = holds_query_ = holds_command_ = false;
  open_size_ = 0;
  open_first_ = open_need_ = kNever;
}

void Link::follow_clock(Ticks now) {
  following_ = configured_ = true;
  next_sync_ = now;
  samples_ = 0;
  asked_at_ = now;
  lost_ = false;
}

void Link::set_byte_ticks(double ticks) {
  byte_ticks_ = ticks;
  window_.set_byte_ticks(ticks);
}

void Link::join(std::shared_ptr<Timeline> timeline, bool main, double tolerance) {
  timeline_ = std::move(timeline);
  seat_ = timeline_->take_seat();
  main_ = main;
  if (main)
    timeline_->set_clock(sync_.line(), hz_);
  else
    job_.retime(tolerance);
}

Ticks Link::own_clock(Ticks clock) const {
  if (main_) return clock;
  double host = timeline_->host_at(double(clock), hz_);
  return Ticks(std::floor(sync_.line().clock_at(host) + 0.5));
}

Ticks Link::main_clock(Ticks own) const {
  if (main_) return own;
  double host = sync_.line().host_at(double(own));
  return Ticks(std::floor(timeline_->clock_at(host, hz_) + 0.5));
}

void Link::set_queue(MessageQueue* queue) {
  queue_ = queue;
  if (live_ && queue) queue->share();
  job_.set_queue(queue);
}

void Link::set_live() {
  live_ = true;
  set_queue(queue_);
}

void Link::start_job(Ticks base, double main_hz) {
  main_base_ = base;
  if (Retimer* retimer = job_.retimer()) {
    retimer->start(main_hz, hz_ / main_hz);
    base = own_clock(main_base_);
    job_.start(base);
    renew_map(0);
  }
  for (Bytes& reset : job_.resets(base)) now_queue_.push_back({std::move(reset), Asks::nothing});
  job_.start(base);
}

Heater& Link::add_heater(HeaterOptions options) {
  commands_.at(options.pwm ? "queue_pwm_out" : "queue_digital_out");
  return heaters_.add(std::move(options));
}

void Link::use_commits(Ticks horizon) {
  job_.use_commits(commands_, horizon);
  keeps_ = true;
  heaters_.keep();
}

void Link::begin_commits(bool on) {
  job_.reset_commits();
  agree();
  if (timeline_ && on) timeline_->begin_commits();
}

void Link::restart() {
  window_.restart();
  scanner_.reset();
  now_queue_.clear();
  stop_.clear();
  job_.stop();
  lateness_.restart();
  due_ = kNever;
  open_size_ = 0;
  open_first_ = open_need_ = kNever;
  holds_question_ = holds_command_ = asked_ = shut_down_ = false;
  holds_query_ = queried_ = restarted_ = false;
}

void Link::reconnect() {
  restart();
  heaters_.interrupted();
  if (following_) follow_clock(0);
  long_ago_ = true;
  configured_ = false;  // an estimate: opening a port resets many boards
}

bool Link::acknowledged() const {
  return stop_.empty() && now_queue_.empty() && !holds_command_ && window_.acked() > last_command_;
}

double Link::unacknowledged_s(Ticks clock) const {
  if (window_.idle()) return 0;
  return double(sync_.host_at(clock) - window_.sent_at(window_.acked())) / hz_;
}

bool Link::delivered() const {
  bool all = true;
  if (queue_) {
    auto held = queue_->hold();
    all = queue_->empty();
  }
  return all && open_first_ == kNever && window_.acked() > last_of_job_ && taken_;
}

void Link::resume() {
  configured_ = true;
  self_stopped_ = false;
  agree();
  map_anew_ = job_.retimer() != nullptr;
  heaters_.tell_kept_again();
  job_.resume();
}

bool Link::feed(const uint8_t* data, size_t n, Ticks now) {
  Ticks clock = wake(now);
  if (record_.on()) record_.add(true, data, n, now, clock);
  uint64_t acked = window_.acked();
  bool waited = keeps_ || timeline_ || !sync_.ready() || !window_.room(kPayloadMax);
  scanner_.feed(
      data, n,
      [&](uint8_t sequence, const uint8_t* payload, size_t size) {
        if (is_starting(payload, size)) return started();
        if (restarted_ || !window_.acknowledge(sequence, size == 0, now) || size == 0) return;
        receive(payload, size, now);
        waited = true;
      },
      [] {});
  if (sync_.ready())
    for (; acked < window_.acked(); ++acked)
      lateness_.arrived(acked, window_.repeated(acked), clock);
  return waited || window_.refused();
}

void Link::cable_full(Ticks now) {
  lateness_.looked(Cause::bytes, wake(now));
  due_ = kNever;
}

Ticks Link::poll(Ticks now, Bytes& out) {
  if (restarted_) return due_ = kNever;
  size_t before = out.size();
  if (timeline_ && timeline_->halted() && !shut_down_ && !std::exchange(halted_, true))
    send("emergency_stop", {});
  if (!stop_.empty() && window_.replace(stop_)) stop_.clear(), last_command_ = window_.next() - 1;
  window_.poll(now, out);
  if (following_ && now >= next_sync_) ask_clock(now);
  if (timeline_ && !shut_down_) follow_orders();
  Ticks clock = wake(now);
  if (sync_.ready() && std::exchange(map_anew_, false)) begin_map_anew(now);
  if (sync_.ready() && !shut_down_)
    for (Bytes again = job_.renew(clock); !again.empty(); again = job_.renew(clock))
      now_queue_.push_back({std::move(again), Asks::nothing});
  if (must_ask_state()) {
    send("survive_query", {});
    now_queue_.back().second = Asks::state;
    queried_ = true;
  }
  for (bool more = true; more && window_.room(kPayloadMax) && fill_frame(clock, more);) {
    if (holds_question_) question_ = window_.next();
    if (holds_query_) query_ = window_.next(), queried_ = false;
    if (holds_command_) last_command_ = window_.next();
    holds_question_ = holds_query_ = holds_command_ = false;
    lateness_.left(window_.next(), job_.must_leave(open_first_), open_need_, clock);
    if (open_first_ != kNever) last_of_job_ = window_.next();
    window_.seal(open_size_, now, out);
    ++frames_;
    open_size_ = 0;
    open_first_ = open_need_ = kNever;
  }
  wire_bytes_ += out.size() - before;
  if (record_.on() && out.size() > before)
    record_.add(false, out.data() + before, out.size() - before, now, clock);
  lateness_.looked(obstacle(clock), clock);
  return due_ = deadline(now);
}

int32_t Link::id_of(const std::string& name) const {
  const Format* format = reports_.find(name);
  return format ? format->id : -1000;
}

// `inline`: code that runs once for each frame becomes part of poll() and feed().

inline Ticks Link::wake(Ticks now) {
  if (!sync_.ready()) return 0;
  if (now == woke_) return clock_;
  woke_ = now;
  clock_ = sync_.clock_at(now);
  lateness_.woke(now > due_ ? sync_.clock_at(due_) : clock_, clock_);
  due_ = std::max(due_, now);
  return clock_;
}

inline Cause Link::obstacle(Ticks clock) const {
  if (!window_.room(kPayloadMax) && job_.wake() <= clock)
    return window_.resending() ? Cause::retransmits : Cause::bytes;
  if (waits_) return Cause::retransmits;
  return job_.short_of_slots() ? Cause::slots : Cause::plan;
}

inline bool Link::fill_frame(Ticks clock, bool& more) {
  uint8_t* payload = window_.payload();
  while (!now_queue_.empty()) {
    const auto& [command, asks] = now_queue_.front();
    if (open_size_ + command.size() > kPayloadMax) return true;
    std::copy(command.begin(), command.end(), payload + open_size_);
    open_size_ += command.size();
    holds_command_ = true;
    holds_question_ |= asks == Asks::clock;
    holds_query_ |= asks == Asks::state;
    now_queue_.pop_front();
  }
  bool commits = false;
  if (sync_.ready() && !shut_down_) {
    auto word = [&](uint32_t serial, bool rest) {
      JobStream::Word word = word_for(serial, rest);
      commits |= word == JobStream::Word::and_ask;
      return word;
    };
    auto filled = job_.fill(payload, open_size_, open_first_, open_need_, clock, word);
    more = filled == JobStream::Fill::full;
    if (more) return true;
    if (filled == JobStream::Fill::complete) return open_size_ > 0;
  }
  if (open_size_ == 0) return false;
  return holds_command_ || commits || job_.must_leave(open_first_) <= clock;
}

inline JobStream::Word Link::word_for(uint32_t serial, bool rest) {
  if (timeline_) {
    waits_ = self_stopped_ || !taken_ || open_first_ != kNever || window_.acked() <= last_of_job_ ||
             !timeline_->may_commit(seat_, serial);
    if (waits_) return JobStream::Word::no;
  }
  committed_ = serial;
  taken_ = !timeline_ && !rest;
  if (taken_) return JobStream::Word::yes;
  return JobStream::Word::and_ask;
}

inline bool Link::must_ask_state() const {
  return !taken_ && !queried_ && !self_stopped_ && job_.running() && open_first_ == kNever &&
         window_.acked() > std::max(last_of_job_, query_);
}

void Link::take_state(int64_t state, uint32_t serial) {
  taken_ |= serial == committed_;
  self_stopped_ |= state >= kBraking || (!taken_ && window_.acked() > last_of_job_ + 1);
}

void Link::follow_orders() {
  for (const Timeline::Order& order : timeline_->take_mail(seat_)) {
    if (order.triggers)
      send("trsync_trigger", {int64_t(order.oid), int64_t(order.reason)});
    else
      send("trsync_set_timeout",
           {int64_t(order.oid), int64_t(uint32_t(own_clock(Ticks(order.clock))))});
  }
}

void Link::renew_map(double job_clock) {
  renewed_ = job_clock;
  job_.retimer()->map().renew(job_clock, [this](double t) { return expected(t); });
}

void Link::begin_map_anew(Ticks now) {
  renewed_ = double(main_clock(sync_.clock_at(now)) - main_base_);
  job_.retimer()->map().restart(renewed_, [this](double t) { return expected(t); });
}

void Link::follow_timeline(Ticks now) {
  if (main_) return timeline_->set_clock(sync_.line(), hz_);
  if (!job_.running()) return;
  const TimeMap& map = job_.retimer()->map();
  double job_clock = map.inverse(double(sync_.clock_at(now) - job_.base()));
  if (job_clock >= renewed_ + kRenewSeconds * map.hz()) renew_map(job_clock);
}

double Link::until_next_question() const {
  if (!timeline_) return samples_ < kQuickSamples ? kQuickSeconds : kSyncSeconds;
  return asks_often() ? kOftenSeconds : kSyncOfSeveralSeconds;
}

bool Link::asks_often() const {
  return timeline_ && (samples_ < kQuickSamplesOfSeveral || sync_.jitter_s() > kJitterSeconds);
}

void Link::ask_clock(Ticks now) {
  if (std::exchange(long_ago_, false)) sync_.bridge(now);
  next_sync_ = now + Ticks(until_next_question() * hz_);
  if (asked_) {
    lost_ = now - asked_at_ > Ticks(kLostSeconds * hz_);
    if (timeline_ && lost_) timeline_->lost();
    // An answer comes before the acknowledgement, or never. Only one question is on its way,
    // because the answers do not tell them apart.
    if (question_ == 0 || window_.acked() <= question_) return;
  }
  Bytes payload;
  commands_.at(sync_.ready() ? "get_clock" : "get_uptime").encode({}, payload);
  now_queue_.push_back({std::move(payload), Asks::clock});
  // Its reports may be lost.
  if (keeps_ && job_.running() && (!asks_often() || samples_ % kSamplesPerState == 0))
    send("survive_query", {});
  if (!asked_) asked_at_ = now;
  asked_ = true;
  question_ = 0;
}

inline Ticks Link::deadline(Ticks now) const {
  Ticks next = std::min(window_.deadline(), following_ ? next_sync_ : kNever);
  if (sync_.ready() && !shut_down_ && window_.room(kPayloadMax)) {
    Ticks wake = open_size_ > 0 ? job_.must_leave(open_first_) : job_.wake();
    wake = std::min(wake, job_.renew_at());
    if (wake != kNever) next = std::min(next, sync_.host_at(wake));
  }
  return std::max(next, now + 1);
}

inline bool Link::is_starting(const uint8_t* payload, size_t size) const {
  Reader in{payload, payload + size};
  return size > 0 && int32_t(in.vlq()) == starting_id_ && in.ok;
}

void Link::started() {
  if (!configured_) return window_.restart();  // otherwise it gets the reset command again
  restarted_ = true;
  job_.stop();
  if (timeline_) timeline_->lost();
}

inline void Link::receive(const uint8_t* payload, size_t size, Ticks now) {
  Reader in{payload, payload + size};
  int32_t id = int32_t(in.vlq());
  const Format* format = reports_.find(id);
  if (!in.ok || !format) return;
  std::vector<Value> values;
  format->decode(in, values);
  if (!in.ok) return;
  try {
    take(id, *format, values, size, now);
  } catch (const std::exception& e) {  // another dictionary than this program expects
    throw std::runtime_error("its report " + format->name + " cannot be used: " + e.what());
  }
}

inline void Link::take(int32_t id, const Format& format, std::vector<Value>& values, size_t size,
                       Ticks now) {
  if (id == clock_id_ || id == uptime_id_) {
    take_clock(id == uptime_id_, values, now - on_the_line(kFrameMin + size));
  } else if ((id == analog_id_ || id == converter_id_) && heaters_.take(values, now)) {
    return;
  } else {
    if (id == trsync_id_ && timeline_) take_trsync(values);
    if (id == survive_id_ && job_.running()) {
      take_state(std::get<int64_t>(values.at(0)), uint32_t(std::get<int64_t>(values.at(1))));
      return;
    }
    if (id == shutdown_id_ || id == is_shutdown_id_) {
      shutdown_reason_ = uint32_t(std::get<int64_t>(values.at(id == shutdown_id_ ? 1 : 0)));
      shut_down_ = true;
      job_.stop();
      if (timeline_) timeline_->halt();
    }
    if (inbox_.size() == kInboxMax) inbox_.pop_front();
    inbox_.push_back({&format, std::move(values)});
  }
}

void Link::take_trsync(const std::vector<Value>& values) {
  int64_t v[4];
  for (size_t i = 0; i < 4; ++i) v[i] = std::get<int64_t>(values.at(i));
  Ticks clock = main_clock(sync_.unwrap(uint32_t(v[3])));
  timeline_->reported(seat_, uint32_t(v[0]), v[1] != 0, uint32_t(v[2]), double(clock));
}

inline void Link::take_clock(bool uptime, const std::vector<Value>& values, Ticks answered) {
  // The answer belongs to the frame that it acknowledges. After a link loss, the answer to an
  // earlier question may arrive; it must not count as the answer to the next question.
  if (!asked_ || question_ == 0 || window_.acked() != question_ + 1) return;
  asked_ = false;
  lost_ = false;
  if (window_.opening(question_)) return;
  // For a repeated frame it is unknown which copy was answered, but no copy was answered before the
  // first one was sent. Only that bound is used for the clock.
  Ticks received = window_.sent_at(question_) + on_the_line(window_.length(question_));
  answered = std::max(answered, received);
  if (uptime)
    sync_.start(std::get<int64_t>(values.at(0)) << 32 | std::get<int64_t>(values.at(1)), received,
                answered);
  else if (sync_.ready())
    sync_.add(uint32_t(std::get<int64_t>(values.at(0))), received, answered);
  ++samples_;
  woke_ = kNever;  // the estimate of the clock is better now
  if (timeline_) follow_timeline(answered);
}

}  // namespace passo::wire
