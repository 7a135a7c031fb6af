// One clock for several programs that work in real time, as a host and a board do at two ends of a
// serial line: it stands still while any of them works, and goes on when all of them wait. So
// neither is ever late because the computer is busy or the other one is a slow simulation.
//
// The clock is a file that all of them map. A program takes part unchanged if this library is
// preloaded and SHARED_CLOCK names the file: its CLOCK_MONOTONIC_RAW is then the shared clock, and
// poll() waits by it. Or it opens the clock, and waits with shared_clock_wait().
//
// A thread has a seat from its first wait on. All wait if each of them has looked at its
// descriptors, and found nothing, after the last time that any of them went to wait: by then all
// that the others wrote was there to be seen. Only a terminal hands bytes on a little later, by a
// thread of the kernel; hence the least time between two leaps. And programs that go round until a
// moment is past would do so for ever; hence a little time passes with each look at the clock.
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

enum { kSeats = 16 };
static const int64_t kSecond = 1000000000, kLeap = 1000000, kRest = 250000, kRead = 200;
static const int64_t kNever = INT64_MAX;

typedef struct {
  pid_t owner;  // process, or 0
  bool waits;
  int64_t until;
  uint32_t seen;  // `waits_begun` before it last looked
} Seat;

typedef struct {
  _Atomic pid_t owner;  // process that has the lock, or 0
  _Atomic int64_t now;  // ns
  _Atomic uint32_t waits_begun;
  int64_t leapt;  // when, in the computer's time
  Seat seats[kSeats];
} Clock;

static Clock* shared;
static pthread_key_t leaving;
static __thread Seat* mine;

static bool has_ended(pid_t process) { return kill(process, 0) != 0 && errno == ESRCH; }

// A program may be killed while it has the lock: then the next one takes it over.
static void lock(void) {
  for (pid_t free = 0; !atomic_compare_exchange_strong(&shared->owner, &free, getpid()); free = 0) {
    pid_t owner = free;
    if (owner != 0 && has_ended(owner) &&
        atomic_compare_exchange_strong(&shared->owner, &owner, getpid()))
      return;
    sched_yield();
  }
}
static void unlock(void) { shared->owner = 0; }

static int64_t computer_time(void) {
  struct timespec t;
  syscall(SYS_clock_gettime, CLOCK_MONOTONIC, &t);
  return t.tv_sec * kSecond + t.tv_nsec;
}

static int look(struct pollfd* fds, nfds_t count, int64_t wait) {
  struct timespec t = {0, wait};
  return (int)syscall(SYS_ppoll, fds, count, &t, NULL, 8);
}

static void leave(void* seat) {
  lock();
  *(Seat*)seat = (Seat){0};
  unlock();
}

static void take_seat(void) {
  lock();
  for (int i = 0; i < kSeats && !mine; ++i)
    if (!shared->seats[i].owner) mine = &shared->seats[i];
  if (!mine) abort();
  *mine = (Seat){.owner = getpid()};
  unlock();
  pthread_setspecific(leaving, mine);
}

// Locked: the clock goes on to where the first of all ends its wait, but a small leap at a time.
static void advance(void) {
  int64_t to = kNever, then = computer_time();
  for (Seat* s = shared->seats; s < shared->seats + kSeats; ++s) {
    if (!s->owner) continue;
    if (!s->waits || s->seen != shared->waits_begun) {
      if (!has_ended(s->owner)) return;
      *s = (Seat){0};  // that program has ended
      continue;
    }
    if (s->until < to) to = s->until;
  }
  if (then - shared->leapt < kRest) return;
  shared->leapt = then;
  int64_t now = shared->now;
  if (to > now) shared->now += to - now < kLeap ? to - now : kLeap;
}

static int wait_until(struct pollfd* fds, nfds_t count, int64_t until) {
  if (!mine) take_seat();
  for (;;) {
    uint32_t seen = shared->waits_begun;
    int ready = look(fds, count, 0);
    lock();
    if (ready != 0 || shared->now >= until) {
      mine->waits = false;
      unlock();
      return ready;
    }
    if (!mine->waits) shared->waits_begun++;
    mine->waits = true;
    mine->until = until;
    mine->seen = seen;
    advance();
    unlock();
    look(fds, count, kRest);
  }
}

// Opens or makes the clock of this name; false if it cannot.
bool shared_clock_open(const char* path) {
  int fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
  if (fd < 0 || ftruncate(fd, sizeof(Clock)) < 0) return false;
  void* at = mmap(NULL, sizeof(Clock), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  close(fd);
  if (at == MAP_FAILED || pthread_key_create(&leaving, leave) != 0) return false;
  shared = at;
  return true;
}

// Nanoseconds since the clock was made.
int64_t shared_clock_now(void) { return shared->now; }

// Until the clock shows `until`, or the descriptor has something to read: true then.
bool shared_clock_wait(int fd, int64_t until) {
  struct pollfd one = {.fd = fd, .events = POLLIN};
  return wait_until(&one, 1, until) > 0;
}

// ---- Preloaded

__attribute__((constructor)) static void preloaded(void) {
  const char* path = getenv("SHARED_CLOCK");
  if (path && !shared_clock_open(path)) abort();
}

int clock_gettime(clockid_t which, struct timespec* t) {
  if (!shared || which != CLOCK_MONOTONIC_RAW) return (int)syscall(SYS_clock_gettime, which, t);
  int64_t now = shared->now += kRead;
  *t = (struct timespec){now / kSecond, now % kSecond};
  return 0;
}

int poll(struct pollfd* fds, nfds_t count, int timeout_ms) {
  if (shared && timeout_ms != 0)
    return wait_until(fds, count, timeout_ms < 0 ? kNever : shared->now + timeout_ms * 1000000LL);
  struct timespec t = {timeout_ms / 1000, timeout_ms % 1000 * 1000000L};
  return (int)syscall(SYS_ppoll, fds, count, timeout_ms < 0 ? NULL : &t, NULL, 8);
}
