#include "drivers/io/udp.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>

namespace luxrig {
namespace {

/// A plain receiver on an ephemeral loopback port.
class Receiver {
 public:
  explicit Receiver(std::uint16_t port = 0) : fd_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(port);
    EXPECT_EQ(::bind(fd_, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    socklen_t size = sizeof(address);
    ::getsockname(fd_, reinterpret_cast<sockaddr*>(&address), &size);
    address_ = {INADDR_LOOPBACK, ntohs(address.sin_port)};
  }
  ~Receiver() { ::close(fd_); }
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  [[nodiscard]] SocketAddress address() const { return address_; }
  [[nodiscard]] int fd() const { return fd_; }

 private:
  int fd_;
  SocketAddress address_;
};

bool readable(int fd) {
  pollfd wait{fd, POLLIN, 0};
  return ::poll(&wait, 1, 1000) == 1;
}

TEST(Udp, DeliversADatagramAndReceivesItsAnswer) {
  const Receiver receiver;
  const auto channel = make_udp({});
  ASSERT_TRUE(channel->open());
  const std::array<std::uint8_t, 3> bytes = {1, 2, 3};
  ASSERT_TRUE(channel->send(receiver.address(), bytes));
  ASSERT_TRUE(readable(receiver.fd()));
  std::array<std::uint8_t, 16> got{};
  sockaddr_in from{};
  socklen_t size = sizeof(from);
  ASSERT_EQ(::recvfrom(receiver.fd(), got.data(), got.size(), 0, reinterpret_cast<sockaddr*>(&from), &size), 3);
  EXPECT_FALSE(channel->receive());
  ASSERT_EQ(::sendto(receiver.fd(), "ok", 2, 0, reinterpret_cast<sockaddr*>(&from), size), 2);
  const auto answer = channel->receive();  // loopback delivers before sendto returns
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->from, receiver.address());
  EXPECT_EQ(answer->bytes, (std::vector<std::uint8_t>{'o', 'k'}));
}

TEST(Udp, ReportsAClosedPortAndStillSendsToAReopenedOne) {
  SocketAddress address;
  {
    const Receiver receiver;
    address = receiver.address();
  }
  const auto channel = make_udp({});
  ASSERT_TRUE(channel->open());
  const std::array<std::uint8_t, 1> byte = {7};
  EXPECT_TRUE(channel->send(address, byte));
  const Receiver receiver(address.port);
  EXPECT_TRUE(channel->send(address, byte));  // despite the pending earlier error
  ASSERT_TRUE(readable(receiver.fd()));
  const auto error = channel->take_error();
  ASSERT_TRUE(error);
  EXPECT_EQ(error->cause, Cause::network);
  EXPECT_EQ(error->detail, "a packet to " + text_of(address) + ": Connection refused");
  EXPECT_FALSE(channel->take_error());
}

TEST(Udp, OpensAndClosesRepeatedly) {
  const auto channel = make_udp({});
  EXPECT_FALSE(channel->is_open());
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(channel->open());
    EXPECT_TRUE(channel->open());
    EXPECT_TRUE(channel->is_open());
    channel->close();
    EXPECT_FALSE(channel->is_open());
  }
}

TEST(Udp, NamesAMissingInterface) {
  UdpSettings settings;
  settings.multicast_interface = "no-such-0";
  const auto channel = make_udp(settings);
  const auto opened = channel->open();
  ASSERT_FALSE(opened);
  EXPECT_NE(opened.error().detail.find("no-such-0"), std::string::npos);
  EXPECT_FALSE(channel->is_open());
}

TEST(Udp, ReadsOnlyNumericAddresses) {
  EXPECT_EQ(parse_ipv4("10.0.0.7"), 0x0A000007u);
  EXPECT_EQ(text_of(SocketAddress{0x0A000007, 80}), "10.0.0.7:80");
  for (const char* bad : {"", "localhost", "10.0.0", "10.0.0.256", "10.0.0.7 ", "::1"}) EXPECT_FALSE(parse_ipv4(bad));
  EXPECT_TRUE(is_multicast(*parse_ipv4("239.255.0.1")));
  EXPECT_FALSE(is_multicast(*parse_ipv4("240.0.0.1")));
}

}  // namespace
}  // namespace luxrig
