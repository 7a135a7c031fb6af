// The messages of the virtual board: its message ids are arbitrary, the declarations are those of
// Klipper's protocol.
#pragma once
#include <cstdint>
#include <iterator>

namespace passo::wire {

enum class Command : int32_t {
  identify = 1,
  queue_step = 2,
  set_next_step_dir,
  reset_step_clock,
  queue_digital_out,
  queue_pwm_out,
  update_digital_out,
  get_clock,
  get_uptime,
  get_config,
  allocate_oids,
  finalize_config,
  emergency_stop,
  clear_shutdown,
  reset,
  debug_nop,
  debug_ping,
  config_stepper,
  stepper_get_position,
  stepper_stop_on_trigger,
  config_endstop,
  endstop_home,
  endstop_query_state,
  config_trsync,
  trsync_start,
  trsync_set_timeout,
  trsync_trigger,
  config_analog_in,
  query_analog_in,
  config_digital_out,
  set_digital_out_pwm_cycle,
  set_digital_out,
  config_pwm_out,
  set_pwm_out,
  config_tmcuart,
  tmcuart_send,
  config_spi,
  spi_set_sw_bus,
  spi_transfer,
  spi_send,
  config_thermocouple,
  query_thermocouple,
  end_
};
enum class Report : int32_t {
  identify_response = 0,
  clock = 64,
  uptime,
  config,
  starting,
  is_shutdown,
  shutdown,
  pong,
  stepper_position,
  endstop_state,
  trsync_state,
  analog_in_state,
  tmcuart_response,
  spi_transfer_response,
  thermocouple_result,
};

struct Declaration {
  int32_t id;
  const char* text;
  bool in_shutdown = false;  // also accepted after a shutdown
};

inline constexpr Declaration kCommands[] = {
    {int(Command::identify), "identify offset=%u count=%c", true},
    {int(Command::queue_step), "queue_step oid=%c interval=%u count=%hu add=%hi"},
    {int(Command::set_next_step_dir), "set_next_step_dir oid=%c dir=%c"},
    {int(Command::reset_step_clock), "reset_step_clock oid=%c clock=%u"},
    {int(Command::queue_digital_out), "queue_digital_out oid=%c clock=%u on_ticks=%u"},
    {int(Command::queue_pwm_out), "queue_pwm_out oid=%c clock=%u value=%hu"},
    {int(Command::update_digital_out), "update_digital_out oid=%c value=%c"},
    {int(Command::get_clock), "get_clock", true},
    {int(Command::get_uptime), "get_uptime", true},
    {int(Command::get_config), "get_config", true},
    {int(Command::allocate_oids), "allocate_oids count=%c"},
    {int(Command::finalize_config), "finalize_config crc=%u"},
    {int(Command::emergency_stop), "emergency_stop", true},
    {int(Command::clear_shutdown), "clear_shutdown", true},
    {int(Command::reset), "reset", true},
    {int(Command::debug_nop), "debug_nop", true},
    {int(Command::debug_ping), "debug_ping data=%*s", true},
    {int(Command::config_stepper),
     "config_stepper oid=%c step_pin=%c dir_pin=%c invert_step=%c step_pulse_ticks=%u"},
    {int(Command::stepper_get_position), "stepper_get_position oid=%c"},
    {int(Command::stepper_stop_on_trigger), "stepper_stop_on_trigger oid=%c trsync_oid=%c"},
    {int(Command::config_endstop), "config_endstop oid=%c pin=%c pull_up=%c"},
    {int(Command::endstop_home),
     "endstop_home oid=%c clock=%u sample_ticks=%u sample_count=%c rest_ticks=%u pin_value=%c"
     " trsync_oid=%c trigger_reason=%c"},
    {int(Command::endstop_query_state), "endstop_query_state oid=%c"},
    {int(Command::config_trsync), "config_trsync oid=%c"},
    {int(Command::trsync_start),
     "trsync_start oid=%c report_clock=%u report_ticks=%u expire_reason=%c"},
    {int(Command::trsync_set_timeout), "trsync_set_timeout oid=%c clock=%u"},
    {int(Command::trsync_trigger), "trsync_trigger oid=%c reason=%c"},
    {int(Command::config_analog_in), "config_analog_in oid=%c pin=%u"},
    {int(Command::query_analog_in),
     "query_analog_in oid=%c clock=%u sample_ticks=%u sample_count=%c rest_ticks=%u"
     " bytes_per_report=%c min_value=%hu max_value=%hu range_check_count=%c"},
    {int(Command::config_digital_out),
     "config_digital_out oid=%c pin=%u value=%c default_value=%c max_duration=%u"},
    {int(Command::set_digital_out_pwm_cycle), "set_digital_out_pwm_cycle oid=%c cycle_ticks=%u"},
    {int(Command::set_digital_out), "set_digital_out pin=%u value=%c"},
    {int(Command::config_pwm_out),
     "config_pwm_out oid=%c pin=%u cycle_ticks=%u value=%hu default_value=%hu max_duration=%u"},
    {int(Command::set_pwm_out), "set_pwm_out pin=%u cycle_ticks=%u value=%hu"},
    {int(Command::config_tmcuart),
     "config_tmcuart oid=%c rx_pin=%u pull_up=%c tx_pin=%u bit_time=%u"},
    {int(Command::tmcuart_send), "tmcuart_send oid=%c write=%*s read=%c"},
    {int(Command::config_spi), "config_spi oid=%c pin=%u cs_active_high=%c"},
    {int(Command::spi_set_sw_bus),
     "spi_set_sw_bus oid=%c miso_pin=%u mosi_pin=%u sclk_pin=%u mode=%u pulse_ticks=%u"},
    {int(Command::spi_transfer), "spi_transfer oid=%c data=%*s"},
    {int(Command::spi_send), "spi_send oid=%c data=%*s"},
    {int(Command::config_thermocouple),
     "config_thermocouple oid=%c spi_oid=%c thermocouple_type=%c"},
    {int(Command::query_thermocouple),
     "query_thermocouple oid=%c clock=%u rest_ticks=%u min_value=%u max_value=%u"
     " max_invalid_count=%c"},
};

inline constexpr Declaration kReports[] = {
    {int(Report::identify_response), "identify_response offset=%u data=%.*s"},
    {int(Report::clock), "clock clock=%u"},
    {int(Report::uptime), "uptime high=%u clock=%u"},
    {int(Report::config), "config is_config=%c crc=%u is_shutdown=%c move_count=%hu"},
    {int(Report::starting), "starting"},
    {int(Report::is_shutdown), "is_shutdown static_string_id=%hu"},
    {int(Report::shutdown), "shutdown clock=%u static_string_id=%hu"},
    {int(Report::pong), "pong data=%*s"},
    {int(Report::stepper_position), "stepper_position oid=%c pos=%i"},
    {int(Report::endstop_state), "endstop_state oid=%c homing=%c next_clock=%u pin_value=%c"},
    {int(Report::trsync_state), "trsync_state oid=%c can_trigger=%c trigger_reason=%c clock=%u"},
    {int(Report::analog_in_state), "analog_in_state oid=%c next_clock=%u values=%*s"},
    {int(Report::tmcuart_response), "tmcuart_response oid=%c read=%*s"},
    {int(Report::spi_transfer_response), "spi_transfer_response oid=%c response=%*s"},
    {int(Report::thermocouple_result),
     "thermocouple_result oid=%c next_clock=%u value=%u fault=%c"},
};

// Why a board shuts down. The number goes over the wire as static_string_id.
enum class Fault : uint16_t {
  none,
  emergency_stop,
  timer_too_close,
  step_too_late,
  count_zero,
  slots_exhausted,
  stepper_active,
  invalid_oid,
  oid_taken,
  not_finalized,
  already_finalized,
  bad_command,
  adc_range,
  missed_digital,
  missed_pwm,
  output_queue_busy,
  period_too_short,
  uart_too_long,
  spi_without_bus,
  thermocouple_type,
  thermocouple_range,
  thermocouple_fault,
};
inline constexpr const char* kFaults[] = {
    "",
    "Command request",
    "Timer too close",
    "Stepper too far in past",
    "Invalid count parameter",
    "Move queue overflow",
    "Can't reset time when stepper active",
    "Invalid oid type",
    "Can't assign oid",
    "Command before finalize_config",
    "Configuration is finalized already",
    "Command parser error",
    "ADC out of range",
    "Missed scheduling of next digital out event",
    "Missed scheduling of next hard pwm event",
    "Output updated while its queue holds commands",
    "Period too short for this board",
    "tmcuart data too large",
    "SPI device without a bus",
    "Invalid thermocouple chip type",
    "Thermocouple ADC out of range",
    "Thermocouple reader fault",
};
static_assert(std::size(kFaults) == size_t(Fault::thermocouple_fault) + 1);

// Thrown by the parts of the board; the board stops all motion and outputs.
struct Shutdown {
  Fault fault;
};

}  // namespace passo::wire
