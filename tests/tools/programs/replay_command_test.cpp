// `luxrig replay` as a user runs it: says what is in a recording, and sends it to a receiver on loopback.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "drivers/dmx/sacn/sacn_codec.h"
#include "tests/tools/programs/process.h"

namespace luxrig::testing {
namespace {

std::string by_tshark() { return source("tests/data/recordings/sacn_by_tshark_on_any.pcapng"); }

Ran replay(std::vector<std::string> words) {
  words.insert(words.begin(), {program("luxrig"), "replay"});
  return luxrig::testing::run(words);
}

TEST(ReplayCommand, InfoTellsWhatIsInARecording) {
  const Ran ran = replay({by_tshark(), "--info"});
  EXPECT_EQ(ran.code, 0) << ran.output;
  EXPECT_NE(ran.output.find("14 packets, 1.1 s"), std::string::npos) << ran.output;
  EXPECT_NE(ran.output.find("house desk"), std::string::npos) << ran.output;
}

TEST(ReplayCommand, SendsEveryPacketToTheReceiver) {
  const int receiver = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof(address);
  ASSERT_EQ(::bind(receiver, reinterpret_cast<sockaddr*>(&address), size), 0);
  ASSERT_EQ(::getsockname(receiver, reinterpret_cast<sockaddr*>(&address), &size), 0);
  const Ran ran =
      replay({by_tshark(), "--to", "127.0.0.1:" + std::to_string(ntohs(address.sin_port)), "--speed", "20"});
  EXPECT_EQ(ran.code, 0) << ran.output;
  std::vector<sacn::DataPacket> heard;
  std::uint8_t bytes[2000];
  for (;;) {
    const ssize_t got = ::recv(receiver, bytes, sizeof(bytes), 0);
    if (got < 0) break;
    const auto packet = sacn::decode({bytes, static_cast<std::size_t>(got)});
    ASSERT_TRUE(packet.has_value());
    heard.push_back(*packet);
  }
  ::close(receiver);
  ASSERT_EQ(heard.size(), 14u) << "the recording has the goodbye itself";
  EXPECT_EQ(heard.front().source_name, "house desk");
  EXPECT_EQ(heard.front().slots, (std::vector<std::uint8_t>{0x89, 0x76, 10, 20, 0, 0, 0, 0}));
  for (std::size_t i = 0; i < heard.size(); ++i) {
    EXPECT_EQ(heard[i].sequence, 8 + i);
    EXPECT_EQ(heard[i].terminated, i >= 11);
  }
}

TEST(ReplayCommand, SaysWhatItNeeds) {
  const auto refused = [](const std::vector<std::string>& words, const std::string& with) {
    const Ran ran = replay(words);
    EXPECT_EQ(ran.code, 2) << ran.output;
    EXPECT_NE(ran.output.find(with), std::string::npos) << ran.output;
  };
  refused({by_tshark()}, "where to? name a rig");
  refused({by_tshark(), "--to", "desk.local"}, "--to desk.local is no IPv4 address");
  refused({by_tshark(), source("tests/rigs/room")}, "listens to a desk");
  refused({by_tshark(), source("tests/rigs/visitors")}, "nothing in");
  refused({source("README.md"), "--info"}, "give a pcap or pcapng file");
}

}  // namespace
}  // namespace luxrig::testing
