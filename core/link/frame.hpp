// Frames of the wire protocol: length (5…64, of the whole frame), 0x10 | sequence, payload (0…59),
// CRC-16/MCRF4XX high byte first, 0x7e. Integers in a payload are variable length quantities.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <vector>

#include "base/simd.hpp"

namespace passo::wire {

using Bytes = std::vector<uint8_t>;

inline constexpr size_t kFrameMin = 5, kFrameMax = 64, kPayloadMax = 59;
inline constexpr size_t kHeader = 2, kTrailer = 3;
inline constexpr uint8_t kSync = 0x7e, kSequenceMark = 0x10, kSequenceMask = 0x0f;

// CRC-16/MCRF4XX: polynomial 0x1021 reflected, initial value 0xffff, no final inversion. Table k
// advances a byte by k further zero bytes, so that eight bytes take one round of look-ups.
class Crc16 {
 public:
  static uint16_t of(const uint8_t* p, size_t n) {
    const auto& t = tables();
    uint32_t crc = 0xffff;
    for (; n >= 8; n -= 8, p += 8) {
      crc = t[7][p[0] ^ (crc & 0xff)] ^ t[6][p[1] ^ (crc >> 8)] ^ t[5][p[2]] ^ t[4][p[3]] ^
            t[3][p[4]] ^ t[2][p[5]] ^ t[1][p[6]] ^ t[0][p[7]];
    }
    for (; n > 0; --n, ++p) crc = (crc >> 8) ^ t[0][(crc ^ *p) & 0xff];
    return uint16_t(crc);
  }

 private:
  using Tables = std::array<std::array<uint16_t, 256>, 8>;
  static constexpr Tables make() {
    Tables t{};
    for (uint32_t i = 0; i < 256; ++i) {
      uint32_t crc = i;
      for (int bit = 0; bit < 8; ++bit) crc = crc & 1 ? (crc >> 1) ^ 0x8408 : crc >> 1;
      t[0][i] = uint16_t(crc);
    }
    for (size_t k = 1; k < 8; ++k)
      for (size_t i = 0; i < 256; ++i)
        t[k][i] = uint16_t((t[k - 1][i] >> 8) ^ t[0][t[k - 1][i] & 0xff]);
    return t;
  }
  static const Tables& tables() {
    static constexpr Tables kTables = make();
    return kTables;
  }
};

// A variable length quantity is 1…5 groups of 7 bits, the first most significant; it holds a 32-bit
// value modulo 2^32, short for small values of either sign.
inline constexpr size_t kVlqMax = 5;
inline uint8_t* put_vlq(uint8_t* p, uint32_t value) {
  int32_t v = int32_t(value);
  if (v < -67108864 || v >= 201326592) *p++ = uint8_t(0x80 | ((v >> 28) & 0x7f));
  if (v < -524288 || v >= 1572864) *p++ = uint8_t(0x80 | ((v >> 21) & 0x7f));
  if (v < -4096 || v >= 12288) *p++ = uint8_t(0x80 | ((v >> 14) & 0x7f));
  if (v < -32 || v >= 96) *p++ = uint8_t(0x80 | ((v >> 7) & 0x7f));
  *p++ = uint8_t(v & 0x7f);
  return p;
}

// The same without branches, for values of unpredictable length. Writes kVlqRoom bytes.
inline constexpr size_t kVlqRoom = 8;
PASSO_INLINE uint8_t* put_vlq_any(uint8_t* p, uint32_t value) {
  const unsigned more = unsigned(value + 32 >= 1u << 7) + unsigned(value + 4096 >= 1u << 14) +
                        unsigned(value + 524288 >= 1u << 21) +
                        unsigned(value + 67108864 >= 1u << 28);
  uint64_t v = uint64_t(int64_t(int32_t(value)));
  uint64_t groups = (v >> 28 & 0x7f) | (v >> 21 & 0x7f) << 8 | (v >> 14 & 0x7f) << 16 |
                    (v >> 7 & 0x7f) << 24 | (v & 0x7f) << 32 | 0x80808080;
  groups >>= 8 * (4 - more);
  if constexpr (std::endian::native == std::endian::little)
    std::memcpy(p, &groups, sizeof groups);
  else
    for (size_t i = 0; i <= more; ++i) p[i] = uint8_t(groups >> 8 * i);
  return p + 1 + more;
}

// Reads the values of one payload. `ok` becomes false, and stays false, if the payload is too
// short.
struct Reader {
  const uint8_t *p, *end;
  bool ok = true;

