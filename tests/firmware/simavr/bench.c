// A test bench around one simulated AVR: its pins are traced, its serial port is a pair of byte
// queues, its analog inputs are voltages, and carriages on its step pins press its switches.
//
// The simulator (libsimavr 1.6) is wrong in six places that matter here. The bench makes up for
// each of them and counts how often it had to, so that a test can see that it did:
//   entries   entering an interrupt takes no cycles; the bench adds what the chip takes
//   rescues   a compare match within the cycles by which a timer's overflow is handled late is
//             lost for a whole turn; the bench raises it
//   revivals  an interrupt of a compare unit that is up and enabled may never be served, because it
//             fell out of the queue; the bench queues it again
//   siblings  writing a timer's flag register clears all flags that are up, not those that are
//             written; the bench shows the simulator only those
//   channels  analog channels 8 to 15 read memory behind the array of the first eight; the bench
//             lets them share the places of channels 0 to 7 and fills these when one is sampled
//   (always)  a byte takes 11 bit times on the line; the bench sets the 10 of 8N1
#include <simavr/avr_adc.h>
#include <simavr/avr_extint.h>
#include <simavr/avr_ioport.h>
#include <simavr/avr_timer.h>
#include <simavr/avr_uart.h>
#include <simavr/sim_avr.h>
#include <simavr/sim_elf.h>
#include <simavr/sim_interrupts.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { kPins = 96, kChannels = 16, kCarriages = 8, kTimers = 8, kExternal = 8, kQueue = 1 << 16 };
enum { kEdges = 1, kRises = 2 };
enum { kSlice = 400, kBitsPerByte = 10, kFifo = 32, kSupplyMillivolts = 5000 };

typedef struct {
  uint64_t cycle;
  uint16_t pin, level;
} Edge;

typedef struct {
  int step_pin, dir_pin, switch_pin, pressed_level;
  int64_t position, pressed_below;
} Carriage;

typedef struct {
  uint8_t data[kQueue];
  uint32_t head, tail;
} Bytes;

typedef struct Bench Bench;
typedef struct {
  Bench* bench;
  int index;
  avr_io_write_t written;  // a timer's: what the simulator does when its flags are written
} Probe;

struct Bench {
  avr_t* avr;
  avr_adc_t* adc;
  avr_uart_t* uart;
  avr_timer_t* timers[kTimers];
  int timer_count;
  avr_irq_t* pin_irq[kPins];
  uint8_t level[kPins], watched[kPins];
  uint64_t high_cycles[kPins], high_since[kPins], rises[kPins];
  uint8_t driven[kPins / 8], driven_high[kPins / 8];
  uint16_t millivolts[kChannels];
  Carriage carriages[kCarriages];
  int carriage_count;
  Edge* edges;
  uint32_t edge_count, edge_room;
  uint64_t edges_lost;
  Bytes to_board, from_board;
  unsigned entry_cycles, depth;
  uint64_t interrupted_at, interrupt_cycles;
  uint64_t entries, rescues, revivals, siblings, channels;
  Probe probes[kPins + kTimers];
};

static void put(Bytes* queue, uint8_t byte) { queue->data[queue->head++ % kQueue] = byte; }

// Drives a pin from outside, more strongly than the chip's own pull-up.
static void set_level(Bench* b, int pin, int level) {
  uint8_t bit = (uint8_t)(1 << pin % 8);
  uint8_t *driven = &b->driven[pin / 8], *high = &b->driven_high[pin / 8];
  *driven |= bit;
  *high = level ? *high | bit : *high & (uint8_t)~bit;
  char port = (char)('A' + pin / 8);
  avr_ioport_external_t pull = {.name = (unsigned)port, .mask = *driven, .value = *high};
  avr_ioctl(b->avr, AVR_IOCTL_IOPORT_SET_EXTERNAL(port), &pull);
  avr_raise_irq(b->pin_irq[pin], (uint32_t)level);
}

static void press(Bench* b, const Carriage* c) {
  int pressed = c->position < c->pressed_below;
  if (c->switch_pin >= 0) set_level(b, c->switch_pin, pressed == c->pressed_level);
}

