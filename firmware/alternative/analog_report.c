// Analog inputs as older hosts ask for them: one sum in a report. A build for those takes this file
// in place of its namesake in core/.
#include "analog_in.h"
#include "command.h"

DECL_REPORT("analog_in_state oid=%c next_clock=%u value=%hu");

void analog_in_report(uint8_t oid, uint32_t next_clock, const uint8_t *values, uint8_t size) {
  (void)size;
  uint16_t value = (uint16_t)(values[0] | values[1] << 8);
  report(REPORT_ANALOG_IN_STATE, (uint32_t[]){oid, next_clock, value}, 3);
}

DECL_COMMAND(command_query_analog_in,
             "query_analog_in oid=%c clock=%u sample_ticks=%u sample_count=%c rest_ticks=%u"
             " min_value=%hu max_value=%hu range_check_count=%c",
             0);
void command_query_analog_in(const uint32_t *args) { analog_in_query(args, 2, args + 5); }
