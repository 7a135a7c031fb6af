// The path of a planned program as columns, for a viewer: a row for each move that changes the
// position.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "plan/move.hpp"

namespace passo {

// Each row is the end of a move; the move begins at the end of the row before it. At the start, and
// where a position is set, a row of kind `jump` has the new position. Rows are in the order of
// time; a layer is a range of rows.
class Toolpath {
 public:
  enum Kind : uint8_t { jump, travel, print };

  explicit Toolpath(double clock_hz) : hz_(clock_hz) {}

  void add(const Move& move);
  size_t rows() const { return at_.size() / 3; }

  // The columns, one after the other, little-endian; see docs/reference/toolpath.md.
  std::string encoded() const;
  // Position of coordinate 0, and mm of a coordinate's unit.
  struct Scale {
    double origin[3];
    double unit_mm;
  };
  Scale scale() const;

  // Where each layer begins.
  struct Layer {
    uint32_t row;
    float z_mm;
    double start_s;
    uint16_t number;
  };
  const std::vector<Layer>& layers() const { return layers_; }
  double end_s() const { return end_s_; }

 private:
  double hz_;
  double end_s_ = 0;
  double last_[3] = {};  // end of the last row
  std::vector<float> at_;
  std::vector<uint8_t> kind_, tool_, feature_, speed_limit_, accel_limit_;
  std::vector<uint16_t> speed_, flow_, accel_;
  std::vector<float> time_;
  std::vector<uint32_t> line_;
  std::vector<Layer> layers_;

  void row(const double* end, Kind kind, const Move& move);
};

}  // namespace passo
