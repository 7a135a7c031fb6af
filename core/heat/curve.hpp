// A piecewise linear function: a sensor's reading by temperature, or the temperature by reading.
#pragma once
#include <algorithm>
#include <utility>
#include <vector>

namespace passo::heat {

// Through points of ascending x; constant beyond both ends.
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
