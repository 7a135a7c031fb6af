// Splits text into lines. The same lexer reads files, consoles and single lines. It holds one line
// at most, without its comment.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace passo {

inline constexpr double kPowersOfTen[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                          1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                          1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
inline constexpr double kLargestWord = 1e9;

// Reads a decimal number without an exponent. Without a number, returns false and leaves p
// unchanged.
inline bool read_number(const char*& p, const char* end, double& value) {
  const char* q = p;
  bool negative = false;
  if (q < end && (*q == '-' || *q == '+')) negative = *q++ == '-';
  uint64_t mantissa = 0;
  int digits = 0, decimals = 0;
  const char* first = q;
  for (; q < end && uint8_t(*q - '0') < 10; ++q)
    if (digits < 18) {
      mantissa = mantissa * 10 + uint64_t(*q - '0');
      digits += mantissa != 0;
    } else {
      --decimals;
    }
  size_t seen = size_t(q - first);
  if (q < end && *q == '.') {
    ++q;
    const char* fraction = q;
    for (; q < end && uint8_t(*q - '0') < 10; ++q)
      if (digits < 18) {
        mantissa = mantissa * 10 + uint64_t(*q - '0');
        digits += mantissa != 0;
        ++decimals;
      }
    seen += size_t(q - fraction);
  }
  if (seen == 0) return false;
  value = double(mantissa);
  for (; decimals > 22 && value > 0; --decimals) value /= 10;
  if (decimals > 0) value /= kPowersOfTen[decimals < 22 ? decimals : 22];
  for (; decimals < 0 && value < 1e300; ++decimals) value *= 10;
  if (negative) value = -value;
  p = q;
  return true;
}

// Splits a stream of bytes into lines, which end with LF, CR LF or CR. Removes a byte order mark
// before the first line.
class Lines {
 public:
  static constexpr size_t kMaxLineBytes = 65536;  // without comment

  Lines() = default;
  // The first line has the number `first`.
  explicit Lines(uint32_t first) : number_(first - 1) {}
  void feed(const char* data, size_t n) {
    if (at_ > 0) {
      buffer_.erase(0, at_);
      feed_at_ -= std::min(feed_at_, at_);
      at_ = 0;
      scanned_ = 0;
    }
    buffer_.append(data, n);
    fed_ += n;
  }
  void finish() { finished_ = true; }
  bool finished() const { return finished_; }
  uint32_t number() const { return number_; }
  bool unended() const { return unended_; }  // the last line of the text has no line end
  // Number of bytes in the lines returned so far.
  uint64_t offset() const { return fed_ - (buffer_.size() - at_); }
  bool too_long() const { return too_long_; }

  // Returns the next line without its line end. A line that is too long is returned as an empty
  // line, before its end arrives. False if more input is needed, or if the text has ended.
  bool next(const char*& begin, const char*& end) {
    const char* stop = buffer_.data() + buffer_.size();
    const char* newline = line_end();
    if (!newline && !finished_) {
      shorten(stop);
      if (!dropped_ || reported_) return false;
      begin = end = stop;
      ++number_;
      reported_ = too_long_ = true;
      return true;
    }
    if (newline && *newline == '\r' && newline + 1 == stop && !finished_) {
      scanned_ = size_t(newline - buffer_.data()) - at_;  // an LF may follow
      return false;
    }
    if (!newline && at_ == buffer_.size() && !cut_) return false;
    begin = text_begin();
    end = newline ? newline : stop;
    if (cut_ || size_t(end - begin) > kMaxLineBytes) end = kept(begin, end);
    const char* next_line = newline ? newline + 1 : stop;
    if (newline && *newline == '\r' && next_line < stop && *next_line == '\n') ++next_line;
    at_ = size_t(next_line - buffer_.data());
    scanned_ = 0;
    unended_ = !newline;
    if (reported_) {
      reported_ = dropped_ = cut_ = false;
      return next(begin, end);
    }
    ++number_;
    too_long_ = dropped_;
    dropped_ = cut_ = false;
    return true;
  }

 private:
  std::string buffer_;
  size_t at_ = 0, scanned_ = 0;  // no CR in the first scanned_ bytes from at_ on
  size_t feed_at_ = 0;           // no LF between at_ and here
  uint64_t fed_ = 0;
  uint32_t number_ = 0;
  bool finished_ = false, dropped_ = false, too_long_ = false, cut_ = false, unended_ = false;
  bool reported_ = false;  // the line at at_ was reported as too long before its end was received

  // The first LF or CR of the line, or null. feed_at_ keeps the place of the next
  // LF for all lines before it that end with a CR.
  const char* line_end() {
    const char* all = buffer_.data();
    feed_at_ = std::max(feed_at_, at_);
    if (feed_at_ < buffer_.size() && all[feed_at_] != '\n') {
      const void* found = std::memchr(all + feed_at_, '\n', buffer_.size() - feed_at_);
      feed_at_ = found ? size_t(static_cast<const char*>(found) - all) : buffer_.size();
    }
    const size_t from = std::min(at_ + scanned_, feed_at_);
    if (const void* found = std::memchr(all + from, '\r', feed_at_ - from))
      return static_cast<const char*>(found);
    return feed_at_ < buffer_.size() ? all + feed_at_ : nullptr;
  }

  // Start of the line at at_, after a byte order mark.
  const char* text_begin() const {
    const char* from = buffer_.data() + at_;
    const bool marked =
        number_ == 0 && buffer_.size() - at_ >= 3 && std::memcmp(from, "\xef\xbb\xbf", 3) == 0;
    return marked ? from + 3 : from;
  }

  // Shortens a long line: drops its comment, or the text after a zero byte or a Ctrl-Z. A line that
  // is too long without them is dropped.
  const char* kept(const char* begin, const char* end) {
    const char* stop = begin + std::min(kMaxLineBytes, size_t(end - begin));
    const char* rest =
        std::find_if(begin, stop, [](char c) { return c == ';' || c == 0 || c == 0x1a; });
    dropped_ = dropped_ || rest == stop;
    return rest == stop ? begin : rest + 1;
  }

  // Bounds the memory of a line whose end has not arrived yet. The result is the same as if the
  // whole line had arrived at once.
  void shorten(const char* stop) {
    const char* begin = text_begin();
    if (size_t(stop - begin) > kMaxLineBytes) {
      cut_ = true;
      buffer_.resize(size_t(kept(begin, stop) - buffer_.data()));
      feed_at_ = buffer_.size();
    }
    scanned_ = buffer_.size() - at_;
  }
};

}  // namespace passo
