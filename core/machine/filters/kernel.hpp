// What motion filters make of one planned law, in the terms in which laws are solved.
#pragma once
#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <vector>

namespace passo {

// The position x(t) becomes the sum of weight * x(t - at).
struct Impulse {
  bool operator==(const Impulse&) const = default;
  double weight, at;  // s; the weights add up to 1
};

// All filters of one axis, or of an extruder, together: a sum of delayed copies of the planned law,
// its mean over a time, and what the filament leads. Each filter changes the kernel that those
// before it have made. A kernel may also reach into the future: Filters::delay makes up for it.
struct Kernel {
  std::vector<Impulse> copies{{1, 0}};
  double box_s = 0;  // the mean over this time; 0: no mean
  // The speed of the filament times the advance of the move is added, smoothed by boxes of these
  // widths; 0: it has no advance.
  double wide_s = 0, narrow_s = 0;

  // Convolves it with the impulses of a shaper. A constant speed stays in place. None: no change.
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
  // Seconds by which it reaches into the future, and into the past.
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

// A setting of a filter: its name in the machine's description and for Job.set_filter. `set` throws
// std::invalid_argument if the filter has no such axis, or the numbers have no meaning.
template <class Filter>
struct Setting {
  const char* name;
  void (*set)(Filter& filter, size_t index, const Numbers& numbers);
};

// The impulses of the numbers weight, s, weight, s, ...
inline std::vector<Impulse> impulses_of(const Numbers& numbers) {
  constexpr size_t kMost = 5;
  if (numbers.size() > 2 * kMost || numbers.size() % 2 != 0)
    throw std::invalid_argument("a shaper has 5 impulses at most, each a weight and a time");
  std::vector<Impulse> impulses;
  for (size_t i = 0; i < numbers.size(); i += 2) impulses.push_back({numbers[i], numbers[i + 1]});
  return impulses;
}
// One of X, Y and Z.
inline size_t axis_of(size_t index) {
  if (index > 2) throw std::invalid_argument("only X, Y and Z have this filter");
  return index;
}
// The value of one extruder, among so many as are known.
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
