#include "link/frame_record.hpp"

#include <algorithm>
#include <cstring>

namespace passo::wire {

void FrameRecord::keep(size_t bytes, size_t parts) {
  bytes_.assign(bytes, 0);
  parts_.assign(parts, {});
  added_ = count_ = 0;
}

void FrameRecord::add(bool from_board, const uint8_t* data, size_t size, Ticks host, Ticks clock) {
  if (size > bytes_.size()) return;
  parts_[count_++ & (parts_.size() - 1)] = {host, clock, from_board, added_, size};
  const size_t at = added_ & (bytes_.size() - 1), first = std::min(size, bytes_.size() - at);
  std::memcpy(bytes_.data() + at, data, first);
  std::memcpy(bytes_.data(), data + first, size - first);
  added_ += size;
}

}  // namespace passo::wire
