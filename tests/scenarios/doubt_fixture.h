#pragma once
/// Shared by the tests of doubt.

#include "tests/scenarios/closed_loop.h"

namespace luxrig::scenarios::doubt_fixture {

inline bool accused(const ClosedLoop& loop, const std::string& device = "meter") {
  for (const Alarm& alarm : loop.status().alarms)
    if (alarm.device.rfind(device, 0) == 0 && alarm.text.find("cannot be believed") != std::string::npos) return true;
  return false;
}

inline bool says(const ClosedLoop& loop, const char* text) {
  for (const Alarm& alarm : loop.status().alarms)
    if (!alarm.severe && alarm.text.find(text) != std::string::npos) return true;
  return false;
}

}  // namespace luxrig::scenarios::doubt_fixture
