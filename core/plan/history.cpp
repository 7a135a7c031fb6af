#include "plan/history.hpp"

#include <algorithm>
#include <iterator>

namespace passo {

void History::add(const std::vector<Move>& moves) {
  moves_.insert(moves_.end(), moves.begin(), moves.end());
}

void History::forget(double past) {
  for (; begin_ < moves_.size() && moves_[begin_].end() < past; ++begin_)
    gone_ = moves_[begin_].end();
  if (2 * begin_ < moves_.size()) return;
  moves_.erase(moves_.begin(), moves_.begin() + long(begin_));
  begin_ = 0;
}

std::vector<Move>::const_iterator History::at(double clock) const {
  return std::partition_point(moves_.begin() + long(begin_), moves_.end(),
                              [&](const Move& m) { return m.end() <= clock; });
}

std::optional<std::array<double, kAxes>> History::position_at(double clock,
                                                              const double* planned_to) const {
  auto next = std::upper_bound(moves_.begin(), moves_.end(), clock,
                               [](double t, const Move& m) { return t < m.start; });
  bool first = next == moves_.begin();
  if (first && clock < gone_) return std::nullopt;
  std::array<double, kAxes> p;
  if (first || clock >= std::prev(next)->end()) {  // at standstill, perhaps at a set position
    std::copy_n(next != moves_.end() ? next->p0 : planned_to, kAxes, p.begin());
    return p;
  }
  const Move& m = *std::prev(next);
  double part = m.kind == MoveKind::dwell ? 1 : m.along(clock - m.start, hz_).first / m.d;
  for (size_t j = 0; j < p.size(); ++j) p[j] = m.p0[j] + (m.p1[j] - m.p0[j]) * part;
  return p;
}

double History::filament_after(double clock, size_t extruder) const {
  double sum = 0;
  for (auto m = at(clock); m != moves_.end(); ++m) {
    if (m->extruder != extruder || m->kind == MoveKind::dwell) continue;
    double left = m->start < clock ? 1 - m->along(clock - m->start, hz_).first / m->d : 1;
    sum += (m->p1[kE] - m->p0[kE]) * left;
  }
  return sum;
}

std::vector<Move> History::before(double clock, double memory) const {
  std::vector<Move> found;
  for (auto m = at(clock - memory); m != moves_.end() && m->start < clock; ++m) found.push_back(*m);
  return found;
}

std::vector<Move> History::cut(double clock) {
  size_t first = moves_.size();
  while (first > begin_ && moves_[first - 1].end() > clock) --first;
  std::vector<Move> rest(moves_.begin() + long(first), moves_.end());
  moves_.resize(first);
  return rest;
}

const Move& History::divide(Move& m, double clock, double& speed2) {
  Move done = m;
  double tau = clock - done.start;
  m.ahead0 += (done.ahead1 - done.ahead0) * (tau / done.ticks());
  if (done.kind == MoveKind::dwell) {
    done.t_cru = tau;
    done.duration = tau / hz_;
    m.duration -= done.duration;
    speed2 = 0;
  } else {
    auto [s, v] = done.along(tau, hz_);
    const Move whole = m;
    Bounds::cut(whole, s / whole.d, 1, m);
    Bounds::cut(whole, 0, s / whole.d, done);
    m.inner = true;
    done.d_acc = std::min(done.d_acc, s);
    done.d_cru = std::min(done.d_cru, s - done.d_acc);
    done.t_dec = std::max(0.0, tau - done.t_acc - done.t_cru);
    done.t_cru = std::clamp(tau - done.t_acc, 0.0, done.t_cru);
    done.t_acc = std::min(tau, done.t_acc);
    speed2 = v * v;
  }
  m.records = 0;
  moves_.push_back(done);
  return moves_.back();
}

}  // namespace passo
