#include "machine/height_map.hpp"

namespace passo {

double HeightMap::find_twist() const {
  double most = 0;
  for (int j = 0; j + 1 < count_[1]; ++j)
    for (int i = 0; i + 1 < count_[0]; ++i) {
      double both = height(i + 1, j + 1) - height(i + 1, j) - height(i, j + 1) + height(i, j);
      most = std::max(most, std::fabs(both) / (spacing_[0] * spacing_[1]));
    }
  return most;
}

double HeightMap::find_range() const {
  double most = 0;
  for (double c : heights_) most = std::max(most, std::fabs(c - fade_.target));
  return most;
}

double HeightMap::plan_z(double x, double y, double height) const {
  double c = cell(x, y).at(x, y);
  if (!(height - c > fade_.start)) return height - c;
  if (height - fade_.target >= fade_.end) return height - fade_.target;
  double by_z = (c - fade_.target) / (fade_.end - fade_.start);
  return (height - fade_.target - fade_.end * by_z) / (1 - by_z);
}

double HeightMap::find_steepest() const {
  double most = 0;
  for (int j = 0; j < count_[1]; ++j)
    for (int i = 0; i < count_[0]; ++i) {
      // The gradient of a cell has its maximum at one of the corners.
      double left = i > 0 ? height(i, j) - height(i - 1, j) : 0;
      double right = i + 1 < count_[0] ? height(i + 1, j) - height(i, j) : 0;
      double below = j > 0 ? height(i, j) - height(i, j - 1) : 0;
      double above = j + 1 < count_[1] ? height(i, j + 1) - height(i, j) : 0;
      double x = std::max(std::fabs(left), std::fabs(right)) / spacing_[0];
      double y = std::max(std::fabs(below), std::fabs(above)) / spacing_[1];
      most = std::max(most, x * x + y * y);
    }
  return std::sqrt(most);
}

}  // namespace passo
