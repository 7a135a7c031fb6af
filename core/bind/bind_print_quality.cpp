// passo._core.PrintQuality: ringing, corners and line width of a simulated print.
#include <nanobind/nanobind.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <tuple>
#include <utility>
#include <vector>

#include "bind/bind_job.hpp"
#include "bind/bind_numbers.hpp"
#include "sim/print_quality.hpp"

namespace nb = nanobind;
using namespace nb::literals;
using namespace passo;
using namespace passo::wire;

namespace {

using SampleTuple = std::tuple<double, double, double, double, double, double, double>;
using Pair = std::pair<double, double>;
using CornerTuple = std::tuple<size_t, uint32_t, Pair, Pair, Pair, std::vector<SampleTuple>>;

CornerTuple shown(const PrintQuality& q) {
  std::vector<SampleTuple> samples;
  const PrintQuality::Corner& corner = q.shown();
  for (const PrintQuality::Sample& s : corner.samples)
    samples.emplace_back(s.s, s.head[0], s.head[1], s.motors[0], s.motors[1], s.across_mm, s.width);
  auto pair = [](const double (&of)[2]) { return Pair(of[0], of[1]); };
  return {corner.number,       corner.line,        pair(corner.at),
          pair(corner.before), pair(corner.after), std::move(samples)};
}

}  // namespace

void bind_print_quality(nb::module_& m) {
  nb::class_<PrintQuality>(m, "PrintQuality",
                           "Measures how the head of a simulated printer follows the path of a "
                           "file, and how wide its lines are. Clocks are those of the main board.")
      .def(
          "__init__",
          [](PrintQuality* self, double clock_hz, std::shared_ptr<HeadDynamics> head) {
            new (self) PrintQuality(positive(clock_hz, "clock_hz"), std::move(head));
          },
          "clock_hz"_a, "head"_a)
      .def(
          "begin",
          [](PrintQuality& q, JobView& job, double clock) {
            finite(clock, "clock");
            job.segments.emplace();
            job.watch_moves();
            q.begin(clock);
          },
          "job"_a, "clock"_a, "Call this when the job begins, at standstill.")
      .def(
          "run",
          [](PrintQuality& q, JobView& job, double clock) {
            finite(clock, "clock");
            if (job.segments) q.add_path(job.segments->take());
            nb::gil_scoped_release released;
            q.run(clock);
          },
          "job"_a, "clock"_a, "Measures up to a clock that the boards have reached.")
      .def(
          "end",
          [](PrintQuality& q, JobView& job) {
            job.segments.reset();
            job.watch_moves();
            q.finish();
          },
          "job"_a, "Call this at the end of the print.")
      .def("keep_path", &PrintQuality::keep_path,
           "Keeps the path, for `StepRecording.measure`. Call it before `begin`.")
      .def("show", &PrintQuality::show, "corner"_a,
           "The corner of `shown`; without a call, the one with the largest ringing.")
      .def_prop_ro(
          "shown", &shown,
          "A corner: its number, its line in the file, X and Y, the directions of its "
          "lines in X and Y, and samples: seconds since the motors have passed it, X and Y "
          "of the head, X and Y of the motors, the head's deviation across its line in "
          "mm, the width of the line as a fraction.")
      .def_prop_ro("corners", &PrintQuality::corners, "Number of sharp corners of printed lines.")
      .def_prop_ro("printed_mm", &PrintQuality::printed_mm)
      .def_prop_ro(
          "ringing_mm",
          [](const PrintQuality& q) { return std::pair(q.ringing().rms(), q.ringing().most); },
          "Deviation across the line for 0.1 s after corners: root mean square, and the largest.")
      .def_prop_ro(
          "rounding_mm",
          [](const PrintQuality& q) { return std::pair(q.rounding().mean(), q.rounding().most); },
          "Distance of the head's way from corners: mean and largest.")
      .def_prop_ro(
          "off_path_mm",
          [](const PrintQuality& q) { return std::pair(q.off_path().rms(), q.off_path().most); },
          "Distance of the head from printed lines: root mean square, and the largest.")
      .def_prop_ro("width_error", &PrintQuality::width_error,
                   "Mean error of the width of printed lines, as a fraction.")
      .def_prop_ro("lost", &PrintQuality::lost,
                   "Fraction of the time in which the motors were more than 2 mm from the path.");
}
