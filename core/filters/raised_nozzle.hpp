// The law of a motor that corrects an uneven bed: the filtered path of the nozzle as pieces. The
// piece solver cuts them at the lines of the height map.
#pragma once
#include "filters/phases.hpp"
#include "geometry/track.hpp"
#include "plan/pieces.hpp"

namespace passo {

class RaisedNozzle {
 public:
  RaisedNozzle(double hz, const Track& track) : hz_(hz), track_(&track) {}

  void start(double) {}  // always at the start of the track
  double t() const { return track_->t[track_->n]; }
  double q() const { return 0; }  // the piece solver keeps the motor's count
  double earliest() const { return 0; }

  // Passes on the whole track by sink.piece, see law.hpp.
  template <class Sink>
  void advance(double, bool, Sink& sink) {
    const Track& track = *track_;
    for (size_t k = 0; k < track.n; ++k) {
      const double d = track.t[k + 1] - track.t[k];
      Piece p{};
      p.start = track.t[k];
      p.seconds = d / hz_;
      for (size_t i = 0; i < 3; ++i) {
        p.c[i][0] = track.p[i][k];
        p.c[i][1] = track.v0[i][k] * hz_;
        p.c[i][2] = 0.5 * (track.v1[i][k] - track.v0[i][k]) / d * hz_ * hz_;
        if (!track.cubic) continue;
        const double third = track.third(i, k) / (p.seconds * p.seconds);
        p.c[i][2] -= 1.5 * third;
        p.c[i][3] = third / p.seconds;
      }
      sink.piece(p);
    }
  }
  // This law has no phases of its own.
  size_t needed(const Phases*) const { return 0; }
  void dropped(const Phases*, size_t) {}

 private:
  double hz_;
  const Track* track_;
};

}  // namespace passo
