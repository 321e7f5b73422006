#include "drivers/dmx/artnet/artnet_controller.h"

#include <gtest/gtest.h>

#include "tests/drivers/test_rig.h"

namespace luxrig::artnet {
namespace {

DmxSlots slots_at(std::uint8_t level) {
  DmxSlots slots{};
  slots[4] = level;
  return slots;
}

Datagram reply_from(std::uint32_t ipv4, int port_address) {
  PollReply reply;
  reply.short_name = "node";
  reply.bind_index = 1;
  reply.outputs.push_back({port_address, false});
  return {{ipv4, kPort}, encode(reply, ipv4)};
}

// The first packet is sent twice. A change held back behind it by the rate limit once counted as sent: a blackout was
// acknowledged while the lamps were lit.
TEST(ArtnetController, LevelsCountAsSentOnlyAfterTheirPacket) {
  for (const int packets_before : {0, 1, 2, 50}) {
    Controller controller({});
    double ms = 0;
    for (int i = 0; i < packets_before; ++i, ms += 1000)
      ASSERT_TRUE(controller.due(at_ms(ms), 1, slots_at(200))) << packets_before;
    if (packets_before == 0) {
      EXPECT_FALSE(controller.is_sent(1, slots_at(200))) << "nothing was";
      ASSERT_TRUE(controller.due(at_ms(ms), 1, slots_at(200)));
      ms += 1000;
    }
    EXPECT_TRUE(controller.is_sent(1, slots_at(200))) << packets_before;
    EXPECT_FALSE(controller.is_sent(1, slots_at(0)));
    EXPECT_FALSE(controller.is_sent(2, slots_at(200))) << "of another universe";
    ASSERT_FALSE(controller.due(at_ms(ms - 1000 + 5), 1, slots_at(0))) << "the rate of a DMX line";
    EXPECT_FALSE(controller.is_sent(1, slots_at(0))) << packets_before << " packets before";
    EXPECT_FALSE(controller.is_sent(1, slots_at(200)));
    ASSERT_TRUE(controller.due(at_ms(ms - 1000 + 25), 1, slots_at(0)));
    EXPECT_TRUE(controller.is_sent(1, slots_at(0))) << packets_before;
  }
}

TEST(ArtnetController, LevelsCountAsSentOnlyWhenNewNodesHaveThem) {
  Controller controller({});
  ASSERT_TRUE(controller.due(at_ms(0), 1, slots_at(0)));
  ASSERT_TRUE(controller.is_sent(1, slots_at(0)));
  ASSERT_TRUE(controller.hear(at_ms(5), reply_from(0x0A000001, 1)));
  EXPECT_FALSE(controller.is_sent(1, slots_at(0)));
  ASSERT_TRUE(controller.due(at_ms(30), 1, slots_at(0)));
  EXPECT_TRUE(controller.is_sent(1, slots_at(0)));
  ASSERT_TRUE(controller.hear(at_ms(40), reply_from(0x0A000001, 1)));
  EXPECT_TRUE(controller.is_sent(1, slots_at(0))) << "a node that was known already";
  controller.rest();
  EXPECT_FALSE(controller.is_sent(1, slots_at(0))) << "every universe is sent afresh";
}

}  // namespace
}  // namespace luxrig::artnet
