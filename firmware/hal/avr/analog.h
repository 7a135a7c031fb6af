#pragma once

void analog_start(void);
