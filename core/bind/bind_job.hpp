// The Python object of a job.
#pragma once
#include <nanobind/nanobind.h>

#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "base/cpu_clock.hpp"
#include "filters/fastest_corner.hpp"
#include "motion/job.hpp"
#include "plan/path_segments.hpp"
#include "plan/printing_spans.hpp"
#include "plan/toolpath.hpp"

namespace passo {

struct JobView {
  Job job;
  std::vector<Move> moves;
  bool keeps_moves = false;
  std::optional<Toolpath> toolpath;
  std::optional<PrintingSpans> spans;
  std::optional<PathSegments> segments;
  std::optional<FastestCorner> fastest_corner;
  JobView(const Machine& machine, std::vector<double> home, const LaserWords& laser,
          bool with_steps)
      : job(machine, std::move(home), laser, with_steps, thread_cpu_s) {}

  // Passes each settled move to the objects that record the plan.
  void watch_moves() {
    auto& on_move = job.motion.on_move;
    auto lead = [this](size_t i) {
      const StepStream& stream = job.motion.stream();
      return i < stream.motors() ? stream.lead(i) : 0;
    };
    if (!keeps_moves && !toolpath && !spans && !segments && !fastest_corner)
      on_move = nullptr;
    else
      on_move = [this, lead](const Move& move) {
        if (keeps_moves) moves.push_back(move);
        if (toolpath) toolpath->add(move);
        if (spans) spans->add(move, job.motion.delay());
        if (segments) segments->add(move);
        if (fastest_corner) fastest_corner->add(move, lead);
      };
  }
};

using ErrorTuple =
    std::tuple<uint32_t, Fault, std::string, double, double, std::tuple<double, double, double>>;

inline ErrorTuple as_tuple(const GcodeError& e) {
  return {e.line, e.fault, e.word, e.value, e.limit, {e.point[0], e.point[1], e.point[2]}};
}

using JobClass = nanobind::class_<JobView>;

// The parts of a job in Python, one class for each subject. A part keeps its job alive.
struct JobPart {
  JobView& view;
  Job& job;
};
template <class Subject>
struct PartOf : JobPart {};
using ProgramPart = PartOf<struct ProgramSubject>;
using OptionsPart = PartOf<struct OptionsSubject>;
using ModesPart = PartOf<struct ModesSubject>;
using ObjectsPart = PartOf<struct ObjectsSubject>;
using PlanPart = PartOf<struct PlanSubject>;
using StopsPart = PartOf<struct StopsSubject>;
using CommitsPart = PartOf<struct CommitsSubject>;
using OutputsPart = PartOf<struct OutputsSubject>;
using AxesPart = PartOf<struct AxesSubject>;
using HistoryPart = PartOf<struct HistorySubject>;
using MotorsPart = PartOf<struct MotorsSubject>;
using BedPart = PartOf<struct BedSubject>;
using FiltersPart = PartOf<struct FiltersSubject>;
using ToolsPart = PartOf<struct ToolsSubject>;
using FilamentPart = PartOf<struct FilamentSubject>;
using LimitsPart = PartOf<struct LimitsSubject>;
using ResultsPart = PartOf<struct ResultsSubject>;

// Binds a part as a class, and as an attribute of the job.
template <class Part>
nanobind::class_<Part> bind_part(nanobind::module_& m, JobClass& job, const char* class_name,
                                 const char* name, const char* text) {
  nanobind::class_<Part> bound(m, class_name, text);
  job.def_prop_ro(
      name, [](JobView& self) { return Part{{self, self.job}}; }, nanobind::keep_alive<0, 1>(),
      text);
  return bound;
}

}  // namespace passo
