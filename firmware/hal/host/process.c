// The host process: the firmware as a program that speaks on a terminal, in real time.
//
//   process LINK ANALOG [STEP DIRECTION SWITCH POSITION]...
//
// LINK becomes a symbolic link to the terminal that hosts open. All analog inputs read ANALOG. Each
// carriage has its step and direction pin, stands POSITION steps above where its switch is pressed
// (level 1), and goes up while the direction pin is high. Pins are numbers.
//
// Each line on the standard input is answered by one: the number of the reason for the board's
// shutdown (0: none), then position and steps made, both ways, of each carriage. The program ends
// when the standard input does.
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "hal.h"
#include "host.h"

#define CARRIAGES 8
#define PINS 1024
#define LOOK_MS 2
#define NANOSECONDS 1000000000LL
// When the computer suspends the process, the chip and its clock stop, too.
#define STALL (10 * NANOSECONDS / 1000)

struct carriage {
  unsigned step, direction, limit;
  long position, steps;
};

static struct carriage carriages[CARRIAGES];
static int carriage_count;
static uint16_t analog_value;
static bool levels[PINS];

static void edge(void *owner, uint16_t pin, bool level, int64_t clock) {
  (void)owner, (void)clock;
  levels[pin] = level;
  for (struct carriage *c = carriages; level && c < carriages + carriage_count; c++) {
    if (c->step != pin) continue;
    c->position += levels[c->direction] ? 1 : -1;
    c->steps++;
  }
}
static void output(void *owner, uint16_t pin, uint32_t value, uint32_t full, int64_t clock) {
  (void)owner, (void)pin, (void)value, (void)full, (void)clock;
}
static bool input(void *owner, uint16_t pin, int64_t clock) {
  (void)owner, (void)clock;
  for (const struct carriage *c = carriages; c < carriages + carriage_count; c++)
    if (c->limit == pin) return c->position < 0;
  return levels[pin];
}
static uint16_t analog(void *owner, uint16_t pin, int64_t clock) {
  (void)owner, (void)pin, (void)clock;
  return analog_value;
}
static bool lights(void *owner, uint16_t pin, const uint8_t *data, uint16_t size, int64_t clock) {
  (void)owner, (void)pin, (void)data, (void)size, (void)clock;
  return true;
}

static int64_t real_time(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC_RAW, &t);
  return t.tv_sec * NANOSECONDS + t.tv_nsec;
}

// The board's clock, in ticks.
static int64_t now(void) {
  static int64_t seen, passed;
  int64_t at = real_time(), since = seen == 0 ? 0 : at - seen;
  seen = at;
  passed += since < STALL ? since : STALL;
  return passed / NANOSECONDS * PROCESS_CLOCK_HZ +
         passed % NANOSECONDS * PROCESS_CLOCK_HZ / NANOSECONDS;
}

static int open_terminal(const char *link) {
  int master = posix_openpt(O_RDWR | O_NOCTTY);
  if (master < 0 || grantpt(master) < 0 || unlockpt(master) < 0) return -1;
  const char *name = ptsname(master);
  int slave = open(name, O_RDWR | O_NOCTTY);  // stays open between hosts
  struct termios raw;
  if (slave < 0 || tcgetattr(slave, &raw) < 0) return -1;
  cfmakeraw(&raw);
  if (tcsetattr(slave, TCSANOW, &raw) < 0 || symlink(name, link) < 0) return -1;
  return master;
}

static bool write_all(int fd, const uint8_t *data, size_t size) {
  while (size > 0) {
    ssize_t n = write(fd, data, size);
    if (n < 0 && errno != EINTR) return false;
    if (n > 0) data += n, size -= (size_t)n;
  }
  return true;
}

static void tell(uint8_t reason) {
  printf("%u", reason);
  for (const struct carriage *c = carriages; c < carriages + carriage_count; c++)
    printf(" %ld %ld", c->position, c->steps);
  printf("\n");
  fflush(stdout);
}

static int serve(const struct host_functions *board, int master) {
  struct pollfd fds[] = {{master, POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}};
  uint8_t buffer[4096];
  size_t size;
  for (;;) {
    board->run(now());
    const uint8_t *sent = board->take(&size);
    if (!write_all(master, sent, size)) return EXIT_FAILURE;
    if (poll(fds, 2, LOOK_MS) < 0 && errno != EINTR) return EXIT_FAILURE;
    if (fds[1].revents != 0) {
      ssize_t n = read(STDIN_FILENO, buffer, sizeof buffer);
      if (n <= 0) return EXIT_SUCCESS;
      board->run(now());
      while (n-- > 0)
        if (buffer[n] == '\n') tell(board->state().reason);
    }
    if (fds[0].revents != 0) {
      ssize_t n = read(master, buffer, sizeof buffer);
      if (n <= 0) return EXIT_FAILURE;
      board->feed(buffer, (size_t)n, now());
    }
  }
}

int main(int argc, char **argv) {
  if (argc < 3 || (argc - 3) % 4 != 0 || (argc - 3) / 4 > CARRIAGES) {
    fprintf(stderr, "%s LINK ANALOG [STEP DIRECTION SWITCH POSITION]...\n", argv[0]);
    return 2;
  }
  analog_value = (uint16_t)atoi(argv[2]);
  for (char **word = argv + 3; *word != NULL; word += 4) {
    unsigned pins[3];
    for (int i = 0; i < 3; i++) {
      pins[i] = (unsigned)strtoul(word[i], NULL, 10);
      if (pins[i] >= PINS) return 2;
    }
    carriages[carriage_count++] = (struct carriage){pins[0], pins[1], pins[2], atol(word[3]), 0};
  }
  int master = open_terminal(argv[1]);
  if (master < 0) {
    perror(argv[1]);
    return EXIT_FAILURE;
  }
  const struct host_functions *board = passo_firmware();
  size_t size;
  const uint8_t *dictionary = board->built_dictionary(&size);
  board->start(
      &(struct host_options){PROCESS_CLOCK_HZ, PROCESS_MOVES, dictionary, (uint16_t)size, now()},
      &(struct host_surroundings){NULL, edge, output, input, analog, lights});
  return serve(board, master);
}
