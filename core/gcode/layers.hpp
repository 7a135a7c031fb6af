// Which layer a program prints: by the comments of its slicer, else by the heights at which it
// extrudes.
#pragma once
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <string_view>

namespace passo {

// The comments with which slicers begin a layer. A file may have the comments of two kinds, for
// example of its slicer and for a host: then only one kind counts.
enum class LayerMark : uint8_t {
  none,          // not a mark
  number,        // ;LAYER:3
  change,        // ;LAYER_CHANGE
  changed,       // ; CHANGE_LAYER
  number_and_z,  // ; layer 3, Z = 0.6
};
inline constexpr size_t kLayerMarks = 5;

// The mark in a comment: its text after ';'.
inline LayerMark layer_mark(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  auto rest = [&](std::string_view word) {  // after the word in upper or lower case; null: the word
                                            // is missing
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

// The number of marks of each kind in a program.
class LayerMarks {
 public:
  void comment(std::string_view text) { ++times_[size_t(layer_mark(text))]; }
  // The most frequent kind; none: the program does not mark layers.
  LayerMark kind() const {
    const auto most = std::max_element(times_.begin() + 1, times_.end());
    return *most ? LayerMark(most - times_.begin()) : LayerMark::none;
  }

 private:
  std::array<uint32_t, kLayerMarks> times_{};
};

// Counts layers from 1; what comes before the first one is in layer 0.
//
// Without marks a layer begins where the program extrudes along X or Y at another height than the
// layer's, if it went there without extruding: so neither a lift between two moves nor filament
// that is primed begins one. Down, too: the next object of several begins at the bed. While all
// that was extruded is a line above the first layer, as at the edge of the bed, both are layer 1.
// Where the height changes while extruding, in a spiral, a layer begins after each rise by the
// height of the last layer.
class LayerCounter {
 public:
  // The marks of the program that is being read; none if it has none. Until they are known, the
  // first mark decides, and heights count as long as there is no mark.
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
  // A move that extrudes along X or Y, between two heights of the nozzle, mm.
  void extrude(double from, double to) {
    if (kind_ != LayerMark::none) return;
    const bool went = std::fabs(from - last_) > kSame;  // there, without extruding
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
  static constexpr double kSame = 0.015;  // mm by which heights of one layer may differ
  static constexpr double kThickest = 2;  // mm, a layer's height at most
  static constexpr double kUsual = 0.2;   // mm, of a layer whose height is not known
  LayerMark kind_ = LayerMark::none;
  bool expected_ = false;
  uint32_t count_ = 0;
  double base_ = 0, height_ = kUsual, last_ = 0;  // of the layer: where it begins; of the last move

  void begin(double base) {
    ++count_;
    base_ = base;
  }
};

}  // namespace passo
