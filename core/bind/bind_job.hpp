// The Python object of a job.
#pragma once
#include <nanobind/nanobind.h>

#include <optional>
#include <utility>
#include <vector>

#include "base/cpu_clock.hpp"
#include "motion/job.hpp"
#include "plan/toolpath.hpp"

namespace passo {

struct JobView {
  Job job;
  std::vector<Move> moves;
  std::optional<Toolpath> toolpath;
  JobView(const Machine& machine, std::vector<double> home, const LaserWords& laser,
          bool with_steps)
      : job(machine, std::move(home), laser, with_steps, thread_cpu_s) {}
};

}  // namespace passo

// Each binds one part of the class.
using JobClass = nanobind::class_<passo::JobView>;
void bind_job_program(JobClass& job);
void bind_job_motion(JobClass& job);
void bind_job_settings(JobClass& job);
void bind_job_results(JobClass& job);
