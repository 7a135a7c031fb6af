// A link on a cable in real time. Its own thread carries the bytes, so commands leave when they are
// due, and heaters are controlled, whatever the other threads do.
#pragma once
#include <atomic>
#include <condition_variable>
#include <memory>
#include <string>
#include <thread>

#include "link/cable.hpp"
#include "link/link.hpp"
#include "link/stop_reason.hpp"

namespace passo::wire {

class LiveWire {
 public:
  // Starts at once. Other threads use the link only under its guard(). The link must outlive this
  // object. From now on the queue of its job is shared.
  LiveWire(Link& link, int fd);
  ~LiveWire();

  double hz() const { return link_.hz(); }
  // This computer's time in ticks; after use_board_clock() the board's clock, which never runs
  // backwards.
  Ticks now();
  // Call it once the link is synchronous: the time must not change while a caller calculates with
  // it.
  void use_board_clock();
  // The thread wakes whenever another link of the machine puts a message into this link's mailbox.
  void join(std::shared_ptr<Timeline> timeline);
  // Moves no more bytes, and releases the cable.
  void stop();
  // Like Pump::run in real time; also ends when the cable is cut.
  Stop run(Ticks until, bool until_heaters);
  // The reason why the connection ended; empty while it exists, or if the cable was cut.
  std::string failure();

 private:
  static constexpr double kIdleSeconds = 0.01;  // planned messages arrive without a call

  Link& link_;
  Cable cable_;
  std::shared_ptr<Timeline> timeline_;
  std::condition_variable news_;
  bool closed_ = false, board_clock_ = false;
  Ticks last_ = 0;
  std::string failure_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;

  Ticks clock();

  void carry();
  void carry_on();
};

}  // namespace passo::wire