  bool more() const { return ok && p < end; }
  uint32_t vlq() {
    if (p >= end) return fail();
    uint32_t c = *p++, v = c & 0x7f;
    if ((c & 0x60) == 0x60) v |= ~uint32_t(0x1f);
    for (size_t used = 1; c & 0x80; ++used) {
      if (p >= end || used == kVlqMax) return fail();
      c = *p++;
      v = (v << 7) | (c & 0x7f);
    }
    return v;
  }
  // A length byte and that many bytes.
  const uint8_t* blob(size_t& size) {
    size = 0;
    if (p >= end || size_t(end - p) < size_t(*p) + 1) {
      fail();
      return p;
    }
    size = *p++;
    const uint8_t* at = p;
    p += size;
    return at;
  }

 private:
  uint32_t fail() {
    ok = false;
    p = end;
    return 0;
  }
};

// Completes the frame whose payload of `payload` bytes starts at frame + 2; returns its length.
inline size_t seal_frame(uint8_t* frame, size_t payload, uint64_t sequence) {
  size_t length = kHeader + payload + kTrailer;
  frame[0] = uint8_t(length);
  frame[1] = uint8_t(kSequenceMark | (sequence & kSequenceMask));
  uint16_t crc = Crc16::of(frame, kHeader + payload);
  frame[length - 3] = uint8_t(crc >> 8);
  frame[length - 2] = uint8_t(crc & 0xff);
  frame[length - 1] = kSync;
  return length;
}
inline void append_frame(Bytes& out, const uint8_t* payload, size_t size, uint64_t sequence) {
  uint8_t frame[kFrameMax];
  if (size > 0) std::memcpy(frame + kHeader, payload, size);
  size_t length = seal_frame(frame, size, sequence);
  out.insert(out.end(), frame, frame + length);
}

// Finds frames in a stream of bytes that is cut anywhere. Skips bytes that are not a frame, up to
// the next 0x7e.
class Scanner {
 public:
  // Calls frame(sequence, payload, size) for each valid frame, and bad() once for each run of bytes
  // that is not a frame.
  template <class Frame, class Bad>
  void feed(const uint8_t* data, size_t n, Frame&& frame, Bad&& bad) {
    if (rest_.empty()) {
      size_t used = scan(data, n, frame, bad);
      rest_.assign(data + used, data + n);
    } else {
      rest_.insert(rest_.end(), data, data + n);
      size_t used = scan(rest_.data(), rest_.size(), frame, bad);
      rest_.erase(rest_.begin(), rest_.begin() + long(used));
    }
  }
  void reset() {
    rest_.clear();
    synchronous_ = true;
  }

 private:
  Bytes rest_;  // shorter than a frame
  bool synchronous_ = true;

  template <class Frame, class Bad>
  size_t scan(const uint8_t* data, size_t n, Frame&& frame, Bad&& bad) {
    size_t i = 0;
    while (i < n) {
      if (!synchronous_) {
        const void* at = std::memchr(data + i, kSync, n - i);
        if (!at) return n;
        i = size_t(static_cast<const uint8_t*>(at) - data) + 1;
        synchronous_ = true;
        continue;
      }
      const uint8_t* p = data + i;
      size_t left = n - i, length = p[0];
      if (length == kSync) {
        ++i;
        continue;
      }
      bool good = length >= kFrameMin && length <= kFrameMax;
      if (good && left > 1) good = (p[1] & ~kSequenceMask) == kSequenceMark;
      if (good && left < length) return i;
      if (good)
        good = p[length - 1] == kSync &&
               Crc16::of(p, length - kTrailer) == (uint32_t(p[length - 3]) << 8 | p[length - 2]);
      if (!good) {
        synchronous_ = false;
        bad();
        continue;
      }
      frame(uint8_t(p[1] & kSequenceMask), p + kHeader, length - kFrameMin);
      i += length;
    }
    return i;
  }
};

}  // namespace passo::wire
