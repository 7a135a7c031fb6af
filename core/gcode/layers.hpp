// Counts the layers of a program: by comments of its slicer, else by the heights at which it
// extrudes.
#pragma once
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <string_view>

namespace passo {

// Comments with which slicers mark a layer. A file may contain two kinds, for example one of its
// slicer and one for a host. Then only one kind counts.
enum class LayerMark : uint8_t {
  none,          // no layer mark
  number,        // ;LAYER:3
  change,        // ;LAYER_CHANGE
  changed,       // ; CHANGE_LAYER
  number_and_z,  // ; layer 3, Z = 0.6
};
inline constexpr size_t kLayerMarks = 5;

// The mark in a comment; `text` is what follows the ';'.
inline LayerMark layer_mark(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  auto rest = [&](std::string_view word) {  // the text after `word`, upper and lower case alike;
                                            // null if `text` does not begin with it is missing
    if (text.size() < word.size()) return static_cast<const char*>(nullptr);
    for (size_t i = 0; i < word.size(); ++i)
      if (std::toupper(uint8_t(text[i])) != word[i]) return static_cast<const char*>(nullptr);
    return text.data() + word.size();
  };
  auto number = [&](const char* p) {
    const char* end = text.data() + text.size();
    if (p < end && *p == ' ') ++p;
    if (p < end && *p == '-') ++p;
    return p < end && std::isdigit(uint8_t(*p));
  };
  if (const char* p = rest("LAYER:")) return number(p) ? LayerMark::number : LayerMark::none;
  if (rest("LAYER_CHANGE")) return LayerMark::change;
  if (rest("CHANGE_LAYER")) return LayerMark::changed;
  if (const char* p = rest("LAYER ")) return number(p) ? LayerMark::number_and_z : LayerMark::none;
  return LayerMark::none;
}

// Counts the marks of each kind in a program.
class LayerMarks {
 public:
  void comment(std::string_view text) { ++times_[size_t(layer_mark(text))]; }
  // The most frequent kind; none if the program marks no layers.
  LayerMark kind() const {
    const auto most = std::max_element(times_.begin() + 1, times_.end());
    return *most ? LayerMark(most - times_.begin()) : LayerMark::none;
  }

 private:
  std::array<uint32_t, kLayerMarks> times_{};
};

// Counts layers from 1. Layer 0 is everything before the first layer.  Without marks, a layer
// starts when the program extrudes along X or Y at a new height that it has reached without
// extruding. So neither a hop between two moves nor priming starts a layer. A lower height starts
// one too: the next of several objects starts at the bed. If the first extrusion is a line above
// the first layer, as at the edge of the bed, both are layer 1. If the height rises during
// extrusion, as in a spiral, a layer starts after each rise by the height of the last layer.
class LayerCounter {
 public:
  // The kind of marks in the program; none if it has none. Before expect(), the kind of the first
  // mark counts, and heights count until the first mark.
  void expect(LayerMark kind) {
    kind_ = kind;
    expected_ = true;
  }
  void comment(std::string_view text) {
    const LayerMark mark = layer_mark(text);
    if (mark == LayerMark::none) return;
    if (!expected_ && kind_ == LayerMark::none) {
      kind_ = mark;
      count_ = 0;
    }
    if (mark == kind_) ++count_;
  }
  // A move extrudes along X or Y between two nozzle heights, mm.
  void extrude(double from, double to) {
    if (kind_ != LayerMark::none) return;
    const bool went = std::fabs(from - last_) > kSame;  // reached without extruding
    const double rise = to - base_;
    last_ = to;
    if (count_ == 0) {
      if (to > kSame && to <= kThickest) height_ = to;
      return begin(to);
    }
    if (std::fabs(rise) < (went ? kSame : height_ - kSame)) return;
    if (!went)
      return begin(std::fabs(rise) < 2 * height_ ? base_ + std::copysign(height_, rise) : to);
    if (count_ == 1 && rise < 0) {
      base_ = to;
      return;
    }
    if (std::fabs(rise) <= kThickest) height_ = std::fabs(rise);
    begin(to);
  }
  uint32_t count() const { return count_; }

 private:
  static constexpr double kSame = 0.015;  // maximum difference of heights within a layer, mm
  static constexpr double kThickest = 2;  // maximum height of a layer, mm
  static constexpr double kUsual = 0.2;   // height of a layer until one is measured, mm
  LayerMark kind_ = LayerMark::none;
  bool expected_ = false;
  uint32_t count_ = 0;
  double base_ = 0, height_ = kUsual,
         last_ = 0;  // start and height of the layer; height of the last move

  void begin(double base) {
    ++count_;
    base_ = base;
  }
};

}  // namespace passo
