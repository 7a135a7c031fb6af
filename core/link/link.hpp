// The host's end of a connection to a board. It has no I/O, thread or clock of its own: the caller
// passes received bytes and host time (ticks of the nominal frequency), and gets the bytes to send
// and the next deadline. If a thread drives it (live_wire.hpp), all other callers hold guard()
// while they use it.
#pragma once
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "link/clock_sync.hpp"
#include "link/commit_sync.hpp"
#include "link/device.hpp"
#include "link/dictionary.hpp"
#include "link/frame.hpp"
#include "link/frame_record.hpp"
#include "link/heaters.hpp"
#include "link/job_stream.hpp"
#include "link/send_slack.hpp"
#include "link/send_window.hpp"

namespace passo::wire {

struct Response {
  const Format* format;
  std::vector<Value> values;
};

class Link {
 public:
  explicit Link(double clock_hz);
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  std::mutex& guard() { return guard_; }
  double hz() const { return hz_; }

  // Replaces the two messages that every board has by the board's dictionary.
  void set_dictionary(Formats commands, Formats reports, size_t receive_window);
  const Formats& commands() const { return commands_; }

  // Queues one command that is sent at once, before the messages of the job. An emergency stop
  // replaces everything that the board has not acknowledged.
  void send(const std::string& name, const std::vector<Value>& values);
  // Messages of the board that the core does not use, oldest first.
  std::deque<Response>& inbox() { return inbox_; }

  // Starts to estimate the clock of the configured board; its first answer makes synchronous()
  // true.
  void follow_clock(Ticks now);
  // Ticks that a byte takes on a serial line. A frame arrives with its last byte.
  void set_byte_ticks(double ticks);
  bool synchronous() const { return sync_.ready(); }
  const ClockSync& clock() const { return sync_; }
  // True if the board has not answered for about four seconds, or has restarted.
  bool lost() const { return lost_ || restarted_; }
  // The board reported `starting`: after a reset or a power failure it rebooted and lost its
  // configuration. Nothing is sent to it until it is connected again.
  bool restarted() const { return restarted_; }

  // This link's board is one of several. The main board's clock is that of the timeline. The steps
  // of a further board may miss their times by `tolerance` additional ticks.
  void join(std::shared_ptr<Timeline> timeline, bool main, double tolerance);
  size_t seat() const { return seat_; }
  // Converts a clock of the main board to this board's clock; the second function converts back.
  Ticks own_clock(Ticks clock) const;
  Ticks main_clock(Ticks own) const;
  JobStream& job() { return job_; }
  // The messages of the job. If a thread drives this link, other threads may use them, too.
  void set_queue(MessageQueue* queue);
  // From now on a thread drives this link.
  void set_live();
  // Starts the job at clock `base` of the main board, whose clock runs at `main_hz`: every motor's
  // clock is set, then messages flow.
  void start_job(Ticks base, double main_hz);

  Heater& add_heater(HeaterOptions options);
  // No heater is still heating or cooling to its target.
  bool heaters_reached() const { return heaters_.reached(); }
  // The board takes commits (docs/decisions/0013-survive.md): messages leave `horizon` ticks ahead.
  // The board gets the power that keeps each heater warm, in case the host stops sending.
  void use_commits(Ticks horizon);
  // Call at standstill: motion comes in commits from here on, if `on`.
  void begin_commits(bool on);
  // True once after faults of heaters: the host has sent the commands that switch them off.
  bool take_fault() { return heaters_.take_fault(); }

  // The board reported that it stopped; its static_string_id is the reason.
  bool shut_down() const { return shut_down_; }
  uint32_t shutdown_reason() const { return shutdown_reason_; }
  // The host has stopped this board, because another board of the machine stopped or was lost.
  bool stopped_with_others() const { return halted_; }
  // The board restarts after a reset or a power cycle: messages on their way are dropped.
  void restart();

  // The board has not received messages in time, and stops by itself.
  bool self_stopped() const { return self_stopped_; }

  // The link was broken, and the board has run without the host: messages on their way are dropped,
  // and the job waits for resume().
  void reconnect();
  // The board has all commands that were sent at once. Their immediate answers have arrived, or are
  // lost.
  bool acknowledged() const;
  // Age in seconds of the oldest message that the board has not acknowledged, when its clock reads
  // `clock`; 0 if all are acknowledged.
  double unacknowledged_s(Ticks clock) const;
  // The board has all messages of the job so far. If motion comes in commits, the board has
  // confirmed the commit that ends at standstill.
  bool delivered() const;
  // The outputs of the board are under control again; the job continues.
  void resume();

  uint64_t wire_bytes() const { return wire_bytes_; }
  uint64_t frames() const { return frames_; }
  uint64_t retransmitted_bytes() const { return window_.retransmitted_bytes(); }
  Lateness& lateness() { return lateness_; }
  // The last sent and received frames, if recording is on.
  FrameRecord& record() { return record_; }

  // Takes bytes from the board. Returns false if poll() need not be called for them: they were only
  // acknowledgements that nothing waits for.
  bool feed(const uint8_t* data, size_t n, Ticks now);
  // The cable takes no bytes now: poll() has to wait.
  void cable_full(Ticks now);

  // Appends the bytes to send now. Returns the host time of the next useful call if no bytes arrive
  // before.
  Ticks poll(Ticks now, Bytes& out);

