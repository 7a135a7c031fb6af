// The last bytes of a link in both directions, for the report of a halt. It has no clock and no
// lock of its own: the link that fills it has both.
#pragma once
#include <cstdint>
#include <vector>

#include "link/device.hpp"
#include "link/frame.hpp"

namespace passo::wire {

// Two rings of a fixed size: the bytes, and the start of each part. A part is the data of one pass
// of the link, sent or received. The newest parts replace the oldest.
class FrameRecord {
 public:
  struct Part {
    Ticks host = 0, clock = 0;  // of this computer and of the board (0: unknown)
    bool from_board = false;
    uint64_t begin = 0;  // index of its first byte among all bytes ever added
    size_t size = 0;
  };

  // From now on keeps at most this many bytes in at most `parts` parts; both are powers of two.
  void keep(size_t bytes, size_t parts);
  bool on() const { return !bytes_.empty(); }

  void add(bool from_board, const uint8_t* data, size_t size, Ticks host, Ticks clock);

  // Calls take(part, bytes) for each part that is complete, oldest first.
  template <class Take>
  void each(Take&& take) const {
    const uint64_t kept = parts_.size();
    Bytes copy;
    for (uint64_t i = count_ > kept ? count_ - kept : 0; i < count_; ++i) {
      const Part& part = parts_[i & (kept - 1)];
      if (added_ - part.begin > bytes_.size()) continue;
      copy.resize(part.size);
      for (size_t k = 0; k < part.size; ++k)
        copy[k] = bytes_[(part.begin + k) & (bytes_.size() - 1)];
      take(part, copy);
    }
  }

 private:
  Bytes bytes_;
  std::vector<Part> parts_;
  uint64_t added_ = 0, count_ = 0;  // number of bytes and parts ever added
};

}  // namespace passo::wire
