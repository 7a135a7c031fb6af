// Processor time of this thread, for the cost of the stages; never used as a clock.
#pragma once
#include <ctime>

namespace passo {

inline double thread_cpu_s() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

}  // namespace passo
