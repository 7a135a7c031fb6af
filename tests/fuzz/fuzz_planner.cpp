// Moves from bytes through planner, step solver and compressor: every command must be one that the
// board accepts, and the steps must add up to the rounded targets. Lengths go down to nanometres
// and feed rates from crawling to absurd; the board's budget may be short, and some moves come as
// polynomials of time that swing beyond both ends, and the bed may not be flat. Motion may come in
// commits, and the board be left alone with what it was told last, also while moves are held. The
// flow of filament may change at any clock. Records come each once: those of the program (output 0)
// in their order, and those of somebody who comes in between (output 1).
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "geometry/cartesian.hpp"
#include "geometry/delta.hpp"
#include "motion/motion.hpp"

using namespace passo;

namespace {

Machine machine_of(JunctionLaw law, bool delta, bool short_of_commands) {
  Machine machine{};
  machine.name = "fuzz";
  machine.clock_hz = 16e6;
  machine.tolerance = 32;
  for (char letter : {'X', 'Y', 'Z'})
    machine.axes.push_back({std::string(1, char(letter + 32)), letter, -50, 50, 300, 3000, 10, 40});
  machine.extruders.push_back({"e", 100, 5000, 1});
  machine.tools.push_back({0, {0, 0, 0}});
  if (delta)
    machine.geometry = std::make_shared<Delta>(81, std::vector<double>{160, 160, 160},
                                               std::vector<double>{210, 330, 90}, 75.1);
  else
    machine.geometry = std::make_shared<LinearGeometry>(cartesian());
  for (int i = 0; i < 4; ++i)
    machine.steppers.push_back(
        {std::string(1, "xyze"[i]), i < 3 ? Drive::actuator : Drive::extruder, i < 3 ? i : 0,
         i == 2 ? 400.0 : 80.0, 16, 4, 4, 500000, kInfinity, kInfinity, -kInfinity, kInfinity});
  machine.limits = {3000, 3000, 5000, kInfinity, law, 0.02, 5, 0, short_of_commands ? 0.2 : 0};
  if (short_of_commands) machine.budgets = {{20000, 500, 10, true}};
  return machine;
}

struct Board {
  int64_t net[4] = {}, clock[4] = {};
  int direction[4] = {1, 1, 1, 1};
  uint32_t recorded[2] = {};  // the greatest value of each output
  void take(const Message& m) {
    if (m.target >= 4) std::abort();
    if (m.kind == MessageKind::pin) {  // of those at one place the last is sent
      uint32_t &most = recorded[m.target], value = uint32_t(m.interval);
      if (m.target == 0 && value <= most) std::abort();
      most = std::max(most, value);
    }
    if (m.kind == MessageKind::set_dir) direction[m.target] = m.dir ? 1 : -1;
    if (m.kind == MessageKind::reset_clock) clock[m.target] = m.clock;
    if (m.kind != MessageKind::queue_step) return;
    int64_t interval = m.interval;
    if (m.count == 0) std::abort();
    for (int k = 0; k < m.count; ++k, interval += m.add) {
      if (interval <= 0) std::abort();
      clock[m.target] += interval;
    }
    net[m.target] += direction[m.target] * m.count;
  }
};

// A board that takes commits.
struct LoneBoard {
  Board moves;
  std::vector<Message> staged, tails, next_tails;
  uint32_t serial = 0;
  int64_t limit = 0;

