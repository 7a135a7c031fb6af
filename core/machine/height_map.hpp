// What the bed adds to Z: heights on an even grid, bilinear in between; beyond the grid its edge
// goes on level.
#pragma once
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace passo {

class HeightMap {
 public:
  // Height number j * nx + i stands at (x + i dx, y + j dy), in mm; nx and ny are 2 at least.
  HeightMap(double x, double y, double dx, double dy, int nx, int ny, std::vector<double> heights)
      : first_{x, y}, spacing_{dx, dy}, count_{nx, ny}, heights_(std::move(heights)),
        steepest_(find_steepest()), twist_(find_twist()) {}

  // One cell: height = at_corner + by_x u + by_y v + by_both u v, u = x - corner[0], v = y -
  // corner[1].
  struct Cell {
    double corner[2], at_corner, by_x, by_y, by_both;
    double at(double x, double y) const {
      double u = x - corner[0], v = y - corner[1];
      return at_corner + by_x * u + (by_y + by_both * u) * v;
    }
    double slope_x(double y) const { return by_x + by_both * (y - corner[1]); }
    double slope_y(double x) const { return by_y + by_both * (x - corner[0]); }
  };

  double at(double x, double y) const { return cell(x, y).at(x, y); }

  Cell cell(double x, double y) const {
    int i = index(0, x), j = index(1, y);
    bool level_x = i < 0 || i > count_[0] - 2, level_y = j < 0 || j > count_[1] - 2;
    i = std::clamp(i, 0, count_[0] - 2 + int(level_x));
    j = std::clamp(j, 0, count_[1] - 2 + int(level_y));
    int right = level_x ? i : i + 1, above = level_y ? j : j + 1;
    double a = height(i, j), b = height(right, j), c = height(i, above), d = height(right, above);
    return {{line(0, i), line(1, j)},
            a,
            (b - a) / spacing_[0],
            (c - a) / spacing_[1],
            (d - b - c + a) / (spacing_[0] * spacing_[1])};
  }

  // Lines of the grid across an axis: line(axis, 0) to line(axis, lines(axis) - 1), mm.
  int lines(int axis) const { return count_[axis]; }
  double line(int axis, int i) const { return first_[axis] + spacing_[axis] * i; }
  // No direction in X and Y is steeper, in mm/mm.
  double steepest() const { return steepest_; }
  // Change of the slope in X for a mm of Y, at most: 1/mm.
  double twist() const { return twist_; }

 private:
  double first_[2], spacing_[2];  // mm, X and Y
  int count_[2];
  std::vector<double> heights_;
  double steepest_, twist_;

  double height(int i, int j) const { return heights_[size_t(j) * size_t(count_[0]) + size_t(i)]; }
  // Which stretch between lines; -1 before the first, count - 1 behind the last.
  int index(int axis, double x) const {
    double i = std::floor((x - first_[axis]) / spacing_[axis]);
    return int(std::min(std::max(i, -1.0), double(count_[axis] - 1)));
  }

  double find_twist() const;

  double find_steepest() const;
};

}  // namespace passo