static void on_pin(avr_irq_t* irq, uint32_t value, void* param) {
  (void)irq;
  Bench* b = ((Probe*)param)->bench;
  int pin = ((Probe*)param)->index;
  uint8_t level = value != 0;
  uint64_t now = b->avr->cycle;
  if (b->level[pin] == level) return;
  b->level[pin] = level;
  b->rises[pin] += level;
  if (level)
    b->high_since[pin] = now;
  else
    b->high_cycles[pin] += now - b->high_since[pin];
  if (b->watched[pin] == kEdges || (b->watched[pin] == kRises && level)) {
    if (b->edge_count < b->edge_room)
      b->edges[b->edge_count++] = (Edge){now, (uint16_t)pin, level};
    else
      b->edges_lost++;
  }
  for (int i = 0; i < b->carriage_count; ++i) {
    Carriage* c = &b->carriages[i];
    if (c->step_pin != pin || !level) continue;
    c->position += b->level[c->dir_pin] ? 1 : -1;
    press(b, c);
  }
}

static void on_interrupt(avr_irq_t* irq, uint32_t running, void* param) {
  (void)irq;
  Bench* b = param;
  avr_t* avr = b->avr;
  if (!running) {
    // The return takes as long as the entry, and is still to be counted.
    if (b->depth > 0 && --b->depth == 0)
      b->interrupt_cycles += avr->cycle + b->entry_cycles - b->interrupted_at;
    return;
  }
  b->entries++;
  if (b->depth++ == 0) b->interrupted_at = avr->cycle;
  avr->cycle += b->entry_cycles;
  // The length of the burst was fixed before; without this, timers due within it come late.
  avr->run_cycle_count -=
      avr->run_cycle_count > b->entry_cycles ? b->entry_cycles : avr->run_cycle_count;
}

// Called while the simulator handles an overflow, before it plans the compares of the new turn.
static void on_overflow(avr_irq_t* irq, uint32_t pending, void* param) {
  (void)irq;
  Bench* b = ((Probe*)param)->bench;
  avr_timer_t* timer = b->timers[((Probe*)param)->index];
  if (!pending || timer->tov_top != 0xffff) return;
  uint64_t late = b->avr->cycle - (timer->tov_base + timer->tov_cycles);
  for (int i = 0; i < AVR_TIMER_COMP_COUNT; ++i) {
    avr_timer_comp_t* unit = &timer->comp[i];
    if (!unit->r_ocr) continue;
    uint16_t compare = (uint16_t)(b->avr->data[unit->r_ocr] | b->avr->data[unit->r_ocrh] << 8);
    int planned = unit->comp_cycles && unit->comp_cycles >= late;
    if (compare > late || planned) continue;
    b->rescues++;
    avr_raise_interrupt(b->avr, &unit->interrupt);
  }
}

static void on_flags(avr_t* avr, avr_io_addr_t addr, uint8_t value, void* param) {
  Probe* probe = param;
  uint8_t up = avr->data[addr];
  avr->data[addr] = up & value;
  probe->written(avr, addr, value, probe->bench->timers[probe->index]);
  avr->data[addr] = up & ~value;
  probe->bench->siblings += (up & ~value) != 0;
}

static void on_conversion(avr_irq_t* irq, uint32_t value, void* param) {
  (void)irq;
  (void)value;
  Bench* b = param;
  uint8_t select = avr_regbit_get_array(b->avr, b->adc->mux, 6);
  int channel = (select & 7) | (select & 0x20 ? 8 : 0);
  b->channels += channel >= 8;
  b->adc->adc_values[channel & 7] = b->millivolts[channel];
}

static void on_byte(avr_irq_t* irq, uint32_t value, void* param) {
  (void)irq;
  Bench* b = param;
  put(&b->from_board, (uint8_t)value);
}

static void connect_pins(Bench* b) {
  static const char ports[] = "ABCDEFGHIJKL";
  for (int port = 0; ports[port]; ++port)
    for (int bit = 0; bit < 8; ++bit) {
      int pin = port * 8 + bit;
      avr_irq_t* irq = avr_io_getirq(b->avr, AVR_IOCTL_IOPORT_GETIRQ(ports[port]), bit);
      if (!irq) continue;
      b->pin_irq[pin] = irq;
      b->probes[pin] = (Probe){b, pin, NULL};
      avr_irq_register_notify(irq, on_pin, &b->probes[pin]);
    }
}

