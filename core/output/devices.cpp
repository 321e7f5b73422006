#include "core/output/devices.h"

namespace luxrig {

const char* name_of(DeskMode mode) {
  switch (mode) {
    case DeskMode::merge:
      return "merge";
    case DeskMode::takeover:
      return "takeover";
    case DeskMode::standby:
      return "standby";
  }
  return "unknown";
}

const char* name_of(Life life) {
  switch (life) {
    case Life::configured:
      return "configured";
    case Life::active:
      return "active";
    case Life::faulted:
      return "faulted";
  }
  return "unknown";
}

}  // namespace luxrig
