// The Python object of a job.
#pragma once
#include <nanobind/nanobind.h>

#include <optional>
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
  std::optional<FastestCorner> corner;
  JobView(const Machine& machine, std::vector<double> home, const LaserWords& laser,
          bool with_steps)
      : job(machine, std::move(home), laser, with_steps, thread_cpu_s) {}

  // Passes each settled move to the parts that record the plan.
  void watch_moves() {
    auto& on_move = job.motion.on_move;
    auto lead = [this](size_t i) {
      const StepStream& stream = job.motion.stream();
      return i < stream.motors() ? stream.lead(i) : 0;
    };
    if (!keeps_moves && !toolpath && !spans && !segments && !corner)
      on_move = nullptr;
    else
      on_move = [this, lead](const Move& move) {
        if (keeps_moves) moves.push_back(move);
        if (toolpath) toolpath->add(move);
        if (spans) spans->add(move, job.motion.delay());
        if (segments) segments->add(move);
        if (corner) corner->add(move, lead);
      };
  }
};

}  // namespace passo

// Each binds one part of the class.
using JobClass = nanobind::class_<passo::JobView>;
void bind_job_program(JobClass& job);
void bind_job_motion(JobClass& job);
void bind_job_settings(JobClass& job);
void bind_job_results(JobClass& job);
