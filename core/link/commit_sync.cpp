#include "link/commit_sync.hpp"

#include <algorithm>
#include <utility>

namespace passo::wire {

size_t Timeline::take_seat() {
  std::lock_guard lock(guard_);
  mail_.emplace_back();
  return mail_.size() - 1;
}

void Timeline::set_wake(size_t seat, std::function<void()> wake) {
  std::lock_guard lock(guard_);
  mail_[seat].wake = std::move(wake);
}

void Timeline::set_clock(const ClockLine& line, double hz) {
  std::lock_guard lock(guard_);
  line_ = line;
  hz_ = hz;
}

double Timeline::host_at(double clock, double hz) const {
  std::lock_guard lock(guard_);
  return line_.host_at(clock) * (hz / hz_);
}

double Timeline::clock_at(double host, double hz) const {
  std::lock_guard lock(guard_);
  return line_.clock_at(host * (hz_ / hz));
}

void Timeline::arm(std::vector<Member> members, uint32_t reason, uint32_t expired, double clock,
                   double patience, uint32_t failed) {
  std::lock_guard lock(guard_);
  for (Member& m : members) m.reported = clock;
  groups_.push_back({std::move(members), reason, expired, patience, failed});
}

void Timeline::disarm() {
  std::lock_guard lock(guard_);
  groups_.clear();
}

void Timeline::reported(size_t seat, uint32_t oid, bool can_trigger, uint32_t reason,
                        double clock) {
  std::lock_guard lock(guard_);
  for (Group& group : groups_)
    for (Member& member : group.members)
      if (member.seat == seat && member.oid == oid) {
        if (can_trigger)
          put_off(group, member, clock);
        else if (!group.over && group.takes(reason))
          trigger(group, member, reason);
      }
}

std::vector<Timeline::Order> Timeline::take_mail(size_t seat) {
  std::lock_guard lock(guard_);
  return std::exchange(mail_[seat].orders, {});
}

void Timeline::begin_commits() {
  std::lock_guard lock(guard_);
  for (Mail& mail : mail_) mail.has = 0;
  survive_ = true;
}

bool Timeline::may_commit(size_t seat, uint32_t serial) {
  std::lock_guard lock(guard_);
  bool news = mail_[seat].has < serial;
  if (news) mail_[seat].has = serial;
  for (const Mail& mail : mail_)
    if (mail.has < serial) return false;
  for (const Mail& mail : mail_)
    if (news && mail.wake) mail.wake();
  return true;
}

void Timeline::lost() {
  if (!survive_) halt();
}

void Timeline::halt() {
  halted_ = true;
  std::lock_guard lock(guard_);
  for (const Mail& mail : mail_)
    if (mail.wake) mail.wake();
}

void Timeline::post(const Member& to, const Order& order) {
  Mail& mail = mail_[to.seat];
  mail.orders.push_back(order);
  if (mail.wake) mail.wake();
}

void Timeline::trigger(Group& group, const Member& by, uint32_t reason) {
  group.over = true;
  for (const Member& m : group.members)
    if (&m != &by) post(m, {m.oid, true, reason, 0});
}

void Timeline::put_off(Group& group, Member& by, double clock) {
  auto earliest = [&] {
    double first = group.members[0].reported;
    for (const Member& m : group.members) first = std::min(first, m.reported);
    return first;
  };
  double before = earliest();
  by.reported = std::max(by.reported, clock);
  if (group.over || earliest() <= before) return;
  for (const Member& m : group.members) post(m, {m.oid, false, 0, earliest() + group.patience});
}

}  // namespace passo::wire
