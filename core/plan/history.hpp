// Moves whose steps are known, as far back as they may be asked for or cut.
#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "plan/bounds.hpp"
#include "plan/move.hpp"

namespace passo {

class History {
 public:
  explicit History(double clock_hz) : hz_(clock_hz) {}

  void add(const std::vector<Move>& moves) {
    moves_.insert(moves_.end(), moves.begin(), moves.end());
  }
  // What ended before `past` will not be cut any more.
  void forget(double past) {
    for (; begin_ < moves_.size() && moves_[begin_].end() < past; ++begin_)
      gone_ = moves_[begin_].end();
    if (2 * begin_ < moves_.size()) return;
    moves_.erase(moves_.begin(), moves_.begin() + long(begin_));
    begin_ = 0;
  }
  bool empty() const { return begin_ == moves_.size(); }
  const Move& oldest() const { return moves_[begin_]; }
  // The move that is under way at a clock, or else the next one; end() if there is none.
  std::vector<Move>::const_iterator at(double clock) const {
    return std::partition_point(moves_.begin() + long(begin_), moves_.end(),
                                [&](const Move& m) { return m.end() <= clock; });
  }
  std::vector<Move>::const_iterator end() const { return moves_.end(); }
  const Move* last() const { return moves_.empty() ? nullptr : &moves_.back(); }
  // Where the machine was at a clock, and is going if it stood before its next move; nothing if
  // that is not known any more. `planned_to`: where it goes on from behind all moves.
  std::optional<std::array<double, kAxes>> position_at(double clock,
                                                       const double* planned_to) const {
    auto next = std::upper_bound(moves_.begin(), moves_.end(), clock,
                                 [](double t, const Move& m) { return t < m.start; });
    bool first = next == moves_.begin();
    if (first && clock < gone_) return std::nullopt;
    std::array<double, kAxes> p;
    if (first || clock >= std::prev(next)->end()) {  // it stands, perhaps where it was told it is
      std::copy_n(next != moves_.end() ? next->p0 : planned_to, kAxes, p.begin());
      return p;
    }
    const Move& m = *std::prev(next);
    double part = m.kind == MoveKind::dwell ? 1 : m.along(clock - m.start, hz_).first / m.d;
    for (size_t j = 0; j < p.size(); ++j) p[j] = m.p0[j] + (m.p1[j] - m.p0[j]) * part;
    return p;
  }

  // Takes back what comes after `clock`; a move that is under way stays and is returned too.
  std::vector<Move> cut(double clock) {
    size_t first = moves_.size();
    while (first > begin_ && moves_[first - 1].end() > clock) --first;
    std::vector<Move> rest(moves_.begin() + long(first), moves_.end());
    moves_.resize(first);
    return rest;
  }
  // Divides a move that is under way at `clock`: the first part is added, and returned; `m` is what
  // is left of it, and `speed2` the speed² in between.
  const Move& divide(Move& m, double clock, double& speed2) {
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

 private:
  double hz_;
  std::vector<Move> moves_;
  size_t begin_ = 0;          // moves before it are forgotten
  double gone_ = -kInfinity;  // clock at which the last of them has ended
};

}  // namespace passo