  void take(const Message& m) {
    if (m.kind == MessageKind::tail) {
      next_tails.push_back(m);
    } else if (m.kind != MessageKind::commit) {
      staged.push_back(m);
    } else {
      for (const Message& x : staged) {
        if (x.kind == MessageKind::queue_step &&
            moves.clock[x.target] + int64_t(x.interval) <= limit)
          std::abort();  // it belongs to the commit before
        moves.take(x);
      }
      staged.clear();
      tails.swap(next_tails);
      next_tails.clear();
      serial = m.interval;
      limit = m.clock;
      for (int64_t clock : moves.clock)
        if (clock > limit) std::abort();
    }
  }
  void stop_alone() {
    for (Message m : tails) {
      if (m.count == 0) {
        moves.clock[m.target] += int32_t(m.interval - uint32_t(moves.clock[m.target]));
        continue;
      }
      if (moves.clock[m.target] + int64_t(m.interval) <= limit) std::abort();
      moves.direction[m.target] = m.dir ? 1 : -1;
      m.kind = MessageKind::queue_step;
      moves.take(m);
    }
    tails.clear();
    staged.clear();
    next_tails.clear();
  }
};

// The board has stopped by itself: every motor is where the plan has it, whatever was held.
void recover(Motion& motion, LoneBoard& board) {
  board.stop_alone();
  if (!motion.recover_from(board.serial)) std::abort();
  for (size_t k = 0; k < 4; ++k)
    if (motion.stream().expected_net(k) != board.moves.net[k]) std::abort();
}

// From rest to rest, and by the way a swing: with τ = t/seconds,
// P = a + (b - a)(10 τ³ - 15 τ⁴ + 6 τ⁵) + mm τ²(1 - τ)²(1 - 2 τ).
Piece swing(const double* a, const double* b, double seconds, double mm) {
  const double rest[] = {0, 0, 0, 10, -15, 6}, wave[] = {0, 0, 1, -4, 5, -2};
  Piece piece{};
  piece.seconds = seconds;
  for (int j = 0; j < kAxes; ++j) {
    double power = 1;
    for (int k = 0; k < Piece::kTerms; ++k, power *= seconds)
      piece.c[j][k] = ((k == 0 ? a[j] : 0) + (b[j] - a[j]) * rest[k] +
                       (j < 4 ? mm * (j + 1) / 4 * wave[k] : 0)) /
                      power;
    piece.end[j] = b[j];
  }
  return piece;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 1 || size > 1200) return 0;
  bool short_of_commands = data[0] & 8;
  Motion motion(machine_of(JunctionLaw(data[0] % 4), data[0] & 4, short_of_commands), true,
                nullptr);
  MoveRequest move{};
  double at[kAxes] = {}, flow = 1, owed = 0;
  motion.set_position(at, 0);
  Board board;
  LoneBoard lone;
  bool commits = data[0] & 32;
  uint32_t records[2] = {}, recoveries = 0;
  int64_t before[4];
  for (size_t i = 0; i < 4; ++i) before[i] = motion.stream().count(i);
  if (data[0] & 16) {
    std::vector<double> heights{0.1, -0.2, 0.3, 0.5, 0, -0.4, 0.2, 0.2, -0.1};
    motion.set_height_map(std::make_shared<HeightMap>(-30, -20, 25, 17, 3, 3, heights));
    std::copy_n(motion.planner().position(), kAxes, at);
    std::copy_n(at, kAxes, move.target);
  }
  if (commits) motion.use_commits(1'200'000, 60);
  MessageQueue& queue = motion.stream().messages(0);
  for (size_t i = 1; i + 12 <= size; i += 12) {
    const uint8_t* p = data + i;
    if (p[8] % 4 == 1) motion.record(0, ++records[0]);
    if (commits && p[11] % 8 == 7) {
      bool holds = p[9] & 2;
      if (holds) motion.hold_from(motion.planner().clock() * (p[7] / 255.0));
      if (holds && p[9] & 4) motion.replan_from(motion.planner().clock() * (p[6] / 255.0));
      for (size_t n = size_t(p[10]) * 4; n > 0 && !queue.empty(); --n, queue.pop())
        lone.take(queue.front());
      if (p[9] & 1) recover(motion, lone), ++recoveries;
      if (p[9] & 8 && motion.held() > 0) {
        motion.shift_from(0, kZ, p[5] / 100.0, 0, 0);
        at[kZ] = move.target[kZ] = motion.planner().position()[kZ];
      }
      if (p[9] & 16 && motion.held() > 0) motion.record(1, ++records[1]);
      if (p[9] & 32 && p[9] & 1) recover(motion, lone), ++recoveries;
      if (holds || p[9] & 1) {
        motion.flush();
        motion.wait_until(motion.planner().clock() + 1e6 + 1e5 * p[8]);  // it stands by then
        motion.release();
      }
    }
    bool travels = false;
    for (int j = 0; j < 4; ++j) {
      if (!(p[0] >> j & 1)) continue;
      int16_t raw;
      std::memcpy(&raw, p + 1 + 2 * j, 2);
      double by = raw * std::pow(10.0, -3 - int(p[9] % 7));
      double to = std::clamp(at[j] + by, j == kE ? -1e6 : -50.0, j == kE ? 1e6 : 50.0);
      travels |= j < 3 && to != at[j];
      move.target[j] = to;
    }
    if (std::equal(at, at + kAxes, move.target)) continue;
    move.kind = !travels                   ? MoveKind::extrude
                : move.target[kE] > at[kE] ? MoveKind::print
                                           : MoveKind::travel;
    if (p[11] & 64) {
      Piece piece = swing(at, move.target, std::pow(1.3, p[10] % 64 - 48), p[9] - 128.0);
      try {
        motion.add_pieces({piece});
      } catch (const std::invalid_argument&) {  // too fast or too far for a motor
        std::copy(at, at + kAxes, move.target);
        continue;
      }
      std::copy(move.target, move.target + kAxes, at);
      continue;
    }
    move.flow = flow;
    move.owed_mm = owed;
    owed = owed_after(owed, move.target[kE] - at[kE]);
    std::copy(move.target, move.target + kAxes, at);
    // Motion of hours in commits takes the fuzzer hours.
    double slowest = commits ? 5 : 0.05;
    move.feed_mm_s = p[10] ? std::pow(1.2, p[10] - 64) + slowest : kInfinity;
    move.radius_mm = p[0] & 16 ? 0.01 + p[11] : kInfinity;
    move.arc_inner = p[0] & 32;
    move.moved = p[0] & 15;
    move.line = uint32_t(i);
    motion.push(move);
    if (p[0] & 64) motion.flush();
    if (p[0] & 128) {
      double cut = motion.planner().clock() * (p[11] / 255.0);
      if (p[9] & 64) motion.hold_from(cut);
      if (p[9] & 16 && (motion.held() > 0 || !(p[9] & 64))) {
        FlowChange change(flow = 0.01 + p[10] / 64.0);
        motion.change_flow_from(cut, 0, change);
        owed = change.owed(owed);
        at[kE] = move.target[kE] = motion.planner().extruder_position(0);
      }
      if (p[9] & 64) {
        motion.release();
      } else {
        motion.planner().rules().change(
            p[9] & 32, [&](Rules& rules) { rules.speed_factor = 0.25 + p[10] / 64.0; });
        motion.replan_from(cut);
      }
    }
  }
  motion.flush();
  double filament = motion.planner().extruder_position(0) * 80;
  if (std::fabs(double(motion.stream().count(3)) - filament) > 0.5 + 1e-6) std::abort();
  for (; !queue.empty(); queue.pop())
    commits ? lone.take(queue.front()) : board.take(queue.front());
  for (const Message& m : lone.staged) {
    if (m.kind != MessageKind::pin) std::abort();
    lone.moves.take(m);  // due when the machine stands
  }
  if (commits) board = lone.moves;
  // What was said at a stop may wait there since the last recovery but one; then it comes behind
  // what was said since, at the same place, and that is not sent.
  if (recoveries > 1 && board.recorded[1] > 0) board.recorded[1] = records[1];
  if (!std::equal(records, records + 2, board.recorded)) std::abort();
  const Machine& machine = motion.machine();
  double end[3] = {0, 0, machine.raised(motion.planner().position())};
  std::copy_n(motion.planner().position(), 2, end);
  for (int i = 0; i < 3; ++i) {
    double steps = machine.geometry->inverse(i, end) * machine.steppers[size_t(i)].steps_per_unit;
    if (!(std::fabs(double(motion.stream().count(size_t(i))) - steps) <= 0.5 + 1e-6)) std::abort();
  }
  for (size_t i = 0; i < 4; ++i) {
    const StepStatistics& s = motion.stream().statistics(i);
    if (board.net[i] != s.net || board.net[i] != motion.stream().count(i) - before[i]) std::abort();
    double widest = short_of_commands ? 400.5 : 32.5;  // tolerance and half a tick
    if (!(s.error_max <= widest + 1e-5)) std::abort();
  }
  return 0;
}
