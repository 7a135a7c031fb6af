// Canned cycles: G73, G81, G82, G83 with G80, G98 and G99, as RS274 and LinuxCNC define them.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "gcode/interpreter.hpp"

namespace passo {

// Runs one line of a cycle, with or without its code. A parameter that is missing has the value of
// the last line of the same cycle. If one end of the cycle is out of range, nothing moves.
void Interpreter::run_cycle(int code, const Word* w, const Word* end) {
  static constexpr int kPlane[3][3] = {
      {0, 1, 2}, {2, 0, 1}, {1, 2, 0}};  // u, v, and the drilling axis w
  const int* plane = kPlane[plane_ - 17];
  const std::string name = code_name('G', code);
  auto letter_of = [&](int j) { return machine_->axes[size_t(j)].letter; };
  double value[26] = {}, feed = feed_, repeats = 1, spindle = 0;
  uint32_t have = 0;
  for (const Word* x = w; x < end; ++x) {
    const bool axis =
        x->letter == letter_of(kX) || x->letter == letter_of(kY) || x->letter == letter_of(kZ);
    if (!sound(*x)) return;
    if (!axis && !std::strchr("RQPLKFS", x->letter))
      return fail_word(Fault::word, std::string(1, x->letter), text_);
    have |= 1u << (x->letter - 'A');
    value[x->letter - 'A'] = x->value;
    if (x->letter == 'F') feed = x->value * unit_ / 60;
    if (x->letter == 'S') spindle = x->value;
    if (x->letter == 'L' || x->letter == 'K') repeats = x->value;
  }
  auto given = [&](char letter) { return (have >> (letter - 'A') & 1) != 0; };
  auto lacks = [&](const std::string& what) { fail(Fault::missing_word, name + " " + what, 0, 0); };
  if (!(feed > 0)) return fail(Fault::feedrate, "F", feed * 60 / unit_, 0);
  const char bottom_letter = letter_of(plane[2]);
  const bool holes =
      given(letter_of(plane[0])) || given(letter_of(plane[1])) || given(bottom_letter);
  if (!holes) {
    if (given('R') || given('Q') || given('P')) return lacks("X, Y or Z");
    feed_ = feed;
    if (given('S')) emit_power(spindle);
    return;
  }
  CycleWords words = cycle_words_;
  if (cycle_begins_ || words.code != code || words.plane != plane_) words = {code, plane_, {}, {}};
  for (char letter : {'R', 'Q', 'P', bottom_letter}) {
    const size_t k = letter == 'R' ? 0 : letter == 'Q' ? 1 : letter == 'P' ? 2 : 3;
    if (!given(letter)) continue;
    words.value[k] = value[letter - 'A'] * (k == 2 ? 1 : unit_);
    words.given[k] = true;
  }
  const bool pecks = code == 73 || code == 83;
  if (!words.given[3]) return lacks(std::string(1, bottom_letter));
  if (!words.given[0]) return lacks("R");
  if (pecks && !words.given[1]) return lacks("Q");
  if (!(feed < kInfinity)) return lacks("F");
  if (!within(given('K') ? 'K' : 'L', repeats, 0, Cycle::kMaxRepeats)) return;
  if (repeats != std::floor(repeats)) return fail(Fault::number, "L", repeats, 0);
  if (words.given[2] && !within('P', words.value[2], 0, kMaxMoveS)) return;

  Cycle::Plan plan;
  plan.code = code;
  plan.u = plane[0], plan.v = plane[1], plan.w = plane[2];
  for (int i = 0; i < 2; ++i) {
    const int j = plane[i];
    const char letter = letter_of(j);
    const double to = value[letter - 'A'] * unit_;
    plan.by[i] = given(letter) && !absolute_ ? to : 0;
    plan.at[i] = !given(letter) ? meant(j) : absolute_ ? to + origin_[j] : meant(j) + to;
  }
  const double level = meant(plan.w);
  const double initial = cycle_begins_ ? level : cycle_level_;
  plan.start = words.value[0] + (absolute_ ? origin_[plan.w] : level);
  plan.bottom = words.value[3] + (absolute_ ? origin_[plan.w] : plan.start);
  if (!(plan.start >= plan.bottom)) {
    const double least = absolute_ ? plan.bottom - origin_[plan.w] : plan.bottom - level;
    return void(within('R', words.value[0] / unit_, least / unit_, kInfinity));
  }
  plan.clear = to_level_ ? std::max(plan.start, initial) : plan.start;
  plan.peck = pecks ? words.value[1] : 0;
  const double least_peck = (plan.start - plan.bottom) * std::max(1.0, repeats) / Cycle::kMaxPecks;
  if (pecks && !(plan.peck > 0 && plan.peck >= least_peck))
    return void(within('Q', plan.peck / unit_, std::max(least_peck, 1e-3) / unit_, kInfinity));
  plan.dwell_s = code == 82 ? words.value[2] : 0;
  plan.repeats = int(repeats);

  for (int j : {plan.u, plan.v, plan.w})
    if (locked(j) && (j == plan.w || given(letter_of(j))))
      return fail(Fault::not_homed, axis_name(j), 0, 0);
  auto keep = [&](int j, double& at) {
    if (!beyond(j, at)) return true;
    const double limit = at < low_[j] ? low_[j] : high_[j];
    if (!clamp) return fail(Fault::out_of_range, axis_name(j), at, limit), false;
    note_clamp(j, at, limit);
    at = limit;
    return true;
  };
  const double last = std::max(0.0, repeats - 1);
  for (int i = 0; i < 2; ++i) {
    double far = plan.at[i] + last * plan.by[i];
    if (!keep(plane[i], plan.at[i]) || !keep(plane[i], far)) return;
    if (last > 0) plan.by[i] = (far - plan.at[i]) / last;
  }
  if (!keep(plan.w, plan.bottom) || !keep(plan.w, plan.start) || !keep(plan.w, plan.clear)) return;

  feed_ = feed;
  if (given('S')) emit_power(spindle);
  cycle_words_ = words;
  cycle_level_ = initial;
  cycle_begins_ = false;
  note_moved();
  if (plan.repeats == 0) return;  // the next lines reuse its parameters
  if (plan.w == kZ) hop_ = 0;     // the cycle moves to the program's Z, without the hop
  if (any_due_) carry_out(0b111);
  cycle_ = Cycle(plan);
  cycle_feed_ = feed;
}

bool Interpreter::next_of_cycle() {
  MoveRequest m{};
  here(m.target);
  const Cycle::Step step = cycle_.next(m.target);
  std::copy(step.target, step.target + 3, m.target);
  m.feed_mm_s = step.rapid ? kInfinity : cycle_feed_;
  m.radius_mm = kInfinity;
  m.rapid = step.rapid;
  m.moved = step.moved;
  m.hop_mm = hop_;
  m.duration_s = step.dwell_s;
  m.kind = step.dwell_s > 0 ? MoveKind::dwell : MoveKind::travel;
  stamp(m);
  return take(m);
}

}  // namespace passo
