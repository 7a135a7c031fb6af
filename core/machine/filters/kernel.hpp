// The effect of all motion filters on one planned law, in the form that the laws use.
#pragma once
#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace passo {

// The position x(t) becomes the sum of weight * x(t - at).
struct Impulse {
  bool operator==(const Impulse&) const = default;
  double weight, at;  // at: s; the weights add up to 1
};

// The combined filters of one axis or extruder: a sum of delayed copies of the planned law, an
// average over a time, and pressure advance. Each filter changes the kernel that the filters before
// it have made. A kernel may need later positions; Filters::delay compensates for that.
struct Kernel {
  std::vector<Impulse> copies{{1, 0}};
  double box_s = 0;  // the position is averaged over this time; 0: not averaged
  // Pressure advance: the speed of the filament times the advance of the move is added, averaged
  // over two boxes of these widths. 0: no advance.
  double wide_s = 0, narrow_s = 0;

  // Convolves the kernel with the impulses of a shaper, without a delay at constant speed. Empty:
  // no change.
  void convolve(const std::vector<Impulse>& shaper) {
    if (shaper.empty()) return;
    double mean = 0;
    for (const Impulse& i : shaper) mean += i.weight * i.at;
    std::vector<Impulse> all;
    for (const Impulse& copy : copies)
      for (const Impulse& i : shaper)
        all.push_back({copy.weight * i.weight, copy.at + (i.at - mean)});
    copies = std::move(all);
  }

  bool shaped() const { return copies.size() > 1; }
  bool advances() const { return narrow_s > 0; }
  // How far the kernel extends to later positions, s. after_s(): to earlier ones.
  double before_s() const {
    double s = 0;
    for (const Impulse& copy : copies) s = std::max(s, half_s() - copy.at);
    return s;
  }
  double after_s() const {
    double s = 0;
    for (const Impulse& copy : copies) s = std::max(s, half_s() + copy.at);
    return s;
  }

 private:
  double half_s() const { return std::max(0.5 * box_s, 0.5 * (wide_s + narrow_s)); }
};

// The numbers of one setting of a filter, for one axis or extruder.
using Numbers = std::vector<double>;

// A setting of a filter, by its name in the machine's description and in Job.set_filter. `set`
// throws std::invalid_argument if the filter does not have the axis, or the numbers are not valid.
template <class Filter>
struct Setting {
  const char* name;
  void (*set)(Filter& filter, size_t index, const Numbers& numbers);
};

// Reads impulses from the numbers weight, s, weight, s, ...
inline std::vector<Impulse> impulses_of(const Numbers& numbers) {
  constexpr size_t kMost = 5;
  if (numbers.size() > 2 * kMost || numbers.size() % 2 != 0)
    throw std::invalid_argument("a shaper has 5 impulses at most, each a weight and a time");
  std::vector<Impulse> impulses;
  for (size_t i = 0; i < numbers.size(); i += 2) impulses.push_back({numbers[i], numbers[i + 1]});
  return impulses;
}
// Checks the number of an axis: X, Y or Z.
inline size_t axis_of(size_t index) {
  if (index > 2) throw std::invalid_argument("only X, Y and Z have this filter");
  return index;
}
// The value of one extruder. The list grows if necessary.
template <class T>
T& at_extruder(std::vector<T>& all, size_t index) {
  if (all.size() <= index) all.resize(index + 1);
  return all[index];
}
inline double only(const Numbers& numbers) {
  if (numbers.size() != 1) throw std::invalid_argument("the setting is one number");
  return numbers[0];
}

}  // namespace passo
