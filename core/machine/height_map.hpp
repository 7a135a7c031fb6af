// Bed correction: heights on a regular grid, with bilinear interpolation. Outside of the grid the
// height of its edge continues. With a fade, the correction decreases as Z rises.
#pragma once
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "base/types.hpp"

namespace passo {

// Up to Z `start` the correction is the height c. From `start` to `end` it changes linearly to
// `target`, mm, which is the same at each X and Y: target + factor (c - target).
struct Fade {
  double start = kInfinity, end = kInfinity, target = 0;

  // The factor at z is whole + by_z z, in one of three ranges: up to `start`, from there to `end`,
  // above `end`.
  struct Factor {
    double whole = 1, by_z = 0;
    double at(double z) const { return whole + by_z * z; }
  };
  Factor around(double z) const {
    if (!(z > start)) return {1, 0};
    if (z >= end) return {0, 0};
    return {end / (end - start), -1 / (end - start)};
  }
};

class HeightMap {
 public:
  // Height number j * nx + i is at (x + i dx, y + j dy), in mm. nx and ny are at least 2. A fade
  // must be longer than the largest difference of a height from its target. Then the nozzle rises
  // whenever Z rises.
  HeightMap(double x, double y, double dx, double dy, int nx, int ny, std::vector<double> heights,
            const Fade& fade = {})
      : first_{x, y}, spacing_{dx, dy}, count_{nx, ny}, heights_(std::move(heights)), fade_(fade),
        steepest_(find_steepest()), twist_(find_twist()), range_(find_range()) {}

  // The same heights, with the grid offset by dx, dy.
  HeightMap moved(double dx, double dy) const {
    HeightMap map = *this;
    map.first_[0] += dx;
    map.first_[1] += dy;
    return map;
  }

  // One cell of the grid: height = at_corner + by_x u + by_y v + by_both u v, where u = x -
  // corner[0] and v = y - corner[1].
  struct Cell {
    double corner[2], at_corner, by_x, by_y, by_both;
    double at(double x, double y) const {
      double u = x - corner[0], v = y - corner[1];
      return at_corner + by_x * u + (by_y + by_both * u) * v;
    }
    double slope_x(double y) const { return by_x + by_both * (y - corner[1]); }
    double slope_y(double x) const { return by_y + by_both * (x - corner[0]); }
  };

  // The correction of Z within one cell and one range of the fade.
  struct Lift {
    Cell cell;
    double target;
    Fade::Factor factor;
    double at(double x, double y, double z) const {
      return target + factor.at(z) * (cell.at(x, y) - target);
    }
    double slope_x(double y, double z) const { return factor.at(z) * cell.slope_x(y); }
    double slope_y(double x, double z) const { return factor.at(z) * cell.slope_y(x); }
    double slope_z(double x, double y) const { return factor.by_z * (cell.at(x, y) - target); }
  };

  Lift lift(double x, double y, double z) const {
    return {cell(x, y), fade_.target, fade_.around(z)};
  }
  // The correction of Z at a position of the plan.
  double at(double x, double y, double z) const { return lift(x, y, z).at(x, y, z); }
  // The planned Z for which Z plus the correction is `height`.
  double plan_z(double x, double y, double height) const;

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

  // Grid lines across an axis, in mm: line(axis, 0) to line(axis, lines(axis) - 1).
  int lines(int axis) const { return count_[axis]; }
  double line(int axis, int i) const { return first_[axis] + spacing_[axis] * i; }
  // Maximum slope in any direction, mm/mm.
  double steepest() const { return steepest_; }
  // Maximum change of the slope in X per mm of Y, 1/mm.
  double twist() const { return twist_; }
  // Maximum difference of a height from the fade's target, mm.
  double range() const { return range_; }
  const Fade& fade() const { return fade_; }

  // Number of the grid line before x; -1 before the first line.
  int index(int axis, double x) const {
    double i = std::floor((x - first_[axis]) / spacing_[axis]);
    return int(std::min(std::max(i, -1.0), double(count_[axis] - 1)));
  }

 private:
  double first_[2], spacing_[2];  // mm, X and Y
  int count_[2];
  std::vector<double> heights_;
  Fade fade_;
  double steepest_, twist_, range_;

  double height(int i, int j) const { return heights_[size_t(j) * size_t(count_[0]) + size_t(i)]; }

  double find_twist() const;
  double find_steepest() const;
  double find_range() const;
};

}  // namespace passo
