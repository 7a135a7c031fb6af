// G2 and G3.
#include <algorithm>
#include <cmath>

#include "gcode/interpreter.hpp"

namespace passo {

void Interpreter::run_arc(bool clockwise, const double* value, uint32_t have, int turns) {
  double radius = (have >> ('R' - 'A') & 1) ? value['R' - 'A'] * unit_ : 0;
  static constexpr int kPlane[3][2] = {{0, 1}, {2, 0}, {1, 2}};  // G17 XY, G18 ZX, G19 YZ
  static constexpr char kCentre[3][2] = {{'I', 'J'}, {'K', 'I'}, {'J', 'K'}};
  static constexpr const char* kWords[3] = {"I, J and R", "K, I and R", "J, K and R"};
  int u = kPlane[plane_ - 17][0], v = kPlane[plane_ - 17][1];
  uint32_t axes = 0;
  for (int k = 0; k < 26; ++k)
    if ((have >> k & 1) && letter_slot_[k] >= 0) axes |= 1u << k;
  double feed = move_.feed_mm_s, e_before = logical_e_, start[kAxes];
  arc_hop_ = hop_;
  uint8_t cut = cut_;
  if (const int j = tool_position(start); j >= 0) {
    const double limit = meant(j) < low_[j] ? low_[j] : high_[j];
    if (!clamp) return fail(Fault::out_of_range, axis_name(j), meant(j), limit);
    note_clamp(j, meant(j), limit);
    cut |= uint8_t(1u << j);
  }
  const double due[3] = {due_[kX], due_[kY], due_[kZ]};
  const uint8_t cut_before = cut_;
  if (!target(value, axes, relative(), offset_letters(axes, true))) return;
  cut |= cut_;
  const bool whole = (cut & (1u << u | 1u << v)) == 0;  // neither end was moved to a limit
  double end[kAxes];
  std::copy(move_.target, move_.target + kAxes, end);
  auto none = [&](Fault fault, const std::string& word, double value, double limit) {
    arc_ = Arc();
    logical_e_ = e_before;
    hop_ = arc_hop_;
    cut_ = cut_before;
    owe(due);
    fail(fault, word, value, limit);
  };
  auto straight = [&] {
    queue_offset(start, feed);
    queue_straight(feed, 0, false);
  };
  auto given = [&](char letter) { return (have >> (letter - 'A') & 1) != 0; };
  double du = end[u] - start[u], dv = end[v] - start[v], d2 = du * du + dv * dv, cu, cv;
  if (radius != 0) {
    double h2 = radius * radius - d2 / 4;
    const bool apart = h2 < -1e-3 * radius * radius;
    if (d2 == 0 ? !whole : apart && Arc::tiny(std::sqrt(d2))) return straight();
    if (whole && (d2 == 0 || apart)) return none(Fault::arc, "R", radius, std::sqrt(d2) / 2);
    double h = std::sqrt(std::max(0.0, h2) / d2) * ((clockwise == (radius > 0)) ? 1 : -1);
    cu = start[u] + du / 2 + dv * h;
    cv = start[v] + dv / 2 - du * h;
  } else {
    auto centre = [&](char letter) { return given(letter) ? value[letter - 'A'] * unit_ : 0.0; };
    double i = centre(kCentre[plane_ - 17][0]), j = centre(kCentre[plane_ - 17][1]);
    if (i == 0 &&
        j ==
            0) {  // without a centre: a straight line if the ends are close together, else an error
      const bool circle = given('R') ? d2 > 0 : given('I') || given('J') || given('K');
      if (circle && Arc::tiny(std::sqrt(d2))) return straight();
      return none(Fault::centre, kWords[plane_ - 17], 0, 0);
    }
    cu = start[u] + i;
    cv = start[v] + j;
  }
  if (!arc_.begin(start, end, u, v, cu, cv, clockwise, turns))
    return none(Fault::range, "P", turns + 1.0, arc_.most_turns());
  if (2 * arc_.radius() <= Arc::kChordError) {  // shorter than the error of a chord
    arc_ = Arc();
    return straight();
  }
  if (whole && !arc_.round()) return none(Fault::radii, "", arc_.start_radius(), arc_.end_radius());
  GcodeError out;
  if (!clamp && !anywhere() && !arc_in_range(start, u, v, out))
    return none(out.fault, out.word, out.value, out.limit);
  ++arcs_;
  arc_move_ = move_;
  arc_move_.feed_mm_s = feed;
  arc_move_.duration_s = 0;
  arc_move_.rapid = false;
  arc_move_.radius_mm = arc_.radius();
  arc_move_.arc_axis = arc_.axis();
  stamp(arc_move_);
  queue_offset(start, feed);
}

// Whether all chords of the arc from `start` end within the limits of slots u and v. target() has
// checked only the end of the arc. If not, sets `error` to the position that is furthest outside.
bool Interpreter::arc_in_range(const double* start, int u, int v, GcodeError& error) const {
  auto hop = [this](int j) { return j == kZ ? arc_hop_ : 0; };
  auto round = [&](int j) {
    return arc_.lowest(j) - hop(j) >= low_[j] && arc_.highest(j) - hop(j) <= high_[j];
  };
  if (round(u) && round(v)) return true;
  int out = -1;
  double from[3] = {start[kX], start[kY], start[kZ]}, to[kAxes];
  for (Arc rest = arc_; rest.active(); std::copy(to, to + 3, from)) {
    rest.next(to);
    for (int j : {u, v}) {
      const double at = to[j] - hop(j);
      if (hop(j) > 0) to[j] = std::min(to[j], high_[j]);
      if (!beyond(j, at, from[j]) || (out >= 0 && out != j)) continue;
      const double limit = at < low_[j] ? low_[j] : high_[j];
      if (out == j && std::fabs(at - limit) <= std::fabs(error.value - error.limit)) continue;
      out = j;
      error.fault = Fault::out_of_range;
      error.word = axis_name(j);
      error.value = at;
      error.limit = limit;
    }
  }
  return out < 0;
}

bool Interpreter::next_chord() {
  arc_.next(arc_move_.target);
  for (int j = 0; j < 3; ++j) {
    const double hop = j == kZ ? arc_hop_ : 0, at = arc_move_.target[j] - hop;
    if (!anywhere() && beyond(j, at)) {
      const double limit = at < low_[j] ? low_[j] : high_[j];
      if (!clamp) {
        fail(Fault::out_of_range, machine_->axes[size_t(j)].name, at, limit);
        take_back(arc_move_.target[kE] - position_[kE] + arc_.left(kE));
        arc_ = Arc();
        return false;
      }
      note_clamp(j, at, limit);
      arc_move_.target[j] = limit + hop;
    }
    if (hop > 0)
      arc_move_.target[j] =
          std::min(arc_move_.target[j], high_[j]);  // the hop is shortened at the limit
  }
  arc_move_.arc_inner = !arc_.first();
  return take(arc_move_);
}

void Interpreter::take_chord(Arc& rest, double* target) const {
  rest.next(target);
  if (arc_hop_ > 0)
    target[kZ] = std::min(target[kZ], high_[kZ]);  // the hop is shortened at the limit
}

}  // namespace passo
