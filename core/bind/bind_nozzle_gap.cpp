// passo._core.NozzleGap: distance of the nozzle from the simulated bed in the first layer of a job.
#include <nanobind/nanobind.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>
#include <vector>

#include "bind/bind_job.hpp"
#include "bind/bind_machine.hpp"
#include "sim/nozzle_gap.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;
using namespace passo::wire;

namespace {

using GapMotor = std::tuple<Bench*, uint32_t, double, double, double>;
using GapLift = std::pair<uint32_t, std::array<double, 4>>;
using GapPlace = std::tuple<double, double, double>;

class GapView {
 public:
  GapView(double clock_hz, const nb::dict& geometry, const Bed& bed,
          const std::vector<GapMotor>& motors, const std::vector<GapLift>& lifts)
      : gap_(clock_hz, geometry_of(geometry), bed, motors_of(motors), lifts_of(lifts)) {
    for (const auto& [board, pin, per_step, ratio, offset] : motors) {
      motors_.push_back({board, pin});
      board->trace_steps(pin, -kNever, kNever);
    }
  }

  void begin(JobView& job, double base) {
    job.spans.emplace(1);
    job.watch_moves();
    base_ = base;
  }
  void place(double ticks, std::vector<double> positions) {
    if (positions.size() != motors_.size()) throw nb::value_error("a motor has no position");
    gap_.place(base_ + ticks, std::move(positions));
  }
  // Returns false when nothing is left to measure.
  bool follow(JobView& job) {
    if (!job.spans) return false;
    const std::vector<Tool>& tools = job.job.motion.machine().tools;
    for (const auto& [from, to, tool] : job.spans->take()) {
      std::array<double, 3> offset{};
      if (!tools.empty()) std::copy_n(tools[tool].offset, 3, offset.begin());
      gap_.add_span(base_ + from, base_ + to, offset);
    }
    for (size_t i = 0; i < motors_.size(); ++i) {
      auto& [board, pin] = motors_[i];
      gap_.add_steps(i, board->take_steps(pin), board->steps(pin), board->now());
    }
    gap_.advance();
    if (!job.spans->over() || !gap_.idle()) return true;
    end(job);
    return false;
  }
  void end(JobView& job) {
    job.spans.reset();
    job.watch_moves();
    for (const auto& [board, pin] : motors_) {
      board->trace_steps(pin, kNever, kNever);
      board->take_steps(pin);
    }
  }
  const NozzleGap& gap() const { return gap_; }

 private:
  NozzleGap gap_;
  std::vector<std::pair<Bench*, uint32_t>> motors_;
  double base_ = 0;

  static std::vector<TrackedMotor> motors_of(const std::vector<GapMotor>& list) {
    std::vector<TrackedMotor> motors;
    for (const auto& [board, pin, per_step, ratio, offset] : list)
      motors.push_back({per_step, ratio, offset});
    return motors;
  }
  static std::vector<Lift> lifts_of(const std::vector<GapLift>& list) {
    std::vector<Lift> lifts;
    for (const auto& [motor, c] : list) lifts.push_back({motor, {c[0], c[1], c[2], c[3]}});
    return lifts;
  }
};

GapPlace place_of(const NozzleGap::Place& at) { return {at.gap, at.x, at.y}; }

}  // namespace

void bind_nozzle_gap(nb::module_& m) {
  nb::class_<GapView>(m, "NozzleGap",
                      "The distance of the nozzle from the simulated bed in mm while a job "
                      "extrudes in its first layer, from executed steps.")
      .def(
          nb::init<double, const nb::dict&, const Bed&, const std::vector<GapMotor>&,
                   const std::vector<GapLift>&>(),
          "clock_hz"_a, "geometry"_a, "bed"_a, "motors"_a, "lifts"_a, nb::keep_alive<1, 5>(),
          "Records the steps of `motors` until the layer is over. The first motors are those of "
          "the "
          "actuators of the geometry, one each. Each entry has the board, the step pin, the mm or "
          "degrees per step, the main board's ticks per tick of the board, and the main board's "
          "clock when the board's clock is 0. `lifts` has, for each motor that carries the gantry, "
          "its index in `motors` and its weight as for carry_probe.")
      .def("begin", &GapView::begin, "job"_a, "base"_a,
           "Call this when the job begins, with the clock of the main board.")
      .def("place", &GapView::place, "ticks"_a, "positions"_a,
           "Sets the positions of the motors at this clock of the job, at standstill.")
      .def("follow", &GapView::follow, "job"_a,
           "Samples the motion that the boards have executed; False once the layer is over.")
      .def("end", &GapView::end, "job"_a, "Stops recording steps.")
      .def_prop_ro("samples", [](const GapView& v) { return v.gap().samples(); })
      .def_prop_ro("mean", [](const GapView& v) { return v.gap().mean(); })
      .def_prop_ro(
          "lowest", [](const GapView& v) { return place_of(v.gap().lowest()); },
          "The smallest distance, and X and Y there.")
      .def_prop_ro(
          "highest", [](const GapView& v) { return place_of(v.gap().highest()); },
          "The largest distance, and X and Y there.")
      .def_prop_ro(
          "cells",
          [](const GapView& v) {
            std::vector<std::pair<double, int>> cells;
            for (const NozzleGap::Cell& cell : v.gap().cells())
              cells.emplace_back(cell.samples > 0 ? cell.sum / cell.samples : 0, cell.samples);
            return cells;
          },
          "The mean distance and the number of samples in each cell of the bed, in rows from the "
          "front.");
  m.attr("GAP_CELLS") = NozzleGap::kCells;
}
