// Converters as older hosts ask for them: the faults that are too many come with each question. A
// build for those takes this file in place of its namesake in core/.
#include "command.h"
#include "thermocouple.h"

DECL_COMMAND(command_config_thermocouple,
             "config_thermocouple oid=%c spi_oid=%c thermocouple_type=%c", 0);
void command_config_thermocouple(const uint32_t *args) { thermocouple_config(args); }

DECL_COMMAND(command_query_thermocouple,
             "query_thermocouple oid=%c clock=%u rest_ticks=%u min_value=%u max_value=%u"
             " max_invalid_count=%c",
             0);
void command_query_thermocouple(const uint32_t *args) {
  thermocouple_query(args);
  thermocouple_forgive(args[0], args[5] > 0 ? args[5] - 1 : 0);
}
