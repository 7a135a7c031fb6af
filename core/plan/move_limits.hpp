// The limits and the feedrate override that moves were made with.
#pragma once
#include <cstdint>
#include <deque>
#include <memory>

#include "machine/constraints.hpp"
#include "machine/machine.hpp"

namespace passo {

struct Rules {
  Limits limits;
  std::shared_ptr<const Constraints> constraints;
  double speed_factor;  // M220
};

// Each move keeps the number of the rules at its arrival, so replanning never applies a later M204
// to an earlier move.
class RuleBook {
 public:
  explicit RuleBook(const Machine& machine)
      : rules_{{machine.limits, std::make_shared<const Constraints>(machine), 1}} {}

  const Rules& now() const { return rules_.back(); }
  const Rules& of(uint32_t number) const { return rules_[number - first_]; }
  // Number of the current rules, for a move.
  uint32_t use() {
    used_ = true;
    return first_ + uint32_t(rules_.size() - 1);
  }
  // Changes the rules of later moves; `live`: of all moves, when they are planned again.
  template <typename Change>
  void change(bool live, Change&& change) {
    if (live) {
      for (Rules& rules : rules_) change(rules);
      return;
    }
    if (used_) rules_.push_back(rules_.back());
    used_ = false;
    change(rules_.back());
  }
  // For moves that were held while others arrived: keeps the numbers ascending along the plan.
  template <typename Moves>
  void renumber(Moves& moves) {
    const Rules now = rules_.back();
    uint32_t before = 0, number = 0;
    for (auto& m : moves) {
      if (&m == &moves.front() || m.rules != before) {
        before = m.rules;
        rules_.push_back(Rules(of(before)));
        number = first_ + uint32_t(rules_.size() - 1);
      }
      m.rules = number;
    }
    rules_.push_back(now);
    used_ = false;
  }
  // Drops rules with lower numbers: no move has them.
  void forget_before(uint32_t number) {
    for (; first_ < number && rules_.size() > 1; ++first_) rules_.pop_front();
  }

 private:
  std::deque<Rules> rules_;
  uint32_t first_ = 0;  // number of the first element of rules_
  bool used_ = false;   // a move uses the last rules, so they cannot change
};

}  // namespace passo
