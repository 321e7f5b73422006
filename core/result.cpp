#include "core/result.h"

namespace luxrig {

const char* name_of(Cause cause) {
  switch (cause) {
    case Cause::network:
      return "network";
    case Cause::timeout:
      return "timeout";
    case Cause::protocol:
      return "protocol";
    case Cause::refused:
      return "refused";
    case Cause::invalid:
      return "invalid";
    case Cause::inactive:
      return "inactive";
    case Cause::cancelled:
      return "cancelled";
    case Cause::system:
      return "system";
  }
  return "unknown";
}

}  // namespace luxrig
