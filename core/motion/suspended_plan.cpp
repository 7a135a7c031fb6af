#include "motion/suspended_plan.hpp"

namespace passo {

void HeldPlan::put_first(const std::vector<Move>& rest, std::deque<Record>& of_rest,
                         uint32_t after) {
  first_due() += after;
  moves.insert(moves.begin(), rest.begin(), rest.end());
  records.insert(records.begin(), of_rest.begin(), of_rest.end());
  of_rest.clear();
}

void HeldPlan::record_first(const std::deque<Record>& first) {
  first_due() += uint32_t(first.size());
  records.insert(records.begin(), first.begin(), first.end());
}

void HeldPlan::give_back(uint32_t n, std::deque<Record>& plan) {
  plan.insert(plan.end(), records.begin(), records.begin() + n);
  records.erase(records.begin(), records.begin() + n);
}

void HeldPlan::shift(int j, double mm) {
  for (Move& m : moves) m.p0[j] += mm, m.p1[j] += mm;
}

void HeldPlan::shift_from_rest(int j, double mm) {
  const Move& first = moves.front();
  Move over{};
  static_cast<MoveOrigin&>(over) = first;
  for (int i = 0; i < kAxes; ++i) over.p0[i] = over.p1[i] = first.p0[i];
  over.p1[j] += mm;
  over.feed = over.radius = kInfinity;
  over.kind = MoveKind::travel;
  over.rules = first.rules;
  over.moved = uint8_t(1u << j);
  shift(j, mm);
  moves.insert(moves.begin(), over);
}

}  // namespace passo
