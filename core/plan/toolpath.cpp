#include "plan/toolpath.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace passo {

namespace {

static_assert(std::endian::native == std::endian::little);

uint16_t in_units(double value, double unit) {
  return uint16_t(std::clamp(std::round(value / unit), 0.0, 65535.0));
}
uint8_t small(unsigned value) { return uint8_t(std::min(value, 255u)); }

template <typename T>
void put(std::string& out, const std::vector<T>& column) {
  out.append(reinterpret_cast<const char*>(column.data()), column.size() * sizeof(T));
}

}  // namespace

void Toolpath::add(const Move& move) {
  end_s_ = move.end() / hz_;
  if (move.kind == MoveKind::dwell || !move.cartesian) return;
  double apart = 0;
  for (int i = 0; i < 3; ++i) apart = std::max(apart, std::fabs(move.p0[i] - last_[i]));
  if (at_.empty() || apart > 1e-4) row(move.p0, jump, move);
  row(move.p1, move.kind == MoveKind::print ? print : travel, move);
}

void Toolpath::row(const double* end, Kind kind, const Move& move) {
  if (layers_.empty() || layers_.back().number != move.layer)
    layers_.push_back({uint32_t(rows()), float(end[2]), move.start / hz_, move.layer});
  if (kind == print) layers_.back().z_mm = float(end[2]);
  double length = 0;
  for (int i = 0; i < 3; ++i) {
    length += (move.p1[i] - move.p0[i]) * (move.p1[i] - move.p0[i]);
    at_.push_back(float(end[i]));
    last_[i] = end[i];
  }
  // Speeds and accelerations are of the path's measure: here of mm.
  const double seconds = move.ticks() / hz_;
  const double mm = move.d > 0 ? std::sqrt(length) / move.d : 0;
  const double filament = std::max(move.p1[kE] - move.p0[kE], 0.0);
  const bool ramps = move.t_acc + move.t_dec > 0;
  kind_.push_back(kind);
  tool_.push_back(small(move.tool));
  feature_.push_back(small(move.feature));
  speed_limit_.push_back(small(move.speed_limit));
  accel_limit_.push_back(small(move.accel_limit));
  speed_.push_back(in_units(move.vc * mm, 0.02));
  flow_.push_back(in_units(seconds > 0 ? filament / seconds : 0, 0.001));
  accel_.push_back(in_units(ramps ? std::max(move.a, move.b) * mm : 0, 1));
  time_.push_back(float(kind == jump ? move.start / hz_ : move.end() / hz_));
  line_.push_back(move.main_line);
}

Toolpath::Scale Toolpath::scale() const {
  Scale s{{0, 0, 0}, 1.0 / 256};
  double longest = 0;
  for (int i = 0; i < 3 && !at_.empty(); ++i) {
    float low = at_[size_t(i)], high = low;
    for (size_t k = size_t(i); k < at_.size(); k += 3) {
      low = std::min(low, at_[k]);
      high = std::max(high, at_[k]);
    }
    s.origin[i] = low;
    longest = std::max(longest, double(high) - low);
  }
  if (longest > 0) s.unit_mm = longest / 65535;
  return s;
}

std::string Toolpath::encoded() const {
  const Scale s = scale();
  std::vector<uint16_t> points(rows() * 4);
  for (size_t i = 0; i < rows(); ++i) {
    for (size_t j = 0; j < 3; ++j)
      points[i * 4 + j] = in_units(at_[i * 3 + j] - s.origin[j], s.unit_mm);
    points[i * 4 + 3] = uint16_t(kind_[i] | tool_[i] << 8);
  }
  std::string out;
  out.reserve(rows() * 25);
  put(out, points);
  put(out, time_);
  put(out, line_);
  put(out, speed_);
  put(out, flow_);
  put(out, accel_);
  put(out, feature_);
  put(out, speed_limit_);
  put(out, accel_limit_);
  return out;
}

}  // namespace passo
