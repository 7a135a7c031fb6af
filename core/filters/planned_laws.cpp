#include "filters/planned_laws.hpp"

#include <algorithm>
#include <utility>

namespace passo {

void PlannedLaws::clear(const Filters& filters) {
  filters_ = &filters;
  extruder_ = -1;
  parted_ = false;
  parts_.clear();
  all_.clear();
}

void PlannedLaws::follow_axis(int slot, double scale) {
  parts_.push_back({slot, filters_->kernel(slot), scale});
  all_.emplace_back();
}

void PlannedLaws::follow_extruder(int extruder, double scale) {
  const size_t i = size_t(extruder);
  extruder_ = extruder;
  Kernel x = filters_->kernel(kX, extruder), y = filters_->kernel(kY, extruder);
  const bool in_step = filters_->in_step(i);
  parted_ = in_step && x.copies != y.copies;
  if (parted_)
    parts_ = {{kE, x, scale}, {kE, y, scale}, {kE, filters_->kernel(kE, extruder), scale}};
  else
    parts_ = {{kE, in_step ? x : filters_->kernel(kE, extruder), scale}};
  const bool advances = filters_->advances(i);
  const auto& knees = filters_->advance.knees;
  std::vector<Phases::Bend> bends;
  if (advances && i < knees.size()) bends = Phases::bends(knees[i], scale, hz_);
  for (size_t k = 0; k < parts_.size(); ++k) all_.emplace_back(advances, bends);
}

void PlannedLaws::begin(const Move& m) {
  const double span = filters_->memory(hz_);
  for (size_t i = 0; i < all_.size(); ++i) {
    const bool whole = !parted_ || i == 2;
    all_[i].begin(whole ? m.p0[parts_[i].slot] * parts_[i].scale : 0, span);
  }
}

void PlannedLaws::add(const Move& m, double until) {
  const bool idle = idles(m);
  if (parted_ && !idle) return add_parts(m, until);
  for (size_t i = 0; i < all_.size(); ++i) {
    Phases& p = all_[i];
    const double at = p.at_end();
    const double from = idle ? at : m.p0[parts_[i].slot] * parts_[i].scale;
    const double to = idle ? at : m.p1[parts_[i].slot] * parts_[i].scale;
    p.add(m, from, to, hz_, idle ? 0 : m.advance * hz_, until);
  }
}

void PlannedLaws::add_parts(const Move& m, double until) {
  const double scale = parts_[0].scale;
  double square[3], sum = 0;
  for (size_t j = 0; j < 3; ++j) {
    square[j] = (m.p1[j] - m.p0[j]) * (m.p1[j] - m.p0[j]);
    sum += square[j];
  }
  const double steps = (m.p1[kE] - m.p0[kE]) * scale;
  double of_others = 0, left = 1;
  for (size_t i = 0; i < 2; ++i) {
    const double share = sum > 0 ? square[i] / sum : 0;
    const double from = all_[i].at_end(), to = from + steps * share;
    all_[i].add(m, from, to, hz_, share > 0 ? m.advance * hz_ : 0, until, share);
    of_others += to;
    left -= share;
  }
  // The sum of the parts ends where the plan ends. A rest from rounding waits for a move outside of
  // the XY plane.
  const bool moves = sum == 0 || square[kZ] > 0;
  const double from = all_[2].at_end(), to = moves ? m.p1[kE] * scale - of_others : from;
  all_[2].add(m, from, to, hz_, moves ? m.advance * hz_ : 0, until, moves ? left : 0);
}

}  // namespace passo
