/// RDM over Art-Net: packets by the offsets of the specification, device tables, and the link.
#include "drivers/dmx/artnet/artnet_rdm.h"

#include <gtest/gtest.h>

#include "drivers/dmx/artnet/artnet_codec.h"
#include "tests/drivers/hex.h"
#include "tests/drivers/io/scripted_datagram.h"
#include "tests/drivers/test_rig.h"

namespace luxrig::artnet {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr SocketAddress kNode{0x0A000007, kPort};
constexpr int kLine = 0x0123;

Bytes tod_of(int total, int block, std::vector<rdm::Uid> uids, int port_address = kLine) {
  return encode(TodData{port_address, 1, 1, true, total, block, std::move(uids)});
}

TEST(ArtnetRdmCodec, FollowsTheSpecifiedFieldLayout) {
  const int ports[] = {0x0123, 0x0124};
  Bytes request = from_hex("4172742d4e657400 0080 000e 0000 00000000000000 01 00 02 2324");
  request.resize(56, 0);
  EXPECT_EQ(encode_tod_request(ports), request);
  EXPECT_EQ(decode_tod_request(request), (std::vector<int>{0x0123, 0x0124}));
  EXPECT_EQ(encode(TodControl{kLine, TodCommand::flush}),
            from_hex("4172742d4e657400 0082 000e 0000 00000000000000 01 01 23"));
  EXPECT_EQ(tod_of(1, 0, {{0x7a70, 2}}),
            from_hex("4172742d4e657400 0081 000e 01 01 000000000000 01 01 00 23 0001 00 01 7a7000000002"));
  // The published SET of a start address, without its start code.
  const Bytes rdm = from_hex("cc011a7a70ffffff027a700000000105010000003000f002002a070d");
  const Bytes carried = from_hex(
      "4172742d4e657400 0083 000e 01 00 00000000000000 01 00 23 "
      "011a7a70ffffff027a700000000105010000003000f002002a070d");
  EXPECT_EQ(encode(ArtRdm{kLine, rdm}), carried);
  const auto back = decode_art_rdm(carried);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->port_address, kLine);
  EXPECT_EQ(back->rdm, rdm);
}

TEST(ArtnetRdmCodec, RefusesTruncationsAndWrongCounts) {
  const int ports[] = {0x0123};
  const Bytes request = encode_tod_request(ports);
  const Bytes data = tod_of(2, 0, {{0x7a70, 1}, {0x7a70, 2}});
  for (std::size_t size = 0; size < data.size(); ++size) {
    EXPECT_FALSE(decode_tod_data(std::span(data).first(size)));
    if (size < 25) {
      EXPECT_FALSE(decode_tod_request(std::span(request).first(size)));
      EXPECT_FALSE(decode_art_rdm(std::span(data).first(size)));
    }
  }
  Bytes many = data;
  many[27] = 201;
  many.resize(28 + 201 * 6);
  EXPECT_FALSE(decode_tod_data(many));
  Bytes net = data;
  net[21] = 0x80;
  EXPECT_FALSE(decode_tod_data(net));
  Bytes command = encode(TodControl{kLine, TodCommand::end});
  EXPECT_TRUE(decode_tod_control(command));
  command[22] = 9;
  EXPECT_FALSE(decode_tod_control(command));
}

struct LinkTest : ::testing::Test {
  std::shared_ptr<DatagramScript> script = std::make_shared<DatagramScript>();
  ScriptedDatagram channel{script};
  ArtnetRdmLink link{channel, kNode, kLine};
  void arrive(Bytes bytes, SocketAddress from = kNode) { script->incoming.push_back({from, std::move(bytes)}); }
};

TEST_F(LinkTest, CollectsTheBlocksOfATable) {
  ASSERT_TRUE(link.ask_table());
  ASSERT_EQ(script->sent.size(), 1u);
  EXPECT_EQ(script->sent[0].to, kNode);
  std::vector<rdm::Uid> first, second;
  for (std::uint32_t i = 0; i < 200; ++i) first.push_back({0x7a70, i});
  for (std::uint32_t i = 200; i < 230; ++i) second.push_back({0x7a70, i});
  arrive(tod_of(230, 0, first));
  link.listen();
  EXPECT_TRUE(link.table().heard);
  EXPECT_FALSE(link.table().complete);
  arrive(tod_of(230, 1, second));
  link.listen();
  EXPECT_TRUE(link.table().complete);
  EXPECT_EQ(link.table().uids.size(), 230u);
  arrive(tod_of(1, 0, {{0x7a70, 9}}));  // later the others are gone
  link.listen();
  EXPECT_EQ(link.table().uids, (std::set<rdm::Uid>{{0x7a70, 9}}));
}

TEST_F(LinkTest, ListensOnlyToItsNodeAndPort) {
  arrive(tod_of(1, 0, {{0x7a70, 1}}), {0x0A000008, kPort});
  arrive(tod_of(1, 0, {{0x7a70, 1}}, 0x0124));
  arrive(encode_poll());
  link.listen();
  EXPECT_FALSE(link.table().heard);
  arrive(encode(TodData{kLine, 1, 1, false, 0, 0, {}}));  // it has no table
  link.listen();
  EXPECT_TRUE(link.table().heard);
  EXPECT_FALSE(link.table().complete);
}

TEST_F(LinkTest, CarriesAClientsQuestionsAndAnswers) {
  rdm::Client client(link, {0x7ff0, 1});
  client.begin({{0x7a70, 1}, rdm::CommandClass::get, rdm::Pid::device_hours});
  client.step(at_ms(0));
  ASSERT_EQ(script->sent.size(), 1u);
  const auto carried = decode_art_rdm(script->sent[0].bytes);
  ASSERT_TRUE(carried);
  auto packet = rdm::decode(carried->rdm);
  ASSERT_TRUE(packet);
  std::swap(packet->to, packet->from);
  packet->command_class = rdm::CommandClass::get_response;
  packet->port_or_type = 0;
  packet->data = {0, 0, 0, 9};
  Bytes garbled = rdm::encode(*packet);
  garbled.back() ^= 1;
  arrive(encode(ArtRdm{kLine, garbled}));
  client.step(at_ms(1));
  EXPECT_FALSE(client.take());
  arrive(encode(ArtRdm{kLine, rdm::encode(*packet)}));
  client.step(at_ms(2));
  const auto answer = client.take();
  ASSERT_TRUE(answer);
  ASSERT_TRUE(*answer);
  EXPECT_EQ(**answer, (Bytes{0, 0, 0, 9}));
  EXPECT_TRUE(client.idle());
}

TEST_F(LinkTest, ReportsTheNetworkErrorWhenItCannotSend) {
  script->send_fails = Fault{Cause::network, "", "no route", {}};
  rdm::Client client(link, {0x7ff0, 1});
  client.begin({{0x7a70, 1}});
  client.step(at_ms(0));
  const auto answer = client.take();
  ASSERT_TRUE(answer);
  ASSERT_FALSE(*answer);
  EXPECT_EQ(answer->error().cause, Cause::network);
}

}  // namespace
}  // namespace luxrig::artnet
