// What Python holds of a job.
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

void bind_job_settings(nanobind::class_<passo::JobView>& job);
