#include "drivers/dmx/enttec_pro/widget_session.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/drivers/hex.h"
#include "tests/drivers/test_rig.h"

namespace luxrig::enttec {
namespace {

std::vector<int> labels_in(const std::vector<std::uint8_t>& bytes) {
  StreamDecoder decoder;
  decoder.add(bytes);
  std::vector<int> labels;
  while (const auto message = decoder.next()) labels.push_back(message->label);
  EXPECT_EQ(decoder.dropped(), 0u);
  return labels;
}

const auto kParameters = from_hex("7e 03 05 00 44 01 11 02 28 e7");
const auto kOthers = from_hex("7e 0a 04 00 12 34 56 02 e7 7e 4d 04 00 01 00 41 42 e7 7e 4e 03 00 01 00 43 e7");

struct Conversation {
  Conversation() { session.start(at_ms(0)); }
  std::vector<int> due(double ms) { return labels_in(session.due(at_ms(ms), slots)); }
  WidgetSession session{Parameters{0, 17, 2, 40}};
  DmxSlots slots{};
};

TEST(WidgetSession, IdentifiesTheWidgetOnceBeforeItIsLive) {
  Conversation c;
  EXPECT_EQ(c.due(0), (std::vector<int>{3, 10, 77, 78}));
  EXPECT_FALSE(c.session.is_live());
  EXPECT_EQ(c.due(20), std::vector<int>{});
  c.session.receive(at_ms(21), kParameters);
  EXPECT_FALSE(c.session.is_live());  // the names may still arrive
  c.session.receive(at_ms(22), kOthers);
  EXPECT_TRUE(c.session.is_live());
  EXPECT_EQ(c.session.identity().serial, "02563412");
  EXPECT_EQ(c.session.identity().manufacturer, "AB");
  EXPECT_EQ(c.session.identity().firmware, 0x0144);
  std::set<int> later;
  for (double t = 23; t < 5000; t += 10) {
    for (const int label : c.due(t)) later.insert(label);
    c.session.receive(at_ms(t + 1), kParameters);
  }
  EXPECT_EQ(later, (std::set<int>{3, 6}));
}

TEST(WidgetSession, AnOriginalWidgetWithoutANameIsLiveAfter200Ms) {
  Conversation c;
  (void)c.due(0);
  c.session.receive(at_ms(5), kParameters);
  EXPECT_EQ(c.due(199), std::vector<int>{});
  EXPECT_EQ(c.due(200), std::vector<int>{6});
}

TEST(WidgetSession, ThrottlesTo40PacketsASecondAndSendsTheNewest) {
  Conversation c;
  (void)c.due(0);
  c.session.receive(at_ms(1), kParameters);
  c.session.receive(at_ms(1), kOthers);
  int packets = 0;
  for (int t = 2; t < 2002; ++t) {
    c.slots[0] = static_cast<std::uint8_t>(t);
    const auto bytes = c.session.due(at_ms(t), c.slots);
    StreamDecoder decoder;
    decoder.add(bytes);
    while (const auto message = decoder.next()) {
      if (message->label != 6) continue;
      ++packets;
      EXPECT_EQ(message->data.at(1), static_cast<std::uint8_t>(t));
    }
    c.session.receive(at_ms(t), kParameters);
  }
  EXPECT_GE(packets, 79);
  EXPECT_LE(packets, 82);
}

TEST(WidgetSession, SetsParametersOnlyWhereTheyDiffer) {
  Conversation same;
  (void)same.due(0);
  same.session.receive(at_ms(1), kParameters);
  same.session.receive(at_ms(1), kOthers);
  EXPECT_EQ(same.due(2), std::vector<int>{6});
  Conversation differs;
  (void)differs.due(0);
  differs.session.receive(at_ms(1), from_hex("7e 03 05 00 44 01 09 01 28 e7"));
  differs.session.receive(at_ms(1), kOthers);
  EXPECT_EQ(differs.due(2), (std::vector<int>{4, 6}));
}

TEST(WidgetSession, AnAnswerIsOverdueAfter500MsUntilItArrives) {
  Conversation c;
  (void)c.due(0);
  EXPECT_FALSE(c.session.is_overdue(at_ms(500)));
  EXPECT_TRUE(c.session.is_overdue(at_ms(501)));
  c.session.receive(at_ms(502), kParameters);
  EXPECT_FALSE(c.session.is_overdue(at_ms(502)));
  EXPECT_TRUE(c.session.has_answered());
}

TEST(WidgetSession, AGarbledLengthCostsOneAnswer) {
  Conversation c;
  (void)c.due(0);
  c.session.receive(at_ms(1), from_hex("7e 03 05 02 44 01 11 02 28 e7"));
  EXPECT_FALSE(c.session.has_answered());
  c.session.receive(at_ms(250), kParameters);
  EXPECT_TRUE(c.session.has_answered());
}

TEST(WidgetSession, SendsOnlyUnsentLevelsBeforeLeaving) {
  Conversation c;
  EXPECT_TRUE(c.session.unsent(c.slots).empty());  // not live: no levels have been set
  (void)c.due(0);
  c.session.receive(at_ms(1), kParameters);
  c.session.receive(at_ms(1), kOthers);
  EXPECT_EQ(c.due(2), std::vector<int>{6});
  EXPECT_TRUE(c.session.unsent(c.slots).empty());
  c.slots[3] = 9;
  EXPECT_EQ(labels_in(c.session.unsent(c.slots)), std::vector<int>{6});
}

}  // namespace
}  // namespace luxrig::enttec
