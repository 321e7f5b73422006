// The simulated RDM responder against literal bytes, its line, and the node in front of it.
#include "sim/devices/rdm_responder.h"

#include <gtest/gtest.h>

#include "sim/devices/rdm_line.h"
#include "sim/wire/artnet/artnet_rdm_gate.h"
#include "tests/sim/tiny_rig.h"

namespace luxrig::sim {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

constexpr std::uint64_t kLampUid = 0x7a7000000001, kRdmDesk = 0x7a70000000ff;

RdmIdentity identity_of(std::uint64_t uid = kLampUid, std::size_t slots = 2) {
  RdmIdentity identity;
  identity.uid = uid;
  identity.label = "spot";
  identity.address = 42;
  identity.slots.assign(slots, RdmSlot{});
  identity.lamp_hours = 1000;
  return identity;
}

RdmFrame request_of(int command_class, int pid, Bytes data = {}, std::uint64_t to = kLampUid) {
  RdmFrame frame;
  frame.to = to;
  frame.from = kRdmDesk;
  frame.transaction = 7;
  frame.port_or_type = 1;
  frame.command_class = command_class;
  frame.pid = pid;
  frame.data = std::move(data);
  return frame;
}

struct Asked {
  RdmResponder responder{identity_of()};
  RdmFrame ask(const RdmFrame& request, Time now = at_s(0)) {
    const auto answer = read_rdm(responder.receive(now, write_rdm(request)));
    EXPECT_TRUE(answer);
    return answer.value_or(RdmFrame{});
  }
  RdmFrame get(int pid, Bytes data = {}, Time now = at_s(0)) {
    return ask(request_of(0x20, pid, std::move(data)), now);
  }
  RdmFrame set(int pid, Bytes data) { return ask(request_of(0x30, pid, std::move(data))); }
};

TEST(RdmResponder, AnswersAnUnmutedBranchAsPublished) {
  RdmResponder responder(identity_of());
  const Bytes all = {0xcc, 0x01, 0x24, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x7a, 0x70, 0x00, 0x00,
                     0x00, 0x01, 0x00, 0x01, 0x00, 0x00, 0x00, 0x10, 0x00, 0x01, 0x0c, 0x00, 0x00,
                     0x00, 0x00, 0x00, 0x00, 0xff, 0xff, 0xff, 0xff, 0xff, 0xfe, 0x0d, 0xed};
  const Bytes answer = {0xfe, 0xfe, 0xfe, 0xfe, 0xfe, 0xfe, 0xfe, 0xaa, 0xfa, 0x7f, 0xfa, 0x75,
                        0xaa, 0x55, 0xaa, 0x55, 0xaa, 0x55, 0xab, 0x55, 0xae, 0x57, 0xef, 0xf5};
  EXPECT_EQ(responder.receive(at_s(0), all), answer);
  const auto muted = read_rdm(responder.receive(at_s(0), write_rdm(request_of(0x10, 0x0002))));
  ASSERT_TRUE(muted);
  EXPECT_EQ(muted->command_class, 0x11);
  EXPECT_EQ(muted->data, (Bytes{0, 0}));
  EXPECT_TRUE(responder.receive(at_s(0), all).empty());
  EXPECT_TRUE(responder.receive(at_s(0), write_rdm(request_of(0x10, 0x0003, {}, kRdmEverybody))).empty());
  EXPECT_EQ(responder.receive(at_s(0), all), answer);
  Bytes below = all;  // up to 7a7000000000, one below its own
  const Bytes highest = {0x7a, 0x70, 0x00, 0x00, 0x00, 0x00};
  std::copy(highest.begin(), highest.end(), below.begin() + 30);
  const int sum = 0x0ded - (0xff * 5 + 0xfe) + 0x7a + 0x70;
  below[36] = static_cast<std::uint8_t>(sum >> 8);
  below[37] = static_cast<std::uint8_t>(sum & 0xff);
  ASSERT_TRUE(read_rdm(below));
  EXPECT_TRUE(responder.receive(at_s(0), below).empty());
}

TEST(RdmResponder, IgnoresForeignAndCorruptRequests) {
  RdmResponder responder(identity_of());
  EXPECT_TRUE(responder.receive(at_s(0), write_rdm(request_of(0x20, 0x0060, {}, kLampUid + 1))).empty());
  EXPECT_TRUE(responder.receive(at_s(0), write_rdm(request_of(0x20, 0x0060, {}, kRdmEverybody))).empty());
  const Bytes good = write_rdm(request_of(0x20, 0x0060));
  for (std::size_t at = 0; at < good.size(); ++at) {
    Bytes bytes = good;
    bytes[at] ^= 0x40;
    EXPECT_TRUE(responder.receive(at_s(0), bytes).empty()) << at;
    EXPECT_TRUE(responder.receive(at_s(0), std::span(good).first(at)).empty()) << at;
  }
}

TEST(RdmResponder, DescribesItself) {
  Asked asked;
  const RdmFrame info = asked.get(0x0060);
  EXPECT_EQ(info.from, kLampUid);
  EXPECT_EQ(info.to, kRdmDesk);
  EXPECT_EQ(info.transaction, 7);
  EXPECT_EQ(info.data, (Bytes{1, 0, 0, 1, 0x01, 0x01, 0, 0, 0, 1, 0, 2, 1, 1, 0, 42, 0, 0, 1}));
  EXPECT_EQ(asked.get(0x0082).data, (Bytes{'s', 'p', 'o', 't'}));
  EXPECT_EQ(asked.get(0x00e1, {1}).data, (Bytes{1, 0, 2, 'a', 's', ' ', 'p', 'a', 't', 'c', 'h', 'e', 'd'}));
}

TEST(RdmResponder, NacksWithAReason) {
  Asked asked;
  const auto nack = [](const RdmFrame& answer) { return answer.port_or_type == 2 ? answer.data.at(1) : -1; };
  EXPECT_EQ(nack(asked.get(0x8001)), 0);
  EXPECT_EQ(nack(asked.get(0x0060, {1})), 1);
  EXPECT_EQ(nack(asked.set(0x0060, {})), 5);
  EXPECT_EQ(nack(asked.set(0x00f0, {2, 0})), 6);  // 512 leaves no room for the second slot
  EXPECT_EQ(nack(asked.set(0x00e0, {2})), 6);
  RdmFrame part = request_of(0x20, 0x0060);
  part.sub_device = 1;
  EXPECT_EQ(nack(asked.ask(part)), 9);
  RdmIdentity locked = identity_of();
  locked.write_protected = true;
  asked.responder = RdmResponder(locked);
  EXPECT_EQ(nack(asked.set(0x00f0, {0, 1})), 4);
  EXPECT_EQ(asked.responder.address(), 42);
}

TEST(RdmResponder, AcceptsAddressLabelAndIdentify) {
  Asked asked;
  EXPECT_EQ(asked.set(0x00f0, {1, 0xff}).port_or_type, 0);
  EXPECT_EQ(asked.responder.address(), 511);
  EXPECT_EQ(asked.set(0x0082, {'x'}).port_or_type, 0);
  EXPECT_EQ(asked.responder.label(), "x");
  EXPECT_EQ(asked.set(0x1000, {1}).port_or_type, 0);
  EXPECT_TRUE(asked.responder.identifies());
  EXPECT_EQ(asked.get(0x1000).data, Bytes{1});
  EXPECT_TRUE(asked.responder.receive(at_s(0), write_rdm(request_of(0x30, 0x1000, {0}, kRdmEverybody))).empty());
  EXPECT_FALSE(asked.responder.identifies());  // obeyed, not answered
}

TEST(RdmResponder, DelaysLampHoursAndQueuesThem) {
  Asked asked;
  const RdmFrame timer = asked.get(0x0401);
  EXPECT_EQ(timer.port_or_type, 1);
  EXPECT_EQ(timer.data, (Bytes{0, 3}));
  EXPECT_EQ(asked.get(0x0020, {2}).pid, 0x0030);  // nothing yet
  EXPECT_EQ(asked.get(0x0060, {}, at_s(0.3)).messages, 1);
  const RdmFrame queued = asked.get(0x0020, {2}, at_s(0.3));
  EXPECT_EQ(queued.pid, 0x0401);
  EXPECT_EQ(queued.command_class, 0x21);
  EXPECT_EQ(queued.data, (Bytes{0, 0, 3, 0xe8}));
  EXPECT_EQ(asked.get(0x0020, {2}, at_s(0.4)).pid, 0x0030);
  EXPECT_EQ(asked.get(0x0020, {1}, at_s(0.4)).pid, 0x0401);  // repeats the last one
}

TEST(RdmResponder, SendsLongAnswersInParts) {
  Asked asked;
  asked.responder = RdmResponder(identity_of(kLampUid, 100));
  const RdmFrame first = asked.get(0x0120);
  EXPECT_EQ(first.port_or_type, 3);
  EXPECT_EQ(first.data.size(), 231u);
  EXPECT_EQ(asked.get(0x0120).data.size(), 231u);
  const RdmFrame last = asked.get(0x0120);
  EXPECT_EQ(last.port_or_type, 0);
  EXPECT_EQ(last.data.size(), 38u);
  EXPECT_EQ(asked.get(0x0120).port_or_type, 3);
  asked.get(0x0060);  // ends the session
  const RdmFrame again = asked.get(0x0120);
  EXPECT_EQ(again.data, first.data);
}

TEST(RdmResponder, WarmsUpWhileLit) {
  Asked asked;
  const auto tenths = [&] {
    const RdmFrame value = asked.get(0x0201, {0});
    return value.data.at(1) << 8 | value.data.at(2);
  };
  EXPECT_EQ(tenths(), 250);
  asked.responder.shine(at_s(0), 1);
  asked.responder.shine(at_s(120), 1);
  EXPECT_EQ(tenths(), 250 + 253);  // 1 − 1/e of 40 K
  asked.responder.shine(at_s(5000), 0);
  EXPECT_EQ(tenths(), 650);
  EXPECT_EQ(asked.get(0x0403).data, Bytes{0});
}

TEST(RdmLine, AppliesTheFaultsOfItsMembers) {
  Faults faults(1);
  RdmLine line(faults);
  line.add("a", identity_of(kLampUid));
  line.add("b", identity_of(kLampUid + 1));
  const Bytes ask = write_rdm(request_of(0x20, 0x0060));
  EXPECT_TRUE(read_rdm(line.exchange(at_s(0), ask).bytes));
  EXPECT_EQ(line.reachable(), (std::vector<std::uint64_t>{kLampUid, kLampUid + 1}));
  faults.set("a", FaultKind::garbled, true);
  for (int i = 0; i < 100; ++i) EXPECT_FALSE(read_rdm(line.exchange(at_s(0), ask).bytes));
  faults.set("a", FaultKind::garbled, false);
  faults.set("a", FaultKind::slow, true, 250);
  EXPECT_EQ(line.exchange(at_s(0), ask).late, Duration(250ms));
  faults.set("a", FaultKind::unpowered, true);
  EXPECT_TRUE(line.exchange(at_s(0), ask).bytes.empty());
  EXPECT_EQ(line.reachable(), (std::vector<std::uint64_t>{kLampUid + 1}));
  faults.clear();
  faults.set("a", FaultKind::lost, true, 0.5);
  int answered = 0;
  for (int i = 0; i < 400; ++i) answered += line.exchange(at_s(0), ask).bytes.empty() ? 0 : 1;
  EXPECT_GT(answered, 140);
  EXPECT_LT(answered, 260);
}

TEST(ArtnetRdmGate, SendsTablesInBlocksAndSearchesAgainWhenFlushed) {
  Faults faults(1);
  std::map<int, RdmLine> lines;
  RdmLine& line = lines.try_emplace(0x0123, faults).first->second;
  for (std::uint64_t i = 0; i < 230; ++i) line.add("device-" + std::to_string(i), identity_of(kLampUid + i));
  ArtnetRdmGate gate(lines);
  Bytes request = {'A', 'r', 't', '-', 'N', 'e', 't', 0, 0x00, 0x80, 0, 14,   0,
                   0,   0,   0,   0,   0,   0,   0,   0, 1,    0,    2, 0x23, 0x24};
  const auto blocks = gate.receive(at_s(0), request);
  ASSERT_EQ(blocks.size(), 2u);
  const Bytes head = {'A', 'r', 't', '-', 'N', 'e', 't',  0, 0x00, 0x81, 0,   14,   1,    1, 0, 0, 0,
                      0,   0,   0,   1,   1,   0,   0x23, 0, 230,  0,    200, 0x7a, 0x70, 0, 0, 0, 1};
  EXPECT_EQ(Bytes(blocks[0].packet.begin(), blocks[0].packet.begin() + 34), head);
  EXPECT_EQ(blocks[0].packet.size(), 28u + 200 * 6);
  EXPECT_EQ(blocks[1].packet.size(), 28u + 30 * 6);
  EXPECT_EQ(blocks[1].packet[26], 1);
  faults.set("device-0", FaultKind::dead, true);
  EXPECT_EQ(gate.receive(at_s(0), request)[0].packet[25], 230);
  const Bytes flush = {'A', 'r', 't', '-', 'N', 'e', 't', 0, 0x00, 0x82, 0, 14, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0x23};
  EXPECT_EQ(gate.receive(at_s(0), flush)[0].packet[25], 229);
  for (std::size_t size = 0; size < request.size(); ++size) {
    EXPECT_TRUE(gate.receive(at_s(0), std::span(request).first(size)).empty());
  }
}

}  // namespace
}  // namespace luxrig::sim