static void connect_modules(Bench* b) {
  for (avr_io_t* io = b->avr->io_port; io; io = io->next) {
    if (!strcmp(io->kind, "adc")) b->adc = (avr_adc_t*)io;
    if (!strcmp(io->kind, "uart") && ((avr_uart_t*)io)->name == '0') b->uart = (avr_uart_t*)io;
    if (!strcmp(io->kind, "timer") && b->timer_count < kTimers) {
      int i = b->timer_count++;
      b->timers[i] = (avr_timer_t*)io;
      Probe* probe = &b->probes[kPins + i];
      avr_io_addr_t flags = AVR_DATA_TO_IO(b->timers[i]->overflow.raised.reg);
      *probe = (Probe){b, i, b->avr->io[flags].w.c};
      b->avr->io[flags].w.c = on_flags;
      b->avr->io[flags].w.param = probe;
      avr_irq_register_notify(&b->timers[i]->overflow.irq[AVR_INT_IRQ_PENDING], on_overflow, probe);
    }
  }
  for (int i = 0; i < 8; ++i)
    b->adc->muxmode[0x20 + i] = (avr_adc_mux_t){.kind = ADC_MUX_SINGLE, .src = i};
  avr_irq_register_notify(b->adc->io.irq + ADC_IRQ_OUT_TRIGGER, on_conversion, b);
  // The firmware uses no external interrupts; looking at their pins every cycle takes long.
  for (uint8_t i = 0; i < kExternal; ++i) avr_extint_set_strict_lvl_trig(b->avr, i, 0);
  uint32_t flags = 0;
  avr_ioctl(b->avr, AVR_IOCTL_UART_SET_FLAGS('0'), &flags);
  avr_irq_register_notify(b->uart->io.irq + UART_IRQ_OUTPUT, on_byte, b);
  for (int vector = 1; vector < 64; ++vector) {
    avr_irq_t* irq = avr_get_interrupt_irq(b->avr, vector);
    if (irq) avr_irq_register_notify(irq + AVR_INT_IRQ_RUNNING, on_interrupt, b);
  }
}

// Null if the image cannot be read or the chip is unknown. Room for `edges` traced edges.
Bench* bench_new(const char* elf, const char* mcu, uint32_t hz, uint32_t edges) {
  elf_firmware_t firmware;
  memset(&firmware, 0, sizeof firmware);
  if (elf_read_firmware(elf, &firmware)) return NULL;
  Bench* b = calloc(1, sizeof *b);
  b->avr = avr_make_mcu_by_name(mcu);
  if (!b->avr) return NULL;
  b->edges = malloc(edges * sizeof(Edge));
  b->edge_room = edges;
  avr_init(b->avr);
  b->avr->log = LOG_ERROR;
  avr_load_firmware(b->avr, &firmware);
  b->avr->frequency = hz;
  b->avr->vcc = b->avr->avcc = b->avr->aref = kSupplyMillivolts;
  b->entry_cycles = b->avr->address_size == 3 ? 5 : 4;
  connect_pins(b);
  connect_modules(b);
  return b;
}

void bench_free(Bench* b) {
  avr_terminate(b->avr);
  free(b->edges);
  free(b);
}

static void serve_uart(Bench* b) {
  unsigned divisor = avr_regbit_get(b->avr, b->uart->ubrrl) + 1;
  unsigned bit_cycles = divisor * (avr_regbit_get(b->avr, b->uart->u2x) ? 8 : 16);
  b->uart->cycles_per_byte = bit_cycles * kBitsPerByte;
  avr_irq_t* input = b->uart->io.irq + UART_IRQ_INPUT;
  const uart_fifo_t* waiting = &b->uart->input;
  while (b->to_board.tail != b->to_board.head &&
         (unsigned)(waiting->write - waiting->read) % uart_fifo_fifo_size < kFifo)
    avr_raise_irq(input, b->to_board.data[b->to_board.tail++ % kQueue]);
}

static int is_queued(const Bench* b, const avr_int_vector_t* vector) {
  const avr_int_pending_t* queue = &b->avr->interrupts.pending;
  for (int i = queue->read; i != queue->write; i = (i + 1) % avr_int_pending_fifo_size)
    if (queue->buffer[i] == vector) return 1;
  return 0;
}

