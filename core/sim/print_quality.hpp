// Measures how well a simulated printer follows the lines of a file: ringing, corners, width of
// lines.
#pragma once
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "plan/path_segments.hpp"
#include "sim/head_dynamics.hpp"

namespace passo::wire {

// Compares the real positions of the head, and the real extrusion, with the path of a file, in
// samples at intervals of kSampleSeconds. It compares only positions, not times, so any stream of
// steps along the path is measured alike. The place on the path is the point nearest to the motors,
// which do not vibrate; it moves only forward. The head is compared with the path around this
// place.
class PrintQuality {
 public:
  static constexpr double kSampleSeconds = 0.0005;
  static constexpr double kRingingSeconds =
      0.1;  // maximum duration of a measurement after a corner
  static constexpr double kSharp =
      0.8660254037844386;  // cosine of the smallest angle that counts as a corner

  PrintQuality(double clock_hz, std::shared_ptr<HeadDynamics> head)
      : hz_(clock_hz), head_(std::move(head)) {}

  // Starts to measure at a clock, at standstill.
  void begin(double clock);
  // Adds the next part of the path, before the head gets there.
  void add_path(const std::vector<PathSegment>& segments);
  // From now on keeps the whole path, so that another stream can be measured with it.
  void keep_path() { keeps_ = true; }
  const std::vector<PathSegment>& path() const { return kept_; }
  // Measures up to a clock. The boards must have run up to it.
  void run(double clock);
  // Completes the measurement of the last corner.
  void finish();

  // Weighted sums of a value and of its square, and the maximum.
  struct Spread {
    double square = 0, weight = 0, most = 0, sum = 0;
    void add(double value, double by) {
      square += value * value * by;
      sum += value * by;
      weight += by;
      if (value > most) most = value;
    }
    double rms() const;
    double mean() const { return weight > 0 ? sum / weight : 0; }
  };
  // In mm. ringing(): deviation of the head across the line after a corner, once the motors are on
  // the line. rounding(): distance of the head's path from the corner. off_path(): distance of the
  // head from the path.
  const Spread& ringing() const { return ringing_; }
  const Spread& rounding() const { return rounding_; }
  const Spread& off_path() const { return off_path_; }
  // Mean error of the width of printed lines, as a fraction.
  double width_error() const { return printed_mm_ > 0 ? width_error_mm_ / printed_mm_ : 0; }
  double printed_mm() const { return printed_mm_; }
  size_t corners() const { return corners_; }
  // Fraction of the samples without measurement, because the motors were too far from the path.
  double lost() const { return samples_ > 0 ? double(lost_) / double(samples_) : 0; }

  // The motion around one corner, for a picture.
  struct Sample {
    double s;          // since the motors passed the corner, s
    double head[2];    // X and Y, mm
    double motors[2];  // X and Y, mm
    double across_mm;  // deviation of the head across its line, positive to the left
    double width;      // width of the line as a fraction of its nominal width; 0: no line
  };
  struct Corner {
    size_t number = 0;  // among all sharp corners between printed lines, from 0
    uint32_t line = 0;  // line of the file after the corner
    double at[2] = {}, before[2] = {},
           after[2] = {};  // X and Y; directions of the lines before and after
    double peak_mm = 0;
    bool lasts = false;  // the line after it is long enough for a picture
    std::vector<Sample> samples;

    // A corner before a long line shows more.
    bool shows_more(const Corner& than) const {
      return lasts != than.lasts ? lasts : peak_mm > than.peak_mm;
    }
  };
  // The corner with the largest ringing before a long line, or the one selected by show().
  const Corner& shown() const { return shown_; }
  void show(size_t corner) { wanted_ = corner; }

 private:
  struct Segment : PathSegment {
    double length, unit[3];
    double begin;  // length of path before this segment, mm

    // The point of the segment nearest to p, between two distances from its start. Returns its
    // distance from the start, and from p.
    std::pair<double, double> nearest(const double p[3], double least, double most) const;
  };
  struct Rounding {
    double at[3], nearest, left_at;
  };
  struct Ringing {
    double from[2], unit[2], peak = 0, settled = -1;
    std::optional<size_t> corner = std::nullopt;
  };
  double hz_, at_ = 0;
  std::shared_ptr<HeadDynamics> head_;
  std::deque<Segment> path_;  // begins kPastMm before the place
  bool keeps_ = false;
  std::vector<PathSegment> kept_;
  size_t on_ = 0;     // the place: number of the segment,
  double along_ = 0;  // and distance from its start, mm
  double off_ = 0;    // distance of the motors from the place
  double motors_[3] = {}, position_[3] = {}, extruded_ = 0;  // of the last sample
  uint16_t extruder_ = 0;
  bool printed_ = false;   // the last sample was on a printed line
  double settled_at_ = 0;  // clock from which the width of lines is measured
  std::optional<Rounding> rounding_now_;
  std::optional<Ringing> ringing_now_;
  std::deque<Sample> past_;
  Corner recorded_, shown_;
  std::optional<size_t> wanted_;
  double recording_ = -1;  // clock of its start; negative: no recording

  Spread ringing_, rounding_, off_path_;
  double width_error_mm_ = 0, printed_mm_ = 0;
  size_t corners_ = 0, samples_ = 0, lost_ = 0;

  double seconds(double from) const { return (at_ - from) / hz_; }
  void stand();
  void sample();
  void follow(const double motors[3], double moved);
  double from_path(const double p[3], double reach) const;
  bool ends() const;  // the place is at the end of its segment
  bool over() const;  // and no further path is known
  void next_segment();
  void pass(const Segment& before, const Segment& after);
  void round(const double from[3], const double to[3]);
  void end_rounding();
  void ring(const double p[3]);
  void end_ringing();
  double measure_width(double moved);
  void record(const double p[3], double width);
  void end_recording();
};

}  // namespace passo::wire