 private:
  static constexpr double kLostSeconds = 4;
  static_assert(JobStream::kMaxCommandBytes <= Window::kOverrun);
  static constexpr int kQuickSamples = 8, kQuickSamplesOfSeveral = 300;
  static constexpr int kSamplesPerState = 8;  // where the host queries the clock often
  static constexpr double kQuickSeconds = 0.05, kSyncSeconds = 0.9839;
  // With several boards: usual period of queries; and the period at the start, or while the delay
  // of answers varies.
  static constexpr double kSyncOfSeveralSeconds = 0.0983, kOftenSeconds = 0.0113;
  static constexpr double kJitterSeconds = 50e-6, kRenewSeconds = 0.9;
  static constexpr size_t kInboxMax = 4096;

  std::mutex guard_;
  double hz_;
  Formats commands_, reports_;
  Scanner scanner_;
  Window window_;
  ClockSync sync_;
  JobStream job_;
  Lateness lateness_;
  FrameRecord record_;
  Ticks due_ = kNever;                  // host time by which poll() should be called
  Ticks woke_ = kNever, clock_ = 0;     // host time of the last poll; board clock then
  std::shared_ptr<Timeline> timeline_;  // none: this is the only board
  size_t seat_ = 0;
  bool main_ = true, halted_ = false;
  Ticks main_base_ = 0;  // of the job, in the main board's clock
  double renewed_ = 0;   // the job's clock when the map of its time was renewed
  bool map_anew_ = false;
  MessageQueue* queue_ = nullptr;
  bool live_ = false;
  enum class Asks : uint8_t { nothing, clock, state };
  std::deque<std::pair<Bytes, Asks>> now_queue_;  // commands, and the queries among them
  Bytes stop_;                                    // emergency_stop, until it is sent
  std::deque<Response> inbox_;
  Heaters heaters_;
  bool keeps_ = false;  // the board takes commits

  // The frame under construction is in the window's next block.
  size_t open_size_ = 0;
  Ticks open_first_ = kNever, open_need_ = kNever;
  bool holds_question_ = false, holds_query_ = false, holds_command_ = false;

  bool following_ = false, asked_ = false;
  double byte_ticks_ = 0;
  Ticks next_sync_ = kNever;
  uint64_t question_ = 0;  // number of the frame that carries the last question for the clock
  int samples_ = 0;
  Ticks asked_at_ = 0;  // the first query without an answer
  bool lost_ = false;
  int32_t clock_id_ = -1000, uptime_id_ = -1000, analog_id_ = -1000, converter_id_ = -1000,
          shutdown_id_ = -1000, is_shutdown_id_ = -1000, trsync_id_ = -1000, starting_id_ = -1000;
  bool configured_ = false, restarted_ = false;
  int32_t survive_id_ = -1000;
  static constexpr int64_t kBraking = 4;  // from this survive_state on, the board acts alone
  bool self_stopped_ = false, long_ago_ = false;  // the board has not reported for a time
  uint64_t last_of_job_ = 0;   // number of the last frame with messages of the job
  uint32_t committed_ = 0;     // serial of the last commit sent
  bool taken_ = true;          // the board has confirmed it, or was not queried
  bool waits_ = false;         // a commit message waits for this board or for others
  uint64_t last_command_ = 0;  // number of the last frame with commands
  uint64_t query_ = 0;         // number of the frame with the last other query
  bool queried_ = false;       // such a query must be sent
  bool shut_down_ = false;
  uint32_t shutdown_reason_ = 0;
  uint64_t wire_bytes_ = 0, frames_ = 0;

  int32_t id_of(const std::string& name) const;

  // The board's clock, as estimated; messages due before now are late.
  Ticks wake(Ticks now);
  // The reason why no more of the job can be sent now.
  Cause obstacle(Ticks clock) const;

  // Puts the allowed messages into the open frame; returns true if the frame must leave now.
  // `more`: another frame may follow.
  bool fill_frame(Ticks clock, bool& more);

  // With several boards, the commit message is sent as soon as all boards have acknowledged the
  // messages of the commit and have reported that they took the commit before. A single board is
  // queried only for the commits after which the machine is at standstill. The answer of a board
  // arrives before the acknowledgement, or never.
  JobStream::Word word_for(uint32_t serial, bool rest);
  // The board has not answered the last query for a commit.
  bool must_ask_state() const;
  // The board and the host agree on the last commit.
  void agree() { committed_ = 0, taken_ = true, waits_ = false; }
  // Checks the reported state of the board. After a frame that follows the commit message, the
  // board must have the commit; if it does not, it has acknowledged damaged bytes.
  void take_state(int64_t state, uint32_t serial);
  void follow_orders();
  void renew_map(double job_clock);
  void begin_map_anew(Ticks now);
  // The expected reading of this board's clock, since the job began, at a clock of the job.
  double expected(double t) const { return double(own_clock(main_base_ + Ticks(t)) - job_.base()); }
  // The estimates of the clocks have improved.
  void follow_timeline(Ticks now);

  double until_next_question() const;
  bool asks_often() const;
  void ask_clock(Ticks now);

  Ticks deadline(Ticks now) const;

  // Accepts any frame number: the board restarted its count.
  bool is_starting(const uint8_t* payload, size_t size) const;
  void started();
  void receive(const uint8_t* payload, size_t size, Ticks now);
  void take(int32_t id, const Format& format, std::vector<Value>& values, size_t size, Ticks now);
  // trsync_state oid can_trigger trigger_reason clock
  void take_trsync(const std::vector<Value>& values);
  Ticks on_the_line(size_t bytes) const { return Ticks(byte_ticks_ * double(bytes)); }
  void take_clock(bool uptime, const std::vector<Value>& values, Ticks answered);
};

}  // namespace passo::wire
