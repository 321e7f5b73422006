#include "drivers/io/os_fault.h"

#include <cerrno>
#include <system_error>

namespace luxrig {

Fault os_fault(const std::string& doing, int error) {
  Cause cause = Cause::system;
  switch (error) {
    case ECONNREFUSED:
    case ECONNRESET:
    case ECONNABORTED:
    case EPIPE:
    case ENETUNREACH:
    case ENETDOWN:
    case EHOSTUNREACH:
    case EHOSTDOWN:
    case EADDRNOTAVAIL:
    case ENODEV:
    case EAGAIN:
    case ENOBUFS:
      cause = Cause::network;
      break;
    case ETIMEDOUT:
      cause = Cause::timeout;
      break;
    default:
      break;
  }
  return Fault{cause, {}, doing + ": " + std::generic_category().message(error), {}};
}

}  // namespace luxrig
