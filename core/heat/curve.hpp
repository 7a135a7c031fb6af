// A piecewise linear function: the reading of a sensor for a temperature, or the reverse.
#pragma once
#include <algorithm>
#include <utility>
#include <vector>

namespace passo::heat {

// The points have ascending x. Outside of them the function is constant.
class Curve {
 public:
  Curve() = default;
  explicit Curve(std::vector<std::pair<double, double>> points) : points_(std::move(points)) {}
  double at(double x) const {
    if (points_.empty()) return 0;
    auto next = std::upper_bound(points_.begin(), points_.end(), x,
                                 [](double v, const auto& point) { return v < point.first; });
    if (next == points_.begin()) return points_.front().second;
    if (next == points_.end()) return points_.back().second;
    const auto &a = *(next - 1), &b = *next;
    return a.second + (b.second - a.second) * ((x - a.first) / (b.first - a.first));
  }

 private:
  std::vector<std::pair<double, double>> points_;
};

}  // namespace passo::heat
