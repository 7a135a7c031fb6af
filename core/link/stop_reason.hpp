// Why time stopped passing on a link.
#pragma once
#include <cstdint>

namespace passo::wire {

enum class Stop : uint8_t { time, shutdown, heaters, fault, closed };

}  // namespace passo::wire
