// The state that the links to the boards of one machine share: the main board's clock, endstops
// that stop motors on several boards, the boards' commits, and failures of boards.
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <vector>

#include "link/clock_sync.hpp"

namespace passo::wire {

// Shared by the links of one machine, each from its own thread if it has one. No function waits for
// a link: messages for another link's board go into that link's mailbox.
class Timeline {
 public:
  // A command for a trsync of a board: trigger with `reason`, or expire at a clock of the main
  // board.
  struct Order {
    uint32_t oid;
    bool triggers;
    uint32_t reason;
    double clock;
  };
  // A trsync of the board on a link.
  struct Member {
    size_t seat;
    uint32_t oid;
    double reported = 0;  // clock of the main board at its last report
  };

  // Returns the number of a link's mail.
  size_t take_seat();
  // `wake` makes a link read its mailbox; any thread may call it.
  void set_wake(size_t seat, std::function<void()> wake);

  // The main board's clock, as its link estimates it; host time in ticks of `hz`.
  void set_clock(const ClockLine& line, double hz);
  // Converts a clock of the main board to host time in ticks of `hz`; the second function converts
  // back.
  double host_at(double clock, double hz) const;
  double clock_at(double host, double hz) const;

  // These trsyncs trigger together: as soon as one has reported that it did, with `reason`, or with
  // `expired` because its timeout was not extended, the others get the command to trigger. They
  // expire when one of them has not reported for `patience` ticks, counted from `clock` at first.
  // Reasons from `failed` up to kFailures later, if it is not 0, are errors of a sensor, and
  // trigger them, too.
  static constexpr uint32_t kFailures = 16;
  void arm(std::vector<Member> members, uint32_t reason, uint32_t expired, double clock,
           double patience, uint32_t failed = 0);
  void disarm();
  // A board's report of a trsync, made at a clock of the main board.
  void reported(size_t seat, uint32_t oid, bool can_trigger, uint32_t reason, double clock);
  std::vector<Order> take_mail(size_t seat);

  // From now on motion comes in commits; there is no commit yet. Call it before any motion is sent.
  void begin_commits();
  // The board of a link has all messages of a commit except the message that makes it valid.
  // Returns true once all boards do: then that message may be sent. So when one board has a commit,
  // all others have at least the commit before it.
  bool may_commit(size_t seat, uint32_t serial);

  // The link to a board is lost. Boards with `survive` stop by themselves; otherwise all boards
  // stop at once.
  void lost();
  // A board has stopped: all others stop, too.
  void halt();
  bool halted() const { return halted_; }

 private:
  struct Group {
    std::vector<Member> members;
    uint32_t reason, expired;
    double patience;
    uint32_t failed;
    bool over = false;
    bool takes(uint32_t why) const {
      return why == reason || why == expired ||
             (failed != 0 && why >= failed && why < failed + kFailures);
    }
  };
  struct Mail {
    std::vector<Order> orders;
    std::function<void()> wake;
    uint32_t has = 0;  // the last commit of which the board has everything except the commit
                       // message
  };

  mutable std::mutex guard_;
  ClockLine line_;
  double hz_ = 1;
  std::vector<Group> groups_;
  std::vector<Mail> mail_;
  std::atomic<bool> halted_{false}, survive_{false};

  void post(const Member& to, const Order& order);
  void trigger(Group& group, const Member& by, uint32_t reason);
  void put_off(Group& group, Member& by, double clock);
};

}  // namespace passo::wire
