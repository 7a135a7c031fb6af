#include "command.h"
#include "thermocouple.h"

DECL_COMMAND(command_config_thermocouple,
             "config_thermocouple oid=%c spi_oid=%c thermocouple_type=%c"
             " consecutive_fault_limit=%u",
             0);
void command_config_thermocouple(const uint32_t *args) {
  thermocouple_config(args);
  thermocouple_forgive(args[0], args[3]);
}

DECL_COMMAND(command_query_thermocouple,
             "query_thermocouple oid=%c clock=%u rest_ticks=%u min_value=%u max_value=%u", 0);
void command_query_thermocouple(const uint32_t *args) { thermocouple_query(args); }
