/// Modbus answers two ways: through our decoder, and through a real exchange over libmodbus with a peer on loopback
/// that answers every request with the fuzzer's bytes. Input: which request, whether the peer corrects the transaction
/// number, then the answer.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmath>
#include <cstdlib>
#include <thread>

#include "drivers/modbus/modbus_codec.h"
#include "drivers/modbus/modbus_registers.h"
#include "drivers/modbus/modbus_tcp_link.h"
#include "tests/fuzz/modbus_requests.h"

namespace {

using namespace luxrig::modbus;
using Bytes = std::vector<std::uint8_t>;

/// Listens once; each exchange gets its own connection.
int listener(int& port) {
  static int kept_port = 0;
  static const int fd = [] {
    const int made = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::bind(made, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0 || ::listen(made, 4) != 0) {
      std::abort();
    }
    socklen_t size = sizeof(address);
    ::getsockname(made, reinterpret_cast<sockaddr*>(&address), &size);
    kept_port = ntohs(address.sin_port);
    return made;
  }();
  port = kept_port;
  return fd;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const Request request = luxrig::fuzz::request_for(data[0]);
  const bool mend = (data[1] & 1) != 0;
  Bytes answer(data + 2, data + size);

  Bytes numbered = answer;
  if (mend && numbered.size() >= 2) {
    numbered[0] = 0;
    numbered[1] = 1;
  }
  const Answer decoded = decode(request, 1, numbered);
  if (decoded.verdict == Verdict::good && request.function == Function::read_holding) {
    const double lux = lux_from_registers({}, decoded.values);
    if (!std::isfinite(lux) || lux < 0) std::abort();
  }

  if (decoded.verdict == Verdict::good && reads(request.function)) {
    if (decoded.values.size() != request.count) std::abort();
    for (const std::uint16_t value : decoded.values)
      if (is_of_bits(request.function) && value > 1) std::abort();
  }

  // The exchange costs a connection: it is done for accepted answers and for one in sixteen of the rejected ones, among
  // inputs that libmodbus could take for an answer.
  if (answer.size() < 8 || answer.size() > 600) return 0;
  std::uint32_t sum = 0;
  for (const std::uint8_t byte : answer) sum = sum * 31 + byte;
  if (decoded.verdict != Verdict::good && sum % 16 != 0) return 0;
  int port = 0;
  const int fd = listener(port);
  TcpLink link("127.0.0.1", port);
  if (!link.connect(std::chrono::milliseconds(1000))) return 0;
  const int peer = ::accept4(fd, nullptr, nullptr, SOCK_CLOEXEC);
  std::thread thread([&] {
    std::uint8_t request_bytes[300];
    const auto got = ::recv(peer, request_bytes, sizeof(request_bytes), 0);
    if (got >= 2 && mend) {
      answer[0] = request_bytes[0];
      answer[1] = request_bytes[1];
    }
    ::send(peer, answer.data(), answer.size(), MSG_NOSIGNAL);
    ::shutdown(peer, SHUT_WR);
  });
  const auto values = link.exchange(request, std::chrono::milliseconds(1000));
  thread.join();
  ::close(peer);
  // An exchange never accepts bytes that the decoder rejects.
  if (values && decoded.verdict != Verdict::good) std::abort();
  if (values && *values != decoded.values) std::abort();
  return 0;
}
