// Processor time of this thread: what the stages cost, never what time it is.
#pragma once
#include <ctime>

namespace passo {

inline double thread_cpu_s() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

}  // namespace passo
