#include "drivers/usb/usb_channel.h"

namespace luxrig {

const char* name_of(UsbStatus status) {
  switch (status) {
    case UsbStatus::done:
      return "done";
    case UsbStatus::stalled:
      return "stalled";
    case UsbStatus::cancelled:
      return "cancelled";
    case UsbStatus::gone:
      return "unplugged";
    case UsbStatus::failed:
      return "failed";
  }
  return "";
}

}  // namespace luxrig
