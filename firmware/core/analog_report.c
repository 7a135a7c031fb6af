// Analog inputs of newer hosts: one report holds several sums.
#include "analog_in.h"
#include "command.h"

DECL_REPORT("analog_in_state oid=%c next_clock=%u values=%*s");

void analog_in_report(uint8_t oid, uint32_t next_clock, const uint8_t *values, uint8_t size) {
  report_bytes(REPORT_ANALOG_IN_STATE, (uint32_t[]){oid, next_clock}, 2, values, size);
}

DECL_COMMAND(command_query_analog_in,
             "query_analog_in oid=%c clock=%u sample_ticks=%u sample_count=%c rest_ticks=%u"
             " bytes_per_report=%c min_value=%hu max_value=%hu range_check_count=%c",
             0);
void command_query_analog_in(const uint32_t *args) {
  analog_in_query(args, (uint8_t)args[5], args + 6);
}