static void revive_interrupts(Bench* b) {
  for (int t = 0; t < b->timer_count; ++t)
    for (int i = 0; i < AVR_TIMER_COMP_COUNT; ++i) {
      avr_int_vector_t* vector = &b->timers[t]->comp[i].interrupt;
      if (!vector->vector || !avr_regbit_get(b->avr, vector->raised) ||
          !avr_regbit_get(b->avr, vector->enable) || is_queued(b, vector))
        continue;
      b->revivals++;
      vector->pending = 0;
      avr_raise_interrupt(b->avr, vector);
    }
}

// Runs until the cycle counter reaches `until`; false if the program crashed or stopped for good.
int bench_run(Bench* b, uint64_t until) {
  while (b->avr->cycle < until) {
    serve_uart(b);
    revive_interrupts(b);
    uint64_t end = b->avr->cycle + kSlice < until ? b->avr->cycle + kSlice : until;
    while (b->avr->cycle < end) {
      int state = avr_run(b->avr);
      if (state == cpu_Done || state == cpu_Crashed) return 0;
    }
  }
  return 1;
}

uint64_t bench_cycle(const Bench* b) { return b->avr->cycle; }

// Bytes for the board's receiver; at most 65535 may be on their way.
void bench_send(Bench* b, const uint8_t* data, int count) {
  while (count--) put(&b->to_board, *data++);
}

// Takes up to `room` bytes that the board has sent; returns their number.
int bench_receive(Bench* b, uint8_t* data, int room) {
  int count = 0;
  while (count < room && b->from_board.tail != b->from_board.head)
    data[count++] = b->from_board.data[b->from_board.tail++ % kQueue];
  return count;
}

// What is traced of a pin: nothing, kEdges or kRises.
void bench_watch(Bench* b, int pin, int watched) { b->watched[pin] = (uint8_t)watched; }
void bench_set_pin(Bench* b, int pin, int level) { set_level(b, pin, level); }
int bench_level(const Bench* b, int pin) { return b->level[pin]; }
void bench_set_voltage(Bench* b, int channel, int millivolts) {
  b->millivolts[channel] = (uint16_t)millivolts;
}

// Cycles spent in interrupts since the start, from entry to return.
uint64_t bench_interrupt_cycles(const Bench* b) { return b->interrupt_cycles; }

uint64_t bench_rises(const Bench* b, int pin) { return b->rises[pin]; }

// Cycles for which a pin has been high since the start.
uint64_t bench_high_cycles(const Bench* b, int pin) {
  return b->high_cycles[pin] + (b->level[pin] ? b->avr->cycle - b->high_since[pin] : 0);
}

// A carriage at `position` steps; a high direction pin moves it up. Its switch (pin -1: none) is
// pressed below `pressed_below`.
int bench_add_carriage(Bench* b, int step_pin, int dir_pin, int64_t position, int switch_pin,
                       int64_t pressed_below, int pressed_level) {
  Carriage* c = &b->carriages[b->carriage_count];
  *c = (Carriage){step_pin, dir_pin, switch_pin, pressed_level, position, pressed_below};
  press(b, c);
  return b->carriage_count++;
}
int64_t bench_position(const Bench* b, int carriage) { return b->carriages[carriage].position; }

// The traced edges since the last call, oldest first; their number. They stay until the next run.
const Edge* bench_edges(Bench* b, uint32_t* count) {
  *count = b->edge_count;
  b->edge_count = 0;
  return b->edges;
}
uint64_t bench_edges_lost(const Bench* b) { return b->edges_lost; }

// What the bench made up for: see the top.
uint64_t bench_entries(const Bench* b) { return b->entries; }
uint64_t bench_rescues(const Bench* b) { return b->rescues; }
uint64_t bench_revivals(const Bench* b) { return b->revivals; }
uint64_t bench_siblings(const Bench* b) { return b->siblings; }
uint64_t bench_channels(const Bench* b) { return b->channels; }

uint8_t bench_ram(const Bench* b, int address) { return b->avr->data[address]; }

// The foreground goes on at an instruction that jumps to itself; interrupts come as before. False
// if there is none.
int bench_hang(const Bench* b) {
  const uint8_t rjmp[] = {0xFF, 0xCF};
  for (avr_flashaddr_t at = 0; at < b->avr->flashend; at += 2) {
    if (memcmp(b->avr->flash + at, rjmp, sizeof rjmp) != 0) continue;
    b->avr->pc = at;
    return 1;
  }
  return 0;
}
